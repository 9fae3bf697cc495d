"""The anchor of a heavy symmetric top: everything about its motion that one state decides (symbols: lagrange_top.py)."""

import math

import numpy as np

from rigid_body_sim.compiled import compiled
from rigid_body_sim.elliptic import carlson_rf, complete_k, nome
from rigid_body_sim.motions.lagrange_top_roots import (
    ABOVE,
    CHI,
    DELTA,
    GAP,
    LOWER,
    NARROW,
    RISE,
    SEPARATE,
    SIGMA,
    SIZE,
    STEADY,
    UPPER,
    W1,
    W2,
    W3,
    WIDE,
    X1,
    X2,
    X3,
    Y1,
    Y2,
    Y3,
    C,
    W,
    X,
    Y,
    quotient,
    turning_points,
)
from rigid_body_sim.motions.lagrange_top_theta import FORM_SIZE, circular, hyperbolic, set_circular, set_hyperbolic, set_nome

# layout: the theta functions; phase of nutation, phases of a and b: value at the start, rate
PHASE, RATE, HALF_PERIOD, INVERSE, PARITY = range(FORM_SIZE, FORM_SIZE + 5)
PHASE_A, RATE_A, SHIFT_A, PHASE_B, RATE_B, SHIFT_B = range(FORM_SIZE + 5, FORM_SIZE + 11)
IS_HYPERBOLIC, SIDE, WINDING = range(FORM_SIZE + 11, FORM_SIZE + 14)
NUTATION_SIZE = FORM_SIZE + 14

QUARTER_TURN = 0.5 * math.pi
TINY = 1e-60        # a tilt and swing below this follow linear equations, to far below round-off


@compiled
def functions(anchor, elapsed):
    """Return real and imaginary part of a, b and omega_c at a time (s) from the start, the steady spin omega_3 - n included."""
    phase = anchor[PHASE] + anchor[RATE] * elapsed
    phase_a = anchor[PHASE_A] + anchor[RATE_A] * elapsed
    phase_b = anchor[PHASE_B] + anchor[RATE_B] * elapsed
    if anchor[IS_HYPERBOLIC] == 0.0:
        c1, s1, ar, ai, br, bi, wr, wi = circular(anchor, phase)
        turn_re = c1 if anchor[WINDING] != 0.0 else 1.0
        turn_im = anchor[WINDING] * s1
    else:
        half_periods = math.floor(phase * anchor[INVERSE] + 0.5)
        phase_a += half_periods * anchor[SHIFT_A]
        phase_b += half_periods * anchor[SHIFT_B]
        odd = half_periods - 2.0 * math.floor(0.5 * half_periods)
        ar, ai, br, bi, wr, wi = hyperbolic(anchor, phase - half_periods * anchor[HALF_PERIOD], odd != anchor[PARITY])
        turn_re, turn_im = 1.0 - 2.0 * odd * anchor[WINDING], 0.0
    ca, sa, cb, sb = math.cos(phase_a), math.sin(phase_a), math.cos(phase_b), math.sin(phase_b)
    # omega_c: i SIDE conj(e_a) e_b times the winding
    cd, sd = anchor[SIDE] * (ca * cb + sa * sb), anchor[SIDE] * (ca * sb - sa * cb)
    to_re, to_im = -(sd * turn_re + cd * turn_im), cd * turn_re - sd * turn_im
    return (ar * ca - ai * sa, ar * sa + ai * ca,
            br * cb - bi * sb, br * sb + bi * cb,
            wr * to_re - wi * to_im, wr * to_im + wi * to_re)


