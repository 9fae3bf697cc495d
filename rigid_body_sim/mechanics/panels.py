# SPDX-License-Identifier: Apache-2.0
"""Quadrature panel by panel, under control of its error.

A panel is integrated by Gauss's rule with 16 nodes. The same values give the coefficients c_k of
its integrand along Legendre's polynomials. Where these fall like a geometric series, as those of
every analytic function do in the end, the rule errs by about c_32, which the last ones predict:

    a = max(|c_14|, |c_15|),    b = max(|c_12|, |c_13|),    error = a (a/b)^8

The values at the beginning of a panel and just before its end must also fit the polynomial
through the nodes, as well as its last terms let expect: a part that ends before the first node,
and a kink beside the last one, would not be seen otherwise. The end itself may lie behind a kink.
A panel with too large an error is halved. Source of the rule: NIST DLMF 3.5(v).

Where heat relaxes a body within a share of a panel, the power may rise from nothing and be over
between two nodes, and no value shows it. The energy of the states at the edges does: a panel that
would not explain what the body gained in it is halved, too.
"""

import numpy as np

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.memory import table
from rigid_body_sim.mechanics.ledger import ENTRIES, ENTRIES_SIZE
from rigid_body_sim.numerics.gauss import rule

COUNT = 16
POINTS = COUNT + 2       # points of a panel: its beginning, the nodes, and LATE
LATE = 1.0 - 2.0 ** -10  # of a panel: just before its end
# rates at a point: those of the entries, |omega|, and what of the power is rounding (W)
OMEGA, NOISE, COLUMNS = ENTRIES_SIZE, ENTRIES_SIZE + 1, ENTRIES_SIZE + 2
FIRST_TAIL = 12
TAIL = COUNT - FIRST_TAIL
# numba compiles a function once more where a constant is handed to it, but not for int(constant)
WORK = ENTRIES.part('work').first
DISSIPATED = ENTRIES.part('dissipated').first
IMPULSE = ENTRIES.part('angular_impulse').first    # entries before it are energies
# places in the array `sums`, after the entries: what they lost, and the sizes of what they sum
LOST = ENTRIES_SIZE
ENERGY = LOST + ENTRIES_SIZE
MOMENTUM = ENERGY + 1
SUMS = MOMENTUM + 1
ROUNDING = 2.0 ** -54    # share of a size: a smaller error is rounding
SEEN = 2.0 ** -40        # share of an integrand: c_14 and c_15 that are smaller are rounding
SMOOTH = 2.0 ** -42      # the same in a panel twice as long
FITS = 2.0 ** -20        # share of an integrand: how well its values at both ends fit at least
BEYOND = 8.0             # times c_14 and c_15: values at the ends of an analytic function fit so
EXPLAINED = 2.0 ** -40   # share of the energy that a panel may leave unexplained
SHOWS = 2.0 ** -36       # share of an integrand: a misfit that may still be rounding
TURNED = 12.0            # rad: the largest turn of the body in a panel
# advice on a panel's length
SHORTER, KEPT, LONGER = 0, 1, 2


def _legendre(x):
    """Return P_0 ... P_15 at points x of [-1, 1], shape (16, len(x))."""
    values = [np.ones_like(x), x]
    for k in range(1, COUNT - 1):
        values.append(((2 * k + 1) * x * values[k] - k * values[k - 1]) / (k + 1))
    return np.array(values)


def _tables():
    """Return nodes and weights on [0, 1], and rows that take values at the nodes.

    The rows give c_12 ... c_15, and the values at 0 and LATE of the polynomial through the nodes.
    """
    nodes, weights = (np.array(numbers) for numbers in rule(COUNT))
    values, degrees = _legendre(2.0 * nodes - 1.0), np.arange(COUNT)[:, np.newaxis]
    rows = (2 * degrees + 1) * weights * values
    ends = np.zeros((2, COUNT))
    for end, at_end in zip(ends, _legendre(np.array([-1.0, 2.0 * LATE - 1.0])).T, strict=True):
        for row, value in zip(rows, at_end, strict=True):
            end += value * row
    return nodes, weights, rows[FIRST_TAIL:], ends


NODES, *_constants = _tables()
WEIGHTS, TAILS, AT_ENDS = map(table, _constants)
PLACES = np.array([0.0, *NODES, LATE])


