# SPDX-License-Identifier: Apache-2.0
"""Template: one step of a convex body on a plane by Gauss collocation, and its error.

It is bound to the rates of equations/contact_lanes.py. It takes the place of contact_step.py,
whose rows it fills: FRESH, TRIED, and in those of stages the watched numbers at the Gauss nodes.
In a row after them, S, the eight stages lie side by side, number by number:

    0         Coupled
    RATES     Stage
    SWEEPS    (one number) how many sweeps the last step took

The equations of the stages are solved to round-off, from the rates at the start of the step alone.
So a step has the same bits whenever it is made again, and its end is a smooth function of its
size, as the search for an event needs. A sweep takes the rates of omega and of the slip at the
stages, moves both, and then moves q with the new omega.
"""

import math
from typing import NamedTuple

import numpy as np

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.compilation.layout import layout
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.equations.contact_lanes import Coupled, Stage
from rigid_body_sim.integrators.equations.contact_views import ROW, UNKNOWNS
from rigid_body_sim.integrators.marching import contact_step, gauss_march, gauss_nodes
from rigid_body_sim.numerics.vectors import dot, minus

parameters = UNBOUND    # contact_lanes.py
turned = UNBOUND
stage = UNBOUND

AtStages = tuple[float, float, float, float, float, float, float, float]


class Eight(NamedTuple):
    """A number at the stages."""

    values: AtStages


class Rates(NamedTuple):
    """The rates of Coupled at the stages."""

    q: tuple[AtStages, AtStages, AtStages, AtStages]
    omega: tuple[AtStages, AtStages, AtStages]
    slip: tuple[AtStages, AtStages]


NODES = gauss_nodes.STAGES
ORDER, STAGES = 2 * NODES, contact_step.STAGES
add, normalise, weight_of, LARGE = (
    contact_step.add, contact_step.normalise, contact_step.weight_of, contact_step.LARGE)
FRESH, TRIED, SIZE = contact_step.FRESH, contact_step.TRIED, UNKNOWNS.size
LANES = contact_step.WORK_ROWS
WORK_ROWS = LANES + 1
LINES, RATES_OF = layout(Coupled, NODES), layout(Stage, NODES)
COUPLED = LINES.size
RATES = NODES * COUPLED
WATCHES = RATES + NODES * SIZE
SWEEPS = RATES + NODES * RATES_OF.size
WIDTH = SWEEPS + 8           # of a row
load_eight, load_rates = layout(Eight).load, layout(Rates).load
OMEGA, U = UNKNOWNS.part('omega').first, UNKNOWNS.part('u').first
WATCHED, WATCHED_SIZE = ROW.part('watched').first, ROW.part('watched').size
PACE, JUMP = ROW.part('pace').first, ROW.part('watched').part('jump').first
load_start, load_line, store_stage = layout(Coupled).load, LINES.load, RATES_OF.store
store_q, store_omega, store_slip = (LINES.part(name).store for name in Coupled._fields)
store_turn, store_growth, store_slips = (
    RATES_OF.part('rates').part(name).store for name in ('q', 'omega', 'u'))
A0, A1, A2, A3, A4, A5, A6, A7 = np.ascontiguousarray(gauss_nodes.A.T)    # a_i0, a_i1, ...
B, C, TAILS = gauss_nodes.B, gauss_nodes.C, gauss_nodes.TAILS
FALL_75, FALL_64, FALL_7, UNSEEN = (
    gauss_march.FALL_75, gauss_march.FALL_64, gauss_march.FALL_7, gauss_march.UNSEEN)
