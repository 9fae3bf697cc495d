# SPDX-License-Identifier: Apache-2.0
"""Drag whose part in proportion to velocity is stiff: matrices, and squares beside it."""

import json
import math

import numpy as np
import pytest
from near import near
from soak import IN_SOAK

from rigid_body_sim.integrators.equations.relaxation import relaxations, stiff_relaxations
from rigid_body_sim.mechanics.bounds import drive, swing_rate
from rigid_body_sim.numerics.rotations import matrix
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


def test_the_coordinates_relax_each_at_its_rate():
    """-I^-1 K is diagonal in them, and they lead back to omega, in the frame of the scene."""
    scene = scene_of(f'angular: {MATRIX}, linear: {MATRIX}', 'free', center=ABOVE)
    [found] = relaxations(scene, 7)
    R = np.array(matrix(*scene.frame.axes))
    slowed = R.T @ np.array(json.loads(MATRIX)) @ R / np.array(scene.frame.moments)[:, None]
    assert found.first == 4
    # measured: 4e-16, 4e-15
    assert found.into @ found.back == pytest.approx(np.eye(3), abs=4e-15)
    assert found.into @ slowed @ found.back == pytest.approx(np.diag(found.rates), abs=4e-14)


@pytest.mark.parametrize(('linear', 'unknowns', 'rates'), [
    ('2.0', 13, [4.0 / 3.0] * 3), ('2.0', 14, [4.0 / 3.0] * 3), ('2.0', 7, None)])
def test_a_body_that_flies_is_slowed_at_the_rate_c_over_m(linear, unknowns, rates):
    found = relaxations(scene_of(f'linear: {linear}', 'free'), unknowns)
    if rates is None:
        assert found == []
        return
    [one] = found
    assert (one.first, one.rates) == (10, near(rates, rel=1e-15))
    assert (one.into == np.eye(3)).all()
    assert (one.back == np.eye(3)).all()


@pytest.mark.parametrize('drag', [NUMBERS, MATRICES])
def test_on_a_hinge_the_part_of_the_drag_along_the_axis_counts(drag):
    n, arm = np.array([0.48, 0.6, 0.64]), np.array([0.1, 0.0, 0.2])
    scene = scene_of(drag, '{hinge: {axis: [0.48, 0.6, 0.64]}}', center=ABOVE)
    linear, angular = ((np.array(json.loads(MATRIX)),) * 2 if drag == MATRICES
                       else (2.0 * np.eye(3), 0.7 * np.eye(3)))
    moved = np.cross(n, arm)
    [found] = relaxations(scene, 2)
    expected = (n @ angular @ n + moved @ linear @ moved) / (
        n @ scene.body.about_origin.matrix @ n)
    assert (found.first, found.rates) == (1, [near(expected, rel=1e-14)])
    assert found.into.tolist() == found.back.tolist() == [[1.0]]


@pytest.mark.parametrize(('share', 'stiff'), [(0.99, False), (1.01, True)])
@pytest.mark.parametrize('more', ['', ', gravity: {g: 9.81}, torque: {value: [0.02, 0, 0.03]}'])
def test_drag_is_stiff_beyond_twenty_times_the_rates_of_the_motion(share, stiff, more):
    """The motion is that of the start, of a swing, and of what a drive reaches in a radian."""
    def with_drag(k):
        return parse_scene(
            'scene: drag\nbody: {mass: 1.5, inertia: [0.3, 0.2, 0.15], center_of_mass: [0, 0, 0.2]'
            f', inertia_about: origin}}\nconstraint: pivot\neffects: [drag: {{angular: {k!r}}}'
            f'{more}]\ninitial: {{angular_velocity: [0.3, 0, 0.4]}}\n')
    scene = with_drag(1.0)
    motion = 0.5 + swing_rate(scene) + math.sqrt(drive(scene, None))
    assert (motion > 0.5) == bool(more)
    found = stiff_relaxations(with_drag(20.0 * share * motion * 0.15), 7)
    assert bool(found) is stiff
    assert stiff_relaxations(parse_scene('scene: s\nbody: {mass: 1, inertia: [1, 1, 1]}\n'
                                         'constraint: free\neffects: []\ninitial: {}\n'), 7) == []


@pytest.mark.parametrize(('k', 'stiff'), [(3.3, False), (3.4, True)])
def test_a_matrix_is_as_fast_as_its_largest_eigenvalue(k, stiff):
    """Of nine equal entries it is three times one of them; 20 times 0.5 rad/s is the limit."""
    scene = parse_scene('scene: s\nbody: {mass: 1, inertia: [1, 1, 1]}\nconstraint: free\n'
                        f'effects: [drag: {{linear: 0, angular: {[[k] * 3] * 3}}}]\n'
                        'initial: {angular_velocity: [0.3, 0, 0.4]}\n')
    assert bool(stiff_relaxations(scene, 7)) is stiff


@pytest.mark.parametrize('square', [2.0e5, pytest.param(1.0e6, marks=IN_SOAK)])
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
