# SPDX-License-Identifier: Apache-2.0
"""Free symmetric top (notes, "Symmetric top (no gravity)").

Symbols: I1 = I2 and I3 moments (kg m^2), e3 the symmetry axis, omega the angular velocity (rad/s)
with omega3 along e3, lambda its angle to e3 (rad, `lambda_`), Omega the rate at which omega goes
round e3 in the body (rad/s).

Errata: the notes divide by I3 in Omega; it is I1 (`precession_rate_as_written`).
"""

import numpy as np


def precession_rate(omega3, I1, I3):
    """Return Omega = omega3 (I3 - I1)/I1, rad/s."""
    return omega3 * (I3 - I1) / I1


def precession_rate_as_written(omega3, I1, I3):
    """Return the notes' omega3 (I3 - I1)/I3, rad/s."""
    return omega3 * (I3 - I1) / I3


def angular_velocity(t, omega, lambda_, I1, I3):
    """Return omega in body axes, shape (..., 3), rad/s.

    It is (omega sin(lambda) cos(Omega t), omega sin(lambda) sin(Omega t), omega cos(lambda)).
    """
    angle = precession_rate(omega * np.cos(lambda_), I1, I3) * t
    across = omega * np.sin(lambda_)
    return np.stack(np.broadcast_arrays(
        across * np.cos(angle), across * np.sin(angle), omega * np.cos(lambda_)), axis=-1)


def body_cone(omega_across, omega3):
    """Return the half-angle of the cone that omega describes about e3 in the body, rad.

    lambda = atan(omega_across/omega3).
    """
    return np.arctan2(omega_across, omega3)


def axis_cone(omega_across, omega3, I1, I3):
    """Return the half-angle of the cone that e3 describes about L in space, rad.

    It is atan(I1 omega_across/(I3 omega3)).
    """
    return np.arctan2(I1 * omega_across, I3 * omega3)


def space_cone(omega_across, omega3, I1, I3):
    """Return the half-angle of the cone that omega describes about L in space, rad.

    The body cone rolls on it without slipping. The angle is the difference of those of the other
    two cones: e3, omega and L lie in one plane.
    """
    return np.abs(body_cone(omega_across, omega3) - axis_cone(omega_across, omega3, I1, I3))


def precession_rate_in_space(L, I1):
    """Return the rate L/I1 at which e3 and omega go round L in space, rad/s."""
    return L / I1
