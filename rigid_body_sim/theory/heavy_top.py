# SPDX-License-Identifier: Apache-2.0
"""Symmetric top with a fixed point in a uniform field.

The formulas are those of the notes, "Symmetric Top" to "Small oscillations about equilibrium".

Symbols: I1 = I2 and I3 moments about the pivot (kg m^2), M mass (kg), g gravity (m/s^2), l
distance from the pivot to the centre of mass (m) along e3; `Mgl` their product (J). alpha, beta,
gamma Euler angles z-y-z (rad), beta from the upward vertical; P_alpha = L_z and P_gamma = L_3
their momenta (kg m^2/s), both constant. beta_0 the tilt of steady precession, eta = beta - beta_0.

Errata: P_x, P_y of the scan are P_alpha, P_gamma; the prefactor in I1 beta'' reads
cos(beta)/(I1 sin^3(beta)). Omega^2 holds at equilibrium only and is singular at beta_0 = 90
degrees (`curvature` holds everywhere).
"""

import math

import numpy as np


def potential_energy(beta, Mgl):
    """Return V = M g l cos(beta), J."""
    return Mgl * np.cos(beta)


def p_gamma(alpha_rate, gamma_rate, beta, I3):
    """Return p_gamma = I3 (alpha' cos(beta) + gamma') = I3 omega3, kg m^2/s."""
    return I3 * (alpha_rate * np.cos(beta) + gamma_rate)


def p_alpha(alpha_rate, beta, P_gamma, I1):
    """Return p_alpha = I1 alpha' sin^2(beta) + p_gamma cos(beta), kg m^2/s."""
    return I1 * alpha_rate * np.sin(beta) ** 2 + P_gamma * np.cos(beta)


def alpha_rate(beta, P_alpha, P_gamma, I1):
    """Return the precession alpha' = (p_alpha - p_gamma cos(beta))/(I1 sin^2(beta)), rad/s."""
    return (P_alpha - P_gamma * np.cos(beta)) / (I1 * np.sin(beta) ** 2)


def gamma_rate(beta, P_alpha, P_gamma, I1, I3):
    """Return the spin gamma', rad/s.

    gamma' = p_gamma (1/(I1 tan^2(beta)) + 1/I3) - p_alpha cos(beta)/(I1 sin^2(beta)).
    """
    omega3 = P_gamma / I3 if P_gamma else 0.0  # serves a body without moment about its axis too
    return (P_gamma / (I1 * np.tan(beta) ** 2) + omega3
            - np.cos(beta) / (I1 * np.sin(beta) ** 2) * P_alpha)


def beta_acceleration(beta, P_alpha, P_gamma, I1, Mgl):
    """Return beta'', rad/s^2.

    I1 beta'' = cos(beta)/(I1 sin^3(beta)) (p_alpha^2 - 2 p_alpha p_gamma cos(beta) + p_gamma^2)
    - p_alpha p_gamma/(I1 sin(beta)) + M g l sin(beta).
    """
    c, s = np.cos(beta), np.sin(beta)
    turning = c / (I1 * s**3) * (P_alpha**2 - 2.0 * P_alpha * P_gamma * c + P_gamma**2)
    return (turning - P_alpha * P_gamma / (I1 * s) + Mgl * s) / I1


def spin_energy(P_gamma, I3):
    """Return P_gamma^2/(2 I3), the constant in V_eff, J.

    It is 0 for a body without spin, even if its moment about the axis is zero.
    """
    return P_gamma**2 / (2.0 * I3) if P_gamma else 0.0


def effective_potential(beta, P_alpha, P_gamma, I1, I3, Mgl):
    """Return the effective potential V_eff, J.

    V_eff = (P_alpha - P_gamma cos(beta))^2/(2 I1 sin^2(beta)) + M g l cos(beta)
    + P_gamma^2/(2 I3).
    """
    centrifugal = (P_alpha - P_gamma * np.cos(beta)) ** 2 / (2.0 * I1 * np.sin(beta) ** 2)
    return centrifugal + Mgl * np.cos(beta) + spin_energy(P_gamma, I3)


def energy(beta, beta_rate, P_alpha, P_gamma, I1, I3, Mgl):
    """Return E = I1 beta'^2/2 + V_eff(beta), J."""
    return 0.5 * I1 * beta_rate**2 + effective_potential(beta, P_alpha, P_gamma, I1, I3, Mgl)


def tilt_of_least_centrifugal_potential(P_alpha, P_gamma):
    """Return the tilt where the first part of V_eff is least (zero), rad.

    cos(beta) = P_alpha/P_gamma, for |P_alpha| < |P_gamma|.
    """
    return np.arccos(P_alpha / P_gamma)


def slope(beta, P_alpha, P_gamma, I1, Mgl):
    """Return dV_eff/dbeta = -I1 beta'', J/rad."""
    return -I1 * beta_acceleration(beta, P_alpha, P_gamma, I1, Mgl)


