# SPDX-License-Identifier: Apache-2.0
"""Phases counted in turns (one turn = 2 pi rad), so that reducing them is exact.

A rate in turns per second is a pair of doubles (double_double.py), so rate times time loses
nothing, even after 1e10 turns. Sine and cosine of a phase are polynomials, not calls of the C
library: they have the same bits on every machine, with and without numba, and loops over them
become vector code.
"""

from rigid_body_sim.compilation.jit import compiled_inline
from rigid_body_sim.numerics.double_double import two_product, two_sum

ROUNDER = 6755399441055744.0    # 1.5 * 2^52: adding and subtracting it rounds to an integer
COUNTABLE = 2.0 ** 51           # half turns; beyond it two events have the same time as doubles
TRIES = 8    # at the next event; if none is later, two events share a double


@compiled_inline
def nearest(x):
    """Return the integer nearest to x, as a float, for |x| < 2^51.

    For larger x it is an integer within ulp(x) of it.
    """
    return (x + ROUNDER) - ROUNDER


@compiled_inline
def phase(rate, rate_low, time, time_low):
    """Return rate * time (turns) less a whole number of turns, as a pair with |high| <= 1/2.

    The result is exact to 1e-31 of the product.
    """
    turns, low = two_product(rate, time)
    low += rate * time_low + rate_low * time
    turns, low = two_sum(turns - nearest(turns), low)
    return turns - nearest(turns), low


@compiled_inline
def fraction(turns, low):
    """Return a pair of turns less a whole number of turns, as a pair with |high| <= 1/2."""
    turns, low = two_sum(turns - nearest(turns), low)
    return turns - nearest(turns), low


@compiled_inline
def sin_cos(turns, low):
    """Return sine and cosine of the angle 2 pi (turns + low), both to 1.5e-16.

    |turns| <= 2, and low is a small correction. The angle is reduced to at most an eighth of a
    turn. Coefficients are Chebyshev fits of (sin(2 pi x)/x - 2 pi)/x^2 and of
    ((cos(2 pi x) - 1)/x^2 + 2 pi^2)/x^2 in x^2 on [0, 1/64], with errors of 1.3e-17 of the result.
    """
    quarter = nearest(4.0 * turns)
    x = (turns - 0.25 * quarter) + low
    z = x * x
    # The leading terms are added last, with more than a double's digits: rounding 2 pi alone
    # would make every sine too small.
    s = x * 6.283185307179586 + x * (2.4492935982947064e-16 + z * (-41.341702240399755 + z * (
        81.6052492760517 + z * (-76.70585973562093 + z * (42.05868918088512 + z * (
            -15.094054182079999 + z * 3.78643334956545))))))
    c = 1.0 + (z * -19.739208802178716 + z * (-1.2530591017479423e-15 + z * (
        64.9393940226683 + z * (-85.45681720668455 + z * (60.24464136502278 + z * (
            -26.426254911246687 + z * (7.903305164742355 + z * -1.701221523203635)))))))
    # half turns change both signs; a quarter turn more takes (s, c) to (c, -s)
    half = nearest(0.5 * quarter)
    sign = 1.0 - 2.0 * abs(half - 2.0 * nearest(0.5 * half))
    step = quarter - 2.0 * half
    sine = s if step == 0.0 else step * c
    cosine = c if step == 0.0 else -step * s
    return sign * sine, sign * cosine
