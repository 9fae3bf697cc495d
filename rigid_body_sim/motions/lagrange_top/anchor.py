"""The anchor of a heavy symmetric top: everything about its motion that one state decides (symbols: lagrange_top.py)."""

import math

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.motions.lagrange_top.means import NEVER, mean_rates
from rigid_body_sim.motions.lagrange_top.roots import (
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
    turning_points,
)
from rigid_body_sim.motions.lagrange_top.theta import (
    FORM_SIZE,
    circular,
    hyperbolic,
    set_circular,
    set_hyperbolic,
    set_nome,
)
from rigid_body_sim.numerics.double_double import two_sum
from rigid_body_sim.numerics.elliptic import carlson_rf_pair, complete_k, nome, root_nome
from rigid_body_sim.numerics.functions import atan2, exp
from rigid_body_sim.numerics.pairs import TURN, minus, plus, put, scaled, times
from rigid_body_sim.numerics.phase import nearest, phase, sin_cos

# layout: the theta functions; phase of nutation (a turn is a period) and phases of a and b (turns): value at the start, rate
START, START_A, START_B, RATE, RATE_A, RATE_B = FORM_SIZE, FORM_SIZE + 1, FORM_SIZE + 2, FORM_SIZE + 3, FORM_SIZE + 5, FORM_SIZE + 7
# hyperbolic phase per turn of nutation; phases of a and b (turns) per unit of it; 1 for an odd position at the start; see `functions`
IS_HYPERBOLIC, STRETCH, DRIFT_A, DRIFT_B, PARITY, SIDE, WINDING, NUTATES = range(FORM_SIZE + 9, FORM_SIZE + 17)
ROOTS = FORM_SIZE + 17      # what `turning_points` fills
NUTATION_SIZE = ROOTS + SIZE

QUARTER_TURN = 0.5 * math.pi
NOTICED = 1e-9
TINY = 1e-60            # a tilt and swing below this follow linear equations, to far below round-off


@compiled_inline
def circular_functions(anchor, time, time_low):
    """Return real and imaginary part of a, b and omega_c at a time (s) after the start, the steady spin omega_3 - n included."""
    turns, low = phase(anchor[RATE], anchor[RATE + 1], time, time_low)
    turns_a, low_a = phase(anchor[RATE_A], anchor[RATE_A + 1], time, time_low)
    turns_b, low_b = phase(anchor[RATE_B], anchor[RATE_B + 1], time, time_low)
    c1, s1, ar, ai, br, bi, wr, wi = circular(anchor, turns + anchor[START], low)
    winding = anchor[WINDING]
    return _with_phases(anchor, ar, ai, br, bi, wr, wi, turns_a, low_a, turns_b, low_b, c1 if winding != 0.0 else 1.0, winding * s1)


@compiled_inline
def hyperbolic_functions(anchor, time, time_low):
    """Return what :func:`circular_functions` returns: hyperbolic form."""
    turns, low = phase(anchor[RATE], anchor[RATE + 1], time, time_low)
    turns_a, low_a = phase(anchor[RATE_A], anchor[RATE_A + 1], time, time_low)
    turns_b, low_b = phase(anchor[RATE_B], anchor[RATE_B + 1], time, time_low)
    turns, more = two_sum(turns, anchor[START])
    turns -= nearest(turns)
    # half a period on, the highest position stands for the lowest; the phases' mean rates are in RATE_A, RATE_B
    half_turns = nearest(2.0 * turns)
    odd = abs(half_turns)
    along = anchor[STRETCH] * ((turns - 0.5 * half_turns) + (more + low))
    ar, ai, br, bi, wr, wi = hyperbolic(anchor, along, odd != anchor[PARITY])
    return _with_phases(anchor, ar, ai, br, bi, wr, wi, turns_a - anchor[DRIFT_A] * along, low_a, turns_b - anchor[DRIFT_B] * along, low_b,
                        1.0 - 2.0 * odd * anchor[WINDING], 0.0)


@compiled_inline
def _with_phases(anchor, ar, ai, br, bi, wr, wi, turns_a, low_a, turns_b, low_b, turn_re, turn_im):
    """Multiply a, b and omega_c by their phase factors; that of omega_c is i SIDE conj(e_a) e_b times the winding."""
    sa, ca = sin_cos(turns_a + anchor[START_A], low_a)
    sb, cb = sin_cos(turns_b + anchor[START_B], low_b)
    cd, sd = anchor[SIDE] * (ca * cb + sa * sb), anchor[SIDE] * (ca * sb - sa * cb)
    to_re, to_im = -(sd * turn_re + cd * turn_im), cd * turn_re - sd * turn_im
    return (ar * ca - ai * sa, ar * sa + ai * ca,
            br * cb - bi * sb, br * sb + bi * cb,
            wr * to_re - wi * to_im, wr * to_im + wi * to_re)


