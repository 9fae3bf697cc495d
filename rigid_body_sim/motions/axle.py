# SPDX-License-Identifier: Apache-2.0
"""A body on a hinge in exact numbers: the rationals that the doubles of a scene are.

They are kept as integers over a common one, which cost a tenth of fractions.
"""

import functools
import math
from fractions import Fraction
from typing import NamedTuple

from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.pairs import in_integers
from rigid_body_sim.numerics.vectors import cross, dot, minus, scaled
from rigid_body_sim.scene import principal_axes
from rigid_body_sim.scene.bodies import IDENTITY
from rigid_body_sim.scene.scene import kept

KEPT = 64    # hinges whose exact numbers are kept for bodies that differ in other things

Integers = tuple[int, int, int]


class Exact(NamedTuple):
    """A vector of rationals: integers over another one, which is positive."""

    integers: Integers
    over: int

    def rounded(self):
        """Return the nearest doubles."""
        x, y, z = self.integers
        return x / self.over, y / self.over, z / self.over


class Axle(NamedTuple):
    """A body on a hinge, in exact numbers; vectors in body axes."""

    axis: Exact                # n
    arm: Exact                 # r, m
    distance: tuple[int, int]  # centre of mass to axis, m: a quotient; 0 to the scene's rounding
    momentum: Exact            # the tensor about `through` times n, kg m^2
    moment: tuple[int, int]    # about n, kg m^2: the quotient of two integers


@kept
def axle(scene):
    """Return the Axle of a scene whose constraint holds an axis."""
    body, constraint = scene.body, scene.constraint
    return axle_of(constraint.axis, body.center_of_mass, constraint.point(body), body.mass,
                   body.about_center)


def axle_of(axis, center, point, mass, inertia):
    """Return the Axle of a body about an axis through a point."""
    n, r, d, across = swung(axis, center, point)
    spun = _tensor_times(inertia.moments, inertia.axes, axis)
    mass, unit = mass.as_integer_ratio()
    momentum = Exact(minus(scaled(across.over * unit, spun.integers),
                           scaled(spun.over * mass, across.integers)),
                     spun.over * across.over * unit)
    moment = dot(n.integers, momentum.integers), n.over * momentum.over
    return Axle(n, r, d, momentum, moment)


@functools.lru_cache(maxsize=KEPT)
def _unit(axis):
    """Return the unit vector along an axis, exactly."""
    along, one = in_integers(axis)
    size = Fraction(*root_of(dot(along, along), one * one))    # in lowest terms: it is kept
    return Exact(scaled(size.denominator, along), one * size.numerator)


@functools.lru_cache(maxsize=KEPT)
def swung(axis, center, point):
    """Return the unit vector n of an axis, r from a point to the centre, d, and r x (r x n)."""
    n = _unit(axis)
    (x, y, z, *held), one = in_integers((*center, *point))
    r = Exact(minus((x, y, z), held), one)
    side, over = cross(n.integers, r.integers), n.over * r.over
    d = size, one = root_of(dot(side, side), over * over)
    if size / one <= principal_axes.ULPS * (hypot3(*center) + hypot3(*point)):
        d = 0, 1    # on the axis, to the rounding of what the scene says
    return n, r, d, Exact(cross(side, r.integers), over * r.over)


def root_of(a, b):
    """Return the square root of a/b of two integers, to 40 digits or more, as such a quotient."""
    shift = max(0, 140 - (a.bit_length() - b.bit_length()) // 2)
    return math.isqrt((a << 2 * shift) // b), 1 << shift


@functools.lru_cache(maxsize=KEPT)
def _tensor_times(moments, axes, axis):
    """Return I n for principal moments and axes, n the unit vector along an axis."""
    n, (moments, unit) = _unit(axis), in_integers(moments)
    if axes == IDENTITY:
        along = [moment * x for moment, x in zip(moments, n.integers, strict=True)]
        return Exact(tuple(along), unit * n.over)
    (x, y, z, w), _ = in_integers(axes)
    norm = x * x + y * y + z * z + w * w
    columns = ((w * w + x * x - y * y - z * z, 2 * (x * y + z * w), 2 * (x * z - y * w)),
               (2 * (x * y - z * w), w * w + y * y - z * z - x * x, 2 * (y * z + x * w)),
               (2 * (x * z + y * w), 2 * (y * z - x * w), w * w + z * z - x * x - y * y))
    along = [moment * dot(column, n.integers)
             for moment, column in zip(moments, columns, strict=True)]
    rows = zip(*columns, strict=True)
    return Exact(tuple(dot(row, along) for row in rows), unit * n.over * norm * norm)
