# SPDX-License-Identifier: Apache-2.0
"""Accelerations and reactions, compared with independent results.

These are differences of states, momentum balance, the closed forms' own kernels and hand
calculations.
"""

import math

import numpy as np
import pytest
from near import near

from rigid_body_sim.errors import BadInput
from rigid_body_sim.mechanics import impulse, parameters
from rigid_body_sim.mechanics.balance import Dynamics
from rigid_body_sim.mechanics.impulse import RESPONSE, RESPONSE_SIZE
from rigid_body_sim.motions.lagrange_top import lagrange_top
from rigid_body_sim.motions.pendulum import pendulum
from rigid_body_sim.numerics.rotations import from_rotation_vector, multiply, rotate
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import load_scene, parse_scene
from rigid_body_sim.scene.state import State
from rigid_body_sim.simulation.simulation import Simulation

SKEW = ('{mass: 2.0, inertia: [[0.05, 0.004, -0.002], [0.004, 0.06, 0.003], [-0.002, 0.003, '
        '0.03]], center_of_mass: [0.02, -0.01, 0.1]}')
HINGE = '{hinge: {axis: [1, 2, 0.5], through: [0.05, 0, -0.1]}}'
AT = '{pivot: {at: [0.05, 0, -0.1]}}'
WRENCH = Wrench((3.0, -1.0, 2.0), (0.2, 0.5, 0.1), 'body')
G = 9.81


def scene(constraint, effects='[gravity: {g: 9.81}]', body=SKEW):
    return parse_scene(f'scene: test\nbody: {body}\nconstraint: {constraint}\neffects: {effects}\n'
                       f'initial: {{}}\n')


def state(constraint):
    q = from_rotation_vector(0.3, 1.2, 0.4)
    if constraint == 'free':
        return State.of(0.0, q, (1.0, -2.0, 3.0), (1.0, 2.0, 3.0), (0.1, -0.2, 0.3))
    if constraint == 'pivot':
        return State.of(0.0, q, (1.0, -2.0, 3.0))
    omega = 4.0 * np.array([1.0, 2.0, 0.5]) / math.sqrt(5.25)
    return State.of(
        0.0, q, omega, velocity=-np.array(rotate(*q, *np.cross(omega, (0.05, 0.0, -0.1)))))


def moved(vector, balance, h):
    """Return the state a time h later by velocities and accelerations.

    It is right to second order, so a central difference is right to h^2.
    """
    out = vector.copy()
    omega, growth = vector[5:8], balance.angular_acceleration
    out[1:5] = multiply(*vector[1:5], *from_rotation_vector(*(h * omega + 0.5 * h * h * growth)))
    out[5:8] = omega + h * growth
    out[8:11] += h * vector[11:14] + 0.5 * h * h * balance.acceleration
    out[11:14] += h * balance.acceleration
    return out


def momentum(body, vector, point):
    """Return momentum and angular momentum about a fixed point, world."""
    q, omega = vector[1:5], vector[5:8]
    lever = np.array(rotate(*q, *body.center_of_mass))
    p = body.mass * (vector[11:14] + rotate(*q, *np.cross(omega, body.center_of_mass)))
    spin = np.array(rotate(*q, *(body.about_center.matrix @ omega)))
    return p, spin + np.cross(vector[8:11] + lever - point, p)


@pytest.mark.parametrize('constraint', ['free', 'pivot', HINGE, AT])
@pytest.mark.parametrize(
    'effects',
    ['[gravity: {g: 9.81}]', '[gravity: {g: 9.81}, drag: {linear: 0.5, angular: 0.01}]'])
def test_momentum_changes_by_all_forces_and_torques(constraint, effects):
    """Newton and Euler hold for the whole body, with the reaction.

    d p/dt = sum of forces, d L/dt = sum of torques about a fixed point.
    """
    made, vector, h = scene(constraint, effects), state(constraint).vector, 1e-5
    balance = Dynamics(made).balance(vector, WRENCH)
    before, after = (momentum(made.body, moved(vector, balance, side * h), balance.point)
                     for side in (-1.0, 1.0))
    q = vector[1:5]
    arm = vector[8:11] + rotate(*q, *made.body.center_of_mass) - balance.point
    force = np.array(rotate(*q, *WRENCH.force)) - [0.0, 0.0, 2.0 * G]
    couple = np.array(rotate(*q, *WRENCH.torque))
    if 'drag' in effects:
        force -= 0.5 * momentum(made.body, vector, balance.point)[0] / 2.0
        couple -= 0.01 * np.array(rotate(*q, *vector[5:8]))
    # differences err by h^2 of rates of 60/s and by rounding over h: 5e-9 of the forces here;
    # measured 2e-9
    np.testing.assert_allclose((after[0] - before[0]) / (2 * h), force + balance.force, atol=2e-7)
    np.testing.assert_allclose((after[1] - before[1]) / (2 * h),
                               couple + np.cross(arm, force) + balance.torque, atol=2e-7)


