# SPDX-License-Identifier: Apache-2.0
"""Errors that are largest where a step ends: of bodies that slow down, and turn in long steps."""

import math
import types

import numpy as np
import pytest
from choice.known_bodies import Coasting, coasting_scene

from rigid_body_sim.choice import forecast, runs, trial_runs
from rigid_body_sim.choice.trial import Trial
from rigid_body_sim.errors import NotConverged
from rigid_body_sim.integrators.marching.work import TooMuchWork
from rigid_body_sim.numerics.rotations import angle_between
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

pytestmark = pytest.mark.without_numba

STOPPED = """
scene: stopped
body: {mass: 1, inertia: [0.030, 0.035, 0.036]}
constraint: pivot
effects: [drag: {angular: 2}]
initial: {angular_velocity: [-27, -30, -40]}
"""
SLOWER = 'drag: {linear: 0, angular: 1.0}'


def test_what_a_body_errs_before_it_stops_is_met_and_foretold():
    """Drag of 60/s stops it within a step of gauss16, and two looks of a trial.

    At the looks it erred by 1.8e-12 rad, as was told, and by 1.3e-11 where a step ended.
    """
    scene, end = parse_scene(STOPPED), 14.0
    one = Simulation(scene, accuracy=1e-11, horizon=end)
    assert one.choice.method == 'gauss16'
    times = np.geomspace(1e-3, 1.0, 100)
    error = max(angle_between(*own, *best) for own, best in zip(
        one.states(times).orientation,
        Simulation(scene, 'dop8', 1e-14, horizon=end).states(times).orientation, strict=True))
    assert error < 1e-11                                        # 1.0e-12
    assert 0.5 < one.choice.expected_error / error < 2.0        # 1.1


class Stepping(Coasting):
    """A body that coasts by steps of half a second from each start."""

    def start(self, vector):
        started = super().start(vector)
        started.__class__ = Stepping
        return started

    def step_ends(self, until, most):
        if until > self.limit:
            raise self.what
        ends = [self.vector[0] + 0.5 * k for k in range(1, 99)]
        found = [end for end in ends if end < until]
        return found if len(found) <= most else None


def test_steps_begin_anew_at_each_strike(monkeypatch):
    """Those of a run that does not converge are not known, and too much work is said."""
    scene = coasting_scene((2.25, -4.0), (0.75, 8.0), (9.0, 1.0))
    start = scene.initial.vector
    monkeypatch.setattr(Stepping, 'limit', math.inf, raising=False)
    found = runs.step_ends(scene, Stepping(), start, 3.0, 5)
    assert found == [0.5, 1.25, 1.75, 2.75]
    assert runs.step_ends(scene, Stepping(), start, 3.0, 4) == found
    assert runs.step_ends(scene, Stepping(), start, 3.0, 3) is None
    monkeypatch.setattr(Stepping, 'limit', 2.5)
    monkeypatch.setattr(Stepping, 'what', NotConverged('no further'), raising=False)
    assert runs.step_ends(scene, Stepping(), start, 3.0, 5) is None
    monkeypatch.setattr(Stepping, 'what', TooMuchWork('too long'))
    with pytest.raises(TooMuchWork):
        runs.step_ends(scene, Stepping(), start, 3.0, 5)


@pytest.mark.parametrize(('rates', 'effects', 'slowed'), [
    ([2.0, 1.0, 0.99], [SLOWER], True), ([2.0, 1.0, 1.0], [SLOWER], False),
    ([1.0, 1.0, 1.0], [SLOWER], False), ([2.0, 1.0, 0.1], [], False),
    ([2.0, 1.0, math.nan], [SLOWER], False)])
def test_a_body_has_slowed_where_heat_leaves_less_than_half_of_its_largest_rate(
        rates, effects, slowed):
    scene, states = coasting_scene(effects=effects), np.zeros((3, 14))
    scene.initial.angular_velocity[:] = 0.0
    states[:, 7] = rates
    assert forecast.has_slowed(scene, states) == slowed
    scene.initial.angular_velocity[2] = 3.0    # the start counts, too
    assert forecast.has_slowed(scene, states) == (slowed or (bool(effects) and rates[2] < 1.5))


def test_what_ends_of_steps_add_counts_from_the_next_look_on(monkeypatch):
    scene = coasting_scene(effects=[SLOWER])
    trial = types.SimpleNamespace(
        _scene=scene, _times=np.array([1.0, 2.0, 3.0, 4.0]), _most=9, _at_ends={},
        _states=lambda tolerance: None, prototype=types.SimpleNamespace(at=lambda one, most: one))
    trial._apart_at_ends = types.MethodType(Trial._apart_at_ends, trial)
    slowed, ends, made, asked = [True], [[0.5, 1.5, 1.6, 3.5]], [], []

    def turned(scene, tolerance, start, times):
        """Return states that are turned about z, the finer ones by nothing."""
        made.append(tolerance)
        out = np.zeros((len(times), 14))
        angle = np.array([1e-9, 4e-9, 2e-9, 3e-9])[:len(times)] * (tolerance == 1e-6)
        out[:, 3], out[:, 4] = np.sin(0.5 * angle), np.cos(0.5 * angle)
        return out
    monkeypatch.setattr(forecast, 'has_slowed', lambda scene, states: slowed[0])
    monkeypatch.setattr(runs, 'step_ends', lambda *given: asked.append(given[1:]) or ends[0])
    monkeypatch.setattr(runs, 'run', turned)
    errors = np.array([2e-9, 1e-9, 3e-9, 1e-9])
    added = Trial._between_looks(trial, 1e-6, 1e-9, errors)
    # the largest so far is 1, 4, 4, 4 at ends, and 2, 2, 3, 3 at looks
    assert added == pytest.approx([0.0, 2e-9, 1e-9, 1e-9], rel=1e-6, abs=1e-15)
    assert made == [1e-6, 1e-9]
    assert [(one, *rest) for one, _, *rest in asked] == [(1e-6, 4.0, trial_runs.ENDS)]
    Trial._between_looks(trial, 1e-6, 1e-9, errors)
    assert made == [1e-6, 1e-9]    # each pair is compared once
    for none in ([], None):
        ends[0], trial._at_ends = none, {}
        assert not Trial._between_looks(trial, 1e-6, 1e-9, errors).any()

    def takes_too_much(*given):
        raise TooMuchWork('too long')
    monkeypatch.setattr(runs, 'step_ends', takes_too_much)
    trial._at_ends = {}
    assert not Trial._between_looks(trial, 1e-6, 1e-9, errors).any()
    slowed[0], trial._at_ends = False, {(1e-6, 1e-9): np.ones(4)}
    assert not Trial._between_looks(trial, 1e-6, 1e-9, errors).any()
