# SPDX-License-Identifier: Apache-2.0
"""Omega of a flattened body by both formulas, and the paths of e3 and omega about L."""

import numpy as np

from figures.style import LINES, MEASURED, THEORY, WRONG, label, panels, run
from rigid_body_sim.study.scenes import instruments
from rigid_body_sim.theory import symmetric_top as theory


def draw():
    """Return the figure."""
    figure, axes = panels(2, width_ratios=(1.6, 1.0))
    simulation = run('symmetric_top')
    fine, some = np.linspace(0.0, 30.0, 601), np.linspace(0.0, 30.0, 31)
    axes[0].plot(fine, 0.8 * np.cos(theory.precession_rate(2.0, 1.0, 1.3) * fine),
                 label='Ω = ω$_3$ (I$_3$ − I$_1$)/I$_1$', **THEORY)
    axes[0].plot(fine, 0.8 * np.cos(theory.precession_rate_as_written(2.0, 1.0, 1.3) * fine),
                 label='the notes: /I$_3$', **WRONG)
    axes[0].plot(some, simulation.states(some).angular_velocity[:, 0], label='measured',
                 **MEASURED)
    axes[0].set_ylim(-0.9, 1.7)
    label(axes[0], 'time (s)', 'ω$_1$ (rad/s)', ncols=2, loc='upper left')
    states = simulation.states(np.linspace(0.0, 2.3, 300))
    L = instruments.momentum_in_world((1.0, 1.0, 1.3))(states)[0]
    up = L / np.linalg.norm(L)
    right = np.cross([0.0, 1.0, 0.0], up)
    right /= np.linalg.norm(right)
    omega = instruments.omega_in_world(states)
    for vectors, name, line in (
            (instruments.axes(states)[:, :, 2], 'e$_3$', LINES[0]),
            (omega / np.linalg.norm(omega, axis=1)[:, np.newaxis], 'ω/|ω|', LINES[1])):
        axes[1].plot(vectors @ right, vectors @ np.cross(up, right), label=name, **line)
    axes[1].plot(0.0, 0.0, 'k+')
    axes[1].annotate('L', (0.0, 0.0), xytext=(5, 4), textcoords='offset points')
    axes[1].set_aspect('equal', adjustable='datalim')
    label(axes[1], 'across L', 'across L', loc='lower center', bbox_to_anchor=(0.5, 1.0), ncols=2)
    return figure
