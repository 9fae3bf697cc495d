# SPDX-License-Identifier: Apache-2.0
"""Error against time of a run, for bodies on a plane by three methods."""

from figures.methods import LINES
from figures.page_tables import groups, numbers, table
from figures.style import label, panels, plain_ticks

SHOWN = 'tippe top', 'rattleback', "Euler's disk", 'Routh sphere'


def draw():
    """Return the figure."""
    rows = groups(table('methods/plane'))
    figure, all_axes = panels(len(SHOWN), height=3.0, sharey=True)
    for axes, name in zip(all_axes, SHOWN, strict=True):
        title = next(title for title in rows if title.startswith(name))
        for method, cells in rows[title].items():
            axes.plot(*zip(*map(numbers, cells), strict=True), label=method, markersize=4,
                      **LINES[method])
        axes.set(xscale='log', yscale='log')
        plain_ticks(axes.xaxis, (0.1, 0.3, 1, 3, 10, 30))
        axes.set_title(name, fontsize=10)
        label(axes, 'CPU time (ms)', '', legend=False)
    label(all_axes[0], 'CPU time (ms)', 'error of the attitude (rad)', legend=False)
    figure.legend(*all_axes[0].get_legend_handles_labels(), loc='outside lower center', ncols=4,
                  frameon=False, fontsize=9)
    return figure
