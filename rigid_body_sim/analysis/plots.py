# SPDX-License-Identifier: Apache-2.0
"""Figures for print: readable in black and white and by the colour-blind."""

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

# Okabe and Ito's colours (https://jfly.uni-koeln.de/color/), which also differ in lightness; line
# styles tell them apart without colour
COLORS = ('#0072B2', '#D55E00', '#009E73', '#CC79A7')
DASHES = ('-', '--', '-.', ':')
SHADE = '#fbe8c0'
GREY, BLACK = '#777777', '#000000'
MARKS = {
    'event': ('v', BLACK),
    'commands': ('|', COLORS[1]),
    'reset': ('D', COLORS[1]),
    'parameters': ('s', COLORS[0]),
    'gap': ('x', BLACK),
}
MOST_MARKS = 500    # most marks of a kind
LEGEND = {
    'loc': 'center left',
    'bbox_to_anchor': (1.0, 0.5),
    'frameon': False,
    'handlelength': 2.5,
}
MARGIN = 0.05    # about a path in space, share of its largest extent
# a residual up to this many times the band is about round-off, and the band is labelled
ROUND_OFF = 20


def stack(panels, title, source):
    """Return a Figure of Panels over time, one above the other, with the marks of a Source."""
    figure = _figure(2.1 * len(panels) + 0.9, title)
    axes = np.atleast_1d(figure.subplots(len(panels), 1, sharex=True))
    for one, panel in zip(axes, panels, strict=True):
        _draw(one, panel)
    _marks(axes[0], source)
    axes[-1].set_xlabel('time since the first tick (s)')
    figure.align_ylabels()
    return figure


def spectra(spectrum, title):
    """Return a Figure of a Spectrum, predicted lines marked."""
    figure = _figure(5.5, title)
    axes = figure.subplots(2, 1, sharex=True)
    for one, name in zip(axes, spectrum.amplitudes, strict=True):
        for k, component in enumerate('xyz'):
            one.plot(
                spectrum.frequencies[1:],
                spectrum.seen(name)[:, k],
                linewidth=0.9,
                color=COLORS[k],
                linestyle=DASHES[k],
                label=component,
            )
        one.set_yscale('log')
        one.set_ylabel(f'ω, {name} axes\n(rad/s)')
        for line, _ in spectrum.lines:
            if line.axes == name:
                one.axvline(line.frequency, color=GREY, linewidth=0.8, linestyle=':')
                one.annotate(
                    line.name,
                    (line.frequency, 1.0),
                    xycoords=('data', 'axes fraction'),
                    xytext=(2, -9),
                    textcoords='offset points',
                    fontsize=8,
                    color=BLACK,
                )
        _finish(one)
    axes[-1].set_xlim(0.0, spectrum.top)
    axes[-1].set_xlabel(
        f'frequency (Hz); from the first {spectrum.seconds:.6g} s, Hann window; dotted: predicted'
    )
    figure.align_ylabels()
    return figure


def space(one):
    """Return a Figure of a space.Space; the path goes from dark to light with time."""
    figure = _figure(8.0, one.title)
    axes = figure.add_subplot(projection='3d')
    for (name, net), color in zip(one.surfaces.items(), (GREY, COLORS[1]), strict=False):
        axes.plot_wireframe(
            *np.moveaxis(net, 2, 0), rstride=2, cstride=3, linewidth=0.35, color=color, label=name
        )
    # as points, since a path may be interrupted anywhere
    points = axes.scatter(*one.path.T, c=one.times, cmap='viridis', s=3.0, depthshade=False)
    for set_label, label in zip(
        (axes.set_xlabel, axes.set_ylabel, axes.set_zlabel), one.axes, strict=True
    ):
        set_label(label)
    # said here: margins that matplotlib chooses differ between its versions
    shown = np.concatenate([one.path, *(net.reshape(-1, 3) for net in one.surfaces.values())])
    shown = shown[np.isfinite(shown).all(axis=1)]
    if len(shown):
        least, most = shown.min(axis=0), shown.max(axis=0)
        margin = MARGIN * (np.max(most - least) or 1.0)
        axes.set(**{f'{name}lim': bounds for name, bounds in zip(
            'xyz', zip(least - margin, most + margin, strict=True), strict=True)})
    axes.set_aspect('equal')
    figure.colorbar(points, ax=axes, shrink=0.6, label='time since the first tick (s)')
    if one.surfaces:
        axes.legend(loc='upper left', frameon=False, fontsize=9)
    return figure


def _figure(height, title):
    figure = Figure(figsize=(10, height), dpi=110, layout='constrained')
    FigureCanvasAgg(figure)
    figure.suptitle(title, x=0.01, ha='left', fontsize=12, fontweight='bold')
    return figure


def _draw(axes, panel):
    if panel.band:
        axes.axhspan(-panel.band, panel.band, color='#e8e8e8', linewidth=0)
    for name, begin, end in panel.spans:
        axes.axvspan(begin, end, color=SHADE, linewidth=0)
        _note(axes, name, (begin, 1.0), ('data', 'axes fraction'), (3, -10))
    for k, line in enumerate(panel.lines):
        axes.plot(
            line.x,
            line.y,
            linewidth=0.7 if panel.band else 1.1,
            color=COLORS[k],
            linestyle=DASHES[k],
            label=line.name,
            drawstyle='steps-post' if panel.steps else 'default',
            marker='.' if len(line.x) < 100 else '',
            markersize=3,
        )
    axes.set_ylabel(panel.label)
    largest = max(
        (float(np.nanmax(np.abs(line.y))) for line in panel.lines if len(line.y)), default=0.0
    )
    if panel.log:
        axes.set_yscale('log')
    if panel.limits:
        axes.set_ylim(*panel.limits)
    if panel.band:
        limit = max(1.3 * largest, 1.5 * panel.band)
        axes.set_ylim(-limit, limit)
        if limit < ROUND_OFF * panel.band and len(panel.lines) == 1:
            _note(axes, 'round-off: 4 ulp', (1.0, panel.band), ('axes fraction', 'data'), (4, 0),
                  va='center', color=GREY, annotation_clip=False)
    _finish(axes, len(panel.lines) > 1)


def _note(axes, text, place, coordinates, offset, **style):
    """Write a word beside a place, `offset` in points."""
    axes.annotate(text, place, xycoords=coordinates, xytext=offset, textcoords='offset points',
                  fontsize=8, **style)


def _finish(axes, legend=True):
    if legend:
        axes.legend(**LEGEND)
    axes.grid(color='#dddddd', linewidth=0.5)
    axes.spines[['top', 'right']].set_visible(False)
    axes.margins(x=0.0)


def _marks(axes, source):
    """Mark events and commands above the axes."""
    top = 1.04
    for kind, (marker, color) in MARKS.items():
        times = (
            np.array([mark.stamp for mark in source.history.marks if mark.kind == kind])[
                :MOST_MARKS
            ]
            - source.start
        ) * 1e-9
        if len(times):
            axes.plot(
                times,
                np.full(len(times), top),
                marker,
                color=color,
                markersize=5,
                transform=axes.get_xaxis_transform(),
                clip_on=False,
            )
            axes.annotate(
                kind,
                (1.0, top),
                xycoords='axes fraction',
                xytext=(6, 0),
                textcoords='offset points',
                va='center',
                fontsize=8,
                color=color,
                annotation_clip=False,
            )
            top += 0.09
