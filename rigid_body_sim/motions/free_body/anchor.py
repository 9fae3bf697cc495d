"""What a free body's motion needs to know before it is evaluated: numbers of the body, and the anchor of its rotation.

What grows with time, the phases v and Omega t/2 of free_rotation.py, has rates with more digits than a double, counted in turns; so the error
does not grow with time beyond what the doubles of the input carry. With Euler's coefficients e1 = (I2 - I3)/I1 and so on in circle, Euler's
equations are omega_1' = e1 omega_2 omega_3 ..., and

    p^2 = -e1 e2 omega_3^2 + e1 e3 omega_2^2,        k^2 p^2 = -e2 e3 omega_1^2 + e1 e3 omega_2^2,        both sums of positive terms,
    k'^2 p^2 = e2 (I3 (I3 - I2) omega_3^2 - I1 (I2 - I1) omega_1^2)/(I1 I3),

the last one decides by its sign which axis is polar: the largest moment's where it is positive or zero, else the smallest's, with 1 and 3
exchanged. It is formed with 32 digits from the input doubles, as are the products of the e. The period follows from agm(1, k') = pi/(2 K),
and chi' = (2 E + L omega_3)/(L + m3) where omega_3 is greatest.
"""

import math
from fractions import Fraction

import numpy as np

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.errors import BadInput
from rigid_body_sim.motions.free_body import rotation
from rigid_body_sim.motions.free_body.rotation import (
    AMPLITUDES,
    CIRCULAR,
    DRIFT,
    FORM,
    HALF,
    HYPERBOLIC,
    KC_HYPERBOLIC,
    PHASE,
    RATE,
    START,
    STEADY,
    UNIT,
    fill_circular,
    fill_hyperbolic,
    turned,
)
from rigid_body_sim.numerics.double_double import (
    add,
    add_alike,
    divide,
    multiply,
    multiply_double,
    root,
    two_product,
)
from rigid_body_sim.numerics.elliptic import agm_pair, carlson_rf_pair, complete_k
from rigid_body_sim.numerics.rotations import multiply as compose
from rigid_body_sim.numerics.rotations import normalised, rotate

# layout of the parameters: the factors of the discriminant, then a block for either choice of the polar axis
GAP_LARGE, GAP_SMALL, GAP, BLOCKS = 0, 2, 4, 6
# layout of a block
MOMENTS, MATRIX, SIDE, HAND, E12, E13, E23, E32, ROOT12, SQUARES, TOWARD = 0, 3, 12, 13, 14, 16, 18, 19, 21, 22, 28
BLOCK_SIZE = 30
PARAMETER_SIZE = BLOCKS + 2 * BLOCK_SIZE

# layout of the anchor behind what free_rotation takes: axes of its frame in the body, matrix of the attitude, what rounding took from omega
# at the start, 1 if the middle component of m reaches L/2
TO_BODY, TO_WORLD, ROUNDING, TUMBLES = (rotation.SIZE + k for k in (0, 9, 25, 28))
SIZE = TUMBLES + 1

TURN, TURN_LOW = 0.15915494309189535, -9.839338337591243e-18        # 1/(2 pi)
LEAST_RATIO = 1e-130            # of a needle's moments
NEVER = 2.0 ** 200              # stands for the infinite period on the separatrix


def rotation_parameters(inertia):
    """Return the numbers of an inertia that the kernels take, shape (PARAMETER_SIZE,).

    Raises
    ------
    BadInput
        A moment that is not zero but so small beside the others that its square would underflow.
    """
    p = np.zeros(PARAMETER_SIZE)
    small, middle, large = order = sorted(range(3), key=inertia.moments.__getitem__)
    if 0.0 < inertia.moments[small] < LEAST_RATIO * inertia.moments[large]:
        raise BadInput('body.inertia', f'moment {inertia.moments[small]!r} beside {inertia.moments[large]!r}',
                       f'at least {LEAST_RATIO} of the largest, or 0 for a rod')
    unit = math.frexp(inertia.moments[large])[1]
    moments = [Fraction(math.ldexp(inertia.moments[k], -unit)) for k in order]
    least, mean, most = moments
    p[GAP_LARGE:GAP_LARGE + 2] = _pair(most * (most - mean))
    p[GAP_SMALL:GAP_SMALL + 2] = _pair(least * (mean - least))
    p[GAP:GAP + 2] = _pair(_quotient(most - least, least * mean * most))
    columns = [rotate(*inertia.axes, *unit_vector) for unit_vector in np.eye(3)]
    _fill_block(p[BLOCKS:], moments, [columns[k] for k in (small, middle, large)], -1.0, 1.0 if (middle - small) % 3 == 1 else -1.0)
    _fill_block(p[BLOCKS + BLOCK_SIZE:], moments[::-1], [columns[k] for k in (large, middle, small)], 1.0,
                1.0 if (middle - large) % 3 == 1 else -1.0)
    return p


