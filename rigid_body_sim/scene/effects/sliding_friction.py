# SPDX-License-Identifier: Apache-2.0
"""Sliding friction: Coulomb's law where a sphere touches the table (notes, "Billiard").

While the lowest point moves over the table with the slip velocity u != 0 the force on the ball is
-mu M g u/|u|; once u = 0 it rolls. The motion is solved in closed form by
rigid_body_sim/motions/sliding_sphere.py; held commands on the table are solved by
rigid_body_sim/integrators/marching/table.py.
"""

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Self

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.bodies import Body
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism
from rigid_body_sim.scene.effects.protocol import Contact, Effect
from rigid_body_sim.scene.painleve import painleve_bound
from rigid_body_sim.scene.schema import POSITIVE, described, mapping_of


@dataclass(frozen=True)
class SlidingFriction(Effect):
    """``sliding_friction: {mu: 0.2, g: 9.81}``.

    mu is the coefficient of sliding friction (0 is allowed), g the gravity that presses a ball on
    the table (m/s^2). A body with a surface has its weight from the effect gravity instead of g,
    and with ``mu: .inf`` it always rolls.
    """

    mu: float
    g: float
    name: ClassVar[str] = 'sliding_friction'
    SCHEMA: ClassVar[dict] = described(mapping_of(
        ['mu'],
        mu=described(
            {'type': 'number', 'minimum': 0},
            'coefficient; .inf: a body with a surface always rolls'),
        g=described(POSITIVE, 'm/s^2, the gravity on a ball without a surface')),
        'Coulomb: a body that slips has the force mu N against the velocity of its lowest '
        'point; booked as heat')
    mechanisms: ClassVar = (Mechanism.TABLE, Mechanism.PLANE)

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, constraint: Constraint,
                   where: str) -> Self:
        """Return the effect of its settings in a scene file."""
        mu = float(settings['mu'])
        if constraint.mechanism is Mechanism.PLANE:
            if 'g' in settings:
                raise BadInput(f'{where}.g', f'got {settings["g"]!r} for a body with a surface',
                               'its weight comes from the effect gravity: {g: 9.81}')
            return cls(mu, 0.0)
        if 'g' not in settings:
            raise BadInput(where, "the key 'g' is missing", 'needed: mu, g')
        if not math.isfinite(mu):
            raise BadInput(f'{where}.mu', f'got {mu!r}', 'needs a finite number')
        return cls(mu, float(settings['g']))

    @property
    def contact(self) -> Contact:
        """Coefficient of friction and gravity."""
        return Contact(self.mu, self.g)

    def notes(self, body: Body, constraint: Constraint) -> list[str]:
        """Warn of Painleve's paradox, where the coefficient of friction reaches its bound."""
        if constraint.mechanism is not Mechanism.PLANE or not math.isfinite(self.mu):
            return []
        bound = painleve_bound(body)
        if self.mu < bound:
            return []
        return [f"sliding_friction: mu = {self.mu!r} reaches mu_P = {bound:.6g}: in some attitude "
                "a slip meets Painleve's paradox, and a run that meets it ends there"]
