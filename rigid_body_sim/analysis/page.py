"""report.html: the report to look at, in one file that works without a network; by Plotly, where it is installed."""

import html
import importlib.util
import json
import pathlib

import numpy as np

from rigid_body_sim.analysis import panels
from rigid_body_sim.analysis.space import playback, spaces
from rigid_body_sim.analysis.summary import lines, title

COLORS = ('#0072B2', '#D55E00', '#009E73', '#CC79A7')
DASHES = ('solid', 'dash', 'dashdot', 'dot')
MOST_MARKS = 500
PANEL_HEIGHT, SPACE_HEIGHT = 190, 620    # px
FACES = ((0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3))


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
    here = pathlib.Path(__file__).parent
    heading = ', '.join(title(found) for _, _, found, _, _ in bodies)
    parts = [f'<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>{html.escape(heading)}</title>',
             f'<style>{(here / "page.css").read_text()}</style><script>{get_plotlyjs()}</script>',
             f'<script>{(here / "playback.js").read_text()}</script></head><body>']
    for number, body in enumerate(bodies):
        parts += _section(number, *body)
    path.write_text('\n'.join([*parts, '</body></html>']), encoding='utf-8')


def _section(number, name, measured, found, spectrum, balance):
    """Yield the HTML of one body."""
    yield f'<h1>{html.escape(title(found))}</h1><p>{html.escape(name)}</p><pre>{html.escape(chr(10).join(lines(found)[1:]))}</pre>'
    over_time = [*panels.overview(measured), *panels.motion(measured), *(panels.energies(balance) if balance else ())]
    yield '<h2>Over time</h2><p>Drag to zoom, double-click to see all; curves of more than 32768 points show the extremes of each stretch.</p>'
    yield _html(_over_time(over_time, measured.source), f'time{number}')
    shown = playback(measured)
    if shown:
        yield from _playback(number, shown)
    for space in spaces(measured):
        yield f'<h2>{html.escape(space.title)}</h2>'
        yield _html(_in_space(space), f'{space.name}{number}')
    if spectrum and spectrum.amplitudes:
        yield f'<h2>Spectrum of ω in the first {spectrum.seconds:.6g} s, predicted lines dotted</h2>'
        yield _html(_spectra(spectrum), f'spectrum{number}')
        yield _table(('line', 'axes', 'predicted (Hz)', 'measured (Hz)', 'source'),
                     [(line.name, line.axes, f'{line.frequency:.9g}', '-' if found is None else f'{found:.9g}', line.source)
                      for line, found in spectrum.lines])
    marks = measured.source.history.marks
    yield f'<h2>What happened ({len(marks)})</h2>'
    yield _table(('time (s)', 'kind', 'what', 'values'), [(f'{(mark.stamp - measured.source.start) * 1e-9:.9g}', mark.kind, mark.name,
                                                          ', '.join(f'{key} {value}' for key, value in mark.values.items()))
                                                         for mark in marks[:MOST_MARKS]])
    if measured.source.scene:
        yield f'<h2>Scene</h2><pre>{html.escape(measured.source.scene.text)}</pre>'


def _table(heads, rows):
    if not rows:
        return ''
    cells = [''.join(f'<td>{html.escape(str(cell))}</td>' for cell in row) for row in rows]
    head = ''.join(f'<th>{html.escape(cell)}</th>' for cell in heads)
    return f'<table><tr>{head}</tr>{"".join(f"<tr>{row}</tr>" for row in cells)}</table>'


def _html(figure, name):
    return figure.to_html(full_html=False, include_plotlyjs=False, div_id=name, config={'displaylogo': False, 'responsive': True})


def _layout(figure, height, **more):
    figure.update_layout(height=height, margin={'l': 80, 'r': 90, 't': 20, 'b': 50}, template='plotly_white', **more)
    return figure


def _over_time(over_time, source):
    """Return the curves, one panel above the other, with a row of what happened on top."""
    import plotly.graph_objects as go
    from plotly.subplots import make_subplots
    marks = source.history.marks[:MOST_MARKS]
    rows = len(over_time) + 1
    heights = [0.5 if marks else 0.01, *[1.0] * len(over_time)]
    figure = make_subplots(rows, 1, shared_xaxes=True, vertical_spacing=0.12 / rows, row_heights=heights)
    figure.add_trace(go.Scatter(
        x=[(mark.stamp - source.start) * 1e-9 for mark in marks], y=[mark.kind for mark in marks], mode='markers', marker={'color': 'black'},
        text=[f'{mark.name}<br>' + '<br>'.join(f'{key}: {value}' for key, value in mark.values.items()) for mark in marks],
        hovertemplate='%{text}<extra></extra>', showlegend=False), 1, 1)
    for row, panel in enumerate(over_time, 2):
        legend = f'legend{row}'
        for k, line in enumerate(panel.lines):
            style = {'color': COLORS[k], 'dash': DASHES[k] if len(panel.lines) > 1 else 'solid', 'width': 1.2,
                     'shape': 'hv' if panel.steps else 'linear'}
            figure.add_trace(go.Scatter(x=line.x, y=line.y.astype(np.float32), name=line.name, showlegend=len(panel.lines) > 1, legend=legend,
                                        line=style), row, 1)
        top = figure.layout[f'yaxis{row}'].domain[1]
        figure.update_layout({legend: {'y': top, 'yanchor': 'top', 'x': 1.0, 'xanchor': 'left', 'font': {'size': 11}}})
        figure.update_yaxes(title_text=panel.label.replace('\n', '<br>'), title_font_size=11, row=row, col=1, exponentformat='e',
                            type='log' if panel.log else 'linear')
        if panel.band:
            figure.add_hrect(-panel.band, panel.band, fillcolor='#bbbbbb', opacity=0.3, line_width=0, row=row, col=1)
        for name, begin, end in panel.spans:
            figure.add_vrect(begin, end, fillcolor='#E69F00', opacity=0.15, line_width=0, annotation_text=name,
                             annotation_position='top left', row=row, col=1)
    figure.update_yaxes(visible=bool(marks), row=1, col=1)
    figure.update_xaxes(title_text='time since the first tick (s)', row=rows, col=1)
    return _layout(figure, PANEL_HEIGHT * rows, hovermode='x')


