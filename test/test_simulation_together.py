"""Commands of one tick gathered: computed once, and to the bit what they do one by one."""

import pytest

from rigid_body_sim.errors import BadInput
from rigid_body_sim.simulation import Simulation


def command(simulation):
    for k in range(5):
        simulation.impulse(force=(0.1 * k, 0.0, -0.3), torque=(0.01, -0.02 * k, 0.005), frame='body' if k % 2 else 'world')
    simulation.hold(torque=(0.0, 0.1, 0.0))
    simulation.impulse(torque=(0.3, 0.1, 0.0), frame='body')


def test_gathered_commands_give_the_same_bits():
    one_by_one, gathered = Simulation('tennis_racket'), Simulation('tennis_racket')
    for simulation in (one_by_one, gathered):
        simulation.advance(300)
    command(one_by_one)
    with gathered.together():
        command(gathered)
    assert gathered.vector.tolist() == one_by_one.vector.tolist()
    assert gathered.wrench == one_by_one.wrench
    for simulation in (one_by_one, gathered):
        simulation.advance(100)
    assert gathered.vector.tolist() == one_by_one.vector.tolist()
    assert gathered.ledger() == one_by_one.ledger()


def test_refused_command_leaves_the_others():
    simulation, expected = Simulation('tennis_racket'), Simulation('tennis_racket')
    expected.impulse(torque=(0.0, 0.0, 0.5))
    with simulation.together():
        with pytest.raises(BadInput):
            simulation.impulse(torque=(0.0, 0.0, float('nan')))
        simulation.impulse(torque=(0.0, 0.0, 0.5))
    assert simulation.vector.tolist() == expected.vector.tolist()


def test_nothing_gathered_changes_nothing():
    simulation = Simulation('tennis_racket')
    simulation.advance(10)
    before = simulation.vector.tolist()
    with simulation.together():
        pass
    assert simulation.vector.tolist() == before
