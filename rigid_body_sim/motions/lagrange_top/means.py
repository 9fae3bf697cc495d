# SPDX-License-Identifier: Apache-2.0
"""Mean rates of a heavy symmetric top over a nutation, as pairs of doubles (symbols: roots.py).

They multiply the time. The nutation's rate is an arithmetic-geometric mean. The phases of
the Cayley-Klein parameters grow at

    arg(a)' = sigma/(2 x),     arg(b)' = delta/(2 y),

whose means are complete integrals of the third kind. Bartky's transformation (R. Bulirsch,
Numerische Mathematik 13 (1969) 305, `cel`) takes them to an arithmetic-geometric mean too, by sums
of terms of one sign. With r^2 = x1/x2 and sigma^2 = x1 x2 x3 it is written here so that r = 0, the
passage through a pole, is an ordinary value; b is the same with r^2 = y2/y1 and other factors in
its first step.
"""

import math
from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.compilation.layout import Pair
from rigid_body_sim.numerics.pairs import TURN, over, plus, root_of, scaled, times

NEVER = 2.0 ** 200    # stands for the half period on the separatrix, in units of 2/sqrt(2k(u3-u1))


class MeanRates(NamedTuple):
    """Mean rates over a nutation."""

    mean: float       # pi/(2 K); 1 without nutation, 0 on the separatrix
    nutation: Pair    # turns/s
    a: Pair           # rate of arg(a), rad/s; on the separatrix the one at the top
    b: Pair           # rate of arg(b), rad/s


@compiled_inline
def mean_rates(roots, scale):
    """Return the MeanRates.

    scale^2 is the unit of 1 - u2 and u3 - 1 where they would underflow, else 1.
    """
    half_sigma, half_delta = scaled(roots.sigma, 0.5), scaled(roots.delta, 0.5)
    if roots.steady:
        return MeanRates(1.0, (0.0, 0.0), over(half_sigma, roots.x2), over(half_delta, roots.y1))
    if roots.narrow[0] == 0.0:
        nutation = scaled(root_of(roots.wide), 0.25 / NEVER)
        return MeanRates(0.0, nutation, over(half_sigma, roots.x2), (0.0, 0.0))
    kc = scaled(root_of(over(roots.narrow, roots.wide)), scale)
    rho_a, rho_b = over(roots.x1, roots.x2), over(roots.y2, roots.y1)
    one = (1.0, 0.0)
    m, e, share = one, kc, 1.0
    aa, ba, pa = one, one, one
    # with y2 counted in scale^2, p is in scale and b in its inverse: the same steps
    ab, bb, pb = one, scaled(kc, scale), scaled(kc, 1.0 / scale)
    go_on = True
    while go_on:
        go_on = abs(m[0] - kc[0]) > 3e-11 * m[0]    # remainder after one more step: its square
        aa, ba, pa = _step(aa, ba, pa, rho_a, e)
        ab, bb, pb = _step(ab, bb, pb, rho_b, e)
        m, kc, share = plus(m, kc), scaled(root_of(e), 2.0), 0.5 * share
        e = times(m, kc)
    mean = scaled(m, share)
    share_a = math.copysign(0.5 * share, half_sigma[0])
    share_b = math.copysign(0.5 * share, half_delta[0])
    return MeanRates(
        mean[0], times(times(mean, root_of(roots.wide)), TURN),
        scaled(times(_end(aa, ba, pa, rho_a, m), root_of(roots.x3)), share_a),
        scaled(times(_end(ab, bb, pb, rho_b, m), root_of(roots.y3)), share_b))


@compiled
def _step(a, b, p, rho, e):
    """Return a, b, p after one transformation."""
    g = over(e, p)
    return (plus(a, times(rho, over(b, p))), scaled(plus(b, times(a, g)), 2.0),
            plus(p, times(rho, g)))


@compiled
def _end(a, b, p, rho, m):
    """Return the integral that the transformations have reached, up to a factor."""
    r = root_of(rho)
    return over(plus(times(a, m), times(r, b)), plus(times(m, r), p))