@compiled
def anchor_nutation(a_re, a_im, b_re, b_im, o_re, o_im, n, k, own_spin, anchor):
    """Fill the anchor from Cayley-Klein parameters (of modulus 1) and omega_c (rad/s).

    Parameters
    ----------
    n, k : float
        I3 omega_3/I1 (rad/s) and M g h/I1 (1/s^2, not negative).
    own_spin : float
        omega_3 - n, rad/s.
    """
    standing = b_re * b_re + b_im * b_im <= a_re * a_re + a_im * a_im
    tilt = max(abs(b_re), abs(b_im)) if standing else max(abs(a_re), abs(a_im))
    swing = max(abs(o_re), abs(o_im))
    scale = _scale(max(tilt, swing / math.sqrt(n * n + 4.0 * k))) if n * n + 4.0 * k > 0.0 else 1.0
    for_a, for_b = (1.0, scale) if standing else (scale, 1.0)
    roots = np.empty(SIZE)
    turning_points(a_re / for_a, a_im / for_a, b_re / for_b, b_im / for_b, o_re / scale, o_im / scale, n, k, roots)

    side_a = 1.0 if roots[SIGMA] >= 0.0 else -1.0
    side_b = 1.0 if roots[DELTA] >= 0.0 else -1.0
    side_w = -1.0 if roots[CHI] >= 0.0 else 1.0
    # c at u1: from the pole that is near, or its sign is that of a rounding error
    lowest = roots[SIGMA] - n * roots[X1] if roots[X1] < 0.5 * roots[X] else roots[C] + n * roots[LOWER]
    anchor[SIDE] = 1.0 if lowest >= 0.0 else -1.0
    if roots[SEPARATE] == 0.0:
        _circular(roots, n, k, for_a, for_b, scale, side_a, side_b, side_w, anchor)
    else:
        _hyperbolic(roots, k, scale, side_a, side_b, side_w, anchor)
    anchor[RATE_A] += 0.5 * own_spin
    anchor[RATE_B] -= 0.5 * own_spin

    # phases at the start: from those two of the three functions that are farthest from their zeros there
    anchor[PHASE_A], anchor[PHASE_B] = 0.0, 0.0
    ar, ai, br, bi, wr, wi = functions(anchor, 0.0)
    phase_a = math.atan2(a_im, a_re) - math.atan2(ai, ar)
    phase_b = math.atan2(b_im, b_re) - math.atan2(bi, br)
    phase_w = math.atan2(o_im, o_re) - math.atan2(wi, wr)
    share_a, share_b, share_w = quotient(roots[X], roots[X2]), quotient(roots[Y], roots[Y1]), quotient(roots[W], roots[W1])
    if share_a < min(share_b, share_w):
        phase_a = phase_b - phase_w
    elif share_b < min(share_a, share_w):
        phase_b = phase_a + phase_w
    anchor[PHASE_A], anchor[PHASE_B] = phase_a, phase_b


@compiled
def _scale(size):
    """Return the power of two that takes a tilt and swing of this size up to TINY; 1 if it is larger, or zero."""
    if size >= TINY or size == 0.0:
        return 1.0
    _, exponent = math.frexp(size / TINY)
    return math.ldexp(1.0, exponent)


@compiled
def _shift(square, x, y, z):
    """Return sqrt(square) R_F(x, y, z), infinite where two of x, y, z vanish."""
    if square == 0.0:
        return 0.0
    if min(x + y, y + z, x + z) == 0.0:
        return math.inf
    return math.sqrt(square) * carlson_rf(x, y, z)


@compiled
def _shifts(roots, k):
    """Return how far the zeros of a (from u1), b and omega_c (from u2) lie along imaginary time, in arguments of Jacobi's functions."""
    gap, wide, narrow = roots[GAP], roots[WIDE], roots[NARROW]
    gap2 = 2.0 * k * gap
    return (_shift(roots[X1], gap, gap * roots[X3] / wide, roots[X2]),
            _shift(roots[Y2] * wide, roots[Y3] * gap, gap * narrow, roots[Y1] * narrow),
            _shift(roots[W2] * wide, roots[W3] * gap2, gap2 * narrow, roots[W1] * narrow))