@compiled
def _advice(rates, at, first, last, length, size, slack, noise):
    """Return SHORTER, KEPT or LONGER for integrands of one panel.

    Parameters
    ----------
    rates : array (panels POINTS, COLUMNS)
    at : int
        The panel's row there.
    first, last : int
        Columns; they count as one vector.
    length : float
        Length of the panel, s.
    size : float
        That of the integral: errors count relative to it.
    slack : float
        Share of the integrand by which the trajectory itself is uncertain.
    noise : float
        What rounding makes of the coefficients, where large terms cancel in the integrand.
    """
    head, a, b, off = 0.0, 0.0, 0.0, 0.0
    for k in range(first, last):
        for i in range(POINTS):
            head = max(head, abs(rates[at + i, k]))
        for j in range(TAIL):
            total = 0.0
            for i in range(COUNT):
                total += TAILS[j, i] * rates[at + 1 + i, k]
            if j < TAIL // 2:
                b = max(b, abs(total))
            else:
                a = max(a, abs(total))
        for end in range(2):
            fit = 0.0
            for i in range(COUNT):
                fit += AT_ENDS[end, i] * rates[at + 1 + i, k]
            off = max(off, abs(fit - rates[at + end * (POINTS - 1), k]))
    nothing = ROUNDING * size
    expected = min(FITS * head, BEYOND * a)
    if length * off > nothing and off > max(expected, max(SHOWS, slack) * head, noise):
        return SHORTER
    if length * a <= nothing or a <= max(SMOOTH * head, noise):
        return LONGER
    if a <= max(SEEN, slack) * head:
        return KEPT
    ratio = min(1.0, a / b) if b > 0.0 else 1.0
    square = ratio * ratio
    fourth = square * square
    return KEPT if a * (fourth * fourth) <= ROUNDING * head else SHORTER


@compiled
def _unexplained(rates, at, length, gained):
    """Return the energy (J) that a body gained in a panel and the panel would not book."""
    for i in range(COUNT):
        row = at + 1 + i
        gained -= length * WEIGHTS[i] * (rates[row, int(WORK)] - rates[row, int(DISSIPATED)])
    return abs(gained)


@compiled
def _add(rates, at, length, sums):
    """Add the integrals over a panel to `sums`, and their sizes to those of the integrals."""
    for k in range(ENTRIES_SIZE):
        total, size = 0.0, 0.0
        for i in range(COUNT):
            part = length * WEIGHTS[i] * rates[at + 1 + i, k]
            total, size = total + part, size + abs(part)
        total += sums[LOST + k]
        after = sums[k] + total
        sums[LOST + k] = total - (after - sums[k])
        sums[k] = after
        sums[ENERGY if k < IMPULSE else MOMENTUM] += size


@compiled
def add_panels(rates, edges, gained, relaxation, falling, longest, shortest, slack, noise, sums):
    """Add panels of one length, until one should be shorter or the next one longer.

    More than eight arguments: what a panel is judged by, as numbers of a kernel.

    Parameters
    ----------
    rates : array (panels POINTS, COLUMNS)
        At the PLACES of each panel.
    edges : array (panels + 1,)
        s.
    gained : array (panels,)
        Energy that the body gained in each, J; read where heat relaxes it.
    relaxation : float
        Rate at which heat relaxes a body, over the square of its |omega|, s.
    falling : float
        Rate at which heat takes it down its potentials, 1/s.
    longest, shortest : float
        Bounds of the length, s: a panel that is shorter is taken as it is.
    slack : float
        As in `_advice`.
    noise : float
        As there, of torques, N m.
    sums : array (SUMS,)
        Integrals, what their sums lost (Kahan), sizes of energy and momentum. They are changed.

    Returns
    -------
    int, int
        The panels that were added; SHORTER, KEPT (all were added) or LONGER.
    """
    for panel in range(len(edges) - 1):
        at, length, fastest, rough = panel * POINTS, edges[panel + 1] - edges[panel], 0.0, 0.0
        for i in range(POINTS):
            fastest = max(fastest, rates[at + i, OMEGA])
            rough = max(rough, rates[at + i, NOISE])
        energy = _advice(rates, at, int(WORK), int(IMPULSE), length, sums[ENERGY], slack, rough)
        momentum = _advice(rates, at, int(IMPULSE), int(LOST), length, sums[MOMENTUM], slack,
                           noise)
        advice = min(energy, momentum)
        if length * (relaxation * fastest * fastest + falling) > 1.0:
            explained = max(EXPLAINED, slack) * sums[ENERGY] + length * rough
            if _unexplained(rates, at, length, gained[panel]) > explained:
                advice = SHORTER
        if length > shortest and (advice == SHORTER or length * fastest > TURNED):
            return panel, SHORTER
        _add(rates, at, length, sums)
        if advice == LONGER and 2.0 * length <= longest and 2.0 * length * fastest <= TURNED:
            return panel + 1, LONGER
    return len(edges) - 1, KEPT
