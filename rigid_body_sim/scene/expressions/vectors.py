# SPDX-License-Identifier: Apache-2.0
"""Vectors whose components are trees: for effects that write their energy as a formula."""

from rigid_body_sim.scene.expressions.source import ATTITUDE
from rigid_body_sim.scene.expressions.tree import ONE, TWO, minus, number, plus, term, times


def constant(vector):
    """Return a vector of numbers as trees."""
    return tuple(number(part) for part in vector)


def named(names):
    """Return the vector of three names."""
    return tuple(term('name', name) for name in names)


def total(a, b):
    """Return a + b."""
    return tuple(map(plus, a, b))


def difference(a, b):
    """Return a - b."""
    return tuple(map(minus, a, b))


def scaled(c, a):
    """Return c a for a tree c."""
    return tuple(times(c, part) for part in a)


def apply(rows, a):
    """Return the product of a matrix of numbers and a."""
    return tuple(dot(constant(row), a) for row in rows)


def dot(a, b):
    """Return a . b."""
    x, y, z = map(times, a, b)
    return plus(plus(x, y), z)


def cross(a, b):
    """Return a x b."""
    (ax, ay, az), (bx, by, bz) = a, b
    return (minus(times(ay, bz), times(az, by)), minus(times(az, bx), times(ax, bz)),
            minus(times(ax, by), times(ay, bx)))


def _columns():
    """Return the columns of the matrix R that turns body components into world components.

    Series take it so: its ten products are the same in all that is turned, and what R multiplies
    takes nine more where u x (u x v) takes fifteen.
    """
    x, y, z, w = (term('name', name) for name in ATTITUDE)

    def diagonal(a, b):
        return minus(ONE, times(TWO, plus(times(a, a), times(b, b))))

    def beside(a, b, c, join):
        return times(TWO, join(times(a, b), times(c, w)))
    return ((diagonal(y, z), beside(x, y, z, plus), beside(x, z, y, minus)),
            (beside(x, y, z, minus), diagonal(x, z), beside(y, z, x, plus)),
            (beside(x, z, y, plus), beside(y, z, x, minus), diagonal(x, y)))


def to_world(v):
    """Return the world components of a body vector, as a function of the attitude."""
    return tuple(dot(row, v) for row in zip(*_columns(), strict=True))


def to_body(v):
    """Return the body components of a world vector, as a function of the attitude."""
    return tuple(dot(column, v) for column in _columns())
