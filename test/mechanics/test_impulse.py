# SPDX-License-Identifier: Apache-2.0
"""The jump of a body under an impulse, beside the same formula in rational numbers."""

import random
from fractions import Fraction

import numpy as np
import pytest
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.mechanics import impulse, parameters
from rigid_body_sim.numerics.vectors import cross, dot
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.scene.state import ANGULAR_VELOCITY, ORIENTATION, VELOCITY

BODY = """
scene: body
body: {{mass: {mass}, inertia: {inertia}, center_of_mass: {center}}}
constraint: {constraint}
effects: []
initial: {{orientation: {orientation}}}
"""


def turned_back(q, vector):
    """Return the body components of a world vector, Fractions, for a quaternion of any norm."""
    u, w = [-Fraction(x) for x in q[:3]], Fraction(q[3])
    square, along, side = dot(u, u), dot(u, vector), cross(u, vector)
    return [((w * w - square) * vector[k] + 2 * along * u[k] + 2 * w * side[k])
            / (w * w + square) for k in range(3)]


@pytest.mark.parametrize('constraint', ['free', 'pivot'])
@pytest.mark.parametrize('thin', [1.0, 0.1, 0.007, 1.1e-3, 1e-6])
def test_each_part_of_the_jump_is_right_to_rounding_however_thin_the_body_is(constraint, thin):
    """Rounding of G across the body would be the larger part of the spin about its axis."""
    draw = random.Random(f'{constraint} {thin}')
    for _ in range(20):
        inertia = [1.0, 1.0 + thin * draw.uniform(0.0, 0.9), thin]
        q = [draw.gauss(0.0, 1.0) for _ in range(4)]
        center = [0.0, 0.0, draw.uniform(-1.0, 1.0)]
        scene = parse_scene(BODY.format(
            mass=draw.uniform(0.5, 2.0), inertia=inertia, center=center, orientation=q,
            constraint=constraint))
        force, couple = np.array([[draw.gauss(0.0, 1.0) for _ in range(3)] for _ in range(2)])
        state, p = scene.initial.vector.copy(), parameters.parameters(scene)
        known = parameters.scene_parameters(scene)
        q = state[ORIENTATION].tolist()
        J, K = ([Fraction(x) for x in given.tolist()] for given in (force, couple))
        arm = [Fraction(x) if constraint == 'pivot' else 0 for x in center]
        G = [a + b for a, b in zip(turned_back(q, K), cross(arm, turned_back(q, J)), strict=True)]
        before = state[ANGULAR_VELOCITY].copy()
        assert impulse.apply_impulse(p, state, force, couple, np.empty(impulse.RESPONSE_SIZE))
        for k in range(3):
            d = float(G[k] / Fraction(known.moments[k]))
            # measured: 2.3e-16; 7e-14 where G is made in doubles
            assert (state[ANGULAR_VELOCITY] - before)[k] == near(d, rel=4.5e-16)


HELD = {
    'free': ('free', 'angular_velocity: [1, -2, 0.5], velocity: [0.3, -0.4, 1.1]'),
    'pivot': ('pivot', 'angular_velocity: [1, -2, 0.5]'),
    'pivot beside': ('{pivot: {at: [0.2, 0.1, -0.1]}}', 'angular_velocity: [1, -2, 0.5]'),
    'moving pivot': ("{pivot: {motion: ['2*t', '-3*t', '5*t'], at: [0.2, 0.1, -0.1]}}",
                     'angular_velocity: [1, -2, 0.5]'),
    'hinge': ('{hinge: {axis: [1, 2, 2], through: [0.2, 0.1, -0.1]}}', 'rate: 1.7')}
SKEW = ('[[0.3, 0.01, 0.02], [0.01, 0.4, -0.03], [0.02, -0.03, 0.5]], '
        'center_of_mass: [0.1, -0.2, 0.3]')
BALL = ('table', 'angular_velocity: [1, -2, 0.5], velocity: [0.3, -0.4, 0]')


