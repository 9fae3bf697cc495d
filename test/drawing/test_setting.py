# SPDX-License-Identifier: Apache-2.0
"""Ground, holder and scale of a picture, by hand."""

import numpy as np
import pytest

from rigid_body_sim.drawing import setting
from rigid_body_sim.drawing.body import drawing_of
from rigid_body_sim.numerics.rotations import rotate
from rigid_body_sim.scene.scene import parse_scene


def scene(constraint, more='', shape='box: {size: [0.2, 0.4, 0.6]}', center='[0.1, 0, 0.3]'):
    return parse_scene(f'scene: s\nbody: {{mass: 1, shape: {{{shape}}}, center_of_mass: {center}}}'
                       f'\nconstraint: {constraint}\neffects: []\ninitial: {{{more}}}\n')


HINGE = '{hinge: {axis: [0, 3, 4], through: [0, 0.5, 0]}}'
TURNED = 'orientation: [0, 0, 1, 1], position: [1, 2, 3]'    # a quarter turn about z


@pytest.mark.parametrize(('one', 'middle', 'start'), [
    (scene('free', TURNED), (0.1, 0.0, 0.3), (1.0, 2.1, 3.3)),
    (scene('pivot'), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
    (scene(HINGE, TURNED), (0.0, 0.5, 0.0), (1.0, 2.0, 3.0)),
    (None, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))])
def test_the_point_of_reference_is_what_is_held_or_the_centre_of_mass(one, middle, start):
    assert setting.middle_of(one) == pytest.approx(np.array(middle))
    assert setting.start_of(one) == pytest.approx(np.array(start), abs=1e-15)
    assert setting.follows(one) == (one is not None and one.constraint.kind == 'free')


def test_the_reach_is_that_of_the_farthest_corner():
    one = scene('pivot')
    corner = np.linalg.norm([0.2, 0.2, 0.6])
    assert setting.reach_of(one, drawing_of(one)) == pytest.approx(corner)
    free = scene('free')
    half = 0.5 * np.linalg.norm([0.2, 0.4, 0.6])
    assert setting.reach_of(free, drawing_of(free)) == pytest.approx(half)


def test_the_ground_is_the_table_or_just_below_all_that_turns():
    assert setting.ground_of(scene('free', TURNED), 2.0).height == pytest.approx(3.3 - 2.2)
    ball = scene('table', '', 'solid_sphere: {radius: 0.5}', '[0, 0, 0]')
    assert setting.ground_of(ball, 9.0).height == pytest.approx(ball.initial.position[2] - 0.5)
    assert setting.ground_of(None, 2.0).height == pytest.approx(-2.2)
    assert setting.ground_of(scene('pivot', TURNED), 2.0).height == pytest.approx(3.0 - 2.2)


def test_the_ground_of_a_plane_is_the_plane_itself():
    """Its normal is the z axis of the ground, which is level for other bodies."""
    slope = parse_scene(
        'scene: s\nbody: {mass: 1, inertia: [0.1, 0.1, 0.1], surface: {sphere: {radius: 0.5}}}\n'
        'constraint: {table: {normal: [0.6, 0, 0.8]}}\n'
        'effects: [gravity: {g: 9.81}, sliding_friction: {mu: 0.3}]\ninitial: {}\n')
    ground = setting.ground_of(slope, 9.0)
    assert ground.height == 0.0
    assert rotate(*ground.axes, 0.0, 0.0, 1.0) == pytest.approx((0.6, 0.0, 0.8), abs=1e-15)
    for one in (scene('free'), scene('table', '', 'solid_sphere: {radius: 0.5}', '[0, 0, 0]')):
        assert setting.ground_of(one, 2.0).axes == (0.0, 0.0, 0.0, 1.0)


def test_springs_have_the_ends_that_the_scene_gives():
    tied = parse_scene(
        'scene: s\nbody: {mass: 1, inertia: [0.1, 0.1, 0.1]}\nconstraint: free\n'
        'effects: [spring: {at: [0, 0, 1], anchor: [1, 2, 3], stiffness: 4}, gravity: {g: 9.81}, '
        'spring: {at: [1, 0, 0], anchor: [0, 0, 5], stiffness: 2}]\ninitial: {}\n')
    found = setting.springs_of(tied)
    assert [(one.at.tolist(), one.anchor.tolist()) for one in found] == [
        ([0.0, 0.0, 1.0], [1.0, 2.0, 3.0]), ([1.0, 0.0, 0.0], [0.0, 0.0, 5.0])]
    door = parse_scene(
        'scene: s\nbody: {mass: 1, inertia: [0.1, 0.1, 0.1]}\n'
        'constraint: {hinge: {axis: [0, 0, 1]}}\neffects: [spring: {stiffness: 4}]\n'
        'initial: {}\n')
    assert setting.springs_of(door) == setting.springs_of(scene('free')) == []
    assert setting.springs_of(None) == []


def test_a_column_carries_a_pivot_and_an_axle_goes_through_a_hinge():
    moved, = setting.holder_of(scene('pivot', TURNED), 2.0)
    column, = setting.holder_of(scene('pivot'), 2.0)
    assert moved.vertices == pytest.approx(np.add(column.vertices, [1.0, 2.0, 3.0]))
    # its tip is at the pivot, its foot on the ground
    assert column.vertices[:, 2].max() == pytest.approx(0.0, abs=1e-14)
    assert column.vertices[:, 2].min() == pytest.approx(-2.2)
    assert np.abs(column.vertices[:, :2]).max() == pytest.approx(0.24)
    axle, = setting.holder_of(scene(HINGE, TURNED), 2.0)
    along = (axle.vertices - [1.0, 2.0, 3.0]) @ [-0.6, 0.0, 0.8]    # the axis, turned
    assert (along.min(), along.max()) == pytest.approx((-1.0, 1.0))
    off = axle.vertices - [1.0, 2.0, 3.0] - np.outer(along, [-0.6, 0.0, 0.8])
    assert np.linalg.norm(off, axis=1).max() == pytest.approx(0.05)
    assert setting.holder_of(scene('free'), 2.0) == []
    assert setting.holder_of(None, 2.0) == []


@pytest.mark.parametrize(('reach', 'cell'), [
    (1.0, 1.0), (1.99, 1.0), (2.0, 2.0), (4.99, 2.0), (5.0, 5.0), (9.9, 5.0), (0.03, 0.02),
    (7e6, 5e6)])
def test_lines_of_the_ground_are_spaced_by_one_two_or_five(reach, cell):
    assert setting.cell_of(reach) == pytest.approx(cell)
