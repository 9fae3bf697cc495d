# SPDX-License-Identifier: Apache-2.0
"""Reports on energy that strikes, commands and resets change at once.

It is constant between them and jumps at each; the report tells both, and marks the strikes.
"""

import itertools
import re

import pytest
from analysis import made

from rigid_body_sim.analysis.analyze import analyze
from rigid_body_sim.cli.simulate import main as simulate

pytestmark = pytest.mark.without_numba

SCENE = """
scene: bar
about: A bar on a hinge, struck three times
body: {mass: 2.0, inertia: [0.001, 0.05, 0.05], center_of_mass: [0.3, 0, 0]}
constraint: {hinge: {axis: [0, 1, 0]}}
effects:
  - gravity: {g: 3.7}
  - strike: {impulse: [0, 0, 1.5], distance: 0.4, time: 0.3}
  - strike: {impulse: [0.5, 0, 1.0], distance: 0.2, time: 0.7}
  - strike: {impulse: [0, 0, 1.0], distance: 0.2, time: 5.0}
initial: {rate: 0.2}
"""


@pytest.fixture(scope='module')
def struck(tmp_path_factory):
    """Return the numbers of the report, its text and its page."""
    pytest.importorskip('plotly')
    path = tmp_path_factory.mktemp('struck')
    (path / 'bar.yaml').write_text(SCENE)
    assert simulate(['--scene', str(path / 'bar.yaml'), '--duration', '1', '--rate', '200',
                     '--output', str(path / 'run')]) == 0
    [found], _ = analyze(path / 'run', path / 'report')
    return found, (path / 'report/report.txt').read_text(), (
        path / 'report/report.html').read_text()


def test_energy_is_told_for_each_stretch_between_strikes(struck):
    found, text, _ = struck
    levels = found['energy']['levels']
    assert [(level['from'], level['begun_by']) for level in levels] == [
        (0.0, ''), (0.3, 'strike'), (0.7, 'strike')]
    values = [level['value'] for level in levels]
    assert min(abs(b - a) for a, b in itertools.pairwise(values)) > 0.1
    assert found['energy']['largest_residual'] < 1e-12
    line = next(line for line in text.splitlines() if line.startswith('  energy'))
    for value, time in zip(values, ('0 s on', '0.3 s on (strike)', '0.7 s on (strike)'),
                           strict=True):
        assert f'{value:.9g} J from {time}' in line
    assert 'within each drift' in line


def test_strikes_are_marks_and_are_counted_with_the_events(struck):
    found, text, page = struck
    assert found['strikes'] == 2        # the third comes after the end
    assert re.search(r'events   .*2 x strike', text)
    assert page.count('<td>strike</td><td>strike</td>') == 2
    assert 'Kept within each of 3 stretches:</b>' in page
    assert 'It is changed by strikes between them.' in page


def test_so_is_energy_that_commands_and_resets_change(tmp_path):
    made.record(tmp_path / 'run', 'tennis_racket', 400, acts={
        100: [('cmd_impulse', (0.0, 0.0, 0.0), (0.5, 0.0, 0.0), 'world')], 300: [('reset',)]})
    [found], _ = analyze(tmp_path / 'run', tmp_path / 'report', short=True)
    levels = found['energy']['levels']
    assert [level['begun_by'] for level in levels] == ['', 'commands', 'reset']
    assert levels[0]['value'] == levels[2]['value'] != levels[1]['value']


def test_energy_that_nothing_changes_has_one_level(tmp_path):
    made.record(tmp_path / 'run', 'tennis_racket', 50)
    [found], _ = analyze(tmp_path / 'run', tmp_path / 'report', short=True)
    assert found['energy']['stretches'] == 1
    assert 'stretches' not in (tmp_path / 'report/report.txt').read_text()


def test_a_level_ends_where_a_wrench_is_held(tmp_path):
    """Energy moves from 0.1 to 0.15 s; no level may be said to last until 0.15 s."""
    torque = (0.0, 0.3, 0.0)
    made.record(tmp_path / 'run', 'tennis_racket', 300, acts={
        100: [('cmd_wrench', (0.0, 0.0, 0.0), torque, 'body')],
        150: [('cmd_wrench', (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 'body')],
        200: [('cmd_impulse', (0.0, 0.0, 0.0), torque, 'body')]})
    [found], _ = analyze(tmp_path / 'run', tmp_path / 'report', short=True)
    levels = found['energy']['levels']
    assert [(level['from'], level['until']) for level in levels] == [
        (0.0, 0.1), (0.15, 0.2), (0.2, None)]
    text = (tmp_path / 'report/report.txt').read_text()
    assert ' from 0 to 0.1 s, ' in text and ' from 0.15 s on (commands), ' in text
    assert re.search('  L        within each of 3 stretches drift', text)


def test_the_last_level_ends_where_a_wrench_is_held_to_the_end(tmp_path):
    made.record(tmp_path / 'run', 'tennis_racket', 200, acts={
        100: [('cmd_wrench', (0.0, 0.0, 0.0), (0.0, 0.3, 0.0), 'body')]})
    analyze(tmp_path / 'run', tmp_path / 'report', short=True)
    assert ' from 0 to 0.1 s; within each ' in (tmp_path / 'report/report.txt').read_text()
