# SPDX-License-Identifier: Apache-2.0
"""How long trials are, by hand."""

import math

import pytest
from choice.known_bodies import coasting_scene
from near import near

from rigid_body_sim.choice import trial_time
from rigid_body_sim.mechanics.bounds import drives


@pytest.mark.parametrize(('rate', 'push'), [(3.0, 0.0), (0.0, 0.5), (3.0, 0.5), (1e200, 0.0)])
def test_a_trial_is_as_long_as_it_takes_to_turn_by_its_angle(rate, push):
    time = trial_time.trial_time([0.0], rate, [(0.0, push)])
    assert rate * time + 0.5 * push * time * time == near(trial_time.RADIANS, rel=1e-12)


def test_a_body_at_rest_is_tried_to_the_horizon():
    assert trial_time.trial_time([0.0], 0.0, [(0.0, 0.0)]) == math.inf


@pytest.mark.parametrize(('strikes', 'expected'), [
    ([7.0, 5.0], 17.0), ([25.0, 5.0], 15.0), ([20.0], 10.0), ([70.0], 87.5), ([89.0], 100.0)])
def test_a_trial_goes_on_behind_the_last_strike_within_the_horizon(strikes, expected):
    """At 2000 rad/s it takes 10 s for the angle; strikes beyond ten times that are not waited for.

    A strike at the horizon is not within it. A quarter more than up to a late one is tried.
    """
    scene = coasting_scene(*((time, 1.0) for time in sorted(strikes)))
    horizon = 1000.0 if strikes[0] > 60.0 else 20.0
    changes = trial_time.changes(scene, horizon)
    assert changes == [0.0, *sorted(time for time in strikes if time < horizon)]
    assert trial_time.trial_time(changes, 2000.0, [(0.0, 0.0)]) == near(expected, rel=1e-12)


PULSE = 'torque: {times: [0, 3, 8], values: [[0, 0, 1], [0, 0, 4], [0, 0, 0]], frame: body}'
LATE = PULSE.replace('[0, 3', '[1, 3')


@pytest.mark.parametrize(('effects', 'changes', 'pushes'), [
    ((PULSE,), [0.0, 3.0, 8.0], [(0.0, 1.0), (3.0, 4.0), (8.0, 0.0)]),
    ((LATE,), [0.0, 1.0, 3.0, 8.0], [(0.0, 0.0), (1.0, 1.0), (3.0, 4.0), (8.0, 0.0)]),
    ((LATE, 'torque: {value: [0, 0, 1], frame: body}'),
     [0.0, 1.0, 3.0, 8.0], [(0.0, 1.0), (1.0, 2.0), (3.0, 5.0), (8.0, 1.0)]),
    # one of zero jumps nowhere
    (('torque: {times: [2, 4], values: [[0, 0, 0], [0, 0, 0]]}',), [0.0],
     [(0.0, 0.0), (2.0, 0.0), (4.0, 0.0)])])
def test_torques_change_the_motion_where_they_jump(effects, changes, pushes):
    scene = coasting_scene(effects=effects)
    least = min(scene.body.about_center.moments)
    assert trial_time.changes(scene, 20.0) == changes
    assert drives(scene) == [(time, near(torque / least, rel=1e-15)) for time, torque in pushes]


@pytest.mark.parametrize(('changes', 'rate', 'pushes', 'turned'), [
    # angle up to the last change, at most; then RADIANS; up to ten times RADIANS in all
    ([0.0, 30.0, 40.0], 1e3, [(0.0, 0.0)], 4e4 + 2e4),
    ([0.0, 30.0, 40.0], 1e3, [(0.0, 0.0), (30.0, 5.0)], 4e4 + 250.0 + 2e4),
    ([0.0, 500.0], 1e3, [(0.0, 0.0)], 2e5),
    ([0.0, 150.0], 1e3, [(0.0, 0.0), (100.0, 100.0)], 2e5),
    ([0.0, 250.0], 1e3, [(0.0, 0.0), (250.0, 100.0)], 2e5),
    # a pulse adds 50 rad/s in five seconds, and is over
    ([0.0, 10.0, 15.0], 0.0, [(0.0, 0.0), (10.0, 10.0), (15.0, 0.0)], 125.0 + 2e4)])
def test_a_trial_goes_on_behind_the_last_jump_of_a_torque(changes, rate, pushes, turned):
    time = trial_time.trial_time(changes, rate, pushes)
    angle, speed = 0.0, rate
    for (begin, push), end in zip(pushes, [*(one[0] for one in pushes[1:]), time], strict=True):
        part = min(end, time) - begin
        if part > 0.0:
            angle += speed * part + 0.5 * push * part * part
            speed += push * part
    assert angle == near(turned, rel=1e-12)
    assert trial_time.turned_by(time, rate, pushes) == near(turned, rel=1e-12)


def test_a_body_at_rest_turns_where_it_is_driven():
    """0.5 * 2 * 3^2 up to the end of a push, and 6 rad/s from then on."""
    pushes = [(0.0, 0.0), (1.0, 2.0), (4.0, 0.0)]
    assert [trial_time.turned_by(time, 0.0, pushes) for time in (0.5, 1.0, 3.0, 4.0, 6.0)] == [
        0.0, 0.0, 4.0, 9.0, 21.0]
