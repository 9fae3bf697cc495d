# SPDX-License-Identifier: Apache-2.0
"""A hinged body as a peer's user writes it down: one angle phi.

phi'' = a cos phi + b sin phi + k - d phi'.
"""

import math
from dataclasses import dataclass

import numba
import numpy as np

from rigid_body_sim.numerics.rotations import multiply, rotate, rotate_back
from rigid_body_sim.study.precision.peers import start


@dataclass(frozen=True)
class Pendulum:
    """A body on a hinge; phi is the angle turned since the start.

    Attributes
    ----------
    axis : array (3,)
        Direction of the hinge, body axes, unit length.
    numbers : array (4,)
        a, b, k (rad/s^2) and d (1/s) in 80-bit numbers, because their rounding matters near a
        separatrix.
    torque, friction : float
        I k (N m), I d (N m s).
    orientation : tuple
        q at phi = 0.
    start : array (2,)
        phi (0), phi'.
    """

    axis: np.ndarray
    numbers: np.ndarray
    torque: float
    friction: float
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
    gravity, drag = scene.effect('gravity'), scene.effect('drag')
    weight = body.mass * long(gravity.g if gravity else 0.0)
    torque, friction = long(0), drag.angular + drag.linear * (out @ out) if drag else long(0)
    for effect in scene.effects:
        if effect.name == 'torque':
            torque += (axis @ effect.values[0] if effect.frame == 'body'
                       else np.dot(rotate(*q, *axis.astype(float)), effect.values[0]))
    numbers = (np.array([weight * (axis @ np.cross(up, out)),
                         weight * (axis @ np.cross(up, np.cross(axis, out))), torque, friction])
               / moment)
    return Pendulum(axis.astype(float), numbers, float(torque), float(friction), q,
                    np.array([0.0, np.dot(constraint.axis, omega)]))


@numba.njit(cache=True)
def rates(p, phi, rate):
    """Return the rates of phi and phi' for p = Pendulum.numbers."""
    return rate, p[0] * math.cos(phi) + p[1] * math.sin(phi) + p[2] - p[3] * rate
