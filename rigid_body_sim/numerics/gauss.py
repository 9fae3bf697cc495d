# SPDX-License-Identifier: Apache-2.0
"""Nodes and weights of Gauss-Legendre quadrature on [0, 1], correct to the last bit of a double.

Newton's method with 60 digits finds the roots of the Legendre polynomial. numpy's own rule finds
them as eigenvalues by LAPACK, whose last bits depend on the processor. Source: NIST DLMF 3.5(v).
"""

import math
from decimal import ROUND_HALF_EVEN, Context, Decimal, localcontext

CONTEXT = Context(prec=60, rounding=ROUND_HALF_EVEN)
NEWTON_STEPS = 7    # the first guess has two digits at least, and each step doubles them


def legendre(n):
    """Return the ascending coefficients (Decimal) of P_n(2 x - 1), Legendre on [0, 1]."""
    return [Decimal((-1) ** (n + k) * math.comb(n, k) * math.comb(n + k, k)) for k in range(n + 1)]


def value(polynomial, x):
    """Return the value of a polynomial (ascending coefficients) at x by Horner's scheme."""
    result = Decimal(0)
    for coefficient in reversed(polynomial):
        result = result * x + coefficient
    return result


def roots(n):
    """Return the n roots of P_n(2 x - 1), ascending, as Decimal in the current context."""
    polynomial = legendre(n)
    slope = [k * coefficient for k, coefficient in enumerate(polynomial)][1:]
    found = []
    for k in range(n, 0, -1):
        # Tricomi's first term (DLMF 18.16.14)
        x = (Decimal(math.cos(math.pi * (4 * k - 1) / (4 * n + 2))) + 1) / 2
        for _ in range(NEWTON_STEPS):
            x -= value(polynomial, x) / value(slope, x)
        found.append(x)
    return found


def rule(n):
    """Return the nodes and the weights of the rule with n nodes, as two lists of floats."""
    with localcontext(CONTEXT):
        slope = [k * coefficient for k, coefficient in enumerate(legendre(n))][1:]
        nodes = roots(n)
        weights = [1 / (x * (1 - x) * value(slope, x) ** 2) for x in nodes]
    return [float(x) for x in nodes], [float(w) for w in weights]
