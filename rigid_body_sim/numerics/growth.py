# SPDX-License-Identifier: Apache-2.0
"""The rate at which what linear equations move grows in the long run.

Of y' = J y that is the largest real part of the eigenvalues of J. It is read off how the size of
e^(J t) grows from one doubling of t to the next, which takes products and sums alone, so that it
has the same bits everywhere. (Gelfand's formula for the spectral radius of e^J.)
"""

import math

import numpy as np

from rigid_body_sim.numerics.functions import log

TERMS = 12        # of the series of the exponential
SHORT = 0.125     # of 1/|J|, the time of that series: the next term is 2^-36/13!
DOUBLINGS = 30    # then sizes that grow like powers of t have no more share than 1e-7 of |J|


def fastest_growth(matrix):
    """Return the largest real part of the eigenvalues of a matrix (n, n), in its unit.

    It is within 1e-6 of the largest sum of a row's |entries|, and within rounding where the rate
    is single.
    """
    rows = np.abs(matrix)
    norm = max(math.fsum(row) for row in rows.tolist())
    if norm == 0.0:
        return 0.0
    time = SHORT / norm
    power = total = np.eye(len(matrix))
    for k in range(1, TERMS + 1):
        power = _product(power, matrix * (time / k))
        total = total + power
    exponent, size, before = 0.0, 0.0, 0.0
    for _ in range(DOUBLINGS):
        total, time, before = _product(total, total), 2.0 * time, size
        largest, taken = math.frexp(float(np.abs(total).max()))
        total, exponent = total * math.ldexp(1.0, -taken), 2.0 * exponent + taken
        size = exponent * log(2.0) + log(largest)    # ln |e^(J time)|
    return (size - before) / (0.5 * time)


def _product(a, b):
    """Return the product of two matrices, its sums from left to right."""
    total = a[:, :1] * b[:1]
    for k in range(1, len(b)):
        total = total + a[:, k:k + 1] * b[k:k + 1]
    return total
