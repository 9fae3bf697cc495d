# SPDX-License-Identifier: Apache-2.0
"""Bodies for each CPU second over those of heyoka, on a processor with AVX-512 and without."""

from figures.marks import dots, key
from figures.page_tables import numbers, table
from figures.style import BLACK, label, panels

GOAL = 2.0
PLACES = {'AVX-512 (Zen 5)': 1, 'AVX2 (Zen 3)': 2}    # which table of the page


def draw():
    """Return the figure."""
    figure, both = panels(2, height=3.6, sharey=True, sharex=True)
    for axes, (processor, place) in zip(both, PLACES.items(), strict=True):
        dots(axes, {name: [_ratio(*numbers(cell)) for cell in cells]
                    for name, *cells in table('methods/many_bodies', place)})
        axes.axvline(GOAL, color=BLACK, linewidth=0.8, linestyle='--')
        axes.set(title=processor, xlim=(0.0, None))
        label(axes, 'bodies over those of heyoka', '', legend=False)
    key(figure)
    return figure


def _ratio(ours, theirs=None):
    """Return ours over theirs; None where heyoka does not reach the accuracy."""
    return theirs and ours / theirs
