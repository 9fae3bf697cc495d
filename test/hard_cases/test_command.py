# SPDX-License-Identifier: Apache-2.0
"""The command `hard_cases`: table, JSON, exit status, peers; what a trend is."""

import json
import math

import numpy as np
import pytest

from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.study.hard_cases import hard_cases, trends
from rigid_body_sim.study.hard_cases.case import Case, Outcome, Question
from rigid_body_sim.study.hard_cases.table import of_group


@pytest.fixture
def few(monkeypatch):
    cases = [*of_group(2)[:2], *of_group(9)]
    monkeypatch.setattr(hard_cases, 'CASES', cases)
    return cases


def test_json_has_every_case(few, capsys):
    assert hard_cases.main(['--json']) == 0
    found = json.loads(capsys.readouterr().out)['cases']
    assert [row['case'] for row in found] == [case.name for case in few]
    assert all(row['good'] and row['error'] <= row['bound'] and row['why'] for row in found)


@pytest.mark.parametrize('error', [2.0, float('nan'), float('inf')])
def test_a_case_that_fails_is_said_and_is_the_exit_status(few, capsys, error):
    few.append(Case(
        9, 'made to fail', 'it must be seen', lambda: Outcome(error, 1.0, 'rad', 'none')))
    assert hard_cases.main([]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[-2].startswith('FAILS  commands     made to fail: ')
    assert lines[-1] == f'{len(few) - 1} of {len(few)} cases within their bounds'


def test_peers_stand_beside_ours_if_they_are_asked_for(few, monkeypatch, capsys):
    answers = {'first': 2.5e-3, 'second': 'refuses: no', 'third': ''}
    monkeypatch.setattr(hard_cases.beside, 'modules', lambda: (dict.fromkeys(answers), ['Drake']))
    given = iter(list(answers.values()) * 3)
    monkeypatch.setattr(hard_cases.beside, 'answer', lambda module, question: next(given))
    few[:] = [Case(9, 'made up', 'why', lambda: Outcome(0.5, 1.0, 'rad', 'none'),
                   Question(2.5, 'm/s', None)),
              Case(1, 'nothing to ask', 'why', lambda: Outcome(1.0, 1.0, 's', 'none'))]
    assert hard_cases.main(['--peers']) == 0
    assert capsys.readouterr().out.splitlines() == [
        'good   commands     made up: 5.0e-01 rad (bound 1.0e+00: none)',
        '           first after 2.5 s: 2.5e-03 m/s',
        '           second after 2.5 s: refuses: no',
        '           third after 2.5 s: not asked',
        'good   racket       nothing to ask: 1.0e+00 s (bound 1.0e+00: none)',
        'not installed here: Drake', '2 of 2 cases within their bounds']
    assert hard_cases.main(['--peers', '--json']) == 0
    found = json.loads(capsys.readouterr().out)
    assert found['peers_not_installed'] == ['Drake']
    assert [row['peers'] for row in found['cases']] == [answers, {}]
    assert (found['cases'][0]['peer_time'], found['cases'][0]['peer_unit']) == (2.5, 'm/s')
    assert hard_cases.main([]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 3


@pytest.mark.parametrize(('means', 'scatter', 'expected'), [
    ([1.0, 2.0, 3.0], 0.5, 2.0 * 2.0**0.5), ([3.0, 2.0, 1.0], 0.5, 2.0 * 2.0**0.5),
    ([1.0, 5.0, 1.0], 0.5, 0.0), ([0.0, 1.0, 2.0, 3.0, 4.0], 2.0, 2.5**0.5),
    ([2.0, 2.0, 2.0], 0.0, 0.0), ([1.0, 2.0, 3.0], 0.0, math.inf)])
def test_a_trend_is_a_slope_beyond_its_own_uncertainty(means, scatter, expected):
    """The places of the means are from -1 to 1: a slope of s/sqrt(sum of squares) is a sigma."""
    assert trends.slope_in_sigmas(np.array(means), scatter) == pytest.approx(expected, rel=1e-14,
                                                                            abs=1e-14)


@pytest.mark.without_numba
@pytest.mark.parametrize(('scene', 'momenta'), [
    ('free_body', {'L'}), ('heavy_top', {'p_alpha', 'p_gamma'})])
def test_residuals_of_an_exact_motion_are_roundings(scene, momenta):
    simulation = Simulation(scene)
    states = simulation.states(np.linspace(0.0, 3.0, 50))
    found = trends.residuals(simulation, states)
    assert set(found) == {'norm of q', 'energy', *momenta}
    for values in found.values():
        assert values.shape == (50,) and np.abs(values).max() < 1e-14    # measured: 7e-16
    # and what is wrong by a part in a thousand is seen
    states.vector[1:, 5:8] *= 1.001
    wrong = trends.residuals(simulation, states)
    for name in momenta:
        assert np.ptp(wrong[name]) > 1e-4
