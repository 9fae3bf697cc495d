# SPDX-License-Identifier: Apache-2.0
"""How a trial searches for its tolerance, with errors that are made up or known by hand."""

import math

import numpy as np
import pytest
from choice.known_bodies import SLOW, TORQUE, coasting_scene
from near import near

from rigid_body_sim.choice import comparison, runs, trial, trial_runs, trial_time
from rigid_body_sim.choice.trial import Trial
from rigid_body_sim.integrators.marching.work import TooMuchWork
from rigid_body_sim.scene.scene import parse_scene

HERE = 2.0 ** -30


def made(accuracy=1e-11, horizon=6.0, promised=1e-12, patience=1, others=True, effects=TORQUE):
    scene = parse_scene(SLOW.replace('EFFECTS', effects))
    return Trial(scene, accuracy, horizon, 'dop8', promised, patience, others)


@pytest.fixture
def tried():
    """Return a Trial whose tolerances are 2^-40 to 2^-10."""
    one = made()
    one._finest, one._coarsest = 2.0 ** -40, 2.0 ** -10
    return one


def at(angle, rate=3.0, velocity=0.0):
    """Return states at looks that are turned about z by an angle (rad), all alike."""
    states = np.zeros((runs.LOOKS, 14))
    states[:, 3], states[:, 4] = math.sin(0.5 * angle), math.cos(0.5 * angle)
    states[:, 7], states[:, 11] = rate, velocity
    return states


@pytest.mark.parametrize(('at', 'horizon', 'blind'), [
    (7.0, 100.0, False), (9.47, 100.0, False), (9.48, 100.0, True), (12.0, 100.0, True),
    (8.99, 9.0, False)])
def test_behind_the_end_of_a_trial_nobody_knows_what_a_change_does(at, horizon, blind,
                                                                   monkeypatch):
    """Four of 64 looks after the last change tell how it goes on.

    The fourth last one is at 0.948 of ten trials.

    So it is unless the trial goes to the horizon.
    """
    monkeypatch.setattr(trial_time, 'RADIANS', 3.0)
    one = Trial(coasting_scene((at, 1e-9)), 1e-9, horizon, 'dop8', 1e-12, 1, True)
    monkeypatch.setattr(one, 'tolerance_from', lambda tolerance: 2.0 ** -20)
    assert one._sees_no_end == blind
    assert one.take(1e-3) == 2.0 ** (-23 if blind else -20)
    monkeypatch.setattr(one, '_errors', lambda *_: np.full(runs.LOOKS, 1e-9))
    told = one.forecast(2.0 ** -20)
    assert (told == (None, None)) == blind


def test_after_a_change_errors_go_on_as_they_do_since_then(monkeypatch):
    """A torque speeds a body up from 8 of 16 s on, from rest: its errors go with its angle."""
    scene = coasting_scene(effects=('torque: {times: [8], values: [[0, 0, 4]], frame: body}',))
    one = Trial(scene, 1e-9, 16.0, 'dop8', 1e-12, 1, True)
    one._times, one._longer, one._horizon = runs.looks(16.0), 2.0, 32.0
    since = np.maximum(0.0, one._times - 8.0)
    states = np.zeros((runs.LOOKS, 14))
    states[:, 7] = since
    # three times the time since then: nine times the angle; half of the looks end near 12 s
    assert one._later(states, since ** 2) == near(9.0 * 64.0, rel=0.03)
    # what the run has from before is not multiplied again: it grows with the whole run
    assert one._later(states, np.full(runs.LOOKS, 5.0)) == 10.0
    one._longer = 1.0
    assert one._later(states, since ** 2) == 64.0


@pytest.mark.parametrize(('horizon', 'patience', 'others', 'radians', 'most'), [
    # twenty steps a radian: at a rate of 3 rad/s, and at most ten times 20,000 rad of them
    (10.0, 1, True, 30.0, 5000 + 600), (1e9, 1, True, 2e4, 5000 + 400_000),
    (10.0, 16, True, 30.0, 16 * 5600), (10.0, 1, False, 30.0, 16 * 5600)])
