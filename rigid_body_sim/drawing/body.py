# SPDX-License-Identifier: Apache-2.0
"""The drawing of a scene's body: its true shape if the scene file gives one."""

import math
from typing import NamedTuple

import numpy as np
import yaml

from rigid_body_sim.drawing import surfaces
from rigid_body_sim.scene.bodies import IDENTITY

THINNEST = 0.02
"""Thinnest edge of a box of equal inertia, relative to its longest."""
OF_SURFACE = {'sphere': 'solid_sphere'}
"""Shapes that are drawn for the surfaces of another name."""
UNKNOWN = (1.0, 0.6, 0.2)
"""Edges of the box that stands for a body of unknown shape, m."""


class Drawing(NamedTuple):
    """A body as surfaces in body axes.

    Attributes
    ----------
    surfaces : list of Surface
        In metres, about the body's origin.
    about : str
        Description of the picture: the shape, or what stands for it.
    stand_in : bool
        Whether a box stands for the body, because the scene gives no shape.
    """

    surfaces: list
    about: str
    stand_in: bool = False

    @property
    def vertices(self):
        """All vertices, array (n, 3)."""
        return np.concatenate([one.vertices for one in self.surfaces])

    def depth(self, point):
        """Return the radius (m) of a ball about a point that an opaque surface hides."""
        return max((one.depth(point) for one in self.surfaces if not one.clear), default=0.0)


def drawing_of(scene):
    """Return the Drawing of a Scene, or a plain box for None."""
    if scene is None:
        return Drawing([surfaces.box(UNKNOWN)], 'a box: the shape of the body is unknown', True)
    mapping = yaml.safe_load(scene.text)['body']
    solid = _solid(mapping, scene.body)
    if 'surface' in mapping:
        touching, name = _surface(scene.body.surface), article(scene.body.surface.kind)
        if solid is None:
            return Drawing([touching], f'the true shape, {name}')
        return Drawing([*solid.surfaces, touching._replace(clear=True)],
                       f'{solid.about}, and the surface that touches the plane, {name}')
    if solid is not None:
        return solid
    if scene.body.radius is not None:
        return Drawing([surfaces.sphere(scene.body.radius).placed(
            scene.body.center_of_mass)], 'the true shape, a sphere')
    return Drawing([_equal_box(scene.body)],
                   'a box with the same mass and moments of inertia: the scene gives no shape',
                   True)


def box_of(body):
    """Return the edges (m) of the box that has the body's mass and moments of inertia."""
    a, b, c = body.about_center.moments
    return tuple(math.sqrt(max(6.0 * square / body.mass, 0.0))
                 for square in (b + c - a, a + c - b, a + b - c))


def article(name):
    """Return the name of a shape with its article: an ellipsoid, a solid sphere."""
    return f'{"an" if name[0] in "aeiou" else "a"} {name.replace("_", " ")}'


def _solid(mapping, body):
    """Return the Drawing of the parts or the shape in a scene's mapping of a body, or None."""
    if 'parts' in mapping:
        shaped = [part for part in mapping['parts'] if 'shape' in part and not _is_hole(part)]
        if shaped:
            return Drawing([_part(part) for part in shaped],
                           _about_parts(mapping['parts'], shaped))
    if 'shape' in mapping:
        return Drawing([_shape(mapping['shape'], body.center_of_mass)],
                       f'the true shape, {article(next(iter(mapping["shape"])))}')
    return None


def _surface(surface):
    """Return the drawn Surface of a scene.surfaces.Surface."""
    size = {'ellipsoid': [surface.size], 'torus': surface.size[:2]}
    drawn = surfaces.SURFACES[OF_SURFACE.get(surface.kind, surface.kind)](
        *size.get(surface.kind, surface.size[:1]))
    return drawn.placed(surface.center)


def _shape(mapping, at, orientation=IDENTITY):
    (name, dimensions), = mapping.items()
    surface = surfaces.SURFACES[name](**dimensions)
    return surface.placed(at, orientation)


def _is_hole(part):
    return part.get('mass', part.get('density')) < 0.0


def _about_parts(parts, shaped):
    """Return a description of the drawn parts of a composite."""
    count, holes = len(shaped), sum(map(_is_hole, parts))
    left_out = [f'{number} {name}{"s" if number > 1 else ""}' for number, name in (
        (holes, 'hole'), (len(parts) - count - holes, 'shapeless part')) if number]
    if not left_out:
        return f'the true shape, {count} part{"s" if count > 1 else ""}'
    return f'{count} of {len(parts)} parts; not drawn: {", ".join(left_out)}'


def _part(mapping):
    return _shape(mapping['shape'], mapping.get('at', (0.0, 0.0, 0.0)),
                  mapping.get('orientation', IDENTITY))


def _equal_box(body):
    edges = np.array(box_of(body))
    edges = np.maximum(edges, THINNEST * edges.max()) if edges.any() else np.full(3, 0.1)
    return surfaces.box(edges).placed(body.center_of_mass, body.about_center.axes)
