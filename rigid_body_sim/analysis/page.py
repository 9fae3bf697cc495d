# SPDX-License-Identifier: Apache-2.0
"""report.html: the report to look at, in one file that works without a network.

The verdict comes first, then the moving body, then the curves that matter; the rest is folded.
Plotly and the numbers are embedded compressed, and a figure is drawn once it is scrolled to.
"""

import base64
import gzip
import html
import importlib.util
import json
import pathlib

import numpy as np

from rigid_body_sim.analysis import panels
from rigid_body_sim.analysis.drift import FLOOR
from rigid_body_sim.analysis.moving import ARROWS, TRACE, moving
from rigid_body_sim.analysis.space import spaces
from rigid_body_sim.analysis.summary import counted, lines, title

COLORS = ('#0072B2', '#D55E00', '#009E73', '#CC79A7')
DASHES = ('solid', 'dash', 'dashdot', 'dot')
MARK = '#7C5CD6'    # of what happened: legible on light and on dark ground
FLAT, AROUND = 1e-6, 0.2    # share of its size by which a flat curve changes, and is shown in
MOST_MARKS = 500
MOST_POINTS = 3000
"""Points of a curve; of a longer one each stretch shows its extremes."""
PANEL_HEIGHT, SPACE_HEIGHT = 170, 560    # px
CAUSES = {'strike': 'strikes', 'reset': 'resets', 'parameters': 'changes of parameters'}
HERE = pathlib.Path(__file__).parent
SPEEDS = {'0.01': '1/100', '0.1': '1/10', '1': 'real time', '10': '10 x', '100': '100 x'}


def available():
    """Return whether Plotly is installed."""
    return importlib.util.find_spec('plotly') is not None


def write_page(path, bodies):
    """Write the page.

    Parameters
    ----------
    path : pathlib.Path
    bodies : list of (name of the recording, Measured, summary, Spectrum or None, ledger or None)
    """
    from plotly.offline import get_plotlyjs
    packed = {'figures': {}, 'bodies': {}}
    sections = [line for number, body in enumerate(bodies)
                for line in _section(number, packed, *body)]
    heading = ', '.join(title(found) for _, _, found, _, _ in bodies)
    parts = ['<!DOCTYPE html><html lang="en"><head><meta charset="utf-8">',
             '<meta name="viewport" content="width=device-width">',
             f'<title>{html.escape(heading)}</title>',
             f'<style>{(HERE / "page.css").read_text()}</style></head><body>', *sections,
             _carried('data', json.dumps(packed, separators=(',', ':'))),
             _carried('plotly', get_plotlyjs()),
             *(f'<script>{(HERE / name).read_text()}</script>'
               for name in ('body.js', 'player.js', 'page.js')),
             '</body></html>']
    path.write_text('\n'.join(parts), encoding='utf-8')


def _carried(name, text):
    """Return the HTML element that passes a text to page.js."""
    packed = base64.b64encode(gzip.compress(text.encode(), 9, mtime=0)).decode()
    return f'<script type="application/gzip" id="{name}">{packed}</script>'


def _section(number, packed, name, measured, found, spectrum, balance):
    """Yield the HTML of one body; what its scripts need goes into `packed`."""
    figures = packed['figures']
    yield f'<h1>{html.escape(title(found))}</h1><p>{html.escape(_subtitle(name, measured))}</p>'
    yield _verdict(found, balance)
    moves = moving(measured)
    if moves:
        packed['bodies'][number] = moves.data()
        yield f'<h2>{html.escape(heading_of(moves))}</h2>{player(number, moves)}'
    kept = [panel for panel in panels.overview(measured) if panel.name != 'lateness']
    first = [*kept[:1], *panels.travel(measured), *kept[1:]]
    yield ('<h2>Over time</h2><p>Move the mouse over the curves: the body follows. Drag to zoom, '
           'double-click to see all.</p>')
    figures[f'time{number}'] = _plain(_over_time(first, measured.source))
    yield _figure(f'time{number}', PANEL_HEIGHT * (len(first) + 1))
    more = [*panels.motion(measured), *(panels.energies(balance) if balance else ()),
            *filter(None, [panels.lateness(measured)])]
    yield _folded('More curves: world axes, Euler angles, the ledger, lateness',
                  _drawn(figures, f'more{number}', _over_time(more, measured.source),
                         PANEL_HEIGHT * (len(more) + 1)))
    for space in spaces(measured):
        yield _folded(space.title, _drawn(figures, f'{space.name}{number}', _in_space(space)))
    if spectrum and spectrum.amplitudes:
        table = _table(('line', 'axes', 'predicted (Hz)', 'measured (Hz)', 'source'),
                       [(line.name, line.axes, f'{line.frequency:.9g}',
                         '-' if seen is None else f'{seen:.9g}', line.source)
                        for line, seen in spectrum.lines])
        yield _folded(
            f'Spectrum of ω in the first {spectrum.seconds:.6g} s, predicted lines dotted',
            _drawn(figures, f'spectrum{number}', _spectra(spectrum)) + table,
        )
    yield _folded('All numbers', f'<pre>{html.escape(chr(10).join(lines(found)))}</pre>')
    marks = measured.source.history.marks
    rows = [(f'{(mark.stamp - measured.source.start) * 1e-9:.9g}', mark.kind, mark.name,
             ', '.join(f'{key} {value}' for key, value in mark.values.items()))
            for mark in marks[:MOST_MARKS]]
    yield _folded(f'What happened ({len(marks)})',
                  _table(('time (s)', 'kind', 'what', 'values'), rows))
    if measured.source.scene:
        yield _folded('Scene', f'<pre>{html.escape(measured.source.scene.text)}</pre>')


