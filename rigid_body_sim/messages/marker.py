# SPDX-License-Identifier: Apache-2.0
"""The body as a marker for RViz: its true shape if the scene gives one.

A body that is one box, ellipsoid or cylinder is that marker; any other shape is a list of
triangles, in two colours that make a turn visible. Without a shape it is a box with the body's
mass and moments of inertia.
"""

import numpy as np

from rigid_body_sim.drawing.body import THINNEST, box_of, drawing_of
from rigid_body_sim.messages.shapes import BOX, CYLINDER, SPHERE, Solid, equal_box, solids_of

TYPES = {BOX: 1, SPHERE: 2, CYLINDER: 3}
"""Numbers of visualization_msgs/Marker."""
TRIANGLE_LIST = 11
COLOUR, ACCENT = (
    {'r': 0.2, 'g': 0.5, 'b': 0.9, 'a': 1.0}, {'r': 0.95, 'g': 0.9, 'b': 0.8, 'a': 1.0})
CLEAR = 0.35
"""Opacity of a translucent surface."""


def solid_of(scene) -> Solid | None:
    """Return the one solid that shows the body, or None if it needs triangles."""
    mapping = solids_of(scene)
    if mapping and len(mapping) == 1:
        return mapping[0]
    drawing = drawing_of(scene)
    if drawing.stand_in:
        edges = np.array(box_of(scene.body))
        largest = edges.max()
        size = np.maximum(edges, THINNEST * largest) if largest else np.full(3, 0.1)
        return equal_box(scene, tuple(size.tolist()))
    return None


def shape_fields(scene) -> dict:
    """Return the constant fields of the marker, which describe its shape."""
    solid = solid_of(scene)
    if solid:
        return {
            'type': TYPES[solid.kind],
            'scale': dict(zip('xyz', solid.size, strict=True)),
            'color': COLOUR,
        }
    points, colours = [], []
    for surface in drawing_of(scene).surfaces:
        corners = surface.vertices[surface.faces].reshape(-1, 3).tolist()
        points += [dict(zip('xyz', corner, strict=True)) for corner in corners]
        pair = [{**one, 'a': CLEAR} if surface.clear else one for one in (COLOUR, ACCENT)]
        colours += [pair[accent] for accent in np.repeat(surface.accent, 3).astype(int)]
    return {
        'type': TRIANGLE_LIST,
        'scale': {'x': 1.0, 'y': 1.0, 'z': 1.0},
        'color': COLOUR,
        'points': points,
        'colors': colours,
    }


def place_of(scene) -> tuple[tuple, tuple]:
    """Return the centre (m) and the axes (quaternion) of the marker in the body."""
    solid = solid_of(scene)
    return (solid.at, solid.orientation) if solid else ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
