# SPDX-License-Identifier: Apache-2.0
"""Expectations of theory for states and events that are made up, with what they see in them."""

import math
import types

import numpy as np
import pytest
from near import near

from rigid_body_sim.numerics.rotations import from_euler_zyz, rotate, rotate_back
from rigid_body_sim.scene.bodies import Inertia
from rigid_body_sim.theory.expectations import Interval, Relaxing, Rolling, Steady, Turning

AXES = (0.0, 0.6, 0.0, 0.8)
MOMENTS = 1.0, 3.0, 2.0


def state(time, omega=(0.0, 0.0, 0.0), velocity=(0.0, 0.0, 0.0), orientation=(0.0, 0.0, 0.0, 1.0)):
    return types.SimpleNamespace(
        time=time, angular_velocity=np.array(omega), velocity=np.array(velocity),
        orientation=np.array(orientation))


def check(found, rel, **expected):
    """Assert that words are these, and that numbers are near to these."""
    words = {key: value for key, value in expected.items() if isinstance(value, str)}
    assert {key: value for key, value in found.items() if isinstance(value, str)} == words
    assert {key: value for key, value in found.items() if key not in words} == near(
        {key: value for key, value in expected.items() if key not in words}, rel)


def test_an_interval_is_between_the_last_two_events_of_its_name():
    expected = Interval('flip', 4.0)
    for name, time in (('flip', 1.0), ('impact', 2.0), ('flip', 4.0), ('flip', 9.0)):
        expected.note(name, time)
    check(expected.compared(), 1e-15, event='flip', predicted_interval=4.0,
          measured_interval=5.0, predicted_frequency=math.pi / 4.0,
          measured_frequency=math.pi / 5.0, relative_difference=0.25)


def direction(seen):
    """Return the two components of omega across the axis, from the time of a state."""
    return lambda state: (2.0 * math.cos(seen(state.time)), 2.0 * math.sin(seen(state.time)))


def test_omega_turns_by_whole_turns_as_predicted_and_by_the_rest_as_seen():
    """In 4 s theory says 24 rad; what is seen is 0.1, 2.0 and then 4.8 rad further."""
    ahead = {10.0: 0.0, 11.0: 0.1, 13.0: 2.0, 14.0: 4.8}
    expected = Turning(lambda time: 6.0 * time,
                       direction(lambda time: 6.0 * time + ahead[time]), state(10.0))
    expected.look(state(11.0))
    expected.look(state(13.0))
    expected.look(state(14.0))
    check(expected.compared(), 1e-13, quantity='omega round the axis', predicted_rate=6.0,
          measured_rate=7.2, relative_difference=0.2)


def test_before_omega_is_seen_to_turn_its_rate_is_that_of_the_next_second():
    expected = Turning(lambda time: 3.0 * time**2, direction(lambda time: 0.5), state(10.0))
    assert expected.compared() == {'quantity': 'omega round the axis', 'predicted_rate': 3.0}


def relaxing(*omegas):
    """Return the comparison after looks at angular velocities along the principal axes."""
    body = types.SimpleNamespace(about_center=Inertia(MOMENTS, AXES))
    states = [state(float(k), rotate(*AXES, *omega)) for k, omega in enumerate(omegas)]
    expected = Relaxing(types.SimpleNamespace(body=body), states[0])
    for one in states[1:]:
        expected.look(one)
    return expected.compared()


def test_the_least_energy_is_that_of_the_angular_momentum_about_the_largest_axis():
    check(relaxing((4.0, 2.0, 1.5)), 1e-14, quantity='least energy at this angular momentum',
          predicted_energy=(16.0 + 36.0 + 9.0) / 6.0)


@pytest.mark.parametrize(('before', 'after', 'settled'), [
    # twice as much of the energy
    ((0.0, 10.0 * (1.0 + 0.35e-9), 0.0), (0.0, 10.0, 0.0), True),
    ((0.0, 10.0 * (1.0 + 0.7e-9), 0.0), (0.0, 10.0, 0.0), False),
    ((0.0, 0.1 * (1.0 + 0.35e-9), 0.0), (0.0, 0.1, 0.0), True),
    ((0.0, 0.1 * (1.0 + 0.7e-9), 0.0), (0.0, 0.1, 0.0), False),
    # the angular momentum is 30 or 0.3, of which a thousandth may lie across
    ((0.024, 10.0, 0.0), (0.024, 10.0, 0.0), True),
    ((0.036, 10.0, 0.0), (0.036, 10.0, 0.0), False),
    ((0.0, 10.0, 0.012), (0.0, 10.0, 0.012), True),
    ((0.0, 10.0, 0.018), (0.0, 10.0, 0.018), False),
    ((2.4e-4, 0.1, 0.0), (2.4e-4, 0.1, 0.0), True),
    ((3.6e-4, 0.1, 0.0), (3.6e-4, 0.1, 0.0), False),
    # it turns about another axis without loss
    ((10.0, 0.0, 0.0), (10.0, 0.0, 0.0), False)])
