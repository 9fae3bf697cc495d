# SPDX-License-Identifier: Apache-2.0
"""Reversible pendulum: both suspensions, hand numbers, the period at finite amplitude, erratum.

The period is compared in 30 digits.
"""

import mpmath
import numpy as np
import pytest
from near import near

from rigid_body_sim.theory import kater_pendulum as theory

G, LENGTH, GYRATION = 9.81, 0.6, 0.35


def test_equal_frequencies_and_g():
    conjugate = theory.conjugate_length(LENGTH, GYRATION)
    Omega = theory.frequency_from_q(G, LENGTH, GYRATION)
    assert conjugate == near((0.36 + 0.1225) / 0.6, 1e-15)
    assert theory.frequency_from_p(G, LENGTH, GYRATION, conjugate) == near(Omega, 1e-15)
    assert theory.gravity_recovered(conjugate, Omega) == near(G, 1e-15)
    # any other second suspension swings differently
    assert abs(theory.frequency_from_p(G, LENGTH, GYRATION, 1.01 * conjugate) / Omega - 1.0) > 1e-3


def test_frequency_is_torque_over_moment():
    """Omega^2 = M g l/I_Q, I_Q by the parallel axis theorem."""
    M = 3.0
    moment = M * GYRATION**2 + M * LENGTH**2
    assert theory.moment_about_suspension(M, LENGTH, GYRATION) == near(moment, 1e-15)
    assert theory.frequency_from_q(G, LENGTH, GYRATION) == near(
        np.sqrt(M * G * LENGTH / moment), 1e-15)
    small = 1e-6
    assert theory.angular_acceleration(small, 3.0) == near(-9.0 * small, 1e-11)


@pytest.mark.parametrize('amplitude', [1e-3, 0.5, 2.0, 3.1])
def test_period_at_finite_amplitude(amplitude):
    """The period agrees with the integral of dphi/phi' from the energy.

    A sine is substituted for phi = amplitude so that nothing is singular.
    """
    with mpmath.workdps(30):
        k = mpmath.sin(mpmath.mpf(amplitude) / 2)
        quarter = (mpmath.quad(lambda u: 1 / mpmath.sqrt(1 - (k * mpmath.sin(u)) ** 2),
                               [0, mpmath.pi / 4, mpmath.pi / 2]) / 3)
    assert theory.period(3.0, amplitude) == near(float(4 * quarter), 1e-14)
    assert theory.gravity_bias(amplitude) == near(
        (2.0 * np.pi / 3.0 / theory.period(3.0, amplitude)) ** 2, 1e-14)


def test_bias_for_small_swings():
    """The measured g is too small by phi0^2/8: at 0.1 rad by 1.25e-3."""
    assert theory.period(3.0) == near(2.0 * np.pi / 3.0, 1e-15)
    deviations = [(1.0 - theory.gravity_bias(amplitude)) / amplitude**2
                  for amplitude in (0.2, 0.1, 0.05)]
    assert deviations[-1] == near(1.0 / 8.0, 1e-3)
    assert abs(deviations[1] - 0.125) == near(4.0 * abs(deviations[2] - 0.125), 0.01)


def test_erratum():
    """With a~^2 = l + a^2/l the moment I_Q = M a~^2 would be 1.7 times too large here."""
    assert theory.moment_about_suspension_as_written(1.0, LENGTH, GYRATION) == near(
        theory.moment_about_suspension(1.0, LENGTH, GYRATION) / LENGTH, 1e-15)
