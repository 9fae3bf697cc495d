# SPDX-License-Identifier: Apache-2.0
"""Two bars for each row of a table: without and with what the page tells of."""

import numpy as np

from figures.page_tables import first, table
from figures.style import BLUE, GREY, label, panels


def draw(page, titles, axis):
    """Return the figure of a page's table; `titles` are those of its second and third columns."""
    rows = table(page)
    figure, [axes] = panels(height=1.6 + 0.4 * len(rows))
    places = np.arange(len(rows))[::-1]
    looks = {'color': GREY, 'hatch': '//'}, {'color': BLUE}
    for column, (title, look) in enumerate(zip(titles, looks, strict=True), 1):
        axes.barh(places + 0.6 - 0.4 * column, first(row[column] for row in rows), 0.36,
                  edgecolor='white', label=title, **look)
    axes.set_axisbelow(True)
    axes.set_yticks(places, [row[0] for row in rows])
    label(axes, axis, '', loc='lower center', ncols=2, bbox_to_anchor=(0.5, 1.0))
    return figure
