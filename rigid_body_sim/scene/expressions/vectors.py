# SPDX-License-Identifier: Apache-2.0
"""Vectors whose components are trees: for effects that write their energy as a formula."""

from rigid_body_sim.scene.expressions.source import ATTITUDE
from rigid_body_sim.scene.expressions.tree import TWO, minus, number, plus, term, times


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


def _turned(v, sign):
    """Return v + 2 w (u x v) + 2 u x (u x v) with q = (u, w), or with -u."""
    *u, w = (term('name', name) for name in ATTITUDE)
    across = cross(u, v)
    once = tuple(times(times(TWO, w), part) for part in across)
    twice = tuple(times(TWO, part) for part in cross(u, across))
    return total(total(v, once) if sign > 0 else difference(v, once), twice)


def to_world(v):
    """Return the world components of a body vector, as a function of the attitude."""
    return _turned(v, 1)


def to_body(v):
    """Return the body components of a world vector, as a function of the attitude."""
    return _turned(v, -1)
