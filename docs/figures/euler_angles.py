# SPDX-License-Identifier: Apache-2.0
"""Euler angles of the heavy top, and omega from their rates."""

import numpy as np

from figures.style import LINES, MEASURED, label, panels, run
from rigid_body_sim.study.scenes import instruments
from rigid_body_sim.theory import euler_angles


def draw():
    """Return the figure."""
    figure, axes = panels(2)
    times = np.linspace(0.0, 0.5, 2001)
    states = run('heavy_top').states(times)
    angles = [np.unwrap(angle(states))
              for angle in (instruments.alpha, instruments.beta, instruments.gamma)]
    for angle, name, line in zip(
            (angles[0], angles[1], angles[2] / 10.0), ('α', 'β', 'γ/10'), LINES[:3], strict=True):
        axes[0].plot(times, angle, label=name, **line)
    label(axes[0], 'time (s)', 'angle (rad)')
    rates = [np.gradient(angle, times) for angle in angles]
    omega = euler_angles.body_rates(*rates, angles[1], angles[2])
    axes[1].plot(times, states.angular_velocity[:, 0], label='ω$_1$ of the body', **LINES[0])
    axes[1].plot(times[1:-1:60], omega[0, 1:-1:60], label='−α′ sin β cos γ + β′ sin γ',
                 **MEASURED | {'color': LINES[1]['color']})
    axes[1].set_ylim(-2.5, 4.5)
    label(axes[1], 'time (s)', 'ω$_1$ (rad/s)', loc='upper right')
    return figure
