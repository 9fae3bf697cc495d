# SPDX-License-Identifier: Apache-2.0
"""Fall with drag in closed form, beside Kummer's function with 40 digits."""

import mpmath
import pytest
from near import near

from rigid_body_sim.integrators.equations.falling import SMALL, fallen, phi

EPS = 2.0 ** -53


def exactly(z):
    """Return e^(-z), phi1(z), phi2(z): Kummer's function, phi_k(z) = 1F1(1, k + 1, -z)/k!."""
    with mpmath.workdps(40):
        return (mpmath.exp(-mpmath.mpf(z)), mpmath.hyp1f1(1, 2, -mpmath.mpf(z)),
                mpmath.hyp1f1(1, 3, -mpmath.mpf(z)) / 2)


@pytest.mark.parametrize(
    'z', [0.0, 1e-300, 1e-16, 1e-8, 0.01, 0.5, SMALL, SMALL * (1.0 + 2.0 * EPS), 3.0, 40.0, 700.0])
def test_functions_of_the_decay_are_right_to_rounding(z):
    # measured over 4000 values from 1e-12 to 300: 1.9, 1.7, 2.9
    for found, true in zip(phi(z), exactly(z), strict=True):
        assert abs(found - true) <= 4.0 * EPS * true


def test_fall_beyond_what_is_left_of_its_speed_goes_on_at_the_final_one():
    # c t/M = 1e4: v = a M/c, x = v (t - M/c) + v0 M/c
    (x, y, z), velocity = fallen((1.0, 2.0, 3.0), (5.0, 0.0, 0.0), (0.0, 0.0, -9.81), 10.0, 1e3)
    assert velocity == (0.0, 0.0, near(-0.981, 4.0 * EPS))
    assert (x, y) == (1.5, 2.0)
    assert z == near(3.0 - 0.981 * (1e3 - 0.1), 4.0 * EPS)


def test_fall_without_drag_is_a_parabola():
    place, velocity = fallen((1.0, 2.0, 3.0), (5.0, -1.0, 2.0), (0.0, 0.0, -8.0), 0.0, 0.5)
    assert (place, velocity) == ((3.5, 1.5, 3.0), (5.0, -1.0, -2.0))
