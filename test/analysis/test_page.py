# SPDX-License-Identifier: Apache-2.0
"""report.html: one file, no network, and no error in a browser nobody here wrote."""

import base64
import gzip
import json
import re
import shutil
import subprocess

import numpy as np
import pytest
from analysis import made

from rigid_body_sim.analysis import page, panels
from rigid_body_sim.analysis.analyze import main
from rigid_body_sim.analysis.measure import measure
from rigid_body_sim.analysis.source import sources
from rigid_body_sim.analysis.spectrum import Spectrum
from rigid_body_sim.analysis.summary import summary
from rigid_body_sim.recording.reader import Recording

pytestmark = pytest.mark.skipif(not page.available(), reason='needs plotly')
CHROMIUM = shutil.which('chromium') or shutil.which('chromium-browser')


@pytest.fixture(scope='module')
def written(tmp_path_factory):
    """Return the path of a page on two bodies, one with commands."""
    folder = tmp_path_factory.mktemp('page')
    acts = {100: [('cmd_impulse', (0.0, 0.0, 0.0), (0.5, 0.0, 0.0), 'world')]}
    made.record(folder / 'run', 'tennis_racket', 600, rate=100.0, namespace='/left',
                bodies=['/right'], acts=acts)
    with Recording(folder / 'run') as recording:
        bodies = measure(recording, sources(recording))
    page.write_page(
        folder / 'report.html',
        [('run', one, summary(one, Spectrum(one)), Spectrum(one), None) for one in bodies])
    return folder / 'report.html'


def carried(text, name):
    """Return a text that the page carries compressed."""
    packed = re.search(
        f'<script type="application/gzip" id="{name}">([^<]*)</script>', text).group(1)
    return gzip.decompress(base64.b64decode(packed)).decode()


def test_a_curve_that_stays_where_it_is_is_shown_at_its_own_size():
    """An energy of 0.023 J was once drawn as a line at zero on an axis from -1 to 1."""
    times = np.arange(5.0)

    def shown(*values, **more):
        lines = tuple(panels.Line('', times, np.array(one)) for one in values)
        return page._range(panels.Panel('energy', 'energy', lines, **more))
    still = np.full(5, 0.02)
    assert shown(still) == pytest.approx([0.016, 0.024])
    assert shown(-still * [1.0, 1.0, 1.0, 1.0, 1.0 + 1e-9]) == pytest.approx([-0.024, -0.016])
    assert shown(np.append(still[:4], np.nan)) == pytest.approx([0.016, 0.024])
    for several in ([still, 2.0 * still], [np.zeros(5)], [times], [np.full(5, np.nan)]):
        assert shown(*several) is None
    assert shown(still, log=True) is None and shown(still, band=1e-16) is None


def test_the_page_is_complete_in_itself_and_small(written):
    text = written.read_text(encoding='utf-8')
    assert len(carried(text, 'plotly')) > 10**6 and len(text) < 3 * 10**6
    packed = json.loads(carried(text, 'data'))
    own = re.sub(r'<script type="application/gzip".*?</script>', '', text, flags=re.DOTALL)
    assert not re.search(r'(src|href)\s*=', own) and 'http' not in own
    for name in ('time0', 'more0', 'polhode0', 'axis0', 'spectrum0', 'time1'):
        assert f'id="{name}"' in own and name in packed['figures']
    assert set(packed['bodies']) == {'0', '1'} and 'id="body0"' in own and 'id="body1"' in own
    assert '<p>run: The middle axis is unstable' in own
    assert 'cmd_impulse' in own and 'scene: tennis_racket' in own


def test_the_verdict_comes_first_and_tells_what_is_wrong(written):
    text = written.read_text(encoding='utf-8')
    assert text.index('class="verdict') < text.index('<canvas') < text.index(
        'id="time0"') < text.index('<details>')
    assert '<b>Kept within each of 2 stretches:</b> energy' in text and 'none lost' in text
    found = {
        'energy': {'largest_residual': 0.1, 'stretches': 1}, 'strikes': 0, 'accuracy_missed': [],
        'angular_momentum_squared': {'largest_residual': None, 'stretches': 0}, 'run': {},
        'timing': {'ticks': 5, 'missing': 2}, 'left_out_by_recorder': 0, 'lines': [], 'events': {},
        'commands': 0}
    said = page._verdict(found, None)
    assert 'verdict bad' in said and 'Not kept' in said and '2 lost' in said
    for commands, words in ((1, ' 1 tick with commands.'), (3, ' 3 ticks with commands.')):
        assert words in page._verdict(found | {'commands': commands}, None)


