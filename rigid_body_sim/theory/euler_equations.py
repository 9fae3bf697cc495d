# SPDX-License-Identifier: Apache-2.0
"""Euler's equations and the constants of torque-free motion.

They are those of the notes, "Euler's Equations" and "Torque-free Motion". Symbols: I =
(I1, I2, I3) = `moments`, principal moments (kg m^2), omega angular velocity and Gamma torque in
body axes, shape (..., 3) (rad/s, N m), L = I omega angular momentum (kg m^2/s).
"""

import numpy as np


def angular_acceleration(moments, omega, Gamma=(0.0, 0.0, 0.0)):
    """Return omega', rad/s^2.

    I1 omega1' = omega2 omega3 (I2 - I3) + Gamma1, and cyclically for axes 2 and 3.
    """
    I1, I2, I3 = moments
    o1, o2, o3 = np.moveaxis(np.asarray(omega), -1, 0)
    G1, G2, G3 = np.moveaxis(np.asarray(Gamma), -1, 0)
    return np.stack([(o2 * o3 * (I2 - I3) + G1) / I1,
                     (o3 * o1 * (I3 - I1) + G2) / I2,
                     (o1 * o2 * (I1 - I2) + G3) / I3], axis=-1)


def angular_momentum_rate_in_body(omega, L, torque):
    """Return (dL/dt)_body = torque - omega x L, N m."""
    return torque - np.cross(omega, L)


def kinetic_energy(moments, omega):
    """Return T = (I1 omega1^2 + I2 omega2^2 + I3 omega3^2)/2, J."""
    return 0.5 * np.square(omega) @ np.asarray(moments)


def angular_momentum_squared(moments, omega):
    """Return L^2 = I1^2 omega1^2 + I2^2 omega2^2 + I3^2 omega3^2, (kg m^2/s)^2."""
    return np.square(omega) @ np.square(moments)


def bounds_from_energy(moments, T):
    """Return the largest |omega_i| that the energy allows, sqrt(2 T/I_i), shape (3,), rad/s."""
    return np.sqrt(2.0 * T / np.asarray(moments))


def bounds_from_angular_momentum(moments, L_squared):
    """Return the largest |omega_i| that L^2 allows, L/I_i, shape (3,), rad/s."""
    return np.sqrt(L_squared) / np.asarray(moments)