@compiled
def functions(anchor, time, time_low):
    """Return what :func:`circular_functions` returns, by the form that the motion has."""
    if anchor[IS_HYPERBOLIC] == 0.0:
        return circular_functions(anchor, time, time_low)
    return hyperbolic_functions(anchor, time, time_low)


@compiled
def anchor_nutation(a_re, a_im, b_re, b_im, o_re, o_im, n, k, own_spin, anchor):
    """Fill the anchor from Cayley-Klein parameters (of any norm) and omega_c (rad/s).

    Parameters
    ----------
    n, k, own_spin : pair of floats (double_double.py)
        I3 omega_3/I1 (rad/s), M g h/I1 (1/s^2, not negative), omega_3 - n (rad/s).
    """
    if o_re == 0.0 and o_im == 0.0 and n[0] == 0.0 and (k[0] == 0.0 or (a_re == 0.0 and a_im == 0.0) or (b_re == 0.0 and b_im == 0.0)):
        _rest(a_re, a_im, b_re, b_im, anchor)
        return
    # powers of two are exact: in the unit of time used here rates are of order 1, and a tiny tilt and swing are TINY
    largest = max(max(abs(n[0]), 2.0 * math.sqrt(k[0])), max(abs(o_re), abs(o_im)))
    rate_unit = math.ldexp(1.0, min(max(math.frexp(largest)[1], -900), 900)) if largest > 0.0 else 1.0
    n, k = scaled(n, 1.0 / rate_unit), scaled(scaled(k, 1.0 / rate_unit), 1.0 / rate_unit)
    o_re, o_im = o_re / rate_unit, o_im / rate_unit
    standing = b_re * b_re + b_im * b_im <= a_re * a_re + a_im * a_im
    tilt, swing = max(abs(b_re), abs(b_im)) if standing else max(abs(a_re), abs(a_im)), max(abs(o_re), abs(o_im))
    own = max(abs(n[0]), 2.0 * math.sqrt(k[0]))
    scale = _scale(max(tilt, swing / own)) if own > 0.0 else 1.0
    unit_a, unit_b = (1.0, scale) if standing else (scale, 1.0)
    roots = anchor[ROOTS:NUTATION_SIZE]
    turning_points(a_re / unit_a, a_im / unit_a, b_re / unit_b, b_im / unit_b, unit_a, unit_b, o_re / scale, o_im / scale, n, k, roots)
    mean, nutation, rate_a, rate_b = mean_rates(roots, scale if roots[SEPARATE] == 1.0 else 1.0)

    side_a = 1.0 if roots[SIGMA] >= 0.0 else -1.0
    side_b = 1.0 if roots[DELTA] >= 0.0 else -1.0
    side_w = -1.0 if roots[CHI] >= 0.0 else 1.0
    # c at u1: from the pole that is near, or its sign is that of a rounding error
    lowest = roots[SIGMA] - n[0] * roots[X1] if roots[X1] < 0.5 * roots[X] else roots[C] + n[0] * roots[LOWER]
    anchor[SIDE] = 1.0 if lowest >= 0.0 else -1.0
    swing_unit = rate_unit * scale
    if roots[SEPARATE] == 0.0:
        _circular(roots, n[0], k[0], mean, unit_a, unit_b, swing_unit, side_a, side_b, side_w, rate_b[0] - rate_a[0], anchor)
    else:
        _hyperbolic(roots, k[0], mean, scale, rate_unit, side_a, side_b, side_w, anchor)
    rate_a = times(plus(scaled(rate_a, rate_unit), scaled(own_spin, 0.5)), TURN)
    rate_b = times(minus(scaled(rate_b, rate_unit), scaled(own_spin, 0.5)), TURN)
    # counted as nutation (an event) if u' ever comes near NOTICED times the angular velocity
    steepest = math.sqrt(roots[WIDE]) * roots[GAP] * (scale * scale if roots[SEPARATE] == 0.0 else 1.0)
    fastest = math.sqrt(roots[W1]) + abs(n[0] + own_spin[0] / rate_unit)
    anchor[NUTATES] = 1.0 if steepest > NOTICED * fastest and nutation[0] > 0.0 else 0.0
    put(anchor, RATE, scaled(nutation, rate_unit))
    put(anchor, RATE_A, rate_a)
    put(anchor, RATE_B, rate_b)

    # phases at the start: from those two of the three functions that are farthest from their zeros there
    anchor[START_A], anchor[START_B] = 0.0, 0.0
    ar, ai, br, bi, wr, wi = functions(anchor, 0.0, 0.0)
    phase_a, phase_b, phase_w = _angle(a_re, a_im, ar, ai), _angle(b_re, b_im, br, bi), _angle(o_re, o_im, wr, wi)
    share_a, share_b, share_w = quotient(roots[X], roots[X2]), quotient(roots[Y], roots[Y1]), quotient(roots[W], roots[W1])
    if share_a < min(share_b, share_w):
        phase_a = phase_b - phase_w
    elif share_b < min(share_a, share_w):
        phase_b = phase_a + phase_w
    anchor[START_A], anchor[START_B] = phase_a - nearest(phase_a), phase_b - nearest(phase_b)


