# SPDX-License-Identifier: Apache-2.0
"""Time of a run at four accuracies by three methods and heyoka, for a top and a driven body."""

from figures.page_tables import ACCURACIES, first, groups, table
from figures.style import BLACK, BLUE, GREEN, ORANGE, label, panels, plain_ticks

LINES = {'taylor': {'color': BLUE, 'marker': 'o'},
         'gauss16': {'color': GREEN, 'marker': 's', 'linestyle': '-.'},
         'dop8': {'color': ORANGE, 'marker': '^', 'linestyle': ':'},
         'heyoka': {'color': BLACK, 'marker': 'x', 'linestyle': '--'}}


def draw():
    """Return the figure."""
    rows = groups(table('methods/smooth'))
    figure, both = panels(2)
    for axes, title in zip(both, ('asymmetric top 1, 20 s', 'driven body, 20 s'), strict=True):
        for method, cells in rows[title].items():
            axes.plot(ACCURACIES, first(cells), label=method, **LINES[method])
        axes.set(title=title, xscale='log', yscale='log')
        axes.invert_xaxis()
        axes.set_xticks(ACCURACIES)
        axes.minorticks_off()
        plain_ticks(axes.yaxis, (5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000))
        label(axes, 'error of the attitude (rad)', 'CPU time of the run (µs)')
    return figure
