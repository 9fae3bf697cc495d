# SPDX-License-Identifier: Apache-2.0
"""Group 9, commands: bursts, opposites, enormous and denormal values, at odd moments.

More: test/simulation/test_simulation.py (opposite impulses cancel, bad commands),
test/node/test_running.py (paused, before the first tick), test/node/test_shutdown.py (at
shutdown).
"""

import numpy as np
import pytest
from hard_cases.judged import judge

from rigid_body_sim.errors import BadInput
from rigid_body_sim.simulation.command_rows import IMPULSE
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.study.hard_cases.table import of_group

NONE = (0.0, 0.0, 0.0)


@pytest.fixture(scope='module')
def scenes():
    return {name: Simulation(name).scene
            for name in ('tennis_racket', 'heavy_top', 'kater_pendulum', 'billiard_center')}


@pytest.mark.parametrize(
    'name', ['tennis_racket', 'heavy_top', 'kater_pendulum', 'billiard_center'])
@pytest.mark.parametrize('size', [1e300, 1e155, 1.7e308])
def test_an_impulse_beyond_the_energies_is_refused_in_one_line(scenes, name, size):
    """Its energy, 1e600 J, would be inf and every residual NaN."""
    simulation = Simulation(scenes[name])
    simulation.advance(10)
    before = simulation.vector.copy()
    for force, torque in (((size, 0.0, 0.0), NONE), (NONE, (0.0, size, 0.0))):
        if name == 'billiard_center' and any(torque):
            torque = (size, size, 0.0)
        with pytest.raises(BadInput, match='would do a work of') as refused:
            simulation.impulse(force, torque)
        assert '\n' not in str(refused.value)
    assert simulation.vector.tobytes() == before.tobytes()


@pytest.mark.parametrize('size', [5e-324, 1e-310, 1e-300])
def test_denormal_impulses_and_wrenches_do_nothing_visible(scenes, size):
    """Denormals lose digits at every product; divided by they overflow."""
    simulation, quiet = Simulation(scenes['tennis_racket']), Simulation(scenes['tennis_racket'])
    for each in (simulation, quiet):
        each.advance(10)
    simulation.impulse((size, 0.0, 0.0), (size, -size, size))
    for each in (simulation, quiet):
        each.advance(90)
    # measured 1e-15
    assert simulation.vector[1:8] == pytest.approx(quiet.vector[1:8], rel=0.0, abs=4e-15)
    assert abs(simulation.ledger()['energy_residual']) < 2e-15


def test_a_wrench_that_spins_the_body_faster_than_any_method_follows_is_refused(scenes):
    """1e15 N m for a tick would turn it by 5e8 rad: the tick would take minutes."""
    simulation = Simulation(scenes['tennis_racket'])
    simulation.advance(10)
    with pytest.raises(BadInput, match=r'rad within a tick.*give it as an impulse'):
        simulation.hold(torque=(1e15, 0.0, 0.0))
    assert not simulation.wrench
    simulation.impulse(torque=(1e15, 0.0, 0.0))
    simulation.advance(1000)
    assert abs(simulation.ledger()['energy_residual']) < 1e-14      # measured 6e-16


def test_bursts_at_10_khz_balance(scenes):
    """2000 impulses from both frames, ten a tick: work and momentum add up to round-off."""
    simulation, random = Simulation(scenes['tennis_racket']), np.random.default_rng(9)
    for _ in range(200):
        assert simulation.command(np.array([(IMPULSE, k % 2, *random.normal(size=6))
                                            for k in range(10)])) == []
        simulation.advance()
        simulation.forget_past()
    ledger = simulation.ledger()
    assert abs(ledger['energy_residual']) < 1e-13       # measured 7e-15
    assert ledger['momentum_residual'] < 1e-13          # measured 2e-15


def test_before_the_first_tick_an_impulse_changes_the_start(scenes):
    struck, told = Simulation(scenes['tennis_racket']), Simulation(scenes['tennis_racket'])
    struck.impulse(torque=(0.1, 0.2, -0.3), frame='body')
    told.vector[5:8] = struck.vector[5:8]
    struck.advance(500)
    assert struck.time == 0.5
    assert abs(struck.ledger()['energy_residual']) < 1e-14      # measured 5e-16


def test_opposite_pairs_of_enormous_impulses_cancel_to_the_last_bit(scenes):
    """1e120 would swallow the body's momentum of 10 if sums were taken one by one."""
    simulation, quiet = Simulation(scenes['tennis_racket']), Simulation(scenes['tennis_racket'])
    for each in (simulation, quiet):
        each.advance(123)
    for sign in (1.0, -1.0):
        simulation.impulse(torque=(sign * 1e120, 0.0, sign * 3e119), frame='body')
    for each in (simulation, quiet):
        each.advance(877)
    assert simulation.vector.tobytes() == quiet.vector.tobytes()


@pytest.mark.parametrize('case', of_group(9), ids=lambda case: case.name)
def test_case(case):
    # measured: the same bits
    judge(case)
