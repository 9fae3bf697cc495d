# SPDX-License-Identifier: Apache-2.0
"""Several effects that turn the axes at once: their rates add up."""

import dataclasses

import pytest
from near import near

from rigid_body_sim.numerics.rotations import angle_between
from rigid_body_sim.scene.effects.internal_dissipation import InternalDissipation
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.simulation.simulation import Simulation


@pytest.mark.without_numba
@pytest.mark.parametrize(('method', 'settings', 'bound'), [
    ('dop8', {'accuracy': 1e-12}, 1e-12), ('semi_implicit_euler', {'step': 1e-2}, 1e-12)])
def test_two_dissipations_are_one_of_their_sum(method, settings, bound):
    shipped = load_scene('major_axis_relaxation')
    coefficient = shipped.effects[0].coefficient
    shares = InternalDissipation(0.25 * coefficient), InternalDissipation(0.75 * coefficient)
    parted = dataclasses.replace(shipped, effects=shares)
    one, two = (Simulation(scene, method, rate=10.0, **settings) for scene in (shipped, parted))
    for simulation in (one, two):
        simulation.advance(5)
    assert angle_between(*one.state.orientation, *two.state.orientation) < bound
    assert two.state.angular_velocity == near(one.state.angular_velocity, rel=bound)
    if method == 'dop8':
        ledger = two.ledger()
        assert ledger['dissipated'] == near(one.ledger()['dissipated'], rel=1e-10)
        assert abs(ledger['energy_residual']) < 1e-14
