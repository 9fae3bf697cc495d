# SPDX-License-Identifier: Apache-2.0
"""A disk that rolls without slip: its Legendre functions, and the thresholds of upright motion."""

import math

import mpmath
import numpy as np
import pytest
from near import near
from scipy.integrate import quad

from rigid_body_sim.theory.rolling_disk import (
    legendre_constants,
    precession_with_centre_at_rest,
    rate_of_upright_stability,
    speed_of_upright_stability,
    time_to_end_viscous,
)


@pytest.mark.parametrize(('theta', 's', 'w3'), [(1.2, 0.7, 3.0), (0.4, -2.0, 0.5)])
def test_the_constants_give_the_spin_and_how_it_goes_with_the_inclination(theta, s, w3):
    """w3 = c1 P(cos theta) + c2 P(-cos theta) and dw3/dtheta = kappa s, by mpmath's functions."""
    A, C, m, R = 0.3, 0.5, 2.0, 0.7
    c1, c2 = legendre_constants(theta, s, w3, A, C, m, R)
    kappa = m * R * R / (C + m * R * R)
    nu = mpmath.findroot(lambda nu: nu * (nu + 1.0) + kappa * C / A, -0.5 + 0.7j)

    def spin(angle):
        x = mpmath.cos(angle)
        return mpmath.re(c1 * mpmath.legenp(nu, 0, x) + c2 * mpmath.legenp(nu, 0, -x))
    # measured: 1.2e-16 and 6.7e-16
    assert float(spin(theta)) == near(w3, rel=1e-14)
    assert float(mpmath.diff(spin, theta)) == near(kappa * s, rel=1e-13)


def appell(theta, turns, s, w3, A, C, m, R, g):
    """Return the rates of theta, theta', s, w3 by Appell's equations."""
    cot = np.cos(theta) / np.sin(theta)
    return np.array([
        turns,
        (A * s * s * cot - (C + m * R * R) * w3 * s - m * g * R * np.cos(theta))
        / (A + m * R * R),
        -s * turns * cot + C / A * w3 * turns,
        m * R * R / (C + m * R * R) * s * turns])


def growth(W, w3, A, C, m, R, g):
    """Return the largest square of a rate at which a small tilt of an upright disk goes, 1/s^2.

    It is that of the Jacobian of Appell's equations at (pi/2, 0, W, w3).
    """
    step = 1e-30    # of the complex step: exact to rounding
    columns = [appell(*np.array([0.5 * np.pi, 0.0, W, w3]) + 1j * step * unit, A, C, m, R, g).imag
               / step for unit in np.eye(4)]
    squares = np.linalg.eigvals(np.transpose(columns)) ** 2
    return float(squares[np.abs(squares).argmax()].real)


@pytest.mark.parametrize('C', [0.49, 0.98, 0.7])    # disk, hoop, between them
@pytest.mark.parametrize('share', [1.1, 0.9])
def test_an_upright_disk_is_unstable_below_its_thresholds_and_stable_above(C, share):
    m, R, g = 2.0, 0.7, 9.81
    A = 0.5 * C
    w3 = share * speed_of_upright_stability(A, C, m, R, g) / R
    W = share * rate_of_upright_stability(A, m, R, g)
    expected = (1.0 - share * share) * m * g * R / (A + m * R * R)
    # measured: 5e-16
    assert growth(0.0, w3, A, C, m, R, g) == near(expected, rel=1e-13)
    assert growth(W, 0.0, A, C, m, R, g) == near(expected, rel=1e-13)


def test_the_thresholds_of_disk_and_hoop_are_those_that_are_known():
    m, R, g = 2.0, 0.7, 9.81
    for C, rolls, spins in ((0.5 * m * R * R, 1.0 / 3.0, 0.8), (m * R * R, 0.25, 2.0 / 3.0)):
        v = speed_of_upright_stability(0.5 * C, C, m, R, g)
        W = rate_of_upright_stability(0.5 * C, m, R, g)
        assert math.sqrt(rolls * g * R) == near(v, rel=1e-15)
        assert math.sqrt(spins * g / R) == near(W, rel=1e-15)


@pytest.mark.parametrize('theta', [0.2, 1.1])
def test_a_disk_whose_centre_rests_precesses_steadily_and_does_not_spin(theta):
    A, m, R, g = 0.3, 2.0, 0.7, 9.81
    W = precession_with_centre_at_rest(theta, A, m, R, g)
    weight = m * g * R * math.cos(theta) / (A + m * R * R)
    # measured: 2e-16 of the part of the weight
    assert np.abs(appell(theta, 0.0, W * math.sin(theta), 0.0, A, 0.5, m, R, g)).max() < (
        1e-14 * weight)


# measured: 4e-7, as the disk lies flat up to the square of 1e-3
def test_a_disk_slowed_at_its_contour_lies_down_in_the_time_its_energy_lasts():
    """E = m g R sin(a) + A (W sin(a))^2/2 is used up by the force c W R at the speed W R."""
    m, R, g, c, end = 2.0, 0.7, 9.81, 0.05, 1e-3
    A = 0.25 * m * R * R

    def precession(a):
        return precession_with_centre_at_rest(a, A, m, R, g)

    def energy(a):
        return m * g * R * math.sin(a) + 0.5 * A * (precession(a) * math.sin(a)) ** 2

    def slowness(a):
        slope = (energy(1.001 * a) - energy(0.999 * a)) / (0.002 * a)
        return slope / (c * (precession(a) * R) ** 2)
    time, _ = quad(slowness, 0.0, end)
    assert time_to_end_viscous(end, m, c) == near(time, rel=2e-6)
