# SPDX-License-Identifier: Apache-2.0
"""Balls that roll without slip: Routh's, with its centre of mass off the middle, and Chaplygin's.

Symbols: m mass (kg), A moment across the axis of symmetry and C along it (kg m^2), R radius (m), a
from the middle down to the centre of mass (m), theta from the vertical to the axis (rad), w3 the
part of omega along the axis and s the part across it in the vertical plane through the axis
(rad/s), r from the centre of mass to the point of contact (m), g gravity (m/s^2).

Routh's sphere has three constants: the energy, Routh's w3 sqrt(A C + m r.I r) and Jellett's
A R s sin(theta) + C w3 (R cos(theta) - a). So s and w3 are functions of theta, and theta(t) is one
quadrature. Chaplygin's sphere has its centre of mass in the middle and any moments: its energy is
constant, and so is M = I omega + m r x (omega x r) as a vector in the world.

Sources: C. G. Gray and B. G. Nickel, Am. J. Phys. 68 (2000) 821; A. V. Borisov, Y. N. Fedorov,
I. S. Mamaev, Regul. Chaotic Dyn. 13 (2008) 443.
"""

import math


def routh_constant(w3, theta, A, C, m, R, a):
    """Return w3 sqrt(A C + m r.I r), kg m^2/s."""
    arm = A * (R * math.sin(theta)) ** 2 + C * (R * math.cos(theta) - a) ** 2
    return w3 * math.sqrt(A * C + m * arm)


def swing(theta, s, w3, A, C, m, R, a, g):
    """Return the other turning point of a Routh sphere, and the time to it.

    More than eight arguments: the symbols of Routh's formulas.

    Returns
    -------
    other : float
        The other turning point, rad.
    time : float
        From one to the other, s.
    """
    from scipy.integrate import quad
    from scipy.optimize import brentq
    jellett = A * R * s * math.sin(theta) + C * w3 * (R * math.cos(theta) - a)
    routh = routh_constant(w3, theta, A, C, m, R, a)

    def parts(x):
        """Return twice the energy less its term in theta'^2, and the factor of theta'^2."""
        along, across = a - R * math.cos(x), R * math.sin(x)
        square = along * along + across * across
        w3 = routh / routh_constant(1.0, x, A, C, m, R, a)
        s = (jellett + C * w3 * along) / (A * across)
        still = (A * s * s + C * w3 * w3 + m * (
            (s * s + w3 * w3) * square - (w3 * along - s * across) ** 2)
            + 2.0 * m * g * (R - a * math.cos(x)))
        return still, A + m * square

    energy = parts(theta)[0]

    def left(x):
        return energy - parts(x)[0]

    side = 1.0 if left(theta + 1e-4) > 0.0 else -1.0
    far = theta + 1e-4 * side
    while left(far) > 0.0:
        far += 0.01 * side
    other = brentq(left, far - 0.01 * side, far, xtol=1e-15)
    middle, half = 0.5 * (theta + other), 0.5 * abs(other - theta)

    def share(angle):
        # theta = middle + half sin(angle) removes the square roots at both ends
        x = middle + half * math.sin(angle)
        speed = left(x) / parts(x)[1]
        return half * math.cos(angle) / math.sqrt(speed)

    edge = 0.5 * math.pi
    return other, quad(share, -edge, edge, epsabs=1e-12, epsrel=1e-12)[0]