def test_a_run_may_take_as_many_steps_as_the_motion_asks_for(
        horizon, patience, others, radians, most):
    one = Trial(coasting_scene(), 1e-11, horizon, 'dop8', 1e-12, patience, others)
    assert one._radians == near(radians, rel=1e-12)
    assert one._most == most
    assert one._longer == near(3.0 * horizon / radians, rel=1e-12)


def test_the_angle_of_a_trial_counts_what_a_drive_and_a_strike_add():
    driven = coasting_scene(effects=('torque: {value: [0, 0, 2], frame: body}',))
    one = Trial(driven, 1e-11, 4.0, 'dop8', 1e-12, 1, True)
    assert one._radians == near(3.0 * 4.0 + 0.5 * 0.5 * 16.0, rel=1e-12)
    struck = coasting_scene((1.0, 8.0))    # 8 N s at 1 m: 8 N m s on 4 kg m^2, in z
    one = Trial(struck, 1e-11, 4.0, 'dop8', 1e-12, 1, True)
    assert one._radians == near((3.0 + 2.0) * 4.0, rel=1e-12)


@pytest.mark.parametrize(('method', 'finest', 'coarsest'), [
    ('dop8', 2.0 ** -30, 2.0 ** -20), ('gauss16', 2.0 ** -35, 2.0 ** -25),
    ('taylor', 2.0 ** -30, 2.0 ** -20)])
def test_tolerances_are_those_that_were_measured_of_the_method_or_else_of_dop8(
        method, finest, coarsest, monkeypatch):
    monkeypatch.setattr(trial_runs.measured, 'rows', lambda _: {
        'dop8': [{'tolerance': 2.0 ** -20}, {'tolerance': 2.0 ** -30}],
        'gauss16': [{'tolerance': 2.0 ** -25}, {'tolerance': 2.0 ** -35}]})
    one = Trial(parse_scene(SLOW.replace('EFFECTS', TORQUE)), 1e-9, 6.0, method, 1e-12, 1, True)
    assert (one._finest, one._coarsest) == (finest, coarsest)


@pytest.mark.parametrize(('tolerance', 'expected'), [
    (2.0 ** -20, -20), (1.99 * 2.0 ** -20, -20), (2.0 ** -41, -40), (0.0, -40), (1.0, -10)])
def test_tolerances_are_powers_of_two_within_those_of_the_table(tolerance, expected, tried):
    assert tried._grid(tolerance) == 2.0 ** expected


@pytest.mark.parametrize(('radians', 'factor'), [(1.0, 2.0), (100.0, 2.0), (400.0, 0.5)])
def test_a_body_that_turns_far_is_likely_to_need_a_finer_tolerance(radians, factor, tried):
    tried._radians = radians
    assert tried._likely(1e-9) == near(factor * 1e-9, rel=1e-12)


@pytest.mark.parametrize(('error', 'good', 'bad', 'expected'), [
    # the aim is 0.22e-11; errors go with the power 1.1 until two are known
    (0.22e-11, None, None, -20), (0.22e-11 * 2.0 ** 8.8, None, None, -28),
    (0.22e-11 * 2.0 ** -5.5, None, None, -15), (0.0, None, None, -10), (1e9, None, None, -32),
    (0.22e-11 * 2.0 ** 8, (2.0 ** -24, 1e-13), (2.0 ** -20, 1.6e-12), -28),
    # powers of 0.1 and of 4 are not believed: a half and two are the bounds
    (0.22e-11 * 2.0 ** 4, (2.0 ** -30, 1e-13), (2.0 ** -20, 2e-13), -28),
    (0.22e-11 * 2.0 ** 8, (2.0 ** -24, 1e-13), (2.0 ** -20, 1e-13 * 2.0 ** 16), -24),
    (0.22e-11 * 2.0 ** 8.8, (2.0 ** -24, 0.0), (2.0 ** -20, 1e-12), -28)])