def _fill_block(block, moments, columns, side, hand):
    """Fill the numbers that belong to one choice of the axes 1, 2, 3: moments, axes in the body, s, +1 if the axes are right-handed else -1."""
    I1, I2, I3 = moments
    e1, e2, e3 = _quotient(abs(I2 - I3), I1), _quotient(abs(I3 - I1), I2), _quotient(abs(I1 - I2), I3)      # Euler's coefficients
    block[MOMENTS:MOMENTS + 3] = moments
    block[MATRIX:MATRIX + 9] = np.transpose(columns).reshape(-1)
    block[SIDE], block[HAND] = side, hand
    block[E12:E12 + 2], block[E13:E13 + 2], block[E23] = _pair(e1 * e2), _pair(e1 * e3), e2 * e3
    block[E32:E32 + 2], block[ROOT12] = _pair(_quotient(e3, e2)), math.sqrt(_quotient(e1, e2))
    block[SQUARES:SQUARES + 6] = [half for moment in moments for half in _pair(moment * moment)]
    block[TOWARD:TOWARD + 2] = I1 * abs(I3 - I2), I3 * abs(I2 - I1)


def _pair(number):
    """Return an exact number as a pair of doubles."""
    return float(number), float(number - Fraction(float(number)))


def _quotient(a, b):
    """Return a/b, or 0 for b = 0: Euler's coefficients of a rod and of a sphere, where omega does not change."""
    return a / b if b else Fraction(0)


@compiled
def fill_rotation(p, start, out):
    """Precompute the rotation from a state (14 doubles, its time included); the angular velocity along an axis of zero moment must be 0."""
    wx, wy, wz = start[5], start[6], start[7]
    scale, unscale = 1.0, 1.0
    size = max(abs(wx), abs(wy), abs(wz))
    if size < 1e-250:
        scale = 0.0     # it does not turn in 1e240 s; what omega there is, _fill_attitude keeps
    elif size < 1e-70 or size > 1e70:
        # squares would leave the range; powers of two are exact
        exponent = min(math.frexp(size)[1], 960)
        scale, unscale = math.ldexp(1.0, -exponent), math.ldexp(1.0, exponent)
    wx, wy, wz = _normal(scale * wx), _normal(scale * wy), _normal(scale * wz)
    small, _, large = _to_frame(p, BLOCKS, wx, wy, wz)
    gap, gap_low, lift = _discriminant(p, small, large)
    b = BLOCKS
    if gap < 0.0:
        b, gap, gap_low = BLOCKS + BLOCK_SIZE, -gap, -gap_low
    w1, w2, w3 = _to_frame(p, b, wx, wy, wz)
    s1, s3 = math.copysign(1.0, w1), math.copysign(1.0, w3)
    s2 = p[b + HAND] * s1 * s3
    w1, w2, w3 = abs(w1), s2 * w2, abs(w3)
    for row in range(3):
        m, d = b + MATRIX + 3 * row, TO_BODY + 3 * row
        out[d], out[d + 1], out[d + 2] = s1 * p[m], s2 * p[m + 1], s3 * p[m + 2]
    out[START], out[rotation.SIDE], out[TUMBLES] = start[0], p[b + SIDE], 0.0
    x1, x1_low = two_product(w1, w1)
    x2, x2_low = two_product(w2, w2)
    x3, x3_low = two_product(w3, w3)
    p2, p2_low = multiply(p[b + E12], p[b + E12 + 1], x3, x3_low)
    e, e_low = multiply(p[b + E13], p[b + E13 + 1], x2, x2_low)
    p2, p2_low = add_alike(p2, p2_low, e, e_low)
    # with p^2 < 1e-250 (omega being of order 1) omega does not move in the body in 1e120 s, and squares would be near underflow
    steady = p2 < 1e-250 or _is_principal(p, b, w1, w2, w3)
    top, top_low = w3, 0.0
    if not steady:
        e, e_low = multiply(p[b + E32], p[b + E32 + 1], x2, x2_low)
        e, e_low = add_alike(e, e_low, x3, x3_low)
        top, top_low = root(e, e_low)
    L, half, half_low = _momentum_and_rate(p, b, x1, x1_low, x2, x2_low, x3, x3_low, top, top_low)
    if steady:
        out[FORM], out[RATE], out[RATE + 1], out[PHASE] = STEADY, 0.0, 0.0, 0.0
        out[AMPLITUDES], out[AMPLITUDES + 1], out[AMPLITUDES + 2] = w1, w2, w3
    else:
        slope = _fill_periodic(p, b, w1, w2, w3, top, p2, p2_low, gap, gap_low, lift, out)
        half, half_low = add(half, half_low, -slope, 0.0)
        out[TUMBLES] = 1.0 if p[b + MOMENTS + 1] * abs(out[AMPLITUDES + 1]) >= 0.5 * L else 0.0
    out[HALF], out[HALF + 1] = unscale * half, unscale * half_low
    out[RATE], out[RATE + 1] = unscale * out[RATE], unscale * out[RATE + 1]
    per_momentum = scale / L if L > 0.0 else 0.0
    for k in range(3):
        out[AMPLITUDES + k] *= unscale
        out[UNIT + k] = per_momentum * p[b + MOMENTS + k]
    _fill_attitude(start, out)


