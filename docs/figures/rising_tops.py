# SPDX-License-Identifier: Apache-2.0
"""The inclination of tippe tops of the three groups, and of an egg that rises."""

import numpy as np

from figures.style import GREY, LINES, label, panels, run
from rigid_body_sim.study.scenes.convex_body import normals


def draw():
    """Return the figure."""
    figure, (left, right) = panels(2)
    times = np.linspace(0.0, 3.0, 1501)
    for share, line in zip((0.75, 8.0 / 7.0, 1.35), LINES, strict=False):
        A = 7.0e-7 * share
        top = run('tippe_top', f'body.inertia=[{A}, {A}, 7.0e-7]', method='dop8')
        left.plot(times, _degrees(top, times), label=f'A/C = {share:.3g}', **line)
    label(left, 'time (s)', 'inclination of a tippe top (°)', loc='lower center',
          bbox_to_anchor=(0.5, 1.0), ncols=3)
    for mu, line in zip((0.1, 0.05), LINES, strict=False):
        egg = run('rising_egg', f'effects.sliding_friction.mu={mu}', method='dop8')
        right.plot(times, _degrees(egg, times), label=f'μ = {mu:g}', **line)
    label(right, 'time (s)', 'inclination of an egg (°)', loc='lower center',
          bbox_to_anchor=(0.5, 1.0), ncols=2)
    for axes in (left, right):
        axes.axhline(90.0, color=GREY, linewidth=0.8)
    return figure


def _degrees(simulation, times):
    return np.degrees(np.arccos(normals(simulation.states(times))[:, 2]))
