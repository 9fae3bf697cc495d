# SPDX-License-Identifier: Apache-2.0
"""How errors go on in time, and what is said of them."""

import math

import numpy as np
import pytest
from choice.known_bodies import SLOW, coasting_scene
from near import near

from rigid_body_sim.choice import comparison, forecast, runs
from rigid_body_sim.choice.choose import choose
from rigid_body_sim.choice.forecast import Forecast
from rigid_body_sim.choice.settling import Settled
from rigid_body_sim.scene.scene import load_scene, parse_scene
from rigid_body_sim.simulation.simulation import Simulation

TIMES = np.array([1.0, 2.0, 3.0, 4.0])


@pytest.mark.parametrize(('errors', 'accuracy', 'horizon', 'expected'), [
    ([1, 2, 3, 4], 5, 4, Forecast(4, 4)), ([1, 2, 3, 4], 4, 4, Forecast(4, 4)),
    ([1, 4, 3, 2], 4, 4, Forecast(4, 4)), ([1, 2, 3, 4], 5, 8, Forecast(8, 5)),
    ([1, 2, 3, 4], 5, 2, Forecast(4, 2)), ([1, 2, 3, 4], 2, 4, Forecast(4, 2)),
    ([1, 2, 3, 4], 2.5, 4, Forecast(4, 2)), ([1, 5, 3, 4], 4.5, 4, Forecast(5, 1)),
    ([1, 2, 3, 4], 0.5, 4, Forecast(4, 0.5)), ([0, 0, 9, 9], 1, 4, Forecast(9, 2)),
    ([1, 2, 3, math.inf], 2, 4, Forecast(math.inf, 2))])
def test_errors_grow_with_time_and_are_met_until_the_last_look_that_was_good(
        errors, accuracy, horizon, expected):
    found = forecast.forecast(np.array(errors, float), TIMES, accuracy, horizon)
    assert found == pytest.approx(expected)


@pytest.mark.parametrize(('errors', 'accuracy', 'horizon', 'error', 'met_until'), [
    ([1e-9, 2e-9, 3e-9, 4e-9], 1e-8, 4.0, 4e-9, 4.0),
    ([1e-9, 2e-9, 3e-9, 4e-9], 1e-8, 16.0, 1.6e-8, 10.0),    # in proportion to time
    ([1e-9, 2e-9, 3e-7, 1e-9], 1e-8, 4.0, 3e-7, 2.0),        # what was seen to be met
    ([4e-8, 5e-8, 6e-8, 7e-8], 1e-8, 4.0, 7e-8, 0.25),
    ([1e-9, math.inf, math.inf, math.inf], 1e-8, 4.0, math.inf, 1.0)])
def test_forecast_from_errors_on_the_way(errors, accuracy, horizon, error, met_until):
    found = forecast.forecast(np.array(errors), np.arange(1.0, 5.0), accuracy, horizon)
    assert found == pytest.approx((error, met_until))


def test_beyond_the_last_time_an_error_grows_evenly_to_that_at_the_horizon():
    found = forecast.forecast(np.array([1e-9, 2e-9]), np.array([1.0, 2.0]), 4e-9, 6.0, 10e-9)
    assert found == pytest.approx((10e-9, 3.0))


DRIVE = 'torque: {value: [0, 0, 1], frame: body}'
UNBOUNDED = 'torque: {value: [0, 0, "2*wz"], frame: body}'


@pytest.mark.parametrize(('rates', 'powers', 'effects', 'expected'), [
    # rates that grow with time from 0 turn a body by an angle that goes with its square
    (lambda t: t, 2.0, [DRIVE], 9.0), (lambda t: t, 3.0, [DRIVE], 27.0),
    (lambda t: t, 4.0, [DRIVE], 81.0), (lambda t: t, 6.0, [DRIVE], 81.0),
    (lambda t: 3.0 * t, 3.0, [DRIVE], 27.0),
    (lambda t: np.where(t < 0.7, t, math.inf), 2.0, [DRIVE], 3.0),
    (lambda t: t, 0.5, [DRIVE], 9.0), (lambda t: t, 2.0, [], 3.0),
    # a torque whose bound nobody knows drives, too
    (lambda t: t, 2.0, [UNBOUNDED], 9.0),
    # from a rate of 1 to 2 the rate is 4 at three times the time, the angle 6 times as large
    (lambda t: 1 + t, 1.0, [DRIVE], 6.0),
    # a rate that rises no more, or rose late, is not taken to rise
    (lambda t: np.minimum(t, 0.75), 2.0, [DRIVE], 3.0),
    (lambda t: np.maximum(t, 0.75), 2.0, [DRIVE], 3.0), (lambda t: 0 * t, 2.0, [DRIVE], 3.0)])
