# SPDX-License-Identifier: Apache-2.0
"""A hinge: where its axis is, and how a body starts on it."""

import numpy as np
import pytest
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.scene import parse_scene

CENTER, THROUGH = np.array([0.1, -0.2, 0.3]), np.array([0.4, 0.5, -0.1])
AXIS, PLACE = np.array([2.0, -1.0, 2.0]) / 3.0, np.array([1.0, -2.0, 0.5])
ANGLES = [0.3, 1.1, -0.4]


def scene_of(hinge, initial='', body='inertia: [0.3, 0.4, 0.5]'):
    return parse_scene(
        f'scene: hung\nbody: {{mass: 2.0, {body}, center_of_mass: {CENTER.tolist()}}}\n'
        f'constraint: {{hinge: {{{hinge}}}}}\neffects: []\ninitial: {{{initial}}}\n')


def test_a_body_starts_at_its_angle_from_the_orientation_given_and_turns_about_the_axis():
    scene = scene_of(f'axis: [4, -2, 4], through: {THROUGH.tolist()}',
                     f'euler: {ANGLES}, angle: 1.2, rate: -3, position: {PLACE.tolist()}')
    state, zero = scene.initial, Rotation.from_euler('xyz', ANGLES)
    turn = Rotation.from_quat(state.orientation)
    assert (turn.inv() * zero * Rotation.from_rotvec(1.2 * AXIS)).magnitude() < 1e-14
    assert state.angular_velocity == near(-3.0 * AXIS, rel=1e-15)
    # the point on the axis is where `position` says, at rest
    arm = turn.apply(THROUGH)
    assert state.position + arm == near(PLACE, rel=1e-14)    # 2e-16
    assert state.velocity == near(-np.cross(turn.apply(-3.0 * AXIS), arm), rel=1e-14)    # 6e-16
    frame = scene.frame
    assert (frame.moves, frame.point, frame.mass) == (False, tuple(THROUGH), 2.0)
    assert frame.arm == near(CENTER - THROUGH, rel=1e-15)
    assert frame.hinge.axis == near(AXIS, rel=1e-15)
    # at the angle 0 it has the orientation that was given
    assert (Rotation.from_quat(frame.hinge.zero).inv() * zero).magnitude() < 1e-14


def test_without_them_the_angle_is_zero_the_body_at_rest_and_its_origin_on_the_axis():
    state = scene_of('axis: [4, -2, 4]', 'euler: [0.5, 0, 0]').initial
    assert state.orientation == near([np.sin(0.25), 0.0, 0.0, np.cos(0.25)], rel=1e-15)
    assert not state.vector[5:].any()


@pytest.mark.parametrize('distance', [0.3, -0.2])
@pytest.mark.parametrize('axis', [[1, 0, 0], [0, 3, 4], [1, 2, -2]])
def test_a_body_hangs_by_a_distance_from_its_centre_of_mass(distance, axis):
    """It is measured along body axis z, as far as that is across the axis."""
    n = np.array(axis) / np.linalg.norm(axis)
    upward = np.array([0.0, 0.0, 1.0]) - n[2] * n
    point = CENTER + distance * upward / np.linalg.norm(upward)
    hung = scene_of(f'axis: {axis}, distance: {distance}').constraint
    assert hung.through == pytest.approx(point, rel=1e-15, abs=1e-16)


@pytest.mark.parametrize(('hinge', 'said'), [
    ('axis: [0, 0, 0]', r'hinge\.axis: got \[0, 0, 0\]; a direction'),
    ('axis: [1, 0, 0], distance: 0.3, through: [0, 0, 1]', 'distance: is given together with'),
    ('axis: [1, 0, 0], distance: 0', r'hinge\.distance: got 0'),
    ('axis: [0.9e-8, 0, 1], distance: 0.3', r'hinge\.distance: got an axis .* along z')])
def test_what_says_no_axis_is_refused(hinge, said):
    with pytest.raises(BadInput, match=said):
        scene_of(hinge)


@pytest.mark.parametrize(('through', 'refused'), [(CENTER.tolist(), True), ([0, 0, 0], False)])
def test_an_axis_along_a_rod_is_refused_and_one_beside_it_is_not(through, refused):
    hinge, rod = f'axis: [0, 0, 2], through: {through}', 'shape: {rod: {length: 1}}'
    if not refused:
        assert scene_of(hinge, body=rod).constraint.axis == (0.0, 0.0, 1.0)
        return
    with pytest.raises(BadInput, match='about which the body has no moment of inertia'):
        scene_of(hinge, body=rod)
