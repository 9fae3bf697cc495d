# SPDX-License-Identifier: Apache-2.0
"""Gravity: a uniform field along -z of the world.

It moves a free body's centre of mass and turns a pivoted or hinged body.
"""

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.vectors import across
from rigid_body_sim.scene.bodies import Body
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism
from rigid_body_sim.scene.effects.protocol import Acting, Bounds, Effect, Potential, Pull
from rigid_body_sim.scene.frame import Frame
from rigid_body_sim.scene.schema import mapping_of


@dataclass(frozen=True)
class Gravity(Effect):
    """``gravity: {g: 9.81}``; g in m/s^2, zero or positive.

    Free body: F = -M g z at the centre of mass, no couple about it. Pivot, hinge: the torque r x F
    about the constraint (notes, "Symmetric Top in a uniform gravitational field").
    """

    g: float
    name: ClassVar[str] = 'gravity'
    SCHEMA: ClassVar[dict] = mapping_of(['g'], g={'type': 'number', 'minimum': 0})
    mechanisms: ClassVar = (Mechanism.FREE, Mechanism.POINT, Mechanism.AXIS, Mechanism.PLANE)

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, constraint: Constraint,
                   where: str) -> Self:
        """Return the effect of its settings in a scene file."""
        return cls(float(settings['g']))

    def acting(self, frame: Frame, time: float) -> tuple[Acting, ...]:
        """Return the weight, or its torque about the constraint; nothing without either."""
        weight = frame.mass * self.g
        if weight == 0.0 or not (frame.moves or any(frame.arm)):
            return ()
        if frame.moves:
            return Acting('rigid_body_sim.scene.effects.elementary:constant',
                          (0.0, 0.0, -weight), 'force', 'potential'),
        values = tuple(weight * r for r in frame.arm)
        return Acting('rigid_body_sim.scene.effects.elementary:moment_of_weight', values, 'torque',
                      'potential'),

    def series(self, frame: Frame, time: float) -> Pull:
        """Return the weight."""
        return Pull(force=(0.0, 0.0, -frame.mass * self.g))

    def potential(self, frame: Frame) -> Potential:
        """Return M g z, z the height of the centre of mass above the world's origin."""
        return Potential(f'{__name__}:energy', (frame.mass * self.g,))

    def bounds(self, body: Body, constraint: Constraint) -> Bounds:
        """Return M g r where a point is held, r its distance from the centre of mass."""
        if not constraint.holds_a_point:
            return Bounds(0.0, 0.0)
        return Bounds(body.mass * self.g * hypot3(*constraint.arm(body)), 0.0)

    def notes(self, body: Body, constraint: Constraint) -> list[str]:
        """Warn if the body is held at its centre of mass."""
        arm = constraint.arm(body)
        if constraint.axis is not None:
            arm = across(constraint.axis, arm)
        if not constraint.holds_a_point or any(arm):
            return []
        return [f'the {constraint.kind} holds the body at its centre of mass: '
                'gravity does nothing there']


@compiled
def energy(weight, qx, qy, qz, qw, x, y, z):
    """Return M g z (J)."""
    return weight * z