@compiled
def _rest(a_re, a_im, b_re, b_im, anchor):
    """Fill the anchor of a top at rest that stays so: upright, hanging, or without weight. Every attitude is a root of its own there."""
    for place in range(NUTATION_SIZE):
        anchor[place] = 0.0
    norm = math.sqrt(a_re * a_re + a_im * a_im + b_re * b_re + b_im * b_im)
    set_nome(0.0, anchor)
    set_circular(anchor, 0, 0.0, -1.0, 1.0, math.sqrt(a_re * a_re + a_im * a_im) / norm)
    set_circular(anchor, 1, 0.0, 1.0, 1.0, math.sqrt(b_re * b_re + b_im * b_im) / norm)
    set_circular(anchor, 2, 0.0, 1.0, 1.0, 0.0)
    anchor[SIDE], anchor[START_A], anchor[START_B] = 1.0, _angle(a_re, a_im, 1.0, 0.0), _angle(b_re, b_im, 1.0, 0.0)


@compiled
def _angle(to_re, to_im, from_re, from_im):
    """Return the angle (turns) from one complex number to another; their moduli may be as small as doubles go."""
    to, back = max(abs(to_re), abs(to_im)), max(abs(from_re), abs(from_im))
    if to == 0.0 or back == 0.0:
        return 0.0
    to_re, to_im, from_re, from_im = to_re / to, to_im / to, from_re / back, from_im / back
    return TURN[0] * atan2(to_im * from_re - to_re * from_im, to_re * from_re + to_im * from_im)


@compiled
def quotient(a, b):
    """Return a / b, or 0 where b is 0."""
    return a / b if b != 0.0 else 0.0


@compiled
def _scale(size):
    """Return the power of two that takes a tilt and swing of this size up to TINY; 1 if it is larger, or zero."""
    if size >= TINY or size == 0.0:
        return 1.0
    _, exponent = math.frexp(size / TINY)
    return math.ldexp(1.0, exponent)


@compiled
def _lengths(square, x, y, z, other, u, v, w):
    """Return sqrt(square) R_F(x, y, z) and sqrt(other) R_F(u, v, w), infinite where two arguments of R_F vanish, 0 where the root does."""
    first, second = min(x + y, y + z, x + z) > 0.0, min(u + v, v + w, u + w) > 0.0
    R, S = carlson_rf_pair(x if first else 1.0, y if first else 1.0, z if first else 1.0,
                           u if second else 1.0, v if second else 1.0, w if second else 1.0)
    return (0.0 if square == 0.0 else math.sqrt(square) * R if first else math.inf,
            0.0 if other == 0.0 else math.sqrt(other) * S if second else math.inf)


@compiled
def _arguments(roots, k, from_lowest):
    """Return, as arguments of Jacobi's functions, the places of the zeros of a, b, omega_c in imaginary time and of the state in real time.

    That of a is counted from u1, those of b and omega_c from u2, that of the state from u1 if `from_lowest`, else from u2.
    """
    gap, wide, narrow, lower, upper, above = roots[GAP], roots[WIDE], roots[NARROW], roots[LOWER], roots[UPPER], roots[ABOVE]
    if gap == 0.0:    # steady: none has a zero, also where it is 0 all the time
        return math.inf, math.inf, math.inf, 0.0
    gap2 = 2.0 * k * gap
    if from_lowest:
        A, along = _lengths(roots[X1], gap, gap * roots[X3] / wide, roots[X2], lower, upper, above * gap / wide, gap)
    else:
        A, along = _lengths(roots[X1], gap, gap * roots[X3] / wide, roots[X2], upper * wide, lower * narrow, narrow * gap, gap * above)
    B, C_ = _lengths(roots[Y2] * wide, roots[Y3] * gap, gap * narrow, roots[Y1] * narrow,
                     roots[W2] * wide, roots[W3] * gap2, gap2 * narrow, roots[W1] * narrow)
    return A, B, C_, along