@pytest.mark.parametrize(('kind', 'held'), [*HELD.items(), ('table', BALL)])
@pytest.mark.parametrize('seed', range(3))
def test_momenta_change_by_the_impulse_and_its_reaction_and_the_energy_by_the_work(
        kind, held, seed):
    """A bearing keeps the velocity of its point, and the table the height of the ball."""
    body = ('shape: {solid_sphere: {radius: 0.3}}' if kind == 'table' else f'inertia: {SKEW}')
    scene = parse_scene(
        f'scene: s\nbody: {{mass: 2.0, {body}}}\nconstraint: {held[0]}\neffects: []\n'
        f'initial: {{orientation: [0.1, 0.5, -0.2, 0.8], {held[1]}}}\n')
    J, K = np.random.default_rng(seed).normal(size=(2, 3))
    turn, M = Rotation.from_quat(scene.initial.orientation), 2.0
    center, tensor = np.array(scene.body.center_of_mass), scene.body.about_center.matrix
    point = np.array(scene.constraint.point(scene.body))

    def momenta(state):
        """Return momentum, spin (world), energy, and the velocities of centre and point."""
        omega = state[ANGULAR_VELOCITY]
        v, of_point = (state[VELOCITY] + turn.apply(np.cross(omega, x)) for x in (center, point))
        spin = tensor @ omega
        return M * v, turn.apply(spin), 0.5 * (M * v @ v + omega @ spin), of_point

    state, entries = scene.initial.vector.copy(), np.arange(5.0)
    before, out = momenta(state), np.empty(impulse.RESPONSE_SIZE)
    again, p = state.copy(), parameters.parameters(scene)
    assert impulse.apply_impulse(p, state, J, K, out)
    after, found = momenta(state), impulse.load_response(out)
    change, spin, energy = (b - a for a, b in zip(before[:3], after[:3], strict=True))
    close = {'rel': 1e-14, 'abs': 1e-14}    # measured: 2e-15
    assert change == pytest.approx(J + found.reaction_force, **close)
    assert found.work == pytest.approx(energy, **close)
    if kind in ('free', 'table'):
        assert spin == pytest.approx(K, **close)
        assert found.angular_impulse == pytest.approx(K, **close)
        assert found.reaction_force == pytest.approx(
            [0.0, 0.0, -J[2] if kind == 'table' else 0.0], **close)
    else:
        assert after[3] == pytest.approx(before[3], **close)
        arm = turn.apply(center - point)
        moment = K + np.cross(arm, J)
        assert spin + np.cross(arm, change) == pytest.approx(
            moment + found.reaction_couple, **close)
        axis = turn.apply(np.array([1, 2, 2]) / 3.0)
        assert found.angular_impulse == pytest.approx(
            axis * (axis @ moment) if kind == 'hinge' else moment, **close)
    assert kind == 'hinge' or found.reaction_couple == (0.0, 0.0, 0.0)
    # what the ledger is told: work, nothing as heat, and the impulse about the point
    solvable, work = impulse.push(p, again, J, K, entries)
    assert solvable and work == found.work and np.array_equal(again, state)
    assert entries - np.arange(5.0) == pytest.approx(
        [work, 0.0, *found.angular_impulse], **close)


@pytest.mark.parametrize('k', range(7))
def test_any_part_of_an_impulse_that_is_not_zero_acts(k):
    scene = parse_scene(BODY.format(mass=2.0, inertia=[1, 2, 2.5], center=[0, 0, 0],
                                    constraint='free', orientation=[0, 0, 0, 1]))
    state, given = scene.initial.vector.copy(), np.eye(7)[k, :6]
    taken, work = impulse.push(
        parameters.parameters(scene), state, given[:3], given[3:], np.zeros(5))
    assert taken and work == near((0.25, 0.25, 0.25, 0.5, 0.25, 0.2, 0.0)[k], rel=1e-15)


@pytest.mark.parametrize('k', [0, 1, 2])
@pytest.mark.parametrize('across', [1, 2])
@pytest.mark.parametrize(('part', 'taken'), [(0.0, True), (-5e-15, True), (2e-14, False),
                                             (-1.0, False)])
def test_about_a_rod_no_impulse_of_torque_is_taken_beyond_its_rounding(k, across, part, taken):
    scene = parse_scene(BODY.format(
        mass=1.0, inertia=np.roll([0, 2, 2], k).tolist(), center=[0, 0, 0], constraint='free',
        orientation=[0, 0, 0, 1]))
    state, given = scene.initial.vector.copy(), np.zeros(3)
    given[k], given[(k + across) % 3] = 8.0 * part, 8.0
    assert impulse.apply_impulse(parameters.parameters(scene), state, np.zeros(3), given,
                                 np.empty(impulse.RESPONSE_SIZE)) == taken
    given[k] = 0.0
    assert state[ANGULAR_VELOCITY].tolist() == (0.5 * given).tolist()
