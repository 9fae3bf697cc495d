# SPDX-License-Identifier: Apache-2.0
"""Moments of inertia of simple bodies (notes, "Some inertia tensors").

They are written as in the notes, M times a length squared times numbers, and independently of
rigid_body_sim/scene/shapes.py, which they confirm. Symbols: M mass (kg), L length, R radius (m);
moments (I1, I2, I3) in kg m^2 about the centre of mass, axis 3 along z, unless a name says
otherwise. Box, cylinder and ellipsoid are not in the notes: their source is Landau and Lifshitz,
Mechanics, section 32, problem 2.
"""

import numpy as np


def line(moment):
    """Return the moments of any mass on the z axis, I (1, 1, 0)."""
    return moment * np.array([1.0, 1.0, 0.0])


def rod_about_center(M, L):
    """Return the moments of a stick along z about its centre of mass, M L^2/12 (1, 1, 0)."""
    return line(M * L**2 / 12.0)


def rod_about_end(M, L):
    """Return the moments of a stick along z about its end, M L^2/3 (1, 1, 0)."""
    return line(M * L**2 / 3.0)


def lamina(Ixx, Iyy):
    """Return the moments of any lamina in the xy plane, I_zz = I_xx + I_yy."""
    return np.array([Ixx, Iyy, Ixx + Iyy])


def hoop(M, R):
    """Return the moments of a hoop in the xy plane, M R^2 (1/2, 1/2, 1)."""
    return M * R**2 * np.array([0.5, 0.5, 1.0])


def disk(M, R):
    """Return the moments of a disk in the xy plane, M R^2 (1/4, 1/4, 1/2)."""
    return M * R**2 * np.array([0.25, 0.25, 0.5])


def spherical_shell(M, R):
    """Return the moments of a spherical shell, (2/3) M R^2 (1, 1, 1)."""
    return 2.0 / 3.0 * M * R**2 * np.ones(3)


def solid_sphere(M, R):
    """Return the moments of a solid sphere, (2/5) M R^2 (1, 1, 1)."""
    return 2.0 / 5.0 * M * R**2 * np.ones(3)


def box(M, x, y, z):
    """Return the moments of a box with edges x, y, z, M/12 (y^2 + z^2, z^2 + x^2, x^2 + y^2)."""
    return M / 12.0 * np.array([y**2 + z**2, z**2 + x**2, x**2 + y**2])


def cylinder(M, R, L):
    """Return the moments of a cylinder along z, M ((3 R^2 + L^2)/12, same, R^2/2)."""
    return M * np.array([(3.0 * R**2 + L**2) / 12.0, (3.0 * R**2 + L**2) / 12.0, R**2 / 2.0])


def ellipsoid(M, a, b, c):
    """Return the moments of an ellipsoid with semi-axes a, b, c.

    They are M/5 (b^2 + c^2, c^2 + a^2, a^2 + b^2).
    """
    return M / 5.0 * np.array([b**2 + c**2, c**2 + a**2, a**2 + b**2])


def parallel_axis(moment, M, distance):
    """Return I + M distance^2, the moment about a parallel axis (notes, "Kater").

    `moment` is about the axis through the centre of mass, at a distance (m) from the other.
    """
    return moment + M * distance**2
