# SPDX-License-Identifier: Apache-2.0
"""Spans, stretches of the motion between two commands or strikes, and their events.

The spans of a motion are a list in the order of their times. Each ends where the next one begins;
the last one has no end.
"""

import bisect
import operator
from dataclasses import dataclass

import numpy as np

from rigid_body_sim.scene.state import STATE_SIZE


@dataclass(frozen=True)
class Event:
    """An event: its tick, time (s), name and values.

    The tick is the first one at or after it, or the last one of the run where none follows.
    """

    tick: int
    time: float
    name: str
    values: dict


class Span:
    """A stretch of the motion that one solver covers, up to the next impulse, hold or strike.

    `given` has the entries of the ledger up to the start (mechanics/ledger.py), `passed` the
    largest energy (J) and angular impulse (N m s) of those at the starts so far: what is pushed
    and stopped again passes through them. `start` is the state (14 doubles) from which the solver
    was started.
    """

    __slots__ = ('_looked_until', '_told', 'given', 'passed', 'solver', 'start', 'strikes', 'time',
                 'wrench')

    def __init__(self, time, solver, wrench, strikes, given, start, passed=(0.0, 0.0)):
        self.time, self.solver, self.wrench, self.strikes = time, solver, wrench, strikes
        self.given, self.start, self.passed = given, start, passed
        self._told, self._looked_until = [], time

    def events(self, after, until, tick):
        """Return the (time, name, values) after one time (s) and not after another, in order.

        `after` never falls from call to call.
        """
        # A solver looks for events once, going forward; events found beyond `until` are kept.
        if until > self._looked_until:
            self._told += self.solver.events(self._looked_until, until, tick)
            self._looked_until = until
        self._told = [event for event in self._told if event[0] > after]
        return [event for event in self._told if event[0] <= until]


def states_at(spans, times):
    """Return the states of a motion at times (s, any order), shape (n, 14)."""
    out = np.empty((len(times), STATE_SIZE))
    if len(times) == 1:    # without what sorts many
        time = times.item()
        place = bisect.bisect_right(spans, time, key=operator.attrgetter('time')) - 1
        spans[place].solver.state(time, out[0])
        return out
    if len(spans) == 1:
        spans[0].solver.states(times, out)
        return out
    place = _places(spans, times)
    for k, span in enumerate(spans):
        chosen = np.flatnonzero(place == k)
        part = np.empty((len(chosen), STATE_SIZE))
        span.solver.states(times[chosen], part)
        out[chosen] = part
    return out


def wrenches_at(spans, times):
    """Return the Wrench that is held at each time (s), a list."""
    return [spans[k].wrench for k in _places(spans, times)]


def events_between(spans, after, until, tick):
    """Yield the (time, name, values) of a motion after one time (s) up to another, in order.

    `tick` is the length of a tick, s; `after` never falls from call to call.
    """
    for k, span in enumerate(spans):
        end = spans[k + 1].time if k + 1 < len(spans) else until
        if end > after:
            yield from span.events(after, min(end, until), tick)


def _places(spans, times):
    """Return for each time the number of the span it lies in."""
    return np.searchsorted([span.time for span in spans], times, side='right') - 1