@compiled_inline
def _normal(w):
    """Return w, or 0 where it is next to the subnormal numbers, which have fewer digits."""
    return w if abs(w) > 1e-304 else 0.0


@compiled_inline
def _to_frame(p, b, wx, wy, wz):
    """Return the components along the axes 1, 2, 3 of the block at b, before their signs are chosen."""
    m = b + MATRIX
    return (p[m] * wx + p[m + 3] * wy + p[m + 6] * wz, p[m + 1] * wx + p[m + 4] * wy + p[m + 7] * wz,
            p[m + 2] * wx + p[m + 5] * wy + p[m + 8] * wz)


@compiled
def _discriminant(p, small, large):
    """Return k'^2 p^2 / lift^2 as a pair, positive if the largest moment's axis is polar, and lift, which keeps tiny numbers from underflow."""
    lift, size = 1.0, max(abs(small), abs(large))
    if size < 1e-70 and size > 0.0:
        lift = math.ldexp(1.0, max(math.frexp(size)[1], -1000))
    small, large = small / lift, large / lift
    x, x_low = two_product(large, large)
    x, x_low = multiply(p[GAP_LARGE], p[GAP_LARGE + 1], x, x_low)
    y, y_low = two_product(small, small)
    y, y_low = multiply(p[GAP_SMALL], p[GAP_SMALL + 1], y, y_low)
    x, x_low = add(x, x_low, -y, -y_low)
    x, x_low = multiply(p[GAP], p[GAP + 1], x, x_low)
    return x, x_low, lift


@compiled_inline
def _is_principal(p, b, w1, w2, w3):
    """Return whether omega lies along a principal axis, so that nothing turns in the body."""
    I1, I2, I3 = p[b + MOMENTS], p[b + MOMENTS + 1], p[b + MOMENTS + 2]
    return not ((w1 != 0.0 and w2 != 0.0 and I1 != I2) or (w2 != 0.0 and w3 != 0.0 and I2 != I3) or (w3 != 0.0 and w1 != 0.0 and I3 != I1))


@compiled
def _momentum_and_rate(p, b, x1, x1_low, x2, x2_low, x3, x3_low, top, top_low):
    """Return L and, as a pair, chi'/2 = (2 E + L omega_3)/(L + m3)/2 in turns where omega_3 = top; x are the squares of omega."""
    s, m = b + SQUARES, b + MOMENTS
    L, L_low = multiply(p[s], p[s + 1], x1, x1_low)
    y, y_low = multiply(p[s + 2], p[s + 3], x2, x2_low)
    L, L_low = add_alike(L, L_low, y, y_low)
    y, y_low = multiply(p[s + 4], p[s + 5], x3, x3_low)
    L, L_low = root(*add_alike(L, L_low, y, y_low))
    if L == 0.0:
        return 0.0, 0.0, 0.0
    rate, rate_low = multiply_double(x1, x1_low, p[m])
    y, y_low = multiply_double(x2, x2_low, p[m + 1])
    rate, rate_low = add_alike(rate, rate_low, y, y_low)
    y, y_low = multiply_double(x3, x3_low, p[m + 2])
    rate, rate_low = add_alike(rate, rate_low, y, y_low)
    y, y_low = multiply(L, L_low, top, top_low)
    rate, rate_low = add_alike(rate, rate_low, y, y_low)
    y, y_low = multiply_double(top, top_low, p[m + 2])
    y, y_low = add_alike(y, y_low, L, L_low)
    rate, rate_low = divide(rate, rate_low, y, y_low)
    rate, rate_low = multiply(rate, rate_low, 0.5 * TURN, 0.5 * TURN_LOW)
    return L, rate, rate_low


