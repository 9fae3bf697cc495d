"""Sliding friction: Coulomb's law where a sphere touches the table (notes, "Billiard").

While the lowest point moves over the table with the slip velocity u != 0 the force on the ball is -mu M g u/|u|; once u = 0 it rolls. The
motion is solved in closed form by rigid_body_sim/motions/sliding_sphere.py; held commands on the table by
rigid_body_sim/integrators/marching/table.py.
"""

from dataclasses import dataclass
from typing import ClassVar

POSITIVE = {'type': 'number', 'exclusiveMinimum': 0}


@dataclass(frozen=True)
class SlidingFriction:
    """``sliding_friction: {mu: 0.2, g: 9.81}``.

    mu is the coefficient of sliding friction, g the gravity that presses the ball on the table (m/s^2); mu may be 0.
    """

    mu: float
    g: float
    name: ClassVar = 'sliding_friction'
    SCHEMA: ClassVar = {
        'type': 'object', 'properties': {'mu': {'type': 'number', 'minimum': 0}, 'g': POSITIVE}, 'required': ['mu', 'g'],
        'additionalProperties': False}
    constraints: ClassVar = ('table',)
    repeatable: ClassVar = False
    breakpoints: ClassVar = ()

    @classmethod
    def from_scene(cls, mapping, body, constraint, where):
        """Make it of its mapping in a scene file."""
        return cls(float(mapping['mu']), float(mapping['g']))
