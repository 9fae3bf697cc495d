# SPDX-License-Identifier: Apache-2.0
"""The parts of a forecast, each computed by hand: errors, looks, strikes, conditioning."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rigid_body_sim.choice import forecast as forecasts
from rigid_body_sim.choice.forecast import LOOKS, Forecast, forecast
from rigid_body_sim.errors import NotConverged
from rigid_body_sim.integrators.marching.work import TooMuchWork
from rigid_body_sim.scene.scene import parse_scene

TIMES = np.array([1.0, 2.0, 3.0, 4.0])
HALF_ULP = 2.0 ** -53


@pytest.mark.parametrize(('errors', 'accuracy', 'horizon', 'expected'), [
    ([1, 2, 3, 4], 5, 4, Forecast(4, 4)), ([1, 2, 3, 4], 4, 4, Forecast(4, 4)),
    ([1, 4, 3, 2], 4, 4, Forecast(4, 4)), ([1, 2, 3, 4], 5, 8, Forecast(8, 5)),
    ([1, 2, 3, 4], 5, 2, Forecast(4, 2)), ([1, 2, 3, 4], 2, 4, Forecast(4, 2)),
    ([1, 2, 3, 4], 2.5, 4, Forecast(4, 2)), ([1, 5, 3, 4], 4.5, 4, Forecast(5, 1)),
    ([1, 2, 3, 4], 0.5, 4, Forecast(4, 0.5)), ([0, 0, 9, 9], 1, 4, Forecast(9, 2)),
    ([1, 2, 3, math.inf], 2, 4, Forecast(math.inf, 2))])
def test_errors_grow_with_time_and_are_met_until_the_last_look_that_was_good(
        errors, accuracy, horizon, expected):
    found = forecast(np.array(errors, float), TIMES, accuracy, horizon)
    assert found == pytest.approx(expected)


def test_looks_are_spread_evenly_up_to_the_time():
    found = forecasts.looks(6.0)
    assert len(found) == LOOKS
    assert found[-1] == 6.0
    assert np.diff([0.0, *found]) == pytest.approx(np.full(LOOKS, 6.0 / LOOKS))


class Coasting:
    """A body that turns at its rate about z from its start; `most` is the latest time it knows."""

    def __init__(self, most=math.inf, error=NotConverged):
        self.most, self.error, self.starts = most, error, []

    def start(self, vector):
        self.starts.append(vector.copy())
        started = Coasting(self.most, self.error)
        started.vector = vector.copy()
        return started

    def state(self, time, out):
        if time > self.most:
            raise self.error('no further')
        out[:] = self.vector
        turn = Rotation.from_rotvec((time - self.vector[0]) * self.vector[5:8])
        out[0], out[1:5] = time, (Rotation.from_quat(self.vector[1:5]) * turn).as_quat()

    def states(self, times, out):
        for time, row in zip(times, out, strict=True):
            self.state(time, row)

    def allowance(self, until):
        return None


def scene(*strikes, effects=()):
    struck = [f'strike: {{impulse: [{impulse}, 0, 0], point: [0, 1, 0], time: {time}, '
              'frame: body}'
              for time, impulse in strikes]
    return parse_scene('scene: s\nbody: {mass: 2, inertia: [4, 4, 4]}\nconstraint: free\n'
                       f'effects: [{", ".join([*struck, *effects])}]\n'
                       'initial: {angular_velocity: [0, 0, 3]}\n')


def test_a_run_begins_anew_at_each_strike():
    """J at y = 1 along x takes J/4 from the rate about z; one after the last look does nothing."""
    one = scene((2.5, -4.0), (1.0, 8.0), (9.0, 1.0))
    assert [strike.time for strike in forecasts.strikes(one)] == [1.0, 2.5, 9.0]
    prototype = Coasting()
    states = forecasts.run(one, prototype, one.initial.vector, TIMES)
    assert [start[0] for start in prototype.starts] == [0.0, 1.0, 2.5]
    assert [start[7] for start in prototype.starts] == pytest.approx([3.0, 1.0, 2.0])
    # a look at the time of a strike sees the state after it
    assert states[:, 7] == pytest.approx([1.0, 1.0, 2.0, 2.0])
    angles = Rotation.from_quat(states[:, 1:5]).as_rotvec()[:, 2] % (2.0 * math.pi)
    assert angles == pytest.approx([3.0, 4.0, 5.5, 7.5 - 2.0 * math.pi])
    assert forecasts.struck_rate(one) == pytest.approx(2.0 + 1.0 + 0.25)


def test_what_does_not_converge_is_not_a_number_and_too_much_work_is_said():
    still = scene()
    found = forecasts.run(still, Coasting(2.5), still.initial.vector, TIMES)
    assert np.isnan(found).all()
    with pytest.raises(TooMuchWork):
        forecasts.run(still, Coasting(2.5, TooMuchWork), still.initial.vector, TIMES)


def test_runs_are_apart_by_the_angle_between_them():
    states, others = np.zeros((2, 3, 14))
    for k, angle in enumerate((0.0, 0.5, 3.0)):
        states[k, 1:5] = Rotation.from_rotvec([0.0, 0.0, 1.0]).as_quat()
        others[k, 1:5] = Rotation.from_rotvec([0.0, 0.0, 1.0 + angle]).as_quat()
    assert forecasts.apart(states, others) == pytest.approx([0.0, 0.5, 3.0], abs=1e-15)
    others[1, 1] = math.nan
    assert forecasts.apart(states, others)[1] == math.inf


TORQUE = 'torque: {value: [0, 0, 1], frame: body}'


@pytest.mark.parametrize(('rates', 'powers', 'effects', 'expected'), [
    # rates that grow with time from 0 turn a body by an angle that goes with its square
    (lambda t: t, 2.0, [TORQUE], 9.0), (lambda t: t, 3.0, [TORQUE], 27.0),
    (lambda t: t, 4.0, [TORQUE], 81.0), (lambda t: t, 6.0, [TORQUE], 81.0),
    (lambda t: t, 0.5, [TORQUE], 9.0), (lambda t: t, 2.0, [], 3.0),
    # from a rate of 1 to 2 the rate is 4 at three times the time, the angle 6 times as large
    (lambda t: 1 + t, 1.0, [TORQUE], 6.0),
    # a rate that rises no more, or rose late, is not taken to rise
    (lambda t: np.minimum(t, 0.75), 2.0, [TORQUE], 3.0),
    (lambda t: np.maximum(t, 0.75), 2.0, [TORQUE], 3.0), (lambda t: 0 * t, 2.0, [TORQUE], 3.0)])
def test_errors_go_with_the_angle_or_its_square_where_a_drive_speeds_a_body_up(
        rates, powers, effects, expected):
    times = forecasts.looks(1.0)
    states = np.zeros((LOOKS, 14))
    states[:, 7] = rates(times)
    found = forecasts.later(scene(effects=effects), states, times ** powers, 3.0)
    assert found == pytest.approx(expected)


def test_rounding_is_half_an_ulp_of_the_angle_at_the_largest_rate_so_far():
    states = np.zeros((4, 14))
    states[:, 7] = 3.0, 6.0, 1.0, 2.0
    found = forecasts.rounding(scene(), states, TIMES)
    assert found == pytest.approx(HALF_ULP * (4.0 + np.array([3.0, 12.0, 18.0, 24.0])))
    # what a torque added counts twice
    driven = scene(effects=('torque: {value: [0, 0, 1]}',))
    found = forecasts.rounding(driven, states, TIMES)
    assert found == pytest.approx(HALF_ULP * (4.0 + np.array([3.0, 18.0, 27.0, 36.0])))


def test_conditioning_is_what_half_an_ulp_of_the_start_does():
    """A body that coasts about z: each number of q counts, and omega by its size times time.

    |G D|^2 = 4 h^2 |dq|^2 + (3 h t)^2 with half an ulp h on each number; what is along q is lost,
    and of the signs of a Hadamard matrix the mixed terms cancel.
    """
    one = scene()
    prototype = Coasting()
    states = forecasts.run(one, prototype, one.initial.vector, TIMES)
    found = forecasts.conditioning(one, prototype, TIMES, states)
    expected = HALF_ULP * np.sqrt(4.0 * 3.0 + (3.0 * TIMES) ** 2)
    assert found == pytest.approx(expected, rel=0.3)
    lost = forecasts.lost(one, prototype, TIMES, states)
    assert lost == pytest.approx(np.maximum(found, forecasts.rounding(one, states, TIMES)))
    struck = scene((1.5, 1e-12), (3.0, 1e-12))
    twice = forecasts.lost(struck, prototype, TIMES, states) / lost
    # what each strike rounds grows from then on
    again = np.square([[0.0, 0.25, 0.5, 0.625], [0.0, 0.0, 0.0, 0.25]]).sum(axis=0)
    again += np.square(4.0 * HALF_ULP / lost) * [0, 1, 2, 2]
    assert twice == pytest.approx(np.sqrt(1.0 + again))


def test_a_start_is_moved_by_half_ulps_of_its_numbers():
    one = scene()
    start = one.initial.vector
    moved = forecasts._moved(one, start, (1, 1, -1, 1, 1, -1, -1), 2.0 ** 20)
    by = HALF_ULP * 2.0 ** 20
    assert moved[1:4] == pytest.approx([by, by, -by], rel=1e-6)
    assert np.linalg.norm(moved[1:5]) == pytest.approx(1.0, abs=1e-15)
    assert moved[5:8] - start[5:8] == pytest.approx([0.0, 0.0, -3.0 * by])
    hinged = parse_scene('scene: s\nbody: {mass: 2, inertia: [1, 2, 2.5]}\n'
                         'constraint: {hinge: {axis: [1, 2, 2]}}\neffects: []\n'
                         'initial: {rate: 3}\n')
    moved = forecasts._moved(hinged, hinged.initial.vector, (1,) * 7, 2.0 ** 20)
    assert moved[5:8] == pytest.approx(hinged.initial.vector[5:8] * (1.0 + by), rel=1e-15)


@pytest.mark.parametrize('turn', [0.6, 1e-9])
def test_on_skew_axes_a_rate_is_moved_by_half_ulps_of_the_products_that_mix(turn):
    cos, sin = math.cos(turn), math.sin(turn)
    axes = np.array([[1.0, 0.0, 0.0], [0.0, cos, -sin], [0.0, sin, cos]])    # body from principal
    tensor = axes @ np.diag([1.0, 2.0, 2.5]) @ axes.T
    moved = _rate_moved((0.5 * (tensor + tensor.T)).tolist(), [3.0, 2.0, 0.01])
    expected = [3.0, cos * 2.0 + sin * 0.01, sin * 2.0 + cos * 0.01]
    assert np.abs(axes.T @ moved) == pytest.approx(expected, rel=1e-6)


def test_about_a_skew_axis_of_zero_moment_no_rate_is_moved():
    moved = _rate_moved([[2, 0, 0], [0, 1, -1], [0, -1, 1]], [3.0, 2.0, -2.0])
    assert moved[1] == pytest.approx(-moved[2]) and abs(moved[1]) == pytest.approx(2.0)


def _rate_moved(inertia, rate):
    """Return the move of a rate by half ulps with equal signs, in half ulps of 1 rad/s."""
    one = parse_scene(f'scene: s\nbody: {{mass: 2, inertia: {inertia}}}\n'
                      'constraint: free\neffects: []\n'
                      f'initial: {{angular_velocity: {rate}}}\n')
    many = 2.0 ** 30
    moved = forecasts._moved(one, one.initial.vector, (1,) * 7, many)
    return (moved - one.initial.vector)[5:8] / (HALF_ULP * many)
