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


def test_a_million_ticks_are_a_million_seconds_however_they_are_passed(monkeypatch):
    class Ticking(Run):
        def __init__(self, scene, rate):
            super().__init__(rate=rate)

        vector = property(lambda self: np.array([self.ticks / self.rate]))

        def advance_through(self, ticks):
            self.ticks += ticks
            return [types.SimpleNamespace(vector=np.array([k / self.rate])) for k in (
                1, 2, self.ticks)]

        def states(self, times):
            return types.SimpleNamespace(vector=np.array(times)[:, None])
    monkeypatch.setattr(behaviour, 'load_scene', lambda *_: None)
    monkeypatch.setattr(behaviour, 'Simulation', Ticking)
    found = behaviour.million_ticks()
    assert (found.error, found.bound) == (0.0, 0.0)


def test_jumps_go_there_and_back_and_their_bound_is_that_of_a_walk(monkeypatch):
    """Each jump rounds the attitude, and omega, which turns the body until the end."""
    times, start, [scene] = [], np.arange(1.0, 15.0), [types.SimpleNamespace(name='made up')]
    start[1:5] = 0.0, 0.0, 0.0, 1.0

    class Anchored:
        def __init__(self, state, wrench):
            assert wrench == 'none' and state[0] == (times[-1] if times else 1.0)
            self._state = state

        def state(self, time, out):
            out[:] = self._state
            out[0] = time
            times.append(time)
    monkeypatch.setattr(behaviour, 'load_scene', lambda name: scene)
    monkeypatch.setattr(behaviour, 'Simulation', lambda _: types.SimpleNamespace(
        choice=types.SimpleNamespace(solver=Anchored), vector=start, wrench='none'))
    found = behaviour.composed_jumps()
    jumps = np.diff([0.0, *times])[:-1]    # the last one goes back to 0
    assert (len(times), times[-1], found.error) == (1001, 0.0, 0.0)
    assert (jumps > 0.0).any() and (jumps < 0.0).any()
    assert 1.0 < np.abs(jumps).max() <= 10.0 and np.abs(jumps).min() < 1e-8
    walk = 4.0 * math.sqrt(1001.0) + math.sqrt(6.0**2 + 7.0**2 + 8.0**2) * math.hypot(*times)
    assert found.bound == near(3.0 * 2.0**-52 * walk, rel=1e-13)    # measured: 2e-16


@pytest.mark.parametrize(('again', 'there', 'count'), [
    ('a', 'a', 0.0), ('b', 'a', 1.0), ('a', 'b', 1.0), ('b', 'b', 2.0)])
def test_bits_are_those_of_this_process_and_of_another(monkeypatch, again, there, count):
    here = iter(['a', again])
    monkeypatch.setattr(behaviour, 'random_bits', lambda: next(here))
    monkeypatch.setattr(behaviour.subprocess, 'run', lambda *_, **__: types.SimpleNamespace(
        stdout=f'{there}\n'))
    found = behaviour.two_processes()
    assert (found.error, found.bound) == (count, 0.0)


CASES = {
    1: ['energy is no proof'], 4: ['a jump of 1e6 s, a million ticks, any order'],
    7: ['struck at 2a/5', 'no friction', 'restruck twice at the very tick of rolling onset',
        'draw shot'],
    8: ['through the separatrix', 'stiff: c dt = 1', 'stiff: c dt = 1000', 'stiff: c dt = 1e+06',
        'stiff: c dt = 1e+06, I = (1, 1, 2), asked for 1e-12 rad',
        'stiff: c dt = 1e+06, I = (1, 2, 2), asked for 1e-12 rad',
        'stiff: c dt = 1e+06, I = (1, 2, 3), asked for 1e-06 rad',
        'exactly on the smallest axis', '1e-300 off the smallest axis'],
    9: ['opposite impulses, denormal and 1e100; 1e300 refused'],
    10: ['a thousand jumps there and back', 'the same bits in two processes']}
"""By the number of their group (case.py)."""


