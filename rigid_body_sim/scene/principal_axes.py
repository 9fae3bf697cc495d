# SPDX-License-Identifier: Apache-2.0
"""Principal axes: the eigenvectors of a tensor, ordered and turned towards the body axes."""

import math
from decimal import ROUND_HALF_EVEN, Context, Decimal, localcontext
from fractions import Fraction
from itertools import permutations, product
from operator import add
from typing import NamedTuple

import numpy as np

from rigid_body_sim.numerics.vectors import cross, dot

PLANES = (0, 1), (0, 2), (1, 2)
DIGITS, SWEEPS = 40, 20    # digits kept, most sweeps; four suffice for most tensors
NEGLIGIBLE = Decimal('1e-70')    # square of an entry over the product of the diagonal ones
TRACE = 1e-36    # of the largest eigenvalue: what rounding leaves of one that is zero, at most
SLIM = 2.0 ** -10    # smallest moment of a slim body over the largest, at most
ULPS = 4.0 * np.finfo(float).eps    # a lamina has I3 = I1 + I2, up to the rounding of the input


class Lost(NamedTuple):
    """What rounding to doubles took from eigenvalues and from the entries of eigenvectors."""

    moments: list
    vectors: list


def eigenvectors(matrix):
    """Return the eigenvalues and eigenvectors of a symmetric 3 x 3 matrix, with 40 digits.

    The entries are doubles or Fractions. The results are rounded to doubles; a third one is the
    Lost of this.

    Jacobi's method keeps the small moments of graded tensors relatively accurate, which the QR
    iteration behind LAPACK does not (Demmel and Veselic, SIAM J. Matrix Anal. Appl. 13, 1992).
    Decimal numbers mean the same on every machine; an extended double of the processor does not.
    """
    with localcontext(Context(prec=DIGITS, rounding=ROUND_HALF_EVEN)):
        a = [[_decimal(entry) for entry in row] for row in matrix]
        vectors = [[Decimal(int(i == j)) for j in range(3)] for i in range(3)]    # in rows
        for _ in range(SWEEPS):
            turns = [_turn_away(a, vectors, i, j) for i, j in PLANES]
            if not any(turns):
                break
        rounded = [float(a[k][k]) for k in range(3)]
        lost = Lost([_lost(a[k][k]) for k in range(3)],
                    [[_lost(x) for x in vector] for vector in vectors])
        return rounded, [[float(x) for x in vector] for vector in vectors], lost


def without_traces(moments, vectors, lost):
    """Return what `eigenvectors` gives; moments that are zero but for its rounding are zero."""
    least = TRACE * max(moments)
    rods = [abs(moment) <= least for moment in moments]
    return ([0.0 if rod else moment for rod, moment in zip(rods, moments, strict=True)], vectors,
            Lost([0.0 if rod else less for rod, less in zip(rods, lost.moments, strict=True)],
                 lost.vectors))


def _decimal(entry):
    return (Decimal(entry.numerator) / Decimal(entry.denominator) if isinstance(entry, Fraction)
            else Decimal(entry))


def _lost(number):
    """Return what a decimal number is more than its double; 0 if that is not finite."""
    rounded = float(number)
    return float(number - Decimal(rounded)) if math.isfinite(rounded) else 0.0


def _turn_away(a, vectors, i, j):
    """Make a[i][j] zero by a rotation in the plane of two axes; return whether it was not.

    Source: Golub and Van Loan, Matrix Computations, section 8.5.2 (symmetric Schur decomposition).
    """
    if a[i][j] * a[i][j] <= NEGLIGIBLE * abs(a[i][i] * a[j][j]):
        a[i][j] = a[j][i] = Decimal(0)
        return False
    ratio = (a[j][j] - a[i][i]) / (2 * a[i][j])
    tangent = (1 if ratio >= 0 else -1) / (abs(ratio) + (1 + ratio * ratio).sqrt())
    cosine = 1 / (1 + tangent * tangent).sqrt()
    sine, k = tangent * cosine, 3 - i - j
    a[i][i], a[j][j] = a[i][i] - tangent * a[i][j], a[j][j] + tangent * a[i][j]
    a[i][j] = a[j][i] = Decimal(0)
    a[i][k], a[j][k] = cosine * a[i][k] - sine * a[j][k], sine * a[i][k] + cosine * a[j][k]
    a[k][i], a[k][j] = a[i][k], a[j][k]
    first, second = vectors[i], vectors[j]
    vectors[i] = [cosine * x - sine * y for x, y in zip(first, second, strict=True)]
    vectors[j] = [sine * x + cosine * y for x, y in zip(first, second, strict=True)]
    return True


def nearest_to_the_body(moments, vectors, lost):
    """Return the moments and the axes (right-handed) that lie nearest to the body axes.

    All orders and signs of the axes are compared. The Lost is returned in the order of the
    moments.
    """
    def turned(order, signs, vectors=vectors):
        return [[sign * entry for entry in vectors[k]]
                for k, sign in zip(order, signs, strict=True)]

    def trace(choice):
        x, y, z = turned(*choice)
        return x[0] + y[1] + z[2] if dot(cross(x, y), z) > 0.0 else -math.inf
    order, signs = max(product(permutations(range(3)), product((1.0, -1.0), repeat=3)), key=trace)
    return [moments[k] for k in order], turned(order, signs), Lost(
        [lost.moments[k] for k in order], turned(order, signs, lost.vectors))


def is_slim(moments):
    """Return whether the difference of two large moments may turn a body about its axis.

    A small moment that is but the rounding of the large ones is that of a rod.
    """
    return ULPS * max(moments) < min(moments) < SLIM * max(moments)


def nearest_where_equal(moments, axes, lost):
    """Make moments equal that agree to rounding, and turn their axes towards the body axes.

    Nothing is lost of such moments.

    The two large moments of a slim body are left as they are: their difference, over the small
    one, turns the body about its axis.
    """
    if is_slim(moments):
        return moments, axes, lost
    slack = ULPS * max(moments)
    equal = [(i, j) for i, j in PLANES if abs(moments[i] - moments[j]) <= slack]
    if len(equal) > 1:
        mean = (moments[0] + moments[1] + moments[2]) / 3.0
        return [mean] * 3, np.eye(3).tolist(), Lost([0.0] * 3, [[0.0] * 3] * 3)
    for i, j in equal:
        lost.moments[i] = lost.moments[j] = 0.0
        moments[i] = moments[j] = (moments[i] + moments[j]) / 2.0
        with localcontext(Context(prec=DIGITS, rounding=ROUND_HALF_EVEN)):
            first, second = (list(map(add, map(Decimal, axes[k]), map(Decimal, lost.vectors[k])))
                             for k in (i, j))
            sine, cosine = second[i] - first[j], first[i] + second[j]
            length = (sine * sine + cosine * cosine).sqrt()
            sine, cosine = sine / length, cosine / length
            for k, vector in (
                    (i, [cosine * x + sine * y for x, y in zip(first, second, strict=True)]),
                    (j, [cosine * y - sine * x for x, y in zip(first, second, strict=True)])):
                axes[k], lost.vectors[k] = list(map(float, vector)), list(map(_lost, vector))
    return moments, axes, lost
