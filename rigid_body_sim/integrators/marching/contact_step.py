# SPDX-License-Identifier: Apache-2.0
"""Template: one step of a convex body on a plane, and its error.

It is bound to the rates of equations/contact_rates.py, and uses the coefficients of a Runge-Kutta
method that estimates its error (dop8). Loops over tables keep the compilation short.

The work space is an array of rows of rates: one per stage, and END, FRESH, TRIED. A step leaves
the new unknowns in row FRESH and what their sums have lost in row TRIED.
"""

import math

import numpy as np

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.equations.contact_views import FLIGHT, UNKNOWNS
from rigid_body_sim.integrators.marching import dormand_prince
from rigid_body_sim.mechanics.contact.parameters import CONTACT
from rigid_body_sim.mechanics.contact.touch import inclination
from rigid_body_sim.numerics.functions import hypot
from rigid_body_sim.numerics.rotations import matrix, normalised
from rigid_body_sim.scene.surfaces import TORUS

rate = UNBOUND

ORDER = dormand_prince.ORDER
STAGES = len(dormand_prince.A)
A = np.zeros((STAGES, STAGES))
B, E5, E3 = np.zeros(STAGES), np.zeros(STAGES), np.zeros(STAGES)
WEIGHED = tuple(dormand_prince.B)        # stages that a step adds up, and its errors
for _i, _row in enumerate(dormand_prince.A):
    for _j, _a in _row.items():
        A[_i, _j] = _a
for _table, _values in ((B, dormand_prince.B), (E5, dormand_prince.E5), (E3, dormand_prince.E3)):
    for _j, _b in _values.items():
        _table[_j] = _b

END, FRESH, TRIED = STAGES, STAGES + 1, STAGES + 2    # rows of the work space beside the stages
WORK_ROWS = STAGES + 3
SIZE = UNKNOWNS.size
COUPLED = UNKNOWNS.part('ledger').first    # unknowns that the rates depend on
OMEGA, U, PLACE, GAP, TIME = (UNKNOWNS.part(name).first
                              for name in ('omega', 'u', 'place', 'gap', 'time'))
load_q, store_q = UNKNOWNS.part('q').load, UNKNOWNS.part('q').store
MODE, KIND, LEVEL = (CONTACT.part(name).first for name in ('mode', 'kind', 'level'))
TURNS = 0.5      # share of its inclination by which a step turns a ring in flight at most
ROUNDING = 2.0 ** -49
LARGE = 1e30     # no unknown of a step that is short enough: powers of larger ones overflow


@compiled_inline
def nears_flat(p, y, h, share):
    """Return whether a ring in flight may turn by a share of its inclination in a step h from y.

    Where it almost turns through flat, the rate of its gap almost jumps. The gap of a `level`
    flight does not (mechanics/contact/touch.py).
    """
    return p[MODE] == FLIGHT and p[KIND] == TORUS and p[LEVEL] == 0.0 and (
        h * hypot(y[OMEGA], y[OMEGA + 1]) > share * inclination(matrix(*load_q(y))[2]))


@compiled
def step_from(p, w, y, lost, h):
    """Fill row FRESH with the unknowns after a step h from y; the rates at y are in row 0.

    Returns
    -------
    float
        0, or infinite: numbers did not stay small, or the step may pass a kink of the gap.
    """
    if nears_flat(p, y, h, TURNS):
        return math.inf    # no stage need show where the lowest point of a ring jumps
    for i in range(1, STAGES):
        _stage(w, y, h, i)
        for n in range(COUPLED):
            if not abs(w[TRIED, n]) < LARGE:
                return math.inf
        rate(p, w[TRIED], w[i])
    b0, b5, b6, b7 = h * B[0], h * B[5], h * B[6], h * B[7]
    b8, b9, b10, b11 = h * B[8], h * B[9], h * B[10], h * B[11]
    for n in range(SIZE):
        d = lost[n] + (
            b0 * w[0, n] + b5 * w[5, n] + b6 * w[6, n] + b7 * w[7, n]
            + b8 * w[8, n] + b9 * w[9, n] + b10 * w[10, n] + b11 * w[11, n])
        if not add(w, y, n, d):
            return math.inf
    normalise(w)
    return 0.0


