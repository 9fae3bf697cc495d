# SPDX-License-Identifier: Apache-2.0
"""Energy, angular momentum and impulses against hand calculations and the balance of the state."""

import numpy as np
import pytest
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.mechanics.energy import DIAGNOSIS_SIZE, KINETIC, MOMENTUM, POTENTIAL
from rigid_body_sim.mechanics.impulse import RESPONSE, RESPONSE_SIZE, apply_impulse
from rigid_body_sim.mechanics.parameters import parameters
from rigid_body_sim.mechanics.potential import energies
from rigid_body_sim.numerics.rotations import rotate
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.scene.state import ANGULAR_VELOCITY, ORIENTATION, VELOCITY

EPS = np.finfo(float).eps
BODY = ('body: {mass: 2.0, inertia: [[0.3, 0.01, 0.0], [0.01, 0.4, 0.02], [0.0, 0.02, 0.5]], '
        'center_of_mass: [0.1, -0.2, 0.3]}')
START = 'orientation: [0.1, 0.2, 0.3, 0.9]'
SCENES = {
    'free': f'scene: a\n{BODY}\nconstraint: free\neffects: [gravity: {{g: 9.81}}]\n'
            f'initial: {{{START}, angular_velocity: [1, 2, 3], velocity: [4, 5, 6]}}',
    'pivot': f'scene: a\n{BODY}\nconstraint: pivot\neffects: [gravity: {{g: 9.81}}]\n'
             f'initial: {{{START}, angular_velocity: [1, 2, 3]}}',
    'hinge': f'scene: a\n{BODY}\n'
             f'constraint: {{hinge: {{axis: [1, 1, 0], through: [0.1, 0.0, 0.2]}}}}\n'
             f'effects: [gravity: {{g: 9.81}}]\n'
             f'initial: {{{START}, angle: 0.3, rate: 2.0}}',
    'table': 'scene: a\nbody: {mass: 2.0, shape: {solid_sphere: {radius: 0.1}}}\n'
             'constraint: table\neffects: []\n'
             f'initial: {{{START}, angular_velocity: [1, 2, 3], velocity: [4, 5, 0]}}',
}
FORCE, COUPLE = np.array([1.0, -2.0, 0.5]), np.array([0.3, 0.2, -0.7])


def diagnosed(scene, vector):
    out = np.empty(DIAGNOSIS_SIZE)
    energies(scene).diagnose(parameters(scene), vector, out)
    return out


def center_velocity(scene, vector):
    turn = Rotation.from_quat(vector[ORIENTATION])
    return (vector[VELOCITY]
            + turn.apply(np.cross(vector[ANGULAR_VELOCITY], scene.body.center_of_mass)))


@pytest.mark.parametrize('kind', SCENES)
def test_kinetic_energy_is_that_of_the_centre_plus_that_about_it(kind):
    scene = parse_scene(SCENES[kind])
    vector = scene.initial.vector.copy()
    if kind == 'pivot':
        vector[VELOCITY] = 0.0
    omega, v = vector[ANGULAR_VELOCITY], center_velocity(scene, vector)
    by_hand = 0.5 * omega @ scene.body.about_center.matrix @ omega + 0.5 * scene.body.mass * v @ v
    assert diagnosed(scene, vector)[KINETIC] == near(by_hand, 8 * EPS)    # measured 3e-16


@pytest.mark.parametrize('kind', ['free', 'pivot', 'hinge'])
def test_potential_energy_is_weight_times_height(kind):
    scene = parse_scene(SCENES[kind])
    height = (scene.initial.position[2]
              + Rotation.from_quat(scene.initial.orientation).apply(scene.body.center_of_mass)[2])
    assert diagnosed(scene, scene.initial.vector)[POTENTIAL] == near(2.0 * 9.81 * height, 8 * EPS)


@pytest.mark.parametrize('kind', SCENES)
def test_impulse_work_is_the_gain_of_kinetic_energy(kind):
    scene = parse_scene(SCENES[kind])
    vector, out = scene.initial.vector.copy(), np.empty(RESPONSE_SIZE)
    before = diagnosed(scene, vector)
    assert apply_impulse(parameters(scene), vector, FORCE, COUPLE, out)
    after = diagnosed(scene, vector)
    gained = after[KINETIC] - before[KINETIC]
    # rounding of the two energies: measured 2e-15 of about 80 J
    assert RESPONSE.load(out).work == pytest.approx(gained, abs=8 * EPS * after[KINETIC])
    change = after[MOMENTUM:] - before[MOMENTUM:]
    impulse = np.array(RESPONSE.load(out).angular_impulse)
    assert impulse == pytest.approx(change, abs=16 * EPS * np.abs(after[MOMENTUM:]).max())


