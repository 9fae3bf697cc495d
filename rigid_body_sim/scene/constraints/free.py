# SPDX-License-Identifier: Apache-2.0
"""Free: nothing holds the body."""

from dataclasses import dataclass
from typing import ClassVar

from rigid_body_sim.scene import initial
from rigid_body_sim.scene.bodies import Body
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism
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
    starts_as_given: ClassVar[bool] = True

    def initial(self, start: Start, body: Body, where: str) -> State:
        """Return the state as it is given, the velocity being that of the body's origin."""
        start.refuse_spin_without_moment(body.about_center, where)
        return start.state()
