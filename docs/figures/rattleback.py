# SPDX-License-Identifier: Apache-2.0
"""The spin of a rattleback started in both senses, and its pitch."""

import numpy as np

from figures.style import BLACK, GREY, LINES, label, panels, run
from rigid_body_sim.study.scenes.convex_body import normals

LIGHT = '#E69F00'    # light beside black, in grey too


def draw():
    """Return the figure."""
    figure, (left, right) = panels(2)
    times = np.linspace(0.0, 10.0, 2001)
    for spin, line in zip((-5.0, 5.0), LINES, strict=False):
        top = run('rattleback', f'initial.angular_velocity=[0, 0, {spin}]', method='dop8')
        states = top.states(times)
        left.plot(times, states.angular_velocity[:, 2], label=f'started at {spin:g} rad/s', **line)
        if spin < 0.0:
            n = normals(states)
            right.plot(times, np.degrees(np.arcsin(n[:, 1])), label='roll', linewidth=0.6,
                       color=LIGHT)
            right.plot(times, np.degrees(np.arcsin(n[:, 0])), label='pitch', linewidth=0.6,
                       color=BLACK)
    left.axhline(0.0, color=GREY, linewidth=0.8)
    label(left, 'time (s)', 'spin ω$_3$ (rad/s)', loc='lower center', bbox_to_anchor=(0.5, 1.0),
          ncols=2)
    label(right, 'time (s)', 'tilt, started at −5 rad/s (°)', loc='lower center',
          bbox_to_anchor=(0.5, 1.0), ncols=2)
    return figure
