"""Strike: an impulse at a point of the body at one time (a bat's ball, a billiard cue)."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.rotations import rotate
from rigid_body_sim.numerics.vectors import across, cross, minus, plus, scaled
from rigid_body_sim.scene.effects.views import as_floats
from rigid_body_sim.scene.state import ORIENTATION

VECTOR = {'type': 'array', 'items': {'type': 'number'}, 'minItems': 3, 'maxItems': 3}


@dataclass(frozen=True)
class Strike:
    """``strike: {impulse: [x, y, z], point: [x, y, z], time: 0.0, frame: world}``; table: ``{speed: v0, height: h}``; hinge: ``distance: d``.

    impulse in N s, in world axes (the default) or body axes; `point` from the body's origin in body axes (m), the default is the centre
    of mass; time in s, default 0. A scene may list several.

    On the table the cue is level: `height` is how far above the middle it hits (m, negative is below), straight behind the middle (notes,
    "Billiard": h = 2 a/5 rolls at once), and `speed` stands for the impulse that gives a ball at rest this speed along x (m/s).
    On a hinge `distance` stands for the point this far from the axis, in the direction of the centre of mass (m; notes, "Bat").
    """

    impulse: tuple
    point: tuple | None
    height: float
    time: float
    frame: str
    name: ClassVar = 'strike'
    SCHEMA: ClassVar = {
        'type': 'object', 'additionalProperties': False, 'properties': {
            'impulse': VECTOR, 'speed': {'type': 'number'}, 'point': VECTOR, 'height': {'type': 'number'}, 'distance': {'type': 'number'},
            'time': {'type': 'number', 'minimum': 0}, 'frame': {'enum': ['world', 'body']}}}
    constraints: ClassVar = ('free', 'pivot', 'hinge', 'table')
    repeatable: ClassVar = True

    @classmethod
    def from_scene(cls, mapping, body, constraint, where):
        """Make it of its mapping in a scene file."""
        frame, height = mapping.get('frame', 'world'), float(mapping.get('height', 0.0))
        impulse = _impulse(mapping, body, constraint, where)
        ways = [way for way in ('point', 'height', 'distance') if way in mapping]
        if len(ways) > 1:
            raise BadInput(f'{where}.{ways[1]}', f'stands beside {ways[0]}', 'say once where it hits')
        if 'height' in mapping and constraint.kind != 'table':
            raise BadInput(f'{where}.height', f'has no meaning on constraint {constraint.kind!r}',
                           'height is for a ball on the table, point for everything else')
        if constraint.kind == 'table':
            if impulse[2] != 0.0 or frame == 'body':
                raise BadInput(f'{where}.impulse', f'got {list(impulse)} in {frame} axes', 'a level cue: [x, y, 0] in world axes')
            if abs(height) > body.radius:
                raise BadInput(f'{where}.height', f'got {height!r}', f'at most the radius, {body.radius!r}, above or below the middle')
        point = as_floats(mapping['point']) if 'point' in mapping else None
        if 'distance' in mapping:
            point = _at_distance(mapping['distance'], body, constraint, f'{where}.distance')
        return cls(impulse, point, height, float(mapping.get('time', 0.0)), frame)

    def as_impulse(self, body, vector):
        """Return the impulse of force (N s) at the centre of mass and of torque (N m s), both shape (3,) in world axes, for a state."""
        q = vector[ORIENTATION]
        force = np.array(rotate(*q, *self.impulse) if self.frame == 'body' else self.impulse)
        if self.height:
            size = hypot3(*force.tolist())
            behind = math.sqrt(body.radius * body.radius - self.height * self.height) / size if size > 0.0 else 0.0
            lever = -behind * force[0], -behind * force[1], self.height
        elif self.point is None:
            return force, np.zeros(3)
        else:
            lever = rotate(*q, *minus(self.point, body.center_of_mass))
        return force, np.array(cross(lever, force.tolist()))


def _impulse(mapping, body, constraint, where):
    """Return the impulse, N s, given as such or by the speed that it gives a ball."""
    if ('impulse' in mapping) == ('speed' in mapping):
        raise BadInput(where, f'got the keys {", ".join(sorted(mapping)) or "none"}', 'give one of impulse (N s) and, on a table, speed')
    if 'impulse' in mapping:
        return as_floats(mapping['impulse'])
    if constraint.kind != 'table' or mapping.get('frame', 'world') != 'world':
        raise BadInput(f'{where}.speed', f'has no meaning on constraint {constraint.kind!r}' if constraint.kind != 'table' else
                       'stands beside frame: body', 'speed is along x of the world, for a ball on the table; impulse for everything else')
    return body.mass * float(mapping['speed']), 0.0, 0.0


def _at_distance(distance, body, constraint, where):
    """Return the point (body axes, m) at a distance from a hinge towards the centre of mass."""
    if constraint.kind != 'hinge':
        raise BadInput(where, f'has no meaning on constraint {constraint.kind!r}', 'distance is from a hinge; give the point')
    arm = across(constraint.axis, minus(body.center_of_mass, constraint.through))
    length = hypot3(*arm)
    if not length > 0.0:
        raise BadInput(where, f'got {distance!r} on a hinge through the centre of mass', 'no direction to measure it in: give the point')
    return plus(constraint.through, scaled(float(distance) / length, arm))
