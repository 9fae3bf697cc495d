# SPDX-License-Identifier: Apache-2.0
"""Error against time of a run, for effects that are formulas, by three methods and heyoka."""

from figures.methods import LINES
from figures.page_tables import groups, numbers, table
from figures.style import label, panels, plain_ticks

TITLES = {'on a spring': 'spring', 'gravity gradient': 'gravity gradient',
          'drag by the square': 'drag by the square', 'attitude under control': 'control'}


def draw():
    """Return the figure."""
    rows = groups(table('methods/expressions'))
    figure, all_axes = panels(len(TITLES), height=3.0, sharey=True)
    for axes, (begin, title) in zip(all_axes, TITLES.items(), strict=True):
        for method, cells in rows[next(one for one in rows if one.startswith(begin))].items():
            axes.plot(*zip(*map(numbers, cells), strict=True), label=method, markersize=4,
                      **LINES[method])
        axes.set(xscale='log', yscale='log')
        plain_ticks(axes.xaxis, (20, 50, 100, 200))
        axes.set_title(title, fontsize=10)
        label(axes, 'CPU time (µs)', '', legend=False)
    label(all_axes[0], 'CPU time (µs)', 'error of the attitude (rad)', legend=False)
    figure.legend(*all_axes[0].get_legend_handles_labels(), loc='outside lower center', ncols=4,
                  frameon=False, fontsize=9)
    return figure