def test_peers_are_asked_what_we_are(monkeypatch):
    """Shots end as the momentum about the point of contact says: v = (5 v + 2 a w)/7."""
    monkeypatch.setattr(behaviour, 'question', lambda shot: shot)
    monkeypatch.setattr(behaviour, 'questions', types.SimpleNamespace(**{
        name: lambda *asked: asked for name in ('never_rises', 'stays', 'leaves', 'cancel')}))
    cases = list(behaviour.cases())
    assert {number: [case.name for case in cases if case.group == number]
            for number in {case.group for case in cases}} == CASES
    asked = {case.name: case.asked for case in cases}
    for name in CASES[7]:
        shot = asked[name]
        v, (x, y, _), (when, push) = np.array(shot.v), shot.omega, shot.push
        rolled = (5.0 * (v + push) + 2.0 * A * np.array([y, -x])) / 7.0 if shot.mu else v
        assert shot.expected == near(rolled, rel=1e-14), name    # measured: 2e-16
        slip = math.hypot(v[0] - A * y, v[1] + A * x)
        until = max((2.0 / 7.0 * (one / (shot.mu * G)) for one in (
            slip, math.hypot(*push))), default=0.0) if shot.mu else 0.0
        assert shot.end > when + until
    assert asked['no friction'].omega[1] < 0.0 < asked['no friction'].v[0]
    for case in cases:
        if case.group == 8 and hasattr(case.run, 'args') and case.asked:
            scene, seconds, ended = case.asked
            c = scene.effect('internal_dissipation').coefficient
            assert case.run.args == (c, tuple(scene.initial.angular_velocity), seconds)
            assert ended == (c * seconds > 100.0)
            assert case.name in ('through the separatrix', f'stiff: c dt = {c * 1e-3:g}')
        elif case.group == 8 and hasattr(case.run, 'args'):
            assert case.run.args == (1e9, behaviour.WOBBLING, 1.0)
            inertia = ', '.join(f'{one:g}' for one in case.run.keywords['inertia'])
            asked_for = case.run.keywords['accuracy']
            assert case.name.endswith(f'I = ({inertia}), asked for {asked_for:g} rad')
    for name, more in ((CASES[8][-2], (100.0,)), (CASES[8][-1], (80.0, behaviour.LEAVES))):
        scene, *rest = asked[name]
        assert scene.effect('internal_dissipation').coefficient == 1.0
        assert scene.body.about_center.moments[0] == 1.0 and tuple(rest) == more
        assert scene.initial.angular_velocity.tolist()[:2] == [5.0, 0.0]
    [impulses] = asked[CASES[9][0]]
    assert np.sum(impulses, axis=0).tolist() == [0.0, 0.0, 0.0]
    assert np.abs(impulses[0])[1:].tolist() == [1e100, 5e-324]


def test_a_ball_that_rolls_at_once_has_one_speed_and_no_event(monkeypatch):
    speeds = np.array([[1.5, 9.0], [1.75, 0.0], [1.625, 0.0]])
    run = Run(states=lambda _: types.SimpleNamespace(velocity=speeds), events=['one', 'two'])
    give(monkeypatch, run)
    found = behaviour.two_fifths()
    assert (found.error, found.bound) == (2.25, 0.0)


def test_without_friction_a_ball_keeps_its_speed(monkeypatch):
    speeds = np.array([[1.0, 9.0], [0.5, 0.0], [1.25, 0.0]])
    asked = []
    give(monkeypatch, Run(states=lambda times: asked.append(times) or types.SimpleNamespace(
        velocity=speeds)), mu=0.0)
    found = behaviour.frictionless()
    assert asked == [[0.1, 1e3, 1e6]]
    assert (found.error, found.bound) == (0.5, 0.0)


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
    found = behaviour.stays_on_smallest()
    assert (found.error, found.bound) == (0.5, 0.0)


@pytest.mark.parametrize('gone', [(0.51, 0.0), (0.0, 0.34), (0.4, 0.25)])
def test_a_body_leaves_its_smallest_axis_when_one_unit_of_momentum_is_across_it(
        monkeypatch, gone):
    """The moments across are 2 and 3 kg m^2."""
    omega = np.array([[9.0, 0.5, 0.0], [9.0, 0.0, 0.33], [9.0, *gone], [9.0, 2.0, 2.0]])
    states = types.SimpleNamespace(angular_velocity=omega, time=behaviour.LEAVES + np.array(
        [-0.3, -0.2, -0.125, 0.5]))

    def relaxing(*asked):
        assert asked == (1.0, (5.0, 0.0, 1e-300), 80.0)    # 400 times, seen every 0.2 s
        return None, states
    monkeypatch.setattr(behaviour, 'relaxing', relaxing)
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
    found = behaviour.impulses_cancel()
    assert (found.error, found.bound) == (error, 0.0)


def test_a_stepped_energy_is_judged_beside_its_attitude(monkeypatch):
    def simulation(scene, method='exact', step=None):
        exact = method == 'exact'
        turn = 0.0 if exact else 0.02
        return Run(energy=4.0 if exact else 3.999, vector=np.array(
            [0.0, 0.0, math.sin(0.5 * turn), 0.0, math.cos(0.5 * turn), *9 * [7.0]]))
    monkeypatch.setattr(behaviour, 'Simulation', simulation)
    # 2.5e-4 over 0.02 rad
    assert behaviour.energy_is_no_proof().error == near(0.0125, rel=1e-10)    # measured: 1e-13
