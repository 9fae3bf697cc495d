# SPDX-License-Identifier: Apache-2.0
"""Check of the moments of inertia (notes, "Some inertia tensors").

They are found by quadrature over the shape, and from the response of the body to a blow.
"""

import numpy as np

from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.study.scenes.quantity import Quantity
from rigid_body_sim.theory import inertia_tensors as theory

METHODS = ('quadrature', 'blow')
M, R, L = 1.7, 0.3, 0.8
A, B, C = 0.3, 0.4, 0.5
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(8)
TURN = np.arange(8) * 0.25 * np.pi


def check(method):
    """Yield the moments of each shape, measured by one of METHODS."""
    for name, shape, predicted, points in _shapes():
        measured = (_by_quadrature(*points) if method == 'quadrature'
                    else _by_a_blow(shape, predicted))
        yield Quantity(name, predicted, measured, 1e-14, 'kg m^2')
    end = _rod(0.0, L)
    measured = (_by_quadrature(*end) if method == 'quadrature'
                else _by_a_blow({'rod': {'length': L}}, theory.rod_about_end(M, L), L / 2.0))
    yield Quantity('rod about its end', theory.rod_about_end(M, L), measured, 1e-14, 'kg m^2')
    center = theory.rod_about_center(M, L)[0]
    yield Quantity('rod about its end, by the parallel axis',
                   theory.parallel_axis(center, M, L / 2.0), measured[0], 1e-14, 'kg m^2')


def _shapes():
    """Yield name, shape of a scene file, moments by the notes, and points with masses.

    The points stand for the shape in the quadrature.
    """
    lamina = _box(A, B, 0.0)
    own = _by_quadrature(*lamina)
    yield ('rod about its centre', {'rod': {'length': L}}, theory.rod_about_center(M, L),
           _rod(-L / 2.0, L / 2.0))
    yield ('lamina, I_zz = I_xx + I_yy', {'lamina': {'width': A, 'height': B}},
           theory.lamina(own[0], own[1]), lamina)
    yield ('hoop', {'hoop': {'radius': R}}, theory.hoop(M, R),
           _round(np.array([R]), np.zeros(1), np.ones(1)))
    r, w = 0.5 * R * (POINTS + 1.0), WEIGHTS
    yield 'disk', {'disk': {'radius': R}}, theory.disk(M, R), _round(r, np.zeros(8), r * w)
    z = R * POINTS
    # Archimedes: equal heights of a sphere have equal areas
    yield ('spherical shell', {'spherical_shell': {'radius': R}}, theory.spherical_shell(M, R),
           _round(np.sqrt(R**2 - z**2), z, WEIGHTS))
    yield ('solid sphere', {'solid_sphere': {'radius': R}}, theory.solid_sphere(M, R),
           _ellipsoid(R, R, R))
    yield 'box', {'box': {'size': [A, B, C]}}, theory.box(M, A, B, C), _box(A, B, C)
    rr, zz = (grid.ravel() for grid in np.meshgrid(r, 0.5 * L * POINTS))
    yield ('cylinder', {'cylinder': {'radius': R, 'length': L}}, theory.cylinder(M, R, L),
           _round(rr, zz, rr * np.outer(WEIGHTS, w).ravel()))
    yield ('ellipsoid', {'ellipsoid': {'semi_axes': [A, B, C]}}, theory.ellipsoid(M, A, B, C),
           _ellipsoid(A, B, C))


def _rod(low, high):
    z = 0.5 * (low + high) + 0.5 * (high - low) * POINTS
    return np.zeros(8), np.zeros(8), z, WEIGHTS


def _round(radius, z, weight):
    """Return points on rings about z, eight on each.

    They are exact for the second powers in the moments, which eight points sum without error.
    """
    turn, radius = np.meshgrid(TURN, radius)
    flat = np.ones(8)
    return (
        (radius * np.cos(turn)).ravel(),
        (radius * np.sin(turn)).ravel(),
        np.outer(z, flat).ravel(),
        np.outer(weight, flat).ravel(),
    )


def _box(x, y, z):
    px, py, pz = np.meshgrid(POINTS, POINTS, POINTS)
    wx, wy, wz = np.meshgrid(WEIGHTS, WEIGHTS, WEIGHTS)
    return 0.5 * x * px.ravel(), 0.5 * y * py.ravel(), 0.5 * z * pz.ravel(), (wx * wy * wz).ravel()


def _ellipsoid(a, b, c):
    r = 0.5 * (POINTS + 1.0)
    rr, height = (grid.ravel() for grid in np.meshgrid(r, POINTS))
    weight = (rr**2 * np.outer(WEIGHTS, WEIGHTS).ravel())
    x, y, z, w = _round(rr * np.sqrt(1.0 - height**2), rr * height, weight)
    return a * x, b * y, c * z, w


def _by_quadrature(x, y, z, weight):
    """Return the sums of mass times squared distance from the three axes."""
    dm = M * weight / weight.sum()
    return np.array([dm @ (y * y + z * z), dm @ (z * z + x * x), dm @ (x * x + y * y)])


def _by_a_blow(shape, predicted, to_end=0.0):
    """Return J/omega_i after an impulse of torque J about each axis.

    It is 0 for an axis without moment, which takes no blow.
    """
    center = f', center_of_mass: [0, 0, {to_end!r}]' if to_end else ''
    scene = parse_scene(f'scene: shape\nbody: {{mass: {M}, shape: {shape}{center}}}\n'
                        f'constraint: {"pivot" if to_end else "free"}\n'
                        'effects: []\ninitial: {}\n')
    moments = np.zeros(3)
    for axis in range(3):
        if predicted[axis]:
            simulation = Simulation(scene, 'exact')
            simulation.impulse(torque=np.eye(3)[axis])
            moments[axis] = 1.0 / simulation.state.angular_velocity[axis]
    return moments
