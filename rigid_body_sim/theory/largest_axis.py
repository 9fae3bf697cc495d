# SPDX-License-Identifier: Apache-2.0
"""Dissipation turns a free body to its largest axis.

Notes, "Is the Earth's rotation axis unstable?". Symbols: I = (I1, I2, I3) = `moments` (kg m^2),
m = I omega angular momentum in body axes, shape (..., 3), and L = |m| (kg m^2/s), T kinetic
energy (J). L is conserved while T falls and heat grows: T + heat = constant.
"""

import numpy as np


def energy(moments, m):
    """Return T = sum m_i^2/(2 I_i), J."""
    return 0.5 * np.square(m) @ (1.0 / np.asarray(moments))


def least_energy(moments, L):
    """Return the least T at an angular momentum L, L^2/(2 I_max), J.

    It belongs to rotation about the axis with the largest moment.
    """
    return 0.5 * L**2 / np.max(moments)


def greatest_energy(moments, L):
    """Return the greatest T at an angular momentum L, L^2/(2 I_min), J."""
    return 0.5 * L**2 / np.min(moments)


def excess_energy(moments, m):
    """Return T - L^2/(2 I_max) = sum m_i^2 (1/I_i - 1/I_max)/2, J.

    All terms are positive, so it is accurate however small it is.
    """
    return 0.5 * np.square(m) @ (1.0 / np.asarray(moments) - 1.0 / np.max(moments))