@compiled_inline
def add(w, y, n, d):
    """Write the unknown n after a change d into row FRESH, what the sum loses into TRIED.

    Return whether the unknown is still a number to go on from.
    """
    s = y[n] + d
    w[FRESH, n] = s
    w[TRIED, n] = d - (s - y[n])
    return abs(s) < LARGE


@compiled_inline
def normalise(w):
    """Give the attitude in row FRESH the norm 1, and row TRIED what it loses by that."""
    summed = load_q(w[FRESH])
    q = normalised(*summed)
    short = load_q(w[TRIED])
    x, yy, z, v = (short[0] + (summed[0] - q[0]), short[1] + (summed[1] - q[1]),
                   short[2] + (summed[2] - q[2]), short[3] + (summed[3] - q[3]))
    # along q there is nothing to make up for
    along = x * q[0] + yy * q[1] + z * q[2] + v * q[3]
    store_q(w[TRIED], (x - along * q[0], yy - along * q[1], z - along * q[2], v - along * q[3]))
    store_q(w[FRESH], q)


@compiled_inline
def _stage(w, y, h, i):
    """Fill row TRIED with the unknowns at which stage i takes its rates."""
    # sums stay in registers: two arrays in a loop would be looked at for overlap each time
    s0 = s1 = s2 = s3 = s4 = s5 = s6 = s7 = s8 = s9 = s10 = s11 = s12 = s13 = 0.0
    for j in range(i):
        a = h * A[i, j]
        if a != 0.0:
            s0 += a * w[j, 0]
            s1 += a * w[j, 1]
            s2 += a * w[j, 2]
            s3 += a * w[j, 3]
            s4 += a * w[j, 4]
            s5 += a * w[j, 5]
            s6 += a * w[j, 6]
            s7 += a * w[j, 7]
            s8 += a * w[j, 8]
            s9 += a * w[j, 9]
            s10 += a * w[j, 10]
            s11 += a * w[j, 11]
            s12 += a * w[j, 12]
            s13 += a * w[j, 13]
    sums = s0, s1, s2, s3, s4, s5, s6, s7, s8, s9, s10, s11, s12, s13
    for n in range(COUPLED):
        w[TRIED, n] = sums[n] + y[n]


@compiled_inline
def weight_of(n, scales):
    """Return how many radians the unknown n counts; `scales` are those of `error_of`."""
    turning, speed, length = scales
    if OMEGA <= n < U:
        return 1.0 / turning
    if U <= n < PLACE:
        return 1.0 / speed
    if PLACE <= n <= GAP:
        return 1.0 / length
    return turning if n == TIME else 1.0


@compiled_inline
def longest(w, h):
    """Return the longest step that may follow one of size h: any."""
    return math.inf


@compiled
def error_of(w, h, scales):
    """Return the estimated error of the step in the rows, as an angle (rad).

    Parameters
    ----------
    scales : tuple of 3 floats
        What counts as one radian: of angular velocity (rad/s), of velocity (m/s), of length (m).
    """
    fifth = third = moved = 0.0
    for n in range(COUPLED):
        e5 = e3 = d = 0.0
        for j in WEIGHED:
            e5 += E5[j] * w[j, n]
            e3 += E3[j] * w[j, n]
            d += B[j] * w[j, n]
        weight = weight_of(n, scales)
        fifth += weight * weight * e5 * e5
        third += weight * weight * e3 * e3
        moved += weight * weight * d * d
    fifth, third, moved = h * h * fifth, h * h * third, h * h * moved
    if not fifth > ROUNDING * ROUNDING * moved:
        return 0.0 if fifth >= 0.0 and moved < math.inf else math.inf
    return fifth / math.sqrt(fifth + 0.01 * third)
