# SPDX-License-Identifier: Apache-2.0
"""The drawn surfaces are closed and have the volumes and moments of the shapes."""

import numpy as np
import pytest
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.drawing import surfaces
from rigid_body_sim.drawing.body import box_of, drawing_of
from rigid_body_sim.drawing.setting import ground_of, reach_of
from rigid_body_sim.messages import marker
from rigid_body_sim.messages.shapes import CYLINDER, SPHERE
from rigid_body_sim.scene import shapes
from rigid_body_sim.scene.scene import load_scene, parse_scene, scene_names

ROLLING = """
scene: rolls
body: {mass: 1.0, inertia: [1.0e-3, 1.2e-3, 1.6e-3], surface: {%s}}
constraint: {table: {normal: [0.1, 0.3, 1]}}
effects: [gravity: {g: 9.81}, sliding_friction: {mu: .inf}]
initial: {euler_zyz: [0.2, 0.6, 0.1], angular_velocity: [1, 0, 3], rolling: true}
"""
SOLIDS = {
    'box': {'size': (0.3, 0.2, 0.1)}, 'cylinder': {'radius': 0.2, 'length': 0.5},
    'cone': {'radius': 0.2, 'height': 0.5}, 'ellipsoid': {'semi_axes': (0.3, 0.2, 0.1)},
    'solid_sphere': {'radius': 0.3}, 'torus': {'radius': 0.3, 'tube': 0.1}}
THIN = {'rod': {'length': 2.0}, 'lamina': {'width': 0.3, 'height': 0.2}, 'hoop': {'radius': 0.2},
        'disk': {'radius': 0.3}, 'spherical_shell': {'radius': 0.1}}


def solid_integrals(surface):
    """Return volume, centre of mass and inertia at density 1, by tetrahedra from the origin."""
    a, b, c = np.moveaxis(surface.vertices[surface.faces], 1, 0)
    volumes = np.einsum('ij,ij->i', a, np.cross(b, c)) / 6.0
    center = (volumes[:, np.newaxis] * (a + b + c) / 4.0).sum(axis=0) / volumes.sum()
    corners = np.stack([a, b, c])
    sums = corners.sum(axis=0)
    second = (np.einsum('n,knp,knq->pq', volumes, corners, corners)
              + np.einsum('n,np,nq->pq', volumes, sums, sums)) / 20.0
    return volumes.sum(), center, np.trace(second) * np.eye(3) - second


@pytest.mark.parametrize('name', SOLIDS)
def test_a_drawn_solid_has_the_moments_of_its_shape(name):
    surface = surfaces.SURFACES[name](**SOLIDS[name])
    volume, center, inertia = solid_integrals(surface)
    assert volume > 0.0     # the triangles face outwards
    np.testing.assert_allclose(center, 0.0, atol=2e-3)
    expected = np.diag(shapes.SHAPES[name](volume, **SOLIDS[name]))
    # 48 chords round a circle, 24 along the meridian; measured up to 0.013 (the torus)
    np.testing.assert_allclose(inertia, expected, atol=0.02 * expected.max())


def test_the_faces_of_a_box_towards_its_axes_have_the_second_colour():
    box = surfaces.box((1.0, 2.0, 3.0))
    a, b, c = np.moveaxis(box.vertices[box.faces], 1, 0)
    towards = np.cross(b - a, c - a).sum(axis=1) > 0.0    # one component is not 0
    assert box.accent.tolist() == towards.tolist()
    assert not box.smooth


