# SPDX-License-Identifier: Apache-2.0
"""Numbers of a pendulum's motion that are computed once: those of the scene, and the anchor.

Symbols and equations are those of pendulum.py. Omega, phi, Delta and the rate of the phase decide
the motion or grow with time, so they are formed with 32 digits from the doubles of the input.
"""

import functools
import math
from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.compilation.layout import Pair, Quaternion, Vector, layout
from rigid_body_sim.mechanics.pulls import weight_of
from rigid_body_sim.motions.axle import (
    KEPT,
    axle,
    swung,
)
from rigid_body_sim.motions.free_body.rotation import (
    CIRCULAR,
    HYPERBOLIC,
    KC_HYPERBOLIC,
    STEADY,
    Course,
    Rotation,
    circular_series,
    fill_circular,
    fill_hyperbolic,
    hyperbolic_series,
    load_circular,
    load_course,
    load_hyperbolic,
    phase_of,
    store_course,
)
from rigid_body_sim.numerics import vectors
from rigid_body_sim.numerics.elliptic import agm_pair, carlson_rf, complete_k
from rigid_body_sim.numerics.pairs import (
    TURN,
    minus,
    over,
    plus,
    products,
    quotient,
    root_of,
    scaled,
    times,
)
from rigid_body_sim.numerics.phase import phase, sin_cos
from rigid_body_sim.numerics.rotations import multiply, normalised, rotate
from rigid_body_sim.numerics.vectors import cross, dot
from rigid_body_sim.scene import principal_axes
from rigid_body_sim.scene.state import STATE

NEVER = 2.0 ** 200              # stands for the infinite period on the separatrix
NOTHING = 0.0, 0.0

Pairs = tuple[Pair, Pair, Pair]


class Parameters(NamedTuple):
    """Numbers of the scene; vectors in body axes."""

    axis: Pairs          # n
    side: Pairs          # (n x r)/d
    down: Pairs          # -r_across/d
    pull: Pair           # M g d/I, 1/s^2
    unit: Vector         # n in doubles
    through: Vector      # m
    mass: float          # kg
    g: float             # m/s^2, with all that pulls at the centre of mass
    arm: Vector          # r, m
    momentum: Vector     # the tensor about `through` times n, kg m^2
    weight: float        # M g/I


class Swing(NamedTuple):
    """How s, c and w follow from what goes like cn, sn and dn."""

    swings: float        # 1.0 if it swings, 0.0 if it turns over or turns steadily
    unit: float          # unit of w, rad/s


class Circle(NamedTuple):
    """How the attitude follows from s and c, and the circle (world) of the body's origin."""

    upright: Quaternion    # attitude at c = 1, s = 0
    turned: Quaternion     # attitude at c = 0, s = 1
    normal: Vector         # n
    middle: Vector         # m
    cosine: Vector         # m: position = middle - cosine cos(phi) - sine sin(phi)
    sine: Vector


class Anchor(NamedTuple):
    """Numbers that one state determines."""

    rotation: Rotation
    swing: Swing
    circle: Circle


PARAMETERS, ANCHOR = layout(Parameters), layout(Anchor)
PARAMETER_SIZE, ANCHOR_SIZE = PARAMETERS.size, ANCHOR.size
load_parameters, load_state = PARAMETERS.load, STATE.load
load_swing, store_swing = ANCHOR.part('swing').load, ANCHOR.part('swing').store
load_circle, store_circle = ANCHOR.part('circle').load, ANCHOR.part('circle').store


@functools.lru_cache(maxsize=KEPT)
def _directions(axis, center, point):
    """Return n, (n x r)/d and (n (n . r) - r)/d as pairs, the last two 0 where d is."""
    n, r, (d, of_d), _ = swung(axis, center, point)
    along = dot(n.integers, r.integers)
    down = vectors.minus(vectors.scaled(along, n.integers),
                         vectors.scaled(n.over * n.over, r.integers))

    def over_d(vector, one):
        return [quotient(component * of_d, one * d) if d else NOTHING
                for component in vector]
    side, one = cross(n.integers, r.integers), n.over * r.over
    return [quotient(x, n.over) for x in n.integers], over_d(side, one), over_d(down, one * n.over)


def parameters(scene):
    """Return the numbers of the scene, :class:`Parameters` as an array.

    They come from the exact rationals that the doubles of the scene are.
    """
    return PARAMETERS.array(numbers_of(scene, weight_of(scene)))


