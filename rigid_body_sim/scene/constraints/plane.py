# SPDX-License-Identifier: Apache-2.0
"""Plane: a convex body that flies, slides, rolls or rests above a plane, level or inclined."""

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Self

from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics import rotations
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.vectors import cross, dot, minus, scaled
from rigid_body_sim.scene import initial
from rigid_body_sim.scene.bodies import IDENTITY, Body
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism, Vector
from rigid_body_sim.scene.frame import Frame
from rigid_body_sim.scene.initial import Start
from rigid_body_sim.scene.schema import VECTOR, described, mapping_of
from rigid_body_sim.scene.state import State

SINKS = 1e-9    # a body that starts no more than this, relative to its size, too deep is lifted


@dataclass(frozen=True)
class Plane(Constraint):
    """``constraint: {table: {normal: [x, y, z], restitution: e}}`` for a body with a surface.

    The plane goes through the origin of the world; `normal` is a direction in world axes (default
    z). An impact leaves `restitution` times the normal velocity before it (default 0). The
    reference point is the centre of mass.

    Attributes
    ----------
    normal : tuple of 3 floats
        Unit vector.
    restitution : float
    axes : tuple of 4 floats
        Quaternion that turns the axes of the plane (z along the normal) into those of the world.
    """

    normal: Vector = (0.0, 0.0, 1.0)
    restitution: float = 0.0
    axes: tuple[float, float, float, float] = IDENTITY
    kind: ClassVar[str] = 'table'
    usage: ClassVar[str] = 'table: {normal: [0, 0, 1], restitution: 0.5}'
    SCHEMA: ClassVar[dict | None] = described(mapping_of(
        normal=described(VECTOR, 'a direction upwards, world axes', [0, 0, 1]),
        restitution=described({'type': 'number', 'minimum': 0, 'maximum': 1},
                              'normal velocity after an impact over that before it', 0)),
        'a body with a surface flies, slides, rolls or rests over a plane through the origin')
    INITIAL: ClassVar[dict] = {**initial.ORIENTATION, **initial.TILT, **initial.TURNING,
                               **initial.PLACE, **initial.MOTION, 'rolling': {'type': 'boolean'}}
    mechanism: ClassVar[Mechanism] = Mechanism.PLANE

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, where: str) -> Self:
        """Return the plane for a body that has a surface and three positive moments."""
        if body.surface is None:
            if body.radius is not None:
                raise BadInput(where, 'settings for a ball that has no surface',
                               'give body.surface: {sphere: {radius: ...}} as well')
            raise BadInput(where, 'the body has no smooth surface',
                           'give body.surface (sphere, ellipsoid, torus or disk): bodies with '
                           'edges, polyhedra and composites without a surface are not supported')
        if not min(body.about_center.moments) > 1e-9 * max(body.about_center.moments):
            raise BadInput(where, f'moments {list(body.about_center.moments)} about the centre of '
                           'mass', 'three positive moments, none below 1e-9 of the largest')
        x, y, z = map(float, settings.get('normal', (0.0, 0.0, 1.0)))
        length = hypot3(x, y, z)
        if not (length > 0.0 and math.isfinite(length) and z > 0.0):
            raise BadInput(f'{where}.normal', f'got {settings["normal"]}',
                           'a direction that points upwards: its z is positive')
        normal = x / length, y / length, z / length
        return cls(normal, float(settings.get('restitution', 0.0)), _tilt(normal))

    def initial(self, start: Start, body: Body, where: str) -> State:
        """Return the state at time 0.

        Without `position` the body touches the plane above the world's origin. With ``rolling:
        true`` the velocity is that of rolling.
        """
        assert body.surface is not None    # from_scene takes no others
        q = start.orientation
        depth = self.height(q, body)
        if 'position' not in start.mapping:
            start = start.at(scaled(-depth, self.normal))
        above = dot(self.normal, start.position) + depth
        size = max(max(body.surface.size), abs(depth))
        if above < -SINKS * size:
            raise BadInput(f'{where}.position',
                           f'the lowest point is {-above!r} m below the plane',
                           f'a body on or above it: along the normal at least {-depth!r} m')
        if above < SINKS * size:
            start = start.at(minus(start.position, scaled(above, self.normal)))
        if not start.mapping.get('rolling', False):
            return start.state()
        if 'velocity' in start.mapping or above > SINKS * size:
            raise BadInput(f'{where}.rolling', 'got true for a body that '
                           f'{"is above the plane" if above > SINKS * size else "has a velocity"}',
                           'rolling: true says the velocity of a body that touches the plane')
        arm = rotations.rotate(*q, *self.touching(q, body))
        v = cross(arm, rotations.rotate(*q, *start.omega))
        return State.of(0.0, q, start.omega, start.position, v)

    def touching(self, q, body: Body) -> Vector:
        """Return the lowest point of a body with the orientation q, from its origin, body axes."""
        assert body.surface is not None    # from_scene takes no others
        return body.surface.lowest(rotations.rotate_back(*q, *self.normal))

    def height(self, q, body: Body) -> float:
        """Return how high the lowest point is above the body's origin, along the normal, m."""
        return dot(self.normal, rotations.rotate(*q, *self.touching(q, body)))

    def frame(self, body: Body) -> Frame:
        """Return the body's own axes about the centre of mass."""
        inertia = body.about_center
        return Frame(True, body.mass, inertia.moments, inertia.differences, IDENTITY,
                     body.center_of_mass, (0.0, 0.0, 0.0))


def _tilt(normal):
    """Return the quaternion of the shortest rotation from z to a unit vector above the level."""
    x, y, z = normal
    if x == 0.0 and y == 0.0:
        return IDENTITY
    w = math.sqrt(0.5 * (1.0 + z))
    return rotations.normalised(-0.5 * y / w, 0.5 * x / w, 0.0, w)
