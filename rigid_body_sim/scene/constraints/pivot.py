# SPDX-License-Identifier: Apache-2.0
"""Pivot: a point of the body stays where it is, and the body turns about it in all directions."""

from dataclasses import dataclass
from typing import Any, ClassVar

from rigid_body_sim.numerics import rotations
from rigid_body_sim.numerics.vectors import cross, minus
from rigid_body_sim.scene import initial
from rigid_body_sim.scene.bodies import Body, Inertia, moved, refuse_beyond, square_of
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism, Vector
from rigid_body_sim.scene.initial import Start
from rigid_body_sim.scene.schema import VECTOR, mapping_of
from rigid_body_sim.scene.state import State


@dataclass(frozen=True)
class Pivot(Constraint):
    """``constraint: pivot``. The reference point is the body's origin.

    With a point `at` that is not the origin it is a :class:`DisplacedPivot`.
    """

    kind: ClassVar[str] = 'pivot'
    usage: ClassVar[str] = 'pivot'
    INITIAL: ClassVar[dict] = {**initial.ORIENTATION, **initial.TILT, **initial.TURNING,
                               **initial.PLACE}
    mechanism: ClassVar[Mechanism] = Mechanism.POINT
    starts_as_given: ClassVar[bool] = True

    @classmethod
    def variant(cls, body: Body, settings: Any) -> type[Constraint]:
        """Return DisplacedPivot where settings are given."""
        return DisplacedPivot if settings else cls

    def initial(self, start: Start, body: Body, where: str) -> State:
        """Return the state as it is given; the origin is at rest."""
        start.refuse_spin_without_moment(body.about_origin, where)
        return start.state()

    def point(self, body: Body) -> Vector:
        """Return the body's origin."""
        return 0.0, 0.0, 0.0

    def inertia(self, body: Body) -> Inertia:
        """Return the tensor about the body's origin."""
        return body.about_origin


@dataclass(frozen=True)
class DisplacedPivot(Constraint):
    """``constraint: {pivot: {at: [x, y, z]}}``: the point `at` (body axes, m) is held.

    `initial.position` is where it is in the world. The motions in closed form hold the body's
    origin, so such a body is followed step by step: put the origin there where one is wanted.
    """

    at: Vector = (0.0, 0.0, 0.0)
    kind: ClassVar[str] = 'displaced_pivot'
    usage: ClassVar[str] = 'pivot: {at: [x, y, z]}'
    SCHEMA: ClassVar[dict | None] = mapping_of(['at'], at=VECTOR)
    INITIAL: ClassVar[dict] = Pivot.INITIAL
    mechanism: ClassVar[Mechanism] = Mechanism.POINT

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, where: str) -> Any:
        """Return the pivot at its point; a Pivot where that is the body's origin."""
        x, y, z = map(float, settings['at'])
        if not any((x, y, z)):
            return Pivot()
        refuse_beyond(body.mass * square_of((x, y, z)), where)
        return cls((x, y, z))

    def initial(self, start: Start, body: Body, where: str) -> State:
        """Return the state as it is given; the point is at rest."""
        start.refuse_spin_without_moment(self.inertia(body), where)
        arm = rotations.rotate(*start.orientation, *self.at)
        velocity = cross(arm, rotations.rotate(*start.orientation, *start.omega))
        return State.of(0.0, start.orientation, start.omega, minus(start.position, arm), velocity)

    def point(self, body: Body) -> Vector:
        """Return the point `at`."""
        return self.at

    def inertia(self, body: Body) -> Inertia:
        """Return the tensor about the point `at`."""
        return moved(body.about_center, body.mass, self.arm(body), 1.0)
