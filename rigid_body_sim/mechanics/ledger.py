# SPDX-License-Identifier: Apache-2.0
"""The ledger of a body: energy and angular momentum now, at the start, and the entries in between.

The entries are the work, the heat and the angular impulse of commands, strikes and effects.
"""

import math
from typing import NamedTuple

from rigid_body_sim.compilation.layout import Vector, layout
from rigid_body_sim.mechanics.energy import DIAGNOSIS
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.vectors import minus
from rigid_body_sim.scene.constraints.protocol import Mechanism


class Entries(NamedTuple):
    """The entries of the ledger since a start.

    Attributes
    ----------
    work : float
        Done on the body, J.
    dissipated : float
        Energy turned into heat, J.
    angular_impulse : Vector
        About the point of reference (parameters.py), world axes, N m s.
    """

    work: float
    dissipated: float
    angular_impulse: Vector


ENTRIES = layout(Entries)
ENTRIES_SIZE = ENTRIES.size
WORK, DISSIPATED = ENTRIES.part('work').first, ENTRIES.part('dissipated').first
ANGULAR_IMPULSE = ENTRIES.part('angular_impulse').places

HEATS = ('dissipated_sliding', 'dissipated_rolling', 'dissipated_air_film', 'dissipated_impacts',
         'dissipated_spinning')
"""Causes of heat at a plane (J): they follow the entries of a body on it."""


def entries_size(scene):
    """Return the number of entries of the ledger of a scene, its causes of heat included."""
    on_plane = scene.constraint.mechanism is Mechanism.PLANE
    return ENTRIES_SIZE + (len(HEATS) if on_plane else 0)


def most(passed, entries):
    """Return the largest energy (J) and angular impulse (N m s) of entries, and of some before."""
    work, dissipated, impulse = ENTRIES.load(entries.tolist())
    return max(passed[0], abs(work), abs(dissipated)), max(passed[1], hypot3(*impulse))


def balance(start, now, entries, passed=(0.0, 0.0)):
    """Return the balance of energy (J) and angular momentum (kg m^2/s), as a dict of floats.

    ``energy_residual`` is the remainder of the terms, relative to the largest of |kinetic|,
    |potential|, |work| and the energy passed; ``momentum_residual`` is
    |L - L(0) - angular impulse| relative to the largest of the three and the momentum passed.

    Parameters
    ----------
    start, now : array (6,)
        Diagnosis.
    entries : array (5,) or longer
        The Entries from start to now, and after them the HEATS of a body on a plane.
    passed : tuple of 2 floats
        Energy (J) and angular momentum (kg m^2/s) of the body on its way (bounds.passed): one that
        is let go passes through them and is at rest again where it turns back.
    """
    causes = dict(zip(HEATS, entries[ENTRIES_SIZE:].tolist(), strict=False))
    start, now = DIAGNOSIS.load(start.tolist()), DIAGNOSIS.load(now.tolist())
    work, dissipated, impulse = ENTRIES.load(entries.tolist())
    left = math.fsum((now.kinetic, now.potential, dissipated,
                      -start.kinetic, -start.potential, -work))
    scale = max(now.kinetic, abs(now.potential), abs(work), start.kinetic, abs(start.potential),
                passed[0])
    missing = hypot3(*minus(minus(now.momentum, start.momentum), impulse))
    size = max(passed[1], *(hypot3(*vector) for vector in (now.momentum, start.momentum, impulse)))
    return {'kinetic': now.kinetic, 'potential': now.potential, 'dissipated': dissipated,
            'work': work, 'energy_residual': left / scale if scale > 0.0 else 0.0,
            'angular_momentum_squared': now.momentum_squared,
            'momentum_residual': missing / size if size > 0.0 else 0.0, **causes}