def _subtitle(name, measured):
    """Return the name of a recording, where its scene has another one, and what the scene says."""
    scene = measured.source.scene
    if scene is None or not scene.about:
        return name
    return scene.about if name == scene.name else f'{name}: {scene.about}'


def _verdict(found, balance):
    """Return the HTML of the verdict, in a sentence or two."""
    names = {'energy': 'energy', 'angular_momentum_squared': 'L²'}
    kept = {name: found[key]['largest_residual'] for key, name in names.items()
            if found[key]['largest_residual'] is not None}
    worst = max(kept.values(), default=0.0)
    accuracy = max((found['run'] or {}).get('accuracy') or 0.0, FLOOR)
    lost = found['timing']['missing'] - found['left_out_by_recorder']
    good = worst <= 10.0 * accuracy and not lost and not found['accuracy_missed']
    if kept:
        what = ' and '.join(f'{name} to {size:.1e}' for name, size in kept.items())
        floor = ', which is round-off' if worst <= FLOOR else ''
        said = f'{what} (relative{floor})'
        parts = max(found[key]['stretches'] for key in names)
        within = f' within each of {parts} stretches' if parts > 1 else ''
        text = f'<b>{"Kept" if worst <= 10.0 * accuracy else "Not kept"}{within}:</b> {said}.'
        if parts > 1:
            text += ' ' + _between(found)
    else:
        text = 'Energy and L² need not be constant in this scene.'
        if balance:
            residual = float(np.nanmax(np.abs(balance[1]['energy_residual'])))
            text += f' The ledger balances energy to {residual:.1e} (relative).'
    text += ''.join(f' <b>Note:</b> {html.escape(line)}.' for line in found['accuracy_missed'])
    ticks = found['timing']['ticks']
    text += f' {ticks} ticks, {lost if lost else "none"} lost.'
    seen = [one for one in found['lines'] if one['measured'] is not None]
    if seen:
        off = max(abs(one['measured'] / one['predicted'] - 1.0) for one in seen)
        text += (f' {len(seen)} predicted frequenc{"y was" if len(seen) == 1 else "ies were"} '
                 f'measured, within {off:.1e}.')
    counts = [f'{count} x {html.escape(name)}' for name, count in found['events'].items()]
    counts += [f'{found["strikes"]} x strike'] if found['strikes'] else []
    counts += [counted(found['commands'], 'tick', ' with commands')] if found['commands'] else []
    text += f' {", ".join(counts)}.' if counts else ''
    return f'<p class="verdict{"" if good else " bad"}">{text}</p>'


def _between(found):
    """Return the sentence on what changed the energy between the stretches in which it is kept."""
    levels = found['energy']['levels'] or found['angular_momentum_squared']['levels']
    causes = sorted({level['begun_by'] for level in levels[1:]} - {''})
    names = [CAUSES.get(cause, cause) for cause in causes]
    return f'It is changed by {" and ".join(names)} between them.' if names else ''


def heading_of(moves):
    """Return a line that says which part of a Moving is shown."""
    return f'The body from {moves.times[0]:.6g} to {moves.times[-1]:.6g} s: {moves.drawing.about}'


