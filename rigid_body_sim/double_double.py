"""Arithmetic with the unevaluated sum of two doubles (high, low), about 32 digits, for the few numbers that must not lose any.

A pair is a tuple of two floats with |low| <= ulp(high)/2. Products are split after Dekker, so no fused multiply-add is needed and the bits are
the same on every machine. Factors stay below 1e150 and products above 1e-290, or their low parts are lost to overflow and underflow.

Sources: T. J. Dekker, Numerische Mathematik 18 (1971) 224; M. Joldes, J.-M. Muller, V. Popescu, ACM TOMS 44 (2017) 15, whose error bounds are
quoted in units of u^2 = 2^-106.
"""

import math

from rigid_body_sim.compiled import compiled

SPLITTER = 134217729.0     # 2^27 + 1


@compiled
def two_sum(a, b):
    """Return the exact sum of two doubles."""
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


@compiled
def quick_two_sum(a, b):
    """Return the exact sum of two doubles with |a| >= |b| or a = 0."""
    total = a + b
    return total, b - (total - a)


@compiled
def split(a):
    """Return the two halves of a double, of 26 bits each."""
    c = SPLITTER * a
    high = c - (c - a)
    return high, a - high


@compiled
def two_product(a, b):
    """Return the exact product of two doubles."""
    product = a * b
    ah, al = split(a)
    bh, bl = split(b)
    return product, al * bl - (((product - ah * bh) - al * bh) - ah * bl)


@compiled
def square(a):
    """Return the exact square of a double."""
    product = a * a
    ah, al = split(a)
    return product, al * al - ((product - ah * ah) - 2.0 * (ah * al))


@compiled
def add(a, al, b, bl):
    """Return a + b to 3 u^2 of the result, whatever the signs."""
    s, e = two_sum(a, b)
    t, f = two_sum(al, bl)
    s, e = quick_two_sum(s, e + t)
    return quick_two_sum(s, e + f)


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
    p, e = square(s)
    return quick_two_sum(s, ((a - p) - e + al) / (s + s))
