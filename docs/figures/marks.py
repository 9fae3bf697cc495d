# SPDX-License-Identifier: Apache-2.0
"""Marks that tell accuracies apart, with and without colour."""

from figures.page_tables import ACCURACIES
from figures.style import BLACK, BLUE, GREEN, ORANGE

MARKS = {accuracy: {'color': colour, 'marker': marker, 'linestyle': '', 'markersize': 5}
         for accuracy, colour, marker in zip(ACCURACIES, (ORANGE, GREEN, BLUE, BLACK), 'o^sx',
                                             strict=True)}


def name(accuracy):
    """Return how an accuracy is written on the pages: ``1e-3 rad``."""
    return f'{accuracy:.0e} rad'.replace('e-0', 'e-')
