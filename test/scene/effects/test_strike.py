# SPDX-License-Identifier: Apache-2.0
"""Strikes: where they hit and what torque that makes, worked out by hand."""

import dataclasses
from fractions import Fraction

import numpy as np
import pytest
from near import near

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.scene import parse_scene

BALL = """
scene: ball
body: {{mass: 0.17, shape: {{solid_sphere: {{radius: 0.05}}}}}}
constraint: table
effects: [strike: {{impulse: {impulse}, height: {height}}}]
initial: {{}}
"""
HINGED = """
scene: bat
body: {{mass: 0.9, inertia: [0.3, 0.4, 0.5], center_of_mass: [0.7, -0.4, 0.3]}}
constraint: {{hinge: {{axis: {axis}, through: [0.1, 0.2, -0.3]}}}}
effects: [strike: {{impulse: [1, 2, 3], distance: {distance}}}]
initial: {{}}
"""
FREE = """
scene: box
body: {{mass: 2.0, inertia: [0.3, 0.4, 0.5], center_of_mass: [0.1, 0.2, -0.3]}}
constraint: free
effects: [strike: {{impulse: [1, 2, 3], point: [0.6, -0.1, 0.2], frame: {frame}}}]
initial: {{orientation: [0, 0, 1, 1]}}
"""


def struck(text):
    """Return the impulses of force and torque at the start of a scene with one strike, rounded."""
    scene = parse_scene(text)
    force, torque = scene.effect('strike').as_impulse(scene.body, scene.initial.vector)
    return force[:3].tolist(), torque[:3].tolist()


@pytest.mark.parametrize('impulse', [(0.3, 0.4), (-0.5, 1.2), (0.2, 0.0), (0.0, -0.7)])
@pytest.mark.parametrize('height', [0.03, -0.02, 0.05])
def test_a_level_cue_behind_the_middle_gives_no_side_spin_in_any_direction(impulse, height):
    """It hits in the vertical plane through the middle: the torque is h z x J."""
    force, torque = struck(BALL.format(impulse=[*impulse, 0], height=height))
    assert force == [*impulse, 0.0]
    expected = [-height * impulse[1], height * impulse[0], 0.0]
    assert torque == pytest.approx(expected, abs=1e-16)


def test_a_cue_at_the_middle_and_a_cue_without_impulse_give_no_torque():
    assert struck(BALL.format(impulse=[0.3, 0.4, 0], height=0))[1] == [0.0] * 3
    assert struck(BALL.format(impulse=[0, 0, 0], height=0.02)) == ([0.0] * 3, [0.0] * 3)


@pytest.mark.parametrize('axis', [(0.0, 0.0, 1.0), (1.0, 2.0, -2.0), (-3.0, 0.0, 4.0)])
@pytest.mark.parametrize('distance', [0.25, 1.5])
def test_a_distance_from_a_hinge_is_measured_straight_towards_the_centre_of_mass(axis, distance):
    """The point lies across the axis from `through`, on the side of the centre of mass."""
    scene = parse_scene(HINGED.format(axis=list(axis), distance=distance))
    arm = np.subtract(scene.effect('strike').point, [0.1, 0.2, -0.3])
    assert np.linalg.norm(arm) == near(distance, rel=1e-14)
    assert arm @ axis == pytest.approx(0.0, abs=1e-14)
    to_center = np.subtract([0.7, -0.4, 0.3], [0.1, 0.2, -0.3])
    assert np.cross(axis, to_center) @ np.cross(axis, arm) > 0.0
    assert np.cross(axis, arm) @ to_center == pytest.approx(0.0, abs=1e-13)


def test_a_point_is_measured_from_the_origin_and_acts_about_the_centre_of_mass():
    """The body stands a quarter turn about z: body x is world y, body y is world -x."""
    lever = (0.3, 0.5, 0.5)    # world axes; point - centre of mass = (0.5, -0.3, 0.5)
    force, torque = struck(FREE.format(frame='world'))
    assert force == [1.0, 2.0, 3.0]
    assert torque == pytest.approx(np.cross(lever, force).tolist(), abs=1e-15)
    force, torque = struck(FREE.format(frame='body'))
    assert force == pytest.approx([-2.0, 1.0, 3.0], abs=1e-15)
    assert torque == pytest.approx(np.cross(lever, force).tolist(), abs=2e-15)


def turned(q, vector):
    """Return R v without rounding, for a quaternion of any norm."""
    x, y, z, w = map(Fraction, q)
    rows = ((x * x - y * y - z * z + w * w, 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), y * y - x * x - z * z + w * w, 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), z * z - x * x - y * y + w * w))
    return [sum(a * Fraction(b) for a, b in zip(row, vector, strict=True))
            / (x * x + y * y + z * z + w * w) for row in rows]


