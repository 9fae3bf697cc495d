"""What a pendulum's motion needs to know before it is evaluated: numbers of the scene, and the anchor (symbols and equations: pendulum.py).

Whatever decides or grows with time, Omega, phi, Delta and the rate of the phase, is formed with 32 digits from the doubles of the input.
"""

import math
from fractions import Fraction

import numpy as np

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.motions.free_body import rotation
from rigid_body_sim.motions.free_body.rotation import (
    AMPLITUDES,
    CIRCULAR,
    FORM,
    HALF,
    HYPERBOLIC,
    KC_HYPERBOLIC,
    PHASE,
    RATE,
    START,
    STEADY,
    circular_series,
    fill_circular,
    fill_hyperbolic,
    hyperbolic_series,
)
from rigid_body_sim.numerics.double_double import two_sum
from rigid_body_sim.numerics.elliptic import agm_pair, carlson_rf, complete_k
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.pairs import (
    TURN,
    minus,
    over,
    pair_at,
    pair_of,
    plus,
    products,
    put,
    root_of,
    scaled,
    times,
)
from rigid_body_sim.numerics.phase import phase, sin_cos
from rigid_body_sim.numerics.rotations import multiply, normalised, rotate
from rigid_body_sim.scene import bodies

# layout of the parameters: pairs n, (n x r)/d, -r_across/d, M g d/I; doubles n, through, M, g, r, tensor about `through` times n, M g/I
AXIS, SIDE, DOWN, PULL, UNIT, THROUGH, MASS, GRAVITY, ARM, MOMENTUM, WEIGHT = 0, 6, 12, 18, 20, 23, 26, 27, 28, 31, 34
PARAMETER_SIZE = 35

# layout of the anchor behind what the theta functions take: 1 if it swings, unit of the rates, w if nothing turns it,
# quaternions that c and s multiply, n, centre and radii (world) of the circle of the body's origin
SWINGS, SPEED, UPRIGHT, TURNED, NORMAL, MIDDLE, COSINE, SINE = (rotation.SIZE + k for k in (0, 1, 2, 6, 10, 13, 16, 19))
ANCHOR_SIZE = SINE + 3

NEVER = 2.0 ** 200              # stands for the infinite period on the separatrix


def parameters(scene):
    """Return the numbers of the scene, shape (PARAMETER_SIZE,): layout above; from the exact rationals that the doubles of the scene are."""
    body, gravity = scene.body, scene.effect('gravity')
    p = np.zeros(PARAMETER_SIZE)
    axis, through = _exact(scene.constraint.axis), _exact(scene.constraint.through)
    r = [c - t for c, t in zip(_exact(body.center_of_mass), through, strict=True)]
    n = [component / _root(_dot(axis, axis)) for component in axis]
    side, along = _cross(n, r), _dot(n, r)
    down = [along * a - b for a, b in zip(n, r, strict=True)]
    mass, g = Fraction(body.mass), Fraction(gravity.g if gravity else 0.0)
    momentum = [a - mass * b for a, b in zip(_tensor_times(body.about_center, n), _cross(r, _cross(r, n)), strict=True)]
    d, moment = _root(_dot(side, side)), _dot(n, momentum)
    size = hypot3(*body.center_of_mass) + hypot3(*scene.constraint.through)
    if d <= bodies.ULPS * size:
        d = Fraction(0)         # on the axis, to the rounding of what the scene says
    for k in range(3):
        put(p, AXIS + 2 * k, pair_of(n[k]))
        if d:
            put(p, SIDE + 2 * k, pair_of(side[k] / d))
            put(p, DOWN + 2 * k, pair_of(down[k] / d))
    put(p, PULL, pair_of(mass * g * d / moment))
    p[UNIT:UNIT + 3], p[THROUGH:THROUGH + 3], p[MASS], p[GRAVITY] = n, scene.constraint.through, body.mass, g
    p[ARM:ARM + 3], p[MOMENTUM:MOMENTUM + 3], p[WEIGHT] = r, momentum, mass * g / moment
    return p


def _exact(numbers):
    return [Fraction(number) for number in numbers]


