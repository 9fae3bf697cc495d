# SPDX-License-Identifier: Apache-2.0
"""The quantities watched for events, and the search of a Watcher, without any method."""

import math

import numpy as np
import pytest
from near import near
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from rigid_body_sim.mechanics import events
from rigid_body_sim.mechanics.events import Watch, Watcher, watches
from rigid_body_sim.scene.scene import parse_scene

MOMENTS = (1.0, 2.0, 2.7)


def scene(constraint, inertia, more=''):
    return parse_scene(f'scene: s\nbody: {{mass: 1.0, inertia: {inertia}{more}}}\n'
                       f'constraint: {constraint}\neffects: []\ninitial: {{}}\n')


def vector(omega, q=(0.0, 0.0, 0.0, 1.0)):
    return [0.0, *q, *omega, *[0.0] * 6]


def shares_of_a_free_turn(omega):
    """Return the share of the momentum along the middle axis, for a long time.

    By Euler's equations of a free body with the principal moments MOMENTS.
    """
    I1, I2, I3 = MOMENTS

    def rate(_, w):
        return [(I2 - I3) / I1 * w[1] * w[2], (I3 - I1) / I2 * w[2] * w[0],
                (I1 - I2) / I3 * w[0] * w[1]]
    w = solve_ivp(rate, (0.0, 60.0), omega, rtol=1e-10, atol=1e-13, max_step=0.02).y
    return I2 * w[1] / np.linalg.norm(np.multiply(w.T, MOMENTS), axis=1)


@pytest.mark.parametrize('omega', [
    (0.1, 2.0, 0.1), (1.0, 0.5, 0.1), (0.1, 0.5, 1.0), (0.3, 1.0, 0.2), (1.3, -0.4, 0.9),
    (2.0, 0.2, 0.0), (0.0, 0.3, 1.0)])
def test_the_largest_share_along_the_middle_axis_is_what_the_free_motion_reaches(omega):
    """Whether the body goes around its largest or its smallest axis: no flip is invented."""
    (watch,) = watches(scene('free', list(MOMENTS)))
    share = shares_of_a_free_turn(omega)
    assert watch.value(vector(omega)) == near(share[0], rel=1e-14)
    assert watch.largest(vector(omega)) == pytest.approx(np.abs(share).max(), abs=1e-3)


def test_the_middle_axis_is_found_whatever_the_order_and_the_axes_of_the_tensor():
    turn = Rotation.from_rotvec([0.3, -1.1, 0.4]).as_matrix()
    tensor = (turn @ np.diag([2.7, 1.0, 2.0]) @ turn.T)
    (watch,) = watches(scene('free', tensor.tolist()))
    along = turn @ [0.1, 0.2, 1.0]
    expected = 2.0 / math.hypot(0.27, 0.2, 2.0)
    # the sign of a principal axis is arbitrary
    assert abs(watch.value(vector(along))) == near(expected, rel=1e-12)


def test_a_body_at_rest_has_no_share_and_symmetric_bodies_are_not_watched():
    (watch,) = watches(scene('free', list(MOMENTS)))
    still = vector((0.0, 0.0, 0.0))
    assert (watch.value(still), watch.largest(still), watch.share) == (0.0, 0.0, 0.5)
    assert watches(scene('free', [1.0, 1.0, 1.5])) == ()
    assert watches(parse_scene('scene: s\nbody: {mass: 1, shape: {solid_sphere: {radius: 1}}}\n'
                               'constraint: table\neffects: []\ninitial: {}\n')) == ()


def test_a_held_body_is_watched_for_where_its_third_axis_turns_back():
    """The height of body axis 3 is R33; its rate over |omega| is (R (omega x z))_3 / |omega|."""
    (watch,) = watches(scene('pivot', list(MOMENTS), ', center_of_mass: [0, 0, 0.1]'))
    turn, omega = Rotation.from_rotvec([0.4, 0.3, -0.8]), np.array([0.3, -0.7, 0.2])
    expected = turn.apply(np.cross(omega, [0.0, 0.0, 1.0]))[2] / np.linalg.norm(omega)
    found = watch.value(vector(omega, turn.as_quat()))
    assert (watch.name, found) == ('turning point', near(expected, rel=1e-13))
    assert watch.value(vector((0.0, 0.0, 0.0))) == 0.0


def test_a_hinged_body_is_watched_for_a_rate_of_zero():
    (watch,) = watches(scene('{hinge: {axis: [1, 2, -2], through: [0, 0, 1]}}', list(MOMENTS)))
    assert watch.value(vector((1.0, 2.0, -2.0))) == pytest.approx(3.0)
    assert watch.value(vector((-2.0, -4.0, 4.0))) == pytest.approx(-6.0)
    assert (watch.name, watch.share) == ('turning point', 0.0)


class Told:
    """A solver whose state holds a value of time, in place of an angular velocity along x."""

    def __init__(self, value, rate=0.0):
        self.value, self.rate, self.asked = value, rate, []

    def state(self, time, out):
        self.asked.append(time)
        out[:] = 0.0
        out[5], out[8] = self.rate, self.value(time)


def watcher(value, share=0.5, largest=1.0, rate=0.0, swing=0.0, drive=0.0, **more):
    solver = Told(value, rate)
    watch = Watch('crossed', lambda state: state[8], share, lambda state: largest)
    return Watcher(solver, (watch,), 0.0, swing, drive, **more), solver


