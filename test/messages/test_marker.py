# SPDX-License-Identifier: Apache-2.0
"""The marker of a body: the box of equal inertia, and the numbers of RViz."""

import pytest
from near import near

from rigid_body_sim.messages.marker import TRIANGLE_LIST, place_of, shape_fields, solid_of
from rigid_body_sim.scene.scene import load_scene, parse_scene


def scene(body):
    return parse_scene(f'scene: s\nbody: {{mass: 12.0, {body}}}\nconstraint: free\n'
                       'effects: []\ninitial: {}\n')


def moments(a, b, c):
    """Return the moments of a box of 12 kg with these edges."""
    return [b * b + c * c, a * a + c * c, a * a + b * b]


@pytest.mark.parametrize(('edges', 'shown'), [
    ((3.0, 2.0, 1.0), (3.0, 2.0, 1.0)),
    ((3.0, 2.0, 0.0), (3.0, 2.0, 0.06)),      # a lamina: 2 % of its longest edge
    ((0.0, 5.0, 0.0), (0.1, 5.0, 0.1)),       # a rod
    ((3.0, 2.0, 0.05), (3.0, 2.0, 0.06)),
    ((3.0, 2.0, 0.07), (3.0, 2.0, 0.07))])
def test_a_bare_tensor_is_a_box_that_is_never_too_thin_to_see(edges, shown):
    fields = shape_fields(scene(f'inertia: {moments(*edges)}'))
    assert fields['type'] == 1
    assert tuple(fields['scale'][axis] for axis in 'xyz') == near(shown, rel=1e-12)


def test_the_box_stands_at_the_centre_of_mass_along_the_principal_axes():
    tensor = [[4.0, 1.0, 0.0], [1.0, 5.0, 0.0], [0.0, 0.0, 6.0]]
    one = scene(f'inertia: {tensor}, center_of_mass: [1, 2, 3]')
    place, axes = place_of(one)
    assert place == (1.0, 2.0, 3.0)
    assert axes == tuple(one.body.about_center.axes) != (0.0, 0.0, 0.0, 1.0)


def test_a_body_without_moments_is_a_small_cube():
    fields = shape_fields(load_scene('spherical_pendulum'))
    assert fields['scale'] == {'x': 0.1, 'y': 0.1, 'z': 0.1}


@pytest.mark.parametrize(('shape', 'kind', 'size'), [
    ('box: {size: [1, 2, 3]}', 1, (1, 2, 3)), ('solid_sphere: {radius: 2}', 2, (4, 4, 4)),
    ('ellipsoid: {semi_axes: [1, 2, 3]}', 2, (2, 4, 6)),
    ('cylinder: {radius: 2, length: 3}', 3, (4, 4, 3)),
    ('disk: {radius: 2}', 3, None), ('rod: {length: 2}', 3, None),
    ('lamina: {width: 2, height: 3}', 1, None)])
def test_a_solid_is_the_primitive_of_its_full_extents(shape, kind, size):
    fields = shape_fields(scene(f'shape: {{{shape}}}'))
    assert fields['type'] == kind
    if size:
        assert tuple(fields['scale'].values()) == size
    else:
        assert 0.0 < min(fields['scale'].values()) < 0.1 * max(fields['scale'].values())
    assert fields['color'] == {'r': 0.2, 'g': 0.5, 'b': 0.9, 'a': 1.0}


def shades(fields):
    return sorted({tuple(colour[key] for key in 'rgba') for colour in fields['colors']})


def test_a_surface_around_another_solid_is_translucent():
    fields = shape_fields(scene('shape: {box: {size: [0.1, 0.2, 0.3]}}, '
                                'surface: {sphere: {radius: 0.5}}'))
    assert shades(fields) == [(0.2, 0.5, 0.9, 0.35), (0.2, 0.5, 0.9, 1.0),
                              (0.95, 0.9, 0.8, 0.35), (0.95, 0.9, 0.8, 1.0)]


def test_what_is_no_single_solid_is_triangles_of_two_colours():
    one = scene('shape: {torus: {radius: 1.0, tube: 0.2}}')
    assert solid_of(one) is None
    fields = shape_fields(one)
    assert fields['type'] == TRIANGLE_LIST == 11
    assert fields['scale'] == {'x': 1.0, 'y': 1.0, 'z': 1.0}
    assert len(fields['points']) == len(fields['colors']) > 0
    assert len(fields['points']) % 3 == 0
    assert shades(fields) == [(0.2, 0.5, 0.9, 1.0), (0.95, 0.9, 0.8, 1.0)]
    assert place_of(one) == ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
