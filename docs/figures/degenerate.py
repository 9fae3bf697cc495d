# SPDX-License-Identifier: Apache-2.0
"""A rod about L, a needle's spin, and a spherical pendulum from above."""

import numpy as np

from figures.style import LINES, label, panels, run
from rigid_body_sim.study.scenes import instruments


def draw():
    """Return the figure."""
    figure, axes = panels(3)
    times = np.linspace(0.0, 4.2, 400)
    tip = instruments.axes(run('thin_rod').states(times))[:, :, 2]
    for k, line in enumerate(LINES[:3]):
        axes[0].plot(times, tip[:, k], label='xyz'[k], **line)
    label(axes[0], 'time (s)', 'direction of the rod', loc='lower center',
          bbox_to_anchor=(0.5, 1.0), ncols=3, fontsize=8)
    times = np.linspace(0.0, 0.02, 400)
    omega = run('needle').states(times).angular_velocity
    axes[1].plot(1e3 * times, omega[:, 0], label='ω$_1$', **LINES[0])
    axes[1].plot(1e3 * times, omega[:, 1], label='ω$_2$', **LINES[1])
    label(axes[1], 'time (ms)', 'needle: ω in the body (rad/s)', loc='lower center',
          bbox_to_anchor=(0.5, 1.0), ncols=2, fontsize=8)
    e3 = instruments.axes(run('spherical_pendulum').states(np.linspace(0.0, 8.0, 1200)))[:, :, 2]
    axes[2].plot(e3[:, 0], e3[:, 1], linewidth=1.0, **LINES[0])
    axes[2].set_aspect('equal')
    label(axes[2], 'pendulum: x (m)', 'y (m)', legend=False)
    return figure
