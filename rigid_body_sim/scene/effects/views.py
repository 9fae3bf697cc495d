"""What an effect shows of itself to the methods, and the frame in which it is written.

An effect is a frozen dataclass. The table of effects (rigid_body_sim/scene/effects/__init__.py) asks for

================ ==================================================================================================================
name             its word in a scene file
SCHEMA           JSON schema of its mapping there
constraints      the constraints under which it may act
repeatable       True if a scene may list it more than once
from_scene       (mapping, body, constraint, where) -> effect; raises BadInput
breakpoints      times (s) at which its values jump: a step ends there
================ ==================================================================================================================

and the methods for views. One that an effect lacks is simply not defined; a method that needs it then cannot run the scene and says so.

================ ==================================================================================================================
acting           (frame, time) -> tuple of Acting: the continuous right-hand side that holds just after `time` (view `rate`)
as_impulse       (body, vector) -> impulses of force and torque at its `time` (view `kick`)
series           (frame, time) -> Pull, or None where it is none: torque and force without quotients (view `series`)
flow             (frame) -> Flow: what the effect does alone over a time h (view `flow`, for compositions)
================ ==================================================================================================================

Every Acting says with `books` where its power is written in the ledger: potential | work | heat.
"""

from dataclasses import dataclass

import numpy as np

from rigid_body_sim.numerics import rotations
from rigid_body_sim.scene.bodies import IDENTITY


@dataclass(frozen=True)
class Frame:
    """Where the equations of motion of a scene are written: a reference point fixed in the body, and axes fixed in the body.

    Free and table: the centre of mass, principal axes. Pivot: the body's origin, principal axes about it. Hinge: its point, body axes.

    Attributes
    ----------
    kind : str
        Of the constraint.
    mass : float
        kg.
    moments : tuple of 3 floats
        Principal moments about the reference point, kg m^2 (unused for a hinge).
    axes : tuple of 4 floats
        Quaternion, turns frame components into body components.
    point : tuple of 3 floats
        Body origin -> reference point, body components, m.
    arm : tuple of 3 floats
        Reference point -> centre of mass, frame components, m.
    """

    kind: str
    mass: float
    moments: tuple
    axes: tuple
    point: tuple
    arm: tuple

    @classmethod
    def of(cls, body, constraint):
        """Return the frame of a body under a constraint."""
        kind, center = constraint.kind, body.center_of_mass
        if kind in ('free', 'table'):
            return cls(kind, body.mass, body.about_center.moments, body.about_center.axes, center, (0.0, 0.0, 0.0))
        if kind == 'hinge':
            arm = tuple(c - p for c, p in zip(center, constraint.through, strict=True))
            return cls(kind, body.mass, body.about_center.moments, IDENTITY, constraint.through, arm)
        axes = body.about_origin.axes
        return cls(kind, body.mass, body.about_origin.moments, axes, (0.0, 0.0, 0.0), turned_back(axes, center))

    def from_body(self, vector):
        """Return the frame components of a vector given in body components."""
        return turned_back(self.axes, vector)


def turned_back(axes, vector):
    """Return the components along the axes; to the last bit the same vector where the axes are not turned."""
    vector = tuple(float(x) for x in vector)
    return vector if tuple(axes) == IDENTITY else tuple(float(x) for x in rotations.rotate_back(*axes, *vector))


@dataclass(frozen=True)
class Acting:
    """A force or a couple that acts as long as its values hold.

    Attributes
    ----------
    kernel : str
        ``'package.module:function'`` with the signature ``(value, ..., value, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz)``: the attitude of
        the frame, its angular velocity (frame components), the velocity of the centre of mass (world); returns three components.
    values : tuple of floats
    gives : str
        ``force`` (world components, at the centre of mass; free body and table), ``torque`` (frame components, about the reference point)
        or ``turning`` (frame components of an extra rate at which the axes turn under a constant angular momentum).
    books : str
        ``potential``, ``work`` or ``heat``.
    """

    kernel: str
    values: tuple
    gives: str
    books: str


@dataclass(frozen=True)
class Pull:
    """What turns or moves a body without quotients and roots.

    Attributes
    ----------
    constant : tuple of 3 floats
        Torque about the reference point, frame components (N m).
    force : tuple of 3 floats, optional
        At the centre of mass, world components (N): it turns a pivoted body by arm x R^T force, and moves a free one.
    couple : tuple of 3 floats, optional
        World components (N m).
    drag : tuple of 3 tuples of 3 floats, optional
        Rows of the matrix that makes a torque of omega, frame components (N m s).
    slowing : float
        c of a force -c v at the centre of mass of a free body (N s/m).
    """

    constant: tuple = (0.0, 0.0, 0.0)
    force: tuple | None = None
    couple: tuple | None = None
    drag: tuple | None = None
    slowing: float = 0.0


def as_floats(values):
    """Return a tuple of floats of a sequence from a scene file."""
    return tuple(np.asarray(values, dtype=float).tolist())
