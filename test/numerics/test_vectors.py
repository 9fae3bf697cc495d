# SPDX-License-Identifier: Apache-2.0
"""Vectors and matrices as tuples beside NumPy, of small whole numbers, which do not round."""

import numpy as np
import pytest

from rigid_body_sim.numerics import vectors

pytestmark = pytest.mark.without_numba

A, B = (2.0, -3.0, 5.0), (7.0, 11.0, -13.0)
MATRIX = (1.0, 2.0, 3.0), (-4.0, 5.0, 6.0), (7.0, -8.0, 10.0)


def test_products_and_sums_are_those_of_numpy():
    a, b, matrix = map(np.array, (A, B, MATRIX))
    assert vectors.dot(A, B) == a @ b
    for found, expected in (
            (vectors.cross(A, B), np.cross(a, b)), (vectors.plus(A, B), a + b),
            (vectors.minus(A, B), a - b), (vectors.scaled(3.0, A), 3.0 * a),
            (vectors.product(A, B), a * b), (vectors.transposed(MATRIX), matrix.T),
            (vectors.apply(MATRIX, A), matrix @ a),
            (vectors.across((0.0, 1.0, 0.0), A), (2.0, 0.0, 5.0))):
        assert np.array_equal(found, expected)