@pytest.mark.parametrize('constraint', ['pivot', HINGE, AT])
def test_fixed_points_stay(constraint):
    vector, made = state(constraint).vector, scene(constraint)
    balance = Dynamics(made).balance(vector, WRENCH)
    point = np.array((0.0, 0.0, 0.0) if constraint == 'pivot' else (0.05, 0.0, -0.1))
    omega, growth = vector[5:8], balance.angular_acceleration
    carried = np.cross(growth, point) + np.cross(omega, np.cross(omega, point))
    assert np.abs(balance.acceleration + rotate(*vector[1:5], *carried)).max() < 1e-14


@pytest.mark.without_numba
def test_closed_forms_have_the_same_reactions():
    for name, motion, size in (('heavy_top', lagrange_top, 3), ('kater_pendulum', pendulum, 6)):
        simulation = Simulation(name)
        times = [0.0, 0.31, 2.5]
        found, states = simulation.reactions(times), simulation.states(times)
        for k in range(3):
            out = np.empty(size)
            motion.reaction(motion.parameters(simulation.scene), states.vector[k], out)
            ours = np.concatenate([found.force[k], found.torque[k]])[:size]
            assert np.abs(ours - out).max() < 1e-13 * np.abs(out).max()    # 4e-16
        assert not found.torque.any() or name == 'kater_pendulum'


def test_pendulum_at_rest_at_its_lowest_point_pulls_with_its_weight_and_at_speed_with_more():
    """A point-like bob at the bottom of an arm of 0.5 m with rate w has tension M (g + w^2 r)."""
    made = scene('{hinge: {axis: [0, 1, 0], through: [0, 0, 0.5]}}',
                 body='{mass: 2.0, inertia: [0.01, 0.01, 0.01]}')
    for rate in (0.0, 3.0):
        balance = Dynamics(made).balance(State.of(
            0.0, angular_velocity=(0.0, rate, 0.0), velocity=(-0.5 * rate, 0.0, 0.0)).vector)
        np.testing.assert_allclose(
            balance.force, [0.0, 0.0, 2.0 * (G + 0.5 * rate * rate)], rtol=1e-15)
        assert not balance.torque.any()
        np.testing.assert_allclose(balance.point, [0.0, 0.0, 0.5])


@pytest.mark.parametrize(('rate', 'push', 'growth'), [
    (0.0, 0.02, 0.0), (0.0, -0.02, 0.0), (0.0, 0.05, 2.0), (0.0, -0.05, -2.0), (1.0, 0.05, 2.0),
    (-1.0, 0.05, 8.0), (1.0, -0.02, -5.0)])
def test_dry_friction_at_a_hinge_bears_up_to_its_torque_at_rest_and_all_of_it_in_motion(
        rate, push, growth):
    """A moment of 0.01 kg m^2, friction of 0.03 N m, and a push about the axis."""
    made = scene('{hinge: {axis: [0, 1, 0]}}', '[dry_friction: {torque: 0.03}]',
                 '{mass: 2.0, inertia: [0.02, 0.01, 0.02]}')
    start = State.of(0.0, angular_velocity=(0.0, rate, 0.0)).vector
    found = Dynamics(made).balance(start, Wrench(torque=(0.0, push, 0.0)))
    np.testing.assert_allclose(found.angular_acceleration, [0.0, growth, 0.0], atol=1e-14)
    assert np.abs(found.torque).max() < 1e-15    # the hinge bears nothing along its axis


