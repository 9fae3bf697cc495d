# SPDX-License-Identifier: Apache-2.0
"""Flips of the racket, and the growth of the deviation before the first one."""

import numpy as np

from figures.style import LINES, THEORY, label, panels, run
from rigid_body_sim.theory import asymmetric_top as theory


def draw():
    """Return the figure."""
    figure, axes = panels(2)
    simulation = run('tennis_racket')
    times = np.linspace(0.0, 20.0, 2001)
    omega = simulation.states(times).angular_velocity
    for k, line in enumerate(LINES[:3]):
        axes[0].plot(times, omega[:, k], label=f'ω$_{k + 1}$', **line)
    interval = theory.time_between_flips((1.0, 2.0, 3.0), (0.01, 5.0, 0.01))
    axes[0].axvspan(0.5 * interval, 1.5 * interval, color='#eeeeee', linewidth=0)
    axes[0].annotate('between flips:\n2 K(k)/λ', (interval, 1.2), ha='center', fontsize=8,
                     bbox={'facecolor': '#eeeeee', 'linewidth': 0, 'pad': 1.0})
    label(axes[0], 'time (s)', 'ω in the body (rad/s)', ncols=3, loc='upper center',
          bbox_to_anchor=(0.5, 1.14))
    early = times < 1.9
    axes[1].semilogy(times[early], np.abs(omega[early, 0]), label='|ω$_1$| measured', **LINES[0])
    rate = theory.growth_rate(5.0, 3.0, 1.0, 2.0)
    axes[1].semilogy(times[early], _growing(times[early], rate),
                     label='growing part, e$^{rate · t}$', **THEORY)
    label(axes[1], 'time (s)', 'deviation (rad/s)')
    return figure


def _growing(times, rate):
    """Return the growing part of omega1 in the linear solution.

    It begins at the scene's seed, omega1 = omega3 = 0.01 rad/s.
    """
    # I1 omega1' = (I2 - I3) omega2 omega3 and the like: this is -omega1/omega3 while it grows,
    # for moments 1, 2, 3
    ratio = np.sqrt(3.0)
    return 0.5 * abs(0.01 - ratio * 0.01) * np.exp(rate * times)
