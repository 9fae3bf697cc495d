# SPDX-License-Identifier: Apache-2.0
"""Turning points of the axis of a symmetric top with a fixed point, to more digits than a double.

Symbols (rates divided by I1): u = cos(beta), n = P_gamma/I1, k = M g h/I1 >= 0 with h > 0 towards
the centre of mass, so that u = -1 is hanging; omega_c = omega_2 - i omega_1 across the axis, gamma
the vertical in body axes, c = omega . gamma across the axis.

    u'^2 = 2 k (u - u1)(u - u2)(u - u3) = |omega_c|^2 (1 - u^2) - c^2,
    -1 <= u1 <= u <= u2 <= 1 <= u3                              (notes, "Symmetric Top", V_eff)

Three squares of moduli, linear in u, decide the motion. At the three roots each has a product that
the conserved quantities give:

    x = 1 + u:         x1 x2 x3 = sigma^2,   sigma = (P_alpha + P_gamma)/I1 = c + n x
    y = 1 - u:         y1 y2 y3 = delta^2,   delta = (P_alpha - P_gamma)/I1 = c - n y
    w = |omega_c|^2:   w1 w2 w3 = chi^2,     chi = 2 k c - n w
    x3 = 2 k (1 + u3),     y3 = 2 k (u3 - 1),     w3 = 2 k u3 - 2 E/I1

The product gives the factor that a subtraction would lose. What belongs to the third root carries
the factor 2 k, so that k = 0 is an ordinary value. Everything is a pair of doubles (pairs.py):
differences like 4 k - n^2 decide region and modulus, and the mean rates, whose errors would grow
with time, need all digits. What comes after these takes the high parts.
"""

import math
from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.compilation.layout import Pair
from rigid_body_sim.numerics.double_double import multiply_double, quick_two_sum
from rigid_body_sim.numerics.pairs import (
    minus,
    not_negative,
    over,
    plus,
    products,
    root_of,
    scaled,
    times,
)


class Now(NamedTuple):
    """Numbers of the state: x, y, w and c + i u' at present, and the conserved ones."""

    x: Pair
    y: Pair
    w: Pair
    c: Pair
    rise: Pair      # u'
    sigma: Pair
    delta: Pair
    chi: Pair


class Factors(NamedTuple):
    """Results of the cubic of one of the two cases below."""

    apart: bool     # whether u1 is the root apart from the other two; else u3 is
    steady: bool    # whether u stays where it is
    y1: Pair
    y2: Pair
    y3: Pair
    gap: Pair       # u2 - u1
    lower: Pair     # u - u1
    upper: Pair     # u2 - u
    above: Pair     # 2 k (u3 - u)
    wide: Pair      # 2 k (u3 - u1)
    narrow: Pair    # 2 k (u3 - u2)


class Roots(NamedTuple):
    """Squares of moduli at the roots (numbers) and now, and distances of the roots."""

    x1: Pair
    x2: Pair
    x3: Pair
    y1: Pair
    y2: Pair
    y3: Pair
    x: Pair
    y: Pair
    wide: Pair      # 2 k (u3 - u1)
    narrow: Pair    # 2 k (u3 - u2)
    sigma: Pair
    delta: Pair
    w1: float
    w2: float
    w3: float
    w: float
    chi: float
    c: float
    rise: float     # u'
    gap: float      # u2 - u1
    lower: float    # u - u1
    upper: float    # u2 - u
    above: float    # 2 k (u3 - u)
    apart: bool     # whether u1 is the root apart from the other two; else u3 is
    steady: bool    # whether u stays where it is


@compiled
def largest_root(b, c, d):
    """Return the largest root of r^3 + b r^2 - c r + d (pairs).

    All roots are real, and the largest is well apart from the others. Newton's method from above,
    where the cubic is convex, falls towards the root. The last step is made in pairs.
    """
    bh, ch, dh = b[0], c[0], d[0]
    r = (-bh + 2.0 * math.sqrt(max(bh * bh + 3.0 * ch, 0.0))) / 3.0
    step, slope = r, 0.0
    while abs(step) > 1e-9 * r:
        slope = (3.0 * r + 2.0 * bh) * r - ch
        if slope <= 0.0:
            return r, 0.0
        step = (((r + bh) * r - ch) * r + dh) / slope
        r -= step
    if slope == 0.0:
        return r, 0.0
    slope = (3.0 * r + 2.0 * bh) * r - ch
    value = plus(b, (r, 0.0))
    value = minus(multiply_double(value[0], value[1], r), c)
    value = plus(multiply_double(value[0], value[1], r), d)
    return quick_two_sum(r, -value[0] / slope)


@compiled
def parts(difference, product):
    """Return p, m >= 0 with p - m = difference and p m = product >= 0, and p + m (pairs)."""
    half = scaled(difference, 0.5)
    square = plus(times(half, half), product)
    mean = root_of(square)
    if half[0] >= 0.0:
        larger = plus(mean, half)
        return larger, over(product, larger), scaled(mean, 2.0)
    larger = minus(mean, half)
    return over(product, larger), larger, scaled(mean, 2.0)


@compiled
def shared(first, second, product, weight):
    """Return two numbers >= 0 (pairs) of known product, the smaller one from the larger.

    The first is counted `weight` times.
    """
    if weight * first[0] >= second[0]:
        return first, over(product, first)
    return over(product, second), second


