# SPDX-License-Identifier: Apache-2.0
"""Initial conditions: the keys of `initial` that constraints share, and their meaning."""

import dataclasses
import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics import rotations
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.scene import bodies, principal_axes
from rigid_body_sim.scene.schema import NUMBER, QUATERNION, VECTOR, Schema
from rigid_body_sim.scene.state import State

ORIENTATION: dict[str, Schema] = {'orientation': QUATERNION, 'euler_zyz': VECTOR,
                                  'euler': VECTOR, 'rotation_vector': VECTOR}
TILT: dict[str, Schema] = {'tilt': NUMBER, 'spin': NUMBER}
TURNING: dict[str, Schema] = {'angular_velocity': VECTOR, 'angular_velocity_world': VECTOR,
                              'angular_momentum': VECTOR}
PLACE: dict[str, Schema] = {'position': VECTOR}
MOTION: dict[str, Schema] = {'velocity': VECTOR}


@dataclass(frozen=True)
class Start:
    """The initial conditions of a scene file.

    Attributes
    ----------
    mapping : dict
        The keys that are given, for those that only one constraint knows.
    orientation : tuple of 4 floats
        Unit quaternion (x, y, z, w), body to world.
    omega : tuple of 3 floats
        Angular velocity, body axes, rad/s.
    position, velocity : tuple of 3 floats
        Those of the body's origin, world axes, m and m/s; zero if they are not given.
    """

    mapping: dict[str, Any]
    orientation: tuple[float, ...]
    omega: tuple[float, ...]
    position: tuple[float, ...]
    velocity: tuple[float, ...]

    @classmethod
    def of(cls, mapping: dict[str, Any], inertia: bodies.Inertia, where: str) -> Self:
        """Return the initial conditions of a mapping.

        Parameters
        ----------
        mapping : dict
            The keys of `initial`.
        inertia : Inertia
            About the constraint's reference point: it makes omega of an angular momentum.
        where : str
            File and key path, for error lines.

        Raises
        ------
        BadInput
            If two keys say the same thing, or an angular momentum asks for what the body lacks.
        """
        orientation = _orientation(mapping, where)
        omega = _omega(mapping, orientation, inertia, where)
        position, velocity = (mapping.get(key, (0.0, 0.0, 0.0))
                              for key in ('position', 'velocity'))
        return cls(mapping, orientation, *(tuple(map(float, vector))
                                           for vector in (omega, position, velocity)))

    def at(self, position: Sequence[float]) -> Self:
        """Return the same at another position."""
        return dataclasses.replace(self, position=tuple(position))

    def state(self) -> State:
        """Return the state at time 0."""
        return State.of(0.0, self.orientation, self.omega, self.position, self.velocity)

    def refuse_spin_without_moment(self, inertia: bodies.Inertia, where: str) -> None:
        """Refuse a spin about a principal axis whose moment is zero."""
        omega = self.omega
        along = (rotations.rotate_back(*inertia.axes, *omega) if inertia.axes != bodies.IDENTITY
                 else omega)
        for k, moment in enumerate(inertia.moments):
            if moment == 0.0 and abs(along[k]) > principal_axes.ULPS * max(abs(x) for x in omega):
                raise BadInput(f'{where}.angular_velocity', f'spin {along[k]!r} rad/s about '
                               f'principal axis {k + 1}, whose moment is zero',
                               'that component must be 0: an axis without moment carries no '
                               'angular momentum')


def _only(mapping: dict[str, Any], ways: Sequence[str], what: str, where: str) -> str | None:
    """Return the key that is given of those that say the same thing, or None."""
    given = [way for way in ways if way in mapping]
    if len(given) > 1:
        raise BadInput(f'{where}.{given[1]}', f'is given together with {given[0]}',
                       f'give {what} once')
    return given[0] if given else None


def _orientation(mapping: dict[str, Any], where: str) -> tuple[float, ...]:
    """Return the unit quaternion of the start.

    `euler` are roll, pitch and yaw about the fixed axes x, y and z of the world, in this order
    (REP 103); `euler_zyz` are the angles of the notes; the angle of `rotation_vector` is its
    length.
    """
    ways = 'orientation', 'euler_zyz', 'euler', 'rotation_vector', 'tilt'
    way = _only(mapping, ways, 'the orientation', where)
    if way is None:
        return bodies.IDENTITY
    if way == 'orientation':
        return unit_quaternion(mapping[way], f'{where}.{way}')
    if way == 'tilt':
        return rotations.from_euler_zyz(0.0, float(mapping[way]), 0.0)
    x, y, z = map(float, mapping[way])
    if way == 'euler_zyz':
        return rotations.from_euler_zyz(x, y, z)
    if way == 'rotation_vector':
        return rotations.from_rotation_vector(x, y, z)
    pitched = rotations.multiply(*rotations.from_rotation_vector(0.0, y, 0.0),
                                 *rotations.from_rotation_vector(x, 0.0, 0.0))
    return rotations.multiply(*rotations.from_rotation_vector(0.0, 0.0, z), *pitched)


def _omega(mapping: dict[str, Any], orientation: Sequence[float], inertia: bodies.Inertia,
           where: str) -> Sequence[float]:
    """Return the angular velocity of the start, body axes, rad/s."""
    way = _only(mapping, ('angular_velocity', 'angular_velocity_world', 'angular_momentum',
                          'spin'), 'the angular velocity', where)
    if way is None:
        return 0.0, 0.0, 0.0
    if way == 'spin':
        return 0.0, 0.0, mapping[way]
    x, y, z = map(float, mapping[way])
    if way == 'angular_velocity':
        return x, y, z
    x, y, z = rotations.rotate_back(*orientation, x, y, z)
    if way == 'angular_velocity_world':
        return x, y, z
    x, y, z = rotations.rotate_back(*inertia.axes, x, y, z)
    slack, omega = principal_axes.ULPS * hypot3(x, y, z), []
    for k, (L, moment) in enumerate(zip((x, y, z), inertia.moments, strict=True)):
        if moment == 0.0 and abs(L) > slack:
            raise BadInput(f'{where}.angular_momentum', f'{L!r} kg m^2/s about principal axis '
                           f'{k + 1}, whose moment is zero',
                           'no part about that axis: it carries no angular momentum')
        omega.append(L / moment if moment else 0.0)
    return rotations.rotate(*inertia.axes, *omega)


def unit_quaternion(values: Sequence[float], where: str) -> tuple[float, float, float, float]:
    """Return a quaternion (x, y, z, w) of norm 1; BadInput if all components are zero."""
    x, y, z, w = map(float, values)
    size = max(abs(x), abs(y), abs(z), abs(w))
    if not size > 0.0:
        raise BadInput(where, f'got {[x, y, z, w]}', 'a quaternion (x, y, z, w) of non-zero norm')
    if not 1e-100 < size < 1e100:
        x, y, z, w = x / size, y / size, z / size, w / size
    square = x * x + y * y + z * z + w * w
    if abs(square - 1.0) <= 2.0 * sys.float_info.epsilon:
        return x, y, z, w
    norm = math.sqrt(square)
    return x / norm, y / norm, z / norm, w / norm
