# SPDX-License-Identifier: Apache-2.0
"""A hinged body as a peer's user writes it down: one angle phi.

phi'' = a cos phi + b sin phi + k - d phi' - s phi.
"""

import math
from dataclasses import dataclass

import numba
import numpy as np

from rigid_body_sim.numerics.rotations import multiply, rotate, rotate_back
from rigid_body_sim.study.precision import inputs
from rigid_body_sim.study.precision.peers import start
from rigid_body_sim.study.precision.runner import RefusedError


@dataclass(frozen=True)
class Pendulum:
    """A body on a hinge; phi is the angle turned since the start.

    Attributes
    ----------
    axis : array (3,)
        Direction of the hinge, body axes, unit length.
    numbers : array (5,)
        a, b, k (rad/s^2), d (1/s) and s (1/s^2) in 80-bit numbers, because their rounding
        matters near a separatrix.
    torque, friction, stiffness : float
        I k (N m) without the pull of the spring at phi = 0, I d (N m s), I s (N m/rad).
    slack : float
        The phi at which the spring pulls nothing, rad.
    orientation : tuple
        q at phi = 0.
    start : array (2,)
        phi (0), phi'.
    """

    axis: np.ndarray
    numbers: np.ndarray
    torque: float
    friction: float
    stiffness: float
    slack: float
    orientation: tuple
    start: np.ndarray

    def state(self, values):
        """Return q and omega (body axes) from phi and phi'."""
        half, rate = 0.5 * values[0], values[1]
        return (*multiply(*self.orientation, *(math.sin(half) * self.axis), math.cos(half)),
                *(rate * self.axis))


def of(scene):
    """Return the Pendulum of a scene; RefusedError tells what peers are not asked to run."""
    body, constraint = scene.body, scene.constraint
    q, omega, _ = start.of(scene)
    long = np.longdouble
    axis, arm = (np.array(constraint.axis, long),
                 np.subtract(body.center_of_mass, constraint.through, dtype=long))
    out = arm - axis * (axis @ arm)
    moment = axis @ body.about_center.matrix.astype(long) @ axis + body.mass * (out @ out)
    # vertical in the body at phi = 0; the weight's torque about the axis is M g n . (z x r)
    up = np.array(rotate_back(*q, 0.0, 0.0, 1.0), long)
    gravity = scene.effect('gravity')
    linear, angular, quadratic, angular_quadratic = inputs.drags(scene)
    if quadratic or angular_quadratic:
        raise RefusedError('drag by squares on a hinge: the harness gives peers smooth motions '
                           'only')
    weight = body.mass * long(gravity.g if gravity else 0.0)
    torque, friction = long(0), angular + linear * (out @ out)
    for effect in scene.effects:
        if effect.name == 'torque':
            torque += (axis @ effect.values[0] if effect.frame == 'body'
                       else np.dot(rotate(*q, *axis.astype(float)), effect.values[0]))
    stiffness, slack, damping = map(long, map(float, inputs.torsion(scene, inputs.exactly)))
    friction += damping
    numbers = (np.array([weight * (axis @ np.cross(up, out)),
                         weight * (axis @ np.cross(up, np.cross(axis, out))),
                         torque + stiffness * slack, friction, stiffness]) / moment)
    return Pendulum(axis.astype(float), numbers, float(torque), float(friction), float(stiffness),
                    float(slack), q, np.array([0.0, np.dot(constraint.axis, omega)]))


@numba.njit(cache=True)
def rates(p, phi, rate):
    """Return the rates of phi and phi' for p = Pendulum.numbers."""
    return (rate,
            p[0] * math.cos(phi) + p[1] * math.sin(phi) + p[2] - p[3] * rate - p[4] * phi)
