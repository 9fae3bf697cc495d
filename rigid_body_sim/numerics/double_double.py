# SPDX-License-Identifier: Apache-2.0
"""Double-double arithmetic: a number is the unevaluated sum of two doubles, about 32 digits.

It serves the few numbers that must not lose any digit. A pair is a tuple of two floats with
|low| <= ulp(high)/2. The error of a product is one fused multiply-add where numba compiles, and
Dekker's split or an fma in plain Python: all are exact, so the bits agree. Low parts of products
below 1e-290 are lost.

Sources: T. J. Dekker, Numerische Mathematik 18 (1971) 224; M. Joldes, J.-M. Muller, V. Popescu,
ACM TOMS 44 (2017) 15, whose error bounds are quoted in units of u^2 = 2^-106.
"""

import math

from rigid_body_sim.compilation.fused import python_fma
from rigid_body_sim.compilation.jit import HAVE_NUMBA, compiled, compiled_inline

SPLITTER = 134217729.0     # 2^27 + 1
LEAST, MOST = 1e-270, 1e290    # between them Dekker's split is exact
HAVE_FMA = hasattr(math, 'fma')

if HAVE_NUMBA:
    from numba.core import types
    from numba.extending import intrinsic

    @intrinsic
    def _product_error(typing_context, a, b, product):
        """Return a b - product exactly, by the processor's fused multiply-add."""
        def generate(context, builder, signature, arguments):
            a, b, product = arguments
            return builder.fma(a, b, builder.fneg(product))
        return types.float64(types.float64, types.float64, types.float64), generate
else:
    def _product_error(a, b, product):
        """Return a b - product exactly, for product = a b rounded: fma(a, b, -product)."""
        if HAVE_FMA or not (LEAST < abs(product) < MOST and abs(a) < MOST and abs(b) < MOST):
            return python_fma(a, b, -product)
        # splits both factors into halves of 26 bits, in half the time of an emulated fma
        c, d = SPLITTER * a, SPLITTER * b
        ah, bh = c - (c - a), d - (d - b)
        al, bl = a - ah, b - bh
        return al * bl - (((product - ah * bh) - al * bh) - ah * bl)


@compiled_inline
def two_sum(a, b):
    """Return the exact sum of two doubles."""
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


@compiled_inline
def quick_two_sum(a, b):
    """Return the exact sum of two doubles with |a| >= |b| or a = 0."""
    total = a + b
    return total, b - (total - a)


@compiled_inline
def two_product(a, b):
    """Return the exact product of two doubles."""
    product = a * b
    return product, _product_error(a, b, product)


@compiled
def add(a, al, b, bl):
    """Return a + b to 3 u^2 of the result, for any signs."""
    s, e = two_sum(a, b)
    t, f = two_sum(al, bl)
    s, e = quick_two_sum(s, e + t)
    return quick_two_sum(s, e + f)


@compiled_inline
def add_double(a, al, b):
    """Return a + b for a pair a and a double b, as a compensated sum needs it."""
    s, e = two_sum(a, b)
    return quick_two_sum(s, e + al)


@compiled
def add_alike(a, al, b, bl):
    """Return a + b to 3 u^2 of the result, for a and b of the same sign."""
    s, e = two_sum(a, b)
    return quick_two_sum(s, e + (al + bl))


@compiled
def multiply(a, al, b, bl):
    """Return a b to 7 u^2."""
    p, e = two_product(a, b)
    return quick_two_sum(p, e + (a * bl + al * b))


@compiled
def multiply_double(a, al, b):
    """Return a b to 3 u^2 for a pair a and a double b."""
    p, e = two_product(a, b)
    return quick_two_sum(p, e + al * b)


@compiled
def divide(a, al, b, bl):
    """Return a / b to 15 u^2; b must not be zero."""
    quotient = a / b
    p, e = multiply_double(b, bl, quotient)
    return quick_two_sum(quotient, ((a - p) + (al - e)) / b)


@compiled
def root(a, al):
    """Return the square root of a pair a >= 0 to 4 u^2."""
    if a <= 0.0:
        return 0.0, 0.0
    s = math.sqrt(a)
    p, e = two_product(s, s)
    return quick_two_sum(s, ((a - p) - e + al) / (s + s))
