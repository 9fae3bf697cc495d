# SPDX-License-Identifier: Apache-2.0
"""Pivot: the body's origin stays where it is, and the body turns about it in all directions."""

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from rigid_body_sim.scene import initial
from rigid_body_sim.scene.bodies import Body, Inertia
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism, Vector
from rigid_body_sim.scene.frame import Frame, turned_back
from rigid_body_sim.scene.initial import Start
from rigid_body_sim.scene.state import State


@dataclass(frozen=True)
class Pivot(Constraint):
    """``constraint: pivot``. The reference point is the body's origin."""

    kind: ClassVar[str] = 'pivot'
    usage: ClassVar[str] = 'pivot'
    INITIAL: ClassVar[dict] = {**initial.ORIENTATION, **initial.TILT, **initial.TURNING,
                               **initial.PLACE}
    mechanism: ClassVar[Mechanism] = Mechanism.POINT

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, where: str) -> Self:
        """Return the constraint; there is nothing to set."""
        return cls()

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

    def frame(self, body: Body) -> Frame:
        """Return the principal axes about the body's origin."""
        inertia = body.about_origin
        return Frame(False, body.mass, inertia.moments, inertia.axes, (0.0, 0.0, 0.0),
                     turned_back(inertia.axes, body.center_of_mass))