@pytest.mark.parametrize('name', [*SOLIDS, *THIN])
def test_every_surface_is_closed_and_has_two_colours(name):
    surface = surfaces.SURFACES[name](**(SOLIDS | THIN)[name])
    place = {tuple(point): k for k, point in enumerate(np.round(surface.vertices, 9).tolist())}
    number = [place[tuple(point)] for point in np.round(surface.vertices, 9).tolist()]
    faces = np.array(number)[surface.faces]
    edges = {}
    for one, other in np.concatenate([
        faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).tolist():
        key = (min(one, other), max(one, other))
        edges[key] = edges.get(key, 0) + (1 if one < other else -1)
    assert not any(edges.values())
    assert 0.2 < surface.accent.mean() < 0.8


@pytest.mark.parametrize('name', scene_names())
def test_every_scene_that_ships_can_be_drawn(name):
    scene = load_scene(name)
    drawing = drawing_of(scene)
    assert np.isfinite(drawing.vertices).all() and np.ptp(drawing.vertices, axis=0).min() > 0.0
    assert ('true shape' in drawing.about) == any(
        key in scene.text for key in ('shape:', 'radius:', 'surface:'))


@pytest.mark.parametrize('surface', [
    'sphere: {radius: 0.1, center: [0.01, 0, 0.02]}', 'ellipsoid: {semi_axes: [0.2, 0.03, 0.02]}',
    'torus: {radius: 0.1, tube: 0.02}', 'disk: {radius: 0.1}'])
def test_a_body_with_a_surface_is_that_surface_and_touches_the_drawn_plane(surface):
    scene = parse_scene(ROLLING % surface)
    drawing, marked = drawing_of(scene), marker.shape_fields(scene)
    assert 'true shape' in drawing.about
    assert marked['type'] == (marker.TRIANGLE_LIST if 'torus' in surface else
                              marker.TYPES[CYLINDER if 'disk' in surface else SPHERE])
    start = scene.initial
    ground = ground_of(scene, reach_of(scene, drawing))
    points = start.position + Rotation.from_quat(start.orientation).apply(drawing.vertices)
    heights = Rotation.from_quat(ground.axes).inv().apply(points - [0.0, 0.0, ground.height])[:, 2]
    size = np.ptp(drawing.vertices, axis=0).max()
    # 24 chords along a meridian, and a disk is drawn with a thickness of 2 % of its radius
    assert heights.min() == pytest.approx(0.0, abs=0.01 * size)


def test_a_bare_tensor_is_the_box_of_equal_inertia_and_says_so():
    scene = parse_scene("""
scene: tilted
body: {mass: 2.0, inertia: [[0.5, 0.1, 0.0], [0.1, 0.6, 0.0], [0.0, 0.0, 0.7]],
       center_of_mass: [0.1, 0.2, 0.3]}
constraint: free
effects: []
initial: {}
""")
    drawing = drawing_of(scene)
    assert 'no shape' in drawing.about
    volume, center, inertia = solid_integrals(drawing.surfaces[0].placed(
        (-0.1, -0.2, -0.3)))
    np.testing.assert_allclose(center, 0.0, atol=1e-12)
    np.testing.assert_allclose(inertia * 2.0 / volume, scene.body.about_center.matrix, rtol=1e-12,
                               atol=1e-12)
    assert np.prod(box_of(scene.body)) == pytest.approx(volume)


def test_parts_stand_where_the_scene_puts_them():
    scene = parse_scene("""
scene: handle
body:
  parts:
  - mass: 0.2
    shape: {cylinder: {radius: 0.01, length: 0.2}}
    orientation: [0.7071067811865476, 0, 0, 0.7071067811865476]
  - {mass: 0.1, shape: {cylinder: {radius: 0.01, length: 0.1}}, at: [0, 0, 0.05]}
constraint: free
effects: []
initial: {}
""")
    drawing = drawing_of(scene)
    assert drawing.about == 'the true shape, 2 parts'
    assert np.ptp(drawing.surfaces[0].vertices, axis=0) == pytest.approx(
        [0.02, 0.2, 0.02], abs=1e-3)
    assert drawing.surfaces[1].vertices[:, 2].min() == pytest.approx(0.0, abs=1e-12)
    assert drawing.surfaces[1].vertices[:, 2].max() == pytest.approx(0.1)


@pytest.mark.parametrize(('surface', 'point', 'depth'), [
    (surfaces.box((2.0, 4.0, 6.0)), (0.0, 0.0, 0.0), 1.0),
    (surfaces.box((2.0, 4.0, 6.0)), (0.0, 0.0, 2.5), 0.5),
    (surfaces.box((2.0, 4.0, 6.0)), (0.0, 0.0, 3.5), 0.0),
    (surfaces.cylinder(0.5, 4.0), (0.0, 0.0, 0.0), 0.5),
    (surfaces.torus(1.0, 0.2), (0.0, 0.0, 0.0), 0.0)])
def test_the_depth_of_a_point_is_the_largest_ball_about_it(surface, point, depth):
    assert surface.depth(np.array(point)) == near(depth, rel=0.01)
