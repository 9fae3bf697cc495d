# SPDX-License-Identifier: Apache-2.0
"""Euler angles: the product of three turns, body rates from R^T R', energy and p_alpha.

Energy and p_alpha follow by differentiation.
"""

import mpmath
import numpy as np
import pytest
from near import near

from rigid_body_sim.numerics import rotations
from rigid_body_sim.theory import euler_angles as theory

ANGLES, RATES, MOMENTS = (0.7, 1.2, -0.4), (1.1, -0.6, 2.3), (1.0, 2.5, 3.1)


def about(axis, angle):
    c, s = mpmath.cos(angle), mpmath.sin(angle)
    return mpmath.matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]] if axis == 'z'
                         else [[c, 0, s], [0, 1, 0], [-s, 0, c]])


def matrix(alpha, beta, gamma):
    return about('z', alpha) * about('y', beta) * about('z', gamma)


def omega_by_differentiation(rates=RATES):
    """Return omega from the skew matrix R^T R', 30 digits."""
    def at(t):
        return matrix(*(angle + rate * t for angle, rate in zip(ANGLES, rates)))

    rate = mpmath.matrix(3, 3)
    for row in range(3):
        for column in range(3):
            rate[row, column] = mpmath.diff(
                lambda t, row=row, column=column: at(t)[row, column], 0)
    skew = at(0).T * rate
    return skew[2, 1], skew[0, 2], skew[1, 0]


def kinetic_energy(rates):
    """Return T for given Euler rates, by differentiation of R alone."""
    return (sum(moment * omega**2
                for moment, omega in zip(MOMENTS, omega_by_differentiation(rates))) / 2)


def test_rotation_matrix():
    expected = np.array(matrix(*ANGLES).tolist(), dtype=float)
    assert theory.rotation_matrix(*ANGLES) == pytest.approx(expected, abs=1e-15)
    of_the_simulator = np.array([rotations.rotate(*rotations.from_euler_zyz(*ANGLES), *unit)
                                 for unit in np.eye(3)]).T
    assert of_the_simulator == pytest.approx(expected, abs=1e-15)
    polar, azimuth = theory.axis_direction(ANGLES[0], ANGLES[1])
    direction = [np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)]
    assert theory.rotation_matrix(*ANGLES)[:, 2] == pytest.approx(direction, abs=1e-15)


def test_body_rates_and_back():
    with mpmath.workdps(30):
        expected = [float(omega) for omega in omega_by_differentiation()]
    omega = theory.body_rates(*RATES, ANGLES[1], ANGLES[2])
    assert omega == near(expected, 1e-14)
    assert theory.euler_rates(omega, ANGLES[1], ANGLES[2]) == near(RATES, 1e-14)


def test_energy_and_p_alpha():
    """T follows from R alone, and p_alpha = dT/dalpha' is the vertical component of L."""
    with mpmath.workdps(30):
        energy = float(kinetic_energy(RATES))
        momentum = float(mpmath.diff(lambda rate: kinetic_energy((rate, *RATES[1:])), RATES[0]))
    assert theory.kinetic_energy(*RATES, ANGLES[1], ANGLES[2], *MOMENTS) == near(energy, 1e-14)
    omega = theory.body_rates(*RATES, ANGLES[1], ANGLES[2])
    assert theory.p_alpha(omega, ANGLES[1], ANGLES[2], *MOMENTS) == near(momentum, 1e-13)
    vertical = (theory.rotation_matrix(*ANGLES) @ (MOMENTS * omega))[2]
    assert theory.p_alpha(omega, ANGLES[1], ANGLES[2], *MOMENTS) == near(vertical, 1e-14)


def test_symmetric_energy():
    for gamma in (0.0, 1.0, 4.0):
        general = theory.kinetic_energy(*RATES, ANGLES[1], gamma, 1.7, 1.7, 0.4)
        assert theory.kinetic_energy_symmetric(*RATES, ANGLES[1], 1.7, 0.4) == near(general, 1e-14)
