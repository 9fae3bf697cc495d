# SPDX-License-Identifier: Apache-2.0
"""Angular velocity of a driven symmetric body, with the closed form."""

import numpy as np

from figures.style import GREY, LINES, label, panels, run
from rigid_body_sim.theory import driven_body as theory


def draw():
    """Return the figure."""
    figure, axes = panels(2)
    simulation = run('driven_body', method='dop8')
    times = np.linspace(0.0, 20.0, 801)
    omega = simulation.states(times).angular_velocity
    for k, line in enumerate(LINES[:3]):
        axes[0].plot(times, omega[:, k], label=f'ω$_{k + 1}$', **line)
    predicted = theory.angular_velocity(
        times[::20], simulation.scene.initial.angular_velocity, 0.5, 0.8, 1.3)
    axes[0].plot(times[::20], predicted, '.', color='#000000', markersize=3)
    label(axes[0], 'time (s)', 'ω in the body (rad/s)')
    turned = np.unwrap(np.arctan2(omega[:, 1], omega[:, 0]))
    axes[1].plot(times, turned - turned[0], label='measured', **LINES[0])
    axes[1].plot(times[::40], theory.phase(times[::40], -1.1, 0.5, 0.8, 1.3), 'o',
                 markerfacecolor='none', label='quadratic in time', color=GREY)
    axes[1].axvline(theory.spin_reversal_time(-1.1, 0.5, 1.3), color='#D55E00', linestyle=':',
                    label='ω$_3$ = 0')
    label(axes[1], 'time (s)', 'angle that ω turned in the body (rad)')
    return figure
