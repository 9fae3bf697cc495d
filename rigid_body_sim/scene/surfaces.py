# SPDX-License-Identifier: Apache-2.0
"""Surfaces: which point of a body touches a plane, and how it moves as the body turns.

Symbols: gamma unit normal of the plane in body axes (it points away from the plane), s(gamma) the
lowest point from the middle of the surface, body axes. With gamma_t = (gamma_1, gamma_2, 0):

    sphere      s = -R gamma
    ellipsoid   s = -D^2 gamma/sigma,  sigma^2 = gamma . D^2 gamma,  D = diag(semi-axes)
    torus       s = -b gamma - a gamma_t/|gamma_t|     (a to the middle of the tube, b of the tube)
    disk        s = -a gamma_t/|gamma_t|               (a circle about body axis z, its sharp edge)

The derivative ds/dgamma is a symmetric matrix S with S gamma = 0.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from rigid_body_sim.compilation.jit import inlined
from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics.vectors import dot, minus, plus, product, scaled
from rigid_body_sim.scene.schema import POSITIVE, VECTOR, mapping_of

Vector = tuple[float, float, float]
SPHERE, ELLIPSOID, TORUS = 0.0, 1.0, 2.0
"""Kinds of surface; a disk is a torus whose tube has the radius 0."""
KINDS = {'sphere': SPHERE, 'ellipsoid': ELLIPSOID, 'torus': TORUS, 'disk': TORUS}
TINY = 1e-300    # keeps a quotient finite where a disk lies flat
SURFACE = mapping_of(
    sphere=mapping_of(['radius'], radius=POSITIVE, center=VECTOR),
    ellipsoid=mapping_of(['semi_axes'], semi_axes={**VECTOR, 'items': POSITIVE}, center=VECTOR),
    torus=mapping_of(['radius', 'tube'], radius=POSITIVE, tube=POSITIVE, center=VECTOR),
    disk=mapping_of(['radius'], radius=POSITIVE, center=VECTOR))
SURFACE |= {'minProperties': 1, 'maxProperties': 1}
OF_SHAPE = {'solid_sphere': 'sphere', 'spherical_shell': 'sphere', 'ellipsoid': 'ellipsoid',
            'torus': 'torus', 'disk': 'disk', 'hoop': 'disk'}
"""The surface of each shape that has a smooth convex one, or a sharp circular edge."""
LONGEST = 1e6      # m
THINNEST = 1e-6    # smallest quotient of the dimensions of a surface


@dataclass(frozen=True)
class Surface:
    """A closed convex surface in a body's axes.

    Attributes
    ----------
    kind : str
        ``sphere``, ``ellipsoid``, ``torus`` or ``disk``; torus and disk lie about body axis z.
    size : tuple of 3 floats
        m: the radius; the semi-axes; the radius to the middle of the tube and that of the tube;
        the radius of the disk. What is left over is 0.
    center : tuple of 3 floats
        The middle, from the body's origin, body axes, m.
    """

    kind: str
    size: Vector
    center: Vector

    def lowest(self, gamma: Vector) -> Vector:
        """Return the lowest point from the body's origin, for a normal gamma, body axes, m."""
        x, y, z = plus(self.center, lowest(KINDS[self.kind], self.size, gamma))
        return x, y, z


@inlined
def lowest(kind, size, gamma):
    """Return s(gamma), m. `size` is (R, -, -), the semi-axes, or (a, b, -)."""
    if kind == ELLIPSOID:
        squares = product(size, size)
        pulled = product(squares, gamma)
        return scaled(-1.0 / math.sqrt(dot(gamma, pulled)), pulled)
    if kind == TORUS:
        across = math.sqrt(gamma[0] * gamma[0] + gamma[1] * gamma[1]) + TINY
        out = size[1] + size[0] / across
        return -out * gamma[0], -out * gamma[1], -size[1] * gamma[2]
    return scaled(-size[0], gamma)


@inlined
def tilted(kind, size, gamma):
    """Return s x gamma, m: the couple about the middle of the surface over a normal force.

    What of s is along gamma has no part in it. The products of s and gamma would leave the
    rounding of s in its place: on a ball 1e-17 R, beside which friction may be small.
    """
    x, y, z = gamma
    if kind == ELLIPSOID:
        a, b, c = size
        share = -1.0 / math.sqrt(dot(gamma, product(product(size, size), gamma)))
        return (share * ((b - c) * (b + c)) * (y * z), share * ((c - a) * (c + a)) * (z * x),
                share * ((a - b) * (a + b)) * (x * y))
    if kind == TORUS:
        share = size[0] / (math.sqrt(x * x + y * y) + TINY) * z
        return -share * y, share * x, 0.0
    return 0.0, 0.0, 0.0


@inlined
def shifted(kind, size, gamma, x):
    """Return S x, m, for a vector x perpendicular to gamma."""
    if kind == ELLIPSOID:
        squares = product(size, size)
        pulled, moved = product(squares, gamma), product(squares, x)
        square = dot(gamma, pulled)
        along = dot(pulled, x) / square
        return scaled(-1.0 / math.sqrt(square), minus(moved, scaled(along, pulled)))
    if kind == TORUS:
        across = math.sqrt(gamma[0] * gamma[0] + gamma[1] * gamma[1]) + TINY
        # the part of x along the circle: (-gamma_2, gamma_1, 0)/|gamma_t|
        tx, ty = -gamma[1] / across, gamma[0] / across
        along = size[0] / across * (tx * x[0] + ty * x[1])
        return -size[1] * x[0] - along * tx, -size[1] * x[1] - along * ty, -size[1] * x[2]
    return scaled(-size[0], x)


def surface_of(mapping: Mapping[str, Any], where: str) -> Surface:
    """Return the surface of its key in a scene file, which satisfies SURFACE.

    Raises
    ------
    BadInput
        For dimensions so different or so large that doubles lose them.
    """
    (kind, settings), = mapping.items()
    center = settings.get('center', (0.0, 0.0, 0.0))
    return _made(kind, settings, center, f'{where}.{kind}')


def surface_of_shape(shape: str, dimensions: Mapping[str, Any], center: Vector,
                     where: str) -> Surface | None:
    """Return the surface of a homogeneous shape about its centre of mass, None if it has edges."""
    if shape not in OF_SHAPE:
        return None
    return _made(OF_SHAPE[shape], dimensions, center, where)


def _made(kind, dimensions, center, where):
    if kind == 'ellipsoid':
        size = tuple(float(x) for x in dimensions['semi_axes'])
    else:
        size = float(dimensions['radius']), float(dimensions.get('tube', 0.0)), 0.0
    given = [x for x in size if x > 0.0]
    middle = tuple(float(x) for x in center)
    if not max(*given, *map(abs, middle)) <= LONGEST or not (
            min(given) >= THINNEST * max(given) and min(given) >= 1e-9):
        raise BadInput(where, f'got lengths {list(size)} m about {list(middle)}',
                       f'at most {LONGEST:g} m and at least 1e-9 m, each at least '
                       f'{THINNEST:g} of the largest')
    return Surface(kind, size, middle)
