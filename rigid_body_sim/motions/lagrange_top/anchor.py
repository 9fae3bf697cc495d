# SPDX-License-Identifier: Apache-2.0
"""The anchor of a heavy symmetric top, made of one state (symbols: lagrange_top.py)."""

import math
from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.motions.lagrange_top.means import NEVER, mean_rates
from rigid_body_sim.motions.lagrange_top.nutation import (
    CIRCULAR,
    HYPERBOLIC,
    Beginning,
    Course,
    functions,
    store_circular,
    store_course,
    store_hyperbolic,
)
from rigid_body_sim.motions.lagrange_top.roots import turning_points
from rigid_body_sim.motions.lagrange_top.theta import (
    THETA_1,
    THETA_2,
    CircularSeries,
    HyperbolicSeries,
    Klein,
    circular_terms,
    hyperbolic_terms,
    powers_of,
)
from rigid_body_sim.numerics.elliptic import carlson_rf_pair, complete_k, nome, root_nome
from rigid_body_sim.numerics.functions import atan2, exp
from rigid_body_sim.numerics.pairs import TURN, minus, plus, scaled, times
from rigid_body_sim.numerics.phase import nearest

QUARTER_TURN = 0.5 * math.pi
FROM_LOWEST = True
NOTICED = 1e-9
TINY = 1e-60    # a tilt and swing below this follow linear equations, to far below round-off


class Units(NamedTuple):
    """Powers of two, exact divisors: they keep rates near 1 and take tiny tilts up to TINY."""

    a: float
    b: float
    swing: float    # unit of a or b, the one that is near 0, and of omega_c
    rate: float     # rad/s


@compiled
def anchor_nutation(start, n, k, own_spin, out):
    """Fill the anchor from one state.

    Parameters
    ----------
    start : Klein
        Its Cayley-Klein parameters may have any norm.
    n, k, own_spin : pair of floats (double_double.py)
        I3 omega_3/I1 (rad/s), M g h/I1 (1/s^2, not negative), omega_3 - n (rad/s).
    out : array, to be loaded as a Nutation
    """
    a, b, omega = start
    if _stays(start, n, k):
        _rest(start, out)
        return
    units = _units(start, n, k)
    n, k = scaled(n, 1.0 / units.rate), scaled(scaled(k, 1.0 / units.rate), 1.0 / units.rate)
    in_units = Klein(_over(a, units.a), _over(b, units.b),
                     _over(_over(omega, units.rate), units.swing))
    roots = turning_points(in_units, (units.a, units.b), n, k)
    means = mean_rates(roots, units.swing if roots.apart else 1.0)
    if roots.apart:
        begin = _begin_hyperbolic(roots, n[0], k[0], means, units, out)
    else:
        begin = _begin_circular(roots, n[0], k[0], means, units, out)
    rate_a = times(plus(scaled(means.a, units.rate), scaled(own_spin, 0.5)), TURN)
    rate_b = times(minus(scaled(means.b, units.rate), scaled(own_spin, 0.5)), TURN)
    # counted as nutation (an event) if u' ever comes near NOTICED times the angular velocity
    steepest = math.sqrt(roots.wide[0]) * roots.gap * (
        1.0 if roots.apart else units.swing * units.swing)
    fastest = math.sqrt(roots.w1) + abs(n[0] + own_spin[0] / units.rate)
    nutates = 1.0 if steepest > NOTICED * fastest and means.nutation[0] > 0.0 else 0.0
    form, rate = HYPERBOLIC if roots.apart else CIRCULAR, scaled(means.nutation, units.rate)
    store_course(out, Course(form, begin, rate, rate_a, rate_b, 0.0, 0.0, nutates))
    start_a, start_b = _starting_phases(start, functions(out, (0.0, 0.0)), roots)
    store_course(out, Course(form, begin, rate, rate_a, rate_b, start_a, start_b, nutates))


@compiled_inline
def _stays(start, n, k):
    """Return whether a top at rest stays so: upright, hanging, or without weight."""
    a, b, omega = start
    return omega[0] == 0.0 and omega[1] == 0.0 and n[0] == 0.0 and (
        k[0] == 0.0 or (a[0] == 0.0 and a[1] == 0.0) or (b[0] == 0.0 and b[1] == 0.0))


@compiled
def _rest(start, out):
    """Fill the anchor of a top at rest that stays so: its attitude is a root of its own."""
    (a_re, a_im), (b_re, b_im), _ = start
    norm = math.sqrt(a_re * a_re + a_im * a_im + b_re * b_re + b_im * b_im)
    powers = powers_of(0.0)
    a, _ = circular_terms(
        powers, 0.0, THETA_1, 1.0, math.sqrt(a_re * a_re + a_im * a_im) / norm)
    b, _ = circular_terms(
        powers, 0.0, THETA_2, 1.0, math.sqrt(b_re * b_re + b_im * b_im) / norm)
    omega, _ = circular_terms(powers, 0.0, THETA_2, 1.0, 0.0)
    store_circular(out, CircularSeries(powers, a, b, omega))
    none = (0.0, 0.0)
    store_course(out, Course(
        CIRCULAR, Beginning(0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0), none, none, none,
        _angle(start.a, (1.0, 0.0)), _angle(start.b, (1.0, 0.0)), 0.0))


