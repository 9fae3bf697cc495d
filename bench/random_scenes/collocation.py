# SPDX-License-Identifier: Apache-2.0
"""Collocation at Gauss nodes with 64-bit mantissas: steps that are polynomials in time.

A step from y0 over H has y' = k at the nodes c_i of (0, 1), k a polynomial in the Legendre
polynomials P_m of 2 theta - 1, theta = (t - t0)/H:

    y(theta) = y0 + H sum_m a_m Q_m(theta),   Q_m = integral of P_m from 0 to theta

The nodes are not at 0: what has no direction there, such as a slip that begins, has one at them.
Where the fixed-point iteration does not converge, as for a stiff slip, Newton's method does.
"""

from typing import NamedTuple

import numpy as np

from random_scenes.wide import WIDE

NODES = 20
ITERATIONS = 40          # of the fixed point
ROUNDS, TRIES = 5, 8     # Jacobians of Newton's method, and iterations with each
CLOSE = 4e-19            # change of an iteration, as a share, that is the last
ROUNDED = 1e-17          # below which a change that no longer falls is rounding
SMALL = 3e-18            # of what a step leaves out, as a share


class Step(NamedTuple):
    """A polynomial in time: begin (s), length (s), the unknowns at its begin, its a_m."""

    begin: WIDE
    length: WIDE
    start: np.ndarray
    parts: np.ndarray

    def at(self, theta):
        """Return the unknowns, one row for each share theta of the step."""
        return self.start + self.length * (_integrals(np.atleast_1d(theta)) @ self.parts)

    def left_out(self):
        """Return the size of what the polynomial may leave out, for each unknown."""
        return self.length * np.abs(self.parts[-2:]).max(0) / NODES


def integral(values, theta):
    """Return the integral from 0 to each share theta of what has values at the nodes."""
    return _integrals(np.atleast_1d(theta)) @ (ANALYSIS @ values)


def _legendre(x, count):
    """Return P_0 .. P_(count - 1) at places x, a row for each place."""
    rows = [np.ones_like(x), x]
    for m in range(1, count - 1):
        rows.append(((2 * m + 1) * x * rows[m] - m * rows[m - 1]) / WIDE(m + 1))
    return np.stack(rows, axis=1)


def _integrals(theta):
    """Return Q_0 .. Q_(NODES - 1), a row for each share."""
    theta = np.asarray(theta, dtype=WIDE)
    P = _legendre(2 * theta - 1, NODES + 1)
    rows = [theta] + [(P[:, m + 1] - P[:, m - 1]) / (2 * WIDE(2 * m + 1)) for m in range(1, NODES)]
    return np.stack(rows, axis=1)


def _tables():
    """Return the nodes, how values there give a_m, and how they give y - y0 there over H."""
    x = np.polynomial.legendre.leggauss(NODES)[0].astype(WIDE)
    for _ in range(3):
        P = _legendre(x, NODES + 1)
        slope = NODES * (P[:, NODES - 1] - x * P[:, NODES]) / (1 - x * x)
        x = x - P[:, NODES] / slope
    weights = 2 / ((1 - x * x) * slope * slope)
    P = _legendre(x, NODES)
    analysis = (P * weights[:, None]).T * (2 * np.arange(NODES, dtype=WIDE) + 1)[:, None] / 2
    c = (1 + x) / 2
    return c, analysis, _integrals(c) @ analysis


C, ANALYSIS, A = _tables()


def step(rates, begin, y, length, sizes, guess=None):
    """Return a Step, or None if no iteration converges.

    Parameters
    ----------
    rates : callable
        (rows of unknowns, times) -> rows of their rates.
    sizes : array
        Beside which a change of each unknown is judged.
    guess : array or 'newton', optional
        k at the nodes for Newton's method, or a demand for it.
    """
    times = begin + length * C
    k = guess
    if guess is None or isinstance(guess, str):
        k = np.tile(rates(y[None], np.array([begin])), (NODES, 1))
    solve = _fixed_point if guess is None else _newton
    k, good = solve(rates, times, y, length, sizes, k)
    return Step(begin, length, y, ANALYSIS @ k) if good else None


def _fixed_point(rates, times, y, length, sizes, k):
    before = np.inf
    for _ in range(ITERATIONS):
        after = rates(y + length * (A @ k), times)
        change = float((np.abs(after - k) * length / sizes).max())
        k = after
        if not np.isfinite(change):
            return k, False
        if change < CLOSE or (change < ROUNDED and change >= before):
            return k, True
        before = change
    return k, False


def _newton(rates, times, y, length, sizes, k):
    """Solve k = rates(y + H A k) by Newton's method; its matrices are of doubles."""
    n, before, first = len(y), np.inf, None
    for _ in range(ROUNDS):
        inverse = _inverse(rates, times, y + length * (A @ k), length, sizes)
        if inverse is None:
            return k, False
        for _ in range(TRIES):
            off = rates(y + length * (A @ k), times) - k
            change = float((np.abs(off) * length / sizes).max())
            first = change if first is None else first
            if not np.isfinite(change) or change > 1e3 * first + 1e-6:
                return k, False
            if change < CLOSE or (change < ROUNDED and change >= before):
                return k, True
            if change > 0.5 * before:
                before = change
                break
            before = change
            scaled = (off / sizes).astype(float).reshape(-1)
            k = k + (inverse @ scaled).reshape(NODES, n).astype(WIDE) * sizes
    return k, False


def _inverse(rates, times, at, length, sizes):
    """Return the inverse of 1 - H A J in doubles, of unknowns over their sizes."""
    n = at.shape[1]
    base, big = rates(at, times), np.eye(NODES * n)
    moves = sizes * WIDE(1e-9)
    slip = getattr(rates, 'smallest', None)    # how little of each unknown changes the rates much
    moves = np.tile(moves, (NODES, 1)) if slip is None else np.minimum(moves, slip(at))
    rows = np.repeat(at, n, axis=0) + (moves[:, :, None] * np.eye(n, dtype=WIDE)).reshape(-1, n)
    apart = rates(rows, np.repeat(times, n)).reshape(NODES, n, n) - base[:, None]
    J = np.swapaxes((apart / moves[:, :, None]), 1, 2)    # J[node, of, by]
    J = (J * sizes[None, None, :] / sizes[None, :, None] * length).astype(float)
    if not np.isfinite(J).all():
        return None
    big -= (A.astype(float)[:, None, :, None] * J[:, :, None, :]).reshape(big.shape)
    return np.linalg.inv(big)
