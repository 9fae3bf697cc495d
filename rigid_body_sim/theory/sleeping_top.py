# SPDX-License-Identifier: Apache-2.0
"""Upright top (notes, "Sleeping top").

Symbols as in rigid_body_sim/theory/heavy_top.py; upright P_alpha = P_gamma is forced. V_eff =
const + stiffness beta^2/2 + ...

Errata: none; equality in the condition is stable too, for the quartic term of V_eff is +M g l
beta^4/8 there. Below it the top does not fall over but nods to `nodding_tilt` and comes back;
exactly upright it never leaves.
"""

import numpy as np


def effective_potential(beta, P_gamma, I1, Mgl):
    """Return V_eff = P_gamma^2/(2 I1) (1 - cos(beta))^2/sin^2(beta) + M g l cos(beta), less its constant, J."""
    return P_gamma**2 / (2.0 * I1) * np.tan(0.5 * beta) ** 2 + Mgl * np.cos(beta)


def stiffness(P_gamma, I1, Mgl):
    """Return V_eff''(0) = P_gamma^2/(4 I1) - M g l, J/rad^2: beta'' = -stiffness beta/I1 for small beta."""
    return P_gamma**2 / (4.0 * I1) - Mgl


def is_stable(P_gamma, I1, Mgl):
    """Return whether P_gamma^2/(4 I1) >= M g l."""
    return stiffness(P_gamma, I1, Mgl) >= 0.0


def threshold(I1, Mgl):
    """Return the least P_gamma of a stable upright top, 2 sqrt(I1 M g l), kg m^2/s."""
    return 2.0 * np.sqrt(I1 * Mgl)


def growth_rate(P_gamma, I1, Mgl):
    """Return the rate sqrt(M g l/I1 - P_gamma^2/(4 I1^2)) of beta below the threshold while it is small, 1/s; NaN above."""
    return np.sqrt(Mgl / I1 - P_gamma**2 / (4.0 * I1**2))


def nodding_tilt(P_gamma, I1, Mgl):
    """Return how far the top nods below the threshold, cos(beta_max) = P_gamma^2/(2 I1 M g l) - 1, rad."""
    return 2.0 * np.arcsin(np.sqrt(np.clip(1.0 - P_gamma**2 / (4.0 * I1 * Mgl), 0.0, 1.0)))
