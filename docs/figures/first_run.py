# SPDX-License-Identifier: Apache-2.0
"""CPU time of first runs: machine code for every kernel, or for those that Python calls."""

import numpy as np

from figures.page_tables import first, table
from figures.style import BLUE, GREY, label, panels


def draw():
    """Return the figure."""
    rows = table('methods/first_run')
    figure, [axes] = panels(height=3.2)
    places = np.arange(len(rows))[::-1]
    for shift, place, title, bar in (
            (0.2, 1, 'each kernel with machine code', {'color': GREY, 'hatch': '//'}),
            (-0.2, 2, 'only those that Python calls', {'color': BLUE})):
        axes.barh(places + shift, first(row[place] for row in rows), 0.36, edgecolor='white',
                  label=title, **bar)
    axes.set_axisbelow(True)
    axes.set_yticks(places, [row[0] for row in rows])
    label(axes, 'CPU time of a first run of 1 s (s)', '')
    return figure
