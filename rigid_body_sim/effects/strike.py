"""Strike: an impulse at a point of the body at one time (a bat's ball, a billiard cue)."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from rigid_body_sim.effects.impulse import struck
from rigid_body_sim.effects.views import as_floats
from rigid_body_sim.errors import BadInput
from rigid_body_sim.rotations import rotate, rotate_back
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

    @property
    def breakpoints(self):
        """The time of the blow, s."""
        return (self.time,)

    def apply(self, scene, vector):
        """View `kick`: return the state just after the blow."""
        q = vector[ORIENTATION]
        impulse = rotate(*q, *self.impulse) if self.frame == 'body' else self.impulse
        point = self.point
        if self.height:
            behind = math.sqrt(scene.body.radius * scene.body.radius - self.height * self.height) / np.linalg.norm(impulse)
            point = rotate_back(*q, -behind * impulse[0], -behind * impulse[1], self.height)
        return struck(scene, vector, impulse, (0.0, 0.0, 0.0), point)
