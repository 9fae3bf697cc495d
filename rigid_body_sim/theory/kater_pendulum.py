# SPDX-License-Identifier: Apache-2.0
"""Reversible pendulum (notes, "Reversible (Kater's) Pendulum").

Symbols: M mass (kg), l (`length`) distance from the suspension Q to the centre of mass (m), a
radius of gyration about the centre of mass (m, I_com = M a^2), l' = l_conjugate distance from Q to
the conjugate suspension P (m), g gravity (m/s^2), phi angle from the vertical (rad), Omega
small-swing angular frequency (rad/s).

Errata: the notes call a~^2 both l^2 + a^2 (in I_Q = M a~^2) and l + a^2/l (a length). Here
l' = l + a^2/l and a~^2 = l l' = l^2 + a^2.
"""

import numpy as np


def conjugate_length(length, a):
    """Return l' = l + a^2/l, the distance from Q to P, m.

    It is the length of the simple pendulum with the same period.
    """
    return length + a**2 / length


def moment_about_suspension(M, length, a):
    """Return I_Q = M (l^2 + a^2) = M l l', kg m^2."""
    return M * (length**2 + a**2)


def moment_about_suspension_as_written(M, length, a):
    """Return I_Q = M a~^2 with the notes' a~^2 = l + a^2/l, which is no moment of inertia."""
    return M * (length + a**2 / length)


def frequency_from_q(g, length, a):
    """Return Omega_Q = sqrt(g l/(a^2 + l^2)) = sqrt(g/l'), rad/s."""
    return np.sqrt(g * length / (a**2 + length**2))


def frequency_from_p(g, length, a, l_conjugate):
    """Return Omega_P = sqrt(g (l' - l)/(a^2 + (l' - l)^2)), rad/s.

    It equals Omega_Q for l' = l + a^2/l.
    """
    return np.sqrt(g * (l_conjugate - length) / (a**2 + (l_conjugate - length) ** 2))


def angular_acceleration(phi, Omega):
    """Return phi'' = -Omega^2 sin(phi), rad/s^2."""
    return -(Omega**2) * np.sin(phi)


def gravity_recovered(l_conjugate, Omega):
    """Return g = l' Omega^2, m/s^2.

    For small swings it does not depend on the place of the centre of mass.
    """
    return l_conjugate * Omega**2


def period(Omega, amplitude=0.0):
    """Return the period at an amplitude phi0 (rad), s.

    It is (2 pi/Omega) (2/pi) K(k) with k = sin(phi0/2).
    """
    from scipy.special import ellipk
    return 4.0 / Omega * ellipk(np.sin(0.5 * amplitude) ** 2)


def gravity_bias(amplitude):
    """Return the g found at an amplitude phi0 (rad) as if it were small, over the true g.

    It is ((2/pi) K(k))^-2 = 1 - phi0^2/8 + ...
    """
    from scipy.special import ellipk
    return (2.0 / np.pi * ellipk(np.sin(0.5 * amplitude) ** 2)) ** -2
