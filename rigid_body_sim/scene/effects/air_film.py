# SPDX-License-Identifier: Apache-2.0
"""Air film: the viscous air that a disk squeezes out as it rolls, almost flat, on a plane."""

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Self

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.bodies import Body
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism
from rigid_body_sim.scene.effects.protocol import Contact, Effect
from rigid_body_sim.scene.schema import POSITIVE, described, mapping_of


@dataclass(frozen=True)
class AirFilm(Effect):
    """``air_film: {viscosity: 1.8e-5}``: eta in Pa s, under a disk of radius R.

    H. K. Moffatt (Nature 404 (2000) 833) finds the power pi eta g R^2/a^2 for an inclination a and
    the rate Omega with Omega^2 = 4 g/(R a). Here it is the force -c s', c = pi eta R/(4 sin a),
    against the velocity s' of the point of contact along the edge, whose power is the same as a
    goes to 0.
    """

    coefficient: float
    name: ClassVar[str] = 'air_film'
    SCHEMA: ClassVar[dict] = described(mapping_of(
        ['viscosity'],
        viscosity=described(POSITIVE, 'Pa s')),
        "Moffatt's viscous layer under a disk at the inclination a: a force -c u/sin a, u as "
        'in rolling_friction; booked as heat')
    mechanisms: ClassVar = (Mechanism.PLANE,)

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, constraint: Constraint,
                   where: str) -> Self:
        """Return the effect of its settings in a scene file; it needs a disk."""
        assert body.surface is not None    # a plane takes no other body
        if body.surface.kind != 'disk':
            raise BadInput(where, f'got a surface {body.surface.kind!r}',
                           'the film of air is that under a disk with a sharp edge')
        return cls(0.25 * math.pi * float(settings['viscosity']) * body.surface.size[0])

    @property
    def contact(self) -> Contact:
        """Return the coefficient pi eta R/4."""
        return Contact(film=self.coefficient)
