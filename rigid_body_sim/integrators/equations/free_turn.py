# SPDX-License-Identifier: Apache-2.0
"""The free rotation over one drift, as increments.

A closed form would give the new state, rounded to the size of the state and not of the change.

    omega1' = ((I2 - I3)/I1) omega2 omega3 and cyclically
    q(t) = q(0) Delta(t),    Delta' = Delta omega/2,    Delta(0) = 1

Both are power series about the start of a span h, of omega h and Delta in t/h, summed down to
round-off. With M the largest |omega_i h|, the coefficients of omega_i h are not above M^(k + 1),
for Euler's are between -1 and 1; so M = REACH needs fewer than TERMS terms, and a longer drift is
cut into spans. The sums begin with t/h, so that increments of omega and Delta - 1 have
only their own rounding error.

Kinetic energy is conserved: the change that the increments make, formed with 32 digits from omega
and what its sums have lost, is subtracted along the new omega. This corrects the rounding of the
increments, at most 1e-16 of them.
"""

import math

import numpy as np

from rigid_body_sim.compilation.jit import compiled, compiled_allocating
from rigid_body_sim.integrators.equations.euler import OMEGA, load_euler, load_moments
from rigid_body_sim.numerics.double_double import (
    add,
    add_double,
    multiply,
    multiply_double,
    two_sum,
)

W1, W2, W3, D1, D2, D3, D4 = range(7)    # rows of the series: of omega h, and of Delta
REACH = 0.25                   # largest M of a span
TERMS = 32
ROUNDING = 2.0 ** -60          # share of the largest term: smaller ones do not count
MOST_SPANS = 4096    # most spans of a drift, a thousand radians: kicks so rare mean nothing
LEAST = 1e-250                 # least I omega^2: below it the 32 digits of products are lost


@compiled_allocating
def turned_freely(p, y, c, h):
    """Return (q and omega, what their sums have lost), 7 each, after a free rotation.

    The time is h; NaN if it takes more than MOST_SPANS spans.
    """
    S, left = np.empty((7, TERMS)), h
    for _ in range(MOST_SPANS):
        w1, w2, w3 = y[OMEGA:]
        fastest = max(abs(w1), abs(w2), abs(w3))
        if not abs(left) * fastest > REACH:
            return _span(p, y, c, left, S)    # also what is not a number
        span = math.copysign(REACH / fastest, left)
        y, c = _span(p, y, c, span, S)
        left -= span
    return (math.nan, math.nan, math.nan, math.nan, math.nan, math.nan, math.nan), c


@compiled
def _span(p, y, c, h, S):
    """Return (y, c) after one span."""
    q1, q2, q3, q4, w1, w2, w3 = y
    d1, d2, d3, r1, r2, r3, r4 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(_fill(p, h * w1, h * w2, h * w3, S) - 1, 0, -1):
        d1, d2, d3 = d1 + S[W1, k], d2 + S[W2, k], d3 + S[W3, k]
        r1, r2, r3, r4 = r1 + S[D1, k], r2 + S[D2, k], r3 + S[D3, k], r4 + S[D4, k]
    per = 1.0 / h if h != 0.0 else 0.0
    d1, d2, d3 = per * d1, per * d2, per * d3
    back = -_gained(p, y, c, d1, d2, d3)
    e1, e2, e3, e4, f1, f2, f3 = c
    s1, e1 = add_double(q1, e1, (q4 * r1 + (q2 * r3 - q3 * r2)) + q1 * r4)
    s2, e2 = add_double(q2, e2, (q4 * r2 + (q3 * r1 - q1 * r3)) + q2 * r4)
    s3, e3 = add_double(q3, e3, (q4 * r3 + (q1 * r2 - q2 * r1)) + q3 * r4)
    s4, e4 = add_double(q4, e4, q4 * r4 - (q1 * r1 + (q2 * r2 + q3 * r3)))
    w1, f1 = add_double(w1, f1 + back * (w1 + d1), d1)
    w2, f2 = add_double(w2, f2 + back * (w2 + d2), d2)
    w3, f3 = add_double(w3, f3 + back * (w3 + d3), d3)
    return (s1, s2, s3, s4, w1, w2, w3), (e1, e2, e3, e4, f1, f2, f3)


@compiled
def _fill(p, a1, a2, a3, S):
    """Fill S with the terms of omega h (3 rows, from its start on) and Delta (4 rows) at t = h.

    Return how many count.
    """
    S[W1, 0], S[W2, 0], S[W3, 0] = a1, a2, a3
    S[D1, 0], S[D2, 0], S[D3, 0], S[D4, 0] = 0.0, 0.0, 0.0, 1.0
    (e1, e2, e3), largest_turn, largest_change, small = load_euler(p), 0.0, 0.0, 0
    for n in range(1, TERMS):
        s1, s2, s3, x, y, z, w = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for j in range(n):
            u1, u2, u3 = S[W1, n - 1 - j], S[W2, n - 1 - j], S[W3, n - 1 - j]
            s1, s2, s3 = s1 + S[W2, j] * u3, s2 + S[W3, j] * u1, s3 + S[W1, j] * u2
            r1, r2, r3, r4 = S[D1, j], S[D2, j], S[D3, j], S[D4, j]
            x, y = x + (r4 * u1 + (r2 * u3 - r3 * u2)), y + (r4 * u2 + (r3 * u1 - r1 * u3))
            z, w = z + (r4 * u3 + (r1 * u2 - r2 * u1)), w - (r1 * u1 + (r2 * u2 + r3 * u3))
        part, half = 1.0 / n, 0.5 / n
        S[W1, n], S[W2, n], S[W3, n] = part * e1 * s1, part * e2 * s2, part * e3 * s3
        S[D1, n], S[D2, n], S[D3, n], S[D4, n] = half * x, half * y, half * z, half * w
        change = max(abs(S[W1, n]), abs(S[W2, n]), abs(S[W3, n]))
        turn = max(abs(S[D1, n]), abs(S[D2, n]), abs(S[D3, n]), abs(S[D4, n]))
        largest_change, largest_turn = max(largest_change, change), max(largest_turn, turn)
        small = (
            small + 1
            if change <= ROUNDING * largest_change and turn <= ROUNDING * largest_turn
            else 0
        )
        if small == 2:    # one may vanish by symmetry
            return n
    return TERMS


@compiled
def _gained(p, y, c, d1, d2, d3):
    """Return what the increments d add to the kinetic energy, as a share of twice all of it.

    sum I d (2 omega + d)/(2 sum I omega^2).
    """
    gain, low, twice = 0.0, 0.0, 0.0
    moments = load_moments(p)
    for k in range(3):
        moment, omega, d = moments[k], y[OMEGA + k], d1 if k == 0 else d2 if k == 1 else d3
        a, al = multiply_double(*two_sum(2.0 * omega, d), moment)
        a, al = multiply(a, al + 2.0 * moment * c[OMEGA + k], d, 0.0)
        gain, low = add(gain, low, a, al)
        twice += moment * omega * omega
    return 0.5 * gain / twice if twice > LEAST else 0.0
