# SPDX-License-Identifier: Apache-2.0
"""Pitch of a satellite on a circular orbit, with the least and with the middle moment outwards."""

import math

import numpy as np

from figures.style import LINES, label, panels, run
from rigid_body_sim.numerics.rotations import multiply


def draw():
    """Return the figure."""
    figure, (axes,) = panels(1)
    n = 0.0011
    times = np.linspace(0.0, 3.0 * 2.0 * math.pi / n, 601)
    for moments, line in zip(('[200, 450, 500]', '[450, 200, 500]'), LINES, strict=False):
        satellite = run('librating_satellite', f'body.inertia={moments}', method='dop8')
        states = satellite.states(times)
        pitch = [2.0 * math.atan2(q[2], q[3]) for q in (
            multiply(0.0, 0.0, -math.sin(0.5 * n * t), math.cos(0.5 * n * t), *q)
            for t, q in zip(times, states.orientation, strict=True))]
        axes.plot(times * n / (2.0 * math.pi), np.degrees(np.unwrap(pitch)),
                  label=f'moments {moments} kg m²', **line)
    label(axes, 'orbits', 'pitch (°)', loc='lower center', bbox_to_anchor=(0.5, 1.0), ncols=2)
    return figure