def test_the_next_tolerance_is_the_nearest_one_that_gives_the_aim(error, good, bad, expected,
                                                                  tried):
    assert tried._next(2.0 ** -20, error, good, bad) == 2.0 ** expected


@pytest.mark.parametrize('power', [0.9, 1.1, 1.5])
@pytest.mark.parametrize('factor', [1e-9, 1e-4, 1.0, 1e2])
def test_a_tenth_to_a_half_of_the_accuracy_is_spent(power, factor, tried, monkeypatch):
    tried._finest, asked = 2.0 ** -60, []
    monkeypatch.setattr(tried, '_error', lambda one: asked.append(one) or factor * one ** power)
    monkeypatch.setattr(tried, '_rounding', lambda one: 0.0)
    found = tried.tolerance_from(1e-9)
    error = factor * found ** power
    assert error <= 0.5e-11 and (error >= 0.1e-11 or found == 2.0 ** -10)
    assert len(asked) == len(set(asked)) <= trial.TRIES


def test_an_error_that_may_be_rounding_ends_the_search(tried, monkeypatch):
    """Ten times the rounding of the angle turned: here of four numbers, and of 3 rad/s in 4 s."""
    tried._scene, tried._times = coasting_scene(), runs.looks(4.0)
    monkeypatch.setattr(tried, '_states', lambda _: at(0.0))
    rounded = 10.0 * 16.0 * 2.0 ** -53
    assert tried._rounding(2.0 ** -49) == near(rounded, rel=1e-15)
    assert tried._rounding(2.0 ** -48) == 0.0
    tried._accuracy, asked = 1e-18, []
    monkeypatch.setattr(tried, '_rounding', lambda _: rounded)
    monkeypatch.setattr(tried, '_error', lambda one: asked.append(one) or rounded)
    assert [tried.tolerance_from(HERE)] == asked


@pytest.mark.parametrize(('errors', 'patience', 'taken'), [
    # the error of each run, rad; where a finer one takes too much work, what works is taken
    ([0.05e-11, None], 1, 0), ([1e-8, None], 16, 0), ([0.5, None], 1, 0),
    ([1e-8, None], 1, None), ([None], 16, None),
    # what was seen last is kept where nothing tells the error of a finer run
    (['unknown'], 1, 0), ([1e-8, 'unknown'], 1, 0)])
def test_a_search_that_takes_too_much_work_ends(errors, patience, taken, tried, monkeypatch):
    asked = []

    def error(tolerance):
        asked.append(tolerance)
        found = errors[len(asked) - 1]
        if found is None:
            raise TooMuchWork('too many steps')
        return None if found == 'unknown' else found
    tried._patience = patience
    monkeypatch.setattr(tried, '_error', error)
    monkeypatch.setattr(tried, '_rounding', lambda one: 0.0)
    if taken is None:
        with pytest.raises(TooMuchWork):
            tried.tolerance_from(HERE)
    else:
        assert tried.tolerance_from(HERE) == asked[taken]
    assert len(asked) == len(errors)
    # with more patience the coarsest one is the first
    assert (asked[0] == 2.0 ** -10) == (patience > 1)


@pytest.mark.parametrize(('errors', 'taken'), [
    # shares of the accuracy; a tenth to a half of it is taken
    ([0.15], 0), ([0.45], 0), ([0.55, 0.2], 1),
    # hardly less with a finer tolerance: rounding that the motion magnifies; the coarser one does
    ([10.0, 9.0, 8.5], 0), ([10.0, 6.0, 5.5], 1),
    # what is asked is met, if only just
    ([1.5, 1.0], 1)])
def test_a_search_ends_where_finer_tolerances_help_no_more(errors, taken, tried, monkeypatch):
    asked, left = [], iter(errors)
    monkeypatch.setattr(tried, '_error', lambda one: asked.append(one) or next(left) * 1e-11)
    monkeypatch.setattr(tried, '_rounding', lambda one: 0.0)
    assert tried.tolerance_from(HERE) == asked[taken]
    assert len(asked) == len(errors)


