# SPDX-License-Identifier: Apache-2.0
"""Vectors whose components are pairs of doubles (pairs.py), as tuples.

They serve slim bodies, where the rounding of a large component across the body, turned into its
axes, would be divided by the small moment.
"""

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.numerics.double_double import add, multiply, two_product, two_sum
from rigid_body_sim.numerics.pairs import over


@compiled
def with_low(high, low):
    """Return two vectors of doubles, rounded numbers and what they lost, as one of pairs."""
    return two_sum(high[0], low[0]), two_sum(high[1], low[1]), two_sum(high[2], low[2])


@compiled
def difference(a, b):
    """Return a - b of two vectors of doubles, exactly."""
    return with_low(a, (-b[0], -b[1], -b[2]))


@compiled
def less(v, a):
    """Return v - a as doubles; a is a vector of doubles."""
    return (v[0][0] - a[0]) + v[0][1], (v[1][0] - a[1]) + v[1][1], (v[2][0] - a[2]) + v[2][1]


@compiled
def plus(a, b):
    """Return a + b."""
    return _sum(a[0], b[0]), _sum(a[1], b[1]), _sum(a[2], b[2])


@compiled
def dot(a, b):
    """Return a . b, a pair."""
    return _sum(_sum(_product(a[0], b[0]), _product(a[1], b[1])), _product(a[2], b[2]))


@compiled
def cross(a, b):
    """Return a x b."""
    return (_sum(_product(a[1], b[2]), _negative(_product(a[2], b[1]))),
            _sum(_product(a[2], b[0]), _negative(_product(a[0], b[2]))),
            _sum(_product(a[0], b[1]), _negative(_product(a[1], b[0]))))


@compiled
def turned(qx, qy, qz, qw, v):
    """Return the world components of the body vector v, for a quaternion of any norm.

    They are ((w^2 - u^2) v + 2 (u . v) u + 2 w (u x v))/(w^2 + u^2) with u = (qx, qy, qz).
    """
    u, w = ((qx, 0.0), (qy, 0.0), (qz, 0.0)), (qw, 0.0)
    square, rest = dot(u, u), two_product(qw, qw)
    before, inside = _sum(rest, _negative(square)), _twice(dot(u, v))
    side, norm, twice = cross(u, v), _sum(rest, square), _twice(w)
    return (_part(before, v[0], inside, u[0], twice, side[0], norm),
            _part(before, v[1], inside, u[1], twice, side[1], norm),
            _part(before, v[2], inside, u[2], twice, side[2], norm))


@compiled
def turned_back(qx, qy, qz, qw, v):
    """Return the body components of the world vector v, for a quaternion of any norm."""
    return turned(-qx, -qy, -qz, qw, v)


@compiled
def _part(a, x, b, y, c, z, norm):
    return over(_sum(_sum(_product(a, x), _product(b, y)), _product(c, z)), norm)


@compiled
def _sum(a, b):
    return add(a[0], a[1], b[0], b[1])


@compiled
def _product(a, b):
    return multiply(a[0], a[1], b[0], b[1])


@compiled
def _negative(a):
    return -a[0], -a[1]


@compiled
def _twice(a):
    return 2.0 * a[0], 2.0 * a[1]
