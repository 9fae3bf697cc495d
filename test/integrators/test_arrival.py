# SPDX-License-Identifier: Apache-2.0
"""Free bodies that internal dissipation has brought to their last axis go on without steps."""

import numpy as np
import pytest
from near import near

from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.numerics.rotations import angle_between, rotate
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

pytestmark = pytest.mark.without_numba


def scene(omega, coefficient, inertia='[1.0, 2.0, 3.0]'):
    """Return a body that nothing but internal dissipation acts on."""
    return parse_scene(
        f'scene: relaxing\nbody: {{mass: 1.0, inertia: {inertia}}}\nconstraint: free\n'
        f'effects: [internal_dissipation: {{coefficient: {coefficient}}}]\n'
        f'initial: {{angular_velocity: {omega}}}\n')


@pytest.mark.parametrize(('omega', 'coefficient', 'inertia'), [
    ('[0.8, 0.2, 0.3]', 2.0, '[1.0, 2.0, 3.0]'), ('[0.1, 0.8, -0.3]', 0.7, '[3.0, 2.5, 1.0]'),
    ('[0.5, 0.1, 0.3]', 2.0, '[1.0, 2.0, 2.0]')])
def test_what_follows_is_what_the_march_goes_on_to(omega, coefficient, inertia):
    body, times = scene(omega, coefficient, inertia), np.array([1.0, 29.0, 30.0, 45.0])
    solver = Stepped(body, 'dop8', 1e-13, horizon=45.0)
    marching = Stepped(body, 'dop8', 1e-13, horizon=45.0)
    marching._departs = False
    found, expected = np.empty((4, 14)), np.empty((4, 14))
    solver.start(body.initial.vector).states(times, found)
    marching.start(body.initial.vector).states(times, expected)
    for one, other in zip(found, expected, strict=True):
        # measured up to 3e-13
        assert angle_between(*one[1:5], *other[1:5]) < 3e-12
        assert np.abs(one[5:8] - other[5:8]).max() < 3e-12
    one_by_one = solver.start(body.initial.vector)
    for time, row in zip(times[::-1], found[::-1], strict=True):
        out = np.empty(14)
        one_by_one.state(time, out)
        assert out.tobytes() == row.tobytes()


@pytest.mark.parametrize('omega', ['[1e9, 1.0, 2.0]', '[1e15, 1e15, 1e15]'])
def test_a_body_may_turn_as_fast_as_doubles_count(omega):
    """At 1e9 rad/s each radian took a step, and the ledger's panels a minute."""
    body = scene(omega, 0.01)
    simulation = Simulation(body, 'dop8', accuracy=1e-9, horizon=1e-3)
    start = simulation.vector.copy()
    simulation.advance(1)
    ledger, L = simulation.ledger(), np.array([1.0, 2.0, 3.0]) * start[5:8]
    assert ledger['kinetic'] == near(L @ L / 6.0, rel=1e-13)
    assert abs(ledger['energy_residual']) < 1e-13
    assert ledger['momentum_residual'] < 1e-13
    direction = rotate(*simulation.vector[1:5], *simulation.vector[5:8])
    assert np.cross(direction, rotate(*start[1:5], *L)) == pytest.approx(
        0.0, abs=1e-13 * np.linalg.norm(L) * np.linalg.norm(direction))