@compiled_inline
def _units(start, n, k):
    """Return the Units of a state."""
    a, b, omega = start
    own = max(abs(n[0]), 2.0 * math.sqrt(k[0]))
    largest = max(own, _largest(omega))
    rate = math.ldexp(1.0, min(max(math.frexp(largest)[1], -900), 900)) if largest > 0.0 else 1.0
    n, k = n[0] * (1.0 / rate), k[0] * (1.0 / rate) * (1.0 / rate)
    own = max(abs(n), 2.0 * math.sqrt(k))
    standing = b[0] * b[0] + b[1] * b[1] <= a[0] * a[0] + a[1] * a[1]
    tilt, swing = _largest(b) if standing else _largest(a), _largest(_over(omega, rate))
    scale = _scale(max(tilt, swing / own)) if own > 0.0 else 1.0
    return Units(1.0 if standing else scale, scale if standing else 1.0, scale, rate)


@compiled_inline
def _largest(z):
    """Return the larger one of real and imaginary part, in size."""
    return max(abs(z[0]), abs(z[1]))


@compiled_inline
def _over(z, divisor):
    """Return a complex number divided by a real one."""
    return z[0] / divisor, z[1] / divisor


@compiled
def _scale(size):
    """Return the power of two that takes a tilt and swing of this size up to TINY.

    It is 1 if the size is larger than TINY, or zero.
    """
    if size >= TINY or size == 0.0:
        return 1.0
    _, exponent = math.frexp(size / TINY)
    return math.ldexp(1.0, exponent)


@compiled_inline
def _starting_phases(start, periodic, roots):
    """Return the phases (turns) of a and b at the start.

    They come from those two of the three functions that are farthest from their zeros there.
    `periodic` is the Klein at the start that phases of 0 give.
    """
    phase_a, phase_b = _angle(start.a, periodic.a), _angle(start.b, periodic.b)
    phase_w = _angle(start.omega, periodic.omega)
    share_a, share_b = quotient(roots.x[0], roots.x2[0]), quotient(roots.y[0], roots.y1[0])
    share_w = quotient(roots.w, roots.w1)
    if share_a < min(share_b, share_w):
        phase_a = phase_b - phase_w
    elif share_b < min(share_a, share_w):
        phase_b = phase_a + phase_w
    return phase_a - nearest(phase_a), phase_b - nearest(phase_b)


@compiled
def _angle(to, back):
    """Return the angle (turns) from the complex number `back` to the complex number `to`.

    Their moduli may be as small as doubles go.
    """
    size_to, size_back = _largest(to), _largest(back)
    if size_to == 0.0 or size_back == 0.0:
        return 0.0
    to_re, to_im = _over(to, size_to)
    from_re, from_im = _over(back, size_back)
    return TURN[0] * atan2(to_im * from_re - to_re * from_im, to_re * from_re + to_im * from_im)


@compiled
def quotient(a, b):
    """Return a / b, or 0 where b is 0."""
    return a / b if b != 0.0 else 0.0


@compiled
def _rf_or_never(x, y, z):
    """Return whether R_F(x, y, z) is finite, and arguments that R_F may take in any case."""
    finite = min(x + y, y + z, x + z) > 0.0
    return finite, (x if finite else 1.0, y if finite else 1.0, z if finite else 1.0)


@compiled
def _lengths(square, first, other, second):
    """Return sqrt(square) R_F(first) and sqrt(other) R_F(second).

    They are infinite where two arguments of R_F vanish, and 0 where the root does.
    """
    is_first, first = _rf_or_never(*first)
    is_second, second = _rf_or_never(*second)
    R, S = carlson_rf_pair(*first, *second)
    return (0.0 if square == 0.0 else math.sqrt(square) * R if is_first else math.inf,
            0.0 if other == 0.0 else math.sqrt(other) * S if is_second else math.inf)


@compiled_inline
def _arguments(roots, k, from_lowest):
    """Return arguments of Jacobi's functions: A, B, C in imaginary time, the state in real time.

    A, B and C are the places of the zeros of a, b and omega_c. That of a is counted from u1, those
    of b and omega_c from u2, that of the state from u1 if `from_lowest`, else from u2.
    """
    gap, wide, narrow = roots.gap, roots.wide[0], roots.narrow[0]
    lower, upper, above = roots.lower, roots.upper, roots.above
    if gap == 0.0:    # steady: none has a zero, also where it is 0 all the time
        return math.inf, math.inf, math.inf, 0.0
    x1, x2, x3 = roots.x1[0], roots.x2[0], roots.x3[0]
    y1, y2, y3 = roots.y1[0], roots.y2[0], roots.y3[0]
    gap2 = 2.0 * k * gap
    if from_lowest:
        state = upper, above * gap / wide, gap
        A, along = _lengths(x1, (gap, gap * x3 / wide, x2), lower, state)
    else:
        state = lower * narrow, narrow * gap, gap * above
        A, along = _lengths(x1, (gap, gap * x3 / wide, x2), upper * wide, state)
    B, C = _lengths(y2 * wide, (y3 * gap, gap * narrow, y1 * narrow),
                    roots.w2 * wide, (roots.w3 * gap2, gap2 * narrow, roots.w1 * narrow))
    return A, B, C, along