def numbers_of(scene, g):
    """Return the :class:`Parameters` of a scene for g (m/s^2)."""
    body, constraint, held = scene.body, scene.constraint, axle(scene)
    point = constraint.point(body)
    (M, of_M), (pull, of_pull) = body.mass.as_integer_ratio(), g.as_integer_ratio()
    weighs, over = M * pull * held.moment[1], of_M * of_pull * held.moment[0]    # M g/I
    d, of_d = held.distance
    return Parameters(
        *_directions(constraint.axis, body.center_of_mass, point),
        quotient(weighs * d, over * of_d), held.axis.rounded(), point, body.mass, float(g),
        held.arm.rounded(), held.momentum.rounded(), weighs / over)


@compiled
def anchor(parameters, start, out):
    """Fill the anchor from a state; of its angular velocity the part along the axis counts."""
    fill_anchor(load_parameters(parameters), load_state(start), out)


@compiled_inline
def fill_anchor(p, begin, out):
    """Fill the anchor from Parameters and a StateView."""
    wx, wy, wz = begin.angular_velocity
    w = scaled(_along(p.axis, (wx, 0.0), (wy, 0.0), (wz, 0.0)), 0.5)
    cosine, sine, size = _position(p.down, p.side, begin.orientation)
    omega = root_of(times(p.pull, size))
    s, c = _half_angle(cosine, sine, size)
    unit = max(abs(w[0]), omega[0])
    # powers of two are exact
    unit = math.ldexp(1.0, min(max(math.frexp(unit)[1], -900), 900)) if unit > 0.0 else 1.0
    w, omega = scaled(w, 1.0 / unit), scaled(omega, 1.0 / unit)
    if omega[0] == 0.0 or (w[0] == 0.0 and (s[0] == 0.0 or c[0] == 0.0)):
        store_swing(out, Swing(0.0, unit))
        store_course(out, Course(STEADY, begin.time, NOTHING, scaled(times(w, TURN), unit), 0.0,
                                 (0.0, 0.0, 0.0), (w[0], 0.0, 0.0)))
    else:
        _fill_elliptic(w, omega, s, c, unit, begin.time, out)
    _fill_circle(p, begin, out)


@compiled
def _along(a, x, y, z):
    """Return the scalar product of a vector of pairs with the vector (x, y, z) of pairs."""
    return plus(plus(times(a[0], x), times(a[1], y)), times(a[2], z))


@compiled
def _position(down, side, orientation):
    """Return G cos(phi), G sin(phi) and G.

    G is 0 for an axis that is vertical to rounding, or if there is no arm.
    """
    x, y, z, w = orientation
    top, rest = products(z, z, w, w), products(x, x, y, y)
    norm = plus(top, rest)
    gx, gy = scaled(products(x, z, -w, y), 2.0), scaled(products(y, z, w, x), 2.0)
    gz = minus(top, rest)
    cosine, sine = over(_along(down, gx, gy, gz), norm), over(_along(side, gx, gy, gz), norm)
    size = root_of(plus(times(cosine, cosine), times(sine, sine)))
    if size[0] <= principal_axes.ULPS:
        size = NOTHING
    return cosine, sine, size


