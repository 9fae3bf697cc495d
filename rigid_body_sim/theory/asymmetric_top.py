# SPDX-License-Identifier: Apache-2.0
"""Free asymmetric top near one of its axes (notes, "Asymmetric Top", "Intermediate Axis Theorem").

Symbols: rotation at omega0 (rad/s) about axis 3, which may have any of the three moments; I1, I2,
I3 moments (kg m^2); eta = (eta1, eta2, eta3) small deviations of omega (rad/s).

Errata: the notes carry I1 into the second and third linear equation; they are I2 and I3
(`linear_rates_as_written`). Omega^2 is right.
"""

import math

import numpy as np


def linear_rates(eta, omega0, I1, I2, I3):
    """Return eta' = (eta1', eta2', eta3'), rad/s^2.

    I1 eta1' = (I2 - I3) omega0 eta2, I2 eta2' = (I3 - I1) omega0 eta1, eta3' = 0.
    """
    return np.array([(I2 - I3) * omega0 * eta[1] / I1, (I3 - I1) * omega0 * eta[0] / I2, 0.0])


def linear_rates_as_written(eta, omega0, I1, I2, I3):
    """Return eta' as the notes write it, with I1 on the left of all three equations, rad/s^2."""
    return np.array([(I2 - I3) * omega0 * eta[1] / I1, (I3 - I1) * omega0 * eta[0] / I1, 0.0])


def frequency_squared(omega0, I1, I2, I3):
    """Return Omega^2 = omega0^2 (I3 - I1) (I3 - I2)/(I1 I2), (rad/s)^2.

    It is negative (the rotation is unstable) if I3 lies between I1 and I2.
    """
    return omega0**2 * (I3 - I1) * (I3 - I2) / (I1 * I2)


def frequency_squared_as_written(omega0, I1, I2, I3):
    """Return the Omega^2 that follows from the notes' linear equations, (rad/s)^2.

    Omega^2 = omega0^2 (I3 - I1) (I3 - I2)/I1^2.
    """
    return omega0**2 * (I3 - I1) * (I3 - I2) / I1**2


def frequency(omega0, I1, I2, I3):
    """Return the frequency Omega of small oscillations about a stable axis, rad/s.

    It is NaN about the intermediate axis.
    """
    return np.sqrt(frequency_squared(omega0, I1, I2, I3))


def growth_rate(omega0, I1, I2, I3):
    """Return the growth rate sqrt(-Omega^2) about the intermediate axis, 1/s.

    There eta1 and eta2 grow as e^(rate t). The rate is NaN about a stable axis.
    """
    return np.sqrt(-frequency_squared(omega0, I1, I2, I3))


def growing_ratio(I1, I2, I3):
    """Return eta2/eta1 of the growing solution about the intermediate axis (omega0 > 0)."""
    return np.sign(I2 - I3) * np.sqrt(I1 * (I3 - I1) / (I2 * (I2 - I3)))


def time_between_flips(moments, omega):
    """Return the time between two sign changes of omega2 of a free body with I1 < I2 < I3, s.

    The time is 2 K(k)/lambda, and two of them make a period (beyond the notes: Landau and
    Lifshitz, Mechanics, section 37). `omega` is in principal axes (rad/s), at any time. The
    discriminants are sums of terms of one sign, and the modulus enters as 1 - k^2. The result is
    None if there are no flips: the moments do not rise, or the rotation is steady.
    """
    I1, I2, I3 = moments
    if not 0.0 < I1 < I2 < I3:
        return None
    w1, w2, w3 = np.square(omega)
    above_least = I2 * (I2 - I1) * w2 + I3 * (I3 - I1) * w3  # L^2 - 2 E I1
    below_greatest = I1 * (I3 - I1) * w1 + I2 * (I3 - I2) * w2  # 2 E I3 - L^2
    middle = I3 * (I3 - I2) * w3 - I1 * (I2 - I1) * w1  # L^2 - 2 E I2
    around_third, around_first = (I3 - I2) * above_least, (I2 - I1) * below_greatest
    lead, side = (around_third, around_first) if middle > 0.0 else (around_first, around_third)
    complement = (I3 - I1) * abs(middle) / lead if lead > 0.0 else 0.0
    if not (side > 0.0 and complement > 0.0):
        return None
    from scipy.special import ellipkm1
    return 2.0 * ellipkm1(complement) / math.sqrt(lead / (I1 * I2 * I3))
