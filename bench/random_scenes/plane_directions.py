# SPDX-License-Identifier: Apache-2.0
"""Directions along which a slip or a rolling begins, and those of a slip after an impact."""

import numpy as np

from random_scenes import collocation
from random_scenes.plane_laws import solved
from random_scenes.wide import WIDE

DIRECTIONS = 720    # from which a search begins
PI = 4 * np.arctan(WIDE(1))


class Unknown(Exception):
    """The truth does not know how a motion goes on."""


def parallel(after):
    """Return the angle along which the slip after an impact is parallel to its friction.

    Raises Unknown if there is none, or more than one.
    """
    angles = 2 * PI * np.arange(DIRECTIONS + 1, dtype=WIDE) / DIRECTIONS

    def across(angles):
        u, A = after(angles)
        return (np.cos(angles) * u[1] - np.sin(angles) * u[0],
                (np.cos(angles) * u[0] + np.sin(angles) * u[1] > 0) & (A > 0))
    values, _ = across(angles)
    found = []
    for k in np.flatnonzero(values[:-1] * values[1:] <= 0):
        low, high, first = angles[k], angles[k + 1], values[k]
        for _ in range(16):
            inner = np.linspace(low, high, 26, dtype=WIDE)
            signs = across(inner)[0] * first
            j = int(np.flatnonzero(~(signs[1:] > 0))[0]) + 1 if (signs[1:] <= 0).any() else 25
            low, high = inner[j - 1], inner[j]
        off, fine = across(np.array([high]))
        if fine[0] and abs(off[0]) < 1e-9 * np.abs(values).max():
            found.append(high)
    if len(found) != 1:
        raise Unknown(f'{len(found)} directions of a slip after an impact')
    return found[0]


def away(growth, guess, count, least):
    """Return the direction along which something that was held grows.

    Newton's method from the guess and from directions all around. Raises Unknown where several
    grow.
    """
    found = _refined(growth, guess[:, 0], least)
    if found is not None:
        return found
    best = []
    if count == 2:
        angles = 2 * PI * np.arange(DIRECTIONS, dtype=WIDE) / DIRECTIONS
        starts = np.stack([np.cos(angles), np.sin(angles)])
    else:
        k = np.arange(DIRECTIONS, dtype=WIDE) + WIDE(0.5)
        z, turn = 1 - 2 * k / DIRECTIONS, k * PI * (1 + np.sqrt(WIDE(5)))
        wide = np.sqrt(1 - z * z)
        starts = np.stack([wide * np.cos(turn), wide * np.sin(turn), z])
    rates, N = growth(starts)
    off = rates - (rates * starts).sum(0) * starts
    share = np.sqrt((off * off).sum(0) / (rates * rates).sum(0))
    share = np.where(((rates * starts).sum(0) > 0) & (N > 0), share, np.inf)
    for k in np.argsort(share)[:40]:
        if np.isfinite(share[k]):
            one = _refined(growth, starts[:, k], least)
            if one is not None and all(one @ other < 1 - 1e-9 for other in best):
                best.append(one)
    if len(best) != 1:
        raise Unknown(f'{len(best)} directions in which a slip begins')
    return best[0]


def _refined(growth, d, least):
    """Return the direction near d along which something grows, by Newton's method, or None.

    Beside `least` (m/s^2) times 1e-12 a growth is rounding.
    """
    d = np.asarray(d, dtype=WIDE)
    for _ in range(60):
        across = collocation.basis(d)
        h = WIDE(1e-8)
        tried = np.stack([d] + [(d + h * one) / np.sqrt(1 + h * h) for one in across], axis=1)
        rates, N = growth(tried)
        if not np.isfinite(rates).all():
            return None
        parts = np.array([[a @ rates[:, j] - (rates[:, j] @ tried[:, j]) * (a @ tried[:, j])
                           for j in range(len(across) + 1)] for a in across])
        J = (parts[:, 1:] - parts[:, :1]) / h
        move = solved(J[:, :, None], -parts[:, :1])[:, 0]
        far = np.sqrt((move * move).sum())
        if not np.isfinite(far):
            return None
        if far > 0.4:
            move = move * (WIDE(0.4) / far)
        d = d + sum(m * a for m, a in zip(move, across, strict=True))
        d = d / np.sqrt(d @ d)
        if far < 1e-15:
            rates, N = growth(d[:, None])
            return d if N[0] > 0 and d @ rates[:, 0] >= -1e-12 * least else None
    return None
