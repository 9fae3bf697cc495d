# SPDX-License-Identifier: Apache-2.0
"""The equations of a rotating body as a peer's user would write them down.

They are the numbers of a scene in principal axes, and their right-hand side for numba.
"""

import math
from dataclasses import dataclass

import numba
import numpy as np

from rigid_body_sim.numerics.rotations import multiply, rotate, rotate_back
from rigid_body_sim.study.precision import inputs
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
    resisting : array (3, 3)
        M of drag by the square of the velocity of the centre of mass: torque = -quadratic
        sqrt(omega . M omega) M omega.
    quadratic, angular_quadratic : float
        Its coefficient, N s^2/m^2, and that of torque = -angular_quadratic |omega| omega, N m s^2.
    tie : tuple or None
        A spring: (point (m, principal axes), anchor from the pivot (m, world axes), stiffness
        (N/m), length (m)).
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
    resisting: np.ndarray
    quadratic: float
    angular_quadratic: float
    tie: tuple | None
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

    def torques(self):
        """Return functions (q, omega) -> torque in the body: of all that acts but weight."""
        found = []
        if np.any(self.torque):
            found.append(lambda q, omega: self.torque)
        if np.any(self.push):
            found.append(lambda q, omega: np.array(rotate_back(*q, *self.push)))
        if np.any(self.damping):
            found.append(lambda q, omega: -(self.damping @ omega))
        for coefficient, form in ((self.quadratic, self.resisting),
                                  (self.angular_quadratic, np.eye(3))):
            if coefficient:
                def slowed(q, omega, coefficient=coefficient, form=form):
                    slow = form @ omega
                    return -coefficient * math.sqrt(omega @ slow) * slow
                found.append(slowed)
        if self.tie:
            found.append(self._pull)
        return found

    def _pull(self, q, _):
        """Return the torque of the spring."""
        at, anchor, stiffness, length = self.tie
        away = np.subtract(at, rotate_back(*q, *anchor))
        return stiffness * (1.0 - length / math.sqrt(away @ away)) * np.cross(away, at)

    def refuse_what_joints_lack(self):
        """Raise RefusedError for scenes that the joints of an engine cannot represent."""
        if self.inner:
            raise RefusedError('internal dissipation: it has no such effect')
        if self.quadratic or self.angular_quadratic:
            raise RefusedError('drag by the square of the velocity along it: its user would have '
                               'to compute it outside, in each evaluation')
        if np.abs(self.damping - self.damping[0, 0] * np.eye(3)).max() > 0.0:
            raise RefusedError(
                'drag on the centre of mass of a pivoted body: its joints damp all axes alike')

    def numbers(self):
        """Return all but the start as one flat array for compiled right-hand sides."""
        i = self.moments
        at, anchor, stiffness, length = self.tie or (np.zeros(3), np.zeros(3), 0.0, 0.0)
        return np.concatenate([i, 1.0 / i, self.torque, self.push, self.weight_arm,
                               self.damping.ravel(), [self.inner, self.quadratic,
                               self.angular_quadratic], self.resisting.ravel(),
                               at, anchor, [stiffness, length]])


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
    gravity, inner = map(scene.effect, ('gravity', 'internal_dissipation'))
    linear, angular, quadratic, angular_quadratic = inputs.drags(scene)
    arm = (np.array(rotate_back(*inertia.axes, *body.center_of_mass)) if kind == 'pivot'
           else np.zeros(3))
    resisting = arm @ arm * np.eye(3) - np.outer(arm, arm)
    damping = angular * np.eye(3) + linear * resisting
    ties = [(np.array(rotate_back(*inertia.axes, *map(float, at))),
             np.array([float(x) for x in anchor]), float(stiffness), float(length))
            for at, anchor, stiffness, length in inputs.ties(scene, inputs.exactly)]
    if len(ties) > 1:
        raise RefusedError('several springs: the harness gives peers one')
    q = multiply(*orientation, *inertia.axes) if tuple(inertia.axes) != IDENTITY else orientation
    return Body(
        np.array(inertia.moments), tuple(inertia.axes), torque, push,
        body.mass * (gravity.g if gravity else 0.0) * arm, damping,
        inner.coefficient if inner else 0.0, resisting, quadratic, angular_quadratic,
        ties[0] if ties else None, np.array([*q, *rotate_back(*inertia.axes, *omega)]))


@numba.njit(cache=True)
def rates(p, x, y, z, w, w1, w2, w3):
    """Return the rates of q and omega for p = Body.numbers().

    More than forty lines: each law once, in scalars, as a user writes it for speed.
    """
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
    if p[25] != 0.0:
        s1 = p[27] * w1 + p[28] * w2 + p[29] * w3
        s2 = p[30] * w1 + p[31] * w2 + p[32] * w3
        s3 = p[33] * w1 + p[34] * w2 + p[35] * w3
        c = p[25] * math.sqrt(w1 * s1 + w2 * s2 + w3 * s3)
        m1, m2, m3 = m1 - c * s1, m2 - c * s2, m3 - c * s3
    if p[26] != 0.0:
        c = p[26] * math.sqrt(w1 * w1 + w2 * w2 + w3 * w3)
        m1, m2, m3 = m1 - c * w1, m2 - c * w2, m3 - c * w3
    if p[42] != 0.0:
        b1 = r11 * p[39] + r21 * p[40] + r31 * p[41]
        b2 = r12 * p[39] + r22 * p[40] + r32 * p[41]
        b3 = r13 * p[39] + r23 * p[40] + r33 * p[41]
        d1, d2, d3 = p[36] - b1, p[37] - b2, p[38] - b3
        c = p[42] * (1.0 - p[43] / math.sqrt(d1 * d1 + d2 * d2 + d3 * d3))
        m1 += c * (p[37] * b3 - p[38] * b2)
        m2 += c * (p[38] * b1 - p[36] * b3)
        m3 += c * (p[36] * b2 - p[37] * b1)
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