def test_each_crossing_is_an_event_at_its_time_and_is_told_once():
    found, _ = watcher(np.cos, rate=1.0)
    times = [(k + 0.5) * np.pi for k in range(6)]
    first, second = found.events(7.0), found.events(20.0)
    assert [name for _, name, _ in first] == ['crossed'] * 2
    assert [time for time, _, _ in first + second] == pytest.approx(times, abs=1e-14)
    assert found.events(20.0) == []


def test_a_crossing_counts_only_if_the_value_was_large_since_the_one_before():
    """A wiggle about zero between two true changes of sign."""
    def value(time):
        return 0.3 * math.cos(20.0 * time) if 2.0 < time < 3.0 else math.cos(math.pi * time / 4.0)
    found, _ = watcher(value, rate=10.0)
    [(time, _, _)] = found.events(5.0)
    assert time == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize(('largest', 'count'), [(0.6, 1), (-0.6, 1), (0.5, 1), (0.4, 0)])
def test_before_the_start_the_value_was_as_large_as_the_free_motion_makes_it(largest, count):
    found, _ = watcher(lambda time: 0.1 - time, largest=largest, rate=1.0)
    assert len(found.events(0.3)) == count


def test_a_value_that_is_zero_at_the_start_crosses_there_if_it_goes_below():
    found, _ = watcher(lambda time: -time, rate=1.0)
    assert [time for time, _, _ in found.events(1.0)] == [0.0]
    found, _ = watcher(lambda time: time, rate=1.0)
    assert found.events(1.0) == []


@pytest.mark.parametrize(('rate', 'swing', 'drive'), [
    (4.0, 0.0, 0.0), (0.0, 4.0, 0.0), (3.0, 1.0, 0.0), (0.0, 0.0, 10.0), (2.0, 1.0, 5.0)])
def test_between_two_looks_the_body_turns_by_a_fifth_of_a_radian(rate, swing, drive):
    """The time s in which rate s + drive s^2/2 = 0.2, with what comes to the rate at once."""
    found, solver = watcher(lambda time: 1.0, rate=rate, swing=swing, drive=drive)
    found.events(1.0)
    step = solver.asked[2] - solver.asked[1]
    assert (rate + swing) * step + 0.5 * drive * step * step == near(0.2, rel=1e-12)
    assert solver.asked[-1] == 1.0


@pytest.mark.parametrize(('steps', 'rate', 'step'), [
    (math.inf, 0.0, events.BLINK), (math.inf, 4.0, 0.05), (0.04, 4.0, 0.01),
    (math.inf, 1.0, events.BLINK), (None, 1.0, 0.2), (None, 0.0, 1.0)])
def test_where_nothing_bounds_what_acts_looks_are_a_blink_and_a_quarter_of_a_step_apart_at_most(
        steps, rate, step):
    found, solver = watcher(lambda time: 1.0, rate=rate,
                            step_at=None if steps is None else lambda time: (0.0, steps))
    found.events(1.0)
    assert solver.asked[1] - solver.asked[0] == near(step, rel=1e-12)
    assert solver.asked[-1] == 1.0


def test_a_body_that_turns_back_ever_faster_is_looked_at_as_often_as_its_method_steps():
    """cos(t^3) has its k-th zero at ((k + 1/2) pi)^(1/3); it turns by no angle worth a look."""
    found, _ = watcher(lambda time: math.cos(time ** 3), step_at=lambda time: (
        0.0, 1.0 / (1.0 + 3.0 * time * time)))
    times = [((k + 0.5) * math.pi) ** (1.0 / 3.0) for k in range(40)]
    assert [time for time, _, _ in found.events(5.0)] == pytest.approx(times, abs=1e-14)


@pytest.mark.parametrize('steps', [1e-7, 1e-3])
def test_short_steps_are_no_turn_between_two_looks(steps):
    found, solver = watcher(np.cos, rate=1.0, step_at=lambda time: (0.0, steps))
    times = [time for time, _, _ in found.events(2.0, tick=1.0)]
    assert times == [pytest.approx(0.5 * math.pi, abs=1e-14)]
    assert len(solver.asked) < 2 * events.LOOKS_A_TICK + 100


def test_a_tick_is_looked_at_a_bounded_number_of_times():
    """A body at 1e9 rad/s: its changes of sign are passed over, and after it slows they count."""
    found, solver = watcher(np.cos, rate=1e9)
    assert found.events(2.0, tick=1.0) == []
    assert len(solver.asked) < 2 * events.LOOKS_A_TICK // 32 + 10
    solver.rate = 1.0
    assert [time for time, _, _ in found.events(6.0, tick=1.0)][-1] == pytest.approx(1.5 * np.pi)


def test_events_of_two_watches_come_in_order_of_time():
    solver = Told(np.cos, 1.0)
    two = [Watch(name, lambda state, shift=shift: math.cos(state[0] + shift), 0.5, lambda _: 1.0)
           for name, shift in (('late', 0.0), ('early', 0.1))]
    solver.state = lambda time, out: out.__setitem__(slice(0, 6), (time, 0, 0, 0, 1, 1.0))
    names = [name for _, name, _ in Watcher(solver, two, 0.0, 0.0, 0.0).events(5.0)]
    assert names == ['early', 'late', 'early', 'late']
