# SPDX-License-Identifier: Apache-2.0
"""Upright top (notes, "Sleeping top").

Symbols are those of rigid_body_sim/theory/heavy_top.py; P_alpha = P_gamma, as the upright top
requires. V_eff = const + stiffness beta^2/2 + ...

Errata: none. Equality in the condition is stable too, because the quartic term of V_eff is
+M g l beta^4/8 there. Below it the top does not fall over but nods to `nodding_tilt` and comes
back; exactly upright it stays upright.
"""

import numpy as np


def effective_potential(beta, P_gamma, I1, Mgl):
    """Return V_eff without its constant, J.

    V_eff = P_gamma^2/(2 I1) (1 - cos(beta))^2/sin^2(beta) + M g l cos(beta).
    """
    return P_gamma**2 / (2.0 * I1) * np.tan(0.5 * beta) ** 2 + Mgl * np.cos(beta)


def stiffness(P_gamma, I1, Mgl):
    """Return V_eff''(0) = P_gamma^2/(4 I1) - M g l, J/rad^2.

    For small beta, beta'' = -stiffness beta/I1.
    """
    return P_gamma**2 / (4.0 * I1) - Mgl


def is_stable(P_gamma, I1, Mgl):
    """Return whether P_gamma^2/(4 I1) >= M g l."""
    return stiffness(P_gamma, I1, Mgl) >= 0.0


def threshold(I1, Mgl):
    """Return the least P_gamma of a stable upright top, 2 sqrt(I1 M g l), kg m^2/s."""
    return 2.0 * np.sqrt(I1 * Mgl)


def growth_rate(P_gamma, I1, Mgl):
    """Return the growth rate of a small beta below the threshold, 1/s; NaN above it.

    It is sqrt(M g l/I1 - P_gamma^2/(4 I1^2)).
    """
    return np.sqrt(Mgl / I1 - P_gamma**2 / (4.0 * I1**2))


def nodding_tilt(P_gamma, I1, Mgl):
    """Return how far the top nods below the threshold, rad.

    cos(beta_max) = P_gamma^2/(2 I1 M g l) - 1.
    """
    return 2.0 * np.arcsin(np.sqrt(np.clip(1.0 - P_gamma**2 / (4.0 * I1 * Mgl), 0.0, 1.0)))