def found_of(energy=1e-16, square=1e-16, stretches=1, levels=(), **more):
    """Return what the verdict is about; nothing else has happened."""
    kept = {name: {'largest_residual': worst, 'stretches': stretches, 'levels': list(levels)}
            for name, worst in (('energy', energy), ('angular_momentum_squared', square))}
    return {**kept, 'strikes': 0, 'accuracy_missed': [], 'run': {'accuracy': 1e-9}, 'lines': [],
            'timing': {'ticks': 500, 'missing': 3}, 'left_out_by_recorder': 3, 'events': {},
            'commands': 0, **more}


def line(predicted, measured):
    return {'predicted': predicted, 'measured': measured}


@pytest.mark.parametrize(('found', 'good', 'said'), [
    (found_of(), True, '<b>Kept:</b> energy to 1.0e-16 and L² to 1.0e-16 (relative, which is '
     'round-off). 500 ticks, none lost.'),
    # ten times the accuracy that was asked are allowed, or of round-off where it was finer
    (found_of(1e-8), True, '<b>Kept:</b> energy to 1.0e-08 and L² to 1.0e-16 (relative). 500'),
    (found_of(1e-16, 1.01e-8), False, '<b>Not kept:</b> energy'),
    (found_of(10.0 * page.FLOOR, run={}), True, '<b>Kept:</b>'),
    (found_of(page.FLOOR, run=None), True, '(relative, which is round-off)'),
    (found_of(11.0 * page.FLOOR, run={'accuracy': None}), False, '<b>Not kept:</b>'),
    (found_of(None), True, '<b>Kept:</b> L² to 1.0e-16 (relative'),
    (found_of(None, None), True, 'Energy and L² need not be constant in this scene. 500 ticks'),
    (found_of(left_out_by_recorder=2), False, '500 ticks, 1 lost.'),
    (found_of(accuracy_missed=['a < b']), False, ' <b>Note:</b> a &lt; b. 500'),
    (found_of(stretches=2, levels=[{'begun_by': ''}, {'begun_by': 'strike'},
                                   {'begun_by': 'reset'}, {'begun_by': 'strike'}]), True,
     '<b>Kept within each of 2 stretches:</b> energy to 1.0e-16 and L² to 1.0e-16 '
     '(relative, which is round-off). It is changed by resets and strikes between them. 500'),
    # L² alone is kept
    (found_of(stretches=2, levels=[{'begun_by': ''}, {'begun_by': 'parameters'}]) | {
        'energy': {'largest_residual': None, 'stretches': 0, 'levels': []}}, True,
     '<b>Kept within each of 2 stretches:</b> L² to 1.0e-16 (relative, which is round-off). It '
     'is changed by changes of parameters between them. 500'),
    (found_of(lines=[line(2.0, 2.002), line(3.0, None)]), True,
     ' 1 predicted frequency was measured, within 1.0e-03.'),
    (found_of(lines=[line(2.0, 1.99), line(4.0, 4.004)]), True,
     ' 2 predicted frequencies were measured, within 5.0e-03.'),
    (found_of(events={'flip': 4}, strikes=2), True, ' none lost. 4 x flip, 2 x strike.')])
def test_the_verdict_is_what_was_measured(found, good, said):
    text = page._verdict(found, None)
    assert text.startswith(f'<p class="verdict{"" if good else " bad"}">') and said in text


def test_where_energy_is_not_constant_the_verdict_is_about_its_ledger():
    ledger = None, {'energy_residual': np.array([0.0, -3e-12, np.nan, 1e-12])}
    text = page._verdict(found_of(None, None), ledger)
    assert 'in this scene. The ledger balances energy to 3.0e-12 (relative). 500 ticks' in text


def test_no_button_of_a_figure_uploads_it(written):
    """Every figure names its buttons; what Plotly would add by itself sends the figure away."""
    own = re.sub(r'<script type="application/gzip".*?</script>', '',
                 written.read_text(encoding='utf-8'), flags=re.DOTALL)
    drawn = own.count('Plotly.newPlot(')
    assert drawn == own.count('modeBarButtons: [') == own.count("plotlyServerURL: ''") > 0
    assert (set(re.findall(
                r"'(\w+)'", ''.join(re.findall(r'modeBarButtons: \[.*?\]\}', own, re.DOTALL))))
            <= {'toImage', 'orbitRotation', 'pan3d', 'resetCameraDefault3d', 'zoom2d', 'pan2d',
                'resetScale2d'})


