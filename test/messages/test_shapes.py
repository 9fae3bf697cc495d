# SPDX-License-Identifier: Apache-2.0
"""The body of a scene as solids: each as large as it is drawn, in its place."""

import pytest
from near import near

from rigid_body_sim.drawing.surfaces import SURFACES
from rigid_body_sim.messages import shapes
from rigid_body_sim.messages.shapes import BOX, CYLINDER, SPHERE, Solid, solids_of
from rigid_body_sim.scene.bodies import IDENTITY
from rigid_body_sim.scene.scene import parse_scene

FLAT = 'box: {size: [1, 2, 3]}'


def scene(body):
    return parse_scene(f'scene: s\nbody: {{{body}}}\nconstraint: free\neffects: []\n'
                       'initial: {}\n')


@pytest.mark.parametrize(('name', 'dimensions', 'kind'), [
    ('box', {'size': (1.0, 2.0, 3.0)}, BOX), ('lamina', {'width': 2.0, 'height': 3.0}, BOX),
    ('lamina', {'width': 5.0, 'height': 3.0}, BOX),
    ('ellipsoid', {'semi_axes': (1.0, 2.0, 3.0)}, SPHERE),
    ('solid_sphere', {'radius': 3.0}, SPHERE), ('spherical_shell', {'radius': 3.0}, SPHERE),
    ('disk', {'radius': 3.0}, CYLINDER), ('cylinder', {'radius': 2.0, 'length': 3.0}, CYLINDER),
    ('rod', {'length': 3.0}, CYLINDER)])
def test_a_solid_is_as_large_as_the_surface_that_is_drawn(name, dimensions, kind):
    made, size = shapes.SOLIDS[name](**dimensions)
    vertices = SURFACES[name](**dimensions).vertices
    assert made == kind
    # the vertices lie on the axes but for rounding: 1e-16
    assert size == near(tuple(vertices.max(axis=0) - vertices.min(axis=0)), rel=1e-14)


SPHERE_OF_1 = Solid(SPHERE, (1.0, 1.0, 1.0), (0.0, 0.0, 0.25))
SEEN = {
    'a surface alone': ('mass: 1.0, inertia: [1, 1, 1], '
                        'surface: {sphere: {radius: 0.5, center: [0, 0, 0.25]}}', [SPHERE_OF_1]),
    'around a shape': (f'mass: 1.0, shape: {{{FLAT}}}, '
                       'surface: {sphere: {radius: 0.5, center: [0, 0, 0.25]}}',
                       [Solid(BOX, (1, 2, 3), (0.0, 0.0, 0.0)), SPHERE_OF_1._replace(clear=True)]),
    'a torus around it': (f'mass: 1.0, shape: {{{FLAT}}}, '
                          'surface: {torus: {radius: 5, tube: 1}}', None),
    'a disk alone': ('mass: 1.0, inertia: [1, 1, 1], surface: {disk: {radius: 0.5}}',
                     [Solid(CYLINDER, (1.0, 1.0, 0.01), (0.0, 0.0, 0.0))]),
    'parts': (f'parts: [{{mass: 0.5, shape: {{{FLAT}}}, at: [1, 2, 3], '
              'orientation: [1, 0, 0, 0]}, {mass: 2.0, shape: {solid_sphere: {radius: 0.5}}}]',
              [Solid(BOX, (1, 2, 3), (1.0, 2.0, 3.0), (1, 0, 0, 0)),
               SPHERE_OF_1._replace(at=(0.0, 0.0, 0.0))]),
    'one is no solid': (f'parts: [{{mass: 1.0, shape: {{{FLAT}}}}}, '
                        '{mass: 2.0, shape: {cone: {radius: 0.5, height: 1}}}]', None),
    'one is a hole': (f'parts: [{{mass: 9.0, shape: {{{FLAT}}}}}, '
                      '{mass: -0.1, shape: {solid_sphere: {radius: 0.5}}}]', None),
    'nothing but moments': ('mass: 1.0, inertia: [1, 1, 1]', None)}


@pytest.mark.parametrize('case', SEEN)
def test_a_body_is_solids_where_these_show_its_true_shape(case):
    body, solids = SEEN[case]
    assert solids_of(scene(body)) == solids


def test_without_an_orientation_a_solid_stands_as_the_body():
    assert Solid(BOX, (1, 2, 3), (0.0, 0.0, 0.0)).orientation == IDENTITY
