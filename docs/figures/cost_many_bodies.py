# SPDX-License-Identifier: Apache-2.0
"""Bodies for each CPU second over those of heyoka, on a processor with AVX-512 and without."""

from figures.marks import MARKS, name
from figures.page_tables import numbers, table
from figures.style import BLACK, label, panels

GOAL = 2.0
PLACES = {'AVX-512 (Zen 5)': 1, 'AVX2 (Zen 3)': 2}    # which table of the page


def draw():
    """Return the figure."""
    figure, both = panels(2, height=3.6, sharey=True, sharex=True)
    for axes, (processor, place) in zip(both, PLACES.items(), strict=True):
        rows = table('methods/many_bodies', place)
        for row, (_, *cells) in enumerate(reversed(rows)):
            for cell, mark in zip(cells, MARKS.values(), strict=True):
                ours, *theirs = numbers(cell)
                if theirs:    # else heyoka does not reach it
                    axes.plot(ours / theirs[0], row, **mark)
        axes.axvline(1.0, color=BLACK, linewidth=0.8)
        axes.axvline(GOAL, color=BLACK, linewidth=0.8, linestyle='--')
        axes.set(title=processor, xlim=(0.0, None))
        axes.set_yticks(range(len(rows)), [row[0] for row in reversed(rows)])
        label(axes, 'bodies over those of heyoka', '', legend=False)
    for accuracy, mark in MARKS.items():
        both[0].plot([], [], label=name(accuracy), **mark)
    figure.legend(loc='outside lower center', ncols=4, frameon=False, fontsize=9)
    return figure
