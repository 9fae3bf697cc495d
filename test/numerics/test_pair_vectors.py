# SPDX-License-Identifier: Apache-2.0
"""Vectors of pairs beside exact fractions.

Each operation errs by a few units of 2^-104 of its largest product.
"""

from fractions import Fraction

import pytest
from near import near

from rigid_body_sim.numerics import pair_vectors

Q = (0.1, 0.5, -0.2, 0.8)    # of norm 0.97
A, B = (0.3, -7.1, 4e5), (2.5e-3, 11.0, -0.7)
LOW = (1e-18, -2e-17, 3e-13)


def exact(vector):
    """Return the sums of pairs as Fractions."""
    return [Fraction(high) + Fraction(low) for high, low in vector]


def across(a, b):
    """Return a x b."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def turned(q, v):
    """Return a body vector in the world, by the formula of the quaternion, exactly."""
    *u, w = map(Fraction, q)
    square, along = sum(x * x for x in u), sum(x * y for x, y in zip(u, v, strict=True))
    side = across(u, v)
    return [((w * w - square) * v[k] + 2 * along * u[k] + 2 * w * side[k]) / (w * w + square)
            for k in range(3)]


def apart(found, wanted):
    """Return the largest difference as a share of the largest component."""
    size = max(map(abs, wanted))
    return max(float(abs(one - other) / size) for one, other in zip(found, wanted, strict=True))


def test_what_rounding_took_is_kept():
    pairs = pair_vectors.with_low(A, LOW)
    assert exact(pairs) == [Fraction(a) + Fraction(b) for a, b in zip(A, LOW, strict=True)]
    assert pair_vectors.less(pairs, A) == near(LOW, rel=1e-15)    # 0
    assert exact(pair_vectors.difference(A, B)) == [
        Fraction(a) - Fraction(b) for a, b in zip(A, B, strict=True)]


def test_sums_and_products_have_32_digits():
    a, b = pair_vectors.with_low(A, LOW), pair_vectors.with_low(B, LOW)
    x, y = exact(a), exact(b)
    assert apart(exact(pair_vectors.plus(a, b)),
                 [one + other for one, other in zip(x, y, strict=True)]) <= 1e-31    # 3e-34
    assert apart(exact(pair_vectors.cross(a, b)), across(x, y)) <= 1e-31    # 2e-33
    along = sum(one * other for one, other in zip(x, y, strict=True))
    assert apart(exact([pair_vectors.dot(a, b)]), [along]) <= 1e-31    # 2e-33


@pytest.mark.parametrize('back', [False, True])
def test_a_turn_by_a_quaternion_of_any_norm_has_32_digits(back):
    v = pair_vectors.with_low(A, LOW)
    turn = pair_vectors.turned_back if back else pair_vectors.turned
    *u, w = Q
    q = [-x for x in u] + [w] if back else Q
    assert apart(exact(turn(*Q, v)), turned(q, exact(v))) <= 1e-31    # 1.5e-32
