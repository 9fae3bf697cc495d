# SPDX-License-Identifier: Apache-2.0
"""Sliding friction: Coulomb's law where a sphere touches the table (notes, "Billiard").

While the lowest point moves over the table with the slip velocity u != 0 the force on the ball is
-mu M g u/|u|; once u = 0 it rolls. The motion is solved in closed form by
rigid_body_sim/motions/sliding_sphere.py; held commands on the table are solved by
rigid_body_sim/integrators/marching/table.py.
"""

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from rigid_body_sim.scene.bodies import Body
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism
from rigid_body_sim.scene.effects.protocol import Contact, Effect
from rigid_body_sim.scene.schema import POSITIVE, mapping_of


@dataclass(frozen=True)
class SlidingFriction(Effect):
    """``sliding_friction: {mu: 0.2, g: 9.81}``.

    mu is the coefficient of sliding friction (0 is allowed), g the gravity that presses the ball on
    the table (m/s^2).
    """

    mu: float
    g: float
    name: ClassVar[str] = 'sliding_friction'
    SCHEMA: ClassVar[dict] = mapping_of(['mu', 'g'], mu={'type': 'number', 'minimum': 0},
                                        g=POSITIVE)
    mechanisms: ClassVar = (Mechanism.TABLE,)

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, constraint: Constraint,
                   where: str) -> Self:
        """Return the effect of its settings in a scene file."""
        return cls(float(settings['mu']), float(settings['g']))

    @property
    def contact(self) -> Contact:
        """Coefficient of friction and gravity."""
        return Contact(self.mu, self.g)
