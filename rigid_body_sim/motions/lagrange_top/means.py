"""Mean rates of a heavy symmetric top over a nutation, as pairs of doubles: what grows with time (symbols: lagrange_top_roots.py).

The nutation's rate is an arithmetic-geometric mean. The phases of the Cayley-Klein parameters grow at

    arg(a)' = sigma/(2 x),     arg(b)' = delta/(2 y),

whose means are complete integrals of the third kind. Bartky's transformation (R. Bulirsch, Numerische Mathematik 13 (1969) 305, `cel`)
takes them to an arithmetic-geometric mean too, by sums of terms of one sign. With r^2 = x1/x2 and sigma^2 = x1 x2 x3 it is written here so
that r = 0, the passage through a pole, is an ordinary value; b is the same with r^2 = y2/y1 and other factors in its first step.
"""

import math

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.motions.lagrange_top.roots import (
    DELTA,
    NARROW,
    SIGMA,
    STEADY,
    WIDE,
    X1,
    X2,
    X3,
    Y1,
    Y2,
    Y3,
)
from rigid_body_sim.numerics.pairs import TURN, over, pair_at, plus, root_of, scaled, times

NEVER = 2.0 ** 200              # stands for the half period on the separatrix, in units of 2/sqrt(WIDE)


@compiled
def mean_rates(roots, scale):
    """Return pi/(2 K), and as pairs the rates of nutation (turns/s) and of arg(a), arg(b) (rad/s).

    scale^2 is the unit of 1 - u2 and u3 - 1, where they would underflow (else 1). Without nutation pi/(2 K) is counted as 1; on the
    separatrix it is 0, and the rates of the phases are those at the highest position.
    """
    narrow, wide, x2, y1 = pair_at(roots, NARROW), pair_at(roots, WIDE), pair_at(roots, X2), pair_at(roots, Y1)
    half_sigma, half_delta = scaled(pair_at(roots, SIGMA), 0.5), scaled(pair_at(roots, DELTA), 0.5)
    if roots[STEADY] == 1.0:
        return 1.0, (0.0, 0.0), over(half_sigma, x2), over(half_delta, y1)
    if narrow[0] == 0.0:
        return 0.0, scaled(root_of(wide), 0.25 / NEVER), over(half_sigma, x2), (0.0, 0.0)
    kc = scaled(root_of(over(narrow, wide)), scale)
    rho_a, rho_b = over(pair_at(roots, X1), x2), over(pair_at(roots, Y2), y1)
    one = (1.0, 0.0)
    m, e, share = one, kc, 1.0
    aa, ba, pa = one, one, one
    # with y2 counted in scale^2, p is in scale and b in its inverse: the same steps
    ab, bb, pb = one, scaled(kc, scale), scaled(kc, 1.0 / scale)
    go_on = True
    while go_on:
        go_on = abs(m[0] - kc[0]) > 3e-11 * m[0]       # what is left after one more step is its square
        aa, ba, pa = _step(aa, ba, pa, rho_a, e)
        ab, bb, pb = _step(ab, bb, pb, rho_b, e)
        m, kc, share = plus(m, kc), scaled(root_of(e), 2.0), 0.5 * share
        e = times(m, kc)
    mean, share_a, share_b = scaled(m, share), math.copysign(0.5 * share, half_sigma[0]), math.copysign(0.5 * share, half_delta[0])
    return (mean[0], times(times(mean, root_of(wide)), TURN),
            scaled(times(_end(aa, ba, pa, rho_a, m), root_of(pair_at(roots, X3))), share_a),
            scaled(times(_end(ab, bb, pb, rho_b, m), root_of(pair_at(roots, Y3))), share_b))


@compiled
def _step(a, b, p, rho, e):
    """Return a, b, p after one transformation."""
    g = over(e, p)
    return plus(a, times(rho, over(b, p))), scaled(plus(b, times(a, g)), 2.0), plus(p, times(rho, g))


@compiled
def _end(a, b, p, rho, m):
    r = root_of(rho)
    return over(plus(times(a, m), times(r, b)), plus(times(m, r), p))
