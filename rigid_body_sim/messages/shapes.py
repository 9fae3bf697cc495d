# SPDX-License-Identifier: Apache-2.0
"""The body of a scene as simple solids, for markers and robot descriptions."""

from collections.abc import Callable
from typing import NamedTuple

import yaml

from rigid_body_sim.drawing.surfaces import THIN
from rigid_body_sim.scene.bodies import IDENTITY

BOX, SPHERE, CYLINDER = 'box', 'sphere', 'cylinder'


class Solid(NamedTuple):
    """A box, an ellipsoid (`sphere`) or a cylinder along its z axis.

    Attributes
    ----------
    kind : str
        BOX, SPHERE or CYLINDER.
    size : tuple of 3 floats
        Full extents, m.
    at, orientation : tuple of floats
        Centre (m) and axes (quaternion) in the body.
    clear : bool
        Whether it is translucent, because other solids are shown inside it.
    """

    kind: str
    size: tuple
    at: tuple
    orientation: tuple = IDENTITY
    clear: bool = False


def _sphere(radius):
    return SPHERE, (2.0 * radius,) * 3


def _cylinder(radius, length):
    return CYLINDER, (2.0 * radius, 2.0 * radius, length)


SOLIDS: dict[str, Callable] = {
    'box': lambda size: (BOX, tuple(size)),
    'lamina': lambda width, height: (BOX, (width, height, THIN * max(width, height))),
    'ellipsoid': lambda semi_axes: (SPHERE, tuple(2.0 * axis for axis in semi_axes)),
    'solid_sphere': _sphere,
    'spherical_shell': _sphere,
    'cylinder': _cylinder,
    'disk': lambda radius: _cylinder(radius, 2.0 * THIN * radius),
    'rod': lambda length: _cylinder(THIN * length, length),
}
"""Kind and size of the shapes of a scene file that are solids; thin ones as in drawing/."""


def solids_of(scene) -> list[Solid] | None:
    """Return the solids of a scene's body, or None if solids cannot show its true shape."""
    mapping = yaml.safe_load(scene.text)['body']
    if 'parts' in mapping:
        found = [_solid(None if _is_hole(part) else part.get('shape'),
                        part.get('at', (0.0, 0.0, 0.0)), part.get('orientation', IDENTITY))
                 for part in mapping['parts']]
    elif 'shape' in mapping:
        found = [_solid(mapping['shape'], scene.body.center_of_mass, IDENTITY)]
    elif 'surface' in mapping:
        found = []
    elif scene.body.radius is not None:
        found = [Solid(*_sphere(scene.body.radius), tuple(scene.body.center_of_mass))]
    else:
        return None
    if 'surface' in mapping:
        touching = _solid_surface(scene.body.surface)
        found.append(touching and touching._replace(clear=bool(found)))
    return found if all(found) else None


def _solid_surface(surface):
    """Return the solid of a scene.surfaces.Surface, None for a torus."""
    made = {'sphere': lambda: _sphere(surface.size[0]),
            'ellipsoid': lambda: SOLIDS['ellipsoid'](surface.size),
            'disk': lambda: SOLIDS['disk'](surface.size[0])}
    return Solid(*made[surface.kind](), surface.center) if surface.kind in made else None


def _is_hole(part):
    return part.get('mass', part.get('density')) < 0.0


def _solid(shape, at, orientation):
    if not shape:
        return None
    [(name, dimensions)] = shape.items()
    if name not in SOLIDS:
        return None
    return Solid(*SOLIDS[name](**dimensions), tuple(map(float, at)), tuple(orientation))


def equal_box(scene, edges: tuple) -> Solid:
    """Return a box of these edges at the centre of mass, along the body's principal axes."""
    return Solid(
        BOX, tuple(edges), tuple(scene.body.center_of_mass), tuple(scene.body.about_center.axes))
