# SPDX-License-Identifier: Apache-2.0
"""Every effect of the table goes where a scene can go: none is known to one part only."""

import json

import numpy as np
import pytest
from scene import effect_cases

from rigid_body_sim.analysis.resimulate import main as resimulate
from rigid_body_sim.cli.simulate import main as simulate
from rigid_body_sim.scene.effects import EFFECTS
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.ensemble import ensemble
from rigid_body_sim.simulation.simulation import Simulation


def test_every_effect_of_the_table_has_a_case():
    assert set(effect_cases.CASES) == set(EFFECTS)
    for name, number in effect_cases.ALL:
        scene = parse_scene(effect_cases.text(name, number))
        assert any(isinstance(effect.name, str) and effect.name.startswith(name)
                   for effect in scene.effects)


def simulated(*arguments):
    return simulate(['--rate', '100', '--integrator', 'dop8', '--accuracy', '1e-10',
                     *map(str, arguments)])


@pytest.mark.without_numba
def test_it_goes_through_commands_ledger_recording_resimulation_and_set(tmp_path, capsys):
    for name, number in effect_cases.ALL:
        case = f'{name}, scene {number}'
        scene = tmp_path / f'{name}_{number}.yaml'
        scene.write_text(effect_cases.text(name, number))
        changed = effect_cases.override(name, number)
        states = []
        folder = tmp_path / f'{name}_{number}'
        for arguments in ((), ('--set', changed, '--output', folder)):
            assert simulated('--scene', scene, '--duration', 0.02, '--json', *arguments) == 0, case
            found = json.loads(capsys.readouterr().out)
            states.append(found['state'])
            assert abs(found['ledger']['energy_residual']) < 1e-9, case
        assert resimulate([str(folder)]) == 0, case
        assert capsys.readouterr().out.startswith('identical'), case
        assert states[0] != states[1], f'{case}: {changed} changes nothing'
        assert_commanded(parse_scene(scene.read_text()), case)


def assert_commanded(scene, case):
    """Push and hold the body; the ledger balances, and an ensemble has the same states."""
    simulation = Simulation(scene, 'dop8', accuracy=1e-10, rate=100.0)
    start = simulation.vector.copy()
    simulation.advance(1)
    free = simulation.vector.copy()
    simulation.impulse(torque=(0.0, 0.0, 1e-3))
    simulation.hold(torque=(0.0, 0.0, 1e-3))
    simulation.advance(1)
    simulation.release()
    simulation.advance(1)
    ledger = simulation.ledger()
    assert ledger['work'] != 0.0, case
    assert abs(ledger['energy_residual']) < 1e-9, case
    assert ledger['momentum_residual'] < 1e-9, case
    if any(effect.as_impulse is not None for effect in scene.effects):
        return    # a strike is a command of the scene's own: ensembles take states after it
    many = ensemble(scene, np.array([start, start]), [0.01], 'dop8', 1e-10)
    assert many.vector[0].tobytes() == many.vector[1].tobytes(), case
    # its horizon is its own, and so are its steps
    assert np.abs(many.vector[1, 0] - free).max() < 1e-8, case
