"""Strike: an impulse at a point of the body at one time (a bat's ball, a billiard cue)."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from rigid_body_sim.effects.views import as_floats
from rigid_body_sim.errors import BadInput
from rigid_body_sim.rotations import rotate
from rigid_body_sim.state import ORIENTATION

VECTOR = {'type': 'array', 'items': {'type': 'number'}, 'minItems': 3, 'maxItems': 3}


@dataclass(frozen=True)
class Strike:
    """``strike: {impulse: [x, y, z], point: [x, y, z], time: 0.0, frame: world}``, or on the table ``{impulse: [x, y, 0], height: h}``.

    impulse in N s, in world axes (the default) or body axes; `point` from the body's origin in body axes (m), the default is the centre
    of mass. On the table the cue is level: `height` is how far above the middle it hits (m, negative is below), straight behind the
    middle (notes, "Billiard": h = 2 a/5 rolls at once). time in s, default 0. A scene may list several.
    """

    impulse: tuple
    point: tuple | None
    height: float
    time: float
    frame: str
    name: ClassVar = 'strike'
    SCHEMA: ClassVar = {
        'type': 'object', 'additionalProperties': False, 'required': ['impulse'], 'properties': {
            'impulse': VECTOR, 'point': VECTOR, 'height': {'type': 'number'}, 'time': {'type': 'number', 'minimum': 0},
            'frame': {'enum': ['world', 'body']}}}
    constraints: ClassVar = ('free', 'pivot', 'hinge', 'table')
    repeatable: ClassVar = True

    @classmethod
    def from_scene(cls, mapping, body, constraint, where):
        """Make it of its mapping in a scene file."""
        impulse, frame, height = as_floats(mapping['impulse']), mapping.get('frame', 'world'), float(mapping.get('height', 0.0))
        if 'height' in mapping and (constraint.kind != 'table' or 'point' in mapping):
            raise BadInput(f'{where}.height', f'stands beside {"point" if "point" in mapping else "constraint " + constraint.kind}',
                           'height is for a ball on the table, point for everything else')
        if constraint.kind == 'table':
            if impulse[2] != 0.0 or frame == 'body':
                raise BadInput(f'{where}.impulse', f'got {list(impulse)} in {frame} axes', 'a level cue: [x, y, 0] in world axes')
            if abs(height) > body.radius:
                raise BadInput(f'{where}.height', f'got {height!r}', f'at most the radius, {body.radius!r}, above or below the middle')
        point = as_floats(mapping['point']) if 'point' in mapping else None
        return cls(impulse, point, height, float(mapping.get('time', 0.0)), frame)

    def as_impulse(self, body, vector):
        """Return the impulse of force (N s) at the centre of mass and of torque (N m s), both shape (3,) in world axes, for a state."""
        q = vector[ORIENTATION]
        force = np.array(rotate(*q, *self.impulse) if self.frame == 'body' else self.impulse)
        if self.height:
            size = np.linalg.norm(force)
            behind = math.sqrt(body.radius * body.radius - self.height * self.height) / size if size > 0.0 else 0.0
            lever = np.array([-behind * force[0], -behind * force[1], self.height])
        elif self.point is None:
            return force, np.zeros(3)
        else:
            lever = np.array(rotate(*q, *np.subtract(self.point, body.center_of_mass)))
        return force, np.cross(lever, force)
