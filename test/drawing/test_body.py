# SPDX-License-Identifier: Apache-2.0
"""The drawing of a body, and its description."""

import numpy as np
import pytest
from near import near

from rigid_body_sim.drawing.body import UNKNOWN, box_of, drawing_of
from rigid_body_sim.scene.scene import load_scene, parse_scene


def scene(body):
    return parse_scene(f'scene: s\nbody: {{{body}}}\nconstraint: free\neffects: []\ninitial: {{}}')


def extent(drawing):
    return np.ptp(drawing.vertices, axis=0)


def test_the_box_of_equal_inertia_has_its_edges_and_its_place():
    one = scene('mass: 12, inertia: [5, 10, 13], center_of_mass: [1, 2, 3]')
    assert box_of(one.body) == pytest.approx((3.0, 2.0, 1.0))
    drawing = drawing_of(one)
    assert extent(drawing) == pytest.approx([3.0, 2.0, 1.0])
    assert drawing.vertices.mean(axis=0) == pytest.approx([1.0, 2.0, 3.0])
    assert drawing.about.startswith('a box with the same mass and moments')


@pytest.mark.parametrize(('inertia', 'edges'), [
    ([4, 9, 13], (3.0, 2.0, 0.06)), ([25, 0, 25], (0.1, 5.0, 0.1))])
def test_a_thin_body_is_drawn_two_hundredths_thick(inertia, edges):
    assert extent(drawing_of(scene(f'mass: 12, inertia: {inertia}'))) == pytest.approx(edges)


def test_a_point_is_a_small_cube_and_an_unknown_body_a_box():
    assert extent(drawing_of(load_scene('spherical_pendulum'))) == pytest.approx([0.1] * 3)
    assert extent(drawing_of(None)) == pytest.approx(UNKNOWN)
    assert 'unknown' in drawing_of(None).about


@pytest.mark.parametrize(('parts', 'about', 'drawn'), [
    ('{mass: 1, shape: {box: {size: [1, 1, 1]}}}', 'the true shape, 1 part', 1),
    ('{mass: 1, shape: {box: {size: [1, 1, 1]}}}, {mass: 1, shape: {disk: {radius: 1}}}',
     'the true shape, 2 parts', 2),
    ('{mass: 4, shape: {box: {size: [1, 1, 1]}}}, '
     '{mass: -1, shape: {solid_sphere: {radius: 0.2}}}', '1 of 2 parts; not drawn: 1 hole', 1),
    ('{mass: 4, shape: {box: {size: [1, 1, 1]}}}, {mass: 1, point: [1, 0, 0]}, '
     '{mass: -1, shape: {solid_sphere: {radius: 0.2}}}, {mass: -1, shape: {solid_sphere: '
     '{radius: 0.1}}, at: [0.3, 0, 0]}', '1 of 4 parts; not drawn: 2 holes, 1 shapeless part', 1)])
def test_of_a_composite_it_is_said_what_is_not_drawn(parts, about, drawn):
    drawing = drawing_of(scene(f'parts: [{parts}]'))
    assert drawing.about == about
    assert len(drawing.surfaces) == drawn


def test_a_shape_is_drawn_where_its_centre_of_mass_is():
    drawing = drawing_of(scene('mass: 1, shape: {solid_sphere: {radius: 2}}, '
                               'center_of_mass: [1, 2, 3]'))
    assert drawing.about == 'the true shape, a solid sphere'
    assert drawing.vertices.max(axis=0) == near([3.0, 4.0, 5.0], rel=1e-2)


@pytest.mark.parametrize(('body', 'about', 'stands_in', 'hidden'), [
    (None, 'a box: the shape of the body is unknown', True, 0.1),
    ('mass: 12, inertia: [5, 10, 13]',
     'a box with the same mass and moments of inertia: the scene gives no shape', True, 0.5),
    ('mass: 1, shape: {box: {size: [2, 4, 6]}}', 'the true shape, a box', False, 1.0),
    ('mass: 1, inertia: [1, 1, 1], radius: 3', 'the true shape, a sphere', False, 3.0),
    ('mass: 1, inertia: [1, 1, 1], surface: {ellipsoid: {semi_axes: [2, 3, 4]}}',
     'the true shape, an ellipsoid', False, 2.0),
    ('mass: 1, shape: {box: {size: [2, 4, 6]}}, surface: {ellipsoid: {semi_axes: [5, 5, 5]}}',
     'the true shape, a box, and the surface that touches the plane, an ellipsoid', False, 1.0),
    ('parts: [{mass: 1, shape: {box: {size: [2, 4, 6]}}}, '
     '{mass: 1, shape: {box: {size: [8, 8, 8]}}}]', 'the true shape, 2 parts', False, 4.0)])
def test_it_is_said_what_is_drawn_and_known_what_it_hides(body, about, stands_in, hidden):
    """A clear surface hides nothing, and of opaque ones the thickest hides a ball."""
    drawing = drawing_of(None if body is None else scene(body))
    assert (drawing.about, drawing.stand_in) == (about, stands_in)
    assert drawing.depth(np.zeros(3)) == near(hidden, rel=0.02)
    assert drawing._replace(surfaces=[
        one._replace(clear=True) for one in drawing.surfaces]).depth(np.zeros(3)) == 0.0


def test_a_body_of_unknown_shape_is_a_flat_long_box():
    assert extent(drawing_of(None)) == pytest.approx([1.0, 0.6, 0.2])


def test_a_part_is_drawn_at_its_place_which_is_the_origin_unless_it_is_given():
    drawing = drawing_of(scene(
        'parts: [{mass: 1, shape: {box: {size: [2, 4, 6]}}}, '
        '{mass: 0.5, shape: {box: {size: [8, 8, 8]}}, at: [1, 2, 3]}]'))
    assert [one.vertices.mean(axis=0).tolist() for one in drawing.surfaces] == [
        [0.0, 0.0, 0.0], pytest.approx([1.0, 2.0, 3.0])]
