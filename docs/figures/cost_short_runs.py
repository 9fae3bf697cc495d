# SPDX-License-Identifier: Apache-2.0
"""Time of a short run over that of the best peer, for each scene and accuracy of the table."""

from figures.marks import dots, key
from figures.page_tables import numbers, table
from figures.style import label, panels, plain_ticks

DURATIONS = '0.1 s', '1 s', '5 s'


def draw():
    """Return the figure."""
    rows = table('methods/short_runs')
    figure, three = panels(3, height=3.8, sharey=True, sharex=True)
    for place, (axes, duration) in enumerate(zip(three, DURATIONS, strict=True)):
        dots(axes, {name: numbers(cells[place]) for name, *cells in rows})
        axes.set(title=f'a run of {duration}', xscale='log')
        plain_ticks(axes.xaxis, (0.01, 0.1, 1))
        label(axes, 'time over the best peer', '', legend=False)
    key(figure)
    return figure
