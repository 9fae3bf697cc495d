# SPDX-License-Identifier: Apache-2.0
"""Librations of a rigid satellite on a circular orbit under the gravity gradient.

Body axes at rest in the frame of the orbit: 1 outwards (a turn about it is yaw), 2 along the track
(roll), 3 along the normal (pitch); n the rate of the orbit (rad/s), I1, I2, I3 the moments
(kg m^2), theta the pitch angle and theta0 its `amplitude` (rad).

    pitch            theta'' = -(3/2) n^2 ((I2 - I1)/I3) sin(2 theta), any amplitude
    roll and yaw     s^4 + (1 + 3 k1 + k1 k3) n^2 s^2 + 4 k1 k3 n^4 = 0,
                     k1 = (I3 - I1)/I2, k3 = (I3 - I2)/I1

They are stable where both roots s^2 are real and negative; I1 < I2 < I3 suffices (P. C. Hughes,
Spacecraft Attitude Dynamics, section 9.1).
"""

import math


def pitch_period(amplitude, n, I1, I2, I3):
    """Return the period of pitch, s: 4 K(sin^2 theta0)/(n sqrt(3 (I2 - I1)/I3))."""
    from scipy.special import ellipk
    return 4.0 * float(ellipk(math.sin(amplitude) ** 2)) / (n * math.sqrt(3.0 * (I2 - I1) / I3))


def roll_yaw_rates(n, I1, I2, I3):
    """Return both rates of roll and yaw, rad/s, the slow one first."""
    k1, k3 = (I3 - I1) / I2, (I3 - I2) / I1
    half, rest = 0.5 * (1.0 + 3.0 * k1 + k1 * k3), 4.0 * k1 * k3
    root = math.sqrt(half * half - rest)
    return n * math.sqrt(half - root), n * math.sqrt(half + root)
