# SPDX-License-Identifier: Apache-2.0
"""Lateness of ticks, counted exactly in bins of one microsecond; its size is constant."""

import array

import numpy as np

BINS = 20_000


class Lateness:
    """A histogram of lateness. One thread adds, another may read.

    The last bin counts everything later than 20 ms; the greatest lateness is kept exactly.
    """

    def __init__(self):
        self._counts = array.array('Q', bytes(8 * BINS))
        self._read = np.zeros(BINS, dtype=np.uint64)
        self._worst_since = 0
        self.worst = 0

    def add(self, nanoseconds):
        """Count one tick."""
        self._counts[min(max(nanoseconds // 1000, 0), BINS - 1)] += 1
        if nanoseconds > self._worst_since:
            self._worst_since = nanoseconds

    def summary(self):
        """Return count, p50, p99 and max (s) of the whole run."""
        return self._summary(
            np.array(self._counts, dtype=np.uint64), max(self.worst, self._worst_since)
        )

    def since_last(self):
        """Return count, p50, p99 and max (s) since the last call; only one reader calls it."""
        counts = np.array(self._counts, dtype=np.uint64)
        worst, self._worst_since = self._worst_since, 0
        self.worst = max(self.worst, worst)
        fresh, self._read = counts - self._read, counts
        return self._summary(fresh, worst)

    @staticmethod
    def _summary(counts, worst):
        total = int(counts.sum())
        if not total:
            return {'count': 0, 'p50': 0.0, 'p99': 0.0, 'max': 0.0}
        ranks = np.cumsum(counts)
        # the upper edge of a bin, so that a percentile is never reported too small
        p50, p99 = (
            min((int(np.searchsorted(ranks, share * total)) + 1) * 1000, worst)
            for share in (0.5, 0.99)
        )
        return {'count': total, 'p50': p50 * 1e-9, 'p99': p99 * 1e-9, 'max': worst * 1e-9}