FEWEST, MOST = 4, 40         # sweeps before the change is looked at, and at most
COMFORTABLE = 20.0           # more sweeps cost more than the longer step saves
GROWTH = 1.2                 # of a step: errors go with its 16th power
ENOUGH = 2.0 ** -51          # a change after which the next one is rounding
NOISE, STALE = 2.0 ** -40, 3 # below it, so many changes that no longer fall are rounding
ROUNDING = 2.0 ** -50        # share of the rates that is rounding
# times the estimate that the error may be: the main motion hides harmonics of smaller amplitude
# in the coefficients; a spinning egg erred by up to 20 times
SAFETY = 64.0
STILL = Coupled((0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0))


@compiled_inline
def _hasten(p, S):
    """Fill the rates of omega and of the slip at the stages."""
    c, weight = parameters(p)
    for i in range(NODES):
        rates = stage(c, weight, load_line(S, i)).rates
        store_growth(S, rates.omega, RATES + i)
        store_slips(S, rates.u, RATES + i)


@compiled_inline
def _move(S, y, h):
    """Fill omega and the slip at the stages from their rates: y + h A k.

    A loop over the numbers would be the one that is unrolled, and no vector code.
    """
    (x, yy, z), (ux, uy), k = load_start(y).omega, load_start(y).slip, load_rates(S, RATES)
    (kx, ky, kz), (kux, kuy) = k.omega, k.slip
    for i in range(NODES):
        store_omega(S, (x + h * _ahead(kx, i), yy + h * _ahead(ky, i), z + h * _ahead(kz, i)), i)
        store_slip(S, (ux + h * _ahead(kux, i), uy + h * _ahead(kuy, i)), i)


@compiled_inline
def _turn(p, S, y, h):
    """Fill the rates of q at the stages, and q there from these."""
    c, _ = parameters(p)
    for i in range(NODES):
        store_turn(S, turned(c, load_line(S, i)), RATES + i)
    (x, yy, z, w), (kx, ky, kz, kw) = load_start(y).q, load_rates(S, RATES).q
    for i in range(NODES):
        store_q(S, (x + h * _ahead(kx, i), yy + h * _ahead(ky, i), z + h * _ahead(kz, i),
                    w + h * _ahead(kw, i)), i)


@compiled_inline
def _ahead(k, i):
    """Return by how much a number whose rates are k changes up to the stage i, over h."""
    k0, k1, k2, k3, k4, k5, k6, k7 = k
    return (((A0[i] * k0 + A1[i] * k1) + (A2[i] * k2 + A3[i] * k3))
            + ((A4[i] * k4 + A5[i] * k5) + (A6[i] * k6 + A7[i] * k7)))


@compiled_inline
def _combined(row, S, n):
    """Return the sum of row[j] times the rates of the number n at the stages."""
    k0, k1, k2, k3, k4, k5, k6, k7 = load_eight(S, RATES + NODES * n).values
    b0, b1, b2, b3, b4, b5, b6, b7 = load_eight(row).values
    return (((b0 * k0 + b1 * k1) + (b2 * k2 + b3 * k3))
            + ((b4 * k4 + b5 * k5) + (b6 * k6 + b7 * k7)))


@compiled_inline
def _squares(a, b):
    """Return the squared differences of two Coupled: of q, of omega and of the slip."""
    d0, d1, d2, d3 = a.q[0] - b.q[0], a.q[1] - b.q[1], a.q[2] - b.q[2], a.q[3] - b.q[3]
    turns = minus(a.omega, b.omega)
    ux, uy = a.slip[0] - b.slip[0], a.slip[1] - b.slip[1]
    return d0 * d0 + d1 * d1 + d2 * d2 + d3 * d3, dot(turns, turns), ux * ux + uy * uy


