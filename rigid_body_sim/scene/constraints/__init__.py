# SPDX-License-Identifier: Apache-2.0
"""The table of constraints: one file each, one line each.

protocol.py says what a constraint offers. This folder imports numerics and its neighbours in
scene/, but no effect.
"""

from rigid_body_sim.scene.constraints.free import Free
from rigid_body_sim.scene.constraints.hinge import Hinge
from rigid_body_sim.scene.constraints.pivot import DisplacedPivot, MovingPivot, Pivot
from rigid_body_sim.scene.constraints.plane import Plane
from rigid_body_sim.scene.constraints.protocol import Constraint
from rigid_body_sim.scene.constraints.table import Table

__all__ = ['CONSTRAINTS', 'Constraint', 'DisplacedPivot', 'Free', 'Hinge', 'MovingPivot', 'Pivot',
           'Plane', 'Table']

CONSTRAINTS: dict[str, type[Constraint]] = {
    constraint.kind: constraint for constraint in (Free, Pivot, Hinge, Table)}
"""What `constraint: table` means depends on the body: a Table or a Plane (table.py)."""
