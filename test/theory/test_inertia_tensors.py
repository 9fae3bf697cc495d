# SPDX-License-Identifier: Apache-2.0
"""Moments of inertia against the integrals that define them, and the simulator's bodies."""

import numpy as np
import pytest
from near import near

from rigid_body_sim.scene import bodies
from rigid_body_sim.theory import inertia_tensors as theory

NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)


def along(low, high):
    """Return Gauss-Legendre nodes and weights of an interval."""
    return 0.5 * (high - low) * NODES + 0.5 * (high + low), 0.5 * (high - low) * WEIGHTS


def moments_of(points, masses, M):
    """Return the moments of point masses, scaled to a total mass M."""
    x, y, z = points
    m = masses * M / masses.sum()
    return np.array([
        (m * (y**2 + z**2)).sum(), (m * (z**2 + x**2)).sum(), (m * (x**2 + y**2)).sum()])


def round_about(radius, height, weight):
    """Return points and masses of rings; each (radius, height, weight) has 12 equal angles."""
    angle = np.arange(12) * np.pi / 6.0
    shape = (*np.broadcast(radius, height, weight).shape, 12)
    x, y = np.multiply.outer(radius, np.cos(angle)), np.multiply.outer(radius, np.sin(angle))
    return ((np.broadcast_to(x, shape), np.broadcast_to(y, shape),
             np.broadcast_to(np.expand_dims(height, -1), shape)),
            np.broadcast_to(np.expand_dims(weight, -1), shape))


def test_rod():
    z, w = along(-0.7, 0.7)
    assert theory.rod_about_center(2.0, 1.4) == near(moments_of((0 * z, 0 * z, z), w, 2.0), 1e-14)
    z, w = along(0.0, 1.4)
    assert theory.rod_about_end(2.0, 1.4) == near(moments_of((0 * z, 0 * z, z), w, 2.0), 1e-14)
    assert theory.rod_about_end(2.0, 1.4)[0] == near(
        theory.parallel_axis(theory.rod_about_center(2.0, 1.4)[0], 2.0, 0.7), 1e-15)


def test_lamina_of_any_shape():
    """The moment of a triangle about its normal is the sum of the other two."""
    u, wu = along(0.0, 1.0)
    x, y = np.meshgrid(u, u)
    points = (x, 0.5 * (1.0 - x) * y, 0.0 * x)
    moments = moments_of(points, np.outer(wu, wu) * (1.0 - x), 3.0)
    assert theory.lamina(moments[0], moments[1]) == near(moments, 1e-14)


def test_hoop_and_disk():
    points, masses = round_about(np.array([0.3]), np.array([0.0]), np.array([1.0]))
    assert theory.hoop(2.0, 0.3) == near(moments_of(points, masses, 2.0), 1e-14)
    r, w = along(0.0, 0.3)
    points, masses = round_about(r, 0.0 * r, w * r)
    assert theory.disk(2.0, 0.3) == near(moments_of(points, masses, 2.0), 1e-14)


def test_shell_and_solid_sphere():
    z, w = along(-0.3, 0.3)
    # Archimedes: equal heights, equal areas
    points, masses = round_about(np.sqrt(0.09 - z**2), z, w)
    assert theory.spherical_shell(2.0, 0.3) == near(moments_of(points, masses, 2.0), 1e-14)
    r, wr = along(0.0, 0.3)
    solid = (sum(weight * radius**2 * theory.spherical_shell(1.0, radius)
                 for radius, weight in zip(r, wr)) / (wr * r**2).sum())
    assert theory.solid_sphere(2.0, 0.3) == near(2.0 * solid, 1e-14)


def test_box_cylinder_ellipsoid():
    (x, wx), (y, wy), (z, wz) = along(-0.1, 0.1), along(-0.2, 0.2), along(-0.3, 0.3)
    grid = np.meshgrid(x, y, z, indexing='ij')
    assert theory.box(2.0, 0.2, 0.4, 0.6) == near(
        moments_of(grid, np.einsum('i,j,k->ijk', wx, wy, wz), 2.0), 1e-14)
    r, wr = along(0.0, 0.3)
    radius, height = np.meshgrid(r, z, indexing='ij')
    points, masses = round_about(radius, height, np.outer(wr * r, wz))
    assert theory.cylinder(2.0, 0.3, 0.6) == near(moments_of(points, masses, 2.0), 1e-14)
    # an ellipsoid is a sphere with its axes stretched: second moments of the unit ball are 1/5
    # along each
    second = 2.0 / 5.0 * np.array([0.1, 0.2, 0.3]) ** 2
    assert theory.ellipsoid(2.0, 0.1, 0.2, 0.3) == near(second.sum() - second, 1e-14)


@pytest.mark.parametrize(('shape', 'expected'), [
    ({'rod': {'length': 1.4}}, theory.rod_about_center(2.0, 1.4)),
    ({'lamina': {'width': 0.3, 'height': 0.2}},
     theory.lamina(2.0 * 0.04 / 12.0, 2.0 * 0.09 / 12.0)),
    ({'hoop': {'radius': 0.3}}, theory.hoop(2.0, 0.3)),
    ({'disk': {'radius': 0.3}}, theory.disk(2.0, 0.3)),
    ({'spherical_shell': {'radius': 0.3}}, theory.spherical_shell(2.0, 0.3)),
    ({'solid_sphere': {'radius': 0.3}}, theory.solid_sphere(2.0, 0.3)),
    ({'box': {'size': [0.2, 0.4, 0.6]}}, theory.box(2.0, 0.2, 0.4, 0.6)),
    ({'cylinder': {'radius': 0.3, 'length': 0.6}}, theory.cylinder(2.0, 0.3, 0.6)),
    ({'ellipsoid': {'semi_axes': [0.1, 0.2, 0.3]}}, theory.ellipsoid(2.0, 0.1, 0.2, 0.3)),
], ids=lambda value: next(iter(value)) if isinstance(value, dict) else '')
def test_bodies_have_these_moments(shape, expected):
    (name, dimensions), = shape.items()
    assert bodies.of_shape(name, 2.0, dimensions).about_center.moments == near(
        tuple(expected), 1e-15)


def test_a_rod_moved_to_its_end():
    body = bodies.of_shape('rod', 2.0, {'length': 1.4}, center_of_mass=[0.0, 0.0, 0.7])
    assert body.about_origin.moments == near(tuple(theory.rod_about_end(2.0, 1.4)), 1e-15)
