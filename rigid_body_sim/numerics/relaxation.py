# SPDX-License-Identifier: Apache-2.0
"""Functions of linear relaxation y' = a - r y, without cancellation at any rate and time.

With x = r t they are exp(-x) and

    f1(x) = (1 - exp(-x))/x = 1 - x/2! + x^2/3! - ...,      f1(0) = 1,
    f2(x) = (1 - f1(x))/x = 1/2! - x/3! + x^2/4! - ...,     f2(0) = 1/2,

so that y = y0 exp(-x) + a t f1(x), and its integral is y0 t f1(x) + a t^2 f2(x). In pairs of
doubles the series is summed for a small x, which is then doubled by sums of positive terms:

    f2(2x) = f2(x)/2 + f1(x)^2/4,       f1(2x) = f1(x) (1 + exp(-x))/2.
"""

import math
from fractions import Fraction

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.numerics.double_double import add, multiply
from rigid_body_sim.numerics.functions import exp, log
from rigid_body_sim.numerics.pairs import minus, over, pair_of, plus, scaled, times

PAIRS = 10          # terms of f1 and f2 that are summed in pairs; the rest are below 1e-16 of them
SMALL = 0.125       # the series is summed up to here
PAST = 80.0         # exp(-x) is below 1e-34 from here on
LEAST = -740.0      # below it exp(-x) overflows
ONE = 1.0, 0.0

C = [pair_of(Fraction((-1) ** n, math.factorial(n + 2))) for n in range(20)]
C0, C1, C2, C3, C4, C5, C6, C7, C8, C9 = C[:PAIRS]
REST = tuple(high for high, _ in C[PAIRS:])
R0, R1, R2, R3, R4, R5, R6, R7, R8, R9 = REST


@compiled_inline
def relaxation(x):
    """Return exp(-x), f1(x) and f2(x) as doubles, each to a few ulp; x of either sign."""
    if -1.0 < x < 1.0:
        rest = R0 + x * (R1 + x * (R2 + x * (R3 + x * (R4 + x * (R5 + x * (R6 + x * (
            R7 + x * (R8 + x * R9))))))))
        f2 = C0[0] + x * (C1[0] + x * (C2[0] + x * (C3[0] + x * (C4[0] + x * (C5[0] + x * (
            C6[0] + x * (C7[0] + x * (C8[0] + x * (C9[0] + x * rest)))))))))
        f1 = 1.0 - x * f2
        return 1.0 - x * f1 if x < 0.5 else exp(-x), f1, f2
    e = exp(-x)
    f1 = (1.0 - e) / x
    return e, f1, (1.0 - f1) / x


@compiled
def relaxation_pairs(x):
    """Return f1(x) and f2(x) as pairs, to 1e-29, for a pair x >= LEAST.

    Below LEAST both are infinite.
    """
    if x[0] < LEAST:
        return (math.inf, 0.0), (math.inf, 0.0)
    if x[0] > PAST:
        f1 = over(ONE, x)
        return f1, over(minus(ONE, f1), x)
    doublings = 0
    while abs(x[0]) > SMALL:
        x = scaled(x, 0.5)
        doublings += 1
    y = x[0]
    f2 = (R0 + y * (R1 + y * (R2 + y * (R3 + y * (R4 + y * (R5 + y * (R6 + y * R7)))))), 0.0)
    f2 = _step(C9, x, f2)
    f2 = _step(C8, x, f2)
    f2 = _step(C7, x, f2)
    f2 = _step(C6, x, f2)
    f2 = _step(C5, x, f2)
    f2 = _step(C4, x, f2)
    f2 = _step(C3, x, f2)
    f2 = _step(C2, x, f2)
    f2 = _step(C1, x, f2)
    f2 = _step(C0, x, f2)
    f1 = _less(ONE, times(x, f2))
    for _ in range(doublings):
        f2 = plus(scaled(f2, 0.5), scaled(times(f1, f1), 0.25))
        f1 = times(f1, _less(ONE, times(scaled(x, 0.5), f1)))
        x = scaled(x, 2.0)
    return f1, f2


@compiled_inline
def _step(c, x, f):
    return add(*c, *multiply(*x, *f))


@compiled_inline
def _less(a, b):
    """Return a - b to 3 u^2 of the difference."""
    return add(*a, -b[0], -b[1])


@compiled
def relaxed_time(r, y):
    """Return t with t f1(r t) = y, infinite if there is none: -log(1 - r y)/r."""
    x = r * y
    if x >= 1.0:
        return math.inf
    if abs(x) < 1e-5:
        # log(1 - x) by its series: the next term is below an ulp
        return y * (1.0 + x * (0.5 + x * (1.0 / 3.0 + x * 0.25)))
    rest = 1.0 - x
    return -(log(rest) + ((1.0 - rest) - x) / rest) / r
