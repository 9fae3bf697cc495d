# SPDX-License-Identifier: Apache-2.0
"""Ways to give the start: each means what it says, checked by SciPy's rotations and by hand."""

import math

import numpy as np
import pytest
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.initial import unit_quaternion
from rigid_body_sim.scene.principal_axes import ULPS
from rigid_body_sim.scene.scene import parse_scene

SKEW = '{mass: 2.0, inertia: [[0.05, 0.004, -0.002], [0.004, 0.06, 0.003], [-0.002, 0.003, 0.03]]}'
EPS = np.finfo(float).eps
ANGLES, VECTOR = [0.3, -1.1, 2.5], [0.4, -0.2, 3.0]


def start(initial, body=SKEW, constraint='free'):
    return parse_scene(f'scene: start\nbody: {body}\nconstraint: {constraint}\neffects: []\n'
                       f'initial: {{{initial}}}').initial


@pytest.mark.parametrize(('key', 'rotation'), [
    ('euler', Rotation.from_euler('xyz', ANGLES)),
    ('euler_zyz', Rotation.from_euler('ZYZ', ANGLES)),
    ('rotation_vector', Rotation.from_rotvec(ANGLES))])
def test_orientation_is_the_rotation_that_its_key_names(key, rotation):
    found = Rotation.from_quat(start(f'{key}: {ANGLES}').orientation)
    assert (found * rotation.inv()).magnitude() < 1e-15       # measured 3.2e-16


def test_roll_alone_turns_about_x():
    found = start('euler: [0.5, 0, 0]').orientation
    assert found == near([np.sin(0.25), 0.0, 0.0, np.cos(0.25)], rel=1e-15)


def test_angular_velocity_of_the_world_is_turned_into_body_axes():
    found = start(f'euler: {ANGLES}, angular_velocity_world: {VECTOR}')
    turned = Rotation.from_quat(found.orientation).apply(found.angular_velocity)
    assert np.abs(turned - VECTOR).max() < 2e-15      # of 3; measured 4.4e-16


@pytest.mark.parametrize(('constraint', 'center'), [
    ('free', [0, 0, 0]), ('pivot', [0, 0, 0]), ('pivot', [0.02, -0.01, 0.1])])
def test_angular_momentum_is_that_of_the_world_about_the_point_of_reference(constraint, center):
    body = SKEW.replace('}', f', center_of_mass: {center}}}')
    scene = parse_scene(f'scene: a\nbody: {body}\nconstraint: {constraint}\neffects: []\n'
                        f'initial: {{euler: {ANGLES}, angular_momentum: {VECTOR}}}')
    R = Rotation.from_quat(scene.initial.orientation)
    tensor = scene.body.about_center if constraint == 'free' else scene.body.about_origin
    L = R.apply(tensor.matrix @ scene.initial.angular_velocity)
    assert np.abs(L - VECTOR).max() < 4e-15      # of 3; measured 9e-16


@pytest.mark.parametrize(('initial', 'line'), [
    ('euler: [0, 0, 1], tilt: 1',
     'scene, line 5: initial.tilt: is given together with euler; give the orientation once'),
    ('spin: 1, angular_momentum: [1, 2, 3]',
     'scene, line 5: initial.spin: is given together with angular_momentum; '
     'give the angular velocity once'),
    ('angular_velocity: [1, 2, 3], angular_velocity_world: [1, 2, 3]',
     'scene, line 5: initial.angular_velocity_world: is given together with angular_velocity; '
     'give the angular velocity once')])
def test_saying_it_twice_gets_one_line(initial, line):
    with pytest.raises(BadInput) as refusal:
        start(initial)
    assert str(refusal.value) == line


def test_no_angular_momentum_about_an_axis_without_moment():
    rod = '{mass: 1.0, shape: {rod: {length: 2.0}}}'
    assert start('angular_momentum: [1, 0, 0]', rod).angular_velocity[0] == near(3.0, rel=1e-15)
    with pytest.raises(BadInput, match='about principal axis 3, whose moment is zero'):
        start('angular_momentum: [1, 0, 0.1]', rod)


def test_an_override_takes_the_place_of_the_other_ways():
    text = 'scene: a\nbody: {mass: 1, inertia: [1, 2, 3]}\nconstraint: free\neffects: []\n' \
        'initial: {tilt: 1, spin: 4}'
    found = parse_scene(text, ['initial.rotation_vector=[0, 0, 1]',
                               'initial.angular_momentum=[1, 2, 3]']).initial
    assert found.orientation[:2].tolist() == [0.0, 0.0]
    assert found.angular_velocity[2] == 1.0


@pytest.mark.parametrize('constraint', [
    'free', 'pivot', '{pivot: {at: [0.1, 0, 0]}}', "{pivot: {motion: ['t', 0, 0]}}",
    '{hinge: {axis: [0, 0, 1]}}'])
