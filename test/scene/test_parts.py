# SPDX-License-Identifier: Apache-2.0
"""Parts of a body: holes, points, given tensors, and densities, against integrals done by hand."""

import math

import numpy as np
import pytest
from near import near

from rigid_body_sim.drawing.body import drawing_of
from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages.shapes import solids_of
from rigid_body_sim.scene import shapes
from rigid_body_sim.scene.scene import parse_scene


def scene_of(body):
    return parse_scene(f'scene: a\nbody: {body}\nconstraint: free\neffects: []\ninitial: {{}}')


def body_of(*parts):
    return scene_of(f'{{parts: [{", ".join(parts)}]}}').body


def test_a_ball_with_a_hole_in_the_middle_is_a_thick_shell():
    shape = '{{density: {}, shape: {{solid_sphere: {{radius: {}}}}}}}'
    body = body_of(shape.format(1000, 0.2), shape.format(-1000, 0.1))
    # 8 pi rho (b^5 - a^5)/15
    assert body.mass == near(4000 * math.pi / 3 * (0.008 - 0.001), rel=1e-15)
    assert body.about_center.moments == near(
        [8000 * math.pi / 15 * (0.2 ** 5 - 0.1 ** 5)] * 3, rel=1e-15)


def test_a_disk_with_a_hole_off_the_middle_by_the_parallel_axis_theorem():
    body = body_of('{mass: 4, shape: {disk: {radius: 2}}}',
                   '{mass: -1, shape: {disk: {radius: 1}}, at: [1, 0, 0]}')
    assert body.mass == 3.0
    assert body.center_of_mass == pytest.approx((-1 / 3, 0.0, 0.0), abs=1e-16)
    # about the middle of the disk 4 4/2 - (1/2 + 1); moved to the centre of mass less 3/9
    assert body.about_center.moments[2] == near(8 - 1.5 - 1 / 3, rel=1e-15)


def test_points_and_a_given_tensor_that_is_turned():
    turn = [0, 0, math.sin(math.pi / 4), math.cos(math.pi / 4)]
    body = body_of('{mass: 0.5, point: [1, 0, 0]}', '{mass: 0.5, point: [-1, 0, 0]}',
                   f'{{mass: 2, inertia: [1, 2, 3], orientation: {turn}}}')
    # by hand: the points give (0, 1, 1); a quarter turn about z changes moments 1 and 2
    assert np.diag(body.about_center.matrix) == near([2, 2, 4], rel=1e-15)


@pytest.mark.parametrize(('name', 'dimensions', 'extent'), [
    ('rod', {'length': 2.0}, 2.0), ('lamina', {'width': 3.0, 'height': 2.0}, 6.0),
    ('hoop', {'radius': 2.0}, 4 * math.pi), ('disk', {'radius': 2.0}, 4 * math.pi),
    ('spherical_shell', {'radius': 3.0}, 36 * math.pi),
    ('solid_sphere', {'radius': 3.0}, 36 * math.pi), ('box', {'size': (1.0, 2.0, 3.0)}, 6.0),
    ('cylinder', {'radius': 2.0, 'length': 6.0}, 24 * math.pi),
    ('cone', {'radius': 2.0, 'height': 3.0}, 4 * math.pi),
    ('ellipsoid', {'semi_axes': (1.0, 2.0, 3.0)}, 8 * math.pi),
    ('torus', {'radius': 2.0, 'tube': 1.0}, 4 * math.pi ** 2)])
def test_a_density_is_per_volume_area_or_length(name, dimensions, extent):
    assert shapes.EXTENTS[name](**dimensions) == near(extent, rel=1e-15)


def test_every_shape_has_an_extent():
    assert set(shapes.EXTENTS) == set(shapes.SHAPES)


def test_a_body_by_its_density():
    assert scene_of('{density: 2.0, shape: {box: {size: [1, 2, 3]}}}').body.mass == 12.0


@pytest.mark.parametrize(('body', 'line'), [
    ('{parts: [{mass: 1, shape: {disk: {radius: 1}}}, {mass: -2, shape: {disk: {radius: 1}}}]}',
     'body.parts: have the mass -1.0 kg together; holes take away less than there is'),
    ('{parts: [{mass: 1, shape: {disk: {radius: 1}}}, {mass: -0.9, shape: {disk: {radius: 2}}}]}',
     'body.inertia: moment -0.65 about the centre of mass is negative; '
     'moments of inertia are zero or positive'),
    ('{density: 3, inertia: [1, 2, 3]}', 'body.density: is given without a shape; '
     'a density needs the volume of a shape: give mass'),
    ('{mass: 1, density: 3, shape: {disk: {radius: 2}}}',
     'body.density: is given together with mass; give one of them'),
    ('{parts: [{mass: 0, point: [1, 0, 0]}]}',
     'body.parts.0.mass: got 0; needs a number that is not 0'),
    ('{parts: [{mass: 1, point: [1, 0, 0], at: [1, 0, 0]}]}',
     'body.parts.0.at: is given together with point; point: [x, y, z] says where it is'),
    ('{parts: [{mass: 1}]}',
     'body.parts.0: got none of them; give exactly one of shape, inertia, point')])
def test_what_no_body_is_gets_one_line(body, line):
    with pytest.raises(BadInput) as refusal:
        scene_of(body)
    assert str(refusal.value) == f'scene, line 2: {line}'


def test_the_picture_says_what_it_leaves_out():
    scene = scene_of('{parts: [{mass: 4, shape: {disk: {radius: 2}}}, '
                     '{mass: 1, point: [0, 0, 1]}, '
                     '{mass: -1, shape: {disk: {radius: 1}}, at: [1, 0, 0]}]}')
    drawing = drawing_of(scene)
    assert len(drawing.surfaces) == 1
    assert drawing.about == '1 of 3 parts; not drawn: 1 hole, 1 shapeless part'
    assert solids_of(scene) is None
