# SPDX-License-Identifier: Apache-2.0
"""A run from a journal that is made by hand: its ticks, its stamps, and what is done at each."""

import json
import types

import numpy as np
import pytest

from rigid_body_sim.analysis import rerun as module
from rigid_body_sim.analysis.rerun import Rerun
from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.simulation.command_rows import rows_of
from rigid_body_sim.simulation.simulation import Simulation

pytestmark = pytest.mark.without_numba

SCENE, OTHER = load_scene('tennis_racket'), load_scene('heavy_top')
START = 5_000_000_000
ASKED = {'integrator': 'dop8', 'method': 'dop8', 'accuracy': 1e-9, 'tolerance': 1e-9,
         'expected_error': 1e-10, 'rate': 100.0, 'step': None, 'horizon': 60.0}
PUSH = [{'topic': 'cmd_impulse', 'frame': 'world', 'force': [0.0, 0.0, 0.0],
         'torque': [0.0, 0.01, 0.0]}]
HOLD = [{'topic': 'cmd_wrench', 'frame': 'body', 'force': [0.0, 0.0, 0.0],
         'torque': [0.0, 0.0, 0.02]}]


def changed(tick, scene=SCENE, keeps=True, **asked):
    return {'kind': 'parameters', 'tick': tick, 'changed': dict.fromkeys(asked or ['scene'], 0),
            'simulation': ASKED | asked, 'scene': scene.text, 'keeps_state': keeps}


def journal(*acts, asked=ASKED, **state):
    return [{'kind': 'begin'},    # of a recorder that knew nothing
            {'kind': 'begin', 'simulation': json.dumps(asked), 'scene': SCENE.text},
            {'kind': 'state', 'tick': 0, 'log_time': START + 7} | state, *acts]


def test_stamps_are_those_of_the_rates_at_their_ticks():
    """100 Hz up to tick 10, 200 Hz up to tick 16, then 50 Hz; ticks are found from stamps."""
    rerun = Rerun(journal(changed(10, rate=200.0), changed(13, accuracy=1e-8, rate=200.0),
                          changed(16, rate=50.0), stamp=START), {})
    ms = [0, 10, 90, 100, 105, 125, 130, 150, 170]
    ticks = [0, 1, 9, 10, 11, 15, 16, 17, 18]
    stamps = START + np.array(ms) * 1_000_000
    assert rerun.ticks(stamps).tolist() == ticks
    assert [rerun.stamp(tick) for tick in ticks] == stamps.tolist()
    assert rerun.ticks(stamps[-2:]).tolist() == [17, 18]
    assert rerun.ticks(stamps[:1]).tolist() == [0]
    for wrong in (stamps[4] + 1, stamps[1] - 2_000_000, stamps[7] + 9_000_000):
        for others in ([], [stamps[-1]], [stamps[0], stamps[-1]]):
            with pytest.raises(BadInput, match='between two ticks'):
                rerun.ticks(np.sort(np.array([wrong, *others])))


@pytest.mark.parametrize('ticks', [[-1], [10**12 + 1], [-1, 3], [3, 10**12 + 1]])
def test_stamps_before_the_first_tick_or_years_later_are_refused(ticks):
    rerun = Rerun(journal(stamp=START, asked=ASKED | {'rate': 1e6}), {})
    assert rerun.ticks(np.array([START, rerun.stamp(10**12)])).tolist() == [0, 10**12]
    with pytest.raises(BadInput, match='before its first tick, or years after it'):
        rerun.ticks(START + 1000 * np.array(ticks))


@pytest.mark.parametrize(('state', 'first_stamp', 'origin'), [
    ({'stamp': 70}, 10**9, 70), ({}, 10**9, 10**9), ({}, None, START + 7),
    # of a state that was noted later
    ({'tick': 3, 'stamp': START}, None, START - 30_000_000)])
def test_the_first_stamp_is_the_one_noted_or_given_or_the_log_time(state, first_stamp, origin):
    assert Rerun(journal(**state), {}, first_stamp).stamp(0) == origin


@pytest.mark.parametrize('left_out', ['begin', 'state'])
def test_without_a_begin_or_a_state_there_is_no_journal(left_out):
    entries = [entry for entry in journal() if entry['kind'] != left_out]
    with pytest.raises(BadInput, match='is missing'):
        Rerun(entries, {})


def by_hand():
    """Return the ticks of a run that is pushed, held, reset and given another step by hand."""
    simulation, states = Simulation(SCENE, 'dop8', 1e-9, 100.0, horizon=60.0), []

    def note(ticks):
        for _ in range(ticks):
            simulation.advance(1)
            states.append((simulation.vector.copy(), simulation.energy,
                           simulation.angular_momentum_squared))
    def again():
        states[-1] = (simulation.vector.copy(), simulation.energy,
                      simulation.angular_momentum_squared)
    states.append((simulation.vector.copy(), simulation.energy,
                   simulation.angular_momentum_squared))
    note(3)
    for rows in (PUSH, HOLD):
        simulation.forget_past()
        assert list(simulation.command(rows_of(rows))) == []
    again()
    note(4)
    simulation.reset()
    again()
    note(2)
    return states


