# SPDX-License-Identifier: Apache-2.0
"""Speed and rim speed of a ball struck at four heights."""

import numpy as np

from figures.style import BLACK, LINES, label, panels, run
from rigid_body_sim.theory import billiard


def draw():
    """Return the figure."""
    figure, axes = panels(2, sharey=True)
    times = np.linspace(0.0, 0.6, 301)
    for line, name in zip(
            LINES, ('billiard_low', 'billiard_center', 'billiard_natural_roll', 'billiard_follow'),
            strict=True):
        simulation = run(name)
        scene, states = simulation.scene, simulation.states(times)
        a, h = scene.body.radius, scene.effect('strike').height
        axes[0].plot(times, states.velocity[:, 0], label=f'h = {h / a:+.2f} a', **line)
        axes[1].plot(times, a * states.angular_velocity[:, 1], **line)
        onset = billiard.onset_of_rolling(1.5, h, a, 0.2, 9.81)
        for one in axes:
            one.plot(onset, billiard.rolling_speed(1.5, h, a), 'o', color=BLACK, markersize=5,
                     markerfacecolor='none')
    label(axes[0], 'time (s)', 'speed x′ (m/s)')
    label(axes[1], 'time (s)', 'rim speed a φ′ (m/s)', legend=False)
    axes[1].annotate('circles: the formulas’ onset of rolling', (0.2, -1.0), fontsize=8)
    return figure
