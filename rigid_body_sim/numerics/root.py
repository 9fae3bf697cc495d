# SPDX-License-Identifier: Apache-2.0
"""A root of a function between two arguments at which its signs differ.

Source: R. P. Brent, Algorithms for Minimization without Derivatives, chapter 4, in the form of
SciPy's brentq. SciPy's is C code, in which a compiler may fuse products and sums; here every
operation is rounded, so that a root has the same bits on every machine.
"""

import math

ITERATIONS = 200    # bisection alone narrows an hour to an ulp in 60


def root(function, begin, end, absolute, relative):
    """Return an argument x with function(x) = 0, found by interpolation and bisection.

    Parameters
    ----------
    function : callable
        Float -> float, continuous.
    begin, end : float
        Arguments where the function has different signs or is zero.
    absolute, relative : float
        The root lies within absolute + relative |x| of what is returned.
    """
    before, x = begin, end
    f_before, f = function(before), function(x)
    if f_before == 0.0:
        return before
    other, f_other, last, step = before, f_before, 0.0, 0.0
    for _ in range(ITERATIONS):
        if f_before != 0.0 and f != 0.0 and (f_before < 0.0) != (f < 0.0):
            other, f_other = before, f_before
            last = step = x - before
        if abs(f_other) < abs(f):
            before, x, other = x, other, x
            f_before, f, f_other = f, f_other, f
        reach = (absolute + relative * abs(x)) / 2.0
        half = (other - x) / 2.0
        if f == 0.0 or abs(half) < reach:
            break
        shorter, bound = half, 0.0
        if abs(last) > reach and abs(f) < abs(f_before):
            bound = min(abs(last), 3.0 * abs(half) - reach)
            if before == other:
                shorter = -f * (x - before) / (f - f_before)
            else:
                slope = (f_before - f) / (before - x)
                other_slope = (f_other - f) / (other - x)
                over = other_slope * slope * (f_other - f_before)
                if over == 0.0:
                    bound = 0.0
                else:
                    shorter = -f * (f_other * other_slope - f_before * slope) / over
        last, step = (step, shorter) if 2.0 * abs(shorter) < bound else (half, half)
        before, f_before = x, f
        x += step if abs(step) > reach else math.copysign(reach, half)
        f = function(x)
    return x
