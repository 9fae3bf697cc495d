# SPDX-License-Identifier: Apache-2.0
"""Surfaces of the shapes of a scene file as triangles, in metres, about their own centre of mass.

The symmetry axis of a shape that has one is z, as in ``scene.bodies``. Every surface has two
colours, which make a turn about a symmetry axis visible.
"""

from typing import NamedTuple

import numpy as np

from rigid_body_sim.scene.bodies import IDENTITY

AROUND, ALONG = 48, 24
"""Number of segments around an axis and along it."""
THIN = 0.01
"""Drawn thickness of thin shapes, relative to their length."""
SLIVER = 1e-9
"""A triangle this small, relative to the largest, has no plane: those at a pole."""


class Surface(NamedTuple):
    """Triangles that enclose a solid.

    Attributes
    ----------
    vertices : array (n, 3)
        Points, m.
    faces : array (m, 3)
        Vertex numbers of each triangle, counterclockwise seen from outside.
    accent : array (m,)
        True where a triangle has the second colour.
    smooth : bool
        Whether the surface is curved, so that its shading should hide the triangles.
    clear : bool
        Whether the surface is translucent, because something else is drawn inside it.
    """

    vertices: np.ndarray
    faces: np.ndarray
    accent: np.ndarray
    smooth: bool
    clear: bool = False

    def placed(self, at, orientation=IDENTITY):
        """Return the surface turned by a quaternion (x, y, z, w), then moved by `at` (m)."""
        vertices = self.vertices
        if any(orientation[:3]):
            # to import it takes a fifth of what a node needs to start; few scenes turn a shape
            from scipy.spatial.transform import Rotation
            vertices = Rotation.from_quat(orientation).apply(vertices)
        return self._replace(vertices=vertices + np.asarray(at, float))

    def depth(self, point):
        """Return how far (m) a point is below all planes of the triangles, 0 where it is not.

        In a convex solid this is the radius of the largest ball about the point.
        """
        a, b, c = np.moveaxis(self.vertices[self.faces] - point, 1, 0)
        normal = np.cross(b - a, c - a)
        size = np.linalg.norm(normal, axis=1)
        kept = size > SLIVER * size.max(initial=0.0)
        below = np.einsum('ij,ij->i', normal, a)[kept] / size[kept]
        return max(0.0, float(below.min(initial=np.inf))) if kept.any() else 0.0


def box(size):
    """Return a box with edges `size` = (x, y, z); the faces +x, +y, +z have the second colour."""
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    squares = ((0, 1, 3, 2), (0, 4, 5, 1), (0, 2, 6, 4), (4, 6, 7, 5), (2, 3, 7, 6), (1, 5, 7, 3))
    vertices = np.concatenate([corners[list(square)] for square in squares]) * size
    first = 4 * np.arange(6)[:, np.newaxis, np.newaxis]
    faces = np.add(first, [[0, 1, 2], [0, 2, 3]]).reshape(-1, 3)
    return Surface(vertices, faces, np.repeat(np.arange(6) >= 3, 2), False)


def lamina(width, height):
    """Return a thin plate in the xy plane, width along x."""
    return box((width, height, THIN * max(width, height)))


def ellipsoid(semi_axes):
    """Return an ellipsoid; its octants have alternating colours."""
    polar = np.linspace(0.0, np.pi, ALONG + 1)
    return _turned(np.sin(polar), np.cos(polar), semi_axes)


def sphere(radius):
    """Return a sphere."""
    return ellipsoid((radius, radius, radius))


def torus(radius, tube):
    """Return a torus about z; `radius` is that of the tube's centre line, `tube` the tube's."""
    around = np.linspace(0.0, 2.0 * np.pi, ALONG + 1)
    return _turned(radius + tube * np.sin(around), tube * np.cos(around))


def hoop(radius):
    """Return a thin ring in the xy plane."""
    return torus(radius, 2.0 * THIN * radius)


def cylinder(radius, length):
    """Return a cylinder along z."""
    return _lathe([0.0, radius, radius, 0.0], [0.5 * length, 0.5 * length, -0.5 * length,
                                               -0.5 * length])


def disk(radius):
    """Return a thin disk in the xy plane."""
    return cylinder(radius, 2.0 * THIN * radius)


def rod(length):
    """Return a thin rod along z."""
    return cylinder(THIN * length, length)


def cone(radius, height):
    """Return a cone along z, with its base a quarter of the height below the centre of mass."""
    return _lathe([0.0, radius, 0.0], [0.75 * height, -0.25 * height, -0.25 * height])


SURFACES = {
    'rod': rod, 'lamina': lamina, 'hoop': hoop, 'disk': disk, 'spherical_shell': sphere,
    'solid_sphere': sphere, 'box': box, 'cylinder': cylinder, 'cone': cone,
    'ellipsoid': ellipsoid, 'torus': torus}
"""Surface of each shape of a scene file; the keywords are the dimensions named there."""


def _lathe(radii, heights):
    """Return the solid of a profile with sharp edges; each line has its own vertices."""
    pieces = [_turned(np.array(radii[k:k + 2]), np.array(heights[k:k + 2]))
              for k in range(len(radii) - 1)]
    return joined(pieces)


def joined(surfaces):
    """Return several surfaces as one."""
    starts = np.cumsum([0, *(len(one.vertices) for one in surfaces[:-1])])
    return Surface(np.concatenate([one.vertices for one in surfaces]),
                   np.concatenate([one.faces + start for one, start in zip(surfaces, starts)]),
                   np.concatenate([one.accent for one in surfaces]), surfaces[0].smooth)


def _turned(radii, heights, scale=(1.0, 1.0, 1.0)):
    """Return the surface that a profile, given from the top down, sweeps around z."""
    angles = np.linspace(0.0, 2.0 * np.pi, AROUND + 1)
    rows = len(radii)
    net = np.stack([np.outer(radii, np.cos(angles)), np.outer(radii, np.sin(angles)),
                    np.repeat(heights[:, np.newaxis], AROUND + 1, axis=1)], axis=2) * scale
    row, column = np.meshgrid(np.arange(rows - 1), np.arange(AROUND), indexing='ij')
    corner = (row * (AROUND + 1) + column).ravel()
    below, beside = corner + AROUND + 1, corner + 1
    faces = np.concatenate([np.stack([corner, below, beside], axis=1),
                            np.stack([beside, below, below + 1], axis=1)])
    quarter = column.ravel() // (AROUND // 4)
    upper = row.ravel() < (rows - 1) / 2
    accent = np.tile((quarter + upper) % 2 == 1, 2)
    vertices = net.reshape(-1, 3)
    corners = vertices[faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]),
                          axis=1)
    kept = area > 1e-12 * area.max()
    return Surface(vertices, faces[kept], accent[kept], True)
