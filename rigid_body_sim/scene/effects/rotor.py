# SPDX-License-Identifier: Apache-2.0
"""Rotor: a flywheel inside the body, whose spin does not change where its mass is (a gyrostat).

With a the axis of the rotor and h its angular momentum along it, m = I omega of the body,

    m' = m x omega + Gamma - omega x h a - h' a

The momentum of body and rotor, R (m + h a), is constant where nothing acts from outside; the
ledger has it whole, and the energy without that of the rotor's own spin.
"""

import dataclasses
from dataclasses import dataclass
from typing import Any, ClassVar, Self

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.vectors import cross, scaled
from rigid_body_sim.scene.bodies import Body
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism
from rigid_body_sim.scene.effects.protocol import (
    Acting,
    Bounds,
    Effect,
    Formulas,
    Momentum,
    Pull,
    Vector,
)
from rigid_body_sim.scene.expressions import tree, vectors
from rigid_body_sim.scene.expressions.source import RATES, TIME
from rigid_body_sim.scene.frame import Frame
from rigid_body_sim.scene.schema import NUMBER, POSITIVE, VECTOR, described, mapping_of


@dataclass(frozen=True)
class Rotor(Effect):
    """``rotor: {axis: [x, y, z], momentum: h}``, or ``{axis, inertia: J, rate: r, torque: T}``.

    The first keeps h (kg m^2/s), its momentum as seen from the body: a motor keeps the speed,
    and the inertia of the body includes the rotor as if it were locked. The second turns freely
    on its axle, or under the constant torque T (N m) of its motor: J is its moment about the axis
    (kg m^2), r its rate at time 0 as seen from space (rad/s), h = J r + T t; the inertia of the
    body does not include J. The axis is a direction in body axes. A scene may list several.

    Attributes
    ----------
    axis : tuple of 3 floats
        Unit vector, body axes.
    momentum_at_start : float
        h at time 0, kg m^2/s.
    torque : float
        Torque of the motor on the rotor, N m; the opposite one acts on the body.
    """

    axis: Vector
    momentum_at_start: float
    torque: float
    name: ClassVar[str] = 'rotor'
    SCHEMA: ClassVar[dict] = described(mapping_of(
        ['axis'],
        axis=described(VECTOR, 'a direction, body axes'),
        momentum=described(NUMBER, 'kg m^2/s, as seen from the body'),
        inertia=described(POSITIVE, 'kg m^2, not included in the inertia of the body'),
        rate=described(NUMBER, 'rad/s at time 0, as seen from space'),
        torque=described(NUMBER, 'N m, of the motor on the rotor', 0)),
        "Gamma = -omega x h a - h' a, with a along axis; h = momentum, or h = inertia "
        'rate + torque t')
    mechanisms: ClassVar = (Mechanism.FREE, Mechanism.POINT, Mechanism.AXIS, Mechanism.PLANE)
    repeatable: ClassVar[bool] = True

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, constraint: Constraint,
                   where: str) -> Self:
        """Return the effect of its settings in a scene file."""
        x, y, z = map(float, settings['axis'])
        length = hypot3(x, y, z)
        if not length > 0.0:
            raise BadInput(f'{where}.axis', f'got {settings["axis"]}',
                           'a direction: three numbers, not all zero')
        given = set(settings) - {'axis'}
        if given != {'momentum'} and not {'inertia', 'rate'} <= given <= {'inertia', 'rate',
                                                                          'torque'}:
            raise BadInput(where, f'got the keys {", ".join(sorted(settings))}',
                           'give momentum alone, or inertia and rate (and torque) beside axis')
        axis = x / length, y / length, z / length
        if 'momentum' in settings:
            return cls(axis, float(settings['momentum']), 0.0)
        return cls(axis, float(settings['inertia']) * float(settings['rate']),
                   float(settings.get('torque', 0.0)))

    @property
    def opposite(self) -> Self:
        """The rotor that turns the other way."""
        return dataclasses.replace(self, momentum_at_start=-self.momentum_at_start,
                                   torque=-self.torque)

    def acting(self, frame: Frame, time: float) -> tuple[Acting, ...]:
        """Return the gyroscopic torque and that of the motor."""
        axis, acting = frame.from_body(self.axis), []
        if self.torque:
            acting.append(Acting(f'{__name__}:gyroscopic_driven',
                                 (self.momentum_at_start, self.torque, *axis), 'torque', 'work',
                                 in_field=True, of_motion=True, inner=True, timed=True,
                                 polynomial=True))
            acting.append(Acting('rigid_body_sim.scene.effects.elementary:constant',
                                 scaled(-self.torque, axis), 'torque', 'work', inner=True,
                                 polynomial=True))
        elif self.momentum_at_start:
            acting.append(Acting(f'{__name__}:gyroscopic', scaled(self.momentum_at_start, axis),
                                 'torque', 'work', of_motion=True, inner=True, polynomial=True))
        return tuple(acting)

    def series(self, frame: Frame, time: float) -> Pull:
        """Return the gyroscopic torque and that of the motor."""
        axis = frame.from_body(self.axis)
        if self.torque:
            h = tree.plus(tree.number(self.momentum_at_start),
                          tree.times(tree.number(self.torque), tree.term('name', *TIME)))
            turning = vectors.cross(vectors.constant(axis), vectors.named(RATES))
            torque = vectors.total(vectors.scaled(h, turning),
                                   vectors.constant(scaled(-self.torque, axis)))
            return Pull(formulas=(Formulas(torque, of_frame=True),))
        x, y, z = scaled(self.momentum_at_start, axis)
        # -omega x h = h x omega
        return Pull(drag=((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)))

    def momentum(self, frame: Frame) -> Momentum:
        """Return h a."""
        return Momentum(f'{__name__}:carried', (self.momentum_at_start, self.torque,
                                                *frame.from_body(self.axis)))

    def bounds(self, body: Body, constraint: Constraint) -> Bounds:
        """Return the torque of the motor."""
        return Bounds(0.0, abs(self.torque))


@compiled
def gyroscopic(hx, hy, hz, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return h x omega, N m."""
    return cross((hx, hy, hz), (wx, wy, wz))


@compiled
def gyroscopic_driven(h, torque, ax, ay, az, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz, t, x, y, z):
    """Return (h + torque t) a x omega, N m."""
    return scaled(h + torque * t, cross((ax, ay, az), (wx, wy, wz)))


@compiled
def carried(h, torque, ax, ay, az, t):
    """Return (h + torque t) a, kg m^2/s."""
    return scaled(h + torque * t, (ax, ay, az))
