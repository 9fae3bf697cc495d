# SPDX-License-Identifier: Apache-2.0
"""Time of taylor over that of heyoka at four accuracies, for each run of the table."""

import math

from figures.page_tables import ACCURACIES, groups, numbers, table
from figures.style import BLACK, BLUE, GREEN, ORANGE, label, panels

GOALS = 0.25, 0.33, 0.4, 0.4
NAMES = {'asymmetric top': 'asymmetric tops', 'driven body': 'driven bodies'}
KINDS = {'asymmetric top': {'color': BLUE, 'marker': 'o'},
         'driven body': {'color': ORANGE, 'marker': 's', 'linestyle': '--'},
         'driven in world axes': {'color': GREEN, 'marker': '^', 'linestyle': '-.'}}


def draw():
    """Return the figure."""
    figure, [axes] = panels()
    named = set()
    for title, methods in groups(table('methods/smooth')).items():
        kind = next(one for one in KINDS if title.startswith(one))
        ratios = [found[1] if len(found := numbers(cell)) == 2 else math.nan
                  for cell in methods['taylor']]
        axes.plot(ACCURACIES, ratios, linewidth=0.8, markersize=4, **KINDS[kind],
                  label=None if kind in named else NAMES.get(kind, kind))
        named.add(kind)
    axes.plot(ACCURACIES, GOALS, color=BLACK, marker='x', linestyle='', label='goal')
    axes.axhline(1.0, color=BLACK, linewidth=0.8)
    axes.annotate('heyoka', (ACCURACIES[0], 1.0), xytext=(0, 3), textcoords='offset points')
    axes.set(xscale='log', ylim=(0.0, 1.1))
    axes.invert_xaxis()
    axes.set_xticks(ACCURACIES)
    axes.minorticks_off()
    label(axes, 'error of the attitude (rad)', 'time over that of heyoka', ncols=4,
          loc='upper right', bbox_to_anchor=(1.0, 0.92))
    return figure
