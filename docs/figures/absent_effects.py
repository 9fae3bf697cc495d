# SPDX-License-Identifier: Apache-2.0
"""Instructions of a step with all effects known, and with the listed ones known."""

import numpy as np

from figures.page_tables import first, table
from figures.style import BLUE, GREY, label, panels


def draw():
    """Return the figure."""
    rows = table('methods/absent_effects')
    figure, [axes] = panels(height=2.8)
    places = np.arange(len(rows))[::-1]
    for shift, place, title, bar in ((0.2, 1, 'all effects known', {'color': GREY, 'hatch': '//'}),
                                     (-0.2, 2, 'listed ones known', {'color': BLUE})):
        axes.barh(places + shift, first(row[place] for row in rows), 0.36, edgecolor='white',
                  label=title, **bar)
    axes.set_axisbelow(True)
    axes.set_yticks(places, [row[0] for row in rows])
    label(axes, 'instructions of a step of dop8', '', loc='lower center', ncols=2,
          bbox_to_anchor=(0.5, 1.0))
    return figure
