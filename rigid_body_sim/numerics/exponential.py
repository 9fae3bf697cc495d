# SPDX-License-Identifier: Apache-2.0
"""exp(-x) from tables and a short polynomial instead of the C library.

Its bits are the same on every machine, and loops over it become vector code.
"""

import math
from decimal import ROUND_HALF_EVEN, Context, Decimal, localcontext

import numpy as np

from rigid_body_sim.compilation.jit import compiled_inline
from rigid_body_sim.compilation.memory import table
from rigid_body_sim.numerics.phase import nearest

PARTS = 46.16624130844683    # 32 / log 2
# log 2 / 32; the first has 22 trailing zeros, so that its multiples are exact
PART, PART_LOW = 0.02166084937925916, 1.3239129268154012e-11
# from BEYOND on the result is 0; LAST is a number whose entry in the tables is 0
BEYOND, LAST = 746.0, 34500.0
with localcontext(Context(prec=50, rounding=ROUND_HALF_EVEN)):
    FRACTIONS = table(np.array([float(Decimal(2) ** (Decimal(-j) / 32)) for j in range(32)]))
POWERS = table(np.array([math.ldexp(1.0, -k) for k in range(int(LAST) // 32 + 1)]))


@compiled_inline
def decay(x):
    """Return exp(-x) for x >= 0, to 1.1 ulp; 0 from 746 on.

    x = (32 k + j) log 2/32 + r with |r| <= log 2/64. The polynomial is a Chebyshev fit of
    (exp(-r) - 1 + r)/r^2 with an error of 2e-19.
    """
    # nan passes through, but not as an index of the tables
    n = nearest(PARTS * x) if 0.0 <= x < BEYOND else LAST
    r = 0.0 if x >= BEYOND else (x - n * PART) - n * PART_LOW
    place = int(n)
    top = FRACTIONS[place & 31]
    rest = r - r * r * (0.5 + r * (-0.16666666666581323 + r * (
        0.041666666666559986 + r * (-0.008333362430989848 + r * 0.0013888925260947679))))
    return (top - top * rest) * POWERS[place >> 5]