@compiled_inline
def _sides(roots):
    """Return the orientations of a, b, omega_c (theta.py): signs of sigma, delta and -chi."""
    return (1.0 if roots.sigma[0] >= 0.0 else -1.0, 1.0 if roots.delta[0] >= 0.0 else -1.0,
            -1.0 if roots.chi >= 0.0 else 1.0)


@compiled_inline
def _side_at_lowest(roots, n):
    """Return the sign of c at u1, formed from the pole that is near: else rounding decides it."""
    near_lower_pole = roots.x1[0] < 0.5 * roots.x[0]
    lowest = roots.sigma[0] - n * roots.x1[0] if near_lower_pole else roots.c + n * roots.lower
    return 1.0 if lowest >= 0.0 else -1.0


@compiled_inline
def _begin_circular(roots, n, k, means, units, out):
    """Store the series of the circular form in `out` and return the Beginning."""
    gap, wide = roots.gap, roots.wide[0]
    per_argument = 2.0 * means.mean    # 2v of an argument of Jacobi's functions
    powers = powers_of(nome(math.sqrt(2.0 * k * gap / wide), math.sqrt(roots.narrow[0] / wide)))
    A, B, C, along = _arguments(roots, k, bool(FROM_LOWEST))
    side_a, side_b, side_w = _sides(roots)
    a, _ = circular_terms(powers, exp(-per_argument * A), THETA_1, side_a,
                          units.a * math.sqrt(0.5 * roots.x2[0]))
    b, _ = circular_terms(powers, exp(-per_argument * B), THETA_2, side_b,
                          units.b * math.sqrt(0.5 * roots.y1[0]))
    omega, slope = circular_terms(powers, exp(-per_argument * C), THETA_2, side_w,
                                  units.rate * units.swing * math.sqrt(roots.w1))
    store_circular(out, CircularSeries(powers, a, b, omega))
    # mean rate of arg(omega_c), from its rate at u1, less that of conj(a) b: a whole multiple of
    # the rate of 2v
    at_lowest = -0.5 * (n + quotient(roots.chi, roots.w1))
    rate = 0.5 * math.sqrt(wide) * per_argument
    turns = 0.0 if roots.steady else nearest(
        (at_lowest - (means.b[0] - means.a[0])) / rate + slope)
    start = TURN[0] * per_argument * math.copysign(along, roots.rise)
    return Beginning(start, turns, _side_at_lowest(roots, n), 0.0, 0.0, 0.0, 0.0)


@compiled_inline
def _begin_hyperbolic(roots, n, k, means, units, out):
    """Store the series of the hyperbolic form in `out` and return the Beginning."""
    wide, narrow = roots.wide[0], roots.narrow[0]
    modulus = math.sqrt(2.0 * k * roots.gap / wide)
    per_argument = QUARTER_TURN / complete_k(modulus)    # y of an argument of Jacobi's functions
    half_period = per_argument * QUARTER_TURN / means.mean if means.mean > 0.0 else NEVER
    root = root_nome(units.swing * math.sqrt(narrow / wide), modulus)
    powers = powers_of(root * root)
    # the lowest position is nearer in time than the highest
    from_lowest = (units.swing * roots.upper * math.sqrt(wide)
                   >= math.sqrt(narrow) * roots.lower)
    A, B, C, along = _arguments(roots, k, from_lowest)
    A, B = min(per_argument * A, QUARTER_TURN), min(per_argument * B, QUARTER_TURN)
    C = min(per_argument * C, QUARTER_TURN)
    side_a, side_b, side_w = _sides(roots)
    a = hyperbolic_terms(powers, A, THETA_1, side_a, math.sqrt(0.5 * roots.x2[0]), root)
    b = hyperbolic_terms(powers, B, THETA_2, side_b, math.sqrt(0.5 * roots.y1[0]), root)
    omega = hyperbolic_terms(
        powers, C, THETA_2, side_w, units.rate * math.sqrt(roots.w1), root)
    store_hyperbolic(out, HyperbolicSeries(powers, a, b, omega))
    # from the lowest to the highest position the phases make a step beside their steady growth;
    # that of omega_c is that of b less that of a, up to half a turn
    step_a, step_b = side_a * (QUARTER_TURN - A), side_b * (QUARTER_TURN - B)
    step_w = side_w * (QUARTER_TURN - C)
    half_turns = nearest((step_w - step_b + step_a) / math.pi)
    winding, stretch = half_turns - 2.0 * math.floor(0.5 * half_turns), 2.0 * half_period
    side, parity, argument = _side_at_lowest(roots, n), 0.0, math.copysign(along, roots.rise)
    if not from_lowest:
        side, parity, argument = side * (1.0 - 2.0 * winding), 1.0, -argument
    return Beginning(per_argument * argument / stretch, winding, side, parity, stretch,
                     TURN[0] * step_a / half_period, TURN[0] * step_b / half_period)
