# SPDX-License-Identifier: Apache-2.0
"""A report says so where the error expected of a run is larger than the accuracy asked."""

import json

import pytest
from analysis import made

from rigid_body_sim.analysis import page
from rigid_body_sim.analysis.analyze import analyze
from rigid_body_sim.analysis.source import missed
from rigid_body_sim.recording import about

RUN = {'accuracy': 1e-12, 'horizon': 20.0, 'method': 'taylor'}
SAID = 'the accuracy asked, 1e-12 rad, is missed: the error expected within 20 s is 1.6e+00 rad'


@pytest.mark.parametrize(('told', 'said'), [
    ({'expected_error': 1.64, 'met_until': 3.25}, [f'{SAID}; it is met until 3.25 s']),
    ({'expected_error': 1.64, 'met_until': 0.0}, [f'{SAID}; it is met at no time']),
    ({'expected_error': 1.64}, [SAID]),
    ({'expected_error': 9e-13}, []),
    ({'expected_error': None}, [])])
def test_what_is_said_of_a_run(told, said):
    assert missed([{**RUN, **told}]) == said


def test_no_run_and_several():
    assert missed([{}]) == []
    good, bad = {**RUN, 'expected_error': 0.0}, {**RUN, 'expected_error': 1.64}
    assert missed([good, bad, bad]) == [SAID]


@pytest.mark.usefixtures('undrawn')
def test_text_and_page_say_it(tmp_path, monkeypatch):
    run_of = about.run_of
    monkeypatch.setattr(about, 'run_of', lambda simulation: {
        **run_of(simulation), 'expected_error': 0.5, 'met_until': 0.75})
    made.record(tmp_path / 'run', 'tennis_racket', 50)
    [found], _ = analyze(tmp_path / 'run', tmp_path / 'report')
    [line] = found['accuracy_missed']
    assert line.endswith('s is 5.0e-01 rad; it is met until 0.75 s')
    assert f'  accuracy {line}\n' in (tmp_path / 'report/report.txt').read_text()
    if page.available():
        shown = (tmp_path / 'report/report.html').read_text()
        assert f'<b>Note:</b> {line}.' in shown
        assert 'class="verdict bad"' in shown
    [body] = json.loads((tmp_path / 'report/report.json').read_text())['bodies']
    assert body['accuracy_missed'] == [line]
