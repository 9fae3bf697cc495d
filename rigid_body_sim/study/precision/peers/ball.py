# SPDX-License-Identifier: Apache-2.0
"""A ball on a table as a peer's user writes it down: it slides, and then rolls.

Friction acts along the slip, which keeps its direction. The unknowns are q, omega in world axes,
v_x and v_y; e is the direction of the slip u = v + omega x (-a z) at the start. The equations
v' = -mu g e, I omega' = -a z x (-mu M g e) hold until e . u = 0, which is an event for the methods
that find events. From there on v and omega are constant.
"""

from dataclasses import dataclass

import numba
import numpy as np

from rigid_body_sim.numerics.rotations import rotate, rotate_back
from rigid_body_sim.study.precision.peers import start

ROLLS = 4e-16
"""Largest share of the speeds that counts as rounding of the slip."""


@dataclass(frozen=True)
class Ball:
    """A sphere on a plane.

    Attributes
    ----------
    radius, mu, g : float
    push : array (9,)
        Rates of the unknowns while it slides, without those of q.
    slip : array (9,)
        Vector whose product with the unknowns is e . u.
    start : array (9,)
    slides : bool
        Whether it slides at the start.
    """

    radius: float
    mu: float
    g: float
    push: np.ndarray
    slip: np.ndarray
    start: np.ndarray
    slides: bool

    def state(self, values):
        """Return q (normalised) and omega in body axes."""
        q = np.array(values[:4]) / np.linalg.norm(values[:4])
        return *q, *rotate_back(*q, *values[4:7])


def of(scene):
    """Return the Ball of a scene; RefusedError tells what peers are not asked to run."""
    body, friction = scene.body, scene.effect('sliding_friction')
    q, omega, velocity = start.of(scene)
    a, ratio = body.radius, body.about_center.moments[0] / (body.mass * body.radius ** 2)
    mu, g = (friction.mu, friction.g) if friction else (0.0, 0.0)
    wx, wy, wz = rotate(*q, *omega)
    u = np.array([velocity[0] - a * wy, velocity[1] + a * wx])
    size = float(np.hypot(*u))
    slides = size > ROLLS * (np.hypot(*velocity[:2]) + a * np.hypot(wx, wy)) and mu * g > 0.0
    ex, ey = u / size if slides else (0.0, 0.0)
    turn = mu * g / (ratio * a)
    return Ball(
        a, mu, g,
        np.array([0.0, 0.0, 0.0, 0.0, -turn * ey, turn * ex, 0.0, -mu * g * ex, -mu * g * ey]),
        np.array([0.0, 0.0, 0.0, 0.0, a * ey, -a * ex, 0.0, ex, ey]),
        np.array([*q, wx, wy, wz, *velocity[:2]]), slides)


@numba.njit(cache=True)
def rates(p, values, out):
    """Store the rates of the unknowns; p is Ball.push, or zeros when it rolls."""
    x, y, z, w, w1, w2, w3 = values[:7]
    out[:] = p
    out[0] = 0.5 * (w * w1 + w2 * z - w3 * y)
    out[1] = 0.5 * (w * w2 + w3 * x - w1 * z)
    out[2] = 0.5 * (w * w3 + w1 * y - w2 * x)
    out[3] = -0.5 * (w1 * x + w2 * y + w3 * z)