def player(number, moves):
    """Return the HTML of a moving body, which body.js and player.js fill."""
    legend = {**ARROWS, 'trace of an axis': TRACE}
    shown = ''.join(
        f'<span><i style="background:rgb({",".join(str(int(255 * c)) for c in color)})">'
        f'</i>{html.escape(name)}</span>' for name, color in legend.items())
    speeds = ''.join(
        f'<option value="{value}"{" selected" if value == "1" else ""}>{name}</option>'
        for value, name in SPEEDS.items())
    return (f'<canvas class="body" id="body{number}"></canvas>'
            f'<p class="playback" id="controls{number}"><button>play</button> '
            '<input type="range" aria-label="time" min="0" '
            f'max="{len(moves.times) - 1}" value="0"> '
            f'<select aria-label="speed">{speeds}</select> <output></output></p>'
            f'<p class="legend">{shown}</p>')


def _folded(heading, content):
    return f'<details><summary>{html.escape(heading)}</summary>{content}</details>'


def _drawn(figures, name, figure, height=SPACE_HEIGHT):
    figures[name] = _plain(figure)
    return _figure(name, height)


def _figure(name, height):
    return f'<div class="figure" id="{name}" style="min-height:{height}px"></div>'


def _plain(figure):
    """Return a figure as plain data."""
    return json.loads(figure.to_json())


def _table(heads, rows):
    if not rows:
        return ''
    cells = [''.join(f'<td>{html.escape(str(cell))}</td>' for cell in row) for row in rows]
    head = ''.join(f'<th>{html.escape(cell)}</th>' for cell in heads)
    return f'<table><tr>{head}</tr>{"".join(f"<tr>{row}</tr>" for row in cells)}</table>'


def _layout(figure, height, **more):
    figure.update_layout(height=height, margin={'l': 80, 'r': 90, 't': 20, 'b': 50},
                         template='none', **more)
    return figure


