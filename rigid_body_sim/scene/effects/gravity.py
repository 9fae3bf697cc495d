# SPDX-License-Identifier: Apache-2.0
"""Gravity: a uniform field along -z of the world, or along any direction.

It moves a free body's centre of mass and turns a pivoted or hinged body.
"""

from dataclasses import dataclass
from typing import Any, ClassVar

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.rotations import rotate_back
from rigid_body_sim.numerics.vectors import across, cross, scaled
from rigid_body_sim.scene.bodies import Body
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism
from rigid_body_sim.scene.effects.protocol import (
    Acting,
    Bounds,
    Effect,
    Potential,
    Pull,
    Vector,
)
from rigid_body_sim.scene.frame import Frame
from rigid_body_sim.scene.schema import VECTOR, described, mapping_of

FIELD = {**VECTOR, 'type': ['number', 'array'], 'minimum': 0}


@dataclass(frozen=True)
class Gravity(Effect):
    """``gravity: {g: 9.81}``; g in m/s^2, zero or positive.

    A vector is the field itself, world components: see :class:`GravityVector`.

    Free body: F = -M g z at the centre of mass, no couple about it. Pivot, hinge: the torque r x F
    about the constraint (notes, "Symmetric Top in a uniform gravitational field").
    """

    g: float
    name: ClassVar[str] = 'gravity'
    SCHEMA: ClassVar[dict] = described(mapping_of(
        ['g'],
        g=described(FIELD, 'm/s^2, along -z of the world; or the field as a vector, world axes')),
        'F = M g at the centre of mass; booked as potential')
    mechanisms: ClassVar = (Mechanism.FREE, Mechanism.POINT, Mechanism.AXIS, Mechanism.PLANE)

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, constraint: Constraint,
                   where: str) -> Effect:
        """Return the effect of its settings in a scene file."""
        if not isinstance(settings['g'], list):
            return cls(float(settings['g']))
        x, y, z = map(float, settings['g'])
        if x == 0.0 and y == 0.0 and z <= 0.0:
            return cls(abs(z))
        return GravityVector.from_scene(settings, body, constraint, where)

    def acting(self, frame: Frame, time: float) -> tuple[Acting, ...]:
        """Return the weight, or its torque about the constraint; nothing without either."""
        weight = frame.mass * self.g
        if weight == 0.0:
            return ()
        found = []
        if frame.pushed:
            found.append(Acting('rigid_body_sim.scene.effects.elementary:constant',
                                (0.0, 0.0, -weight), 'force', 'potential', polynomial=True))
        if any(frame.arm):
            found.append(Acting('rigid_body_sim.scene.effects.elementary:moment_of_weight',
                                scaled(weight, frame.arm), 'torque', 'potential',
                                polynomial=True))
        return tuple(found)

    def series(self, frame: Frame, time: float) -> Pull:
        """Return the weight."""
        return Pull(force=(0.0, 0.0, -frame.mass * self.g))

    @property
    def uniform_field(self) -> Vector:
        """The acceleration, m/s^2."""
        return 0.0, 0.0, -self.g

    def potential(self, frame: Frame) -> Potential:
        """Return M g z, z the height of the centre of mass above the world's origin."""
        return Potential(f'{__name__}:energy', (frame.mass * self.g,))

    def bounds(self, body: Body, constraint: Constraint) -> Bounds:
        """Return M g r where a point is held, r its distance from the centre of mass."""
        if not constraint.holds_a_point:
            return Bounds(0.0, 0.0)
        return Bounds(body.mass * self.g * hypot3(*constraint.arm(body)), 0.0)

    def notes(self, body: Body, constraint: Constraint) -> list[str]:
        """Warn if the body is held at its centre of mass."""
        arm = constraint.arm(body)
        if constraint.axis is not None:
            arm = across(constraint.axis, arm)
        if not constraint.holds_a_point or any(arm):
            return []
        return [f'the {constraint.kind} holds the body at its centre of mass: '
                'gravity does nothing there']


@dataclass(frozen=True)
class GravityVector(Effect):
    """``gravity: {g: [gx, gy, gz]}``: a uniform field in any direction, m/s^2, world components.

    F = M g at the centre of mass, U = -M g . r. A vector along -z is a :class:`Gravity`.
    """

    g: Vector
    name: ClassVar[str] = 'gravity_vector'
    SCHEMA: ClassVar[dict] = Gravity.SCHEMA
    mechanisms: ClassVar = (Mechanism.FREE, Mechanism.POINT, Mechanism.AXIS)

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, constraint: Constraint,
                   where: str) -> Effect:
        """Return the effect of its settings in a scene file; a plane has a normal instead."""
        if constraint.mechanism is Mechanism.PLANE:
            raise BadInput(f'{where}.g', f'got {settings["g"]}',
                           'above a plane gravity is along -z: incline the plane, '
                           'table: {normal: [x, y, z]}')
        x, y, z = map(float, settings['g'])
        return cls((x, y, z))

    def acting(self, frame: Frame, time: float) -> tuple[Acting, ...]:
        """Return the weight, or its torque about the constraint."""
        weight = scaled(frame.mass, self.g)
        if not any(weight):
            return ()
        found = []
        if frame.pushed:
            found.append(Acting('rigid_body_sim.scene.effects.elementary:constant', weight,
                                'force', 'potential', polynomial=True))
        if any(frame.arm):
            found.append(Acting(f'{__name__}:moment', (*frame.arm, *weight), 'torque',
                                'potential', polynomial=True))
        return tuple(found)

    def series(self, frame: Frame, time: float) -> Pull:
        """Return the weight."""
        return Pull(force=scaled(frame.mass, self.g))

    @property
    def uniform_field(self) -> Vector:
        """The acceleration, m/s^2."""
        return self.g

    def potential(self, frame: Frame) -> Potential:
        """Return -M g . r, r the place of the centre of mass."""
        return Potential(f'{__name__}:energy_in_field', scaled(frame.mass, self.g))

    def bounds(self, body: Body, constraint: Constraint) -> Bounds:
        """Return M |g| r where a point is held, r its distance from the centre of mass."""
        if not constraint.holds_a_point:
            return Bounds(0.0, 0.0)
        return Bounds(body.mass * hypot3(*self.g) * hypot3(*constraint.arm(body)), 0.0)


@compiled
def moment(rx, ry, rz, fx, fy, fz, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return r x R^T F, N m."""
    return cross((rx, ry, rz), rotate_back(qx, qy, qz, qw, fx, fy, fz))


@compiled
def energy_in_field(fx, fy, fz, qx, qy, qz, qw, x, y, z):
    """Return -F . r (J)."""
    return -(fx * x + fy * y + fz * z)


@compiled
def energy(weight, qx, qy, qz, qw, x, y, z):
    """Return M g z (J)."""
    return weight * z
