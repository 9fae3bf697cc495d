# SPDX-License-Identifier: Apache-2.0
"""Strikes: where they hit and what torque that makes, worked out by hand."""

import numpy as np
import pytest
from near import near

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