def curvature(beta, P_alpha, P_gamma, I1, Mgl):
    """Return d^2 V_eff/dbeta^2 at any tilt, J/rad^2.

    With c = cos(beta) and s = sin(beta) it is
    ((P_alpha^2 + P_gamma^2) (1 + 2 c^2) - P_alpha P_gamma c (5 + c^2))/(I1 s^4) - M g l c.
    """
    c, s = np.cos(beta), np.sin(beta)
    return ((P_alpha**2 + P_gamma**2) * (1.0 + 2.0 * c**2)
            - P_alpha * P_gamma * c * (5.0 + c**2)) / (I1 * s**4) - Mgl * c


def curvature_at_equilibrium(beta_0, P_alpha, P_gamma, I1, Mgl):
    """Return the notes' V_eff'' at equilibrium, J/rad^2; it is singular at 90 degrees.

    V_eff'' = (P_alpha P_gamma - I1 M g l (4 - 3 sin^2(beta_0)))/(I1 cos(beta_0)).
    """
    return ((P_alpha * P_gamma - I1 * Mgl * (4.0 - 3.0 * np.sin(beta_0) ** 2))
            / (I1 * np.cos(beta_0)))


def equilibrium_residual(beta_0, P_alpha, P_gamma, I1, Mgl):
    """Return the residual of the notes' condition for beta_0, (kg m^2/s)^2.

    It is zero at equilibrium: (P_gamma^2 - 2 P_alpha P_gamma cos(beta_0) + P_alpha^2) cos(beta_0)
    - (P_alpha P_gamma - I1 M g l sin^2(beta_0)) sin^2(beta_0).
    """
    c, s = np.cos(beta_0), np.sin(beta_0)
    return ((P_gamma**2 - 2.0 * P_alpha * P_gamma * c + P_alpha**2) * c
            - (P_alpha * P_gamma - I1 * Mgl * s**2) * s**2)


def equilibrium_quartic(P_alpha, P_gamma, I1, Mgl):
    """Return the coefficients of the condition, a quartic in cos(beta_0), highest power first."""
    K = I1 * Mgl
    return np.array([K, 0.0, -(P_alpha * P_gamma + 2.0 * K), P_alpha**2 + P_gamma**2,
                     K - P_alpha * P_gamma])


def equilibrium_tilt(P_alpha, P_gamma, I1, Mgl):
    """Return beta_0, the tilt of steady precession where V_eff is least, rad.

    It lies between 0 and pi, for |P_alpha| != |P_gamma|. V_eff then rises without bound towards
    both poles and is convex in cos(beta), so the quartic has one root between -1 and 1. Bisection
    finds it and Newton's method polishes it.
    """
    low, high = -1.0, 1.0
    quartic = equilibrium_quartic(P_alpha, P_gamma, I1, Mgl)
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if np.polyval(quartic, middle) > 0.0 else (middle, high)
    beta = np.arccos(0.5 * (low + high))
    for _ in range(3):
        beta -= slope(beta, P_alpha, P_gamma, I1, Mgl) / curvature(beta, P_alpha, P_gamma, I1, Mgl)
    return beta


def nutation_frequency(beta_0, P_alpha, P_gamma, I1, Mgl):
    """Return Omega = sqrt(V_eff''/I1) of small oscillations of beta about equilibrium, rad/s."""
    return np.sqrt(curvature(beta_0, P_alpha, P_gamma, I1, Mgl) / I1)


def nutation_frequency_squared_of_notes(beta_0, P_alpha, P_gamma, I1, Mgl):
    """Return the notes' Omega^2, (rad/s)^2; it holds at equilibrium, except at 90 degrees.

    Omega^2 = (P_alpha P_gamma - I1 M g l (4 - 3 sin^2(beta_0)))/(I1^2 cos(beta_0)).
    """
    return curvature_at_equilibrium(beta_0, P_alpha, P_gamma, I1, Mgl) / I1


def precession_variation(beta_0, P_alpha, P_gamma, I1):
    """Return d alpha'/d beta at beta_0, (rad/s)/rad: alpha' = main precession + eta(t) times this.

    It is P_gamma/(I1 sin(beta_0))
    - 2 cos(beta_0) (P_alpha - P_gamma cos(beta_0))/(I1 sin^3(beta_0)).
    """
    c, s = np.cos(beta_0), np.sin(beta_0)
    return P_gamma / (I1 * s) - 2.0 * c * (P_alpha - P_gamma * c) / (I1 * s**3)


def steady_precession_rates(beta_0, omega3, I1, I3, Mgl):
    """Return the slow and the fast rate alpha' of steady precession at a tilt, rad/s.

    They solve I1 cos(beta) alpha'^2 - I3 omega3 alpha' + M g l = 0 (beta'' = 0 with P_alpha from
    alpha'), written without cancellation. Below the spin omega3^2 = 4 I1 M g l cos(beta)/I3^2
    there are none (NaN).
    """
    b = I3 * omega3
    large = 0.5 * (b + np.copysign(np.sqrt(b**2 - 4.0 * I1 * Mgl * np.cos(beta_0)), b))
    return Mgl / large, large / (I1 * np.cos(beta_0))


