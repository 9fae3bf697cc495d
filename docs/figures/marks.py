# SPDX-License-Identifier: Apache-2.0
"""Ratios as dots, a row for each scene and a mark for each accuracy, with and without colour."""

from figures.page_tables import ACCURACIES
from figures.style import BLACK, BLUE, GREEN, ORANGE

MARKS = {accuracy: {'color': colour, 'marker': marker, 'linestyle': '', 'markersize': 5}
         for accuracy, colour, marker in zip(ACCURACIES, (ORANGE, GREEN, BLUE, BLACK), 'o^sx',
                                             strict=True)}


def dots(axes, ratios):
    """Draw {name: a ratio for each accuracy, None where there is none} from the top down."""
    for row, of in enumerate(reversed(ratios.values())):
        for ratio, mark in zip(of, MARKS.values(), strict=True):
            if ratio is not None:
                axes.plot(ratio, row, **mark)
    axes.axvline(1.0, color=BLACK, linewidth=0.8)
    axes.set_yticks(range(len(ratios)), list(reversed(ratios)))


def key(figure):
    """Say below a figure which mark is which accuracy."""
    for accuracy, mark in MARKS.items():
        figure.axes[0].plot([], [], label=f'{accuracy:.0e} rad'.replace('e-0', 'e-'), **mark)
    figure.legend(loc='outside lower center', ncols=4, frameon=False, fontsize=9)
