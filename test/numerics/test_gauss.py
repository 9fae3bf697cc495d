# SPDX-License-Identifier: Apache-2.0
"""Gauss-Legendre quadrature: NumPy's rule, and polynomials that it integrates exactly."""

from decimal import Decimal, localcontext

import numpy as np
import pytest

from rigid_body_sim.numerics import gauss


@pytest.mark.parametrize('n', [1, 2, 5, 8, 16])
def test_the_rule_is_that_of_numpy_and_rounds_once(n):
    nodes, weights = map(np.array, gauss.rule(n))
    x, w = np.polynomial.legendre.leggauss(n)
    assert np.abs(nodes - (x + 1.0) / 2.0).max() < 1e-15    # measured: 1e-16
    assert np.abs(weights - w / 2.0).max() < 2e-15    # measured: 4e-16
    with localcontext(gauss.CONTEXT):
        roots = gauss.roots(n)
        polynomial = gauss.legendre(n)
        # P_n = 1 at the upper end and (-1)^n at the lower one
        assert gauss.value(polynomial, Decimal(1)) == 1
        assert gauss.value(polynomial, Decimal(0)) == (-1) ** n
        assert all(abs(gauss.value(polynomial, root)) < Decimal('1e-45') for root in roots)
    assert nodes.tolist() == [float(root) for root in roots] == sorted(nodes)
    for degree in range(2 * n):
        assert abs((weights * nodes ** degree).sum() - 1.0 / (degree + 1)) < 1e-15
