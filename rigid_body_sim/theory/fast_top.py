# SPDX-License-Identifier: Apache-2.0
"""Limits of a fast top (notes, "Fast top").

Symbols are those of rigid_body_sim/theory/heavy_top.py. The small parameter is `slowness` =
I1 M g l/P_gamma^2; the notes' second one is P_alpha/P_gamma, the cosine of a nearly horizontal
tilt, and the formulas below are the leading terms in both.

Errata: the notes state the limit as P_gamma/P_alpha -> infinity, the precession as
I1 M g l/P_gamma, and the nutation as P_gamma^2/I1^2 (its square).
"""


def slowness(P_gamma, I1, Mgl):
    """Return I1 M g l/P_gamma^2, which must be small."""
    return I1 * Mgl / P_gamma**2


def epsilon(P_gamma, I1, Mgl):
    """Return epsilon = -I1 M g l/P_gamma^2 in cos(beta_0) = P_alpha/P_gamma + epsilon."""
    return -I1 * Mgl / P_gamma**2


def cos_equilibrium_tilt(P_alpha, P_gamma, I1, Mgl):
    """Return cos(beta_0) = P_alpha/P_gamma + epsilon."""
    return P_alpha / P_gamma + epsilon(P_gamma, I1, Mgl)


def precession_rate(P_gamma, Mgl):
    """Return the slow mean precession alpha' = M g l/P_gamma, rad/s."""
    return Mgl / P_gamma


def precession_rate_as_written(P_gamma, I1, Mgl):
    """Return the notes' I1 M g l/P_gamma."""
    return I1 * Mgl / P_gamma


def nutation_frequency(P_gamma, I1):
    """Return the fast nutation Omega = P_gamma/I1, rad/s."""
    return P_gamma / I1


def nutation_frequency_as_written(P_gamma, I1):
    """Return the notes' P_gamma^2/I1^2."""
    return P_gamma**2 / I1**2
