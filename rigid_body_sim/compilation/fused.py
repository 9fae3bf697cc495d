# SPDX-License-Identifier: Apache-2.0
"""The fused multiply-add: a b + c with one rounding, on every machine and with every compiler.

Compiled code uses the instruction of the processor (``llvm.fma``; where there is none, LLVM calls
the C library's function). Plain Python has ``math.fma`` from version 3.13 on; before, or where
``math.fma`` raises an exception, the functions here compute the same number from sums and
products. IEEE 754 defines the result to the last bit, so all ways give the same bits.

Sources: T. J. Dekker, Numerische Mathematik 18 (1971) 224 (exact products); S. Boldo and
G. Melquiond, IEEE Transactions on Computers 57 (2008) 462 (fma from exact sums and products);
J.-M. Muller et al., Handbook of Floating-Point Arithmetic, 2nd ed. (2018), section 4.
"""

import math

from rigid_body_sim.compilation.jit import HAVE_NUMBA, compiled_inline

SPLITTER = 134217729.0                        # 2^27 + 1
LEAST, MOST = 2.0 ** -900, 2.0 ** 990         # products and factors between split without loss


def exact_fma(a, b, c):
    """Return a b + c, rounded once, for any doubles: by integers, in a few microseconds."""
    if not (math.isfinite(a) and math.isfinite(b) and a != 0.0 and b != 0.0):
        return a * b + c
    if not math.isfinite(c):
        return c
    (p, q), (r, s), (t, u) = a.as_integer_ratio(), b.as_integer_ratio(), c.as_integer_ratio()
    numerator = p * r * u + t * q * s
    try:
        # Python rounds the quotient of two integers once, to the nearest, also where it underflows
        return numerator / (q * s * u)
    except OverflowError:
        return math.inf if numerator > 0 else -math.inf


def _rounded(a, b, c, p):
    """Return r, q and h: a b + c is r + q + h exactly, for doubles with a b = p rounded.

    Exactly, a b = p + e, p + c = s + f and e + f = g + h, so a b + c = s + g + h. For h = 0 the
    sum s + g rounds once. Otherwise let s + g = r + q, r rounded: h is less than an ulp of g,
    of which both q and the distance d from r to where rounding changes are multiples; so r is
    right unless |q| = d, and d is a power of two.
    """
    upper = SPLITTER * a
    ah = upper - (upper - a)
    al = a - ah
    upper = SPLITTER * b
    bh = upper - (upper - b)
    bl = b - bh
    e = al * bl - (((p - ah * bh) - al * bh) - ah * bl)
    s = p + c
    part = s - p
    f = (p - (s - part)) + (c - part)
    g = e + f
    part = g - e
    h = (e - (g - part)) + (f - part)
    r = s + g
    return r, g - (r - s), h


def emulated_fma(a, b, c):
    """Return a b + c, rounded once, from sums and products of doubles where these suffice."""
    p = a * b
    if not (LEAST <= abs(p) <= MOST and abs(a) <= MOST and abs(b) <= MOST and abs(c) <= MOST):
        return exact_fma(a, b, c)
    r, q, h = _rounded(a, b, c, p)
    if h != 0.0 and abs(math.frexp(q)[0]) == 0.5:
        return exact_fma(a, b, c)
    return r


def guarded_fma(a, b, c):
    """Return a b + c, rounded once: ``math.fma`` without its exceptions."""
    try:
        return math.fma(a, b, c)
    except (OverflowError, ValueError):
        return exact_fma(a, b, c)


# the function that plain Python uses, also where kernels are compiled
python_fma = guarded_fma if hasattr(math, 'fma') else emulated_fma


_fused = python_fma
if HAVE_NUMBA:
    from numba.core import types
    from numba.extending import intrinsic

    @intrinsic
    def _fused(typing_context, a, b, c):
        """Return a b + c, rounded once, by the instruction of the processor."""
        def generate(context, builder, signature, arguments):
            return builder.fma(*arguments)
        return types.float64(types.float64, types.float64, types.float64), generate


@compiled_inline
def fma(a, b, c):
    """Return a b + c, rounded once."""
    return _fused(a, b, c)
