# SPDX-License-Identifier: Apache-2.0
"""The peers' billiard ball, with steps of 1 ms or tolerances of 1e-12: shots, and their error.

sliding_ball.py and contact_engines.py have what the peers do.
"""

import math
from dataclasses import dataclass

from rigid_body_sim.study.hard_cases.case import Question
from rigid_body_sim.study.hard_cases.contact_engines import Bullet, Drake, Heyoka, Mujoco
from rigid_body_sim.study.hard_cases.sliding_ball import A, Rk4, Scipy


@dataclass(frozen=True)
class Shot:
    """A shot: the start of the ball, one push on the way, and its end.

    Attributes
    ----------
    mu : float
    v : tuple of 2 floats
        Initial velocity, m/s.
    omega : tuple of 3 floats
        Initial angular velocity, world axes, rad/s.
    end : float
        Last time, s.
    expected : tuple of 2 floats
        Velocity at the end, m/s.
    push : tuple
        Time (s) and change of v (m/s).
    """

    mu: float
    v: tuple
    omega: tuple
    end: float
    expected: tuple
    push: tuple = (0.0, (0.0, 0.0))


def question(shot):
    """Return the Question for the error of v at the end plus the slip left then (m/s).

    The slip counts if the ball should roll by then.
    """
    def ask(module):
        if module.NAME not in PEERS:
            return ''
        ball = PEERS[module.NAME](shot)
        ball.to(shot.push[0])
        ball.push(shot.push[1])
        ball.to(shot.end)
        (vx, vy), (wx, wy) = ball.velocities()
        slip = math.hypot(vx - A * wy, vy + A * wx) if shot.mu else 0.0
        return math.hypot(vx - shot.expected[0], vy - shot.expected[1]) + slip
    return Question(shot.end, 'm/s', ask)


PEERS = {
    'heyoka': Heyoka,
    'numba RK4': Rk4,
    'SciPy DOP853': Scipy,
    'MuJoCo': Mujoco,
    'Drake': Drake,
    'PyBullet': Bullet,
}
"""Classes by the NAME of the peer's module; RK4 is plain Python here, with the same numbers."""
