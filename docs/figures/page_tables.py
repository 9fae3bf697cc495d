# SPDX-License-Identifier: Apache-2.0
"""What the tables of a page say, for the figures that draw them."""

import pathlib
import re

DOCS = pathlib.Path(__file__).resolve().parent.parent
ACCURACIES = 1e-3, 1e-6, 1e-9, 1e-12
NUMBER = re.compile(r'\d+\.?\d*(?:e[-+]?\d+)?')


def table(page, place=0):
    """Return the rows of a table of a page (``methods/smooth``): lists of cells, no head."""
    text = (DOCS / f'{page}.md').read_text()
    found = re.findall(r'(?:^\|.*\n)+', text, re.MULTILINE)[place]
    return [[cell.strip() for cell in line.strip().strip('|').split('|')]
            for line in found.splitlines()[2:]]


def groups(rows):
    """Return {first cell: {second cell: the others}}; an empty first cell means that above."""
    found, title = {}, None
    for first, second, *others in rows:
        title = first or title
        found.setdefault(title, {})[second] = others
    return found


def numbers(cell):
    """Return the numbers of a cell: ``82 (0.43)`` is [82.0, 0.43]."""
    return [float(number) for number in NUMBER.findall(cell)]


def first(cells):
    """Return the first number of each cell; NaN where there is none."""
    return [next(iter(numbers(cell)), float('nan')) for cell in cells]
