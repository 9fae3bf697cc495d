# SPDX-License-Identifier: Apache-2.0
"""What hard cases measure, on made-up runs that are wrong by known amounts."""

import math
import types

import numpy as np
import pytest
from near import near

from rigid_body_sim.errors import BadInput
from rigid_body_sim.study.hard_cases import behaviour
from rigid_body_sim.study.hard_cases.sliding_ball import MASS, A, G
from rigid_body_sim.theory import billiard


class Run:
    """Stands in for Simulation: it goes nowhere, and what it shows is given."""

    def __init__(self, **shown):
        self.ticks, self.pushes, self.events = 0, [], []
        self.__dict__.update(shown)

    def advance(self, ticks):
        self.ticks += ticks

    def impulse(self, force):
        self.pushes.append((self.ticks, force))


def give(monkeypatch, run, **meant):
    """Have `ball` return a run, and look at what it is asked for."""
    def ball(**asked):
        assert {key: asked[key] for key in meant} == meant
        return run
    monkeypatch.setattr(behaviour, 'ball', ball)


def test_constants_are_those_of_theory():
    assert billiard.sliding_time(behaviour.SPEED, behaviour.RESTRUCK, G) == near(
        1e-3 * behaviour.ONSET, rel=1e-14)
    assert near(billiard.speed_when_rolling(1.0, -140.0 * A), rel=1e-14) == behaviour.DRAWN
    # 3e-300 grows to 1 at the mean of 25 (1 - 1/2) and 25 (1 - 1/3), 1/s
    assert near(math.log(1e300 / 3.0) / (0.5 * 25.0 * (1.0 / 2.0 + 2.0 / 3.0)),
                rel=1e-14) == behaviour.LEAVES


def test_runs_that_differ_from_the_first_are_counted():
    one = np.array([0.0, 1.0])
    for others, count in (((one, one), 0.0), ((one, -one), 1.0), ((-one, one + 1.0), 2.0)):
        assert behaviour._same_bits(one, *others).error == count


def test_a_ball_that_rolls_at_once_has_one_speed_and_no_event(monkeypatch):
    speeds = np.array([[1.5, 9.0], [1.75, 0.0], [1.625, 0.0]])
    run = Run(states=lambda _: types.SimpleNamespace(velocity=speeds), events=['one', 'two'])
    give(monkeypatch, run)
    assert behaviour.two_fifths().error == 2.25


def test_without_friction_a_ball_keeps_its_speed(monkeypatch):
    speeds = np.array([[1.0, 9.0], [0.5, 0.0], [1.25, 0.0]])
    give(monkeypatch, Run(states=lambda _: types.SimpleNamespace(velocity=speeds)), mu=0.0)
    assert behaviour.frictionless().error == 0.5


def test_two_pushes_at_the_onset_of_rolling_add_up(monkeypatch):
    run = Run(vector=np.zeros(14))
    # pushed by 0.5 m/s across; friction makes 5/7 of it
    run.vector[11:13] = (behaviour.SPEED * 5.0 / 7.0 + 0.001, 0.5 * 5.0 / 7.0 - 0.002)
    give(monkeypatch, run, mu=behaviour.RESTRUCK)
    assert behaviour.restruck_at_onset().error == near(0.002, rel=1e-10)    # measured: 1e-15
    assert [ticks for ticks, _ in run.pushes] == [behaviour.ONSET] * 2
    assert np.sum([force for _, force in run.pushes], axis=0) == near(
        [0.0, MASS * 0.5, 0.0], rel=1e-15)
    assert run.ticks > behaviour.ONSET


@pytest.mark.parametrize(('about', 'error'), [
    ([1], 0.003), ([0], math.inf), ([2], math.inf), ([0, 2], math.inf)])
def test_a_ball_that_comes_back_rolls_without_slip_about_y_alone(monkeypatch, about, error):
    orientation, speed = np.array([0.0, 0.0, 0.0, 0.8]), behaviour.DRAWN - 0.001
    orientation[about] = 0.6
    orientation[0] *= -1.0
    state = types.SimpleNamespace(orientation=orientation, velocity=np.array([speed, 0.0, 0.0]),
                                  angular_velocity=np.array([7.0, (speed + 0.002) / A, 7.0]))
    give(monkeypatch, Run(state=state))
    assert behaviour.draw_shot().error == near(error, rel=1e-10)    # measured: 1e-15


