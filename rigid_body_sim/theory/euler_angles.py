# SPDX-License-Identifier: Apache-2.0
"""Euler angles z-y-z (notes, "Euler angles for rigid body in inertial frame").

The body turns first by alpha about the vertical e3^0, then by beta about the new e2 (line of
nodes), then by gamma about the new e3: R = Rz(alpha) Ry(beta) Rz(gamma) takes body vectors to the
world. Symbols: omega angular velocity in body axes (rad/s), a name ending in _rate is a time
derivative (rad/s), I1, I2, I3 moments (kg m^2).
"""

import numpy as np


def rotation_matrix(alpha, beta, gamma):
    """Return R, shape (3, 3); its columns are e1, e2, e3 in the world."""
    ca, sa, cb, sb, cg, sg = (np.cos(alpha), np.sin(alpha), np.cos(beta), np.sin(beta),
                              np.cos(gamma), np.sin(gamma))
    return np.array([[ca * cb * cg - sa * sg, -ca * cb * sg - sa * cg, ca * sb],
                     [sa * cb * cg + ca * sg, -sa * cb * sg + ca * cg, sa * sb],
                     [-sb * cg, sb * sg, cb]])


def axis_direction(alpha, beta):
    """Return the polar and azimuthal angle of e3 in the world, (beta, alpha), rad."""
    return beta, alpha


def body_rates(alpha_rate, beta_rate, gamma_rate, beta, gamma):
    """Return omega in body axes, shape (3, ...), rad/s.

    omega1 = -alpha' sin(beta) cos(gamma) + beta' sin(gamma),
    omega2 = alpha' sin(beta) sin(gamma) + beta' cos(gamma),
    omega3 = alpha' cos(beta) + gamma'.
    """
    return np.array([
        -alpha_rate * np.sin(beta) * np.cos(gamma) + beta_rate * np.sin(gamma),
        alpha_rate * np.sin(beta) * np.sin(gamma) + beta_rate * np.cos(gamma),
        alpha_rate * np.cos(beta) + gamma_rate])


def euler_rates(omega, beta, gamma):
    """Return (alpha', beta', gamma') for the body rates, shape (3, ...), rad/s.

    They invert the formulas of :func:`body_rates`, which are singular at beta = 0 and pi.
    """
    alpha_rate = (omega[1] * np.sin(gamma) - omega[0] * np.cos(gamma)) / np.sin(beta)
    return np.array([alpha_rate,
                     omega[0] * np.sin(gamma) + omega[1] * np.cos(gamma),
                     omega[2] - alpha_rate * np.cos(beta)])


def kinetic_energy(alpha_rate, beta_rate, gamma_rate, beta, gamma, I1, I2, I3):
    """Return T = (I1 omega1^2 + I2 omega2^2 + I3 omega3^2)/2 from Euler rates, J."""
    omega = body_rates(alpha_rate, beta_rate, gamma_rate, beta, gamma)
    return 0.5 * (I1 * omega[0] ** 2 + I2 * omega[1] ** 2 + I3 * omega[2] ** 2)


def kinetic_energy_symmetric(alpha_rate, beta_rate, gamma_rate, beta, I1, I3):
    """Return the kinetic energy T of a body with I1 = I2, J.

    T = I1 (alpha'^2 sin^2(beta) + beta'^2)/2 + I3 (alpha' cos(beta) + gamma')^2/2.
    """
    return (0.5 * I1 * (alpha_rate**2 * np.sin(beta) ** 2 + beta_rate**2)
            + 0.5 * I3 * (alpha_rate * np.cos(beta) + gamma_rate) ** 2)


def p_alpha(omega, beta, gamma, I1, I2, I3):
    """Return p_alpha = dT/dalpha' of any body, the vertical component of L, kg m^2/s.

    It is constant without a potential, or with one that does not depend on alpha:
    p_alpha = -I1 omega1 sin(beta) cos(gamma) + I2 omega2 sin(beta) sin(gamma) + I3 omega3
    cos(beta).
    """
    return (-I1 * omega[0] * np.sin(beta) * np.cos(gamma)
            + I2 * omega[1] * np.sin(beta) * np.sin(gamma)
            + I3 * omega[2] * np.cos(beta))
