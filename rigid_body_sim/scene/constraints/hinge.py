# SPDX-License-Identifier: Apache-2.0
"""Hinge: the body turns about an axis through a point, both fixed in the body and in the world."""

import dataclasses
import math
from dataclasses import dataclass
from typing import Any, ClassVar, Self

from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics import rotations
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.vectors import across, apply, cross, dot, minus, plus, scaled
from rigid_body_sim.scene import initial
from rigid_body_sim.scene.bodies import IDENTITY, Body, refuse_beyond, square_of
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism, Vector
from rigid_body_sim.scene.frame import Frame, Hinging
from rigid_body_sim.scene.initial import Start
from rigid_body_sim.scene.schema import NUMBER, VECTOR, described, mapping_of
from rigid_body_sim.scene.state import State


@dataclass(frozen=True)
class Hinge(Constraint):
    """``constraint: {hinge: {axis: [x, y, z], through: [x, y, z]}}``.

    `axis` is a direction in body axes. `through` is a point of the axis in body axes (m, default
    the origin). Instead of it, `distance` hangs the body that far from its centre of mass along
    body axis z, measured across the axis. The reference point is `through`. `zero` is the
    orientation at the angle 0, the one that `initial` gives beside `angle`. `winds` says that the
    body may turn to an end of the angle where what acts jumps.
    """

    axis: Vector = (0.0, 0.0, 1.0)    # overrides the view `axis` of Constraint
    through: Vector = (0.0, 0.0, 0.0)
    zero: tuple[float, float, float, float] = IDENTITY
    winds: bool = False
    kind: ClassVar[str] = 'hinge'
    usage: ClassVar[str] = 'hinge: {axis: [x, y, z], through: [x, y, z]}'
    SCHEMA: ClassVar[dict | None] = described(mapping_of(
        ['axis'],
        axis=described(VECTOR, 'a direction, body axes'),
        through=described(VECTOR, "m, a point of the axis from the body's origin, body axes",
                          [0, 0, 0]),
        distance=described(NUMBER, 'm, from the centre of mass along body z, measured across '
                                   'the axis; in place of through')),
        'the body turns about an axis that is fixed in it and in the world')
    INITIAL: ClassVar[dict] = {**initial.ORIENTATION, 'angle': NUMBER, 'rate': NUMBER,
                               **initial.PLACE}
    mechanism: ClassVar[Mechanism] = Mechanism.AXIS

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, where: str) -> Self:
        """Return the hinge, its axis made a unit vector."""
        x, y, z = map(float, settings['axis'])
        length = hypot3(x, y, z)
        if not length > 0.0 or not math.isfinite(length):
            raise BadInput(f'{where}.axis', f'got {settings["axis"]}',
                           'a direction: three numbers, not all zero')
        axis = x / length, y / length, z / length
        if 'distance' in settings:
            through = _suspension(settings, axis, body, where)
        else:
            x, y, z = map(float, settings.get('through', (0.0, 0.0, 0.0)))
            through = x, y, z
        refuse_beyond(body.mass * square_of(through), where)
        lever = cross(axis, minus(body.center_of_mass, through))
        about_center = dot(axis, apply(body.about_center.matrix.tolist(), axis))
        if not about_center + body.mass * dot(lever, lever) > 0.0:
            raise BadInput(f'{where}.axis', f'got {settings["axis"]}, about which the body has no '
                           'moment of inertia', 'an axis that a rod does not lie along')
        return cls(axis, through)

    def begun(self, start: Start) -> Self:
        """Return the hinge whose angle counts from the orientation of a start."""
        x, y, z, w = start.orientation
        return dataclasses.replace(self, zero=(x, y, z, w))

    def wound(self) -> Self:
        """Return the hinge whose angle may come to its ends, where what acts jumps."""
        return dataclasses.replace(self, winds=True)

    def initial(self, start: Start, body: Body, where: str) -> State:
        """Return the state at an angle (rad) and rate (rad/s) about the axis.

        `position` is where the point `through` is in the world, m.
        """
        angle = float(start.mapping.get('angle', 0.0))
        rate = float(start.mapping.get('rate', 0.0))
        turn = rotations.from_rotation_vector(*scaled(angle, self.axis))
        orientation = rotations.multiply(*start.orientation, *turn)
        omega = scaled(rate, self.axis)
        arm = rotations.rotate(*orientation, *self.through)
        velocity = cross(arm, rotations.rotate(*orientation, *omega))
        return State.of(0.0, orientation, omega, minus(start.position, arm), velocity)

    def point(self, body: Body) -> Vector:
        """Return the point `through`."""
        return self.through

    def frame(self, body: Body) -> Frame:
        """Return the body's axes through the point `through`."""
        inertia = body.about_center
        return Frame(False, body.mass, inertia.moments, inertia.differences, IDENTITY,
                     self.through, self.arm(body), Hinging(self.axis, self.zero, self.winds))


def _suspension(settings: dict[str, Any], axis: Vector, body: Body, where: str) -> Vector:
    """Return the point at the key `distance` from the centre of mass (body axes, m)."""
    distance, upward = float(settings['distance']), across(axis, (0.0, 0.0, 1.0))
    if 'through' in settings:
        raise BadInput(f'{where}.distance', 'is given together with through', 'give one of them')
    if distance == 0.0:
        raise BadInput(f'{where}.distance', f'got {settings["distance"]!r}',
                       'hung at its centre of mass a body does not swing: give a distance in m, '
                       'above 0, or below 0 for the other side')
    length = hypot3(*upward)
    if not length > 1e-8:
        raise BadInput(f'{where}.distance', f'got an axis {list(axis)} along z',
                       'distance is measured along body axis z: give through')
    x, y, z = plus(body.center_of_mass, scaled(distance / length, upward))
    return x, y, z
