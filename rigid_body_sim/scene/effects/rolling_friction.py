# SPDX-License-Identifier: Apache-2.0
"""Rolling friction: a force against the motion of the point of contact over a body's surface."""

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.bodies import Body
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism
from rigid_body_sim.scene.effects.protocol import Contact, Effect
from rigid_body_sim.scene.schema import described, mapping_of

COEFFICIENT = {'type': 'number', 'minimum': 0}


@dataclass(frozen=True)
class RollingFriction(Effect):
    """``rolling_friction: {dry: C, viscous: c}``; either may be left out (0).

    With s' the velocity of the point of contact over the surface of the body, the force
    C N + c |s'| acts against s' (N the normal force, c in N s/m). On a sphere of radius R this is
    the couple R (C N + c R |omega_t|) against the rolling, on a disk the friction of its contour
    (R. Leine, Arch. Appl. Mech. 79 (2009) 1063). At s' = 0 dry friction holds with up to C N.
    """

    dry: float
    viscous: float
    name: ClassVar[str] = 'rolling_friction'
    SCHEMA: ClassVar[dict] = described(mapping_of(
        dry=described(COEFFICIENT, 'C, a share of the normal force N', 0),
        viscous=described(COEFFICIENT, 'c in N s/m', 0)),
        "the force C N + c u against the velocity u of the point of contact over the body's "
        'surface; booked as heat')
    mechanisms: ClassVar = (Mechanism.PLANE,)

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, constraint: Constraint,
                   where: str) -> Self:
        """Return the effect of its settings in a scene file; it needs a coefficient."""
        if not settings:
            raise BadInput(where, 'no coefficient', 'give dry, viscous (N s/m), or both')
        return cls(float(settings.get('dry', 0.0)), float(settings.get('viscous', 0.0)))

    @property
    def contact(self) -> Contact:
        """Return the two coefficients."""
        return Contact(rolling=self.dry, rolling_viscous=self.viscous)