@compiled
def _fill_periodic(p, b, w1, w2, w3, top, p2, p2_low, gap, gap_low, lift, out):
    """Fill rate and phase of v and the series; return what the series contribute to the rate of the half angle (turns) at v = 0."""
    a, c = w1, p[b + ROOT12] * abs(w2)
    larger, ratio = max(a, c), min(a, c) / max(a, c)
    A1 = larger * math.sqrt(1.0 + ratio * ratio)
    A2 = -p[b + SIDE] * A1 / p[b + ROOT12]
    x, x_low = root(p2, p2_low)
    kc, kc_low = divide(*root(gap, gap_low), x, x_low)
    kc, kc_low = lift * kc, lift * kc_low
    k2 = min((p[b + E23] * w1 * w1 + p[b + E13] * w2 * w2) / p2, 1.0)
    # u = sn R_F(cn^2, dn^2, 1) (DLMF 19.25.5), its first duplication written out for the sake of cn and dn of 1e-300;
    # the other one is K' less the argument a of the body's own constant: F of the complementary amplitude (DLMF 19.7(iii))
    cn, sn, dn = w1 / A1, w2 / A2, w3 / top
    step = cn * dn + cn + dn
    to_1, to_3 = k2 * p[b + TOWARD], p[b + TOWARD + 1]
    u, shift = carlson_rf_pair(0.25 * (cn * cn + step), 0.25 * (dn * dn + step), 0.25 * (1.0 + step),
                               to_1 if to_1 > 0.0 else 1.0, to_1 + k2 * to_3 if to_1 > 0.0 else 1.0, to_1 + to_3 if to_1 > 0.0 else 1.0)
    u *= sn
    shift *= math.sqrt(to_3) if to_1 > 0.0 else 0.0
    f, f_low = x / (2.0 * NEVER), x_low / (2.0 * NEVER)
    if kc > 0.0:
        f, f_low = agm_pair(1.0, 0.0, kc, kc_low)
        f, f_low = multiply(*multiply(f, f_low, x, x_low), TURN, TURN_LOW)
    out[RATE], out[RATE + 1], out[PHASE] = f, f_low, f * u / x
    if kc >= KC_HYPERBOLIC:
        out[FORM] = CIRCULAR
        return f * fill_circular(out, A1, A2, top, k2, kc, 0.25 * x / f, shift)
    k = math.sqrt(k2)
    period = 0.25 * math.pi * x / (f * complete_k(k)) if kc > 0.0 else NEVER
    out[FORM] = HYPERBOLIC
    return f * (period * fill_hyperbolic(out, A1, A2, top, k, kc, period, shift) / math.pi - out[DRIFT])


@compiled
def _fill_attitude(start, out):
    """Fill the matrix that takes the quaternion of Z S to the body's attitude, and what is missing in omega at the start.

    The missing ulp or so is added to omega at all times. Then the start comes back to the last bit, and in a motion that is anchored anew at
    every tick energy and momentum walk at random: what the formulas round to one side cancels between two evaluations.
    """
    w1, w2, w3, x, y, z, w = turned(out, 0.0, 0.0)
    m = TO_BODY
    for k in range(3):
        out[ROUNDING + k] = start[5 + k] - (out[m + 3 * k] * w1 + out[m + 3 * k + 1] * w2 + out[m + 3 * k + 2] * w3)
    bx, by, bz = (out[m] * x + out[m + 1] * y + out[m + 2] * z, out[m + 3] * x + out[m + 4] * y + out[m + 5] * z,
                  out[m + 6] * x + out[m + 7] * y + out[m + 8] * z)
    x, y, z, w = normalised(*compose(start[1], start[2], start[3], start[4], -bx, -by, -bz, w))
    for k in range(3):
        column = compose(x, y, z, w, out[m + k], out[m + 3 + k], out[m + 6 + k], 0.0)
        for row in range(4):
            out[TO_WORLD + 4 * row + k] = column[row]
    out[TO_WORLD + 3], out[TO_WORLD + 7], out[TO_WORLD + 11], out[TO_WORLD + 15] = x, y, z, w
