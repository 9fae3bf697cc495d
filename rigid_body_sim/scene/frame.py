# SPDX-License-Identifier: Apache-2.0
"""The frame of a scene: where its equations of motion are written."""

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple

from rigid_body_sim.numerics import rotations
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.vectors import apply
from rigid_body_sim.scene.bodies import IDENTITY
from rigid_body_sim.scene.expressions.path import Path


class Hinging(NamedTuple):
    """The axis of a hinge, and where its angle is zero.

    Attributes
    ----------
    axis : tuple of 3 floats
        Unit vector, body axes.
    zero : tuple of 4 floats
        The orientation of the body, body to world, at the angle 0.
    winds : bool
        Whether the body may turn to an end of the angle where what acts jumps: then the jump is a
        kink.
    """

    axis: tuple[float, float, float]
    zero: tuple[float, float, float, float]
    winds: bool = False


class Frame(NamedTuple):
    """A reference point fixed in the body, and axes fixed in the body.

    A constraint makes the frame of a body: ``constraint.frame(body)``.

    Attributes
    ----------
    moves : bool
        True if the reference point is the centre of mass, which forces move. False if a bearing
        holds the point: then a force acts through its torque about the point.
    mass : float
        kg.
    moments : tuple of 3 floats
        Principal moments about the reference point, kg m^2. For a body on an axis they are about
        the centre of mass, and only the moment about the axis counts.
    differences : tuple of 3 floats
        I2 - I3, I3 - I1 and I1 - I2 of these moments before they were rounded, kg m^2.
    axes : tuple of 4 floats
        Quaternion that turns frame components into body components.
    point : tuple of 3 floats
        From the body's origin to the reference point, body components, m.
    arm : tuple of 3 floats
        From the reference point to the centre of mass, frame components, m.
    hinge : Hinging, optional
        Given for a body that turns about one axis only.
    path : Path, optional
        Given for a reference point that moves as the scene says (expressions/path.py).
    rows : tuple of 3 tuples of 3 Fractions
        The axes of the frame, body components, before they were rounded: given where the two
        differ, else empty.
    """

    moves: bool
    mass: float
    moments: tuple[float, float, float]
    differences: tuple[float, float, float]
    axes: tuple[float, float, float, float]
    point: tuple[float, float, float]
    arm: tuple[float, float, float]
    hinge: Hinging | None = None
    path: Path | None = None
    rows: tuple[tuple[Fraction, ...], ...] = ()

    @property
    def pushed(self) -> bool:
        """Whether forces count: they move the body, or do work on what carries it."""
        return self.moves or self.path is not None

    def from_body(self, vector: Sequence[float]) -> tuple[float, float, float]:
        """Return the frame components of a vector given in body components."""
        return along(self.axes, self.rows, vector)


def along(axes: tuple[float, float, float, float], rows: tuple[tuple[Fraction, ...], ...],
          vector: Sequence[float | Fraction]) -> tuple[float, float, float]:
    """Return the components of a body vector along axes, rounded once where there are `rows`.

    `axes` and `rows` are those of a Frame.
    """
    if not rows or not hypot3(*map(float, vector)) < math.inf:
        return turned_back(axes, vector)
    x, y, z = map(float, apply(rows, [Fraction(part) for part in vector]))
    return x, y, z


def turned_back(axes: tuple[float, float, float, float],
                vector: Sequence[float | Fraction]) -> tuple[float, float, float]:
    """Return the components of a body vector along axes that the quaternion turns into the body's.

    The vector stays the same to the last bit where the axes are the body's own.
    """
    x, y, z = map(float, vector)
    if axes == IDENTITY:
        return x, y, z
    x, y, z = map(float, rotations.rotate_back(*axes, x, y, z))
    return x, y, z