def _in_space(space):
    import plotly.graph_objects as go
    figure = go.Figure()
    for (name, net), color in zip(space.surfaces.items(), ('#999999', COLORS[1]), strict=False):
        x, y, z = np.moveaxis(net, 2, 0)
        figure.add_trace(go.Surface(x=x, y=y, z=z, name=name, showscale=False, opacity=0.25, colorscale=[[0, color], [1, color]],
                                    hoverinfo='name', showlegend=True))
    x, y, z = space.path.T
    figure.add_trace(go.Scatter3d(x=x, y=y, z=z, mode='markers', name='path', text=[f't = {time:.6g} s' for time in space.times],
                                  marker={'size': 2, 'color': space.times, 'colorscale': 'Viridis', 'colorbar': {'title': 't (s)'}}))
    axes = {f'{name}axis': {'title': label} for name, label in zip('xyz', space.axes, strict=True)}
    return _layout(figure, SPACE_HEIGHT, scene={**axes, 'aspectmode': 'data'}, legend={'x': 0.0, 'y': 1.0})


def _spectra(spectrum):
    import plotly.graph_objects as go
    from plotly.subplots import make_subplots
    figure = make_subplots(2, 1, shared_xaxes=True, vertical_spacing=0.03)
    # what is much higher is not sent along
    last = int(np.searchsorted(spectrum.frequencies, 4.0 * spectrum.top))
    for row, axes in enumerate(spectrum.amplitudes, 1):
        seen = spectrum.seen(axes)[:last - 1].astype(np.float32)
        for k, name in enumerate('xyz'):
            figure.add_trace(go.Scatter(x=spectrum.frequencies[1:last], y=seen[:, k], name=f'{name} ({axes})',
                                        line={'color': COLORS[k], 'dash': DASHES[k], 'width': 1.2}), row, 1)
        for line, _ in spectrum.lines:
            if line.axes == axes:
                figure.add_vline(line.frequency, line_dash='dot', annotation_text=line.name, row=row, col=1)
        figure.update_yaxes(type='log', title_text=f'ω, {axes} axes (rad/s)', exponentformat='e', row=row, col=1)
    figure.update_xaxes(title_text='frequency (Hz)', row=2, col=1)
    figure.update_xaxes(range=[0.0, spectrum.top])
    return _layout(figure, SPACE_HEIGHT)


def _playback(number, shown):
    """Yield the HTML of the moving body: a figure, buttons, and the data that playback.js moves it by."""
    import plotly.graph_objects as go
    i, j, k = zip(*FACES, strict=True)
    reach = float(np.abs(shown.corners).max()) * 1.6
    x, y, z = shown.corners.T
    figure = go.Figure(go.Mesh3d(x=x, y=y, z=z, i=i, j=j, k=k, color='#56B4E9', flatshading=True, opacity=0.9, hoverinfo='skip'))
    for name, color in zip('xyz', COLORS, strict=False):
        figure.add_trace(go.Scatter3d(x=[0, 0], y=[0, 0], z=[0, 0], mode='lines', line={'color': color, 'width': 7}, name=f'body {name}'))
    axis = {'range': [-reach, reach]}
    _layout(figure, SPACE_HEIGHT, legend={'x': 0.0, 'y': 1.0},
            scene={'xaxis': axis, 'yaxis': axis, 'zaxis': axis, 'aspectmode': 'cube', 'camera': {'up': {'x': 0, 'y': 0, 'z': 1}}})
    data = {'times': np.round(shown.times, 9).tolist(), 'orientation': np.round(shown.orientation, 6).tolist(),
            'corners': shown.corners.tolist(), 'reach': reach}
    yield f'<h2>The body from {shown.times[0]:.6g} to {shown.times[-1]:.6g} s: a box with its mass and moments</h2>'
    yield _html(figure, f'body{number}')
    slider = f'<input type="range" min="0" max="{len(shown.times) - 1}" value="0">'
    yield (f'<p class="playback" id="controls{number}"><button>play</button> {slider} '
           '<select><option value="0.01">1/100</option><option value="0.1">1/10</option><option value="1" selected>real time</option>'
           '<option value="10">10 x</option><option value="100">100 x</option></select> <output></output></p>')
    yield f'<script>playback("body{number}", "controls{number}", {json.dumps(data)})</script>'