def test_ball_slides_rolls_and_is_pushed():
    ball = load_scene('billiard_center')
    M, a, friction = ball.body.mass, ball.body.radius, ball.effect('sliding_friction')
    dynamics, weight = Dynamics(ball), M * friction.g
    sliding = dynamics.balance(State.of(0.0, velocity=(3.0, 4.0, 0.0)).vector)
    np.testing.assert_allclose(
        sliding.force, [-0.6 * friction.mu * weight, -0.8 * friction.mu * weight, weight],
        rtol=1e-15)
    rolling = State.of(0.0, angular_velocity=(0.0, 1.0 / a, 0.0), velocity=(1.0, 0.0, 0.0)).vector
    np.testing.assert_allclose(dynamics.balance(rolling).force, [0.0, 0.0, weight], atol=1e-16)
    # a force F at the centre of a rolling solid sphere: a = (5/7) F/M, friction -(2/7) F
    F = 0.1 * friction.mu * weight
    pushed = dynamics.balance(rolling, Wrench((F, 0.0, 0.0)))
    np.testing.assert_allclose(pushed.force, [-2.0 / 7.0 * F, 0.0, weight], rtol=1e-14)
    np.testing.assert_allclose(
        pushed.acceleration, [5.0 / 7.0 * F / M, 0.0, 0.0], rtol=1e-14, atol=1e-16)
    # a stronger push makes it slide, with the largest friction that mu allows
    assert abs(dynamics.balance(rolling, Wrench((100.0 * F, 0.0, 0.0))).force[0]) == near(
        friction.mu * weight, rel=1e-15)


def test_blow_is_the_limit_of_a_strong_short_push():
    """The impulsive reaction is the integral of the continuous one.

    Both follow from Newton and Euler, but by different code.
    """
    made, vector = scene(HINGE, '[]'), state(HINGE).vector
    vector[5:8] = vector[11:14] = 0.0
    out = np.empty(RESPONSE_SIZE)
    force, couple = np.array([0.3, -0.2, 0.1]), np.array([0.01, 0.02, -0.03])
    impulse.apply_impulse(parameters.parameters(made), vector.copy(), force, couple, out)
    response = RESPONSE.load(out)
    balance = Dynamics(made).balance(vector, Wrench(tuple(force), tuple(couple)))
    np.testing.assert_allclose(balance.force, response.reaction_force, atol=1e-15)
    np.testing.assert_allclose(balance.torque, response.reaction_couple, atol=1e-15)


def test_acceleration_of_a_simulation_is_the_slope_of_its_velocity():
    simulation = Simulation('tennis_racket')
    simulation.advance(300)
    _, angular = simulation.acceleration
    h = 1e-4
    around = simulation.states([simulation.time - h, simulation.time + h]).angular_velocity
    # 2e-7: h^2/6 omega'''
    assert np.abs((around[1] - around[0]) / (2 * h) - angular).max() < 1e-6


def test_free_body_has_no_reaction():
    with pytest.raises(BadInput, match='nothing holds the body of tennis_racket'):
        Simulation('tennis_racket').reactions([0.0])


def test_axes_that_dissipate_turn_by_more_than_omega_and_keep_the_momentum():
    """By u = c (m x omega + Gamma): Gamma is the weight's about the pivot, a wrench's is none.

    Momenta change by what acts, as the axes turn with omega + u.
    """
    for constraint in ('free', 'pivot'):
        vector, h = state(constraint).vector, 1e-5
        made = scene(constraint, '[gravity: {g: 9.81}, internal_dissipation: {coefficient: 3}]')
        balance = Dynamics(made).balance(vector, WRENCH)
        q, omega, body = vector[1:5], vector[5:8], made.body
        held = constraint == 'pivot'
        down = np.array(rotate(*(-q[:3]), q[3], 0.0, 0.0, -2.0 * G))
        pull = np.cross(body.center_of_mass, down) if held else np.zeros(3)
        inertia = made.constraint.inertia(body).matrix if held else body.about_center.matrix
        extra = 3.0 * (np.cross(inertia @ omega, omega) + pull)
        assert np.linalg.norm(extra) > 0.3

        def later(t, vector=vector, balance=balance, extra=extra):
            out = moved(vector, balance, t)
            turn = t * (vector[5:8] + extra) + 0.5 * t * t * balance.angular_acceleration
            out[1:5] = multiply(*vector[1:5], *from_rotation_vector(*turn))
            return out
        around = [later(side * h) for side in (-1.0, 1.0)]
        p, spin = (np.array([part(one) for one in around]) for part in (
            lambda one: momentum(body, one, balance.point)[0],    # noqa: B023 (called at once)
            lambda one: rotate(*one[1:5], *(inertia @ one[5:8]))))    # noqa: B023
        force = np.array(rotate(*q, *WRENCH.force)) - [0.0, 0.0, 2.0 * G]
        about = np.cross(rotate(*q, *body.center_of_mass), force) if held else np.zeros(3)
        # measured: 1.1e-8
        assert (p[1] - p[0]) / (2 * h) == pytest.approx(force + balance.force, abs=2e-7)
        assert (spin[1] - spin[0]) / (2 * h) == pytest.approx(
            rotate(*q, *WRENCH.torque) + about, abs=2e-7)