def test_every_motion_begins_at_time_zero(constraint):
    scene = parse_scene(f"""
scene: begins
body: {{mass: 1.0, inertia: [1.0, 1.5, 2.0]}}
constraint: {constraint}
effects: []
initial: {{}}
""")
    assert scene.initial.time == 0.0


ROD = '{mass: 1.0, shape: {rod: {length: 2.0}}}'
A_TURN = 'orientation: [0, 0, 0.6, 0.8]'


@pytest.mark.parametrize(('initial', 'vector'), [
    ('', [0, 0, 0, 0, 1, *[0] * 9]),
    ('spin: 4', [0, 0, 0, 0, 1, 0, 0, 4, *[0] * 6]),
    ('angular_velocity: [1, 2, 3]', [0, 0, 0, 0, 1, 1, 2, 3, *[0] * 6]),
    ('position: [1, 2, 3], velocity: [4, 5, 6]', [0, 0, 0, 0, 1, 0, 0, 0, 1, 2, 3, 4, 5, 6]),
    ('tilt: 1, spin: 2', [0, 0, math.sin(0.5), 0, math.cos(0.5), 0, 0, 2, *[0] * 6]),
    (A_TURN, [0, 0, 0, 0.6, 0.8, *[0] * 9])])
def test_what_is_given_is_kept_and_the_rest_is_zero(initial, vector):
    assert start(initial).vector.tolist() == near(vector, rel=EPS)


@pytest.mark.parametrize('scale', [1.0, 1e-150, 1e150, 1e-310, 1e307])
def test_a_quaternion_of_any_norm_is_divided_by_it(scale):
    """(2, 4, 5, 6) has the norm 9; squares of the large and the small are no doubles."""
    found = unit_quaternion([2.0 * scale, 4.0 * scale, 5.0 * scale, 6.0 * scale], 'q')
    rel = 1e-13 if scale == 1e-310 else 4e-16    # multiples of 5e-324: 1e-14; measured 2e-16
    assert found == near((2 / 9, 4 / 9, 5 / 9, 6 / 9), rel=rel)


@pytest.mark.parametrize('k', range(4))
def test_a_quaternion_that_is_as_good_as_one_is_kept_to_the_last_bit(k):
    """Its square is 1 to two ulps; dividing by the norm again would make 1 of it."""
    for w in (1.0 + EPS, 1.0 - EPS, 1.0 - EPS / 2):
        given = tuple(w if place == k else 0.0 for place in range(4))
        assert unit_quaternion(given, 'q') == given
    w = 1.0 + 2 * EPS
    assert sum(unit_quaternion([w if place == k else 0.0 for place in range(4)], 'q')) == 1.0


def test_a_quaternion_of_the_square_two_is_divided_too():
    assert unit_quaternion([0, -1, 0, 1], 'q') == near((0, -(0.5 ** 0.5), 0, 0.5 ** 0.5), rel=EPS)
    with pytest.raises(BadInput, match='of non-zero norm'):
        unit_quaternion([0, 0, 0, 0], 'q')


@pytest.mark.parametrize('across', [(1.0, 0.0), (0.0, 1.0)])
@pytest.mark.parametrize(('key', 'refused'), [
    ('angular_momentum', r'kg m\^2/s about principal axis 3, whose moment is zero'),
    ('angular_velocity', 'rad/s about principal axis 3, whose moment is zero')])
def test_along_a_rod_there_is_what_rounding_leaves_and_no_more(key, refused, across):
    """As much as ULPS of the whole; with what is across 1, the whole is 1."""
    found = start(f'{key}: [{across[0]}, {across[1]}, {float(ULPS)!r}]', ROD).angular_velocity
    times = 3.0 if key == 'angular_momentum' else 1.0    # M length^2/12 = 1/3
    assert found[:2] == near([times * one for one in across], rel=4 * EPS)
    assert found[2] == (0.0 if key == 'angular_momentum' else ULPS)
    with pytest.raises(BadInput, match=refused):
        start(f'{key}: [{across[0]}, {across[1]}, {float(1.1 * ULPS)!r}]', ROD)


def test_a_rod_askew_to_its_axes_may_turn_across_itself_only():
    """It lies along (3, 4, 0): the tensor is |r|^2 - r r^T."""
    askew = '{mass: 1, inertia: [[16, -12, 0], [-12, 9, 0], [0, 0, 25]]}'
    assert start('angular_velocity: [4, -3, 2]', askew).angular_velocity.tolist() == [4, -3, 2]
    assert start('angular_momentum: [100, -75, 50]', askew).angular_velocity == pytest.approx(
        [4, -3, 2], abs=1e-14)
    for key in ('angular_velocity', 'angular_momentum'):
        with pytest.raises(BadInput, match='whose moment is zero'):
            start(f'{key}: [3, 4, 0]', askew)
