# SPDX-License-Identifier: Apache-2.0
"""The numbers of a scene with a convex body on a plane."""

import math

from rigid_body_sim.errors import BadInput
from rigid_body_sim.mechanics.contact.parameters import CONTACT, ContactParameters
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.vectors import minus
from rigid_body_sim.scene.bodies import IDENTITY
from rigid_body_sim.scene.painleve import inverse_of
from rigid_body_sim.scene.surfaces import KINDS


def contact_parameters(scene):
    """Return the ContactParameters of a scene, an array."""
    body, plane = scene.body, scene.constraint
    surface, inertia = body.surface, tuple(map(tuple, body.about_center.matrix.tolist()))
    laws = scene.contact
    if laws.patch > 0.0 and not 0.0 < laws.mu < math.inf:
        raise BadInput(f'{scene.name}: effects.spinning_friction', f'with mu = {laws.mu!r}',
                       'sliding_friction with a finite mu above 0: its force is that of the patch')
    return CONTACT.array(ContactParameters(
        mode=0.0, mass=body.mass, center=body.center_of_mass,
        middle=minus(surface.center, body.center_of_mass), kind=KINDS[surface.kind],
        size=surface.size, inertia=inertia, inverse=inverse_of(inertia), uneven=_uneven(inertia),
        inclined=float(plane.axes != IDENTITY), plane=plane.axes,
        mu=laws.mu, restitution=plane.restitution, rolling=laws.rolling,
        rolling_viscous=laws.rolling_viscous, film=laws.film, patch=laws.patch,
        way=(1.0, 0.0), swift=0.0, creep=0.0, side=0.0, lag=0.0, wide=0.0, onset=0.0, turn=0.0,
        since=0.0, slack=0.0, rim=0.0, level=0.0, until=math.inf, began=0.0, origin=(0.0, 0.0)))


def _uneven(inertia):
    """Return a tensor less the unit matrix times the middle one of its diagonal entries."""
    middle = sorted(inertia[k][k] for k in range(3))[1]
    return tuple(tuple(entry - middle if i == j else entry for j, entry in enumerate(row))
                 for i, row in enumerate(inertia))


def weight(scene):
    """Return the gravity of a scene (m/s^2), by which its speeds are judged."""
    return hypot3(*scene.field)