@compiled_inline
def turning_points(start, units, n, k):
    """Return the Roots that one state decides.

    Parameters
    ----------
    start : Klein
        Cayley-Klein parameters a = w + i z, b = y - i x of the attitude, of any norm, and omega_c.
    units : pair of floats
        Those that a and b are counted in, powers of two.
    n, k : pair
    """
    now = _now(start, units, n, k)
    square = times(now.rise, now.rise)
    limit = minus(scaled(k, 4.0), times(n, n))
    top = now.y[0] <= now.x[0]
    # u'^2 = square + 2 fall s + bend s^2 - 2 h s^3; s is the distance from the nearest pole less
    # its present value
    sign, near = (1.0, now.y) if top else (-1.0, now.x)
    h, hw = scaled(k, sign), plus(scaled(times(k, near), sign), now.w)
    bend = limit if top else minus(scaled(k, -4.0), times(n, n))
    bend = minus(bend, plus(scaled(times(k, near), 4.0 * sign), now.w))
    fall = minus(plus(scaled(times(k, near), 2.0 * sign), now.w),
                 plus(scaled(times(n, now.c), sign), times(near, hw)))
    steady = fall[0] == 0.0 and square[0] == 0.0
    if steady or bend[0] * (bend[0] * bend[0] + 18.0 * h[0] * fall[0]) \
            + 54.0 * h[0] * h[0] * square[0] < 0.0:
        # where u stays as it is, any positive number serves
        above = (max(now.w[0] + n[0] * n[0] + 4.0 * k[0], 1e-300), 0.0) if steady else \
            largest_root(bend, scaled(times(h, fall), 4.0),
                         times(times(scaled(k, 2.0), scaled(k, 2.0)), square))
        f = _upper_root_apart(now, k, h, fall, square, above, top, steady)
    else:
        f = _lower_root_apart(now, n, k, limit, square)
    return _all_roots(now, f, k)


@compiled_inline
def _now(start, units, n, k):
    """Return x, y, w and c + i u' = -2 i a conj(b) omega_c of a state, and what is conserved."""
    (a_re, a_im), (b_re, b_im), (o_re, o_im) = start
    unit_a, unit_b = units
    a2, b2 = products(a_re, a_re, a_im, a_im), products(b_re, b_re, b_im, b_im)
    w = products(o_re, o_re, o_im, o_im)
    per = over((2.0, 0.0), plus(scaled(a2, unit_a * unit_a), scaled(b2, unit_b * unit_b)))
    x, y = times(a2, per), times(b2, per)
    z_re, z_im = products(a_re, b_re, a_im, b_im), products(a_im, b_re, -a_re, b_im)
    c = times(plus(multiply_double(z_re[0], z_re[1], o_im),
                   multiply_double(z_im[0], z_im[1], o_re)), per)
    rise = times(minus(multiply_double(z_im[0], z_im[1], o_im),
                       multiply_double(z_re[0], z_re[1], o_re)), per)
    sigma, delta = plus(c, times(n, x)), minus(c, times(n, y))
    chi = minus(scaled(times(k, c), 2.0), times(n, w))
    return Now(x, y, w, c, rise, sigma, delta, chi)


@compiled_inline
def _upper_root_apart(now, k, h, fall, square, above, top, steady):
    """Return the Factors of the cubic about the state, where u3 is apart: `above` is its root."""
    k2, product = scaled(k, 2.0), over(square, above)
    outward, inward, gap = parts(
        over(scaled(minus(fall, times(h, product)), 2.0), above), product)
    lower, upper = (outward, inward) if top else (inward, outward)
    y1 = plus(now.y, lower)
    y2, y3 = shared(not_negative(minus(now.y, upper)),
                    not_negative(minus(above, times(k2, now.y))),
                    over(times(now.delta, now.delta), y1), k2[0])
    wide, narrow = plus(above, times(k2, lower)), minus(above, times(k2, upper))
    return Factors(False, steady, y1, y2, y3, gap, lower, upper, above, wide, narrow)


@compiled_inline
def _lower_root_apart(now, n, k, limit, square):
    """Return the Factors of the cubic about the upper pole, where u1 is apart."""
    k2 = scaled(k, 2.0)
    energy2 = minus(now.w, times(k2, now.y))
    linear, d2 = minus(energy2, times(n, now.delta)), times(now.delta, now.delta)
    r1 = largest_root(minus(energy2, limit), scaled(times(k, linear), 4.0),
                      times(times(k2, k2), d2))
    y1, product = over(r1, k2), over(d2, r1)
    y2, y3, narrow = parts(over(scaled(minus(times(k, product), linear), 2.0), r1), product)
    y3, narrow = times(k2, y3), times(k2, narrow)
    above, wide, gap = plus(times(k2, now.y), y3), plus(r1, y3), minus(y1, y2)
    if 2.0 * now.y[0] > y1[0] + y2[0]:
        upper = not_negative(minus(now.y, y2))
        lower = over(square, times(upper, above))
    else:
        lower = minus(y1, now.y)
        upper = over(square, times(lower, above))
    return Factors(True, False, y1, y2, y3, gap, lower, upper, above, wide, narrow)


@compiled_inline
def _all_roots(now, f, k):
    """Return the Roots: those of the Factors f, and what the products give."""
    k2 = scaled(k, 2.0)
    x2, x3 = plus(now.x, f.upper), plus(times(k2, now.x), f.above)
    w1 = plus(now.w, times(k2, f.lower))
    w2, w3 = shared(not_negative(minus(now.w, times(k2, f.upper))),
                    not_negative(minus(f.above, now.w)), over(times(now.chi, now.chi), w1), 1.0)
    x1 = over(times(now.sigma, now.sigma), times(x2, x3))
    return Roots(x1, x2, x3, f.y1, f.y2, f.y3, now.x, now.y, f.wide, f.narrow, now.sigma,
                 now.delta, w1[0], w2[0], w3[0], now.w[0], now.chi[0], now.c[0], now.rise[0],
                 f.gap[0], f.lower[0], f.upper[0], f.above[0], f.apart, f.steady)
