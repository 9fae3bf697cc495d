"""The figure of a resimulation that differs: by how much, over time."""

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from rigid_body_sim.analysis.overview import STYLES

LABELS = {'orientation': 'attitude (rad)', 'angular_velocity': 'angular velocity (rad/s)', 'position': 'position (m)', 'energy': 'energy (J)',
          'angular_momentum_squared': 'L² ((kg m²/s)²)'}
SMALLEST = 1e-18


def draw(comparison, found):
    """Return the Figure of a Comparison and its verdict."""
    names = [name for name, worst in comparison.largest.items() if worst['difference'] > 0.0]
    figure = Figure(figsize=(10, 1.9 * len(names) + 1.0), dpi=110, layout='constrained')
    FigureCanvasAgg(figure)
    recorded, now = (f'{one["method"]} ({one["accuracy"]:g})' for one in (found['recorded'], found['resimulated']))
    figure.suptitle(f'Recorded by {recorded}, run again by {now}: differences', x=0.01, ha='left', fontsize=12, fontweight='bold')
    for axes, name in zip(np.atleast_1d(figure.subplots(len(names), 1, sharex=True)), names, strict=True):
        times, sizes = comparison.curve(name)
        axes.plot(times, np.maximum(sizes, SMALLEST), linewidth=0.9, **STYLES[0])
        axes.set_yscale('log')
        axes.set_ylabel(LABELS[name], fontsize=8)
        axes.grid(color='#dddddd', linewidth=0.5)
        axes.spines[['top', 'right']].set_visible(False)
        axes.margins(x=0.0)
    figure.supxlabel('time since the first tick (s)', fontsize=10)
    return figure