def test_a_thinned_curve_keeps_its_extremes_and_its_holes():
    x, y = np.arange(100_000.0), np.random.default_rng(1).normal(size=100_000)
    y[[777, 50_000]] = 9.0, np.nan
    kept_x, kept_y = page.thinned(x, y)
    assert len(kept_x) <= 1.1 * page.MOST_POINTS and np.all(np.diff(kept_x) > 0.0)
    assert 9.0 in kept_y and np.isnan(kept_y).sum() == 1 and np.nanmin(kept_y) == np.nanmin(y)


@pytest.mark.skipif(not CHROMIUM, reason='needs chromium (Debian, Ubuntu: apt install chromium)')
def test_a_browser_draws_it_without_an_error(written, tmp_path):
    def console(path):
        options = ['headless=new', 'no-sandbox', 'disable-dev-shm-usage', 'use-angle=swiftshader',
                   'enable-unsafe-swiftshader', 'enable-logging=stderr', 'v=0',
                   f'user-data-dir={tmp_path}', 'virtual-time-budget=5000', 'dump-dom']
        command = [CHROMIUM, *(f'--{option}' for option in options), f'file://{path}']
        done = subprocess.run(command, capture_output=True, text=True, timeout=110)
        errors = [line
                  for line in done.stderr.splitlines()
                  if 'CONSOLE' in line and ('Uncaught' in line or 'rror' in line)]
        return done.stdout, errors

    drawn, errors = console(written)
    assert not errors
    assert drawn.count('class="main-svg"') >= 2 and drawn.count('<canvas') >= 2
    # each body has shown its first frame
    assert len(re.findall(r'<output>t = \d', drawn)) == 2

    # an error would have been seen
    broken = written.with_name('broken.html')
    broken.write_text('<html><body><script>player(0, {})</script></body></html>')
    assert console(broken)[1]


@pytest.mark.usefixtures('undrawn')
def test_without_plotly_the_rest_is_made_and_it_is_said(tmp_path, monkeypatch, capsys):
    made.record(tmp_path / 'run', 'tennis_racket', 30)
    monkeypatch.setattr(page, 'available', lambda: False)
    assert main([str(tmp_path / 'run')]) == 0
    captured = capsys.readouterr()
    assert ('report.html was not made: it needs plotly' in captured.err
            and 'report.html' not in captured.out)
    assert (tmp_path / 'run_report' / 'polhode.png').exists()


def luminance(color):
    """Return the relative luminance of a colour '#rrggbb' (WCAG 2)."""
    parts = [int(color[k:k + 2], 16) / 255.0 for k in (1, 3, 5)]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4
              for part in parts]
    return float(np.dot((0.2126, 0.7152, 0.0722), linear))


def contrast(one, other):
    """Return the contrast of two colours."""
    darker, lighter = sorted((luminance(one), luminance(other)))
    return (lighter + 0.05) / (darker + 0.05)


def test_thin_lines_are_told_from_a_light_and_a_dark_page():
    style, script = ((page.HERE / name).read_text() for name in ('page.css', 'page.js'))
    light, dark = re.findall(r'--page: (#\w+)', style)
    brighter = dict(re.findall(r"'(#\w+)': '(#\w+)'", script))
    assert brighter.keys() == set(page.COLORS)
    for color in page.COLORS:
        assert contrast(color, light.replace('#fff', '#ffffff')) > 3.0
        assert contrast(brighter[color], dark) > 7.0
    trace = '#' + ''.join(f'{round(255 * part):02x}' for part in page.TRACE)
    for box in re.findall(r'--box: (#\w+)', style):
        assert contrast(trace, box) > 3.0


def test_without_events_there_is_no_row_for_them(tmp_path):
    made.record(tmp_path / 'still', 'symmetric_top', 50)
    with Recording(tmp_path / 'still') as recording:
        [measured] = measure(recording, sources(recording))
        figure = page._over_time(page.panels.overview(measured), measured.source)
    assert not figure.layout.xaxis.visible and not figure.layout.yaxis.visible
