# SPDX-License-Identifier: Apache-2.0
"""Path of the pole of rotation on the ground, and the residual of its distance."""

import numpy as np

from figures.style import LINES, label, panels, run

RADIUS, DAY = 6.356e6, 86164.0905       # polar radius of the Earth (m), sidereal day (s)


def draw():
    """Return the figure."""
    figure, axes = panels(2, width_ratios=(1.0, 1.6))
    days = np.linspace(0.0, 915.0, 1831)
    simulation = run('chandler_wobble')
    omega = simulation.states(days * DAY).angular_velocity
    metres = RADIUS * omega[:, :2] / omega[:, 2:]
    axes[0].plot(metres[:611, 0], metres[:611, 1], **LINES[0])
    axes[0].plot(metres[:501:100, 0], metres[:501:100, 1], 'ko', markersize=4)
    for k in range(0, 501, 100):
        axes[0].annotate(f'{days[k]:.0f} d', metres[k], xytext=(5, 4),
                         textcoords='offset points', fontsize=8)
    axes[0].plot(0.0, 0.0, 'k+')
    axes[0].set_aspect('equal', adjustable='datalim')
    label(axes[0], 'along axis 1 (m)', 'along axis 2 (m)', legend=False)
    size = np.hypot(omega[:, 0], omega[:, 1])
    axes[1].plot(days, (size / size[0] - 1.0) * 1e16, linewidth=0.6, **LINES[0])
    label(axes[1], 'sidereal days', 'change of the amplitude (10$^{-16}$ of it)', legend=False)
    return figure