def test_a_search_ends_at_the_finest_tolerance(tried, monkeypatch):
    tried._finest, asked = 2.0 * HERE, []
    monkeypatch.setattr(tried, '_error', lambda one: asked.append(one) or 0.1)
    monkeypatch.setattr(tried, '_rounding', lambda one: 0.0)
    assert [tried.tolerance_from(HERE)] == asked == [2.0 * HERE]


@pytest.mark.parametrize(('promised', 'told'), [
    (1e-11, (1e-11, 6.0)), (1.1e-11, (1.1e-11, 0.0)), (None, (None, None))])
def test_where_no_run_tells_an_error_it_is_what_the_table_promises(promised, told, tried,
                                                                   monkeypatch):
    """There is no finer run to compare with, and beside the coarsest one no coarser one."""
    tried._promised = promised
    monkeypatch.setattr(tried, '_states', lambda tolerance: at(tolerance))
    monkeypatch.setattr(tried, '_reference', lambda _: None)
    assert tried.forecast(2.0 ** -10) == told
    assert tried._errors(2.0 ** -10, 2.0 ** -11) == near([2.0 ** -11] * runs.LOOKS, rel=1e-9)


@pytest.mark.parametrize(('more', 'fails', 'ends'), [
    (10.0, False, [600.0]), (10.1, False, []), (10.0, True, [600.0, 6.0])])
def test_a_trial_goes_on_to_the_horizon_where_heat_lets_the_body_turn_little(
        more, fails, ends, tried, monkeypatch):
    """Up to ten times the angle; where rest takes too many steps it ends where it would have."""
    tried._horizon, begun = 600.0, []

    def states(tolerance):
        if fails and begun:
            raise TooMuchWork('too many steps')
    monkeypatch.setattr(tried, '_states', states)
    monkeypatch.setattr(trial_runs.forecast, 'turned_later', lambda *_: more)
    monkeypatch.setattr(tried, '_begin', lambda *settings: begun.append(settings))
    tried._go_on(6.0, 4.0)
    assert begun == [(end, more * 4.0 if end == 600.0 else 4.0) for end in ends]


@pytest.mark.parametrize(('error', 'least', 'lost', 'expected'), [
    (None, math.inf, 0.0, math.inf), (1e-11, math.inf, 0.0, 0.0), (2e-11, 2e-11, 1.0, 2e-11),
    # a tenth of what runs differ by, here 1e-10
    (2e-11, math.inf, 0.9e-11, 2e-11), (2e-11, math.inf, 1.1e-11, 0.0),
    (2e-11, 2.1e-11, 1.1e-11, 0.0), (2e-11, math.inf, None, 0.0)])
def test_another_method_may_do_better_where_rounding_does_not_excuse_an_error(
        error, least, lost, expected, tried, monkeypatch):
    growing = np.linspace(0.5, 1.0, runs.LOOKS)

    def rounded(scene, prototype, times, states, enough):
        assert enough == near(1e-11, rel=1e-15)
        if lost is None:
            raise TooMuchWork('too many steps')
        return lost * growing
    monkeypatch.setattr(tried, '_error', lambda _: error)
    monkeypatch.setattr(tried, '_reference', lambda _: HERE / 128.0)
    monkeypatch.setattr(tried, '_states', lambda _: at(0.0))
    monkeypatch.setattr(tried, '_apart', lambda *_: 1e-10 * growing)
    monkeypatch.setattr(trial_runs.rounding, 'lost', rounded)
    assert tried.excess(HERE, least) == 0.0    # it was not tried
    tried._runs = {HERE: at(0.0)}
    assert tried.excess(HERE, least) == expected