def test_heat_has_ended_once_the_energy_stays_and_the_wobble_is_gone(before, after, settled):
    found = relaxing((0.0, 1.0, 0.0), before, after)
    assert ('measured_energy' in found) == settled
    if settled:
        energy = 0.5 * np.array(MOMENTS) @ np.square(after)
        assert found['measured_energy'] == near(energy, rel=1e-13)
        assert found['relative_difference'] == near(energy / 1.5 - 1.0, rel=1e-12)


def test_one_look_does_not_tell_that_heat_has_ended():
    assert 'measured_energy' not in relaxing((0.0, 1.0, 0.0), (0.0, 1.0, 0.0))
    assert 'measured_energy' in relaxing(*[(0.0, 1.0, 0.0)] * 3)


def test_a_steady_rate_is_that_about_the_hinge():
    expected = Steady(5.0, (0.6, 0.0, 0.8))
    assert 'measured_rate' not in expected.compared()
    expected.look(state(1.0, (2.0, 7.0, 6.0)))
    check(expected.compared(), 1e-14, quantity='rate after the blow', predicted_rate=5.0,
          measured_rate=6.0, relative_difference=0.2)


QUARTER = from_euler_zyz(0.4, 1.1, -2.0)


def ball(start, mu=0.25, g=8.0):
    """Return the expectation for a ball of mass 2, radius 0.5 and moment 0.2."""
    body = types.SimpleNamespace(about_center=Inertia((0.2, 0.2, 0.2)), mass=2.0, radius=0.5)
    return Rolling(types.SimpleNamespace(
        body=body, contact=types.SimpleNamespace(mu=mu, g=g)), start)


SLIPPING = state(10.0, rotate_back(*QUARTER, 3.0, -4.0, 5.0), (1.0, 2.0, 0.0), QUARTER)
"""Its rim goes forward at (-2, -1.5) m/s, so it slips at (3, 3.5) m/s; I/(m a^2) is 0.4."""


def test_a_ball_that_slips_rolls_after_a_time_at_a_speed():
    expected = ball(SLIPPING)
    time = math.hypot(3.0, 3.5) * 0.4 / (1.4 * 2.0)
    speed = math.hypot(1.0 - 0.8, 2.0 - 0.6) / 1.4
    predicted = {'event': 'rolling began', 'predicted_time': time, 'predicted_speed': speed}
    check(expected.compared(), 1e-14, **predicted)
    expected.note('impact', 10.5)
    expected.note('rolling began', 10.0 + 1.1 * time)
    expected.note('rolling began', 12.0)
    expected.look(state(10.5, velocity=(7.0, 0.0, 0.0)))    # it slips still
    assert 'measured_speed' not in expected.compared()
    expected.look(state(11.0, velocity=(0.6 * 0.95 * speed, 0.8 * 0.95 * speed, 0.0)))
    check(expected.compared(), 1e-13, **predicted, measured_time=1.1 * time,
          measured_speed=0.95 * speed, relative_difference=0.1)


def test_the_larger_difference_of_time_and_speed_is_told():
    expected = ball(SLIPPING)
    predicted = expected.compared()
    expected.note('rolling began', 10.0 + 1.1 * predicted['predicted_time'])
    expected.look(state(12.0, velocity=(0.8 * predicted['predicted_speed'], 0.0, 0.0)))
    assert expected.compared()['relative_difference'] == near(-0.2, rel=1e-13)


def test_a_ball_at_rest_or_rolling_has_begun_to_roll():
    assert ball(state(10.0)).compared() == {
        'event': 'rolling began', 'predicted_time': 0.0, 'measured_time': 0.0,
        'predicted_speed': 0.0, 'measured_speed': 0.0, 'relative_difference': 0.0}
    assert ball(state(10.0, (0.0, 4.0, 0.0), (2.0, 0.0, 0.0))).compared() == {
        'event': 'rolling began', 'predicted_time': 0.0, 'measured_time': 0.0,
        'predicted_speed': 2.0, 'measured_speed': 2.0, 'relative_difference': 0.0}


@pytest.mark.parametrize(('ulps', 'rolls'), [(60, True), (130, False)])
def test_a_slip_of_some_ulps_is_rolling(ulps, rolls):
    """The bound is 1e-14 of the sum of both speeds, here 2 m/s: 90 ulps."""
    start = state(10.0, (0.0, 2.0, 0.0), (1.0 + ulps * 2.0**-52, 0.0, 0.0))
    assert (ball(start).compared()['predicted_time'] == 0.0) == rolls


@pytest.mark.parametrize(('mu', 'g'), [(0.0, 8.0), (0.25, 0.0)])
def test_a_ball_without_friction_slips_for_ever(mu, g):
    assert ball(SLIPPING, mu, g).compared() == {}
