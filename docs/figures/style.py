# SPDX-License-Identifier: Apache-2.0
"""The common style of all figures: readable in print, in grey and by the colour-blind."""

import pathlib

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator

from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.simulation.simulation import Simulation

IMAGES = pathlib.Path(__file__).resolve().parent.parent / 'images'

# Okabe and Ito's colours (https://jfly.uni-koeln.de/color/); line styles tell the lines apart
# without colour
BLUE, ORANGE, GREEN, BLACK, GREY = '#0072B2', '#D55E00', '#009E73', '#000000', '#777777'
LINES = ({'color': BLUE}, {'color': ORANGE, 'linestyle': '--'},
         {'color': GREEN, 'linestyle': '-.'}, {'color': BLACK, 'linestyle': ':'})
THEORY = {'color': GREY, 'linewidth': 1.0}
WRONG = {'color': ORANGE, 'linestyle': '--', 'linewidth': 1.2}
MEASURED = {'color': BLUE, 'marker': 'o', 'markersize': 4, 'linestyle': ''}


def panels(count=1, height=3.2, **options):
    """Return a figure and its axes side by side, an array."""
    figure = Figure(figsize=(8.0, height), dpi=100, layout='constrained')
    FigureCanvasAgg(figure)
    axes = figure.subplots(1, count, squeeze=False, **options)[0]
    for one in axes:
        one.grid(color='#dddddd', linewidth=0.5)
        one.spines[['top', 'right']].set_visible(False)
    return figure, axes


def label(axes, x, y, legend=True, **options):
    """Name the axes, and add a legend of the lines that have names."""
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    if legend:
        axes.legend(**{'frameon': False, 'fontsize': 9, 'handlelength': 2.5} | options)


def plain_ticks(axis, ticks):
    """Give a logarithmic axis (``axes.xaxis`` or ``axes.yaxis``) ticks in plain numbers."""
    axis.set_major_locator(FixedLocator(ticks))
    axis.set_major_formatter('{x:g}')
    axis.set_minor_locator(NullLocator())


def run(name, *overrides, method='auto'):
    """Return the Simulation of a scene that ships, with changes."""
    return Simulation(load_scene(name, overrides), method)


def save(figure, name):
    """Write docs/images/<name>.png."""
    IMAGES.mkdir(exist_ok=True)
    figure.savefig(IMAGES / f'{name}.png', metadata={'Software': None})
