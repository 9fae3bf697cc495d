# SPDX-License-Identifier: Apache-2.0
"""The course of a body on a plane: its states, events and ledger at any time.

Its phases follow each other in contact_succession.py.
"""

import bisect
import contextlib
import math

import numpy as np

from rigid_body_sim.compilation.threads import look
from rigid_body_sim.errors import Ended
from rigid_body_sim.integrators.equations.contact_views import UNKNOWNS
from rigid_body_sim.integrators.marching.contact_succession import Succession
from rigid_body_sim.integrators.marching.work import Work
from rigid_body_sim.mechanics.ledger import ENTRIES_SIZE, HEATS
from rigid_body_sim.scene.state import STATE_SIZE

EVENT = 256              # steps that cost as much as finding one event and what follows it
ROWS = 4096              # states of one call of a kernel
FIRST = np.array([0])    # the only row
TIME = UNKNOWNS.part('time').first


class PlaneCourse:
    """One course from a start."""

    TELLS_EVENTS = True

    def __init__(self, stepped, bound):
        self._so_far = Succession(bound, stepped.vector, stepped.accuracy, stepped.horizon)
        self._begin, self._name = self._so_far.begin, bound.scene.name
        self._steps = Work(f'{stepped.method.NAME} on {self._name}', stepped.most,
                           comes_to_rest=True, origin=self._begin)

    def reach(self, elapsed):
        """March until the time since the start is passed."""
        so_far = self._so_far
        while so_far.over is None and so_far.phases[-1].reach(elapsed, self._steps):
            self._steps.count(EVENT, float(so_far.phases[-1].front[TIME]), elapsed)
            so_far.follow(so_far.phases[-1])
        if so_far.over is not None and (elapsed > so_far.over or not so_far.phases):
            raise Ended(f'{self._name}: {so_far.why}', so_far.last)

    def state(self, time, out):
        """Fill `out` with the state at a time not before the start.

        Columns from 14 on, where `out` has them, get the entries of the ledger, and after them
        the heat by its cause (ledger.HEATS).
        """
        elapsed = time - self._begin
        self.reach(elapsed)
        place = bisect.bisect_right(self._so_far.begins, elapsed) - 1
        self._so_far.write(place, np.array([time]), FIRST, out[np.newaxis])

    def entries(self, time):
        """Return the ledger's entries from the start to a time, and the HEATS after them."""
        row = np.empty(STATE_SIZE + ENTRIES_SIZE + len(HEATS))
        self.state(time, row)
        return row[STATE_SIZE:]

    def states(self, times, out):
        """Fill the rows of `out` as `state` does, for times not before the start."""
        times = np.ascontiguousarray(times)
        order = np.argsort(times, kind='stable')
        elapsed, done = times[order] - self._begin, 0
        self.reach(float(elapsed[-1]))
        begins = self._so_far.begins
        while done < len(order):
            look()
            k = bisect.bisect_right(begins, elapsed[done])
            end = min(len(order), done + ROWS)
            if k < len(begins):
                end = min(end, int(np.searchsorted(elapsed, begins[k])))
            self._so_far.write(k - 1, times, order[done:end], out)
            done = end

    def allowance(self, until):
        """Return (error, since) as Solver.allowance does, of a ring that lies low; else None."""
        error, elapsed = self._so_far.allowed
        since = self._begin + elapsed
        return (error, since) if since <= until else None

    def events(self, after, until):
        """Return the (time, name, values) after one time (s) and up to another.

        The `end` of a course that ends where it begins is after its start.
        """
        with contextlib.suppress(Ended):    # as far as what is rounded to `until`
            self.reach(math.nextafter(until, math.inf) - self._begin)
        if not self._so_far.phases and after == self._begin:
            return self._so_far.events[-1:]
        return [event for event in self._so_far.events if after < event[0] <= until]
