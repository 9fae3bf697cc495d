# SPDX-License-Identifier: Apache-2.0
"""The roots of a top's cubic from what is conserved, to the digits of pairs."""

import pytest
from mpmath import mpf, sqrt, workdps

from rigid_body_sim.motions.lagrange_top.roots import largest_root, parts, shared

pytestmark = pytest.mark.without_numba


def pair(x):
    """Return a number as a pair."""
    return float(x), float(x - mpf(float(x)))


def number(p):
    """Return the number of a pair."""
    return mpf(p[0]) + mpf(p[1])


@pytest.mark.parametrize('roots', [
    ('3.7', '1.1', '0.3'), ('3.7', '1.1', '-2.3'), ('0.1', '-0.2', '-0.9'), ('5', '1.3', '1.3'),
    ('1e9', '1', '0.1'), ('7', '0', '0'), ('2', '-3', '-3'), ('1e-9', '-1', '-2')])
def test_the_largest_of_three_real_roots_has_the_digits_of_pairs(roots):
    with workdps(60):
        r1, r2, r3 = map(mpf, roots)
        b, c, d = -(r1 + r2 + r3), -(r1 * r2 + r2 * r3 + r3 * r1), -r1 * r2 * r3
        found = number(largest_root(*map(pair, (b, c, d))))
        # what rounding of the coefficients, to 2^-105, does to the root
        slope = (r1 - r2) * (r1 - r3)
        size = abs(r1) ** 3 + abs(b) * r1 * r1 + abs(c * r1) + abs(d)
        assert abs(found - r1) <= mpf(2) ** -100 * size / slope    # measured: 2^-104


@pytest.mark.parametrize('root', [0.0, 1.0, 4.0])
def test_three_equal_roots_are_found_at_once(root):
    """There the cubic has no slope to divide by."""
    coefficients = (-3.0 * root, 0.0), (-3.0 * root * root, 0.0), (-root ** 3, 0.0)
    assert largest_root(*coefficients) == (root, 0.0)


@pytest.mark.parametrize('difference', ['0.7', '-0.7', '1e9', '-1e9', '0', '1e-20'])
@pytest.mark.parametrize('product', ['0.3', '1e-12', '2e10'])
def test_two_numbers_follow_from_their_difference_and_their_product(difference, product):
    """The smaller one has as many digits as the larger."""
    with workdps(60):
        d, m = mpf(difference), mpf(product)
        more, less, total = map(number, parts(pair(d), pair(m)))
        root = sqrt(d * d / 4 + m)
        larger, smaller = root + abs(d) / 2, m / (root + abs(d) / 2)
        expected = (larger, smaller) if d >= 0 else (smaller, larger)
        for found, one in zip((more, less, total), (*expected, 2 * root), strict=True):
            assert abs(found / one - 1) < mpf(2) ** -99    # measured: 2^-104


@pytest.mark.parametrize(('first', 'second', 'weight', 'first_stays'), [
    ('3', '2', 1.0, True), ('2', '3', 1.0, False), ('2', '3', 2.0, True), ('3', '2', 0.5, False)])
def test_the_smaller_of_two_numbers_is_made_from_the_larger(first, second, weight, first_stays):
    """The product is known better than the smaller one, which here is told wrong."""
    with workdps(60):
        product = mpf('1.7')
        one, other = shared(pair(mpf(first)), pair(mpf(second)), pair(product), weight)
        assert number(one if first_stays else other) == mpf(first if first_stays else second)
        assert abs(number(one) * number(other) / product - 1) < mpf(2) ** -100
