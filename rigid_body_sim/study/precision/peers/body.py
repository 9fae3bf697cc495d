# SPDX-License-Identifier: Apache-2.0
"""The equations of a rotating body as a peer's user would write them down.

They are the numbers of a scene in principal axes, and their right-hand side for numba.
"""

import math
from dataclasses import dataclass

import numba
import numpy as np

from rigid_body_sim.numerics.rotations import multiply, rotate, rotate_back
from rigid_body_sim.study.precision.peers import start
from rigid_body_sim.study.precision.runner import RefusedError

IDENTITY = (0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True)
class Body:
    """A rotating body in axes principal about the point of reference.

    Attributes
    ----------
    moments : array (3,)
    axes : tuple
        Quaternion from principal to body axes.
    torque : array (3,)
        Constant torque in the body, N m.
    push : array (3,)
        Constant torque in the world, N m.
    weight_arm : array (3,)
        M g r in principal axes, N m; gravity is along -z.
    damping : array (3, 3)
        Matrix of the drag: torque = -damping omega.
    inner : float
        Coefficient of internal dissipation.
    start : array (7,)
        q (from principal axes to the world) and omega (principal axes).
    """

    moments: np.ndarray
    axes: tuple
    torque: np.ndarray
    push: np.ndarray
    weight_arm: np.ndarray
    damping: np.ndarray
    inner: float
    start: np.ndarray

    def state(self, values):
        """Return q (normalised, body axes -> world) and omega in body axes.

        `values` are the unknowns in principal axes.
        """
        q = np.array(values[:4]) / np.linalg.norm(values[:4])
        if self.axes == IDENTITY:
            return *q, *values[4:7]
        x, y, z, w = self.axes
        return *multiply(*q, -x, -y, -z, w), *rotate(*self.axes, *values[4:7])

    def about_center(self, scene):
        """Return the inertia tensor about the centre of mass, and that point's place.

        The tensor has shape (3, 3). The place is relative to the point of reference, in the
        body's principal axes about it.
        """
        if scene.constraint.kind == 'free':
            return np.diag(self.moments), np.zeros(3)
        mass = scene.body.mass
        arm = np.array(rotate_back(*self.axes, *scene.body.center_of_mass))
        return np.diag(self.moments) - mass * (arm @ arm * np.eye(3) - np.outer(arm, arm)), arm

    def refuse_what_joints_lack(self):
        """Raise RefusedError for scenes that the joints of an engine cannot represent."""
        if self.inner:
            raise RefusedError('internal dissipation: it has no such effect')
        if np.abs(self.damping - self.damping[0, 0] * np.eye(3)).max() > 0.0:
            raise RefusedError(
                'drag on the centre of mass of a pivoted body: its joints damp all axes alike')

    def numbers(self):
        """Return all but the start as one flat array for compiled right-hand sides."""
        i = self.moments
        return np.concatenate([i, 1.0 / i, self.torque, self.push, self.weight_arm,
                               self.damping.ravel(), [self.inner]])


def of(scene):
    """Return the Body of a free or pivoted scene; RefusedError tells what peers are not asked."""
    body, kind = scene.body, scene.constraint.kind
    orientation, omega, _ = start.of(scene)
    inertia = body.about_origin if kind == 'pivot' else body.about_center
    if min(inertia.moments) <= 0.0:
        raise RefusedError('a zero moment of inertia: its equations divide by it')
    torque, push = np.zeros(3), np.zeros(3)
    for effect in scene.effects:
        if effect.name == 'torque':
            if effect.frame == 'body':
                torque += rotate_back(*inertia.axes, *effect.values[0])
            else:
                push += effect.values[0]
    gravity, drag, inner = map(scene.effect, ('gravity', 'drag', 'internal_dissipation'))
    arm = (np.array(rotate_back(*inertia.axes, *body.center_of_mass)) if kind == 'pivot'
           else np.zeros(3))
    damping = np.zeros((3, 3))
    if drag:
        damping = (drag.angular * np.eye(3)
                   + drag.linear * (arm @ arm * np.eye(3) - np.outer(arm, arm)))
    q = multiply(*orientation, *inertia.axes) if tuple(inertia.axes) != IDENTITY else orientation
    return Body(
        np.array(inertia.moments), tuple(inertia.axes), torque, push,
        body.mass * (gravity.g if gravity else 0.0) * arm, damping,
        inner.coefficient if inner else 0.0, np.array([*q, *rotate_back(*inertia.axes, *omega)]))


@numba.njit(cache=True)
def rates(p, x, y, z, w, w1, w2, w3):
    """Return the rates of q and omega for p = Body.numbers()."""
    i1, i2, i3 = p[0], p[1], p[2]
    u1, u2, u3 = (
        p[24] * (i2 - i3) * w2 * w3,
        p[24] * (i3 - i1) * w3 * w1,
        p[24] * (i1 - i2) * w1 * w2,
    )
    a1, a2, a3 = w1 + u1, w2 + u2, w3 + u3
    r11, r12, r13 = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)
    r21, r22, r23 = 2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)
    r31, r32, r33 = 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)
    m1 = (p[6] + r11 * p[9] + r21 * p[10] + r31 * p[11] - (p[13] * r33 - p[14] * r32)
          - (p[15] * w1 + p[16] * w2 + p[17] * w3))
    m2 = (p[7] + r12 * p[9] + r22 * p[10] + r32 * p[11] - (p[14] * r31 - p[12] * r33)
          - (p[18] * w1 + p[19] * w2 + p[20] * w3))
    m3 = (p[8] + r13 * p[9] + r23 * p[10] + r33 * p[11] - (p[12] * r32 - p[13] * r31)
          - (p[21] * w1 + p[22] * w2 + p[23] * w3))
    return (
        0.5 * (w * a1 + y * a3 - z * a2),
        0.5 * (w * a2 + z * a1 - x * a3),
        0.5 * (w * a3 + x * a2 - y * a1),
        -0.5 * (x * a1 + y * a2 + z * a3),
        p[3] * (m1 + i2 * w2 * a3 - i3 * w3 * a2),
        p[4] * (m2 + i3 * w3 * a1 - i1 * w1 * a3),
        p[5] * (m3 + i1 * w1 * a2 - i2 * w2 * a1),
    )


def whole_steps(time, step):
    """Return the number of steps that reach a time."""
    return math.floor(time / step + 0.5)
