# SPDX-License-Identifier: Apache-2.0
"""Pivot: the body's origin stays where it is, and the body turns about it in all directions."""

from dataclasses import dataclass
from typing import ClassVar

from rigid_body_sim.scene import initial
from rigid_body_sim.scene.bodies import Body, Inertia
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism, Vector
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
    starts_as_given: ClassVar[bool] = True

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
