"""Mean rates of a heavy symmetric top over a nutation, as pairs of doubles: what grows with time (symbols: lagrange_top_roots.py).

The nutation's rate is an arithmetic-geometric mean. The phases of the Cayley-Klein parameters grow at

    arg(a)' = sigma/(2 x),     arg(b)' = delta/(2 y),

whose means are complete integrals of the third kind. Bartky's transformation (R. Bulirsch, Numerische Mathematik 13 (1969) 305, `cel`)
takes them to an arithmetic-geometric mean too, by sums of terms of one sign. With r^2 = x1/x2 and sigma^2 = x1 x2 x3 it is written here so
that r = 0, the passage through a pole, is an ordinary value; b is the same with r^2 = y2/y1 and other factors in its first step.
"""

import math

from rigid_body_sim.compiled import compiled
from rigid_body_sim.double_double import root
from rigid_body_sim.motions.lagrange_top_roots import (
    DELTA,
    NARROW,
    SIGMA,
    SIZE,
    STEADY,
    WIDE,
    X1,
    X2,
    X3,
    Y1,
    Y2,
    Y3,
    X,
    Y,
    over,
    plus,
    scaled,
    times,
)

TURN = 0.15915494309189535, -9.839338337591243e-18        # 1/(2 pi)
NEVER = 2.0 ** 200                                         # stands for the half period on the separatrix, in units of 2/sqrt(WIDE)


@compiled
def pair(roots, place):
    """Return a stored pair."""
    return roots[place], roots[SIZE + place]


@compiled
def root_of(p):
    """Return the square root of a pair."""
    return root(p[0], p[1])


@compiled
def mean_rates(roots, scale):
    """Return pi/(2 K), and as pairs the rates of nutation (turns/s) and of arg(a), arg(b) (rad/s).

    scale is the unit in which 1 - u2 and u3 - 1 are counted twice, where their squares would underflow (else 1). Without nutation pi/(2 K) is counted as 1; on the separatrix it
    is 0, and the rates of the phases are those at the highest position.
    """
    narrow, wide = pair(roots, NARROW), pair(roots, WIDE)
    side_a, side_b = math.copysign(0.5, roots[SIGMA]), math.copysign(0.5, roots[DELTA])
    if roots[STEADY] == 1.0:
        return 1.0, (0.0, 0.0), scaled(over(pair(roots, SIGMA), pair(roots, X)), 0.5), scaled(over(pair(roots, DELTA), pair(roots, Y)), 0.5)
    if narrow[0] == 0.0:
        return 0.0, scaled(root_of(wide), 0.25 / NEVER), scaled(over(pair(roots, SIGMA), pair(roots, X2)), 0.5), (0.0, 0.0)
    kc = scaled(root_of(over(narrow, wide)), scale)
    rho_a, rho_b = over(pair(roots, X1), pair(roots, X2)), over(pair(roots, Y2), pair(roots, Y1))
    one = (1.0, 0.0)
    m, e, share = one, kc, 1.0
    aa, ba, pa = one, one, one
    ab, bb, pb = one, kc, kc
    go_on = True
    while go_on:
        go_on = abs(m[0] - kc[0]) > 1e-9 * m[0]
        aa, ba, pa = _step(aa, ba, pa, rho_a, e)
        ab, bb, pb = _step(ab, bb, pb, rho_b, e)
        m, kc, share = plus(m, kc), scaled(root_of(e), 2.0), 0.5 * share
        e = times(m, kc)
    mean = scaled(m, share)
    return (mean[0], times(times(mean, root_of(wide)), TURN), scaled(times(_end(aa, ba, pa, rho_a, m), root_of(pair(roots, X3))), side_a * share),
            scaled(times(_end(ab, bb, pb, rho_b, m), root_of(pair(roots, Y3))), side_b * share))


@compiled
def _step(a, b, p, rho, e):
    """Return a, b, p after one transformation."""
    g = over(e, p)
    return plus(a, times(rho, over(b, p))), scaled(plus(b, times(a, g)), 2.0), plus(p, times(rho, g))


@compiled
def _end(a, b, p, rho, m):
    r = root_of(rho)
    return over(plus(times(a, m), times(r, b)), plus(times(m, r), p))
