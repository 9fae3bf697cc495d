# SPDX-License-Identifier: Apache-2.0
"""Slim bodies made of parts that lie askew: their small moment is as right as the large ones."""

import math

import mpmath
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics.rotations import angle_between, multiply
from rigid_body_sim.scene import composites
from rigid_body_sim.scene.bodies import IDENTITY, of_shape
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

EPS = np.finfo(float).eps


def cylinders(source, orientation):
    """Return three cylinders in one line along the z axis of an orientation, as lists."""
    axis = Rotation.from_quat(orientation).as_matrix()[:, 2]
    return [(source.uniform(0.1, 3.0), 10.0 ** source.uniform(-4.0, -2.0),
             source.uniform(0.2, 1.0), (source.uniform(-1.0, 1.0) * axis).tolist(), orientation)
            for _ in range(3)]


def exact_moments(parts):
    """Return the principal moments about the centre of mass, rising, with 50 digits."""
    with mpmath.workdps(50):
        placed = []
        for M, radius, length, at, orientation in parts:
            across = M * (3 * mpmath.mpf(radius) ** 2 + mpmath.mpf(length) ** 2) / 12
            x, y, z, w = map(mpmath.mpf, orientation)
            # the axis, third column of the rotation matrix: I = across 1 + (I3 - across) e e^T
            e = mpmath.matrix([2 * (x * z + w * y), 2 * (y * z - w * x),
                               w * w + z * z - x * x - y * y]) / (x * x + y * y + z * z + w * w)
            own = across * mpmath.eye(3) + (mpmath.mpf(M) * radius * radius / 2 - across) * e * e.T
            placed.append((mpmath.mpf(M), mpmath.matrix(at), own))
        total = sum(M for M, _, _ in placed)
        center = sum((M * at for M, at, _ in placed), mpmath.zeros(3, 1)) / total
        tensor = mpmath.zeros(3)
        for M, at, own in placed:
            d = at - center
            tensor += own + M * ((d.T * d)[0] * mpmath.eye(3) - d * d.T)
        return sorted(mpmath.eigsy(tensor, eigvals_only=True))


@pytest.mark.parametrize('seed', range(8))
def test_the_moments_of_skew_cylinders_in_one_line_are_those_of_fifty_digits(seed):
    source = np.random.default_rng(seed)
    parts = cylinders(source, Rotation.random(random_state=seed).as_quat().tolist())
    inertia = composites.composite([
        (of_shape('cylinder', M, {'radius': radius, 'length': length}), at, orientation)
        for M, radius, length, at, orientation in parts]).about_center
    found, exact = sorted(zip(inertia.moments, inertia.lost, strict=True)), exact_moments(parts)
    # the moments of each part are doubles: measured 1e-16; sums of doubles left 1e-10
    for (moment, less), truth in zip(found, exact, strict=True):
        assert abs(mpmath.mpf(moment) + less - truth) <= 2 * EPS * truth
    # I1 - I2, over I3, turns the needle about its axis: measured 4e-28
    (small, _), (middle, d2), (large, d1) = found
    assert abs((large - middle) + (d1 - d2) - (exact[2] - exact[1])) <= 1e-20 * small


@pytest.mark.without_numba
def test_a_skew_composite_moves_as_the_one_along_its_axes():
    """The places of the parts are doubles, off the line by 1e-17 m; the motion does not feel it.

    Each number of the start by half an ulp turns the end by 1e-15.
    """
    q = Rotation.from_rotvec([0.4, -0.7, 0.2]).as_quat().tolist()
    x, y, z, w = q
    turned = Rotation.from_quat(q)

    def after(parts, orientation, omega):
        text = ', '.join(
            f'{{mass: {M}, shape: {{cylinder: {{radius: {radius}, length: 0.5}}}}, at: {at}, '
            f'orientation: {way}}}' for M, radius, at, way in parts)
        scene = parse_scene(f'scene: needle\nbody: {{parts: [{text}]}}\nconstraint: free\n'
                            f'effects: []\ninitial: {{orientation: {orientation}, '
                            f'angular_velocity: {omega}}}\n')
        return Simulation(scene).states([10.0])[0].orientation
    along = [(1.0, 1e-3, [0.0, 0.0, 0.3], list(IDENTITY)),
             (0.7, 2e-4, [0.0, 0.0, -0.4], list(IDENTITY))]
    skew = [(M, radius, turned.apply(at).tolist(), q) for M, radius, at, _ in along]
    omega = [0.3, 0.2, 5.0]
    straight = after(along, list(IDENTITY), omega)
    found = after(skew, [-x, -y, -z, w], turned.apply(omega).tolist())
    # 4e-15 measured; 8e-13 where the tensor was a sum of doubles
    assert angle_between(*multiply(*found, *q), *straight) <= 5e-14


def test_two_skew_rods_in_one_line_have_no_moment_about_it():
    q = [0.3, 0.1, -0.2, 0.9]
    rods = [(of_shape('rod', 0.2, {'length': 0.7}), (0.0, 0.0, 0.0), q)] * 2
    assert sorted(composites.composite(rods).about_center.moments)[0] == 0.0
    rod = '{mass: 0.2, shape: {rod: {length: 0.7}}, orientation: [0.3, 0.1, -0.2, 0.9]}'
    text = ('scene: rods\nbody: {parts: [%s, %s]}\nconstraint: free\neffects: []\n'
            'initial: {angular_velocity: %s}\n')
    parse_scene(text % (rod, rod, [0.5, 0.75, 0.54]))    # across the line
    with pytest.raises(BadInput, match='whose moment is zero'):
        parse_scene(text % (rod, rod, [0.7, 0.5, -0.4]))


def test_the_centre_of_mass_is_known_beyond_its_doubles():
    ball = of_shape('solid_sphere', 1.0, {'radius': 0.1})
    body = composites.composite([(ball, (0.1, 0.0, 0.0), IDENTITY),
                                 (ball, (0.2, 0.0, 0.0), IDENTITY),
                                 (ball, (0.4, 0.0, 0.0), IDENTITY)])
    with mpmath.workdps(40):
        exact = sum(map(mpmath.mpf, (0.1, 0.2, 0.4))) / 3
        assert abs(body.center_of_mass[0] + mpmath.mpf(body.center_lost[0]) - exact) < 1e-32
    assert body.center_of_mass[1:] == (0.0, 0.0)
    assert math.isclose(body.center_of_mass[0], 0.7 / 3, rel_tol=2 * EPS)


def test_what_is_small_beside_a_far_part_is_kept():
    ball = of_shape('solid_sphere', 1.0, {'radius': 0.1})
    for x in (0.0, 0.2):
        body = composites.composite([(ball, (0.1 + x, 0.0, 1e60), IDENTITY),
                                     (ball, (0.1 - x, 0.0, -1e60), IDENTITY)])
        assert body.center_of_mass == pytest.approx((0.1, 0.0, 0.0), rel=2 * EPS)
    across, along = 2.0 * 1e120, 2 * 0.01 * 0.4
    spins = composites.composite([(ball, (0.0, 0.0, 1e60), IDENTITY),
                                  (ball, (0.0, 0.0, -1e60), IDENTITY)]).about_center.moments
    assert spins == pytest.approx((across, across, along), rel=4 * EPS)