def test_errors_go_with_the_angle_or_its_square_where_a_drive_speeds_a_body_up(
        rates, powers, effects, expected):
    times = runs.looks(1.0)
    states = np.zeros((runs.LOOKS, 14))
    states[:, 7] = rates(times)
    found = forecast.later(coasting_scene(effects=effects), states, times ** powers, 3.0)
    assert found == pytest.approx(expected)


@pytest.mark.parametrize(('errors', 'longer', 'expected'), [
    # none in the first half: with the square of the angle, which goes with that of time
    (lambda t: np.maximum(t - 0.5, 0.0), 2.0, 0.5 * 16.0),
    (lambda t: np.maximum(t - 0.5, 0.0), 1.0, 0.5), (lambda t: t ** 3, 1.0, 1.0),
    (lambda t: 0.0 * t, 3.0, 0.0),
    (lambda t: np.where(t < 0.7, t, math.inf), 3.0, math.inf),
    # the largest of all, not the last
    (lambda t: np.where(t < 0.751, 4.0 * t, t), 1.0, 3.0)])
def test_errors_of_a_body_sped_up_from_rest(errors, longer, expected):
    times, states = runs.looks(1.0), np.zeros((runs.LOOKS, 14))
    states[:, 7] = times
    found = forecast.later(coasting_scene(effects=[DRIVE]), states, errors(times), longer)
    assert found == pytest.approx(expected)


@pytest.mark.parametrize(('turns_round', 'added'), [
    # 0.15 at half time, -0.2 at the end, in three quarters of the angle; 0.25 to 1 is growth
    (lambda t: t * (0.8 - t), 0.35 * 4.0 / 3.0), (lambda t: t * t, 1.0)])
def test_an_error_that_goes_through_0_grows_on_by_what_it_grew(turns_round, added):
    times, size = runs.looks(1.0), 1e-6
    states = np.zeros((runs.LOOKS, 14))
    states[:, 4], states[:, 7] = 1.0, times
    beside = states.copy()
    beside[:, 3] = 0.5 * size * turns_round(times)
    errors = size * np.abs(turns_round(times))
    found = forecast.later(coasting_scene(effects=[DRIVE]), states, errors, 2.0, beside)
    assert found == near(4.0 * size * added, rel=0.05)


SLOWER = 'drag: {linear: 0, angular: 1.0}'
GOES_ON = math.exp(-4.0 * runs.looks(1.0)[3 * runs.QUARTER])
OVER = 'torque: {times: [0, 1], values: [[0, 0, 1], [0, 0, 0]], frame: body}'


@pytest.mark.parametrize(('rates', 'effects', 'expected'), [
    # from rest to rest; at one rate; nothing that makes heat
    (lambda t: 0.0 * t, [SLOWER], 1.0), (lambda t: 2.0 + 0.0 * t, [SLOWER], 100.0),
    (lambda t: np.exp2(-40.0 * t), [], 100.0),
    # exp(-4 t) has turned by 0.25 (1 - exp(-4)), and turns by 0.25 exp(-4) more
    (lambda t: np.exp(-4.0 * t), [SLOWER], 1.0 / -math.expm1(-4.0)),
    # half of the angle is still to come
    (lambda t: np.exp(-math.log(2.0) * t), [SLOWER], 2.0),
    # so it is behind a torque that is over; under one that lasts it goes on at the largest rate
    # of the last quarter
    (lambda t: np.exp(-4.0 * t), [SLOWER, OVER], 1.0 / -math.expm1(-4.0)),
    (lambda t: np.exp(-4.0 * t), [SLOWER, DRIVE], 1.0 + 99.0 * GOES_ON / 0.2454),
    (lambda t: np.exp(-4.0 * t), [SLOWER, UNBOUNDED], 1.0 + 99.0 * GOES_ON / 0.2454),
    # one that slows down to a rate goes on at it: 0.5 of 2.75 in each run to come
    (lambda t: np.where(t < 0.5, 5.0, 0.5), [SLOWER], 1.0 + 99.0 * 0.5 / 2.75),
    # one that is as fast in the last quarter as before is not taken to slow down
    (lambda t: np.where((t > 0.6) & (t < 0.8), 3.0, 1.0), [SLOWER], 100.0),
    (lambda t: np.where(t < 0.99, 3.0, math.nan), [SLOWER], 100.0)])
