# SPDX-License-Identifier: Apache-2.0
"""Tops that rise while they slip: Jellett's integral, the least energy it allows, and the time."""

import math

import numpy as np
import pytest
from near import near

from rigid_body_sim.theory import rising as theory

A, C, M, G, R, OFF = 0.8e-5, 0.9e-5, 0.02, 9.81, 0.015, 0.004


def arm(gamma):
    """Return the vector from the centre of mass to the point of contact of a spherical foot."""
    return np.array([0.0, 0.0, OFF]) - R * np.asarray(gamma)


def test_jellett_s_integral_is_the_angular_momentum_against_the_arm():
    omega, gamma = np.array([3.0, -7.0, 90.0]), np.array([0.48, 0.6, 0.64])
    expected = -(np.array([A, A, C]) * omega) @ arm(gamma)
    assert theory.jellett(omega, gamma, A, C, R, OFF) == near(expected, rel=1e-14)


@pytest.mark.parametrize('theta', [0.0, 0.7, 2.5])
def test_the_least_energy_is_reached_by_omega_along_the_arm(theta):
    """Any other omega of the same integral has more; the middle of the foot is at height R."""
    gamma, tensor = np.array([math.sin(theta), 0.0, math.cos(theta)]), np.array([A, A, C])
    r, jellett = arm(gamma), 2e-6
    omega = -jellett / (tensor @ (r * r)) * r
    assert theory.jellett(omega, gamma, A, C, R, OFF) == near(jellett, rel=1e-14)

    def energy(omega):
        return 0.5 * tensor @ np.square(omega) + M * G * (R - OFF * math.cos(theta))
    least = theory.least_energy(theta, jellett, A, C, M, G, R, OFF)
    assert least == near(energy(omega), rel=1e-14)
    for more in np.random.default_rng(4).normal(size=(20, 3)):
        across = more - (tensor * r) @ more / (tensor * r @ (tensor * r)) * tensor * r
        assert energy(omega + across) > least


@pytest.mark.parametrize(('jellett', 'expected'), [
    (0.0, 0.0),           # it lies on its heavy end
    (1e-4, math.pi)])     # a fast top stands on its stem, since A/C < 1 + e
def test_a_slow_top_rests_and_a_fast_one_stands_on_its_stem(jellett, expected):
    assert theory.inclination_of_least_energy(jellett, A, C, M, G, R, OFF) == expected


# measured: 4e-8; the least of a parabola is found to the root of an ulp
@pytest.mark.parametrize('x', [0.25, 0.245])
def test_between_them_the_energy_is_level_at_the_inclination_of_a_top(x):
    """E = lambda^2/(2 D) + m g h: its derivative by x = cos theta vanishes at the least energy."""
    D = A * R * R * (1.0 - x * x) + C * (R * x - OFF) ** 2
    slope = -2.0 * A * R * R * x + 2.0 * C * R * (R * x - OFF)
    jellett = math.sqrt(-2.0 * M * G * OFF * D * D / slope)
    found = theory.inclination_of_least_energy(jellett, A, C, M, G, R, OFF)
    assert abs(found - math.acos(x)) < 1e-6


@pytest.mark.parametrize(('begin', 'end'), [(0.0, 1.0), (1.0, 0.0)])
def test_the_time_to_rise_is_an_integral_over_the_inclination(begin, end):
    """With h = cos theta the integral of 1/h^2 is tan theta."""
    assert theory.time_to_rise(2.0, 3.0, math.cos, begin, end) == near(
        2.0 / 3.0 * math.tan(1.0), rel=1e-12)
