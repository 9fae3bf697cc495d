# SPDX-License-Identifier: Apache-2.0
"""Drag whose part in proportion to velocity is stiff: matrices, and squares beside it."""

import json
import math

import numpy as np
import pytest

from rigid_body_sim.integrators.equations.relaxation import relaxations
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

pytestmark = pytest.mark.without_numba
BODY = '{mass: 1.5, inertia: [[0.3, 0.02, 0.01], [0.02, 0.2, 0.03], [0.01, 0.03, 0.15]]'
ABOVE = ', center_of_mass: [0.1, 0, 0.2]'
MATRIX = '[[3.0, 0.5, 0.1], [0.5, 2.0, -0.3], [0.1, -0.3, 1.0]]'
HINGE = '{hinge: {axis: [0, 0, 1]}}'
NUMBERS, MATRICES = 'linear: 2.0, angular: 0.7', f'linear: {MATRIX}, angular: {MATRIX}'
SQUARES = ', quadratic: 3.0, angular_quadratic: 0.4'
MOVING = "{pivot: {motion: [0, 0, '0.1*cos(5*t)']}}"


def scene_of(drag, constraint, initial='{}', center=''):
    """Return a scene with drag alone."""
    return parse_scene(f'scene: drag\nbody: {BODY}{center}}}\nconstraint: {constraint}\n'
                       f'effects: [drag: {{{drag}}}]\ninitial: {initial}\n')


@pytest.mark.parametrize('constraint', ['free', 'pivot', HINGE])
@pytest.mark.parametrize('drag', [NUMBERS, MATRICES])
def test_squares_beside_it_leave_the_rates_of_relaxation(drag, constraint):
    linear, both = (relaxations(scene_of(one, constraint, center=ABOVE), 13)
                    for one in (drag, drag + SQUARES))
    assert len(linear) == len(both) > 0
    for one, other in zip(linear, both, strict=True):
        assert one.first == other.first
        # measured: 0, and 2e-16 where numbers go another way than matrices
        np.testing.assert_allclose(other.rates, one.rates, rtol=4e-15)


@pytest.mark.parametrize('drag', [NUMBERS, MATRICES, NUMBERS + SQUARES])
def test_a_moving_pivot_leaves_them_too(drag):
    moving, still = (relaxations(scene_of(drag, constraint, center=ABOVE), 10)
                     for constraint in (MOVING, 'pivot'))
    # measured: 3e-16
    np.testing.assert_allclose(moving[0].rates, still[0].rates, rtol=4e-15)


@pytest.mark.parametrize('drag', [MATRICES, MATRICES + SQUARES])
def test_the_rates_are_those_of_the_torque(drag):
    """Beside d(torque)/d(omega) by differences, at rest, where squares have no slope."""
    scene = scene_of(drag, 'pivot', center=ABOVE)
    inertia = scene.constraint.inertia(scene.body).matrix
    K = np.array(json.loads(MATRIX))
    arm = np.array([0.1, 0.0, 0.2])
    turning = K + sum(np.outer(np.cross(arm, K @ np.cross(e, arm)), e) for e in np.eye(3))
    expected = np.sort(np.linalg.eigvals(np.linalg.solve(inertia, turning)).real)
    [found] = relaxations(scene, 10)
    np.testing.assert_allclose(np.sort(found.rates), expected, rtol=1e-13)    # measured: 9e-16


@pytest.mark.parametrize('square', [2.0e5, 1.0e6])
def test_a_wheel_in_tar_turns_by_the_angle_of_its_closed_form(square):
    r"""I omega' = -(k + q omega) omega, so phi = (I/q) ln(1 + (q omega_0/k)(1 - exp(-k t/I)))."""
    scene = scene_of(f'angular: 1.0e6, angular_quadratic: {square}', HINGE, '{rate: 3.0}')
    simulation = Simulation(scene, accuracy=1e-12, horizon=1.0)
    assert simulation.choice.method == 'gauss16'
    assert simulation.expected_error < 1e-12
    k, q, moment = 1.0e6, square, 0.15
    for t in (1e-8, 1e-7, 1e-6, 1.0):
        [state] = simulation.states([t])
        phi = moment / q * math.log1p(q * 3.0 / k * -math.expm1(-k * t / moment))
        left = math.exp(-k * t / moment)
        omega = k * 3.0 * left / (k + q * 3.0 * (1.0 - left))
        assert abs(2.0 * state.orientation[2] - phi) < 1e-21 + 1e-13 * phi
        assert abs(state.angular_velocity[2] - omega) < 1e-12
