# SPDX-License-Identifier: Apache-2.0
"""A billiard ball that slides, by the integrators that a user has without an engine.

They get Coulomb's law as their user writes it: v' = -mu g e and a omega' = (5/2) mu g (-e_y, e_x),
where e = u/|u| is the direction of the slip u = v + omega x (-a z), or zero where u is zero.
"""

import math

import numpy as np

from rigid_body_sim.errors import NotConverged
from rigid_body_sim.study.hard_cases.beside import STEP, TOLERANCE

A, MASS, G = 0.028575, 0.17, 9.81


def rates(y, drive, root=math.sqrt):
    """Return (v', a omega') at y = (vx, vy, a wx, a wy) for drive = mu g."""
    ux, uy = y[0] - y[3], y[1] + y[2]
    slip = root(ux * ux + uy * uy)
    ex, ey = (ux / slip, uy / slip) if slip != 0.0 else (0.0, 0.0)
    return [-drive * ex, -drive * ey, -2.5 * drive * ey, 2.5 * drive * ex]


class Equations:
    """Base of the integrators, with the unknowns (vx, vy, a wx, a wy)."""

    def __init__(self, shot):
        self.drive, self.time = shot.mu * G, 0.0
        self.y = np.array([*shot.v, A * shot.omega[0], A * shot.omega[1]])

    def push(self, change):
        """Change the velocity by (x, y), m/s."""
        self.y[:2] += change

    def velocities(self):
        """Return (x, y) of the velocity, m/s, and of the angular velocity, rad/s."""
        return (self.y[0], self.y[1]), (self.y[2] / A, self.y[3] / A)


class Rk4(Equations):
    """Plain Python, with the numbers of the peer that numba compiles."""

    def to(self, time):
        """Go on to a time, s."""
        def rate(y):
            return np.array(rates(y, self.drive))
        for _ in range(round((time - self.time) / STEP)):
            y, h = self.y, STEP
            k1 = rate(y)
            k2 = rate(y + 0.5 * h * k1)
            k3 = rate(y + 0.5 * h * k2)
            self.y = y + h / 6.0 * (k1 + 2.0 * (k2 + k3) + rate(y + h * k3))
        self.time = time


class Scipy(Equations):
    """DOP853."""

    def to(self, time):
        """Go on to a time, s."""
        from scipy.integrate import solve_ivp
        if time > self.time:
            found = solve_ivp(lambda _, y: rates(y, self.drive), (self.time, time), self.y,
                              'DOP853', rtol=TOLERANCE, atol=TOLERANCE)
            if not found.success:
                raise NotConverged(found.message)
            self.time, self.y = time, found.y[:, -1].copy()
