# SPDX-License-Identifier: Apache-2.0
"""The height of a tossed coin, and the heat that its energy becomes."""

import numpy as np

from figures.style import LINES, label, panels, run


def draw():
    """Return the figure."""
    figure, (left, right) = panels(2)
    coin, rows = run('tossed_coin', method='dop8'), []
    for _ in range(1000):
        coin.advance(2)
        ledger = coin.ledger()
        rows.append((coin.tick / coin.rate, 100.0 * coin.state.position[2],
                     ledger['kinetic'] + ledger['potential'], ledger['dissipated_impacts'],
                     ledger['dissipated_sliding'], ledger['dissipated_rolling']))
    time, height, *energies = np.array(rows).T
    left.plot(time, height, **LINES[0])
    label(left, 'time (s)', 'height of the centre (cm)', legend=False)
    for energy, text, line in zip(energies, ('motion', 'impacts', 'slip', 'roll'), LINES,
                                  strict=True):
        right.semilogy(time, np.maximum(1e3 * energy, 1e-4), label=text, **line)
    label(right, 'time (s)', 'energy, heat (mJ)', loc='lower center', bbox_to_anchor=(0.5, 1.0),
          ncols=4)
    return figure
