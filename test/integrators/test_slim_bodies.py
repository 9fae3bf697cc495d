# SPDX-License-Identifier: Apache-2.0
"""Slim bodies: what acts on them leaves no rounding about the axis, where it would spin them."""

import json
from fractions import Fraction

import numpy as np
import pytest
from near import near

from rigid_body_sim.integrators.equations.equations import Equations
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

pytestmark = pytest.mark.without_numba

ON_AXIS = {
    'magnetic': {'moment': [0, 0, 0.3], 'field': [0.2, -0.1, 0.4]},
    'magnetic in a field': {'moment': [0, 0, 0.3], 'field': ['0.1*z', 0.2, '0.1*x']},
    'spring': {'at': [0, 0, 0.3], 'anchor': [1.0, 2.0, -0.5], 'stiffness': 0.4},
    'spring with a length': {'at': [0, 0, 0.3], 'anchor': [1.0, 2.0, -0.5], 'stiffness': 0.4,
                             'length': 0.7, 'damping': 0.1},
    'gravity_gradient': {'mu': 2e20, 'position': [3e6, -5e6, 2e6]},
    'force': {'value': ['sin(3*t)', 0.2, 0.1], 'at': [0, 0, 0.3], 'frame': 'world'},
}


@pytest.mark.parametrize('kind', ON_AXIS)
def test_a_needle_keeps_its_spin(kind):
    """Differentiated by the attitude, a gravity gradient left 1e-16 I1/I3 about the axis."""
    scene = parse_scene(json.dumps({
        'scene': 'needle', 'body': {'mass': 1.0, 'inertia': [0.02, 0.02, 2e-12]},
        'constraint': 'free', 'effects': [{kind.split()[0]: ON_AXIS[kind]}],
        'initial': {'euler': [0.7, -1.1, 0.4], 'angular_velocity': [0.3, -0.2, 0.7]}}))
    simulation = Simulation(scene, 'dop8', accuracy=1e-9, horizon=1.0)
    spins = simulation.states(np.linspace(0.0, 1.0, 9)).angular_velocity
    assert spins[:, 2].tolist() == [0.7] * 9
    assert np.ptp(spins[:, 0]) > 0.01


def test_about_a_pivot_the_spin_changes_by_the_moments_that_were_given():
    """omega3' = (I1 - I2)/I3 omega1 omega2: doubles about the pivot have I1 - I2 to 1e-7 only."""
    I1, I2, I3 = 0.037, 0.037 * (1.0 + 1e-9), 0.037 * 3e-6
    scene = parse_scene(json.dumps({
        'scene': 'needle', 'constraint': 'pivot', 'effects': [{'drag': {'angular': 1e-30}}],
        'body': {'mass': 0.5, 'inertia': [I1, I2, I3], 'center_of_mass': [0, 0, 0.25]},
        'initial': {'angular_velocity': [3.0, -2.0, 0.0]}}))
    equations = Equations(scene)
    p, y = equations.start(scene.initial.vector)
    *_, turning = equations.kernels.rate(p, tuple(y.tolist()))
    exact = (Fraction(I1) - Fraction(I2)) / Fraction(I3) * -6
    assert turning == near(float(exact), 1e-15)
