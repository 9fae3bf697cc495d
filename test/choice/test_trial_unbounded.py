# SPDX-License-Identifier: Apache-2.0
"""Trials of bodies that something pushes whose bounds nobody knows, and that repeat themselves.

A torsion spring of period 1 s is let go from 1 rad: angle = cos(2 pi t). What it could turn is
known from a run only.
"""

import math

import numpy as np
import pytest
from near import near

from rigid_body_sim.choice import runs, trial_runs, trial_time
from rigid_body_sim.choice.trial import Trial
from rigid_body_sim.choice.trial_on_plane import TrialOnPlane
from rigid_body_sim.integrators.marching.work import TooMuchWork
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

RATE = 2.0 * math.pi
MOMENT = 0.03
SWINGING = parse_scene(f"""
scene: swinging
body: {{mass: 1.0, inertia: [{MOMENT}, 0.03, 0.01]}}
constraint: {{hinge: {{axis: [1, 0, 0]}}}}
effects: [spring: {{stiffness: {MOMENT * RATE * RATE!r}}}]
initial: {{angle: 1.0}}
""")


def error(simulation, horizon):
    """Return the largest error of the angle over 300 times, rad."""
    times = horizon * (np.arange(1, 301) / 300.0)
    x, _, _, w = simulation.states(times).orientation.T
    apart = 2.0 * np.arctan2(x, w) - np.cos(RATE * times)
    return float(np.abs((apart + math.pi) % (2.0 * math.pi) - math.pi).max())


@pytest.mark.without_numba
def test_an_error_that_does_not_show_where_the_body_turns_back_is_foretold():
    """Two even looks in each of 32 periods would see it turn back and nothing else."""
    swung = Simulation(SWINGING, accuracy=1e-3, horizon=32.0)
    found = error(swung, 32.0)
    # measured: 0.99 times the expected one
    assert swung.choice.expected_error / 2.0 < found < 2.0 * swung.choice.expected_error
    assert found < 1e-3


@pytest.mark.without_numba
def test_how_far_a_body_turns_shows_in_a_run(monkeypatch):
    """It turns by 4 rad in a period; the largest rate from each moment on counts, 2 pi."""
    monkeypatch.setattr(trial_time, 'RADIANS', 20.0)
    tried = Trial(SWINGING, 1e-6, 8.0, 'dop8', 1e-7, 1, True)
    assert RATE * 7.5 < tried._pace_seen() * 8.0 < RATE * 8.0
    # so the trial ends where it could have turned by 20 rad
    assert tried._times[-1] == near(20.0 / RATE, rel=0.06)
    assert tried._radians == near(20.0, rel=1e-9)
    assert tried._longer == near(8.0 / tried._times[-1], rel=1e-12)


def cut_short(monkeypatch, able):
    """Return a Trial of 8 s whose runs reach `able` s, and the times up to which they were."""
    made = []

    def run(self, tolerance, most):
        made.append(float(self._times[-1]))
        if made[-1] > able:
            raise TooMuchWork('too many', able)
        states = np.zeros((runs.LOOKS, 14))
        states[:, 5] = 3.0
        return states
    monkeypatch.setattr(Trial, '_run', run)
    return Trial(SWINGING, 1e-6, 8.0, 'dop8', 1e-7, 1, True), made


def test_where_a_run_takes_too_much_work_the_trial_is_a_part_of_what_it_reached(monkeypatch):
    tried, made = cut_short(monkeypatch, 2.0)
    assert made == [8.0, 0.5]
    assert (tried._times[-1], tried._longer) == (0.5, 16.0)
    # 3 rad/s from the first look on, at 0.53/64 of the time, and less before it
    assert tried._radians == near(1.5, rel=0.01)
    # the run that showed it stands
    assert list(tried._runs) == [tried._coarsest]


@pytest.mark.parametrize('able', [0.0, 5e-324])
def test_where_no_part_can_be_run_the_search_tells(able, monkeypatch):
    tried, made = cut_short(monkeypatch, able)
    assert len(made) <= trial_runs.CUTS
    assert tried._radians == 0.0


def test_a_run_that_fails_shows_no_rate(monkeypatch):
    monkeypatch.setattr(Trial, '_run', lambda *_: np.full((runs.LOOKS, 14), math.nan))
    tried = Trial(SWINGING, 1e-6, 8.0, 'dop8', 1e-7, 1, True)
    assert (tried._radians, tried._times[-1]) == (0.0, 8.0)


def test_on_a_plane_the_whole_time_is_tried():
    assert TrialOnPlane._pace_seen(None) == 0.0


@pytest.mark.without_numba
def test_the_momentum_of_a_spring_that_turns_back_balances():
    """At 1 s it is at rest again, as it was at the start: its momentum on the way is the size."""
    swung = Simulation(SWINGING, accuracy=1e-9, rate=1.0, horizon=1.0)
    swung.advance(1)
    assert abs(swung.state.angular_velocity[0]) < 1e-7
    # measured: 4e-10; beside the momenta of start and end it was 0.15
    assert swung.ledger()['momentum_residual'] < 1e-8