@pytest.mark.parametrize(('begin', 'taken'), [
    # four that are finer; two at least, be they coarser than a quarter
    (HERE / 128.0, [-7, -6, -5, -4]), (HERE / 32.0, [-5, -4, -3, -2]), (HERE / 4.0, [-2, -1]),
    # those that take the steps of the run itself do not count, nor those that take too much work
    (HERE / 2.0, [-1, 1]), (4.0 * HERE, [2, 3]), (8.0 * HERE, [3]),
    (HERE / 1024.0, [-7, -6, -5, -4])])
def test_a_mean_is_of_four_finer_runs_or_of_two_about_as_fine(begin, taken, tried, monkeypatch):
    def states(tolerance):
        if tolerance < HERE / 128.0:
            raise TooMuchWork('too many steps')
        return at(tolerance)
    monkeypatch.setattr(tried, '_states', states)
    found = tried._around(begin, HERE)
    assert [one[0, 3] for one in found] == [at(HERE * 2.0 ** k)[0, 3] for k in taken]


def test_a_run_that_begins_later_has_the_first_state_of_a_finer_one(tried, monkeypatch):
    tried._scene, begun = coasting_scene(), np.linspace(0.0, 1.0, runs.LOOKS)
    states, able = at(0.0), True
    states[:, 0] = tried._times

    def run(scene, prototype, start, times, over):
        if not able:
            raise TooMuchWork('too many steps')
        assert start[0] == over == tried._times[0]
        assert prototype.accuracy == HERE / 4.0
        return np.array([at(turned)[0] for turned in begun])
    monkeypatch.setattr(tried, '_states', lambda _: states)
    monkeypatch.setattr(runs, 'run', run)
    assert tried._beside_one_begun_later(HERE, HERE / 4.0) == near(begun, rel=1e-12)
    able = False
    assert tried._beside_one_begun_later(HERE, HERE / 4.0).tolist() == [0.0] * runs.LOOKS


@pytest.mark.parametrize(('shares', 'begins', 'told'), [
    (3.9, 0.0, 1.0), (4.1, 0.0, 4.1), (math.inf, 0.0, 1.0), (8.0, 1.9, 8.0), (8.0, 2.1, 1.0)])
@pytest.mark.parametrize('finer', [None, HERE / 128.0])
def test_a_run_begun_later_tells_where_it_is_more_than_four_times_as_far(
        shares, begins, told, finer, tried, monkeypatch):
    """Finer runs may share its rounding. What rounding does is asked of the finest run.

    It is more than four times what the rounding of its own start does, too.
    """
    tried._scene, tried._longer, asked = coasting_scene(), 1.0, []
    growing = np.linspace(0.5, 1.0, runs.LOOKS)
    monkeypatch.setattr(tried, '_reference', lambda _: finer)
    monkeypatch.setattr(tried, '_below', lambda *_: finer)
    monkeypatch.setattr(tried, '_states', lambda tolerance: at(0.0, tolerance))
    monkeypatch.setattr(tried, '_errors', lambda *_: 1e-10 * growing)
    monkeypatch.setattr(tried, '_around', lambda *_: [])
    monkeypatch.setattr(tried, '_beside_one_begun_later', lambda *settings: (
        asked.append(settings), shares * 1e-10 * growing)[1])
    monkeypatch.setattr(tried, '_lost_as_it_begins', lambda one: (
        asked.append(one), begins * 1e-10)[1])
    monkeypatch.setattr(trial_runs.rounding, 'lost', lambda scene, prototype, times, states: (
        asked.append(states[0, 7]), 1e-12 * growing)[1])
    monkeypatch.setattr(trial_runs.rounding, 'of_angle_turned', lambda *_: np.zeros(runs.LOOKS))
    assert tried.forecast(HERE).error == near(told * 1e-10, rel=1e-12)
    where = finer or HERE
    assert asked == [where, (HERE, where), *[where] * (4.0 < shares < math.inf)]