@compiled
def _circular(roots, n, k, for_a, for_b, scale, side_a, side_b, side_w, anchor):
    gap, wide = roots[GAP], roots[WIDE]
    modulus, complement = math.sqrt(2.0 * k * gap / wide), math.sqrt(roots[NARROW] / wide)
    per_argument = QUARTER_TURN / complete_k(complement)
    set_nome(nome(modulus, complement), anchor)
    A, B, C_ = _shifts(roots, k)
    rate = 0.5 * math.sqrt(wide) * per_argument if roots[STEADY] == 0.0 else 0.0
    slope_a = set_circular(anchor, 0, math.exp(-2.0 * per_argument * A), -1.0, side_a, for_a * math.sqrt(0.5 * roots[X2]))
    slope_b = set_circular(anchor, 1, math.exp(-2.0 * per_argument * B), 1.0, side_b, for_b * math.sqrt(0.5 * roots[Y1]))
    slope_w = set_circular(anchor, 2, math.exp(-2.0 * per_argument * C_), 1.0, side_w, scale * math.sqrt(roots[W1]))
    anchor[RATE_A] = 0.5 * quotient(roots[SIGMA], roots[X2]) + rate * slope_a
    anchor[RATE_B] = 0.5 * quotient(roots[DELTA], roots[Y1]) + rate * slope_b
    at_lowest = -0.5 * (n + quotient(roots[CHI], roots[W1]))        # arg(omega_c)' at u1
    anchor[WINDING] = math.floor(quotient(at_lowest + rate * slope_w - anchor[RATE_B] + anchor[RATE_A], 2.0 * rate) + 0.5)
    anchor[PHASE] = 0.0
    if gap > 0.0:
        argument = math.sqrt(roots[LOWER]) * carlson_rf(roots[UPPER], roots[ABOVE] * gap / wide, gap)
        anchor[PHASE] = math.copysign(per_argument * argument, roots[RISE])
    anchor[RATE], anchor[HALF_PERIOD], anchor[INVERSE], anchor[PARITY] = rate, QUARTER_TURN, 1.0 / QUARTER_TURN, 0.0
    anchor[SHIFT_A], anchor[SHIFT_B], anchor[IS_HYPERBOLIC] = 0.0, 0.0, 0.0


@compiled
def _hyperbolic(roots, k, scale, side_a, side_b, side_w, anchor):
    gap, wide, narrow, lower, upper = roots[GAP], roots[WIDE], roots[NARROW], roots[LOWER], roots[UPPER]
    complement = scale * math.sqrt(narrow / wide)
    per_argument = QUARTER_TURN / complete_k(math.sqrt(2.0 * k * gap / wide))
    anchor[HALF_PERIOD], anchor[INVERSE] = 0.0, 0.0         # on the separatrix there is no second turning point
    root_nome = 0.0
    if complement > 0.0:
        anchor[HALF_PERIOD] = per_argument * complete_k(complement)
        anchor[INVERSE] = 1.0 / anchor[HALF_PERIOD]
        root_nome = math.exp(-anchor[HALF_PERIOD])
    set_nome(root_nome * root_nome, anchor)
    A, B, C_ = _shifts(roots, k)
    A, B, C_ = min(per_argument * A, QUARTER_TURN), min(per_argument * B, QUARTER_TURN), min(per_argument * C_, QUARTER_TURN)
    rate = 0.5 * math.sqrt(wide) * per_argument
    slope_a = set_hyperbolic(anchor, 0, A, -1.0, side_a, math.sqrt(0.5 * roots[X2]), root_nome)
    slope_b = set_hyperbolic(anchor, 1, B, 1.0, side_b, math.sqrt(0.5 * roots[Y1]), root_nome)
    set_hyperbolic(anchor, 2, C_, 1.0, side_w, math.sqrt(roots[W1]), root_nome)
    anchor[RATE_A] = 0.5 * roots[SIGMA] / roots[X2] + rate * slope_a
    anchor[RATE_B] = 0.5 * roots[DELTA] / roots[Y1] + rate * slope_b
    anchor[SHIFT_A], anchor[SHIFT_B] = side_a * (QUARTER_TURN - A), side_b * (QUARTER_TURN - B)
    # the shift of omega_c is that of b less that of a, up to half a turn
    half_turns = math.floor((side_w * (QUARTER_TURN - C_) - anchor[SHIFT_B] + anchor[SHIFT_A]) / math.pi + 0.5)
    anchor[WINDING] = half_turns - 2.0 * math.floor(0.5 * half_turns)
    if scale * upper * math.sqrt(wide) >= math.sqrt(narrow) * lower:     # nearer in time to the lowest position than to the highest
        anchor[PARITY] = 0.0
        argument = math.copysign(math.sqrt(lower) * carlson_rf(upper, roots[ABOVE] * gap / wide, gap), roots[RISE])
    else:
        anchor[PARITY] = 1.0
        anchor[SIDE] *= 1.0 - 2.0 * anchor[WINDING]
        argument = -math.copysign(math.sqrt(upper * wide) * carlson_rf(lower * narrow, narrow * gap, gap * roots[ABOVE]), roots[RISE])
    anchor[PHASE], anchor[RATE], anchor[IS_HYPERBOLIC] = per_argument * argument, rate, 1.0