def _dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def _cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def _root(number):
    """Return the square root of a Fraction, to 40 digits or more."""
    if not number:
        return number
    shift = max(0, 140 - (number.numerator.bit_length() - number.denominator.bit_length()) // 2)
    return Fraction(math.isqrt((number.numerator << 2 * shift) // number.denominator), 1 << shift)


def _tensor_times(inertia, n):
    """Return I n for principal moments and axes."""
    x, y, z, w = _exact(inertia.axes)
    norm = x * x + y * y + z * z + w * w
    columns = ((w * w + x * x - y * y - z * z, 2 * (x * y + z * w), 2 * (x * z - y * w)),
               (2 * (x * y - z * w), w * w + y * y - z * z - x * x, 2 * (y * z + x * w)),
               (2 * (x * z + y * w), 2 * (y * z - x * w), w * w + z * z - x * x - y * y))
    along = [Fraction(moment) * _dot(column, n) / norm for moment, column in zip(inertia.moments, columns, strict=True)]
    return [sum(a * column[k] for a, column in zip(along, columns, strict=True)) / norm for k in range(3)]


@compiled
def anchor(p, start, out):
    """Precompute the motion from a state (14 doubles, its time included); of its angular velocity the part along the axis counts."""
    w = scaled(_along(p, AXIS, (start[5], 0.0), (start[6], 0.0), (start[7], 0.0)), 0.5)
    cosine, sine, size = _position(p, start)
    omega = root_of(times(pair_at(p, PULL), size))
    s, c = _half_angle(cosine, sine, size)
    unit = max(abs(w[0]), omega[0])
    unit = math.ldexp(1.0, min(max(math.frexp(unit)[1], -900), 900)) if unit > 0.0 else 1.0      # powers of two are exact
    out[START], out[SWINGS], out[SPEED] = start[0], 0.0, unit
    out[PHASE], out[rotation.SIDE] = 0.0, 1.0
    w, omega = scaled(w, 1.0 / unit), scaled(omega, 1.0 / unit)
    if omega[0] == 0.0 or (w[0] == 0.0 and (s[0] == 0.0 or c[0] == 0.0)):
        out[FORM] = STEADY
        turns = times(w, TURN)
        put(out, HALF, scaled(turns, unit))
        out[AMPLITUDES] = w[0]
    else:
        _fill_elliptic(w, omega, s, c, unit, out)
    _fill_attitude(p, start, out)


@compiled
def _along(p, place, x, y, z):
    """Return the scalar product of a vector of pairs among the parameters with the vector (x, y, z) of pairs."""
    total = plus(times(pair_at(p, place), x), times(pair_at(p, place + 2), y))
    return plus(total, times(pair_at(p, place + 4), z))


@compiled
def _position(p, start):
    """Return G cos(phi), G sin(phi) and G; G is 0 for an axis that is vertical to rounding, or if there is no arm."""
    x, y, z, w = start[1], start[2], start[3], start[4]
    top, rest = products(z, z, w, w), products(x, x, y, y)
    norm = plus(top, rest)
    gx, gy, gz = scaled(products(x, z, -w, y), 2.0), scaled(products(y, z, w, x), 2.0), minus(top, rest)
    cosine, sine = over(_along(p, DOWN, gx, gy, gz), norm), over(_along(p, SIDE, gx, gy, gz), norm)
    size = root_of(plus(times(cosine, cosine), times(sine, sine)))
    if size[0] <= bodies.ULPS:
        size = 0.0, 0.0
    return cosine, sine, size


@compiled
def _half_angle(cosine, sine, size):
    """Return sin(phi/2) and cos(phi/2) >= 0, each from a sum without cancellation."""
    if size[0] == 0.0:
        return (0.0, 0.0), (1.0, 0.0)
    twice = scaled(size, 2.0)
    if cosine[0] >= 0.0:
        c = root_of(over(plus(size, cosine), twice))
        return over(sine, times(twice, c)), c
    s = root_of(over(minus(size, cosine), twice))
    c = over(sine, times(twice, s))
    if sine[0] < 0.0:
        return scaled(s, -1.0), scaled(c, -1.0)
    return s, c


@compiled
def _fill_elliptic(w, omega, s, c, unit, out):
    """Fill series, rate and phase of the elliptic functions; rates are in the unit given."""
    side = -1.0 if w[0] < 0.0 else 1.0          # mirrored where needed so that w >= 0
    w, s = scaled(w, side), scaled(s, side)
    rise, fall = times(omega, c), times(omega, s)
    less, more = minus(rise, w), plus(rise, w)
    swings = less[0] >= 0.0
    larger, smaller = max(w[0], abs(fall[0])), min(w[0], abs(fall[0]))
    ratio = smaller / larger
    top = larger * math.sqrt(1.0 + ratio * ratio)              # w where it is greatest
    if swings:
        out[SWINGS] = 1.0
        x, k = omega, min(top / omega[0], 1.0)
        cn, sn, dn = w[0] / top, fall[0] / top, c[0]
        A1, A2, A3 = side * top, side * k, 1.0
    else:
        less = scaled(less, -1.0)
        x = root_of(plus(times(w, w), times(fall, fall)))
        k = min(omega[0] / x[0], 1.0)
        cn, sn, dn = c[0], s[0], w[0] / x[0]
        A1, A2, A3 = 1.0, side, side * x[0]
    y = times(root_of(less), root_of(more))
    kc = y[0] / x[0]
    f = scaled(x, 0.5 / NEVER)
    if kc > 0.0:
        mean, mean_low = agm_pair(x[0], x[1], y[0], y[1])
        f = times((mean, mean_low), TURN)
    put(out, RATE, scaled(f, unit))
    if cn < kc * abs(sn):
        # nearer to the quarter period: K - u has sn = cn/dn, cn = k' sn/dn, dn = k'/dn
        out[PHASE] = math.copysign(0.25 - f[0] / x[0] * _argument(cn / dn, kc * abs(sn) / dn, kc / dn), sn)
    else:
        out[PHASE] = f[0] / x[0] * _argument(sn, cn, dn)
    if kc >= KC_HYPERBOLIC:
        out[FORM] = CIRCULAR
        fill_circular(out, A1, A2, A3, k * k, kc, 0.25 * x[0] / f[0], 0.0)
    else:
        out[FORM] = HYPERBOLIC
        period = 0.25 * math.pi * x[0] / (f[0] * complete_k(k)) if kc > 0.0 else NEVER
        fill_hyperbolic(out, A1, A2, A3, k, kc, period, 0.0)


@compiled
def _argument(sn, cn, dn):
    """Return u = sn R_F(cn^2, dn^2, 1) (DLMF 19.25.5) for cn, dn >= 0, its first duplication written out for the sake of 1e-300."""
    step = cn * dn + cn + dn
    return sn * carlson_rf(0.25 * (cn * cn + step), 0.25 * (dn * dn + step), 0.25 * (1.0 + step))


@compiled
def _fill_attitude(p, start, out):
    """Fill what takes s and c to the attitude and to the circle of the body's origin, so that the start itself comes out."""
    nx, ny, nz = p[UNIT], p[UNIT + 1], p[UNIT + 2]
    s, c, _ = functions(out, 0.0, 0.0)
    x, y, z, w = normalised(start[1], start[2], start[3], start[4])
    x, y, z, w = normalised(*multiply(x, y, z, w, -s * nx, -s * ny, -s * nz, c))
    out[UPRIGHT], out[UPRIGHT + 1], out[UPRIGHT + 2], out[UPRIGHT + 3] = x, y, z, w
    out[TURNED], out[TURNED + 1], out[TURNED + 2], out[TURNED + 3] = multiply(x, y, z, w, nx, ny, nz, 0.0)
    out[NORMAL], out[NORMAL + 1], out[NORMAL + 2] = nx, ny, nz
    # the body's origin from the hinge is -through; of that the part across the axis goes round
    hx, hy, hz = p[THROUGH], p[THROUGH + 1], p[THROUGH + 2]
    mx, my, mz = ny * hz - nz * hy, nz * hx - nx * hz, nx * hy - ny * hx
    ax, ay, az = rotate(x, y, z, w, my * nz - mz * ny, mz * nx - mx * nz, mx * ny - my * nx)
    bx, by, bz = rotate(x, y, z, w, mx, my, mz)
    cosine, sine = (c - s) * (c + s), 2.0 * s * c
    out[COSINE], out[COSINE + 1], out[COSINE + 2] = ax, ay, az
    out[SINE], out[SINE + 1], out[SINE + 2] = bx, by, bz
    out[MIDDLE] = start[8] + (cosine * ax + sine * bx)
    out[MIDDLE + 1] = start[9] + (cosine * ay + sine * by)
    out[MIDDLE + 2] = start[10] + (cosine * az + sine * bz)


@compiled_inline
def steady(c, dt, dt_low):
    """Return s, c and w (rad/s) at a time, a pair, after the start: uniform rotation."""
    sine, cosine = sin_cos(*phase(c[HALF], c[HALF + 1], dt, dt_low))
    return sine, cosine, c[SPEED] * c[AMPLITUDES]


@compiled_inline
def circular(c, dt, dt_low):
    """Return what :func:`steady` returns: by the nome."""
    w1, w2, w3, _, _ = circular_series(c, *_argument_at(c, dt, dt_low))
    return _sorted(c, w1, w2, w3)


@compiled_inline
def hyperbolic(c, dt, dt_low):
    """Return what :func:`steady` returns: by the complementary nome."""
    w1, w2, w3, _, _, _ = hyperbolic_series(c, *_argument_at(c, dt, dt_low))
    return _sorted(c, w1, w2, w3)


@compiled_inline
def _argument_at(c, dt, dt_low):
    """Return the phase of the elliptic functions as a pair."""
    v, v_low = phase(c[RATE], c[RATE + 1], dt, dt_low)
    v, low = two_sum(v, c[PHASE])
    return v, v_low + low


@compiled_inline
def _sorted(c, w1, w2, w3):
    """Return s, c and w from what goes like cn, sn and dn."""
    swings = c[SWINGS] != 0.0
    return w2, w3 if swings else w1, c[SPEED] * (w1 if swings else w3)


@compiled
def functions(c, dt, dt_low):
    """Return what :func:`steady` returns, by the form that the motion has."""
    if c[FORM] == CIRCULAR:
        return circular(c, dt, dt_low)
    if c[FORM] == HYPERBOLIC:
        return hyperbolic(c, dt, dt_low)
    return steady(c, dt, dt_low)
