# SPDX-License-Identifier: Apache-2.0
"""auto on a plane: shipped scenes beside references of 34 digits, with their events.

test/data/make_plane_scenes.py makes the references. A tossed coin has none: its 115 impacts are
compared with the finest run.
"""

import functools
import json
import pathlib

import numpy as np
import pytest

from rigid_body_sim.numerics.rotations import angles_between
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.simulation.simulation import Simulation

REFERENCES = json.loads((pathlib.Path(__file__).parents[1] / 'data/plane_scenes.json').read_text())
ACCURACIES = 1e-3, 1e-5, 1e-7, 1e-9, 1e-11
FINEST = 1e-15


COIN_TIMES = tuple(0.5 * k for k in range(1, 21))


@functools.cache
def finest(name, times):
    """Return the orientations of the finest run, shape (n, 4)."""
    return Simulation(name, 'dop8', FINEST).states(times).orientation


def error(simulation, times, true):
    """Return the largest error of the attitude at times (rad), beside orientations (n, 4)."""
    angles = np.empty(len(times))
    angles_between(simulation.states(times).orientation, np.array(true, dtype=float), angles)
    return float(angles.max())


@pytest.mark.parametrize('name', REFERENCES)
def test_the_finest_run_meets_the_reference_and_its_events_to_round_off(name):
    """Measured: at most 3e-13 rad and 1e-13 s, in 900 rad of the tippe top and the egg."""
    case = REFERENCES[name]
    simulation = Simulation(name, 'dop8', FINEST)
    assert error(simulation, case['times'], case['orientations']) < 6e-13
    for event, time in case['events']:
        assert simulation.at_event(event).time == pytest.approx(float(time), abs=4e-13)


@pytest.mark.parametrize('name', REFERENCES)
def test_auto_keeps_and_foretells_the_accuracy_that_is_asked(name):
    case, scene = REFERENCES[name], load_scene(name)
    for accuracy in ACCURACIES:
        simulation = Simulation(scene, 'auto', accuracy, horizon=case['times'][-1])
        found = error(simulation, case['times'], case['orientations'])
        assert found <= accuracy
        # neither too bold nor too careful; measured: 0.6 to 1.5
        assert found / 3.0 <= simulation.expected_error <= 3.0 * found + 1e-13
        assert simulation.missed is None
        for event, time in case['events']:
            assert simulation.at_event(event).time == pytest.approx(float(time), abs=accuracy)


@pytest.mark.parametrize('accuracy', [1e-3, 1e-6, 1e-9])
def test_auto_keeps_its_promise_through_every_impact_of_a_coin(accuracy):
    simulation = Simulation('tossed_coin', 'auto', accuracy, horizon=10.0)
    found = error(simulation, COIN_TIMES, finest('tossed_coin', COIN_TIMES))
    assert found <= max(accuracy, simulation.expected_error)
    assert simulation.expected_error <= accuracy


def test_a_rattleback_says_until_when_an_accuracy_is_met_that_its_motion_does_not_allow():
    """Its errors grow a million times in twenty seconds: finer steps put that off."""
    simulation = Simulation('rattleback', 'auto', 1e-9, horizon=100.0)
    assert simulation.expected_error > 1e-9
    until = simulation.choice.met_until
    assert 15.0 < until < 40.0
    assert 'is missed' in simulation.missed
    times = tuple((0.045 * until * np.arange(1, 21)).tolist())
    assert error(simulation, times, finest('rattleback', times)) <= 1e-9
