# SPDX-License-Identifier: Apache-2.0
"""Librations of a satellite: Euler's equations near rest in the orbit's frame; large pitch."""

import math

import numpy as np
import pytest
from near import near
from scipy.integrate import solve_ivp

from rigid_body_sim.theory import libration as theory

RATE, MOMENTS = 1.1e-3, np.array([1.2, 1.9, 2.5])


def acceleration(turn, turning):
    """Return the second derivative of a small rotation vector from the orbit's axes, rad/s^2.

    To first order omega = turning + n (e3 - turn x e3); the torque is 3 n^2 u x I u, u outwards.
    """
    outwards, _, normal = np.eye(3)
    u = outwards - np.cross(turn, outwards)
    omega = turning + RATE * (normal - np.cross(turn, normal))
    torque = 3.0 * RATE**2 * np.cross(u, MOMENTS * u)
    return (np.cross(MOMENTS * omega, omega) + torque) / MOMENTS + RATE * np.cross(turning, normal)


# measured: 1e-15
def test_small_librations_go_at_the_three_rates_of_the_linear_equations():
    columns = [np.concatenate([turning, acceleration(turn, turning)]).imag / 1e-30
               for turn, turning in (np.split(1e-30j * unit, 2) for unit in np.eye(6))]
    values = np.linalg.eigvals(np.transpose(columns))
    assert np.abs(values.real).max() < 1e-12 * RATE    # measured: 0
    pitch = 2.0 * math.pi / theory.pitch_period(0.0, RATE, *MOMENTS)
    slow, fast = theory.roll_yaw_rates(RATE, *MOMENTS)
    assert slow < fast
    assert sorted([slow, fast, pitch]) == near(np.sort(values.imag)[3:], rel=1e-12)


# measured: at most 4e-14 rad
@pytest.mark.parametrize('amplitude', [0.1, 0.8, 1.5])
def test_a_pitch_of_any_size_passes_through_zero_after_a_quarter_of_its_period(amplitude):
    k = 1.5 * (MOMENTS[1] - MOMENTS[0]) / MOMENTS[2]
    quarter = 0.25 * RATE * theory.pitch_period(amplitude, RATE, *MOMENTS)
    pitch = solve_ivp(lambda _, y: (y[1], -k * math.sin(2.0 * y[0])), (0.0, quarter),
                      (amplitude, 0.0), method='DOP853', rtol=1e-13, atol=1e-14).y[0, -1]
    assert abs(pitch) < 1e-12
