# SPDX-License-Identifier: Apache-2.0
"""Strike: an impulse at a point of the body at one time (a bat's ball, a billiard cue)."""

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.pair_vectors import cross as cross_pairs
from rigid_body_sim.numerics.pair_vectors import difference, less, turned, turned_back, with_low
from rigid_body_sim.numerics.rotations import rotate
from rigid_body_sim.numerics.vectors import across, cross, minus, plus, scaled
from rigid_body_sim.scene.bodies import Body
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism
from rigid_body_sim.scene.effects.protocol import Effect, as_floats
from rigid_body_sim.scene.schema import NUMBER, VECTOR, described, mapping_of
from rigid_body_sim.scene.state import ORIENTATION


@dataclass(frozen=True)
class Strike(Effect):
    """``strike: {impulse: [x, y, z], point: [x, y, z], time: 0.0, frame: world}``.

    The impulse (N s) is in world axes (the default) or body axes; `point` is measured from the
    body's origin in body axes (m), by default it is the centre of mass; time is in s, by default
    0. A scene may list several.

    On the table, ``{speed: v0, height: h}``: the cue is level, `height` is how far above the
    middle it hits (m, negative is below), straight behind the middle (notes, "Billiard": a ball
    hit at h = 2 a/5 rolls at once), and `speed` stands for the impulse that gives a ball at rest
    this speed along x (m/s). On a hinge, ``distance: d`` stands for the point this far from the
    axis, in the direction of the centre of mass (m; notes, "Bat").
    """

    impulse: tuple[float, ...]
    point: tuple[float, ...] | None
    height: float
    time: float
    frame: str
    name: ClassVar[str] = 'strike'
    SCHEMA: ClassVar[dict] = described(mapping_of(
        impulse=described(VECTOR, 'N s; on a table speed may stand in its place'),
        speed=described(NUMBER, 'm/s of a ball along x after the strike: J = M speed'),
        point=described(VECTOR, "m, from the body's origin, body axes"),
        height=described(NUMBER, 'm, above the middle of a ball on the table, in place of point'),
        distance=described(NUMBER, 'm, from a hinge toward the centre of mass, in place of point'),
        time=described({'type': 'number', 'minimum': 0}, 's', 0),
        frame=described({'enum': ['world', 'body']}, 'axes of impulse', 'world')),
        'the impulse J at a point and a time; a bearing or a table adds the impulse of its '
        'reaction')
    mechanisms: ClassVar = tuple(Mechanism)
    repeatable: ClassVar[bool] = True

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, constraint: Constraint,
                   where: str) -> Self:
        """Return the effect of its settings in a scene file."""
        frame, height = settings.get('frame', 'world'), float(settings.get('height', 0.0))
        on_table = constraint.mechanism is Mechanism.TABLE
        impulse = _impulse(settings, body, constraint, where)
        ways = [way for way in ('point', 'height', 'distance') if way in settings]
        if len(ways) > 1:
            raise BadInput(f'{where}.{ways[1]}', f'is given together with {ways[0]}',
                           'say once where it hits')
        if 'height' in settings and not on_table:
            raise BadInput(f'{where}.height', f'has no meaning on constraint {constraint.kind!r}',
                           'height is for a ball on the table, point for everything else')
        if on_table:
            assert body.radius is not None    # the table holds spheres only
            if impulse[2] != 0.0 or frame == 'body':
                raise BadInput(f'{where}.impulse', f'got {list(impulse)} in {frame} axes',
                               'a level cue: [x, y, 0] in world axes')
            if abs(height) > body.radius:
                raise BadInput(f'{where}.height', f'got {height!r}',
                               f'at most the radius, {body.radius!r}, above or below the middle')
        point = as_floats(settings['point']) if 'point' in settings else None
        if 'distance' in settings:
            point = _at_distance(settings['distance'], body, constraint, f'{where}.distance')
        return cls(impulse, point, height, float(settings.get('time', 0.0)), frame)

    def as_impulse(self, body: Body, vector: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the impulse of force (N s) at the centre of mass and of torque (N m s).

        Both are in world axes, for the attitude of a state. They have shape (3,), or (6,): then
        the last three numbers are what rounding took.
        """
        q, force = vector[ORIENTATION].tolist(), self.impulse
        if self.frame == 'body':
            force = rotate(*q, *force)
        if self.height:
            assert body.radius is not None    # `height` is for the table
            size = hypot3(*force)
            behind = (math.sqrt(body.radius * body.radius - self.height * self.height) / size
                      if size > 0.0 else 0.0)
            lever = -behind * force[0], -behind * force[1], self.height
            return np.array(force), np.array(cross(lever, force))
        if self.point is None and self.frame == 'world':
            return np.array(force), np.zeros(3)
        point = body.center_of_mass if self.point is None else self.point
        couple = cross(rotate(*q, *minus(point, body.center_of_mass)), force)
        lost = _lost(tuple(q), self.impulse, 1.0 if self.frame == 'body' else 0.0,
                     difference(point, body.center_of_mass), force, couple)
        return np.array([*force, *lost[0]]), np.array([*couple, *lost[1]])


@compiled
def _lost(q, impulse, in_body, lever, force, couple):
    """Return what rounding took from the force and the couple of an impulse, world axes.

    Parameters
    ----------
    q : Quaternion
        Attitude of the body.
    impulse : Vector
        N s, in body axes where `in_body` is 1.0, else in world axes.
    lever : vector of pairs
        From the centre of mass, body axes, m.
    force, couple : Vector
        As they were rounded.
    """
    J = with_low(impulse, (0.0, 0.0, 0.0))
    K = cross_pairs(lever, J if in_body != 0.0 else turned_back(*q, J))
    if in_body != 0.0:
        J = turned(*q, J)
    return less(J, force), less(turned(*q, K), couple)


def _impulse(settings, body, constraint, where):
    """Return the impulse, N s, given as such or by the speed that it gives a ball."""
    if ('impulse' in settings) == ('speed' in settings):
        raise BadInput(where, f'got the keys {", ".join(sorted(settings)) or "none"}',
                       'give one of impulse (N s) and, on a table, speed')
    if 'impulse' in settings:
        return as_floats(settings['impulse'])
    remedy = 'speed is along x of the world, for a ball on the table; impulse for everything else'
    if constraint.mechanism is not Mechanism.TABLE:
        raise BadInput(f'{where}.speed', f'has no meaning on constraint {constraint.kind!r}',
                       remedy)
    if settings.get('frame', 'world') != 'world':
        raise BadInput(f'{where}.speed', 'is given together with frame: body', remedy)
    return body.mass * float(settings['speed']), 0.0, 0.0


def _at_distance(distance, body, constraint, where):
    """Return the point (body axes, m) at a distance from a hinge towards the centre of mass."""
    if constraint.axis is None:
        raise BadInput(where, f'has no meaning on constraint {constraint.kind!r}',
                       'distance is from a hinge; give the point')
    arm = across(constraint.axis, constraint.arm(body))
    length = hypot3(*arm)
    if not length > 0.0:
        raise BadInput(where, f'got {distance!r} on a hinge through the centre of mass',
                       'no direction to measure it in: give the point')
    return plus(constraint.point(body), scaled(float(distance) / length, arm))
