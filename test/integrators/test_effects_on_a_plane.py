# SPDX-License-Identifier: Apache-2.0
"""Forces, magnets, potentials and expressions that act on a body on a plane, and its ledger."""

import numpy as np
import pytest

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

pytestmark = pytest.mark.without_numba

EGG = ('{mass: 0.06, inertia: [3.0e-5, 3.4e-5, 2.0e-5], center_of_mass: [0.001, 0, -0.002], '
       'surface: {ellipsoid: {semi_axes: [0.022, 0.021, 0.03]}}}')
BALL = '{mass: 1.0, inertia: [0.001, 0.001, 0.001], surface: {sphere: {radius: 0.05}}}'
SPUN = '{euler_zyz: [0, 1.2, 0.3], angular_velocity: [1, 2, 60]}'


def simulation(effects, body=EGG, initial=SPUN, table='table'):
    """Return a Simulation under gravity and friction, which both have the same kernels."""
    return Simulation(parse_scene(
        f'scene: acted\nbody: {body}\nconstraint: {table}\neffects: [gravity: {{g: 9.81}}, '
        f'sliding_friction: {{mu: 0.15}}, {effects}]\ninitial: {initial}\n'), 'dop8', 1e-13)


@pytest.mark.parametrize('table', ['table', '{table: {normal: [0.1, 0.05, 1]}}'])
@pytest.mark.parametrize('effect', [
    'force: {value: [0.05, 0, 0], frame: world, at: [0, 0, 0.01]}',
    'magnetic: {moment: [0, 0, 0.2], field: [0.01, 0, 0.02]}',
    "potential: {energy: '0.001*(qx^2 + qy^2)'}",
    "torque: {value: ['-1.0e-5*wx', '-1.0e-5*wy', 0], books: heat}"])
def test_the_ledger_balances_through_slip_stick_and_impacts(effect, table):
    sim = simulation(effect, table=table)
    sim.advance(300)
    assert len(sim.events) > 0
    ledger = sim.ledger()
    assert ledger['dissipated_sliding'] > 0.0
    # measured: 3e-14 and 1e-15
    assert abs(ledger['energy_residual']) < 2e-13
    assert ledger['momentum_residual'] < 2e-13


def test_a_ball_that_is_pushed_rolls_with_its_share_of_the_force():
    """One at rest rolls where friction bears I/(I + m R^2) of a force on its centre."""
    sim = simulation('force: {value: [0.5, 0, 0], frame: world}', BALL, '{}')
    state = sim.states([2.0])[0]
    acceleration = 0.5 / (1.0 + 0.001 / 0.05**2)
    assert state.velocity[0] == pytest.approx(2.0 * acceleration, rel=1e-13)
    assert state.position[0] == pytest.approx(2.0 * acceleration, rel=1e-13)
    assert sim.reactions([1.0]).force[0] == pytest.approx(
        [acceleration - 0.5, 0.0, 9.81], abs=1e-13)
    # above the centre it is pushed more, below it friction turns round
    higher = simulation('force: {value: [0.5, 0, 0], frame: world, at: [0, 0, 0]}', BALL,
                        '{}').states([2.0])[0]
    assert higher.velocity[0] == pytest.approx(state.velocity[0], rel=1e-13)


@pytest.mark.parametrize(('one', 'other'), [
    ('drag: {angular: 1.0e-5}',
     "torque: {value: ['-1.0e-5*wx', '-1.0e-5*wy', '-1.0e-5*wz'], books: heat}"),
    ('magnetic: {moment: [0, 0, 0.2], field: [0, 0, 0.02]}',
     "torque: {value: ['-0.004*2*(qy*qz + qx*qw)', '0.004*2*(qx*qz - qy*qw)', 0]}"),
    ('magnetic: {moment: [0, 0, 0.2], field: [0, 0, 0.02]}',
     "potential: {energy: '-0.004*(qw^2 - qx^2 - qy^2 + qz^2)'}")])
def test_an_effect_and_its_expressions_move_a_body_alike(one, other):
    times = np.linspace(0.0, 0.1, 4)
    found = [simulation(effect).states(times).vector for effect in (one, other)]
    assert np.abs(found[0] - found[1]).max() < 1e-9 * np.abs(found[0]).max()
    assert np.abs(found[0] - simulation('drag: {angular: 0}').states(times).vector).max() > 1e-4


@pytest.mark.parametrize('effect', [
    "force: {value: ['-0.01*vx', 0, 0]}", "torque: {value: ['1.0e-5*sin(t)', 0, 0]}",
    "potential: {energy: '0.001*z^2'}", "torque: {value: ['-1.0e-5*abs(wx)', 0, 0]}"])
def test_time_place_and_kinks_are_refused_in_one_line(effect):
    with pytest.raises(BadInput) as error:
        simulation(effect)
    assert 'for a body on a plane' in str(error.value)
    assert '\n' not in str(error.value)
