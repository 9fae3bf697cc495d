# SPDX-License-Identifier: Apache-2.0
"""Exponents of doubles: taken off and put on exactly."""

import math

import pytest

from rigid_body_sim.numerics.bits import balanced, power_of_two

LOWER = 181 / 256


@pytest.mark.parametrize('x', [
    1.0, 0.5, 2.0, 3.0, LOWER, 2.0 * LOWER, math.nextafter(LOWER, 0.0), math.nextafter(LOWER, 1.0),
    math.nextafter(2.0 * LOWER, 0.0), 1e300, 3e-300, 2.0 ** -1022, 1.7976931348623157e308])
def test_a_number_is_a_power_of_two_times_one_near_1(x):
    m, e = balanced(x)
    assert LOWER <= m < 2.0 * LOWER
    assert math.ldexp(m, e) == x


@pytest.mark.parametrize('k', [-1022, -1, 0, 1, 52, 1023])
def test_powers_of_two_are_exact(k):
    assert power_of_two(k) == math.ldexp(1.0, k)
