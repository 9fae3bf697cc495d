# SPDX-License-Identifier: Apache-2.0
"""Pairs of doubles beside exact fractions."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest

from rigid_body_sim.numerics import pairs

pytestmark = pytest.mark.without_numba

U2 = Fraction(1, 2 ** 106)
A, B, MINUS = (1.7, 3e-17), (0.3, -1.1e-17), (-2.3, 1.3e-16)


def exact(p):
    """Return the sum of a pair."""
    return Fraction(p[0]) + Fraction(p[1])


@pytest.mark.parametrize(('of', 'expected'), [
    (lambda: pairs.plus(A, B), exact(A) + exact(B)),
    (lambda: pairs.minus(A, MINUS), exact(A) - exact(MINUS)),
    (lambda: pairs.times(A, MINUS), exact(A) * exact(MINUS)),
    (lambda: pairs.over(A, MINUS), exact(A) / exact(MINUS)),
    (lambda: pairs.scaled(A, -0.25), -exact(A) / 4),
    (lambda: pairs.products(1.7, 0.3, 2.3, 0.7),
     Fraction(1.7) * Fraction(0.3) + Fraction(2.3) * Fraction(0.7)),
    (lambda: pairs.pair_of(Fraction(1, 3)), Fraction(1, 3)),
    (lambda: pairs.quotient(-22, 7), Fraction(-22, 7)),
    (lambda: pairs.quotient_of(0.1, 0.7), Fraction(0.1) / Fraction(0.7))])
def test_results_have_32_digits(of, expected):
    found = of()
    assert abs(exact(found) / expected - 1) <= 15 * U2
    assert abs(found[1]) <= 2.0 ** -53 * abs(found[0])


def test_a_root_has_32_digits_and_what_is_negative_or_divided_by_zero_is_zero():
    assert abs(exact(pairs.root_of(A)) ** 2 / exact(A) - 1) <= 8 * U2
    assert pairs.over(A, (0.0, 0.0)) == (0.0, 0.0)
    assert pairs.not_negative(A) == A and pairs.not_negative(B) == B
    assert pairs.not_negative(MINUS) == pairs.not_negative((0.0, -1e-300)) == (0.0, 0.0)


def test_a_radian_is_a_share_of_a_turn():
    with mpmath.workdps(40):
        high, low = map(mpmath.mpf, pairs.TURN)
        assert abs(2 * mpmath.pi * (high + low) - 1) <= 2.0 ** -106
    assert abs(low) <= 2.0 ** -53 * high


def test_a_pair_is_stored_and_read_high_part_first():
    stored = np.zeros(4)
    pairs.put(stored, 1, A)
    assert stored.tolist() == [0.0, *A, 0.0]
    assert pairs.pair_at(stored, 1) == A


@pytest.mark.parametrize('numbers', [[0.1, -3.0, 0.0, 1e20], [0.0], [2.5, 2.0 ** -60]])
def test_doubles_are_integers_over_a_common_one(numbers):
    integers, one = pairs.in_integers(numbers)
    assert [Fraction(number, one) for number in integers] == list(map(Fraction, numbers))
    assert all(isinstance(number, int) for number in integers)
