# SPDX-License-Identifier: Apache-2.0
"""The contract of a constraint: what it declares, and what it makes of a body.

A constraint is a frozen dataclass that inherits :class:`Constraint`, one file in this folder.
docs/extending adds one step by step.
"""

import enum
from fractions import Fraction
from typing import Any, ClassVar, Protocol, Self

from rigid_body_sim.numerics.vectors import minus
from rigid_body_sim.scene.bodies import Body, Inertia
from rigid_body_sim.scene.expressions.path import Path
from rigid_body_sim.scene.frame import Frame, along
from rigid_body_sim.scene.initial import Start
from rigid_body_sim.scene.state import State

Vector = tuple[float, float, float]


class Mechanism(enum.IntEnum):
    """The free directions of a body: the code by which compiled kernels branch.

    FREE moves and turns in all directions. POINT turns about a point that a bearing holds. AXIS
    turns about an axis that a bearing holds. TABLE is a sphere that rolls or slides on a plane.
    PLANE is a convex body that flies, slides or rolls over a plane; kernels that know nothing of
    the plane take it as a free body between impacts.
    """

    FREE = 0
    POINT = 1
    AXIS = 2
    TABLE = 3
    PLANE = 4


class Constraint(Protocol):
    """What holds the body.

    Attributes
    ----------
    kind : str
        The word for it in a scene file.
    usage : str
        How to write it in a scene file, for error lines.
    SCHEMA : dict or None
        JSON schema of its settings in a scene file; None if it takes none.
    INITIAL : dict of str to dict
        JSON schemas of the keys that `initial` may have under it.
    mechanism : Mechanism
        Which directions are free.
    starts_as_given : bool
        Whether `initial` takes the orientation, velocities and place of the scene file as they
        are, for any body. Sweeps then make starts without the scene file.
    """

    kind: ClassVar[str]
    usage: ClassVar[str]
    SCHEMA: ClassVar[dict[str, Any] | None] = None
    INITIAL: ClassVar[dict[str, dict[str, Any]]]
    mechanism: ClassVar[Mechanism]
    starts_as_given: ClassVar[bool] = False

    @classmethod
    def variant(cls, body: Body, settings: Any) -> 'type[Constraint]':
        """Return the class that the word in a scene file means for a body and the settings."""
        return cls

    @classmethod
    def variants(cls) -> 'tuple[type[Constraint], ...]':
        """Return all classes that `variant` may return."""
        return cls,

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, where: str) -> Self:
        """Return the constraint of its settings in a scene file.

        Parameters
        ----------
        settings : dict
            They satisfy SCHEMA, and all numbers are finite; empty if there are none.
        body : Body
        where : str
            File and key path, for error lines.

        Raises
        ------
        BadInput
            For a body that it cannot hold, and for what SCHEMA cannot say.
        """
        return cls()

    def begun(self, start: Start) -> Self:
        """Return the constraint with the numbers that it takes from the initial conditions."""
        return self

    def wound(self) -> Self:
        """Return the constraint of a body that may turn to where what acts jumps (frame.py)."""
        return self

    def initial(self, start: Start, body: Body, where: str) -> State:
        """Return the state at time 0.

        Parameters
        ----------
        start : Start
            The initial conditions of the scene file; only keys of INITIAL are given.
        body : Body
        where : str
            File and key path, for error lines.

        Raises
        ------
        BadInput
            For a state that the constraint does not allow.
        """
        ...

    def point(self, body: Body) -> Vector:
        """Return the reference point of the equations of motion, body axes, m.

        It is the centre of mass unless the constraint holds a point.
        """
        return body.center_of_mass

    def inertia(self, body: Body) -> Inertia:
        """Return the tensor that the kernels take.

        It is about the held point where the mechanism is POINT, else about the centre of mass.
        """
        return body.about_center

    def frame(self, body: Body) -> Frame:
        """Return the frame in which the equations of motion of a body are written.

        Its axes are the principal axes of the tensor.
        """
        inertia = self.inertia(body)
        arm = 0.0, 0.0, 0.0
        if self.holds_a_point:
            # doubles lose nothing of a difference of two but its last rounding
            exactly = inertia.rows or any(body.center_lost)
            given = self.exact_arm(body) if exactly else self.arm(body)
            arm = along(inertia.axes, inertia.rows, given)
        return Frame(not self.holds_a_point, body.mass, inertia.moments, inertia.differences,
                     inertia.axes, self.point(body), arm, rows=inertia.rows)

    @property
    def axis(self) -> Vector | None:
        """Unit vector of the only axis the body can turn about, body axes; None if it has more."""
        return None

    @property
    def path(self) -> Path | None:
        """The path of the point that it holds (expressions/path.py); None if it stays."""
        return None

    @property
    def holds_a_point(self) -> bool:
        """Whether a bearing holds a point of the body: forces act by their torque about it."""
        return self.mechanism in (Mechanism.POINT, Mechanism.AXIS)

    def arm(self, body: Body) -> Vector:
        """Return the vector from the reference point to the centre of mass, body axes, m."""
        x, y, z = minus(body.center_of_mass, self.point(body))
        return x, y, z

    def exact_arm(self, body: Body) -> tuple[Fraction, Fraction, Fraction]:
        """Return the same before it is rounded."""
        x, y, z = minus(body.exact_center, tuple(map(Fraction, self.point(body))))
        return x, y, z
