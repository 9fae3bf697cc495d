# SPDX-License-Identifier: Apache-2.0
"""Euler's equations: the vector equation, constants of motion, and symmetric bodies.

The bodies are the driven one and the wobbling ones.
"""

import mpmath
import numpy as np
import pytest
from near import near

from rigid_body_sim.theory import chandler_wobble, driven_body, symmetric_top
from rigid_body_sim.theory import euler_equations as theory

MOMENTS, OMEGA = np.array([1.0, 2.5, 3.1]), np.array([0.7, -1.3, 2.2])


def derivative(function, t):
    """Return the derivative of a vector function of floats by the five-point rule."""
    h = 1e-3
    return ((8.0 * (function(t + h) - function(t - h))
             - (function(t + 2 * h) - function(t - 2 * h))) / (12.0 * h))


def test_components_of_the_vector_equation():
    torque = np.array([0.3, -0.2, 0.9])
    by_vectors = theory.angular_momentum_rate_in_body(OMEGA, MOMENTS * OMEGA, torque)
    assert MOMENTS * theory.angular_acceleration(MOMENTS, OMEGA, torque) == near(by_vectors, 1e-14)
    # by hand: 1.0 omega1' = (-1.3) (2.2) (2.5 - 3.1) + 0.3
    assert theory.angular_acceleration(MOMENTS, OMEGA, torque)[0] == near(2.016, 1e-14)


def test_energy_and_angular_momentum_are_conserved():
    rate = theory.angular_acceleration(MOMENTS, OMEGA)
    assert (MOMENTS * OMEGA) @ rate == pytest.approx(0.0, abs=1e-14)             # dT/dt
    assert (MOMENTS**2 * OMEGA) @ rate == pytest.approx(0.0, abs=1e-14)          # dL^2/dt over 2
    assert theory.kinetic_energy(MOMENTS, OMEGA) == near(
        0.5 * (0.49 + 2.5 * 1.69 + 3.1 * 4.84), 1e-15)
    assert theory.angular_momentum_squared(MOMENTS, OMEGA) == near(
        0.49 + 6.25 * 1.69 + 9.61 * 4.84, 1e-15)


def test_bounds_are_reached_and_never_passed():
    rng = np.random.default_rng(3)
    omegas = rng.normal(size=(1000, 3))
    for omega in (*omegas, np.array([4.0, 0.0, 0.0]), np.array([0.0, 4.0, 0.0]),
                  np.array([0.0, 0.0, 4.0])):
        energy = theory.bounds_from_energy(MOMENTS, theory.kinetic_energy(MOMENTS, omega))
        momentum = theory.bounds_from_angular_momentum(
            MOMENTS, theory.angular_momentum_squared(MOMENTS, omega))
        assert (np.abs(omega) <= np.minimum(energy, momentum) * (1.0 + 1e-15)).all()
        if np.count_nonzero(omega) == 1:
            assert energy[omega != 0.0] == near(4.0, 1e-15)
            assert momentum[omega != 0.0] == near(4.0, 1e-15)


def test_driven_symmetric_body_obeys_them():
    I1, I3, Gamma3 = 0.8, 1.3, 0.5
    start = np.array([0.4, -0.2, -1.1])
    for t in (0.0, 1.0, 4.0):
        omega = driven_body.angular_velocity(t, start, Gamma3, I1, I3)
        rate = derivative(lambda at: driven_body.angular_velocity(at, start, Gamma3, I1, I3), t)
        # the five-point rule is good to 1e-12 here
        assert theory.angular_acceleration(
            (I1, I1, I3), omega, (0.0, 0.0, Gamma3)) == pytest.approx(rate, abs=1e-11)
    turning = driven_body.spin_reversal_time(start[2], Gamma3, I3)
    assert turning == near(2.86, 1e-15)
    assert driven_body.axial_rate(turning, start[2], Gamma3, I3) == pytest.approx(0.0, abs=1e-15)
    # at the reversal the phase turns back
    assert driven_body.phase(2.0 * turning, start[2], Gamma3, I1, I3) == pytest.approx(
        0.0, abs=1e-15)


