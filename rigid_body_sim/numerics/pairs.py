# SPDX-License-Identifier: Apache-2.0
"""Pairs of doubles (double_double.py) as tuples, for formulas such as ``plus(times(n, x), c)``.

Sums and differences are exact to 2 u^2 of their larger term, u = 2^-53.
"""

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.numerics.double_double import add_alike, divide, multiply, root, two_product

TURN = 0.15915494309189535, -9.839338337591243e-18        # 1/(2 pi), turns per radian


def pair_of(number):
    """Return an exact number (int, float, Fraction) as a pair."""
    return quotient(*number.as_integer_ratio())


def quotient(a, b):
    """Return a/b of two integers, b > 0, as a pair: each part is rounded once."""
    high = a / b
    over, under = high.as_integer_ratio()
    return high, (a * under - over * b) / (b * under)


def quotient_of(a, b):
    """Return a/b of two doubles, b > 0, as a pair: each part is rounded once."""
    (over, of_a), (under, of_b) = a.as_integer_ratio(), b.as_integer_ratio()
    return quotient(over * of_b, of_a * under)


def in_integers(numbers):
    """Return doubles as integers over a common one: a list of integers, and the one."""
    # most numbers of a scene are 0
    ratios = [number.as_integer_ratio() if number else (0, 1) for number in numbers]
    one = max([under for _, under in ratios])    # powers of two
    return [over and over * (one // under) for over, under in ratios], one


@compiled
def plus(p, q):
    """Return the sum of two pairs."""
    return add_alike(p[0], p[1], q[0], q[1])


@compiled
def minus(p, q):
    """Return the difference of two pairs."""
    return add_alike(p[0], p[1], -q[0], -q[1])


@compiled
def times(p, q):
    """Return the product of two pairs."""
    return multiply(p[0], p[1], q[0], q[1])


@compiled
def over(p, q):
    """Return the quotient of two pairs, or 0 where the divisor is 0."""
    if q[0] == 0.0:
        return 0.0, 0.0
    return divide(p[0], p[1], q[0], q[1])


@compiled
def scaled(p, factor):
    """Return a pair times a power of two."""
    return factor * p[0], factor * p[1]


@compiled
def root_of(p):
    """Return the square root of a pair."""
    return root(p[0], p[1])


@compiled
def products(a, b, c, d):
    """Return a b + c d for doubles, as a pair."""
    return plus(two_product(a, b), two_product(c, d))


@compiled
def not_negative(p):
    """Return the pair, or 0 if it is negative."""
    return p if p[0] > 0.0 else (0.0, 0.0)


@compiled
def put(out, place, p):
    """Store a pair in an array, high part first."""
    out[place], out[place + 1] = p


@compiled
def pair_at(stored, place):
    """Return a pair stored by :func:`put`."""
    return stored[place], stored[place + 1]
