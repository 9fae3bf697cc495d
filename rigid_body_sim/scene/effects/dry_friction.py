# SPDX-License-Identifier: Apache-2.0
"""Dry friction at a hinge: a torque of one size against the rate, which holds what rests."""

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.numerics.vectors import scaled
from rigid_body_sim.scene.bodies import Body
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism
from rigid_body_sim.scene.effects.protocol import Acting, Effect
from rigid_body_sim.scene.expressions.functions import side
from rigid_body_sim.scene.frame import Frame
from rigid_body_sim.scene.schema import POSITIVE, described, mapping_of


@dataclass(frozen=True)
class DryFriction(Effect):
    """``dry_friction: {torque: T}``: T in N m, at a hinge.

    The torque is -T sign(rate) about the axis while the body turns. When the rate reaches zero,
    the body stays at rest for as long as all other torques about the axis add up to at most T.
    """

    torque: float
    name: ClassVar[str] = 'dry_friction'
    SCHEMA: ClassVar[dict] = described(mapping_of(
        ['torque'],
        torque=described(POSITIVE, 'N m')),
        'the torque -torque sign(rate) about the hinge; at rest it balances up to this torque; '
        'booked as heat')
    mechanisms: ClassVar = (Mechanism.AXIS,)

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, constraint: Constraint,
                   where: str) -> Self:
        """Return the effect of its settings in a scene file."""
        return cls(float(settings['torque']))

    def acting(self, frame: Frame, time: float) -> tuple[Acting, ...]:
        """Return the couple."""
        assert frame.hinge is not None    # mechanisms has no others
        values = self.torque, 0.0, *frame.from_body(frame.hinge.axis)
        return Acting(f'{__name__}:couple', values, 'torque', 'heat',
                      switching=f'{__name__}:switches', modes=(1,), grip=self.torque),

    @property
    def grip(self) -> float:
        """The torque that it bears, N m."""
        return self.torque


@compiled
def couple(torque, mode, nx, ny, nz, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return -T sign(rate) n, N m; nothing at rest."""
    return scaled(-torque * side(mode, nx * wx + ny * wy + nz * wz), (nx, ny, nz))


@compiled
def switches(torque, mode, nx, ny, nz, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return the rate, rad/s."""
    return (nx * wx + ny * wy + nz * wz,)
