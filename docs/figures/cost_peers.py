# SPDX-License-Identifier: Apache-2.0
"""Our time over that of the best peer, for each problem of the suite and each accuracy."""

from figures.marks import dots, key
from figures.page_tables import numbers, table
from figures.style import label, panels, plain_ticks


def draw(page='accuracy/problems'):
    """Return the figure of a page's table."""
    ours, ratios = None, {}
    for title, *cells in table(page):
        if title.endswith(': ours'):
            problem, ours = title.removesuffix(': ours').strip('*'), cells
        elif title == 'best peer':
            ratios[problem] = [    # a peer may not get there
                numbers(our)[0] / numbers(their)[0] if numbers(their) else None
                for our, their in zip(ours, cells, strict=True)]
    figure, [axes] = panels(height=4.2)
    dots(axes, ratios)
    axes.set_xscale('log')
    plain_ticks(axes.xaxis, (0.0001, 0.001, 0.01, 0.1, 1))
    label(axes, 'time over that of the best peer', '', legend=False)
    key(figure)
    return figure
