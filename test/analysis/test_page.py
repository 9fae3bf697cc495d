"""report.html: one file, no network, and no error in a browser nobody here wrote."""

import re
import shutil
import subprocess

import pytest
from analysis import made

from rigid_body_sim.analysis import page
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
    made.record(folder / 'run', 'tennis_racket', 600, rate=100.0, namespace='/left', bodies=['/right'], acts=acts)
    with Recording(folder / 'run') as recording:
        bodies = measure(recording, sources(recording))
    page.write_page(folder / 'report.html', [('run', one, summary(one, Spectrum(one)), Spectrum(one), None) for one in bodies])
    return folder / 'report.html'


def test_the_page_is_complete_in_itself(written):
    text = written.read_text(encoding='utf-8')
    own = re.sub(r'<script>/\*\*.*?</script>', '', text, count=1, flags=re.DOTALL)     # without Plotly itself
    assert len(text) - len(own) > 10**6
    assert not re.search(r'(src|href)\s*=', own) and 'http' not in own.replace('http://www.w3.org', '')
    for name in ('time0', 'body0', 'polhode0', 'axis0', 'spectrum0', 'time1', 'body1'):
        assert f'id="{name}"' in own
    assert 'cmd_impulse' in own and 'scene: tennis_racket' in own


@pytest.mark.skipif(not CHROMIUM, reason='needs chromium (Debian, Ubuntu: apt install chromium)')
def test_a_browser_draws_it_without_an_error(written, tmp_path):
    def console(path):
        options = ['headless=new', 'no-sandbox', 'disable-dev-shm-usage', 'use-angle=swiftshader', 'enable-unsafe-swiftshader',
                   'enable-logging=stderr', 'v=0', f'user-data-dir={tmp_path}', 'virtual-time-budget=5000', 'dump-dom']
        command = [CHROMIUM, *(f'--{option}' for option in options), f'file://{path}']
        done = subprocess.run(command, capture_output=True, text=True, timeout=110)
        errors = [line for line in done.stderr.splitlines() if 'CONSOLE' in line and ('Uncaught' in line or 'rror' in line)]
        return done.stdout, errors

    drawn, errors = console(written)
    assert not errors
    assert drawn.count('class="main-svg"') >= 8 and drawn.count('<canvas') >= 6
    assert len(re.findall(r'<output>t = \d', drawn)) == 2      # playback has shown its first frame

    # an error would have been seen
    broken = written.with_name('broken.html')
    broken.write_text('<html><body><script>playback("body0", "controls0", {})</script></body></html>')
    assert console(broken)[1]


def test_without_plotly_the_rest_is_made_and_it_is_said(tmp_path, monkeypatch, capsys):
    made.record(tmp_path / 'run', 'tennis_racket', 30)
    monkeypatch.setattr(page, 'available', lambda: False)
    assert main([str(tmp_path / 'run')]) == 0
    captured = capsys.readouterr()
    assert 'report.html was not made: it needs plotly' in captured.err and 'report.html' not in captured.out
    assert (tmp_path / 'run_report' / 'polhode.png').exists()