@compiled
def _half_angle(cosine, sine, size):
    """Return sin(phi/2) and cos(phi/2) >= 0, each from a sum without cancellation."""
    if size[0] == 0.0:
        return NOTHING, (1.0, 0.0)
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
def _fill_elliptic(w, omega, s, c, unit, start, out):
    """Fill series, rate and phase of the elliptic functions; w and Omega are in the unit given."""
    side = -1.0 if w[0] < 0.0 else 1.0          # mirrored where needed so that w >= 0
    w, s = scaled(w, side), scaled(s, side)
    rise, fall = times(omega, c), times(omega, s)
    less, more = minus(rise, w), plus(rise, w)
    swings = less[0] >= 0.0
    larger, smaller = max(w[0], abs(fall[0])), min(w[0], abs(fall[0]))
    ratio = smaller / larger
    top = larger * math.sqrt(1.0 + ratio * ratio)              # w where it is greatest
    if swings:
        x, k = omega, min(top / omega[0], 1.0)
        cn, sn, dn = w[0] / top, fall[0] / top, c[0]
        A = side * top, side * k, 1.0
    else:
        less = scaled(less, -1.0)
        x = root_of(plus(times(w, w), times(fall, fall)))
        k = min(omega[0] / x[0], 1.0)
        cn, sn, dn = c[0], s[0], w[0] / x[0]
        A = 1.0, side, side * x[0]
    y = times(root_of(less), root_of(more))
    kc = y[0] / x[0]
    f = scaled(x, 0.5 / NEVER)
    if kc > 0.0:
        f = times(agm_pair(*x, *y), TURN)
    if cn < kc * abs(sn):
        # nearer to the quarter period: K - u has sn = cn/dn, cn = k' sn/dn, dn = k'/dn
        left = f[0] / x[0] * _argument(cn / dn, kc * abs(sn) / dn, kc / dn)
        phase = math.copysign(0.25 - left, sn)
    else:
        phase = f[0] / x[0] * _argument(sn, cn, dn)
    if kc >= KC_HYPERBOLIC:
        form = CIRCULAR
        amplitudes, _ = fill_circular(out, A, 1.0, k * k, kc, 0.25 * x[0] / f[0], 0.0)
    else:
        form = HYPERBOLIC
        period = 0.25 * math.pi * x[0] / (f[0] * complete_k(k)) if kc > 0.0 else NEVER
        amplitudes, _, _ = fill_hyperbolic(out, A, 1.0, k, kc, period, 0.0)
    store_swing(out, Swing(1.0 if swings else 0.0, unit))
    store_course(out, Course(form, start, scaled(f, unit), NOTHING, phase, (0.0, 0.0, 0.0),
                             amplitudes))


@compiled
def _argument(sn, cn, dn):
    """Return u = sn R_F(cn^2, dn^2, 1) (DLMF 19.25.5) for cn, dn >= 0.

    The first duplication of R_F is written out for the sake of 1e-300.
    """
    step = cn * dn + cn + dn
    return sn * carlson_rf(0.25 * (cn * cn + step), 0.25 * (dn * dn + step), 0.25 * (1.0 + step))


@compiled_inline
def _fill_circle(p, begin, out):
    """Fill what takes s and c to the pose, so that the start itself comes out."""
    n = p.unit
    nx, ny, nz = n
    s, c, _ = functions(out, NOTHING)
    q = normalised(*begin.orientation)
    upright = normalised(*multiply(*q, -s * nx, -s * ny, -s * nz, c))
    # the body's origin from the hinge is -through; of that the part across the axis goes round
    across = cross(n, p.through)
    a, b = rotate(*upright, *cross(across, n)), rotate(*upright, *across)
    cosine, sine = (c - s) * (c + s), 2.0 * s * c
    way = vectors.plus(vectors.scaled(cosine, a), vectors.scaled(sine, b))
    store_circle(out, Circle(upright, multiply(*upright, *n, 0.0), n,
                             vectors.plus(begin.position, way), a, b))


@compiled_inline
def steady(course, swing, dt):
    """Return s, c and w (rad/s) at a time, a pair, after the start: uniform rotation."""
    sine, cosine = sin_cos(*phase(*course.half_rate, *dt))
    return sine, cosine, swing.unit * course.amplitudes[0]


@compiled_inline
def circular(course, series, swing, dt):
    """Return s, c and w (rad/s) at a time after the start, by the nome."""
    omega, _, _ = circular_series(course.amplitudes, series, phase_of(course, dt))
    return _sorted(swing, omega)


@compiled_inline
def hyperbolic(course, series, swing, dt):
    """Return s, c and w (rad/s) at a time after the start, by the complementary nome."""
    omega, _, _, _ = hyperbolic_series(course.amplitudes, series, phase_of(course, dt))
    return _sorted(swing, omega)


@compiled_inline
def _sorted(swing, omega):
    """Return s, c and w from the functions that go like cn, sn and dn."""
    like_cn, like_sn, like_dn = omega
    swings = swing.swings != 0.0
    c, w = (like_dn, like_cn) if swings else (like_cn, like_dn)
    return like_sn, c, swing.unit * w


@compiled
def functions(anchor, dt):
    """Return s, c and w (rad/s) at a time after the start, by the form of the motion."""
    course, swing = load_course(anchor), load_swing(anchor)
    if course.form == CIRCULAR:
        return circular(course, load_circular(anchor), swing, dt)
    if course.form == HYPERBOLIC:
        return hyperbolic(course, load_hyperbolic(anchor), swing, dt)
    return steady(course, swing, dt)
