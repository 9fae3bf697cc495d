# SPDX-License-Identifier: Apache-2.0
"""Drag: resistance in proportion to velocity (creeping flow; Stokes's law)."""

from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.bodies import Body
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism
from rigid_body_sim.scene.effects.protocol import Acting, Effect, Pull
from rigid_body_sim.scene.frame import Frame
from rigid_body_sim.scene.schema import mapping_of

COEFFICIENT = {'type': 'number', 'minimum': 0}


@dataclass(frozen=True)
class Drag(Effect):
    """``drag: {linear: c, angular: k}``; either may be left out (0).

    F = -c v at the centre of mass (c in N s/m = kg/s, v its velocity) and the couple -k omega (k
    in N m s). At a pivot or hinge F acts by its torque about the constraint. It does not act on
    the table, where rolling resistance would be another effect.
    """

    linear: float
    angular: float
    name: ClassVar[str] = 'drag'
    SCHEMA: ClassVar[dict] = mapping_of(linear=COEFFICIENT, angular=COEFFICIENT)
    mechanisms: ClassVar = (Mechanism.FREE, Mechanism.POINT, Mechanism.AXIS, Mechanism.PLANE)

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, constraint: Constraint,
                   where: str) -> Self:
        """Return the effect of its settings in a scene file; it needs a coefficient."""
        if not settings:
            raise BadInput(where, 'no coefficient',
                           'give linear (N s/m), angular (N m s), or both')
        return cls(float(settings.get('linear', 0.0)), float(settings.get('angular', 0.0)))

    def acting(self, frame: Frame, time: float) -> tuple[Acting, ...]:
        """Return force and couple; a coefficient of zero does not act."""
        acting = []
        if self.linear and frame.moves:
            acting.append(Acting(f'{__name__}:force', (self.linear,), 'force', 'heat'))
        elif self.linear and any(frame.arm):
            values = self.linear, *frame.arm
            acting.append(Acting(f'{__name__}:moment', values, 'torque', 'heat'))
        if self.angular:
            acting.append(Acting(f'{__name__}:couple', (self.angular,), 'torque', 'heat'))
        return tuple(acting)

    def series(self, frame: Frame, time: float) -> Pull:
        """Return the couple, and the force as a moment about a bearing or as it slows a flight."""
        x, y, z = frame.arm
        # the matrices of the kernels `couple` and `moment`, without the difference r^2 - z^2
        of_arm = np.array(((y * y + z * z, -x * y, -x * z), (-x * y, z * z + x * x, -y * z),
                           (-x * z, -y * z, x * x + y * y)))
        matrix = -self.angular * np.eye(3) - self.linear * of_arm
        first, second, third = matrix.tolist()
        return Pull(drag=(tuple(first), tuple(second), tuple(third)) if matrix.any() else None,
                    slowing=self.linear if frame.moves else 0.0)


@compiled
def force(c, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return -c v, N, world components."""
    return -c * vx, -c * vy, -c * vz


@compiled
def couple(k, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return -k omega, N m."""
    return -k * wx, -k * wy, -k * wz


@compiled
def moment(c, rx, ry, rz, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return r x (-c omega x r), N m.

    The products in turn round less than r^2 omega - (r . omega) r, of which a slim body would
    take the small difference along its axis.
    """
    ux, uy, uz = wy * rz - wz * ry, wz * rx - wx * rz, wx * ry - wy * rx
    return -c * (ry * uz - rz * uy), -c * (rz * ux - rx * uz), -c * (rx * uy - ry * ux)