@pytest.mark.parametrize('ran', [False, True])
def test_where_all_that_was_tried_is_bad_the_finest_that_ran_is_taken(ran, tried, monkeypatch):
    """The next one may have run beside one that was tried, to tell its error."""
    tried._finest, asked = 2.0 ** -100, []

    def error(tolerance):
        asked.append(tolerance)
        return 0.2 * (tolerance / asked[0]) ** 0.4
    monkeypatch.setattr(tried, '_error', error)
    monkeypatch.setattr(tried, '_rounding', lambda one: 0.0)
    tried._runs = {2.0 ** -k: None for k in range(101)} if ran else {}
    found = tried.tolerance_from(HERE)
    assert len(asked) == trial.TRIES and asked == sorted(asked, reverse=True)
    assert found < min(asked) if ran else found == min(asked)


@pytest.mark.parametrize(('radians', 'promised', 'flies', 'slim', 'tried_at_all'), [
    (3.0, 1e-11, False, False, False), (3.1, 1e-11, False, False, True),
    (3.0, 1.1e-11, False, False, True), (3.0, 1e-11, True, False, True),
    (3.0, 1e-11, False, True, True)])
def test_a_body_that_turns_little_gets_an_eighth_of_the_tolerance_of_the_table(
        radians, promised, flies, slim, tried_at_all, tried, monkeypatch):
    tried._radians, tried._promised, tried._flies = radians, promised, flies
    monkeypatch.setattr(trial, '_slim', lambda scene: slim)
    monkeypatch.setattr(tried, 'tolerance_from', lambda tolerance: ('searched', tolerance))
    assert tried.take(HERE) == (('searched', HERE) if tried_at_all else HERE / 8.0)


@pytest.mark.parametrize(('moments', 'slim'), [
    ('[1, 10, 10]', False), ('[1, 10.1, 10]', True), ('[4, 4, 4]', False)])
def test_slim_are_moments_that_differ_more_than_tenfold(moments, slim):
    scene = parse_scene(SLOW.replace('EFFECTS', TORQUE).replace('[1.0, 2.0, 3.0]', moments))
    assert trial._slim(scene) == slim


@pytest.mark.parametrize(('effects', 'flies'), [
    (TORQUE, False), ('gravity: {g: 9.81}', True), ('', False),
    (f'{TORQUE}, force: {{value: [1, 0, 0]}}', True)])
def test_only_forces_make_a_body_fly(effects, flies):
    assert trial_runs._flies(parse_scene(SLOW.replace('EFFECTS', effects))) == flies


@pytest.mark.parametrize(('error', 'misses'), [
    (1e-11, False), (1.1e-11, True), (0.9e-5, True), (1e-5, False), (None, False)])
def test_a_run_misses_by_what_is_not_magnified(error, misses, tried, monkeypatch):
    monkeypatch.setattr(tried, '_error', lambda _: error)
    assert not tried.misses(HERE)    # it was not tried
    tried._runs[HERE] = at(0.0)
    assert tried.misses(HERE) == misses


def test_momenta_count_a_tenth_and_velocities_of_a_body_that_flies_too(tried):
    tried._scene = coasting_scene()
    tried._runs = {HERE: at(1e-9), HERE / 2.0: at(0.0, 3.0 * (1.0 + 1e-6)),
                   HERE / 4.0: at(0.0, 3.0, 1.0), HERE / 8.0: at(0.0, 3.0, 1.0 + 1e-5),
                   HERE / 16.0: at(1e-3)}

    def apart(one, other):
        return tried._apart(HERE / one, HERE / other)
    assert apart(1, 16) == near([1e-3 - 1e-9] * runs.LOOKS, rel=1e-9)
    assert apart(1, 2) == near([1e-7] * runs.LOOKS, rel=1e-5)
    assert apart(4, 8).max() == 0.0
    tried._flies = True
    assert apart(4, 8) == near([1e-6] * runs.LOOKS, rel=1e-5)


