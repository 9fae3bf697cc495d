# SPDX-License-Identifier: Apache-2.0
"""Trials on a plane, with runs whose errors and work are made up."""

import math

import numpy as np
import pytest
from near import near

from rigid_body_sim.choice import runs, trial_on_plane
from rigid_body_sim.choice.trial_on_plane import COARSE, DEAR, WITHIN, TrialOnPlane
from rigid_body_sim.integrators.marching.work import TooMuchWork
from rigid_body_sim.scene.scene import parse_scene

BALL = """
scene: ball
body: {mass: 2, inertia: [1, 1, 1], surface: {sphere: {radius: 0.5}}}
constraint: {table: {}}
effects: [gravity: {g: G}, sliding_friction: {mu: 0.2}]
initial: {velocity: [3, 0, 4], angular_velocity: [2, 6, 3]}
"""
HORIZON = 8.0


@pytest.fixture
def tried():
    """Return the trial of a ball, of 1e-9 rad over 8 s."""
    return TrialOnPlane(parse_scene(BALL.replace('G', '9.81')), 1e-9, HORIZON, 'dop8', None, 1,
                        True)


def turned(angle):
    """Return states that are turned about z by an angle, rad."""
    states = np.zeros((runs.LOOKS, 14))
    states[:, 3], states[:, 4] = math.sin(0.5 * angle), math.cos(0.5 * angle)
    states[:, 7] = 1.0
    return states


def made_up(monkeypatch, tried, errors, works=()):
    """Let runs be turned by errors(tolerance), unless one of `works` is beyond what is allowed."""
    asked = []

    def run(tolerance, most):
        asked.append((tolerance, most))
        if dict(works).get(tolerance, 0) > most:
            raise TooMuchWork('too long')
        return turned(errors(tolerance))
    monkeypatch.setattr(tried, '_run', run)
    return asked


def test_where_runs_take_too_much_work_nothing_is_told(tried, monkeypatch):
    """The accuracy asked was told, as if measured; a body that had fallen erred by 3 rad."""
    tried._promised = 1e-9
    made_up(monkeypatch, tried, lambda tolerance: 0.0, {2.0 ** -k: math.inf for k in range(60)})
    assert tried.forecast(2.0 ** -30) == (None, None)


def test_a_search_begins_at_eight_times_the_tolerance_given(tried):
    assert tried._likely(1e-6) == 8e-6


def test_the_finer_run_of_the_trial_tells_whether_it_is_dear(tried, monkeypatch):
    finer = 2.0 ** -24    # below 2^-7 of eight times 1e-6
    asked = made_up(monkeypatch, tried, lambda tolerance: 0.0, {finer: DEAR})
    assert not tried._dear(1e-6)
    assert asked == [(finer, DEAR)]
    assert tried._runs.keys() == {finer}
    made_up(monkeypatch, tried, lambda tolerance: 0.0, {finer: DEAR + 1})
    assert tried._dear(1e-6)


@pytest.mark.parametrize('dear', [False, True])
def test_where_a_trial_is_dear_two_coarse_runs_tell(dear, tried, monkeypatch):
    monkeypatch.setattr(tried, '_dear', lambda tolerance: dear)
    monkeypatch.setattr(tried, '_careful', lambda: 'careful')
    monkeypatch.setattr(TrialOnPlane, 'tolerance_from', lambda self, tolerance: tolerance)
    tried._radians, tried._promised = 100.0, 1e-9
    assert tried.take(1e-6) == ('careful' if dear else 1e-6)


@pytest.mark.parametrize(('factor', 'expected'), [
    # errors go with the tolerance: an eighth of what meets 1e-9, on the grid below
    (8.0, 2.0 ** -36), (64.0, 2.0 ** -39),
    # errors below the tolerance: they are taken to go with it
    (0.1, 2.0 ** -33)])
def test_an_eighth_of_what_two_coarse_runs_lead_to_is_taken(factor, expected, tried,
                                                            monkeypatch):
    coarse, finer = COARSE
    asked = made_up(monkeypatch, tried, lambda one: factor * one * coarse / (coarse - finer))
    assert tried._careful() == expected
    assert asked == [(coarse, WITHIN), (finer, WITHIN)]


@pytest.mark.parametrize(('far', 'works'), [
    (0.31, {}), (0.29, {}), (0.0, {COARSE[0]: WITHIN + 1}), (0.0, {COARSE[1]: WITHIN + 1}),
    (0.0, {COARSE[0]: WITHIN})])
def test_where_coarse_runs_part_or_are_long_the_finest_is_taken(far, works, tried, monkeypatch):
    made_up(monkeypatch, tried, lambda one: far * (one == COARSE[0]), works)
    monkeypatch.setattr(tried, '_cancelling', lambda: 0.0)
    finest = tried._grid(128.0 * tried._finest)
    known = far < 0.3 and all(work <= WITHIN for work in works.values())
    assert (tried._careful() == finest) == (not known)
    monkeypatch.setattr(tried, '_cancelling', lambda: 1e-5)
    if not known:
        assert tried._careful() == 2.0 ** -17    # below 1e-5


@pytest.mark.parametrize(('g', 'heaviness'), [('8', 8.0), ('1e-9', 1e-3)])
def test_the_finest_tolerance_is_where_forces_cancel(g, heaviness):
    """Falls and turns of the size of the ball count: 5 + 7 x 0.5 + sqrt(g 0.5) m/s."""
    tried = TrialOnPlane(parse_scene(BALL.replace('G', g)), 1e-9, HORIZON, 'dop8', None, 1, True)
    speed = 8.5 + math.sqrt(0.5 * heaviness)
    expected = trial_on_plane.CANCELS * 16.0 * heaviness / speed * HORIZON
    assert tried._cancelling() == near(expected, rel=1e-14)