def test_the_error_of_a_body_that_heat_slows_goes_with_the_angle_it_turns(rates, effects,
                                                                            expected):
    times = runs.looks(1.0)
    states = np.zeros((runs.LOOKS, 14))
    states[:, 7] = rates(times)
    scene = coasting_scene(effects=effects)
    assert forecast.turned_later(scene, states, 100.0) == near(expected, rel=0.05)
    # and so do the errors of its steps
    assert forecast.later(scene, states, 3.0 * times, 100.0) == near(3.0 * expected, rel=0.05)
    assert forecast.turned_later(scene, states, 1.0) == 1.0


def test_heat_inside_a_body_leaves_it_a_rotation():
    states = np.zeros((runs.LOOKS, 14))
    states[:, 7] = np.exp(-4.0 * runs.looks(1.0))
    found = forecast.turned_later(load_scene('major_axis_relaxation'), states, 100.0)
    assert found == near(1.0 + 99.0 * GOES_ON / 0.2454, rel=0.05)


def test_the_angle_of_a_body_that_heat_slows_is_counted_from_look_to_look():
    """Between rates r and r' it turns at most at (2 sqrt(r r') + (r + r')/2)/3, in looks.

    The first rate counts up to the first look, too, and each one at least as the largest later.
    """
    scene, n = coasting_scene(effects=[SLOWER]), runs.LOOKS
    states = np.zeros((n, 14))
    states[:, 7] = [7.0] + [5.0] * (n // 4 - 1) + [0.5] * (n - n // 4)
    turned = (7.0 + (2.0 * math.sqrt(35.0) + 6.0) / 3.0 + 5.0 * (n // 4 - 2)
              + (2.0 * math.sqrt(2.5) + 2.75) / 3.0 + 0.5 * (n - n // 4 - 1))
    assert forecast.turned_later(scene, states, 2.0) == near(1.0 + 0.5 * n / turned, rel=1e-13)
    # a last quarter at a third of the rate of the one before, which ended late: half of that share
    # of a quarter is to come in all
    late = 3 * n // 4 - 1
    states[:, 7] = 1.0
    states[late, 7] = 3.0
    turned = 1.0 + 3.0 * late + (2.0 * math.sqrt(3.0) + 2.0) / 3.0 + (n - 2.0 - late)
    assert forecast.turned_later(scene, states, 9.0) == near(
        1.0 + 0.25 * 0.5 * n / turned, rel=1e-13)


@pytest.mark.parametrize(('inertia', 'torque', 'rate', 'accuracy', 'horizon'), [
    # expected 2.9e-8, error 2.2e-8; 3.9e-8 beside 2.4e-7 where errors went with time
    ('[0.01, 0.010000005, 1.0e-8]', '[0, 0, 0.02]', '[0.1, 0, 0]', 1e-6, 1.0),
    # 1.8e-10 beside 3.6e-10, through 0 on the way; 2.1e-10 beside 2.2e-9
    ('[1, 2, 1.5]', '[0, 0.2, 0]', '[1, 1, 1]', 1e-9, 1500.0)], ids=['needle', 'body'])
def test_the_error_of_a_body_that_turns_ever_faster_goes_with_its_angle(
        inertia, torque, rate, accuracy, horizon):
    scene = parse_scene(SLOW.replace('[1.0, 2.0, 3.0]', inertia).replace('[0.3, 0.2, 0.1]', rate)
                        .replace('EFFECTS', f'torque: {{value: {torque}, frame: body}}'))
    times = np.linspace(0.5, 1.0, 9) * horizon
    ours, finer = (Simulation(scene, accuracy=one, horizon=horizon) for one in (accuracy, 1e-13))
    error = comparison.apart(*(one.states(times).vector for one in (ours, finer))).max()
    assert error < min(accuracy, 3.0 * ours.expected_error)


def test_a_missed_accuracy_is_said_with_the_time_until_which_it_is_met():
    scene = load_scene('tennis_racket')
    missed = choose(scene, accuracy=1e-9, settled=Settled('dop8', 1e-9, 1.64, 12.5)).missed
    assert 'accuracy asked, 1e-09 rad, is missed' in missed
    assert '1.6e+00 rad' in missed and 'met until 12.5 s' in missed
    assert choose(scene, accuracy=1e-9, settled=Settled('dop8', 1e-9, 1e-9, 100.0)).missed is None
    assert choose(scene, 'dop8', accuracy=1e-9).missed is None    # nothing was foretold
    assert choose(scene, accuracy=1e-15).missed    # closed forms have a floor, too


@pytest.mark.parametrize(('expected', 'shown'), [
    (3e-12, '3.0e-12'), (1.0004e-12, '1.0004e-12'), (math.nextafter(1e-12, 1.0), '1.00000000000'),
    (math.inf, 'inf')])
def test_an_error_is_told_with_the_figures_that_show_that_it_is_too_large(expected, shown):
    line = forecast.missed(1e-12, 10.0, expected, 4.0)
    assert f' {shown}' in line and '1.0e-12 rad' not in line


@pytest.mark.parametrize(('expected', 'met_until', 'line'), [
    (None, 3.0, None), (1e-9, 3.0, None), (1e-12, None, None),
    (2e-9, None, 'the error expected within 12.5 s is 2.0e-09 rad'),
    (2e-9, 0.0, 'the error expected within 12.5 s is 2.0e-09 rad; it is met at no time'),
    (2e-9, 1 / 3, 'the error expected within 12.5 s is 2.0e-09 rad; it is met until 0.333 s')])
def test_what_is_missed_is_said_in_one_line(expected, met_until, line):
    found = forecast.missed(1e-9, 12.5, expected, met_until)
    assert found == (line and f'the accuracy asked, 1e-09 rad, is missed: {line}')


INNER = 'internal_dissipation: {coefficient: 0.1}'


def spinning(wobble, axis=2, count=64):
    """Return states of a body at rate 1 about one of its axes, with a wobble of each look."""
    states = np.zeros((count, 14))
    states[:, 4] = 1.0
    states[:, 5 + axis] = 1.0
    states[:, 5 + (axis + 1) % 3] = wobble(np.arange(1, count + 1) / count)
    return states


@pytest.mark.parametrize(('wobble', 'axis', 'effects', 'expected'), [
    (lambda t: 0.0 * t, 2, [INNER], True), (lambda t: np.exp(-20.0 * t), 2, [INNER], True),
    (lambda t: np.exp(-5.0 * t), 2, [INNER], False),           # it still wobbles
    (lambda t: 1e-9 * np.exp(5.0 * t), 2, [INNER], False),     # ever more
    (lambda t: 1e-13 * np.exp(t), 2, [INNER], True),           # by rounding
    (lambda t: 0.0 * t, 0, [INNER], False), (lambda t: 0.0 * t, 1, [INNER], False),
    (lambda t: 0.0 * t, 2, [], False), (lambda t: math.nan * t, 2, [INNER], False),
    (lambda t: 0.0 * t, 0, ['drag: {angular: 0.1}'], True)])
def test_what_heat_has_made_spin_steadily(wobble, axis, effects, expected):
    scene = coasting_scene(effects=effects, inertia='[1.0, 1.5, 2.0]')
    states = spinning(wobble, axis)
    assert forecast.spins_steadily(scene, states) is expected
    assert not forecast.is_steady(scene, states[:7])    # too few


def test_errors_of_a_steady_spin_go_on_as_they_grew_in_the_second_half():
    scene = coasting_scene(effects=[INNER], inertia='[1.0, 1.5, 2.0]')
    best = spinning(lambda t: 0.0 * t)
    ours, half = best.copy(), np.arange(1, 65) / 128.0
    angle = np.minimum(half, 0.25) * 4e-3 + np.maximum(half - 0.25, 0.0) * 4e-4    # of half a turn
    ours[:, 3], ours[:, 4] = np.sin(angle), np.cos(angle)
    errors = comparison.apart(ours, best)
    assert errors[-1] == near(2.2e-3, rel=1e-6)
    assert forecast.later(scene, ours, errors, 11.0, best) == near(2.2e-3 + 4e-3, rel=1e-6)
    assert forecast.later(scene, ours, errors, 1.0, best) == errors[-1]
    # where the other run is not known, in proportion to time
    assert forecast.later(scene, ours, errors, 11.0) == near(11.0 * 2.2e-3, rel=1e-6)


@pytest.mark.parametrize(('rates', 'yet', 'expected'), [
    # folds of the energy: 2 c L^2 (1 - 1/2) yet = 0.1 yet; of the wobble half as many. It passes
    # where the energy below the largest is (1 - 1/1.5)/2 = 1/6 J, now it is 0.375 e^2
    ([1.0, 1e-6, 0.0], 267.0, False), ([1.0, 1e-6, 0.0], 269.0, True),
    ([1.0, 0.0, 0.0], 1e6, False),       # exactly about the axis, for ever
    ([0.1, 0.0, 1.0], 1e6, False),       # it has passed
    ([math.nan, 0.0, 1.0], 1e6, False), ([0.0, 0.0, 0.0], 1e6, False)])
def test_where_inner_heat_may_make_a_body_tumble(rates, yet, expected):
    scene = coasting_scene(effects=[INNER], inertia='[1.0, 1.5, 2.0]')
    states = np.zeros((4, 14))
    states[:, 5:8] = rates
    assert forecast.may_tumble(scene, states, yet) is expected
    assert not forecast.may_tumble(coasting_scene(effects=[]), states, yet)