@pytest.mark.parametrize('through', [(0.05, 0.0, -0.1), (0.0, 0.0, 0.0)])
def test_a_pivot_that_moves_takes_its_point_of_the_body_along(through):
    """The point has the acceleration of the path; the reaction acts there, without a couple."""
    made = scene(f"{{pivot: {{at: {list(through)}, motion: ['0.3*t^2', '-0.1*t^3', '0.2*t']}}}}")
    vector = State.of(0.5, from_rotation_vector(0.3, 1.2, 0.4), (1.0, -2.0, 3.0),
                      (0.2, -0.1, 0.4)).vector
    found = Dynamics(made).balance(vector, WRENCH)
    q, omega, growth = vector[1:5], vector[5:8], found.angular_acceleration

    def carried(arm):
        return np.array(rotate(*q, *(np.cross(growth, arm) + np.cross(omega, np.cross(
            omega, arm)))))
    # measured: 4e-16
    assert found.acceleration + carried(through) == pytest.approx([0.6, -0.3, 0.0], abs=1e-14)
    center, inertia = np.array(made.body.center_of_mass), made.body.about_center.matrix
    force = np.array(rotate(*q, *WRENCH.force)) - [0.0, 0.0, 2.0 * G] + found.force
    assert 2.0 * (found.acceleration + carried(center)) == pytest.approx(force, abs=1e-13)
    lever = np.cross(through - center, rotate(*(-q[:3]), q[3], *found.force))
    assert inertia @ growth + np.cross(omega, inertia @ omega) == pytest.approx(
        WRENCH.torque + lever, abs=1e-13)
    assert not found.torque.any()
    assert found.point == pytest.approx(vector[8:11] + rotate(*q, *through), abs=1e-15)


@pytest.mark.parametrize(('speed', 'slides'), [(0.0, False), (0.3, True)])
@pytest.mark.parametrize('size', [0.02, 50.0])
def test_a_ball_on_the_table_obeys_newton_and_coulomb_under_any_push(speed, slides, size):
    """What acts along the table and about it, and lifts; friction holds what it can."""
    ball = load_scene('billiard_center')
    M, a, mu = ball.body.mass, ball.body.radius, ball.effect('sliding_friction').mu
    q, omega = from_rotation_vector(0.3, 1.2, 0.4), np.array([0.6, -0.8, 0.5]) / a
    back, down = (*(-np.array(q[:3])), q[3]), np.array([0.0, 0.0, -a])
    velocity = speed * np.array([0.0, 1.0, 0.0]) - np.cross(omega, down)
    start = State.of(0.0, q, rotate(*back, *omega), velocity=velocity).vector
    push, couple = size * np.array([0.1, -0.2, 0.01]), size * a * np.array([0.05, 0.1, -0.2])
    found = Dynamics(ball).balance(start, Wrench(tuple(push), tuple(couple)))
    growth, moment = np.array(rotate(*q, *found.angular_acceleration)), 0.4 * M * a * a
    N = M * ball.effect('sliding_friction').g - push[2]
    assert found.force[2] == near(N, rel=1e-14)
    friction = found.force * [1.0, 1.0, 0.0]
    assert M * found.acceleration == pytest.approx(push * [1, 1, 0] + friction, abs=1e-13)
    assert moment * growth == pytest.approx(couple + np.cross(down, friction), abs=1e-14)
    slip = found.acceleration + np.cross(growth, down)
    if slides:
        assert friction == pytest.approx([0.0, -mu * N, 0.0], abs=1e-13)
    elif size < 1.0:
        assert slip == pytest.approx(np.zeros(3), abs=1e-13)
        assert np.linalg.norm(friction) < mu * N
    else:    # it begins to slip, against friction
        assert np.linalg.norm(friction) == near(mu * N, rel=1e-14)
        assert slip @ friction == near(-np.linalg.norm(slip) * mu * N, rel=1e-12)
    assert found.point == pytest.approx(start[8:11] + down, abs=1e-15)


def test_a_rod_takes_no_torque_along_itself():
    made = scene('free', '[]', '{mass: 2.0, inertia: [0, 0.3, 0.3]}')
    found = Dynamics(made).balance(State.of(0.0, angular_velocity=(0.0, 1.0, 2.0)).vector,
                                   Wrench(torque=(0.3, 0.6, -0.9)))
    assert found.angular_acceleration == pytest.approx([0.0, 2.0, -3.0], abs=1e-14)    # 4e-16
