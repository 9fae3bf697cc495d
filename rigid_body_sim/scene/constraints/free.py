# SPDX-License-Identifier: Apache-2.0
"""Free: nothing holds the body."""

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from rigid_body_sim.scene import initial
from rigid_body_sim.scene.bodies import Body, Inertia
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism, Vector
from rigid_body_sim.scene.frame import Frame
from rigid_body_sim.scene.initial import Start
from rigid_body_sim.scene.state import State


@dataclass(frozen=True)
class Free(Constraint):
    """``constraint: free``. The reference point is the centre of mass, which forces move."""

    kind: ClassVar[str] = 'free'
    usage: ClassVar[str] = 'free'
    INITIAL: ClassVar[dict] = {**initial.ORIENTATION, **initial.TILT, **initial.TURNING,
                               **initial.PLACE, **initial.MOTION}
    mechanism: ClassVar[Mechanism] = Mechanism.FREE

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, where: str) -> Self:
        """Return the constraint; there is nothing to set."""
        return cls()

    def initial(self, start: Start, body: Body, where: str) -> State:
        """Return the state as it is given, the velocity being that of the body's origin."""
        start.refuse_spin_without_moment(body.about_center, where)
        return start.state()

    def point(self, body: Body) -> Vector:
        """Return the centre of mass."""
        return body.center_of_mass

    def inertia(self, body: Body) -> Inertia:
        """Return the tensor about the centre of mass."""
        return body.about_center

    def frame(self, body: Body) -> Frame:
        """Return the principal axes about the centre of mass."""
        inertia = body.about_center
        return Frame(True, body.mass, inertia.moments, inertia.axes, body.center_of_mass,
                     (0.0, 0.0, 0.0))
