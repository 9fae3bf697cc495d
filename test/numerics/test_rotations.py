# SPDX-License-Identifier: Apache-2.0
"""Rotations: against SciPy, through the poles of the Euler angles, rounding of `normalised`."""

from fractions import Fraction

import numpy as np
import pytest
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.numerics.rotations import (
    angle_between,
    angles_between,
    from_euler_zyz,
    from_matrix,
    from_rotation_vector,
    matrix,
    multiply,
    normalised,
    rotate,
    rotate_back,
    to_euler_zyz,
    turn_to,
)

ULP = 2.0**-52


def excess(q):
    """Return |q|^2 - 1 in units of 2^-52, exactly summed."""
    return float(sum(Fraction(part) ** 2 for part in q) - 1) / ULP


@pytest.mark.parametrize('scale', [1.0, 1.0 + 3e-9, 1.0 - 1e-6, 0.5, 3e5])
def test_normalised_has_no_side(scale):
    """Norms are 1 to about an ulp, and as often too long as too short.

    Rounding of a sum near 1 alone would leave a mean of 0.6.
    """
    rng = np.random.default_rng(4)
    starts = rng.normal(size=(4000, 4))
    starts *= scale / np.linalg.norm(starts, axis=1)[:, None]
    found = np.array([excess(normalised(*start.tolist())) for start in starts])
    assert np.abs(found).max() < 2.0                                # measured 1.3
    # spread 0.37; measured 0.00 to 0.02
    assert abs(found.mean()) < 5.0 * 0.4 / np.sqrt(4000) + 0.02


def test_normalised_keeps_the_direction():
    q = normalised(0.3, -0.4, 1.2, 2.0)
    assert q == near(tuple(np.array([0.3, -0.4, 1.2, 2.0]) / np.sqrt(5.69)), 1e-15)
    assert normalised(0.0, 0.0, 0.0, -1.0) == (0.0, 0.0, 0.0, -1.0)


def random_quaternions(count):
    return Rotation.random(count, np.random.default_rng(5)).as_quat().tolist()


def test_products_and_rotated_vectors_are_those_of_scipy():
    for p, q in zip(random_quaternions(50), random_quaternions(60)[10:], strict=True):
        expected = (Rotation.from_quat(p) * Rotation.from_quat(q)).as_quat()
        found = np.array(multiply(*p, *q))
        assert min(np.abs(found - expected).max(), np.abs(found + expected).max()) < 4e-16
        vector = (0.3, -2.0, 1.1)
        assert rotate(*p, *vector) == pytest.approx(
            Rotation.from_quat(p).apply(vector), rel=0.0, abs=2e-15)
        assert rotate_back(*p, *rotate(*p, *vector)) == pytest.approx(vector, rel=0.0, abs=5e-15)


def exact_matrix(qx, qy, qz, qw):
    """Return the rotation matrix of a quaternion of any norm, without rounding."""
    square = qx * qx + qy * qy + qz * qz + qw * qw
    return [[(qw * qw + qx * qx - qy * qy - qz * qz) / square,
             2 * (qx * qy - qz * qw) / square, 2 * (qx * qz + qy * qw) / square],
            [2 * (qx * qy + qz * qw) / square,
             (qw * qw - qx * qx + qy * qy - qz * qz) / square, 2 * (qy * qz - qx * qw) / square],
            [2 * (qx * qz - qy * qw) / square, 2 * (qy * qz + qx * qw) / square,
             (qw * qw - qx * qx - qy * qy + qz * qz) / square]]


def test_matrices_are_exact_and_give_their_quaternions_back():
    """Half turns and the like too, where w or all but one of the components are 0.

    The norm of a unit quaternion in doubles is off by up to 1.5e-16, and its matrix by twice that,
    on top of the rounding of the matrix itself.
    """
    for given in [*random_quaternions(40), *np.eye(4).tolist(), [0.6, -0.8, 0.0, 0.0],
                  [0.0, 0.6, 0.8, 0.0], [-0.48, 0.6, 0.64, 0.0], [0.1, 0.7, -0.1, 0.7]]:
        q = normalised(*given)
        R = np.array(exact_matrix(*map(Fraction, q)), dtype=float)
        assert np.abs(np.array(matrix(*q)) - R).max() < 7e-16           # measured 5.6e-16
        assert np.abs(Rotation.from_quat(q).as_matrix() - R).max() < 2e-15
        found = from_matrix(R.tolist())
        assert found[3] >= 0.0
        assert min(np.abs(np.subtract(found, q)).max(), np.abs(np.add(found, q)).max()) < 6e-16


@pytest.mark.parametrize('to', [(0.48, -0.6, 0.64), (0.48, 0.6, -0.64), (0.6, 0.8, 0.0),
                                (0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (1e-9, 0.0, -1.0)])
def test_the_third_axis_is_turned_into_a_vector(to):
    q = turn_to(*to)
    assert sum(part * part for part in q) == near(1.0, rel=5e-16)
    assert rotate(*q, 0.0, 0.0, 1.0) == pytest.approx(to, rel=0.0, abs=5e-16)    # 1.1e-16


def test_angles_between_attitudes_are_those_of_scipy():
    p, q = np.array(random_quaternions(20)), np.array(random_quaternions(30)[10:])
    out = np.empty(20)
    angles_between(p, q, out)
    expected = (Rotation.from_quat(p).inv() * Rotation.from_quat(q)).magnitude()
    assert out == near(expected, rel=4e-15)    # measured 4e-16


def test_euler_angles_zyz():
    for angles in (
            (0.3, 1.1, -2.0), (-3.0, 3.1, 3.0), (2.0, 1e-9, 0.5), (1.0, np.pi - 1e-9, -0.5)):
        q = from_euler_zyz(*angles)
        assert angle_between(*q, *Rotation.from_euler('ZYZ', angles).as_quat()) < 1e-15
        assert angle_between(*q, *from_euler_zyz(*to_euler_zyz(*q))) < 1e-15
        assert to_euler_zyz(*q)[1] == near(angles[1], 1e-15)
    # at the poles only alpha + gamma or alpha - gamma is defined
    assert to_euler_zyz(*from_euler_zyz(0.4, 0.0, 0.3)) == near((0.7, 0.0, 0.0), 1e-15)
    assert to_euler_zyz(*from_euler_zyz(0.4, np.pi, 0.3))[1] == near(np.pi, 1e-15)


def test_small_angles_keep_their_digits():
    for angle in (1e-150, 1e-12, 1e-8, 0.9e-8, 1.0, 3.0):
        q = from_rotation_vector(0.0, 0.6 * angle, -0.8 * angle)
        assert angle_between(0.0, 0.0, 0.0, 1.0, *q) == near(angle, 4e-16)
        assert q[1] * -0.8 == near(q[2] * 0.6, 4e-16)
