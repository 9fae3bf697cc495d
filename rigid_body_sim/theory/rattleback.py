# SPDX-License-Identifier: Apache-2.0
"""Small rocking of a rattleback that spins slowly: frequencies and growth of both modes.

The equations of rolling without slip are linear in the tilts about the spin n about the vertical:
M p'' + n G p' + (K + n^2 L) p = 0. Here finite differences of the full equations give them.

Source: T. R. Kane and D. A. Levinson, Int. J. Non-Linear Mech. 17 (1982) 175 (the body and its
motion); A. Garcia and M. Hubbard, Proc. R. Soc. Lond. A 418 (1988) 165.
"""

import numpy as np

STEP = 1e-5    # step of the differences


def modes(body, surface, g, spin):
    """Return the eigenvalues (1/s) of the oscillating modes of small rocking at a spin (rad/s).

    Parameters
    ----------
    body : tuple
        Mass (kg), tensor about the centre of mass (kg m^2), centre of mass from the origin (m).
    surface : tuple of 3 floats
        Semi-axes of the ellipsoid about the origin, m; the third one is vertical.
    g : float
        Gravity, m/s^2.
    """
    x0 = np.array([0.0, 0.0, 1.0, 0.0, 0.0, spin])

    def rate(x):
        return _rate(body, surface, g, x)

    # gamma stays on the unit sphere and energy is kept: two eigenvalues are 0
    matrix = np.array([(8.0 * (rate(x0 + STEP * e) - rate(x0 - STEP * e))
                        - rate(x0 + 2.0 * STEP * e) + rate(x0 - 2.0 * STEP * e)) / (12.0 * STEP)
                       for e in np.eye(6)]).T
    values = np.linalg.eigvals(matrix)
    return sorted((value for value in values if value.imag > 1.0), key=lambda value: value.imag)


def _rate(body, surface, g, x):
    """Return the rates of gamma and omega of a body that rolls."""
    m, tensor, center = body
    gamma, omega = x[:3], x[3:]
    squares = np.asarray(surface) ** 2
    size = np.sqrt(gamma @ (squares * gamma))
    r = -squares * gamma / size - center
    turned = np.cross(gamma, omega)
    moved = -squares * turned / size + squares * gamma * (gamma @ (squares * turned)) / size**3
    about = tensor + m * (r @ r * np.eye(3) - np.outer(r, r))
    # M' = M x omega + m r' x (omega x r) + m g r x gamma for M about the point of contact
    M = tensor @ omega + m * np.cross(r, np.cross(omega, r))
    known = m * (np.cross(moved, np.cross(omega, r)) + np.cross(r, np.cross(omega, moved)))
    right = (np.cross(M, omega) + m * np.cross(moved, np.cross(omega, r))
             + m * g * np.cross(r, gamma) - known)
    return np.concatenate((turned, np.linalg.solve(about, right)))
