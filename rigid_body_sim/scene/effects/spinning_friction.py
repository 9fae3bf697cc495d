# SPDX-License-Identifier: Apache-2.0
"""Spinning friction: a patch of contact resists a spin about the normal, and shares its slip."""

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from rigid_body_sim.scene.bodies import Body
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism
from rigid_body_sim.scene.effects.protocol import Contact, Effect
from rigid_body_sim.scene.schema import POSITIVE, described, mapping_of


@dataclass(frozen=True)
class SpinningFriction(Effect):
    """``spinning_friction: {radius: rho}``, rho in m; it needs sliding_friction.

    With u the slip, w the spin about the normal and S = sqrt(u^2 + (rho w)^2) the friction is the
    force -mu N u/S and the couple -mu N rho^2 w/S: Coulomb's law in the three directions u and rho
    w, whose limit surface is an ellipsoid (R. Howe, M. Cutkosky, Int. J. Robotics Res. 15 (1996)
    531). So a spinning body slips as in a viscous fluid, and a pure spin meets the couple mu N
    rho: rho is 3 pi/16 of the radius of a patch with Hertz' pressure, 2/3 of one with a uniform
    pressure.
    """

    radius: float
    name: ClassVar[str] = 'spinning_friction'
    SCHEMA: ClassVar[dict] = described(mapping_of(
        ['radius'],
        radius=described(POSITIVE, 'm')),
        'a patch of contact: the couple mu N radius against the spin about the normal; '
        'booked as heat')
    mechanisms: ClassVar = (Mechanism.PLANE,)

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, constraint: Constraint,
                   where: str) -> Self:
        """Return the effect of its settings in a scene file."""
        return cls(float(settings['radius']))

    @property
    def contact(self) -> Contact:
        """Return the radius."""
        return Contact(patch=self.radius)
