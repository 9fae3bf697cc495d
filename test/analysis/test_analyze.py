# SPDX-License-Identifier: Apache-2.0
"""The command `analyze` on recordings whose content is known, of ours and of strangers."""

import functools
import json
import os
import shutil

import numpy as np
import pytest
from analysis import made
from near import near

from rigid_body_sim.analysis import page, panels, plots
from rigid_body_sim.analysis.analyze import analyze, main, report_folder
from rigid_body_sim.analysis.measure import measure
from rigid_body_sim.analysis.source import sources
from rigid_body_sim.recording.reader import Recording
from rigid_body_sim.simulation.simulation import Simulation

pytestmark = pytest.mark.without_numba

PAGE = ['report.html'] if page.available() else []
FIGURES = ('overview', 'motion', 'ledger', 'spectrum', 'polhode', 'axis')
LATE = np.random.default_rng(2).integers(30_000, 90_000, 3001)


@pytest.fixture(scope='module')
def eventful(tmp_path_factory):
    """Return what returns the path of 3 s with all that can befall a run.

    There are an impulse, a wrench held for 0.5 s, a reset, a gap and lateness. It is made when it
    is called, for a test without numba has its fixtures in two processes.
    """
    return functools.cache(lambda: _eventful(tmp_path_factory.mktemp('analyze') / 'eventful'))


