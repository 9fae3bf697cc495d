"""Gravity: a uniform field along -z of the world. It moves a free body's centre of mass and turns a pivoted or hinged one."""

from dataclasses import dataclass
from typing import ClassVar

from rigid_body_sim.scene.effects.views import Acting, Pull


@dataclass(frozen=True)
class Gravity:
    """``gravity: {g: 9.81}``; g in m/s^2, zero or positive.

    Free body: F = -M g z at the centre of mass, no couple about it. Pivot, hinge: the torque r x F about the constraint (notes,
    "Symmetric Top in a uniform gravitational field").
    """

    g: float
    name: ClassVar = 'gravity'
    SCHEMA: ClassVar = {
        'type': 'object', 'properties': {'g': {'type': 'number', 'minimum': 0}}, 'required': ['g'], 'additionalProperties': False}
    constraints: ClassVar = ('free', 'pivot', 'hinge')
    repeatable: ClassVar = False
    breakpoints: ClassVar = ()

    @classmethod
    def from_scene(cls, mapping, body, constraint, where):
        """Make it of its mapping in a scene file."""
        return cls(float(mapping['g']))

    def acting(self, frame, time):
        """View `rate`: the weight, or its torque about the constraint."""
        weight = frame.mass * self.g
        if frame.kind == 'free':
            return Acting('rigid_body_sim.scene.effects.elementary:constant', (0.0, 0.0, -weight), 'force', 'potential'),
        values = tuple(weight * r for r in frame.arm)
        return Acting('rigid_body_sim.scene.effects.elementary:moment_of_weight', values, 'torque', 'potential'),

    def series(self, frame, time):
        """View `series`: the weight."""
        return Pull(force=(0.0, 0.0, -frame.mass * self.g))

    def energy(self, frame, height):
        """Return the potential energy (J) of the centre of mass at a height (m) above the world's origin."""
        return frame.mass * self.g * height
