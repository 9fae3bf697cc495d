"""The overview figure: angular velocity, residuals and lateness over time, readable in print and by the colour-blind."""

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from rigid_body_sim.analysis.drift import FLOOR

# Okabe and Ito's colours (https://jfly.uni-koeln.de/color/), which also differ in lightness; line styles tell them apart without colour
BLUE, ORANGE, GREEN, BLACK, GREY = '#0072B2', '#D55E00', '#009E73', '#000000', '#777777'
STYLES = ({'color': BLUE, 'linestyle': '-'}, {'color': ORANGE, 'linestyle': '--'}, {'color': GREEN, 'linestyle': '-.'})
MARKS = {'event': ('v', BLACK), 'commands': ('|', ORANGE), 'reset': ('D', ORANGE), 'parameters': ('s', BLUE), 'gap': ('x', BLACK)}
LEGEND = {'loc': 'center left', 'bbox_to_anchor': (1.0, 0.5), 'frameon': False, 'handlelength': 2.5}
MOST_MARKS = 500    # of each kind


def draw(measured, title):
    """Return the Figure of a Measured."""
    source = measured.source
    late = measured.punctuality.curve()
    rows = 4 if len(late) else 3
    figure = Figure(figsize=(10, 2.1 * rows + 0.9), dpi=110, layout='constrained')
    FigureCanvasAgg(figure)
    axes = figure.subplots(rows, 1, sharex=True)
    figure.suptitle(title, x=0.01, ha='left', fontsize=12, fontweight='bold')
    _angular_velocity(axes[0], measured)
    _residual(axes[1], measured.energy, source, 'energy', 'J')
    _residual(axes[2], measured.momentum, source, 'L²', '(kg m²/s)²')
    if len(late):
        _lateness(axes[3], late, source.start)
    _marks(axes[0], source)
    for one in axes:
        one.grid(color='#dddddd', linewidth=0.5)
        one.spines[['top', 'right']].set_visible(False)
        one.margins(x=0.0)
    axes[-1].set_xlabel('time since the first tick (s)')
    figure.align_ylabels()
    return figure


def _angular_velocity(axes, measured):
    gaps = [mark.stamp for mark in measured.source.history.marks if mark.kind == 'gap']
    for k, (name, style) in enumerate(zip('xyz', STYLES, strict=True)):
        times, values = _broken(*measured.angular_velocity.curve(k), gaps, measured.source.start)
        axes.plot(times, values, linewidth=1.1, label=f'ω$_{name}$', **style)
    axes.set_ylabel('ω, body axes\n(rad/s)')
    axes.legend(**LEGEND)


def _broken(times, values, stamps, start):
    """Return a curve that is interrupted after some stamps (ns)."""
    places = np.searchsorted(times, (np.array(stamps, dtype=float) - start) * 1e-9, side='right')
    return np.insert(times, places, np.nan), np.insert(values, places, np.nan)


def _residual(axes, residual, source, name, unit):
    """Draw the residual of what is kept, or else the quantity itself."""
    times, values = residual.curve()
    if not len(times):
        times, values = residual.values.curve()
        axes.plot(times, values, linewidth=1.1, color=BLUE)
        axes.set_ylabel(f'{name} ({unit})')
        return
    largest = max(1.3 * np.abs(values).max(), 1.5 * FLOOR)
    times, values = _broken(times, values, residual.not_kept_from, source.start)
    axes.axhspan(-FLOOR, FLOOR, color='#e8e8e8', linewidth=0)
    axes.plot(times, values, linewidth=0.6, color=BLUE, marker='.' if len(times) < 200 else '', markersize=3)
    axes.set_ylim(-largest, largest)
    axes.set_ylabel(f'residual of {name}\n(relative)')
    if largest < 20 * FLOOR:
        axes.annotate('round-off: 4 ulp', (1.0, FLOOR), xycoords=('axes fraction', 'data'), xytext=(4, 0), textcoords='offset points',
                      va='center', fontsize=8, color=GREY, annotation_clip=False)


def _lateness(axes, late, start):
    edges = np.append(late[:, 0], late[-1, 1])
    for column, name, style in ((4, 'max', STYLES[1]), (3, 'p99', STYLES[0]), (2, 'p50', {'color': GREEN, 'linestyle': '-'})):
        # what is less than a microsecond is noise of the clock
        values = np.maximum(np.append(late[:, column], late[-1, column]) * 1e-3, 1.0)
        axes.plot((edges - start) * 1e-9, values, linewidth=1.1, label=name, drawstyle='steps-post', **style)
    axes.set_yscale('log')
    axes.set_ylim(1.0, max(1e3, 2e-3 * late[:, 4].max()))
    axes.set_ylabel('lateness of ticks,\nby seconds (µs)')
    axes.legend(**LEGEND)


def _marks(axes, source):
    """Mark events and commands above the axes."""
    top = 1.04
    for kind, (marker, color) in MARKS.items():
        times = (np.array([mark.stamp for mark in source.history.marks if mark.kind == kind])[:MOST_MARKS] - source.start) * 1e-9
        if len(times):
            axes.plot(times, np.full(len(times), top), marker, color=color, markersize=5, transform=axes.get_xaxis_transform(), clip_on=False)
            axes.annotate(kind, (1.0, top), xycoords='axes fraction', xytext=(6, 0), textcoords='offset points', va='center', fontsize=8,
                          color=color, annotation_clip=False)
            top += 0.09
