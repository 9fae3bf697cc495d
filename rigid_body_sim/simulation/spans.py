# SPDX-License-Identifier: Apache-2.0
"""Spans: what a simulation is made of between two commands or strikes, and the events that they tell of."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Event:
    """Something that happened: at which tick (the first one at or after it), when (s), what, and its numbers."""

    tick: int
    time: float
    name: str
    values: dict


class Span:
    """A stretch of the motion that one solver covers, from its start to the next impulse, hold or strike.

    `given` is what commands, strikes and effects have exchanged with the body up to the start: work (J), angular impulse about the point of
    reference (world axes, N m s), dissipated energy (J). `start` is the state (14 doubles) from
    which the solver was started.
    """

    def __init__(self, time, solver, wrench, strikes, given, start):
        self.time, self.solver, self.wrench, self.strikes = time, solver, wrench, strikes
        self.given, self.start = given, start
        self._told, self._looked_until = [], time

    def events(self, after, until, tick):
        """Return the (time, name, values) after one time (s), which never falls from call to call, and not later than another, in order."""
        # a solver looks for events once, going forward: what it found beyond `until` in an earlier look is kept
        if until > self._looked_until:
            self._told += self.solver.events(self._looked_until, until, tick)
            self._looked_until = until
        self._told = [event for event in self._told if event[0] > after]
        return [event for event in self._told if event[0] <= until]