ACTS = [{'kind': 'commands', 'tick': 3, 'commands': PUSH}, {'kind': 'other', 'tick': 1},
        {'kind': 'commands', 'tick': 3, 'commands': HOLD}, {'kind': 'reset', 'tick': 7}]


@pytest.mark.parametrize('stops', [[9], [0, 9], [2, 3, 7, 9], [5, 5, 8, 9]])
def test_each_tick_is_given_once_after_what_is_done_at_it(stops):
    rerun, expected, ticks = Rerun(journal(*ACTS), {}), by_hand(), []
    for stop in stops:
        if rerun.next_tick > stop:
            continue
        found, states, energies, squares = rerun.through(stop)
        for k, tick in enumerate(found.tolist()):
            vector, energy, square = expected[tick]
            assert states.vector[k].tolist() == vector.tolist()
            assert (energies[k], squares[k]) == (energy, square)
        ticks += found.tolist()
        assert rerun.next_tick == stop + 1
    assert ticks == list(range(10))


def test_ticks_that_nobody_asks_for_are_run_all_the_same():
    rerun, expected = Rerun(journal(*ACTS), {}), by_hand()
    rerun.skip_to(5)
    assert (rerun.simulation.tick, rerun.next_tick) == (5, 5)
    found, states, _, _ = rerun.through(6)
    assert found.tolist() == [5, 6]
    assert states.vector[:, 1:8] == pytest.approx(
        np.array([expected[tick][0][1:8] for tick in (5, 6)]), abs=1e-8)
    rerun.to(9)
    assert rerun.simulation.tick == 9


@pytest.mark.without_numba
@pytest.mark.parametrize(('keeps', 'scene'), [(True, SCENE), (False, OTHER)])
def test_parameters_of_a_simulation_make_another_one_that_goes_on(keeps, scene):
    other = {'kind': 'parameters', 'tick': 2, 'changed': {'command_timeout': 1},
             'simulation': ASKED}
    rerun = Rerun(journal(other, changed(4, scene, keeps, rate=50.0, integrator='rk4',
                                         step=0.005)), {})
    before = rerun.simulation
    rerun.to(3)
    assert rerun.simulation is before and not before.watching
    rerun.to(4)
    now = rerun.simulation
    assert (now is before, now.rate, now.scene.name, now.tick) == (False, 50.0, scene.name, 4)
    assert (now.vector[1:8].tolist() == before.vector[1:8].tolist()) is keeps
    assert (now.integrator, now.choice.step, now.watching) == ('rk4', 0.005, False)


def test_the_method_is_that_of_the_recording_or_another_one_that_holds_for_the_whole_run():
    auto = ASKED | {'integrator': 'auto', 'method': 'dop8'}
    recorded = Rerun(journal(asked=auto), {}).simulation
    assert (recorded.choice.method, recorded.choice.settled.tolerance) == ('dop8', 1e-9)
    asked = ASKED | {'integrator': 'rk4', 'step': 0.005}
    assert Rerun(journal(asked=asked), {}).simulation.choice.step == 0.005
    other = Rerun(journal(changed(2, integrator='rk4', step=0.01), asked=asked),
                  {'integrator': 'dop8', 'accuracy': 1e-6})
    for tick in (1, 2):
        other.to(tick)
        one = other.simulation
        assert (one.integrator, one.accuracy, one.choice.step) == ('dop8', 1e-6, None)


def test_a_command_that_was_taken_and_is_now_refused_ends_the_rerun():
    wrong = [PUSH[0] | {'torque': [float('nan'), 0.0, 0.0]}]
    rerun = Rerun(journal({'kind': 'commands', 'tick': 1, 'commands': wrong}), {})
    with pytest.raises(BadInput):
        rerun.to(2)


@pytest.mark.parametrize(('integrator', 'method', 'settled'), [
    ('auto', {}, True), ('exact', {}, True), ('dop8', {}, False),
    ('auto', {'accuracy': 1e-6}, False), ('auto', {'integrator': 'exact'}, False)])
def test_what_auto_chose_is_taken_again_where_nothing_else_is_asked_for(
        integrator, method, settled, monkeypatch):
    made = []
    monkeypatch.setattr(module, 'Simulation', lambda *of, **more: made.append(
        (of, more)) or types.SimpleNamespace(tick=0))
    asked = ASKED | {'integrator': integrator, 'method': 'taylor', 'step': 0.01}
    for given in ({}, {'met_until': 3.0}):
        made.clear()
        Rerun(journal(asked=asked | given), method)
        [(of, more)] = made
        assert of[1:] == (method.get('integrator', integrator), method.get('accuracy', 1e-9),
                          100.0, None if method else 0.01)
        assert more['horizon'] == 60.0
        assert (more['settled'] is not None) == settled
        if settled:
            forecast = more['settled'].forecast
            assert (more['settled'].method, more['settled'].tolerance) == ('taylor', 1e-9)
            assert forecast == (1e-10, given.get('met_until', 60.0))