def test_symmetric_top_obeys_them_and_the_notes_rate_does_not():
    """A flattened body I = 2, 2, 2.6 has Omega = 0.3 omega3; as written it is 0.2308 omega3."""
    I1, I3 = 2.0, 2.6
    assert symmetric_top.angular_velocity(0.0, 2.0, 0.4, I1, I3) == near(
        [2.0 * np.sin(0.4), 0.0, 2.0 * np.cos(0.4)], 1e-15)
    omega = symmetric_top.angular_velocity(0.6, 2.0, 0.4, I1, I3)
    rate = derivative(lambda at: symmetric_top.angular_velocity(at, 2.0, 0.4, I1, I3), 0.6)
    assert theory.angular_acceleration((I1, I1, I3), omega) == pytest.approx(rate, abs=1e-11)
    assert symmetric_top.precession_rate(omega[2], I1, I3) == near(0.3 * omega[2], 1e-14)
    written = (symmetric_top.precession_rate_as_written(omega[2], I1, I3)
               * np.array([-omega[1], omega[0], 0.0]))
    assert np.abs(written - rate).max() > 0.05


@pytest.mark.parametrize(('I1', 'I3'), [(1.0, 1.3), (1.0, 0.2), (1.0, 1.9), (2.0, 2.6)])
def test_cones_roll_on_each_other(I1, I3):
    """The cones' angles follow from vectors, and they roll without slip.

    Omega sin(body cone) = (L/I1) sin(space cone).
    """
    across, omega3 = 0.9, 2.0
    omega, L, e3 = (np.array([across, 0.0, omega3]), np.array([I1 * across, 0.0, I3 * omega3]),
                    np.array([0.0, 0.0, 1.0]))

    def angle(u, v):
        return np.arctan2(np.linalg.norm(np.cross(u, v)), u @ v)

    assert symmetric_top.body_cone(across, omega3) == near(angle(omega, e3), 1e-14)
    assert symmetric_top.axis_cone(across, omega3, I1, I3) == near(angle(L, e3), 1e-14)
    assert symmetric_top.space_cone(across, omega3, I1, I3) == near(angle(L, omega), 1e-14)
    in_body = abs(symmetric_top.precession_rate(omega3, I1, I3)) * np.sin(angle(omega, e3))
    assert in_body == near(
        symmetric_top.precession_rate_in_space(np.linalg.norm(L), I1) * np.sin(angle(L, omega)),
        1e-13)


def test_of_several_times_the_components_are_last():
    times = np.array([0.5, 2.0])
    for one in (lambda t: symmetric_top.angular_velocity(t, 2.0, 0.4, 2.0, 2.6),
                lambda t: driven_body.angular_velocity(t, OMEGA, 0.5, 0.8, 1.3)):
        assert one(times) == near(np.array([one(t) for t in times]), 1e-14)    # measured: 0


def test_chandler_wobble():
    assert chandler_wobble.period_in_sidereal_days() == near(305.0, 1e-15)
    assert chandler_wobble.period_in_solar_days() == pytest.approx(304.2, abs=0.05)
    day = chandler_wobble.SIDEREAL_DAY
    I3 = 1.0 + chandler_wobble.ELLIPTICITY
    Omega = symmetric_top.precession_rate(2.0 * np.pi / day, 1.0, I3)
    assert 2.0 * np.pi / Omega / day == near(chandler_wobble.period_in_sidereal_days(), 1e-13)
    written = symmetric_top.precession_rate_as_written(2.0 * np.pi / day, 1.0, I3)
    assert (2.0 * np.pi / written / day
            == near(chandler_wobble.period_in_sidereal_days_as_written(), 1e-13))
    # for the Earth the two differ by 0.3 % only; both are far from the observed period
    assert chandler_wobble.period_in_sidereal_days_as_written() == near(306.0, 1e-15)
    assert (chandler_wobble.OBSERVED_PERIOD / chandler_wobble.period_in_solar_days()
            == pytest.approx(1.43, abs=0.005))
    assert chandler_wobble.wobble_angle(6.0, 6.356e6) == near(
        float(mpmath.mpf(6) / 6356000), 1e-15)