def test_shares_of_what_rests_by_the_first_look_are_those_of_the_start(tried):
    """It turned at 3 rad/s, and 1e-17 are left; then it moved at 2 m/s, twice what is left."""
    tried._scene = coasting_scene()
    tried._runs = {HERE: at(0.0, 1e-17, 1.0), HERE / 2.0: at(0.0, 3e-17, 1.0 + 1e-5)}
    assert tried._apart(HERE, HERE / 2.0) == near([2e-18 / 3.0] * runs.LOOKS, rel=1e-9)
    tried._flies, (momentum, speed) = True, tried._at_start
    assert speed == 0.0
    tried._at_start = momentum, 2.0
    assert tried._apart(HERE, HERE / 2.0) == near([5e-7] * runs.LOOKS, rel=1e-5)


def test_the_momenta_of_a_run_are_formed_once(tried, monkeypatch):
    formed, momenta = [], comparison.momenta
    monkeypatch.setattr(comparison, 'momenta', lambda scene, states: (
        formed.append(len(states)), momenta(scene, states))[1])
    tried._scene, tried._runs = coasting_scene(), {HERE: at(1e-9), HERE / 2.0: at(0.0)}
    for _ in range(2):
        tried._apart(HERE, HERE / 2.0)
    assert formed == [1, runs.LOOKS, runs.LOOKS]    # first that of the start


def test_the_finer_run_is_the_finest_that_work_allows(tried, monkeypatch):
    able, asked = [], []

    def states(tolerance):
        asked.append(tolerance)
        if tolerance not in able:
            raise TooMuchWork('too many steps')
    monkeypatch.setattr(tried, '_states', states)
    for share in (2.0 ** -7, 2.0 ** -4, 2.0 ** -2):
        able[:] = [share * HERE]
        assert tried._reference(HERE) == share * HERE
    able.clear()
    assert tried._reference(HERE) is None
    assert asked[-3:] == [2.0 ** -7 * HERE, 2.0 ** -4 * HERE, 2.0 ** -2 * HERE]
    # what was run is used, where it is fine enough
    tried._runs = {HERE / 8.0: None, HERE / 16.0: None, HERE / 64.0: None}
    assert tried._reference(HERE) == HERE / 16.0


def test_where_only_a_coarser_run_tells_the_middle_is_told(tried, monkeypatch):
    turned = {HERE: 0.0, 8.0 * HERE: 8e-9, HERE / 8.0: 3e-9}
    monkeypatch.setattr(tried, '_states', lambda tolerance: at(turned[tolerance]))
    assert tried._errors(HERE, None) == near([8e-9 / math.sqrt(8.0)] * runs.LOOKS, rel=1e-7)
    assert tried._errors(HERE, HERE / 8.0) == near([3e-9] * runs.LOOKS, rel=1e-7)


def test_a_finer_run_that_differs_by_less_than_its_own_error_is_not_enough(tried, monkeypatch):
    tried._finest = 2.0 ** -60
    turned = {HERE: 0.0, HERE / 128.0: HERE / 129.0, HERE / 2.0 ** 14: HERE / 127.0}
    monkeypatch.setattr(tried, '_states', lambda tolerance: at(turned.get(tolerance, 0.0)))
    assert tried._below(HERE / 128.0, HERE) == HERE / 2.0 ** 14
    turned[HERE / 128.0] = HERE / 127.0
    assert tried._below(HERE / 128.0, HERE) == HERE / 128.0
    states = at(0.0)    # the largest difference counts
    states[-1] = at(HERE / 127.0)[-1]
    monkeypatch.setattr(tried, '_states', lambda one: at(0.0) if one == HERE else states)
    assert tried._below(HERE / 128.0, HERE) == HERE / 128.0