@compiled_inline
def _solve(p, S, y, h):
    """Solve the equations of the stages; return the change that is left: 0, or infinite.

    It is 0 where they settled, and finite where they still moved after the last sweep.
    The change that a sweep makes is looked at in the last stage, each unknown beside its own size.
    """
    _turn(p, S, y, h)
    smallest, change, stale = math.inf, math.inf, 0
    for sweep in range(1, MOST):
        before = load_line(S, NODES - 1)
        _hasten(p, S)
        _move(S, y, h)
        _turn(p, S, y, h)
        now = load_line(S, NODES - 1)
        turned_by, spun, slid = _squares(now, before)
        if not turned_by + spun + slid < LARGE:
            return math.inf
        _, spin, slip = _squares(now, STILL)
        change = (turned_by + (spun / spin if spin > 0.0 else spun)
                  + (slid / slip if slip > 0.0 else slid))
        stale = stale + 1 if smallest <= change <= NOISE * NOISE else 0
        if sweep >= FEWEST and (change <= ENOUGH * ENOUGH or stale == STALE):
            S[SWEEPS] = sweep
            return 0.0
        smallest = min(smallest, change)
    return change


@compiled
def step_from(p, w, y, lost, h):
    """Fill row FRESH with the unknowns after a step h from y; the rates at y are in row 0.

    They are filled where the stages did not settle, too. A part of a step whose stages did is that
    good: all that moves on is rounding, which may be much beside a body that hardly turns.

    Returns
    -------
    float
        0, or infinite: the step is too long for its stages to be found.
    """
    S, (c, weight) = w[LANES], parameters(p)
    S[SWEEPS] = MOST
    for n in range(COUPLED):
        for i in range(NODES):
            S[NODES * n + i] = y[n] + C[i] * (h * w[0, n])
    left = _solve(p, S, y, h)
    if not left < LARGE:
        return math.inf
    for i in range(NODES):
        store_stage(S, stage(c, weight, load_line(S, i)), RATES + i)
    for n in range(SIZE):
        d = lost[n] + h * _combined(B, S, n)
        if not add(w, y, n, d):
            return math.inf
    normalise(w)
    for i in range(1, STAGES):
        for n in range(WATCHED_SIZE):
            w[i, WATCHED + n] = S[WATCHES + NODES * n + min(i, NODES) - 1]
        w[i, JUMP] = w[0, JUMP]
    return 0.0 if left == 0.0 else math.inf


@compiled_inline
def longest(w, h):
    """Return the longest step that may follow one of size h, whose rows these are."""
    return h * min(GROWTH, COMFORTABLE / w[LANES, SWEEPS])


@compiled
def error_of(w, h, scales):
    """Return the estimated error of the step in the rows, as contact_step.error_of does.

    It is that of gauss_march.py, with a margin.
    """
    S, size = w[LANES], 0.0
    for n in range(COUPLED):
        mean = weight_of(n, scales) * _combined(B, S, n)
        size += mean * mean
    # forces that nearly cancel leave the rounding of what they could do
    rounding = ROUNDING * max(math.sqrt(size), w[0, PACE] * scales[0])
    error = 0.0
    for first, end in ((0, OMEGA), (OMEGA, U), (U, COUPLED)):
        error += h * _error(S, first, end, weight_of(first, scales), rounding * rounding)
    return error


@compiled
def _error(S, first, end, weight, noise):
    """Return the error of a group of unknowns over h, by its last Legendre coefficients."""
    c7 = c6 = c5 = c4 = 0.0
    for n in range(first, end):
        d7, d6 = weight * _combined(TAILS[0], S, n), weight * _combined(TAILS[1], S, n)
        d5, d4 = weight * _combined(TAILS[2], S, n), weight * _combined(TAILS[3], S, n)
        c7, c6, c5, c4 = c7 + d7 * d7, c6 + d6 * d6, c5 + d5 * d5, c4 + d4 * d4
    if c5 + c4 <= noise:
        return 0.0
    square = math.sqrt(max(FALL_75 * FALL_75 * c7 / (c5 + noise),
                           FALL_64 * FALL_64 * c6 / (c4 + noise)))
    seventh = math.sqrt(max(c7, square * c6 / (FALL_7 * FALL_7)))
    return SAFETY * UNSEEN * seventh * square * square * square * square * math.sqrt(square)
