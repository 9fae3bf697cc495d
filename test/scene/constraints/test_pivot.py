# SPDX-License-Identifier: Apache-2.0
"""A pivot: the point that it holds, the tensor about it, and how a body starts there."""

import numpy as np
import pytest
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.constraints.pivot import DisplacedPivot, Pivot
from rigid_body_sim.scene.scene import parse_scene

CENTER, AT = np.array([0.1, -0.2, 0.3]), np.array([0.4, 0.5, -0.1])
PLACE, OMEGA = np.array([1.0, -2.0, 0.5]), np.array([0.3, -0.8, 1.2])
START = f'euler: [0.3, 1.1, -0.4], angular_velocity: {OMEGA.tolist()}, position: {PLACE.tolist()}'
MOTION = "motion: ['0.1 + 0.5*t', '2*sin(t)', '0.3*t^2 - 1']"


def scene_of(pivot, initial='', body='inertia: [0.3, 0.4, 0.5]'):
    return parse_scene(
        f'scene: held\nbody: {{mass: 2.0, {body}, center_of_mass: {CENTER.tolist()}}}\n'
        f'constraint: {{pivot: {{{pivot}}}}}\neffects: []\ninitial: {{{initial}}}\n')


@pytest.mark.parametrize(('pivot', 'at', 'moved', 'velocity'), [
    (f'at: {AT.tolist()}', AT, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
    (f'{MOTION}, at: {AT.tolist()}', AT, (0.1, 0.0, -1.0), (0.5, 2.0, 0.0)),
    (MOTION, np.zeros(3), (0.1, 0.0, -1.0), (0.5, 2.0, 0.0))])
def test_a_body_starts_with_its_point_where_the_pivot_is(pivot, at, moved, velocity):
    scene = scene_of(pivot, START)
    state = scene.initial
    turn = Rotation.from_quat(state.orientation)
    arm, omega = turn.apply(at), turn.apply(OMEGA)
    assert state.position + arm == near(PLACE + moved, rel=1e-14)    # 1e-16
    assert state.velocity + np.cross(omega, arm) == pytest.approx(velocity, abs=1e-14)    # 1e-16
    d = CENTER - at
    tensor = np.diag([0.3, 0.4, 0.5]) + 2.0 * (d @ d * np.eye(3) - np.outer(d, d))
    assert scene.constraint.inertia(scene.body).matrix == near(tensor, rel=1e-14)    # 7e-16
    frame = scene.frame
    assert (frame.moves, frame.point, frame.path is None) == (False, tuple(at), pivot[:2] == 'at')
    assert Rotation.from_quat(frame.axes).apply(frame.arm) == near(d, rel=1e-14)    # 2e-16


def test_a_pivot_at_the_origin_is_one_that_has_closed_forms():
    assert scene_of('at: [0, 0, 0]').constraint == Pivot()
    for at in np.diag([0.3, -0.2, 0.1]).tolist():
        assert scene_of(f'at: {at}').constraint == DisplacedPivot(tuple(at))


@pytest.mark.parametrize(('motion', 'said'), [
    ("['abs(t)', 0, 'max(t, 1)']", r'pivot\.motion: has abs, max; a path without kinks'),
    ("['1/t', 0, 0]", r'pivot\.motion: the place at time 0 is \[(inf|nan), 0\.0, 0\.0\]'),
    ("['sqrt(t)', 0, 0]", r'pivot\.motion: the velocity at time 0 is \[(inf|nan), 0\.0, 0\.0\]')])
def test_a_path_without_an_acceleration_is_refused(motion, said):
    with pytest.raises(BadInput, match=said):
        scene_of(f'motion: {motion}')


@pytest.mark.parametrize('pivot', [f'at: {CENTER.tolist()}',
                                   f'{MOTION}, at: {CENTER.tolist()}'])
def test_a_rod_does_not_spin_about_itself(pivot):
    rod = 'shape: {rod: {length: 1}}'
    assert scene_of(pivot, 'angular_velocity: [1, 2, 0]', rod).initial.angular_velocity[1] == 2.0
    with pytest.raises(BadInput, match='whose moment is zero'):
        scene_of(pivot, 'angular_velocity: [1, 2, 0.1]', rod)


@pytest.mark.parametrize('far', np.diag([1e75] * 3).tolist())
@pytest.mark.parametrize('pivot', ['', f'{MOTION}, '])
def test_a_point_so_far_that_squares_of_its_tensor_are_no_doubles_is_refused(far, pivot):
    with pytest.raises(BadInput, match=r'pivot: a moment of inertia of .*e\+150'):
        scene_of(f'{pivot}at: {far}')