@pytest.mark.without_numba
def test_errors_that_a_run_allows_itself_count_from_then_on(monkeypatch):
    one = made(accuracy=1e-8)
    finer = one._reference(HERE)
    since = float(one._times[runs.LOOKS // 2])
    for allowed in ((HERE, 1e-7, since), (finer, 1e-7, since), (2.0 * HERE, 1e-3, 0.0)):
        one._allowed = [allowed]
        found = one.forecast(HERE)
        if allowed[0] > HERE:    # another run
            assert found.error < 1e-8 and found.met_until == 6.0
        else:
            assert found.error == 1e-7
            assert found.met_until == one._times[runs.LOOKS // 2 - 1]
    assert comparison.apart(one._states(HERE), one._states(finer)).max() < 1e-8


@pytest.mark.parametrize(('error', 'lost', 'longer', 'told', 'around'), [
    # up to 1024 times what rounding does an error may be rounding: the mean of finer runs tells
    (1000e-12, 1e-12, 1.0, 500e-12, True), (1050e-12, 1e-12, 1.0, 1050e-12, False),
    (1e-9, 2e-9, 1.0, 2e-9, True),
    # either grows in proportion to time
    (1050e-12, 1e-12, 3.0, 3150e-12, False), (1e-9, 2e-9, 3.0, 6e-9, True),
    # what is magnified to 1e-5 shows in the errors themselves: rounding is not asked
    (0.9e-5, 1e-3, 1.0, 1e-3, True), (1e-5, 1e-3, 1.0, 1e-5, False),
    (math.inf, 1e-3, 1.0, 1e-12, False)])    # told by the table
def test_the_larger_of_error_and_rounding_is_told(error, lost, longer, told, around, tried,
                                                  monkeypatch):
    """The largest of all looks counts."""
    tried._scene, tried._longer, asked = coasting_scene(), longer, []
    growing = np.linspace(0.5, 1.0, runs.LOOKS)
    monkeypatch.setattr(tried, '_reference', lambda _: HERE / 128.0)
    monkeypatch.setattr(tried, '_below', lambda *_: HERE / 128.0)
    monkeypatch.setattr(tried, '_states', lambda _: at(0.0))
    monkeypatch.setattr(tried, '_errors', lambda *_: error * np.ones(runs.LOOKS))
    monkeypatch.setattr(tried, '_around', lambda *_: asked.append(None) or 'finer')
    monkeypatch.setattr(tried, '_beside_one_begun_later', lambda *_: np.zeros(runs.LOOKS))
    monkeypatch.setattr(trial_runs.rounding, 'lost', lambda *_: lost * growing)
    monkeypatch.setattr(trial_runs.rounding, 'of_angle_turned', lambda *_: np.zeros(runs.LOOKS))
    monkeypatch.setattr(
        trial_runs.comparison, 'apart_from_mean', lambda *_: 0.5 * error * growing[::-1])
    found = tried.forecast(HERE)
    assert found.error == near(told, rel=1e-12)
    assert bool(asked) == around


def test_where_rounding_is_small_the_angle_turned_tells_what_the_start_does(tried, monkeypatch):
    tried._scene, tried._longer = coasting_scene(), 3.0
    monkeypatch.setattr(tried, '_reference', lambda _: HERE / 128.0)
    monkeypatch.setattr(tried, '_below', lambda *_: HERE / 128.0)
    monkeypatch.setattr(tried, '_states', lambda _: at(0.0))
    monkeypatch.setattr(tried, '_errors', lambda *_: 1e-9 * np.ones(runs.LOOKS))
    monkeypatch.setattr(trial_runs.rounding, 'lost', lambda *_: 1e-15 * np.ones(runs.LOOKS))
    monkeypatch.setattr(
        trial_runs.rounding, 'of_angle_turned', lambda *_: 5e-9 * np.ones(runs.LOOKS))
    assert tried.forecast(HERE).error == near(15e-9, rel=1e-12)


def test_how_far_two_trials_are_apart_at_the_horizon(tried):
    other = made()
    tried._scene, tried._longer = coasting_scene(), 3.0
    tried._runs, other._runs = {HERE: at(0.0)}, {HERE / 2.0: at(1e-9)}
    assert tried.beside(HERE, other, HERE / 2.0) == near(3e-9, rel=1e-6)
