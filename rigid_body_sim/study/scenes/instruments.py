# SPDX-License-Identifier: Apache-2.0
"""Instruments: directions, angles and rates of a body's axes, read from States.

Symbols are those of rigid_body_sim/theory.
"""

import numpy as np


def axes(states):
    """Return the rotation matrices of orientations, shape (n, 3, 3).

    Their columns are e1, e2, e3 in the world.
    """
    x, y, z, w = np.moveaxis(states.orientation, -1, 0)
    return np.moveaxis(np.array([
        [w * w + x * x - y * y - z * z, 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), w * w - x * x - y * y + z * z]]), -1, 0)


def omega(component):
    """Return the instrument that reads a component of omega in body axes, rad/s."""
    return lambda states: states.angular_velocity[:, component]


def omega_in_world(states):
    """Return omega in world axes, shape (n, 3), rad/s."""
    return np.einsum('nij,nj->ni', axes(states), states.angular_velocity)


def momentum_in_world(moments):
    """Return the instrument that reads L = R I omega, shape (n, 3), kg m^2/s."""
    return lambda states: np.einsum(
        'nij,nj->ni', axes(states), np.asarray(moments) * states.angular_velocity)


def alpha(states):
    """Return the azimuth of e3, rad, modulo 2 pi."""
    x, y, z, w = np.moveaxis(states.orientation, -1, 0)
    return np.arctan2(y * z - w * x, x * z + w * y)


def beta(states):
    """Return the angle from the upward vertical to e3, rad."""
    x, y, z, w = np.moveaxis(states.orientation, -1, 0)
    return 2.0 * np.arctan2(np.hypot(x, y), np.hypot(z, w))


def gamma(states):
    """Return the turn about e3 from the line of nodes, rad, modulo 2 pi."""
    x, y, z, w = np.moveaxis(states.orientation, -1, 0)
    return np.arctan2(y * z + w * x, w * y - x * z)


def beta_rate(states):
    """Return beta', rad/s, read from omega across e3: omega1 sin(gamma) + omega2 cos(gamma)."""
    angle = gamma(states)
    return (states.angular_velocity[:, 0] * np.sin(angle)
            + states.angular_velocity[:, 1] * np.cos(angle))


def alpha_rate(states):
    """Return alpha', rad/s: (omega2 sin(gamma) - omega1 cos(gamma))/sin(beta)."""
    angle = gamma(states)
    return ((states.angular_velocity[:, 1] * np.sin(angle)
             - states.angular_velocity[:, 0] * np.cos(angle)) / np.sin(beta(states)))


def angle_between(u, v):
    """Return the angle between vectors, rad, accurate for small ones too."""
    return np.arctan2(np.linalg.norm(np.cross(u, v), axis=-1), np.sum(u * v, axis=-1))