@pytest.mark.parametrize('kind', SCENES)
def test_impulse_and_reaction_move_the_centre_of_mass(kind):
    """Newton: M dv of the centre of mass is the impulse plus that of the reaction.

    It holds under every constraint.
    """
    scene = parse_scene(SCENES[kind])
    vector, out = scene.initial.vector.copy(), np.empty(RESPONSE_SIZE)
    before = center_velocity(scene, vector)
    apply_impulse(parameters(scene), vector, FORCE, COUPLE, out)
    gained = scene.body.mass * (center_velocity(scene, vector) - before)
    reaction = np.array(RESPONSE.load(out).reaction_force)
    assert gained == pytest.approx(FORCE + reaction, abs=1e-14)    # measured 2e-15


@pytest.mark.parametrize('kind', SCENES)
def test_impulse_and_reaction_turn_the_body(kind):
    """Euler: the spin momentum gains the couples and the moments of the reaction.

    All are about the centre of mass.
    """
    scene = parse_scene(SCENES[kind])
    vector, out = scene.initial.vector.copy(), np.empty(RESPONSE_SIZE)
    turn = Rotation.from_quat(vector[ORIENTATION])
    before = vector[ANGULAR_VELOCITY].copy()
    apply_impulse(parameters(scene), vector, FORCE, COUPLE, out)
    gained = turn.apply(scene.body.about_center.matrix @ (vector[ANGULAR_VELOCITY] - before))
    point = scene.constraint.point(scene.body)
    lever = turn.apply(np.subtract(point, scene.body.center_of_mass))
    force, couple = map(np.array, RESPONSE.load(out)[2:])
    if kind == 'table':
        force = force * [0.0, 0.0, 1.0]
    # measured 1e-15
    assert gained == pytest.approx(COUPLE + couple + np.cross(lever, force), abs=1e-14)
    if kind != 'hinge':
        assert not couple.any()


def test_bat_reaction_vanishes_at_the_centre_of_percussion():
    """F_R/F = 1 - d/l' with l' = l + a^2/l (notes, "Baseball bat sweet spot").

    The erratum is l l' = l^2 + a^2.
    """
    M, length, a2 = 0.9, 0.5, 0.06
    scene = parse_scene(f"""
scene: bat
body: {{mass: {M}, inertia: [{M * a2}, {M * a2}, 0.001], center_of_mass: [0, 0, {-length}]}}
constraint: {{hinge: {{axis: [0, 1, 0]}}}}
effects: []
initial: {{}}
""")
    for d in (0.2, length, length + a2 / length):
        vector, out = scene.initial.vector.copy(), np.empty(RESPONSE_SIZE)
        # a force at depth d is one at the centre of mass and a couple about it
        force = np.array([3.0, 0.0, 0.0])
        couple = np.cross([0.0, 0.0, length - d], force)
        apply_impulse(parameters(scene), vector, force, couple, out)
        # the hand pushes back on the bat: F + reaction = M dv, so the reaction on the bat is -F_R
        assert RESPONSE.load(out).reaction_force[0] == pytest.approx(
            -3.0 * (1.0 - d / (length + a2 / length)), abs=4e-15)


def test_opposite_impulses_restore_the_state_of_a_simple_body():
    scene = parse_scene(SCENES['table'])
    p, out = parameters(scene), np.empty(RESPONSE_SIZE)
    vector = scene.initial.vector.copy()
    apply_impulse(p, vector, FORCE, COUPLE, out)
    apply_impulse(p, vector, -FORCE, -COUPLE, out)
    assert vector == near(scene.initial.vector, 4 * EPS)


def test_torque_about_an_axis_of_zero_moment_is_refused_and_changes_nothing():
    scene = parse_scene('scene: rod\nbody: {mass: 1.0, shape: {rod: {length: 2.0}}}\n'
                        'constraint: free\neffects: []\n'
                        'initial: {angular_velocity: [1, 0, 0]}')
    vector = scene.initial.vector.copy()
    assert not apply_impulse(
        parameters(scene), vector, np.zeros(3), np.array([0.0, 0.0, 1e-3]), np.empty(10))
    assert vector.tobytes() == scene.initial.vector.tobytes()


def test_torque_across_a_rod_turned_to_the_world_and_back_is_no_torque_along_it():
    """Rounding leaves up to 1e-15 of it along the axis: a slack of two ulps refused 13 of 1000."""
    scene = parse_scene('scene: rod\nbody: {mass: 1.0, shape: {rod: {length: 2.0}}}\n'
                        'constraint: free\neffects: []\ninitial: {}')
    p, random = parameters(scene), np.random.default_rng(0)
    for _ in range(1000):
        vector, q = scene.initial.vector.copy(), random.normal(size=4)
        vector[ORIENTATION] = q / np.linalg.norm(q)
        torque = np.array(rotate(
            *vector[ORIENTATION].tolist(),
            *(random.normal(size=2) * 10.0 ** random.uniform(-3.0, 3.0, 2)).tolist(), 0.0))
        assert apply_impulse(p, vector, np.zeros(3), torque, np.empty(10))
