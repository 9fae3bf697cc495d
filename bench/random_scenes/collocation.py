# SPDX-License-Identifier: Apache-2.0
"""Collocation at Gauss nodes with 64-bit mantissas: steps that are polynomials in time.

A step from y0 over H has y' = k at the nodes c_i of (0, 1), k a polynomial in the Legendre
polynomials P_m of 2 theta - 1, theta = (t - t0)/H:

    y(theta) = y0 + H sum_m a_m Q_m(theta),   Q_m = integral of P_m from 0 to theta

A slip that is small or begins has a direction that is stiff, or has none of its own: `Ways` makes
directions unknowns of their own.
"""

from typing import NamedTuple

import numpy as np

from random_scenes.wide import WIDE

NODES = 20
ITERATIONS = 40          # of the fixed point
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


def step(rates, begin, y, length, sizes):
    """Return a Step by iterations of the fixed point, or None if they do not converge.

    Parameters
    ----------
    rates : callable
        (rows of unknowns, times) -> rows of their rates.
    sizes : array
        Beside which a change of each unknown is judged.
    """
    times = begin + length * C
    k = np.tile(rates(y[None], np.array([begin])), (NODES, 1))
    k, good = _fixed_point(rates, times, y, length, sizes, k)
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


class Ways:
    """Directions of what slips, as smooth unknowns of their own where it hardly slips.

    A slip s d, |d| = 1, with the rate v' has s' = d . v' and s d' = v' - (d . v') d, which is
    smooth where s is 0 or small, and stiff: it is solved by Newton's method. Each d is that of the
    begin plus p_1 b_1 + ..., of unit length, with b_j across it.

    Parameters
    ----------
    firsts : list of array
        Directions at the begin of a step.
    sizes : list
        |s| there.
    """

    def __init__(self, firsts, sizes):
        self.firsts, self.sizes = firsts, sizes
        self.across = [basis(d) for d in firsts]
        self.counts = [len(one) for one in self.across]

    def at(self, p):
        """Return the directions (n, rows) for parts p (rows, m)."""
        found, first = [], 0
        for d, across in zip(self.firsts, self.across, strict=True):
            raw = d[:, None] + across.T @ p[:, first:first + len(across)].T
            found.append(raw / np.sqrt((raw * raw).sum(0)))
            first += len(across)
        return found

    def turns(self, d, rates, p):
        """Return the parts across the first directions of v' - (d . v') d, and d . v'."""
        parts = [across @ (v - (one * v).sum(0) * one)
                 for across, one, v in zip(self.across, d, rates, strict=True)]
        return np.concatenate(parts).T, [(one * v).sum(0)
                                         for one, v in zip(d, rates, strict=True)]

    def step(self, rates, begin, y, length, scales):
        """Return a Step and the directions at its end, or None.

        Parameters
        ----------
        rates : callable
            (rows of unknowns, times, directions) -> their rates, and a list of v'.
        """
        m, h = sum(self.counts), WIDE(1e-9)
        times, before, swung = begin + length * C, np.inf, np.inf
        now, _ = rates(y[None], times[:1], [d[:, None] for d in self.firsts])
        k, turned = np.tile(now, (NODES, 1)), np.zeros((NODES, m), dtype=WIDE)
        moves = np.concatenate((np.zeros((1, m)), np.eye(m))).astype(WIDE) * h
        for _ in range(ITERATIONS):
            p = length * (A @ turned)
            tried = (p[None] + moves[:, None]).reshape(-1, m)
            d = self.at(tried)
            found, grows = rates(np.tile(y + length * (A @ k), (m + 1, 1)),
                                 np.tile(times, m + 1), d)
            turns, along = self.turns(d, grows, tried)
            turns = turns.reshape(m + 1, NODES, m)
            slope = np.moveaxis((turns[1:] - turns[0]) / h, 0, 2)    # [node, of, by]
            s = [size + length * (A @ one[:NODES])
                 for size, one in zip(self.sizes, along, strict=True)]
            s = np.repeat(np.stack(s, axis=1), self.counts, axis=1)
            off = turns[0] - s * self._swing([one[:, :NODES] for one in d], turned, p)
            M = -np.einsum('iab,ij->iajb', slope.astype(float), (length * A).astype(float))
            M = M.reshape(NODES * m, NODES * m)
            M[np.diag_indices(NODES * m)] += s.astype(float).reshape(-1)
            after = found[:NODES]
            change = float((np.abs(after - k) * length / scales).max())
            # in a short step the rates change little, whatever the direction
            change = max(change, swung * float((np.abs(after) * length / scales).max()))
            if not (np.isfinite(after).all() and np.isfinite(M).all() and np.isfinite(off).all()):
                return None
            k = after
            if change < CLOSE or (change < ROUNDED and change >= before):
                end = self.at(length * (_integrals(np.ones(1)) @ (ANALYSIS @ turned)))
                return Step(begin, length, y, ANALYSIS @ k), [one[:, 0] for one in end]
            before = change
            try:
                move = np.linalg.solve(M, off.astype(float).reshape(-1))
            except np.linalg.LinAlgError:
                return None
            move = move.reshape(NODES, m).astype(WIDE)
            turned, swung = turned + move, float(np.abs(length * (A @ move)).max())
        return None

    def _swing(self, d, turned, p):
        """Return the parts of d' across the first directions."""
        parts, first = [], 0
        for one, start, across in zip(d, self.firsts, self.across, strict=True):
            own = slice(first, first + len(across))
            raw = start[:, None] + across.T @ p[:, own].T
            by = across.T @ turned[:, own].T / np.sqrt((raw * raw).sum(0))
            parts.append(across @ (by - (one * by).sum(0) * one))
            first += len(across)
        return np.concatenate(parts).T


def basis(d):
    """Return unit vectors across a direction, as rows."""
    if len(d) == 2:
        return np.array([[-d[1], d[0]]])
    side = np.eye(3, dtype=WIDE)[int(np.argmin(np.abs(d)))]
    first = np.cross(d, side)
    first = first / np.sqrt(first @ first)
    return np.stack([first, np.cross(d, first)])
