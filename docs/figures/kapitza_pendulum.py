# SPDX-License-Identifier: Apache-2.0
"""Kapitza's pendulum above and below its threshold, and the balance of its energy."""

import numpy as np

from figures.style import LINES, label, panels, run
from rigid_body_sim.study.scenes.instruments import beta


def draw():
    """Return the figure."""
    figure, (left, right) = panels(2)
    times = np.linspace(0.0, 2.0, 2001)
    for amplitude, line in zip((0.01, 0.006), LINES, strict=False):
        pendulum = run('kapitza_pendulum', f'parameters.A={amplitude}', method='dop8')
        left.plot(times, beta(pendulum.states(times)), label=f'A = {1e3 * amplitude:g} mm', **line)
    label(left, 'time (s)', 'tilt from upright (rad)', loc='lower center',
          bbox_to_anchor=(0.5, 1.0), ncols=2)
    pendulum, rows = run('kapitza_pendulum', method='dop8'), []
    for _ in range(100):
        pendulum.advance(1)
        ledger = pendulum.ledger()
        rows.append((1e3 * pendulum.tick / pendulum.rate, ledger['kinetic'], ledger['potential'],
                     ledger['work']))
    time, *energies = np.array(rows).T
    for energy, text, line in zip(energies, ('kinetic', 'potential', 'work of the drive'), LINES,
                                  strict=False):
        right.plot(time, 1e3 * (energy - energy[0] * (text == 'potential')), label=text, **line)
    label(right, 'time (ms)', 'energy (mJ)', loc='lower center', bbox_to_anchor=(0.5, 1.0),
          ncols=3)
    return figure
