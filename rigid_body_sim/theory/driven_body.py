# SPDX-License-Identifier: Apache-2.0
"""Symmetric body driven by a constant torque about its axis (notes, "Euler's Equations").

Euler's equations with this Gamma have a closed form. Symbols: I1 = I2 and I3 moments (kg m^2),
Gamma3 torque about the symmetry axis (N m), omega angular velocity in body axes (rad/s); a name
that ends in _0 is the value at t = 0.
"""

import numpy as np


def axial_rate(t, omega3_0, Gamma3, I3):
    """Return omega3 = omega3(0) + Gamma3 t/I3, rad/s; it may pass through zero."""
    return omega3_0 + Gamma3 * t / I3


def phase(t, omega3_0, Gamma3, I1, I3):
    """Return the angle through which (omega1, omega2) has turned in body axes, rad.

    It is (I3 - I1)/I1 (omega3(0) t + Gamma3 t^2/(2 I3)).
    """
    return (I3 - I1) / I1 * (omega3_0 * t + 0.5 * Gamma3 * t**2 / I3)


def angular_velocity(t, omega_0, Gamma3, I1, I3):
    """Return omega in body axes, shape (..., 3), rad/s.

    omega1 + i omega2 = (omega1(0) + i omega2(0)) exp(i phase).
    """
    angle = phase(t, omega_0[2], Gamma3, I1, I3)
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([omega_0[0] * c - omega_0[1] * s,
                     omega_0[0] * s + omega_0[1] * c,
                     axial_rate(t, omega_0[2], Gamma3, I3)], axis=-1)


def spin_reversal_time(omega3_0, Gamma3, I3):
    """Return the time when omega3 passes through zero, -I3 omega3(0)/Gamma3, s."""
    return -I3 * omega3_0 / Gamma3
