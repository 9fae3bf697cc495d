# SPDX-License-Identifier: Apache-2.0
"""An ellipsoid that rolls without slip, by the laws of Newton and Euler with a force of contact.

In body axes: gamma the upward vertical, omega the angular velocity (rad/s), r from the centre of
mass to the point of contact (m). The velocity of the centre of mass is r x omega, and the force
F = m (a + g gamma) acts at the point of contact.
"""

import numpy as np


def arm(gamma, center, semi_axes):
    """Return r for an ellipsoid about the origin."""
    towards = np.square(semi_axes) * gamma
    return -towards / np.sqrt(gamma @ towards) - center


def rates(x, mass, tensor, center, semi_axes, g):
    """Return the rates of x = (gamma, omega)."""
    gamma, omega = x[:3], x[3:]
    turning = np.cross(gamma, omega)
    r = arm(gamma, center, semi_axes)
    # the derivative along `turning` by a complex step, exact to rounding
    moving = arm(gamma + 1e-30j * turning, center, semi_axes).imag / 1e-30
    known = np.cross(moving, omega) + np.cross(omega, np.cross(r, omega)) + g * gamma
    cross = np.array([np.cross(r, unit) for unit in np.eye(3)]).T
    return np.concatenate((turning, np.linalg.solve(
        tensor - mass * cross @ cross,
        mass * np.cross(r, known) - np.cross(omega, tensor @ omega))))
