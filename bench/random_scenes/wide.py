# SPDX-License-Identifier: Apache-2.0
"""Vectors, rotations and tensors of 80-bit numbers, row by row.

The first axis of each array is the copy: the start itself, then moved ones.
"""

import numpy as np

WIDE = np.longdouble


def cross(a, b):
    """Return a x b, row by row; a single vector stands for all rows."""
    x, y, z = a[..., 0], a[..., 1], a[..., 2]
    u, v, w = b[..., 0], b[..., 1], b[..., 2]
    first = y * w - z * v
    out = np.empty((*first.shape, 3), dtype=first.dtype)    # np.stack takes twice as long
    out[..., 0], out[..., 1], out[..., 2] = first, z * u - x * w, x * v - y * u
    return out


def rotated(q, v):
    """Return R v, row by row."""
    u, w = q[:, :3], q[:, 3:]
    t = 2 * cross(u, v)
    return v + w * t + cross(u, t)


def back(q, v):
    """Return R^T v, row by row."""
    return rotated(q * np.array([-1, -1, -1, 1], dtype=WIDE), v)


def inverse(m):
    """Return the inverse of symmetric matrices (n, 3, 3)."""
    a, b, c = m[:, 0], m[:, 1], m[:, 2]
    rows = np.stack([cross(b, c), cross(c, a), cross(a, b)], axis=1)
    return np.swapaxes(rows, 1, 2) / (a * rows[:, 0]).sum(1)[:, None, None]


def times(m, v):
    """Return M v, row by row."""
    return (m * v[:, None, :]).sum(2)


def angle(a, b):
    """Return the angle between two attitudes of 80-bit numbers."""
    sign = 1 if a @ b > 0 else -1
    return float(4 * np.arcsin(min(WIDE(1), np.sqrt(((a - sign * b) ** 2).sum()) / 2)))
