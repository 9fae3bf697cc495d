# SPDX-License-Identifier: Apache-2.0
"""Bodies held at a point that is not their origin: they move as those whose origin is there.

The numbers are such that the tensor about the point and the arm are the same doubles either way.
"""

import numpy as np
import pytest

from rigid_body_sim.motions import absorbing_motion
from rigid_body_sim.motions.nearly import is_exact, nearly_absorbing
from rigid_body_sim.numerics.rotations import rotate
from rigid_body_sim.numerics.vectors import cross
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

pytestmark = pytest.mark.without_numba

SCENE = """
scene: held
body: {mass: 2, inertia: [INERTIA], center_of_mass: CENTER}
constraint: PIVOT
effects: [EFFECTS]
initial: {euler: [0.3, 0.7, -0.4], angular_velocity: [0.5, -1, 6], position: [1, -2, 3]}
"""
AT = 0.0, 0.0, -0.25
AROUND = {
    'the vertical': ('lagrange_top', '0.5, 0.5, 0.25', 'gravity: {g: 9.81}'),
    'a leaning vertical': ('leaning_top', '0.5, 0.5, 0.25', 'gravity: {g: [1, 2, -9]}'),
    'a vertical of two forces': (
        'leaning_top', '0.5, 0.5, 0.25',
        'gravity: {g: 9.81}, force: {value: [0.5, 0, 3], frame: world}'),
    'nothing': ('lagrange_top', '0.5, 0.5, 0.25', ''),
    'nothing, without symmetry': ('damped_body', '0.5, 0.4, 0.25', ''),
    'an axis that is driven': (
        'driven_body', '0.5, 0.5, 0.25', 'torque: {value: [0, 0, 0.3]}')}


def held(inertia, effects, center, pivot):
    return parse_scene(SCENE.replace('INERTIA', inertia).replace('EFFECTS', effects).replace(
        'CENTER', str(center)).replace('PIVOT', pivot))


@pytest.mark.parametrize(('motion', 'inertia', 'effects'), AROUND.values(), ids=AROUND)
def test_a_body_held_away_from_its_origin_turns_as_one_held_there(motion, inertia, effects):
    away = Simulation(held(inertia, effects, [0, 0, 0], f'{{pivot: {{at: {list(AT)}}}}}'))
    there = Simulation(held(inertia, effects, [0, 0, 0.25], 'pivot'))
    assert (away.choice.method, there.choice.method) == ('exact', 'exact')
    assert away.choice.solver(away.vector, None).motion.__name__.endswith(f'.{motion}')
    times = np.linspace(0.0, 30.0, 41)
    own, other = away.states(times), there.states(times)
    assert np.array_equal(own.vector[:, 1:8], other.vector[:, 1:8])
    for state in own.vector:
        arm = rotate(*state[1:5], *AT)
        assert np.abs(state[8:11] + arm - (1.0, -2.0, 3.0)).max() < 2e-15              # 9e-16
        assert np.abs(state[11:14] + rotate(
            *state[1:5], *cross(state[5:8], AT))).max() < 2e-15                        # 7e-16
    for k in (0, 7, 40):    # one by one as among many
        assert np.array_equal(away.states(times[k:k + 1]).vector[0], own.vector[k])
    begun = away.restart(own[7]).states(times[:9])
    assert np.abs(begun.vector[:, 8:11] - own.vector[7:16, 8:11]).max() < 4e-15        # 1.3e-15
    away.advance(2000)
    ledger = away.ledger()
    assert abs(ledger['energy_residual']) < 1e-15                                      # 2e-16
    assert ledger['momentum_residual'] < 3e-15                                         # 8e-16


def test_what_is_nearly_symmetric_is_not_taken_as_symmetric_about_such_a_point():
    """Two moments about it are the same double, and those about the centre of mass are not."""
    away = held('0.5, 0.5000000000000001, 0.25', 'gravity: {g: 9.81}', [0, 0, 2.0],
                '{pivot: {at: [0, 0, -0.25]}}')
    assert not is_exact(absorbing_motion(away), away)
    assert nearly_absorbing(away, 0.1) is None
