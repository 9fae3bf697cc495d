"""Free asymmetric top near one of its axes (notes, "Asymmetric Top", "Intermediate Axis Theorem").

Symbols: rotation at omega0 (rad/s) about axis 3, which may have any of the three moments; I1, I2, I3 moments (kg m^2); eta = (eta1,
eta2, eta3) small deviations of omega (rad/s).

Errata: the notes carry I1 into the second and third linear equation; they are I2 and I3 (`linear_rates_as_written`). Omega^2 is right.
"""

import numpy as np


def linear_rates(eta, omega0, I1, I2, I3):
    """Return eta' of I1 eta1' = (I2 - I3) omega0 eta2, I2 eta2' = (I3 - I1) omega0 eta1, eta3' = 0, rad/s^2."""
    return np.array([(I2 - I3) * omega0 * eta[1] / I1, (I3 - I1) * omega0 * eta[0] / I2, 0.0])


def linear_rates_as_written(eta, omega0, I1, I2, I3):
    """Return eta' of the notes, with I1 on the left of all three, rad/s^2."""
    return np.array([(I2 - I3) * omega0 * eta[1] / I1, (I3 - I1) * omega0 * eta[0] / I1, 0.0])


def frequency_squared(omega0, I1, I2, I3):
    """Return Omega^2 = omega0^2 (I3 - I1) (I3 - I2)/(I1 I2), (rad/s)^2; negative (unstable) if I3 lies between."""
    return omega0**2 * (I3 - I1) * (I3 - I2) / (I1 * I2)


def frequency_squared_as_written(omega0, I1, I2, I3):
    """Return the Omega^2 that follows from the notes' linear equations, omega0^2 (I3 - I1) (I3 - I2)/I1^2, (rad/s)^2."""
    return omega0**2 * (I3 - I1) * (I3 - I2) / I1**2


def frequency(omega0, I1, I2, I3):
    """Return the frequency Omega of small oscillations about a stable axis, rad/s; NaN about the intermediate one."""
    return np.sqrt(frequency_squared(omega0, I1, I2, I3))


def growth_rate(omega0, I1, I2, I3):
    """Return the rate sqrt(-Omega^2) at which eta1, eta2 ~ e^(rate t) run away from the intermediate axis, 1/s; NaN about a stable one."""
    return np.sqrt(-frequency_squared(omega0, I1, I2, I3))


def growing_ratio(I1, I2, I3):
    """Return eta2/eta1 of the growing solution about the intermediate axis (omega0 > 0)."""
    return np.sign(I2 - I3) * np.sqrt(I1 * (I3 - I1) / (I2 * (I2 - I3)))
