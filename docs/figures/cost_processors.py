# SPDX-License-Identifier: Apache-2.0
"""Times with AVX2 over those with AVX-512, for each row of the table."""

from figures.page_tables import table
from figures.style import BLACK, BLUE, label, panels


def draw():
    """Return the figure."""
    rows, names = table('methods/another_processor'), ['']
    for title, *_ in rows:    # some rows go on with what a row above says
        if title.startswith('to '):
            title = names[-1].replace('to 1e-6', title)
        elif title.startswith(('from ', 'a state')):
            title = f'{names[-1].partition(":")[0]}: {title}'
        names.append(title)
    figure, [axes] = panels(height=4.6)
    places = range(len(rows) - 1, -1, -1)
    axes.hlines(places, 1.0, [float(row[-1]) for row in rows], color=BLUE, linewidth=2.0)
    axes.plot([float(row[-1]) for row in rows], places, color=BLUE, marker='o', linestyle='')
    axes.axvline(1.0, color=BLACK, linewidth=0.8)
    axes.set_yticks(places, names[1:], fontsize=8)
    label(axes, 'time with AVX2 over that with AVX-512', '', legend=False)
    return figure