def test_the_excess_is_over_the_energy_about_the_largest_axis(monkeypatch):
    """By hand: (E - L^2/(2 I_max))/E(0) with I_max = 5 kg m^2."""
    def simulation(scene, accuracy):
        assert (scene.body.about_center.moments, accuracy) == ((1.0, 4.5, 5.0), 1e-7)
        return types.SimpleNamespace(states=lambda times: times, diagnose=lambda _: (
            np.array([4.0, 3.0]), np.array([10.0, 15.0])))
    monkeypatch.setattr(behaviour, 'Simulation', simulation)
    excess, times = behaviour.relaxing(0.5, (1.0, 2.0, 0.5), 7.0, (1.0, 4.5, 5.0), 1e-7)
    assert excess.tolist() == [0.75, 0.375]
    assert (times[0], times[-1], len(times)) == (0.0, 7.0, 400)


@pytest.mark.parametrize(('c', 'seconds', 'last', 'error'), [
    (50.5, 2.0, -0.25, 0.25), (49.5, 2.0, -0.25, 0.125), (50.5, 2.0, 0.0625, 0.125),
    (50.0, 2.0, 0.25, 0.125), (202.0, 0.5, 0.25, 0.25)])
def test_an_excess_never_rises_and_nothing_is_left_after_a_hundred_of_its_times(
        monkeypatch, c, seconds, last, error):
    excess = np.array([1.0, 0.5, 0.625, last])
    monkeypatch.setattr(behaviour, 'relaxing', lambda *_: (excess, None))
    assert behaviour.never_rises(c, behaviour.WOBBLING, seconds).error == error


def test_a_body_stays_on_its_smallest_axis(monkeypatch):
    omega = np.array([[5.0, 0.0, 0.0], [4.75, 0.0, 0.0], [5.0, 0.0, -0.5]])
    monkeypatch.setattr(behaviour, 'relaxing', lambda *_: (
        None, types.SimpleNamespace(angular_velocity=omega)))
    assert behaviour.stays_on_smallest().error == 0.5


@pytest.mark.parametrize('gone', [(0.51, 0.0), (0.0, 0.34), (0.4, 0.25)])
def test_a_body_leaves_its_smallest_axis_when_one_unit_of_momentum_is_across_it(
        monkeypatch, gone):
    """The moments across are 2 and 3 kg m^2."""
    omega = np.array([[9.0, 0.5, 0.0], [9.0, 0.0, 0.33], [9.0, *gone], [9.0, 2.0, 2.0]])
    states = types.SimpleNamespace(angular_velocity=omega, time=behaviour.LEAVES + np.array(
        [-0.3, -0.2, -0.125, 0.5]))
    monkeypatch.setattr(behaviour, 'relaxing', lambda *_: (None, states))
    assert behaviour.leaves_smallest().error == pytest.approx(0.125, abs=1e-13)


@pytest.mark.parametrize(('refused', 'error'), [
    ((1e300, math.inf, math.nan), 0.0), ((math.inf, math.nan), 2.0), ((), 4.0)])
def test_what_is_not_refused_and_what_is_left_of_impulses_are_counted(
        monkeypatch, refused, error):
    class Struck(Run):
        def __init__(self, scene):
            super().__init__(vector=np.zeros(3))

        def impulse(self, torque, frame='world'):
            assert self.ticks
            if str(torque[0]) in map(str, refused):
                raise BadInput('impulse', 'too large', 'less')
            self.vector += torque
    monkeypatch.setattr(behaviour, 'Simulation', Struck)
    assert behaviour.impulses_cancel().error == error


def test_a_stepped_energy_is_judged_beside_its_attitude(monkeypatch):
    def simulation(scene, method='exact', step=None):
        exact = method == 'exact'
        turn = 0.0 if exact else 0.02
        return Run(energy=4.0 if exact else 3.999, vector=np.array(
            [0.0, 0.0, math.sin(0.5 * turn), 0.0, math.cos(0.5 * turn), *9 * [7.0]]))
    monkeypatch.setattr(behaviour, 'Simulation', simulation)
    # 2.5e-4 over 0.02 rad
    assert behaviour.energy_is_no_proof().error == near(0.0125, rel=1e-10)    # measured: 1e-13