def _eventful(path):
    acts = {500: [('cmd_impulse', (0.0, 0.0, 0.0), (0.5, 0.0, 0.0), 'world')],
            1000: [('cmd_wrench', (0.0, 0.0, 0.0), (0.0, 2.0, 0.0), 'body')],
            1500: [('cmd_wrench', (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 'body')],
            2500: [('reset',)]}
    made.record(path, 'tennis_racket', 3000, acts=acts, late=LATE, left_out=range(2000, 2040))
    return path


def test_the_report_says_what_was_done(eventful, tmp_path, capsys):
    assert main([str(eventful()), '--output', str(tmp_path)]) == 0
    printed = capsys.readouterr().out.splitlines()
    text = (tmp_path / 'report.txt').read_text().splitlines()
    assert printed[:len(text)] == text
    files = ['report.txt', 'report.json', *(f'{name}.png' for name in FIGURES), *PAGE]
    assert [line.strip() for line in printed[len(text):]] == [str(tmp_path / name)
                                                              for name in files]
    assert all((tmp_path / name).stat().st_size > 10_000 for name in files[2:])
    assert all((tmp_path / f'{name}.svg').read_text().startswith('<?xml') for name in FIGURES)
    [found] = json.loads((tmp_path / 'report.json').read_text())['bodies']
    assert (found['scene'], found['made_by'], found['rate'], found['run']['method']) == (
        'tennis_racket', 'sim_node', 1000.0, 'exact')
    assert (found['commands'], found['resets'], found['left_out_by_recorder'],
            found['events']['reset']) == (3, 1, 40, 1)
    energy, momentum = found['energy'], found['angular_momentum_squared']
    # the impulse and the wrench change them by far more than this, but not the residuals; they are
    # kept in 2461 ticks of 2961
    assert energy['greatest'] > energy['least'] + 1.0
    for quantity in (energy, momentum):
        assert 0.0 < quantity['largest_residual'] < 2e-14     # 1.3e-14
        assert quantity['judged_ticks'] == 3001 - 40 - 500
    timing = found['timing']
    assert (timing['ticks'], timing['missing'], timing['standstills']) == (2961, 40, 0)
    assert timing['lateness']['max'] == pytest.approx(60e-6, abs=1.5e-6)
    assert timing['lateness']['p50'] == pytest.approx(30e-6, abs=2.5e-6)
    assert '  drops    40 ticks are missing, 40 of them left out by the recorder' in printed


def test_the_figure_shows_what_was_recorded(eventful):
    recording = Recording(eventful())
    [one] = measure(recording, sources(recording))
    figure = plots.stack(panels.overview(one), 'title', one.source)
    omega, energy, momentum, late = figure.axes
    recorded = recording.read('/angular_velocity')
    for k, line in enumerate(omega.lines[:3]):
        times, values = line.get_data()
        assert np.flatnonzero(np.isnan(values)).tolist() == [2000]      # at the gap
        assert np.delete(values, 2000).tolist() == recorded['vector'][:, k].tolist()
        assert np.delete(times, 2000) == pytest.approx((recorded['log_time'] - made.START) * 1e-9)
    # told apart without colour
    assert len({line.get_linestyle() for line in omega.lines[:3]}) == 3
    marks = {tuple(line.get_xdata()) for line in omega.lines[3:]}
    assert {(0.5, 1.0, 1.5), (2.5,), (1.999,)} <= {tuple(np.round(times, 9)) for times in marks}
    for axes, quantity in ((energy, one.energy), (momentum, one.momentum)):
        values = axes.lines[0].get_ydata()
        assert np.flatnonzero(np.isnan(values)).tolist() == [1000]      # where the wrench is held
        assert np.delete(values, 1000).tolist() == quantity.curve()[1].tolist()
    assert {text.get_text() for text in late.get_legend().get_texts()} == {'p50', 'p99', 'max'}


@pytest.mark.usefixtures('undrawn')
def test_flips_are_counted_without_looking_at_events(tmp_path):
    made.record(tmp_path / 'run', 'tennis_racket', 1500, rate=75.0)
    [found], _ = analyze(tmp_path / 'run', tmp_path / 'report', short=True)
    omega = Recording(tmp_path / 'run').read('/angular_velocity')['vector']
    assert found['flips'] == np.count_nonzero(np.diff(omega[:, 1] > 0.0)) == 4
    assert found['events'].get('flip', 4) == 4


@pytest.mark.usefixtures('undrawn')
def test_drift_that_is_there_is_found(tmp_path):
    """The energy of coarse steps drifts: the report has the drift that the messages show."""
    simulation = Simulation('tennis_racket', integrator='dop8', accuracy=1e-4, rate=100.0)
    states = made.record_foreign(tmp_path / 'run', simulation, 2000, 0.01)
    energies, momenta = simulation.diagnose(states)
    [found], _ = analyze(tmp_path / 'run', tmp_path / 'report', short=True)
    # differences of numbers near 1: measured 1.6e-17
    assert found['energy']['largest_residual'] == pytest.approx(
        np.abs(energies / energies[0] - 1.0).max(), abs=1e-15)
    assert found['angular_momentum_squared']['last_residual'] == pytest.approx(
        momenta[-1] / momenta[0] - 1.0, abs=1e-15)
    assert found['energy']['largest_residual'] > 1e-9


def test_a_recording_of_ros2_bag_record_is_analysed_too(tmp_path):
    states = made.record_foreign(
        tmp_path / 'run', Simulation('tennis_racket', rate=200.0), 2001, 0.005)
    [found], files = analyze(tmp_path / 'run', tmp_path / 'report')
    assert found['ledger'] is None      # the commands are not known
    assert (found['namespace'], found['scene'], found['made_by'], found['run']) == (
        '/lab', 'tennis_racket', '', {})
    assert found['rate'] == near(200.0, rel=1e-9)
    assert found['flips'] == np.count_nonzero(np.diff(states.angular_velocity[:, 1] > 0.0)) == 2
    assert found['energy']['largest_residual'] < 1e-14
    assert (found['timing']['ticks'], found['timing']['missing']) == (2001, 0)
    # written at once at its time of arrival, 20 to 90 us after the stamp
    assert found['timing']['lateness']['max'] == pytest.approx(70e-6, abs=3e-6)
    assert [path.name for path in files[2:]] == [
        *(f'{name}_lab.png' for name in FIGURES if name != 'ledger'), *PAGE]


def test_without_a_scene_nothing_is_judged_by_it(tmp_path):
    made.record_foreign(
        tmp_path / 'run', Simulation('tennis_racket'), 500, 0.001, with_scene=False)
    [found], _ = analyze(tmp_path / 'run', tmp_path / 'report', short=True)
    assert found['scene'] is None and found['flips'] is None
    assert (found['energy']['largest_residual'] is None
            and found['energy']['first'] == pytest.approx(25.0002))


def test_two_bodies_in_one_recording(tmp_path):
    made.record(tmp_path / 'run', 'tennis_racket', 300, namespace='/left', bodies=['/right'])
    found, files = analyze(tmp_path / 'run', tmp_path / 'report', short=True)
    assert [one['namespace'] for one in found] == ['/left', '/right']
    assert found[0]['energy'] == found[1]['energy'] and found[0]['energy']['judged_ticks'] == 301
    assert {path.name for path in files} == {
        'report.txt', 'report.json', 'overview_left.png', 'overview_right.png'}


@pytest.mark.usefixtures('undrawn')
def test_the_report_lies_beside_the_recording(tmp_path, monkeypatch, capsys):
    made.record(tmp_path / 'one.a', 'tennis_racket', 20)
    file = tmp_path / 'one.a' / 'one.a_0.mcap'
    assert report_folder(tmp_path / 'one.a') == tmp_path / 'one.a_report'
    assert report_folder(file) == tmp_path / 'one.a' / 'one.a_0_report'
    monkeypatch.chdir(tmp_path / 'one.a')
    assert report_folder('.') == tmp_path / 'one.a_report'
    assert main(['.', str(file), '--output', str(tmp_path / 'all'), '--json']) == 0
    results = json.loads(capsys.readouterr().out)
    assert ([len(result['bodies']) for result in results] == [1, 1]
            and results[0]['bodies'] == results[1]['bodies'])
    # one page on both, and a folder each
    assert sorted(path.name for path in (tmp_path / 'all').iterdir()) == [
        'one.a_0_report', 'one.a_report', *PAGE, 'report.json']
    assert json.loads((tmp_path / 'all' / 'report.json').read_text()) == results
    for name in PAGE:
        text = (tmp_path / 'all' / name).read_text(encoding='utf-8')
        assert '<p>one.a: The' in text and '<p>one.a_0.mcap: The' in text and 'id="time1"' in text
    assert not (tmp_path / 'all' / 'one.a_report' / 'report.html').exists()


def test_bad_input_is_one_line(tmp_path, capsys):
    made.record(tmp_path / 'run', 'tennis_racket', 2000)
    shutil.copytree(tmp_path / 'run', tmp_path / 'cut')
    file = tmp_path / 'cut' / 'cut_0.mcap'
    (tmp_path / 'cut' / 'run_0.mcap').rename(file)
    file.write_bytes(file.read_bytes()[:-1000])
    (tmp_path / 'cut' / 'metadata.yaml').unlink()
    (tmp_path / 'text.mcap').write_text('hello')
    (tmp_path / 'blocked').write_text('')
    for arguments, said in [([tmp_path / 'missing'], 'missing'), ([tmp_path / 'cut'], 'recover'),
                            ([file], 'recover'), ([tmp_path / 'text.mcap'], 'MCAP'),
                            ([tmp_path / 'run', '--output', tmp_path / 'blocked' / 'here'],
                             'the report cannot be written (Not a directory)')]:
        assert main([str(argument) for argument in arguments]) == 2
        error = capsys.readouterr().err
        assert said in error and error.count('\n') == 1


@pytest.mark.usefixtures('undrawn')
def test_a_folder_of_recordings_stands_for_the_newest(eventful, tmp_path, capsys):
    for number, name in enumerate(('b', 'a')):
        shutil.copytree(eventful(), tmp_path / name)
        for file in (tmp_path / name).iterdir():
            os.utime(file, (number, number))
    assert main([str(tmp_path)]) == 0
    assert f'{tmp_path / "a"}: the newest of 2 recordings\n' in capsys.readouterr().err
    assert (tmp_path / 'a_report' / 'report.json').is_file()
    assert not (tmp_path / 'b_report').exists()
