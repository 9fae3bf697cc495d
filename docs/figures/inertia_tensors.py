# SPDX-License-Identifier: Apache-2.0
"""Moments of the shapes by the notes, by quadrature and by a blow."""

from figures.style import BLUE, GREY, ORANGE, label, panels
from rigid_body_sim.study.scenes.confirm import confirm_shapes


def draw():
    """Return the figure."""
    rows = [row for row in confirm_shapes()
            if len(row['blow'].predicted.shape
                   if hasattr(row['blow'].predicted, 'shape') else ()) == 1]
    figure, (axes,) = panels(height=3.4)
    for place, row in enumerate(rows):
        for k, name in enumerate('123'):
            x = place + 0.24 * (k - 1)
            axes.bar(x, row['blow'].predicted[k], 0.2, color='#dddddd', edgecolor=GREY,
                     label='the notes' if not place + k else None)
            axes.plot(x, row['quadrature'].measured[k], '+', color=BLUE, markersize=10,
                      label='quadrature' if not place + k else None)
            axes.plot(x, row['blow'].measured[k], '.', color=ORANGE, markersize=6,
                      label='blow: J/ω' if not place + k else None)
            axes.annotate(name, (x, 0.0), xytext=(0, -9), textcoords='offset points',
                          ha='center', fontsize=7, color=GREY)
    names = [row['blow'].name.split(',')[0].replace(' about its ', ' ').replace(' ', '\n')
             for row in rows]
    axes.set_xticks(range(len(rows)), names, fontsize=8)
    axes.tick_params(axis='x', length=0, pad=12)
    label(axes, '', 'I$_1$, I$_2$, I$_3$ (kg m²)')
    return figure
