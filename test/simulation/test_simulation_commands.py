# SPDX-License-Identifier: Apache-2.0
"""Commands of one tick given at once have the same bits as one by one.

They are computed once, and a refused one leaves the others.
"""

import numpy as np
import pytest

from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.simulation.command_rows import (
    BODY,
    HOLD,
    IMPULSE,
    LET_GO,
    WORLD,
    commands_of,
    rows_of,
)
from rigid_body_sim.simulation.simulation import Simulation

NONE = (0.0, 0.0, 0.0)
ROWS = np.array([*((IMPULSE, (WORLD, BODY)[k % 2], 0.1 * k, 0.0, -0.3, 0.01, -0.02 * k, 0.005)
                   for k in range(5)),
                 (HOLD, BODY, *NONE, 0.0, 0.1, 0.0), (IMPULSE, BODY, *NONE, 0.3, 0.1, 0.0),
                 (HOLD, WORLD, 0.0, 0.0, 0.2, 0.0, 0.1, 0.0)])


@pytest.fixture
def pair():
    simulations = Simulation('tennis_racket'), Simulation('tennis_racket')
    for simulation in simulations:
        simulation.advance(300)
    return simulations


def assert_same(one, other):
    assert one.vector.tobytes() == other.vector.tobytes()
    assert one.wrench == other.wrench
    assert one.ledger() == other.ledger()


def test_together_they_give_the_same_bits_as_one_by_one(pair):
    one_by_one, together = pair
    for row in ROWS:
        act = one_by_one.impulse if row[0] == IMPULSE else one_by_one.hold
        act(row[2:5], row[5:8], ('world', 'body')[int(row[1])])
    assert together.command(ROWS) == []
    assert together.wrench.torque == (0.0, 0.1, 0.0)
    assert_same(together, one_by_one)
    for simulation in pair:
        simulation.advance(100)
        simulation.command(LET_GO)
    assert_same(together, one_by_one)


def test_refused_commands_leave_the_others(pair):
    simulation, expected = pair
    bad = np.array([(IMPULSE, BODY, *NONE, 0.0, np.nan, 0.0), (HOLD, WORLD, *NONE, 1e15, 0.0, 0.0),
                    (IMPULSE, WORLD, 1e200, *NONE, 0.0, 0.0)])
    refused = simulation.command(np.concatenate([ROWS[:3], bad, ROWS[3:]]))
    assert [refusal.place for refusal in refused] == [3, 4, 5]
    assert [refusal.reason for refusal in refused] == [
        'not finite', 'the body cannot take it', 'too large']
    assert [refusal.error.where for refusal in refused] == ['impulse', 'wrench', 'impulse']
    assert [words in str(refusal.error)
            for words, refusal in zip(
                ('three finite numbers', 'rad within a tick', 'energies are doubles'), refused,
                strict=True)] == [True] * 3
    expected.command(ROWS)
    assert_same(simulation, expected)


def test_what_is_held_is_tried_on_what_the_impulses_before_it_leave():
    """2e7 rad/s a tick is too fast, and so is 0.6e7 after, but not before, such an impulse."""
    body = load_scene(
        'tennis_racket',
        ['body={mass: 1.0, inertia: [1.0, 1.0, 1.0]}', 'initial.angular_velocity=[0, 0, 0]'])
    hold, impulse = (HOLD, WORLD, *NONE, 6e12, 0.0, 0.0), (IMPULSE, WORLD, *NONE, 6e9, 0.0, 0.0)
    assert Simulation(body).command(np.array([hold, impulse])) == []
    [refusal] = Simulation(body).command(np.array([impulse, hold]))
    assert (refusal.place, refusal.error.where) == (1, 'wrench')


def test_none_changes_nothing(pair):
    simulation, quiet = pair
    assert simulation.command(rows_of([])) == []
    assert_same(simulation, quiet)


def test_impulses_that_nearly_cancel_on_a_rod_balance():
    """The sum of torques, turned to the world and back, is not quite across the axis.

    That is rounding, not a torque that the rod cannot take.
    """
    simulation, random = Simulation('thin_rod'), np.random.default_rng(0)
    simulation.advance(1234)
    for _ in range(300):
        torque = np.array([*random.normal(size=2), 0.0])
        simulation.impulse(torque=torque, frame='body')
        simulation.impulse(torque=-torque * (1.0 + 1e-9), frame='body')
        simulation.advance()
    ledger = simulation.ledger()
    assert abs(ledger['energy_residual']) < 1e-13       # measured 5e-15
    assert ledger['momentum_residual'] < 1e-13          # measured 1e-14


def test_rows_say_what_a_journal_says():
    commands = [{'topic': 'cmd_impulse', 'frame': 'body', 'force': [1.0, -0.0, 1e-300],
                 'torque': [0.1, 0.2, 0.3]},
                {'topic': 'cmd_wrench', 'frame': 'world', 'force': [0.0, 0.0, 0.0],
                 'torque': [-0.1, 0.0, 1e100]},
                {'topic': 'release', 'frame': 'world', 'force': [0.0, 0.0, 0.0],
                 'torque': [0.0, 0.0, 0.0]}]
    assert repr(commands_of(rows_of(commands))) == repr(commands)


@pytest.mark.without_numba
@pytest.mark.parametrize('act', ['hold', 'impulse'])
def test_a_body_that_is_stopped_again_balances_beside_what_it_passed_through(act):
    """0.0123 N m, or N m s, about a body axis, for 0.37 s between, and back to rest."""
    slewed = Simulation('free_body', rate=100.0, overrides={
        'initial': {'euler_zyz': [0.3, 0.5, 0.2]}})
    for twist in 0.0123, -0.0123:
        getattr(slewed, act)(torque=(twist, 0.0, 0.0), frame='body')
        slewed.advance(37)
    slewed.release()
    slewed.advance(20)
    balance = slewed.ledger()
    # measured: 1.2e-15 and 8e-16; beside the two ends both were 1
    assert abs(balance['energy_residual']) < 1e-14
    assert balance['momentum_residual'] < 1e-14
    assert slewed.copy().ledger() == balance
    slewed.forget_past()
    assert slewed.ledger() == balance == slewed.copy().ledger()
