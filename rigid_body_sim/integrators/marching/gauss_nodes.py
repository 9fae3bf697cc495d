# SPDX-License-Identifier: Apache-2.0
"""Gauss nodes and the polynomials through them, for eight stages.

They are formed once, with 60 digits, and correct to the last bit of a double.
"""

from decimal import Decimal, localcontext
from itertools import pairwise
from math import comb

import numpy as np

from rigid_body_sim.compilation.memory import table
from rigid_body_sim.numerics.gauss import CONTEXT, legendre, roots, value

STAGES = 8


def _through(nodes):
    """Yield the polynomials that are 1 at one node and 0 at the others."""
    for j, own in enumerate(nodes):
        polynomial = [Decimal(1)]
        for other in nodes[:j] + nodes[j + 1:]:
            gap = own - other
            polynomial = [
                (low - other * high) / gap
                for low, high in zip(
                    [Decimal(0), *polynomial], [*polynomial, Decimal(0)], strict=True
                )
            ]
        yield polynomial


def _integral(polynomial):
    return [Decimal(0), *(coefficient / (k + 1) for k, coefficient in enumerate(polynomial))]


def _slope(polynomial):
    return [k * coefficient for k, coefficient in enumerate(polynomial)][1:]


def _continued(polynomial):
    """Return the polynomial in x - 1: the same curve beyond the end of the interval."""
    return [
        sum(coefficient * comb(k, m) for k, coefficient in enumerate(polynomial) if k >= m)
        for m in range(len(polynomial))
    ]


def _in_legendre(polynomial):
    """Return the coefficients of Legendre's P_k(x), from those of the powers of x."""
    power, result = [Decimal(1)], [Decimal(0)] * len(polynomial)
    for coefficient in polynomial:
        result = [
            r + coefficient * p
            for r, p in zip(result, power + [Decimal(0)] * len(result), strict=False)
        ]
        # multiplied by x: x P_k = ((k + 1) P_(k+1) + k P_(k-1))/(2 k + 1)
        higher = [Decimal(0)] * (len(power) + 1)
        for k, p in enumerate(power):
            higher[k + 1] += p * (k + 1) / (2 * k + 1)
            if k:
                higher[k - 1] += p * k / (2 * k + 1)
        power = higher
    return result


def _halves(nodes):
    """Return the middles between neighbouring nodes, and between 0, 1 and the nodes next to them.

    The one in the middle of all is left out: there are as many as nodes.
    """
    ends = [Decimal(0), *nodes, Decimal(1)]
    middles = [(low + high) / 2 for low, high in pairwise(ends)]
    del middles[len(nodes) // 2]
    return middles


def _floats(rows):
    return np.array([[float(x) for x in row] for row in rows])


with localcontext(CONTEXT):
    _C = roots(STAGES)
    _BASIS = list(_through(_C))
    _INTEGRALS = [_integral(polynomial) for polynomial in _BASIS]
    _B = [value(integral, Decimal(1)) for integral in _INTEGRALS]
    C, B = np.array([float(c) for c in _C]), np.array([float(b) for b in _B])
    # A[i, j]: integral of the j-th basis polynomial from 0 to c_i
    A = _floats([[value(integral, c) for integral in _INTEGRALS] for c in _C])
    # SLOPES, the inverse of A: of a curve that begins at 0, its slopes at the nodes from its
    # values
    SLOPES = _floats([[value(_slope(polynomial), c)
                       for polynomial in list(_through([Decimal(0), *_C]))[1:]] for c in _C])
    # AHEAD[j, k]: from 1 to 1 + x the j-th basis polynomial adds sum_k AHEAD[j, k] x^(k + 1)
    AHEAD = table(_floats([_integral(_continued(polynomial))[1:] for polynomial in _BASIS]))
    # DENSE[j, k]: the integral from 0 to x of the polynomial through the nodes of the step before
    # (on [-1, 0]) and of this one (on [0, 1]) that is 1 at the j-th, as a sum over k of DENSE[j,
    # k] P_k(x)
    DENSE = table(_floats([_in_legendre(_integral(polynomial))
                           for polynomial in _through([c - 1 for c in _C] + _C)]))
    # BETWEEN[i, j]: the same as A up to points between the nodes
    _BETWEEN = _halves(_C)
    BETWEEN = _floats([[value(integral, c) for integral in _INTEGRALS] for c in _BETWEEN])
    # HIGHEST[k]: the coefficients of P_15 (k = 0) and P_14 of a function, from its values at the
    # nodes and then at the points between them
    _DEGREES = [_in_legendre(polynomial)
                for polynomial in _through([2 * c - 1 for c in _C + _BETWEEN])]
    HIGHEST = _floats([[coefficients[2 * STAGES - k] for coefficients in _DEGREES]
                       for k in (1, 2)]).reshape(2, 2, STAGES)
    # TAILS: rows that give the last four Legendre coefficients, the last one first, of a function
    # from its values at the nodes
    TAILS = _floats([[(2 * n + 1) * b * value(legendre(n), c) for b, c in zip(_B, _C, strict=True)]
                     for n in range(STAGES - 1, STAGES - 5, -1)])
