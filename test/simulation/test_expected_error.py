# SPDX-License-Identifier: Apache-2.0
"""What a simulation and `simulate` tell of the error, before and after commands."""

import pytest

from rigid_body_sim.choice.settling import Settled
from rigid_body_sim.simulation.simulation import Simulation

COMMANDS = {
    'a held wrench': lambda simulation: simulation.hold(torque=(0.0, 1.0, 0.0)),
    'an impulse': lambda simulation: simulation.impulse(torque=(0.0, 1.0, 0.0)),
    'another start': lambda simulation: simulation.restart(simulation.states([0.5]).vector[0])}


@pytest.mark.parametrize('command', COMMANDS.values(), ids=COMMANDS)
def test_after_a_command_nothing_is_foretold(command):
    simulation = Simulation('tennis_racket', 'auto', 1e-12, settled=Settled(
        'dop8', 1e-12, 1e-13, 100.0))
    assert simulation.expected_error == 1e-13 and simulation.departed is None
    simulation.advance(5)
    command(simulation)
    assert simulation.expected_error is None and simulation.missed is None
    assert simulation.departed in (0.005, 0.0)
    assert simulation.copy().expected_error is None
    simulation.advance(5)
    assert simulation.expected_error is None
    if simulation.departed:
        simulation.reset()
        assert simulation.expected_error == 1e-13


@pytest.mark.without_numba
@pytest.mark.parametrize(('foretold', 'allowed', 'told'), [
    (1e-13, None, 1e-13), (1e-13, (1e-9, 0.5), 1e-9), (1e-8, (1e-9, 0.5), 1e-8),
    (None, (1e-9, 0.5), 1e-9), (None, None, None)])
def test_what_a_run_has_allowed_itself_counts_where_it_is_more_than_what_was_foretold(
        foretold, allowed, told, monkeypatch):
    simulation = Simulation('tennis_racket', 'rk4', step=0.1)
    monkeypatch.setattr(type(simulation.choice), 'expected_error', foretold)
    monkeypatch.setattr(Simulation, '_allowed', allowed)
    assert simulation.expected_error == told


def test_commands_of_a_tick_that_cancel_leave_the_forecast():
    simulation = Simulation('tennis_racket')
    simulation.hold(torque=(0.0, 1.0, 0.0))
    simulation.hold()
    assert simulation.departed is None and simulation.expected_error > 0.0


def test_what_was_missed_before_a_command_stays_missed():
    def missed(ticks):
        simulation = Simulation('tennis_racket', rate=1.0, accuracy=1e-9, settled=Settled(
            'dop8', 1e-9, 1.64, 12.5))
        simulation.advance(ticks)
        simulation.hold(torque=(0.0, 1.0, 0.0))
        return simulation.missed
    assert missed(10) is None and 'met until 12.5 s' in missed(15)


def test_simulate_says_it(tmp_path, capsys):
    from rigid_body_sim.cli import simulate
    asked = ['--scene', 'tennis_racket', '--duration', '3', '--accuracy', '1e-15']
    assert simulate.main(asked) == 0
    captured = capsys.readouterr()
    assert 'tennis_racket: the accuracy asked, 1e-15 rad, is missed' in captured.err
    assert simulate.main([*asked[:-1], '1e-9']) == 0
    assert 'missed' not in capsys.readouterr().err
