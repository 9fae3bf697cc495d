# SPDX-License-Identifier: Apache-2.0
"""A body on a hinge in exact numbers: the rationals that the doubles of a scene are."""

import functools
import math
from fractions import Fraction
from typing import NamedTuple

from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.scene import principal_axes
from rigid_body_sim.scene.bodies import IDENTITY

KEPT = 64    # hinges whose exact numbers are kept for bodies that differ in other things


class Axle(NamedTuple):
    """A body on a hinge, in exact numbers; vectors in body axes."""

    axis: list[Fraction]       # n
    arm: list[Fraction]        # r, m
    distance: Fraction         # centre of mass to axis, m; 0 to rounding of the scene
    momentum: list[Fraction]   # the tensor about `through` times n, kg m^2
    moment: Fraction           # about n, kg m^2


def axle(scene):
    """Return the Axle of a scene whose constraint holds an axis."""
    return axle_of(*held_of(scene))


def held_of(scene):
    """Return what an Axle depends on: axis, centre of mass, point, mass and inertia."""
    body, constraint = scene.body, scene.constraint
    return (tuple(constraint.axis), tuple(body.center_of_mass), tuple(constraint.point(body)),
            body.mass, body.about_center)


@functools.lru_cache(maxsize=KEPT)
def axle_of(axis, center, point, mass, inertia):
    """Return the Axle of what :func:`held_of` returns; it is kept."""
    n, r, d, across = swung(axis, center, point)
    spun, mass = _tensor_times(tuple(inertia.moments), tuple(inertia.axes), axis), Fraction(mass)
    momentum = [a - mass * b for a, b in zip(spun, across, strict=True)]
    return Axle(n, r, d, momentum, dot_exactly(n, momentum))


@functools.lru_cache(maxsize=KEPT)
def _unit(axis):
    """Return the unit vector along an axis, exactly."""
    axis = exact(axis)
    size = _root(dot_exactly(axis, axis))
    return tuple(component / size for component in axis)


@functools.lru_cache(maxsize=KEPT)
def swung(axis, center, point):
    """Return the unit vector n of an axis, r from a point to the centre, d, and r x (r x n)."""
    n = _unit(axis)
    r = tuple(c - t for c, t in zip(exact(center), exact(point), strict=True))
    side = cross_exactly(n, r)
    d = _root(dot_exactly(side, side))
    if d <= principal_axes.ULPS * (hypot3(*center) + hypot3(*point)):
        d = Fraction(0)         # on the axis, to the rounding of what the scene says
    return n, r, d, cross_exactly(r, cross_exactly(r, n))


def exact(numbers):
    """Return numbers as Fractions, a list."""
    return [Fraction(number) for number in numbers]


def dot_exactly(a, b):
    """Return the scalar product of vectors of Fractions."""
    return sum(x * y for x, y in zip(a, b, strict=True))


def cross_exactly(a, b):
    """Return the vector product of vectors of Fractions, a list."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def _root(number):
    """Return the square root of a Fraction, to 40 digits or more."""
    if not number:
        return number
    shift = max(0, 140 - (number.numerator.bit_length() - number.denominator.bit_length()) // 2)
    return Fraction(math.isqrt((number.numerator << 2 * shift) // number.denominator), 1 << shift)


@functools.lru_cache(maxsize=KEPT)
def _tensor_times(moments, axes, axis):
    """Return I n for principal moments and axes, n the unit vector along an axis."""
    n = _unit(axis)
    if axes == IDENTITY:
        return tuple(Fraction(moment) * along for moment, along in zip(moments, n, strict=True))
    x, y, z, w = exact(axes)
    norm = x * x + y * y + z * z + w * w
    columns = ((w * w + x * x - y * y - z * z, 2 * (x * y + z * w), 2 * (x * z - y * w)),
               (2 * (x * y - z * w), w * w + y * y - z * z - x * x, 2 * (y * z + x * w)),
               (2 * (x * z + y * w), 2 * (y * z - x * w), w * w + z * z - x * x - y * y))
    along = [Fraction(moment) * dot_exactly(column, n) / norm
             for moment, column in zip(moments, columns, strict=True)]
    return tuple(sum(a * column[k] for a, column in zip(along, columns, strict=True)) / norm
                 for k in range(3))