@pytest.mark.parametrize('frame', ['world', 'body'])
def test_what_rounding_took_from_a_strike_is_told_beside_it(frame):
    scene = parse_scene(FREE.format(frame=frame).replace('[0, 0, 1, 1]', '[0.1, -0.5, 0.3, 0.7]'))
    q = scene.initial.orientation.tolist()
    found = scene.effect('strike').as_impulse(scene.body, scene.initial.vector)
    J = [Fraction(one) for one in (1, 2, 3)] if frame == 'world' else turned(q, (1, 2, 3))
    x, y, z = turned(q, [Fraction(a) - Fraction(b) for a, b in zip(
        (0.6, -0.1, 0.2), (0.1, 0.2, -0.3), strict=True)])
    K = y * J[2] - z * J[1], z * J[0] - x * J[2], x * J[1] - y * J[0]
    for pair, exact in zip(found, (J, K), strict=True):
        for high, low, one in zip(pair[:3], pair[3:], exact, strict=True):
            assert abs(Fraction(high) + Fraction(low) - one) < 1e-30    # measured 3e-32
            assert abs(low) < 4e-15


@pytest.mark.parametrize('frame', ['world', 'body'])
def test_a_strike_that_names_no_point_hits_the_centre_of_mass_at_the_start(frame):
    text = FREE.format(frame=frame).replace('point: [0.6, -0.1, 0.2], ', '')
    force, torque = struck(text)
    assert force == pytest.approx([1, 2, 3] if frame == 'world' else [-2, 1, 3], abs=1e-15)
    assert torque == [0.0] * 3
    scene = parse_scene(text)
    strike = scene.effect('strike')
    assert strike.time == strike.SCHEMA['properties']['time']['default'] == 0.0
    # rounding takes nothing where nothing is turned
    assert {one.shape for one in strike.as_impulse(scene.body, scene.initial.vector)} == {
        (3,) if frame == 'world' else (6,)}


def test_a_speed_is_that_of_a_ball_along_x():
    force, torque = struck(BALL.format(impulse='[0, 0, 0]', height=0.02).replace(
        'impulse: [0, 0, 0]', 'speed: 3'))
    assert force == near([0.17 * 3, 0.0, 0.0], rel=1e-15)
    assert torque == near([0.0, 0.02 * 0.17 * 3, 0.0], rel=1e-15)


def test_a_cue_above_the_middle_hits_the_surface_of_the_ball():
    """A level cue along x: the lever is (-0.04, 0, 0.03), on the radius 0.05; a J_z shows it."""
    scene = parse_scene(BALL.format(impulse=[0.3, 0, 0], height=0.03))
    tilted = dataclasses.replace(scene.effect('strike'), impulse=(0.3, 0.0, 0.4))
    _, torque = tilted.as_impulse(scene.body, scene.initial.vector)
    behind = 0.04 * 0.3 / 0.5    # straight against an impulse of the size 0.5
    assert torque.tolist() == near([0.0, 0.03 * 0.3 + behind * 0.4, 0.0], rel=1e-14)


@pytest.mark.parametrize(('strike', 'words'), [
    ('impulse: [1, 0, 0], point: [0, 0, 0], height: 0.01', 'height: is given together with point'),
    ('impulse: [1, 0, 0], speed: 1', 'give one of impulse'), ('height: 0.01', 'give one of impul'),
    ('impulse: [1, 0, 0.5]', 'a level cue'), ('impulse: [1, 0, 0], frame: body', 'a level cue'),
    ('impulse: [1, 0, 0], height: 0.051', 'at most the radius'),
    ('impulse: [1, 0, 0], height: -0.051', 'at most the radius'),
    ('impulse: [1, 0, 0], distance: 1', r'distance: has no meaning on constraint .table.'),
    ('speed: 1, frame: body', 'speed: is given together with frame: body'),
    ('impulse: [1, 0, 0], time: -0.1', 'time')])
def test_a_strike_that_no_cue_gives_is_refused(strike, words):
    with pytest.raises(BadInput, match=words):
        parse_scene(BALL.format(impulse='[1, 0, 0]', height=0).replace(
            'impulse: [1, 0, 0], height: 0', strike))


@pytest.mark.parametrize(('strike', 'words'), [
    ('speed: 1', r'speed: has no meaning on constraint .free.'),
    ('impulse: [1, 0, 0], height: 0.1', r'height: has no meaning on constraint .free.')])
def test_a_cue_is_for_the_table(strike, words):
    with pytest.raises(BadInput, match=words):
        parse_scene(FREE.format(frame='world').replace(
            'impulse: [1, 2, 3], point: [0.6, -0.1, 0.2]', strike))


def test_a_scene_may_have_strikes_one_of_them_half_a_second_after_the_start():
    text = FREE.format(frame='world').replace(
        'effects: [', 'effects: [strike: {impulse: [1, 0, 0], time: 0.5}, ')
    assert [one.time for one in parse_scene(text).effects] == [0.5, 0.0]


def test_a_hinge_through_the_centre_of_mass_has_no_side_to_measure_from():
    text = HINGED.format(axis=[0, 0, 1], distance=0.5).replace('[0.7, -0.4, 0.3]', '[0.1, 0.2, 4]')
    with pytest.raises(BadInput, match='no direction to measure it in'):
        parse_scene(text)
