# SPDX-License-Identifier: Apache-2.0
"""Initial conditions: the keys of `initial` that constraints share, and what they mean."""

import dataclasses
import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics import rotations
from rigid_body_sim.scene import bodies
from rigid_body_sim.scene.schema import NUMBER, QUATERNION, VECTOR, Schema
from rigid_body_sim.scene.state import State

ORIENTATION: dict[str, Schema] = {'orientation': QUATERNION, 'euler_zyz': VECTOR}
TILT: dict[str, Schema] = {'tilt': NUMBER, 'spin': NUMBER}
TURNING: dict[str, Schema] = {'angular_velocity': VECTOR}
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
        Of the body's origin, world axes, m and m/s; zero if they are not given.
    """

    mapping: dict[str, Any]
    orientation: tuple[float, ...]
    omega: tuple[float, ...]
    position: tuple[float, ...]
    velocity: tuple[float, ...]

    @classmethod
    def of(cls, mapping: dict[str, Any], where: str) -> Self:
        """Return the initial conditions of a mapping; BadInput if two keys say the same thing."""
        orientation = _orientation(mapping, where)
        omega = mapping.get('angular_velocity', (0.0, 0.0, 0.0))
        if 'spin' in mapping:
            if 'angular_velocity' in mapping:
                raise BadInput(f'{where}.spin', 'stands beside angular_velocity',
                               'give one of them')
            omega = 0.0, 0.0, mapping['spin']
        position, velocity = (mapping.get(key, (0.0, 0.0, 0.0)) for key in ('position', 'velocity'))
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
            if moment == 0.0 and abs(along[k]) > bodies.ULPS * max(abs(x) for x in omega):
                raise BadInput(f'{where}.angular_velocity', f'spin {along[k]!r} rad/s about '
                               f'principal axis {k + 1}, whose moment is zero',
                               'that component must be 0: an axis without moment carries no '
                               'angular momentum')


def _orientation(mapping: dict[str, Any], where: str) -> tuple[float, ...]:
    ways = [way for way in ('orientation', 'euler_zyz', 'tilt') if way in mapping]
    if len(ways) > 1:
        raise BadInput(f'{where}.{ways[1]}', f'stands beside {ways[0]}',
                       'give the orientation once')
    if 'euler_zyz' in mapping:
        return rotations.from_euler_zyz(*(float(x) for x in mapping['euler_zyz']))
    if 'tilt' in mapping:
        return rotations.from_euler_zyz(0.0, float(mapping['tilt']), 0.0)
    return unit_quaternion(mapping.get('orientation', bodies.IDENTITY), f'{where}.orientation')


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
