# SPDX-License-Identifier: Apache-2.0
"""Spans, stretches of the motion between two commands or strikes, and their events."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Event:
    """An event: its tick (the first at or after it), time (s), name and values."""

    tick: int
    time: float
    name: str
    values: dict


class Span:
    """A stretch of the motion that one solver covers, up to the next impulse, hold or strike.

    `given` is what commands, strikes and effects have exchanged with the body up to the start:
    work (J), angular impulse about the point of reference (world axes, N m s), dissipated energy
    (J). `start` is the state (14 doubles) from which the solver was started.
    """

    __slots__ = ('_looked_until', '_told', 'given', 'solver', 'start', 'strikes', 'time', 'wrench')

    def __init__(self, time, solver, wrench, strikes, given, start):
        self.time, self.solver, self.wrench, self.strikes = time, solver, wrench, strikes
        self.given, self.start = given, start
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
