# SPDX-License-Identifier: Apache-2.0
"""Shapes: principal moments and extents of homogeneous bodies.

M is the mass (kg); lengths are in metres, moments in kg m^2. Every shape is placed with its centre
of mass at its own origin and its symmetry axis, where it has one, along z. Moments: notes, section
"Some inertia tensors"; cone, ellipsoid and torus: Landau and Lifshitz, Mechanics, section 32.
"""

import math


def rod(M, length):
    """Return the moments of a thin rod along z about its middle.

    About its end it is M length^2 / 3 (parallel axis).
    """
    return M * length * length / 12.0, M * length * length / 12.0, 0.0


def lamina(M, width, height):
    """Return the moments of a thin rectangle in the xy plane, width along x, height along y.

    I3 = I1 + I2 (perpendicular axes).
    """
    I1, I2 = M * height * height / 12.0, M * width * width / 12.0
    return I1, I2, I1 + I2


def hoop(M, radius):
    """Return the moments of a thin ring in the xy plane."""
    return M * radius * radius / 2.0, M * radius * radius / 2.0, M * radius * radius


def disk(M, radius):
    """Return the moments of a thin disk in the xy plane."""
    return M * radius * radius / 4.0, M * radius * radius / 4.0, M * radius * radius / 2.0


def spherical_shell(M, radius):
    """Return the moments of a thin spherical shell."""
    return (2.0 * M * radius * radius / 3.0,) * 3


def solid_sphere(M, radius):
    """Return the moments of a homogeneous ball."""
    return (2.0 * M * radius * radius / 5.0,) * 3


def box(M, size):
    """Return the moments of a homogeneous box with edges size = (x, y, z)."""
    x, y, z = size
    return M * (y * y + z * z) / 12.0, M * (z * z + x * x) / 12.0, M * (x * x + y * y) / 12.0


def cylinder(M, radius, length):
    """Return the moments of a homogeneous cylinder along z."""
    across = M * (3.0 * radius * radius + length * length) / 12.0
    return across, across, M * radius * radius / 2.0


def cone(M, radius, height):
    """Return the moments of a homogeneous cone along z about its centre of mass.

    The centre of mass lies a quarter of the height above the base.
    """
    across = 3.0 * M * (radius * radius + height * height / 4.0) / 20.0
    return across, across, 3.0 * M * radius * radius / 10.0


def ellipsoid(M, semi_axes):
    """Return the moments of a homogeneous ellipsoid with semi_axes = (a, b, c) along x, y, z."""
    a, b, c = semi_axes
    return M * (b * b + c * c) / 5.0, M * (c * c + a * a) / 5.0, M * (a * a + b * b) / 5.0


def torus(M, radius, tube):
    """Return the moments of a homogeneous torus about z.

    `radius` is that of the circle in the middle of the tube, `tube` the radius of the tube.
    """
    across = M * (radius * radius / 2.0 + 5.0 * tube * tube / 8.0)
    return across, across, M * (radius * radius + 3.0 * tube * tube / 4.0)


SHAPES = {shape.__name__: shape for shape in (
    rod, lamina, hoop, disk, spherical_shell, solid_sphere, box, cylinder, cone, ellipsoid, torus)}
SPHERES = ('spherical_shell', 'solid_sphere')
EXTENTS = {
    'rod': lambda length: length,
    'lamina': lambda width, height: width * height,
    'hoop': lambda radius: 2.0 * math.pi * radius,
    'disk': lambda radius: math.pi * radius * radius,
    'spherical_shell': lambda radius: 4.0 * math.pi * radius * radius,
    'solid_sphere': lambda radius: 4.0 * math.pi / 3.0 * radius * radius * radius,
    'box': lambda size: size[0] * size[1] * size[2],
    'cylinder': lambda radius, length: math.pi * radius * radius * length,
    'cone': lambda radius, height: math.pi / 3.0 * radius * radius * height,
    'ellipsoid':
        lambda semi_axes: 4.0 * math.pi / 3.0 * semi_axes[0] * semi_axes[1] * semi_axes[2],
    'torus': lambda radius, tube: 2.0 * math.pi * math.pi * radius * tube * tube,
}
"""What a density is multiplied by: the volume (m^3) of a solid, the area (m^2) of a thin body, the
length (m) of a rod or a hoop."""
