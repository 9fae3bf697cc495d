# SPDX-License-Identifier: Apache-2.0
"""Samples kept of a stream of millions of numbers: few enough to draw, each an original value.

Each collector takes blocks in the order of time (``add``) and holds a bounded amount of memory.
"""

import math

import numpy as np


class Curve:
    """Curves thinned to their least and greatest values, so that no spike is lost.

    Of each group of neighbours two are kept, both as they were.

    Parameters
    ----------
    count : int
        Approximate number of samples to come.
    points : int
        Approximate number to keep of each curve; a shorter curve is kept whole.
    """

    def __init__(self, count, points=32768):
        self._group = 1 if count <= points else math.ceil(2 * count / points)
        self._times, self._values = [], []
        self._pending = None

    def add(self, times, values):
        """Take samples: times (n,), values (n,) or (n, curves)."""
        values = values.reshape(len(times), -1)
        if self._pending is not None:
            times, values = np.concatenate([self._pending[0], times]), np.concatenate(
                [self._pending[1], values]
            )
        whole = len(times) // self._group * self._group
        self._pending = (times[whole:], values[whole:])
        if whole:
            self._thin(
                times[:whole].reshape(-1, self._group),
                values[:whole].reshape(-1, self._group, values.shape[1]),
            )

    def _thin(self, times, values):
        """Keep the least and the greatest of each row: times (k, m), values (k, m, curves)."""
        if self._group == 1:
            self._times.append(np.repeat(times, values.shape[2], axis=1))
            self._values.append(values[:, 0])
            return
        # in the order in which they came, (k, 2, curves)
        places = np.sort(np.stack([values.argmin(axis=1), values.argmax(axis=1)], axis=1), axis=1)
        rows = np.arange(len(times))[:, None, None]
        self._times.append(times[rows, places].reshape(-1, values.shape[2]))
        self._values.append(
            np.take_along_axis(values, places, axis=1).reshape(-1, values.shape[2])
        )

    def curve(self, which=0):
        """Return times (k,) and values (k,) of one of the curves."""
        if self._pending is not None and len(self._pending[0]):
            times, values = self._pending
            self._pending = None
            self._thin_rest(times, values)
        if not self._times:
            return np.empty(0), np.empty(0)
        return np.concatenate(self._times)[:, which], np.concatenate(self._values)[:, which]

    def _thin_rest(self, times, values):
        group, self._group = self._group, len(times)
        self._thin(times.reshape(1, -1), values.reshape(1, len(times), -1))
        self._group = group


class Samples:
    """Every n-th sample with all columns, for pictures of the motion in space.

    Parameters
    ----------
    count : int
        How many will come, about.
    keep : int
        How many to keep, about.
    """

    def __init__(self, count, keep):
        self._stride = max(1, math.ceil(count / keep))
        self._seen = 0
        self._parts = []

    def add(self, *columns):
        """Take samples: arrays of n rows each."""
        first = -self._seen % self._stride
        self._seen += len(columns[0])
        self._parts.append([column[first::self._stride] for column in columns])

    def columns(self):
        """Return the columns kept."""
        return (
            [np.concatenate(parts) for parts in zip(*self._parts, strict=True)]
            if self._parts
            else []
        )


class Head:
    """The first `keep` samples with all columns.

    Parameters
    ----------
    keep : int
    """

    def __init__(self, keep):
        self._left = keep
        self._parts = []

    def add(self, *columns):
        """Take samples: arrays of n rows each."""
        if self._left:
            self._parts.append([column[:self._left] for column in columns])
            self._left -= len(self._parts[-1][0])

    def columns(self):
        """Return the columns kept."""
        return (
            [np.concatenate(parts) for parts in zip(*self._parts, strict=True)]
            if self._parts
            else []
        )
