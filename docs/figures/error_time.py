# SPDX-License-Identifier: Apache-2.0
"""Error against time of a run by each method of a table, a panel for each of its groups."""

from figures.methods import LINES
from figures.page_tables import groups, numbers, table
from figures.style import label, panels, plain_ticks


def panels_of(page, titles, unit, ticks):
    """Return the figure of a page's table.

    Parameters
    ----------
    page : str
    titles : dict
        How a group of rows begins -> the title of its panel.
    unit : str
        Of the times.
    ticks : tuple of float
        Times that are written on the axis.
    """
    rows = groups(table(page))
    figure, all_axes = panels(len(titles), height=3.0, sharey=True)
    for axes, (begin, title) in zip(all_axes, titles.items(), strict=True):
        for method, cells in rows[next(one for one in rows if one.startswith(begin))].items():
            axes.plot(*zip(*map(numbers, cells), strict=True), label=method, markersize=4,
                      **LINES[method])
        axes.set(xscale='log', yscale='log')
        axes.set_title(title, fontsize=10)
        plain_ticks(axes.xaxis, ticks)
        label(axes, f'CPU time ({unit})', '', legend=False)
    all_axes[0].set_ylabel('error of the attitude (rad)')
    figure.legend(*all_axes[0].get_legend_handles_labels(), loc='outside lower center', ncols=4,
                  frameon=False, fontsize=9)
    return figure
