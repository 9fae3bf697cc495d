# SPDX-License-Identifier: Apache-2.0
"""The inclination of Routh's sphere, and the angular velocity of Chaplygin's."""

import numpy as np

from figures.style import LINES, MEASURED, label, panels, run
from rigid_body_sim.study.scenes.convex_body import normals
from rigid_body_sim.theory import rolling_sphere


def draw():
    """Return the figure."""
    figure, (left, right) = panels(2)
    sphere = run('routh_sphere', method='dop8')
    times = np.linspace(0.0, 5.0, 501)
    theta = np.degrees(np.arccos(normals(sphere.states(times))[:, 2]))
    left.plot(times, theta, label='dop8', **LINES[0])
    other, half = rolling_sphere.swing(0.9, 1.5, 4.0, 0.3, 0.2, 1.0, 0.7, 0.12, 9.81)
    turns = np.arange(0, int(5.0 / half) + 1)
    left.plot(turns * half, np.degrees(np.where(turns % 2, other, 0.9)),
              label='turning points by the quadrature', **MEASURED)
    label(left, 'time (s)', "inclination of Routh's sphere (°)", loc='lower center',
          bbox_to_anchor=(0.5, 1.0))
    times = np.linspace(0.0, 20.0, 801)
    ball = run('chaplygin_sphere', method='dop8').states(times)
    for k, line in enumerate(LINES[:3]):
        right.plot(times, ball.angular_velocity[:, k], label=f'ω$_{k + 1}$', **line)
    label(right, 'time (s)', "Chaplygin's sphere (rad/s)", loc='lower center',
          bbox_to_anchor=(0.5, 1.0), ncols=3)
    return figure
