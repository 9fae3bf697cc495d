# SPDX-License-Identifier: Apache-2.0
"""A disk that rolls without slip, in Legendre functions."""

import mpmath
import pytest
from near import near

from rigid_body_sim.theory.rolling_disk import legendre_constants


@pytest.mark.parametrize(('theta', 's', 'w3'), [(1.2, 0.7, 3.0), (0.4, -2.0, 0.5)])
def test_the_constants_give_the_spin_and_how_it_goes_with_the_inclination(theta, s, w3):
    """w3 = c1 P(cos theta) + c2 P(-cos theta) and dw3/dtheta = kappa s, by mpmath's functions."""
    A, C, m, R = 0.3, 0.5, 2.0, 0.7
    c1, c2 = legendre_constants(theta, s, w3, A, C, m, R)
    kappa = m * R * R / (C + m * R * R)
    nu = mpmath.findroot(lambda nu: nu * (nu + 1.0) + kappa * C / A, -0.5 + 0.7j)

    def spin(angle):
        x = mpmath.cos(angle)
        return mpmath.re(c1 * mpmath.legenp(nu, 0, x) + c2 * mpmath.legenp(nu, 0, -x))
    # measured: 1.2e-16 and 6.7e-16
    assert float(spin(theta)) == near(w3, rel=1e-14)
    assert float(mpmath.diff(spin, theta)) == near(kappa * s, rel=1e-13)
