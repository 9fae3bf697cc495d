# SPDX-License-Identifier: Apache-2.0
"""Tops that rise while they slip: the tippe top, and an egg that spins on its side.

Symbols: m mass (kg), A moment across the axis of symmetry, C along it (kg m^2), theta from the
vertical to the axis (rad), R radius of a spherical foot (m), a = e R the distance (m) of the
centre of mass below its middle, h(theta) height of the centre of mass (m), r the vector (m) from
the centre of mass to the point of contact, g gravity (m/s^2), Omega the precession (rad/s).

Jellett's integral lambda = -(I omega) . r is constant under any friction on a spherical foot. Of
all motions with the same lambda the one of least energy at an inclination has omega parallel to r:
it does not slip, and E = lambda^2/(2 r.I r) + m g h. Friction can only lower the energy towards
the minimum of this. So a top leaves the rest on its heavy end if A/C > 1 - e and it spins fast
enough; it can end on its stem if A/C < 1 + e, otherwise it stops on the way.

While a fast top slips, A Omega theta' = F h and Omega h is constant: with F = mu m g it passes
from one inclination to another in the time J/(mu m g) times the integral of 1/h^2, J = A Omega h.

Sources: T. Ueda, K. Sasaki, S. Watanabe, SIAM J. Appl. Dyn. Syst. 4 (2005) 1159 (the groups);
H. K. Moffatt, Y. Shimomura, Nature 416 (2002) 385 (the time, for an egg).
"""

import math


def jellett(omega, gamma, A, C, R, a):
    """Return lambda (kg m^3/s) for omega (rad/s) and the upward direction, body axes."""
    across = omega[0] * gamma[0] + omega[1] * gamma[1]
    return A * R * across + C * omega[2] * (R * gamma[2] - a)


def least_energy(theta, jellett, A, C, m, g, R, a):
    """Return the least energy (J) of a top with a Jellett constant at an inclination."""
    arm = A * (R * math.sin(theta)) ** 2 + C * (R * math.cos(theta) - a) ** 2
    return 0.5 * jellett * jellett / arm + m * g * (R - a * math.cos(theta))


def inclination_of_least_energy(jellett, A, C, m, g, R, a):
    """Return the inclination (rad) at which a top with a Jellett constant has least energy."""
    from scipy.optimize import minimize_scalar

    def energy(theta):
        return least_energy(theta, jellett, A, C, m, g, R, a)

    looks = [math.pi * k / 256 for k in range(257)]
    place = min(range(257), key=lambda k: energy(looks[k]))
    if place in (0, 256):
        return looks[place]
    return float(minimize_scalar(energy, bounds=(looks[place - 1], looks[place + 1]),
                                 method='bounded', options={'xatol': 1e-10}).x)


def time_to_rise(J, push, height, begin, end):
    """Return the time (s) in which a fast top passes from one inclination to another.

    Parameters
    ----------
    J : float
        A Omega h, kg m^3/s.
    push : float
        The force of friction, N.
    height : callable
        Height of the centre of mass (m) at an inclination (rad).
    """
    from scipy.integrate import quad
    return J / push * abs(quad(lambda theta: height(theta) ** -2, begin, end)[0])
