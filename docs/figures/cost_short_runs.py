# SPDX-License-Identifier: Apache-2.0
"""Time of a short run over that of the best peer, for each scene and accuracy of the table."""

from figures.marks import MARKS, name
from figures.page_tables import numbers, table
from figures.style import BLACK, label, panels, plain_ticks

DURATIONS = '0.1 s', '1 s', '5 s'


def draw():
    """Return the figure."""
    rows = table('methods/short_runs')
    figure, three = panels(3, height=3.8, sharey=True, sharex=True)
    for place, (axes, duration) in enumerate(zip(three, DURATIONS, strict=True)):
        for row, (_, *cells) in enumerate(reversed(rows)):
            for ratio, mark in zip(numbers(cells[place]), MARKS.values(), strict=True):
                axes.plot(ratio, row, **mark)
        axes.axvline(1.0, color=BLACK, linewidth=0.8)
        axes.set(title=f'a run of {duration}', xscale='log')
        plain_ticks(axes.xaxis, (0.01, 0.1, 1))
        label(axes, 'time over the best peer', '', legend=False)
    three[0].set_yticks(range(len(rows)), [row[0] for row in reversed(rows)])
    for accuracy, mark in MARKS.items():
        three[0].plot([], [], label=name(accuracy), **mark)
    figure.legend(loc='outside lower center', ncols=4, frameon=False, fontsize=9)
    return figure