def turning_points(E, P_alpha, P_gamma, I1, I3, Mgl):
    """Return the least and the greatest tilt of the nutation, where V_eff(beta) = E, rad.

    With u = cos(beta): 2 I1 (E - P_gamma^2/(2 I3) - M g l u) (1 - u^2) = (P_alpha - P_gamma u)^2,
    a cubic of which two roots lie in [-1, 1].
    """
    K, left = 2.0 * I1 * Mgl, 2.0 * I1 * (E - spin_energy(P_gamma, I3))
    roots = np.roots([K, -(left + P_gamma**2), 2.0 * P_alpha * P_gamma - K, left - P_alpha**2])
    low, high = np.sort(np.sort(roots.real)[:2] if K > 0.0 else np.sort(roots.real)[-2:])
    return np.arccos(np.clip(high, -1.0, 1.0)), np.arccos(np.clip(low, -1.0, 1.0))


def time_between_turning_points(omega, up, I1, I3, Mgl):
    """Return half the period of the nutation, s, or None if there is none.

    `omega` and the upward vertical `up` are in body axes, at any time. Beyond the notes: with
    w = 1 - cos(beta) and K = 2 I1 M g l, (I1 w')^2 = K (w3 - w)(w - w1)(w - w2), or the like for
    another sign of K, so that the time is I1 pi/(sqrt(K) agm(sqrt(w2 - w3), sqrt(w1 - w3)));
    Whittaker and Watson, Modern Analysis, 22.7. The coefficients in w keep their digits near the
    upright top.
    """
    heights = _turning_heights(omega, up, I1, I3, Mgl)
    if heights is None:
        return None
    first, second, third = heights
    a, b = math.sqrt(abs(second - third)), math.sqrt(abs(first - third))
    if not b > 0.0:
        return None
    while abs(a - b) > 1e-15 * a:
        a, b = 0.5 * (a + b), math.sqrt(a * b)
    return I1 * math.pi / (math.sqrt(abs(2.0 * I1 * Mgl)) * 0.5 * (a + b))


def _turning_heights(omega, up, I1, I3, Mgl):
    """Return the roots w1, w2, w3 of the cubic of :func:`time_between_turning_points`, or None.

    The root that is no turning point comes last.
    """
    surplus, P_gamma, lead = _constants(omega, up, I1, I3, Mgl)
    K = 2.0 * I1 * Mgl
    cubic = [-K, 2.0 * K - surplus - P_gamma**2, 2.0 * (surplus - lead * P_gamma), -(lead**2)]
    roots = np.sort(np.roots(cubic).real) if K != 0.0 else []
    if len(roots) < 3:
        return None
    third, first, second = roots if K > 0.0 else roots[[2, 1, 0]]
    return first, second, third


def _constants(omega, up, I1, I3, Mgl):
    """Return 2 I1 (E - P_gamma^2/(2 I3) - M g l), P_gamma and P_alpha - P_gamma.

    They keep their digits near the upright top too.
    """
    across = up[0] ** 2 + up[1] ** 2
    w = across / (1.0 + up[2]) if up[2] > 0.0 else 1.0 - up[2]
    P_gamma = I3 * omega[2]
    surplus = I1**2 * (omega[0] ** 2 + omega[1] ** 2) - 2.0 * I1 * Mgl * w
    return surplus, P_gamma, I1 * (omega[0] * up[0] + omega[1] * up[1]) - P_gamma * w


def mean_precession(omega, up, I1, I3, Mgl):
    """Return the mean of alpha' over a nutation, rad/s, or None where it is not defined.

    `omega` and the upward vertical `up` are in body axes. Beyond the notes:
    alpha' = (P_alpha - P_gamma + P_gamma w)/(I1 w (2 - w)) with w = 1 - cos(beta) is averaged over
    time by w = (w1 + w2)/2 - (w2 - w1)/2 cos(theta), where dt is proportional to
    dtheta/sqrt(|w - w3|); the midpoint rule then converges geometrically. The result is None for
    a top that passes (nearly) through the vertical.
    """
    heights = _turning_heights(omega, up, I1, I3, Mgl)
    if heights is None:
        return None
    low, high, third = *sorted(heights[:2]), heights[2]
    if min(low, 2.0 - high) < 1e-4 * (high - low) or low <= 0.0 or high >= 2.0:
        return None
    _, P_gamma, lead = _constants(omega, up, I1, I3, Mgl)
    theta = (np.arange(4096) + 0.5) * np.pi / 4096
    w = 0.5 * (low + high) - 0.5 * (high - low) * np.cos(theta)
    weight = 1.0 / np.sqrt(np.abs(w - third))
    return float(np.sum(weight * (lead + P_gamma * w) / (I1 * w * (2.0 - w))) / np.sum(weight))