@compiled
def _circular(roots, n, k, mean, unit_a, unit_b, unit_w, side_a, side_b, side_w, rate_difference, anchor):
    gap, wide = roots[GAP], roots[WIDE]
    per_argument = 2.0 * mean                               # 2v of an argument of Jacobi's functions
    set_nome(nome(math.sqrt(2.0 * k * gap / wide), math.sqrt(roots[NARROW] / wide)), anchor)
    A, B, C_, along = _arguments(roots, k, True)
    set_circular(anchor, 0, exp(-per_argument * A), -1.0, side_a, unit_a * math.sqrt(0.5 * roots[X2]))
    set_circular(anchor, 1, exp(-per_argument * B), 1.0, side_b, unit_b * math.sqrt(0.5 * roots[Y1]))
    slope_w = set_circular(anchor, 2, exp(-per_argument * C_), 1.0, side_w, unit_w * math.sqrt(roots[W1]))
    # mean rate of arg(omega_c), from its rate at u1, less that of conj(a) b: a whole multiple of the rate of 2v
    at_lowest = -0.5 * (n + quotient(roots[CHI], roots[W1]))
    rate = 0.5 * math.sqrt(wide) * per_argument
    anchor[WINDING] = nearest((at_lowest - rate_difference) / rate + slope_w) if roots[STEADY] == 0.0 else 0.0
    anchor[START], anchor[PARITY], anchor[IS_HYPERBOLIC] = TURN[0] * per_argument * math.copysign(along, roots[RISE]), 0.0, 0.0
    anchor[STRETCH], anchor[DRIFT_A], anchor[DRIFT_B] = 0.0, 0.0, 0.0


@compiled
def _hyperbolic(roots, k, mean, scale, rate_unit, side_a, side_b, side_w, anchor):
    wide, narrow = roots[WIDE], roots[NARROW]
    modulus, complement = math.sqrt(2.0 * k * roots[GAP] / wide), scale * math.sqrt(narrow / wide)
    per_argument = QUARTER_TURN / complete_k(modulus)       # hyperbolic phase of an argument of Jacobi's functions
    half_period = per_argument * QUARTER_TURN / mean if mean > 0.0 else NEVER
    root = root_nome(complement, modulus)
    set_nome(root * root, anchor)
    from_lowest = scale * roots[UPPER] * math.sqrt(wide) >= math.sqrt(narrow) * roots[LOWER]     # nearer in time than the highest position
    A, B, C_, along = _arguments(roots, k, from_lowest)
    A, B, C_ = min(per_argument * A, QUARTER_TURN), min(per_argument * B, QUARTER_TURN), min(per_argument * C_, QUARTER_TURN)
    set_hyperbolic(anchor, 0, A, -1.0, side_a, math.sqrt(0.5 * roots[X2]), root)
    set_hyperbolic(anchor, 1, B, 1.0, side_b, math.sqrt(0.5 * roots[Y1]), root)
    set_hyperbolic(anchor, 2, C_, 1.0, side_w, rate_unit * math.sqrt(roots[W1]), root)
    # from the lowest to the highest position the phases make a step beside their steady growth; that of omega_c is that of b less that of
    # a, up to half a turn
    step_a, step_b, step_w = side_a * (QUARTER_TURN - A), side_b * (QUARTER_TURN - B), side_w * (QUARTER_TURN - C_)
    anchor[STRETCH], anchor[DRIFT_A], anchor[DRIFT_B] = 2.0 * half_period, TURN[0] * step_a / half_period, TURN[0] * step_b / half_period
    half_turns = nearest((step_w - step_b + step_a) / math.pi)
    anchor[WINDING] = half_turns - 2.0 * math.floor(0.5 * half_turns)
    anchor[PARITY], argument = 0.0, math.copysign(along, roots[RISE])
    if not from_lowest:
        anchor[PARITY], argument = 1.0, -argument
        anchor[SIDE] *= 1.0 - 2.0 * anchor[WINDING]
    anchor[START], anchor[IS_HYPERBOLIC] = per_argument * argument / anchor[STRETCH], 1.0
