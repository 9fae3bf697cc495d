# SPDX-License-Identifier: Apache-2.0
"""How punctual a run was: lateness of every tick, the rate achieved, ticks that are missing.

A tick is late by publish time minus stamp over pace, counted from the schedule. The schedule of a
run stands still in a pause and slips when the node cannot keep up, and the wall clock is adjusted
against the steady clock that ticks obey; so it is found anew in every group of ticks: it is never
later than the promptest of them, follows the wall clock by at most SLEW, and a step of more than
STANDSTILL is no lateness.
"""

import numpy as np

from rigid_body_sim.messages.timeline import NANOSECONDS

SLEW = 5e-4                 # s per second: a clock that is slewed changes by no more
STANDSTILL = 100_000_000    # ns; a node that is further behind slips (realtime/ticking.py)
FEWEST = 20                 # fewest ticks in a group, which otherwise lasts a second
BINS = 100_000              # bins of 1 us, up to STANDSTILL


class Punctuality:
    """Takes the ticks of a Source in their order.

    Parameters
    ----------
    history : History
    """

    def __init__(self, history):
        self._history = history
        self._counts = np.zeros(BINS + 1, np.int64)
        self._pending = (np.empty(0, np.int64), np.empty(0, np.int64))
        self._pace = self._rate = 0.0
        self._origin = self._last_stamp = self._schedule = self._last_time = self._paced_until = (
            None
        )
        self._running = self._worst = 0
        self._groups = []
        self.ticks = self.missing = self._standstills = 0
        self._advanced = 0.0

    def add(self, stamps, publish_times):
        """Take ticks: stamps and publish times (n,) int64, ns."""
        places = self._history.at(stamps)
        self._count_missing(stamps, places)
        changes = np.flatnonzero(np.diff(places)) + 1
        for begin, end in zip([0, *changes], [*changes, len(stamps)], strict=True):
            segment = self._history.segments[places[begin]]
            if segment.pace != self._pace:
                self._take_groups(all_of_them=True)
                self._pace, self._schedule, self._last_time = segment.pace, None, None
            self._rate = segment.rate
            more = stamps[begin:end], publish_times[begin:end]
            self._pending = tuple(
                np.concatenate(pair) for pair in zip(self._pending, more, strict=True)
            )
            self._take_groups()

    def _count_missing(self, stamps, places):
        """Count the ticks that should lie between two neighbours."""
        self._origin = stamps[0] if self._origin is None else self._origin
        steps = np.diff(
            stamps, prepend=stamps[0] if self._last_stamp is None else self._last_stamp
        )
        rates = np.array([segment.rate for segment in self._history.segments])[places]
        self.missing += int(np.maximum(np.rint(steps * rates / NANOSECONDS) - 1, 0).sum())
        self.ticks += len(stamps)
        self._last_stamp = stamps[-1]

    def _take_groups(self, all_of_them=False):
        stamps, times = self._pending
        size, done = max(FEWEST, round(self._rate)), 0
        while len(stamps) - done >= size or (all_of_them and done < len(stamps)):
            if self._pace:
                self._take_group(stamps[done:done + size], times[done:done + size])
            done += size
        self._pending = stamps[done:], times[done:]

    def _take_group(self, stamps, times):
        behind = times - ((stamps - self._origin) / self._pace).astype(np.int64)
        promptest, stood = int(behind.min()), 0
        if self._schedule is None:
            self._schedule = promptest
        elif promptest - self._schedule > STANDSTILL:
            stood = promptest - self._schedule
            self._standstills += 1
            self._schedule = promptest
        else:
            self._schedule = min(
                promptest, self._schedule + int(SLEW * (times[-1] - self._last_time))
            )
        if self._last_time is None:
            self._last_time, self._paced_until = times[0], stamps[0]
        self._running += int(times[-1] - self._last_time) - stood
        # counted by stamps, since ticks that are missing here were still run
        self._advanced += float(stamps[-1] - self._paced_until) * self._rate
        self._last_time, self._paced_until = times[-1], stamps[-1]
        late = np.maximum(behind - self._schedule, 0)
        late = late[late <= STANDSTILL]     # a pause within the group is no lateness
        self._counts += np.bincount(late // 1000, minlength=BINS + 1)
        self._worst = max(self._worst, int(late.max()))
        self._groups.append((stamps[0], stamps[-1], *np.percentile(late, (50, 99, 100))))

    def summary(self):
        """Return lateness (s), the rate achieved (Hz) and counts, as a dict.

        Values that a run without pacing cannot tell are None.
        """
        self._take_groups(all_of_them=True)
        found = {
            'ticks': self.ticks,
            'missing': self.missing,
            'standstills': self._standstills,
            'lateness': None,
            'achieved_rate': None,
        }
        measured = int(self._counts.sum())
        if measured:
            ranks = np.cumsum(self._counts)
            # the upper edge of a bin, so that a percentile is never reported too small
            p50, p99 = (
                min((int(np.searchsorted(ranks, share * measured)) + 1) * 1e-6, self._worst * 1e-9)
                for share in (0.5, 0.99)
            )
            found['lateness'] = {'p50': p50, 'p99': p99, 'max': self._worst * 1e-9}
        if self._running > 0:
            found['achieved_rate'] = self._advanced / self._running
        return found

    def curve(self):
        """Return groups of ticks, shape (n, 5).

        Columns: first and last stamp (ns), then p50, p99 and max of the lateness (ns).
        """
        return np.array(self._groups, dtype=float).reshape(-1, 5)