def thinned(x, y):
    """Return a curve of at most MOST_POINTS points: the least and largest of each stretch."""
    if len(x) <= MOST_POINTS:
        return x, y
    stretch = -(-len(x) // (MOST_POINTS // 2))
    count = len(x) // stretch * stretch
    rows = y[:count].reshape(-1, stretch)
    first = np.arange(0, count, stretch)
    low = np.argmin(np.where(np.isnan(rows), np.inf, rows), axis=1)
    high = np.argmax(np.where(np.isnan(rows), -np.inf, rows), axis=1)
    holes = first + np.argmax(np.isnan(rows), axis=1)
    places = np.unique(np.concatenate([first + low, first + high,
                                       holes[np.isnan(rows).any(axis=1)],
                                       np.arange(count, len(x))]))
    return x[places], y[places]


def _over_time(over_time, source):
    """Return the curves, one panel above the other, with a row of what happened on top."""
    import plotly.graph_objects as go
    from plotly.subplots import make_subplots
    marks = source.history.marks[:MOST_MARKS]
    rows = len(over_time) + 1
    heights = [0.5 if marks else 0.01, *[1.0] * len(over_time)]
    figure = make_subplots(rows, 1, shared_xaxes=True, vertical_spacing=0.12 / rows,
                           row_heights=heights)
    texts = [
        f'{mark.name}<br>' + '<br>'.join(f'{key}: {value}' for key, value in mark.values.items())
        for mark in marks
    ]
    figure.add_trace(go.Scatter(
        x=[(mark.stamp - source.start) * 1e-9 for mark in marks], y=[mark.kind for mark in marks],
        mode='markers', marker={'color': MARK, 'size': 12, 'symbol': 'line-ns',
                                'line': {'color': MARK, 'width': 2}},
        text=texts, hovertemplate='%{text}<extra></extra>', showlegend=False), 1, 1)
    for row, panel in enumerate(over_time, 2):
        _add_panel(figure, row, panel)
    figure.update_yaxes(visible=bool(marks), row=1, col=1)
    figure.update_xaxes(visible=bool(marks), row=1, col=1)
    figure.update_xaxes(title_text='time since the first tick (s)', row=rows, col=1)
    return _layout(figure, PANEL_HEIGHT * rows, hovermode='x')


def _add_panel(figure, row, panel):
    """Add the curves of a Panel to a row of a figure."""
    import plotly.graph_objects as go
    legend, several = f'legend{row}', len(panel.lines) > 1
    for k, line in enumerate(panel.lines):
        style = {'color': COLORS[k], 'dash': DASHES[k] if several else 'solid', 'width': 1.2,
                 'shape': 'hv' if panel.steps else 'linear'}
        x, y = thinned(line.x, line.y)
        figure.add_trace(go.Scatter(x=x.astype(np.float32), y=y.astype(np.float32), name=line.name,
                                    showlegend=several, legend=legend, line=style), row, 1)
    top = figure.layout[f'yaxis{row}'].domain[1]
    figure.update_layout({legend: {'y': top, 'yanchor': 'top', 'x': 1.0, 'xanchor': 'left',
                                   'font': {'size': 11}}})
    # a standoff keeps the title beside the tick labels, however wide they are
    figure.update_yaxes(title_text=panel.label.replace('\n', '<br>'), title_font_size=11,
                        title_standoff=8, automargin=True, exponentformat='power', row=row, col=1,
                        type='log' if panel.log else 'linear')
    figure.update_yaxes(range=_range(panel), row=row, col=1)
    if panel.band:
        figure.add_hrect(-panel.band, panel.band, fillcolor='#888888', opacity=0.25, line_width=0,
                         row=row, col=1)
    for name, begin, end in panel.spans:
        figure.add_vrect(begin, end, fillcolor='#E69F00', opacity=0.15, line_width=0,
                         annotation_text=name, annotation_position='top left', row=row, col=1)


def _range(panel):
    """Return the range of the axis of curves that stay where they are, else None.

    plotly shows a constant from 1 below it to 1 above it, whatever its size.
    """
    values = np.concatenate([line.y for line in panel.lines])
    values = values[np.isfinite(values)]
    size = float(np.abs(values).max(initial=0.0))
    if panel.log or panel.band or size == 0.0 or np.ptp(values) > FLAT * size:
        return None
    middle = 0.5 * float(values.min() + values.max())
    return [middle - AROUND * size, middle + AROUND * size]


def _in_space(space):
    import plotly.graph_objects as go
    figure = go.Figure()
    for (name, net), color in zip(space.surfaces.items(), ('#999999', COLORS[1]), strict=False):
        x, y, z = np.moveaxis(net.astype(np.float32), 2, 0)
        figure.add_trace(go.Surface(x=x, y=y, z=z, name=name, showscale=False, opacity=0.25,
                                    colorscale=[[0, color], [1, color]], hoverinfo='name',
                                    showlegend=True))
    step = -(-len(space.path) // MOST_POINTS)
    x, y, z = space.path[::step].astype(np.float32).T
    times = space.times[::step].astype(np.float32)
    figure.add_trace(
        go.Scatter3d(
            x=x,
            y=y,
            z=z,
            mode='markers',
            name='path',
            customdata=times,
            hovertemplate='t = %{customdata:.6g} s<extra></extra>',
            marker={
                'size': 2,
                'color': times,
                'colorscale': 'Viridis',
                'colorbar': {'title': 't (s)'},
            },
        )
    )
    axes = {f'{name}axis': {'title': label} for name, label in zip('xyz', space.axes, strict=True)}
    return _layout(figure, SPACE_HEIGHT, scene={**axes, 'aspectmode': 'data'},
                   legend={'x': 0.0, 'y': 1.0})


def _spectra(spectrum):
    import plotly.graph_objects as go
    from plotly.subplots import make_subplots
    figure = make_subplots(2, 1, shared_xaxes=True, vertical_spacing=0.03)
    # frequencies far above are not sent to the page
    last = int(np.searchsorted(spectrum.frequencies, 4.0 * spectrum.top))
    for row, axes in enumerate(spectrum.amplitudes, 1):
        seen = spectrum.seen(axes)[:last - 1].astype(np.float32)
        for k, name in enumerate('xyz'):
            x, y = thinned(spectrum.frequencies[1:last].astype(np.float32), seen[:, k])
            figure.add_trace(
                go.Scatter(
                    x=x,
                    y=y,
                    name=f'{name} ({axes})',
                    line={'color': COLORS[k], 'dash': DASHES[k], 'width': 1.2},
                ),
                row,
                1,
            )
        for line, _ in spectrum.lines:
            if line.axes == axes:
                figure.add_vline(line.frequency, line_dash='dot', annotation_text=line.name,
                                 row=row, col=1)
        figure.update_yaxes(type='log', title_text=f'ω, {axes} axes (rad/s)',
                            exponentformat='power', row=row, col=1)
    figure.update_xaxes(title_text='frequency (Hz)', row=2, col=1)
    figure.update_xaxes(range=[0.0, spectrum.top])
    return _layout(figure, SPACE_HEIGHT)
