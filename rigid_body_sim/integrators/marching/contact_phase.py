# SPDX-License-Identifier: Apache-2.0
"""One phase of a body on a plane: the march from one event to the next, and its states."""

import math

import numpy as np

from rigid_body_sim.integrators.equations.contact_rest import lies_low
from rigid_body_sim.integrators.equations.contact_views import FLIGHT, UNKNOWNS
from rigid_body_sim.integrators.marching import contact_march
from rigid_body_sim.mechanics.contact.parameters import CONTACT

MODE, SWIFT = (CONTACT.part(name).first for name in ('mode', 'swift'))
SIZE = UNKNOWNS.size
TIME, GAP = (UNKNOWNS.part(name).first for name in ('time', 'gap'))

SHORT = 2.0 ** -12    # rad: the time of a difference, over the pace of the motion
PAST = 1.5            # times the length of a hop that the first step of a flight may have
LEAST = 2.0 ** -20    # share of the step planned: a shorter hop is rounding


def _hop(rates, p, y, work, pace):
    """Return how long the first step of a flight may be (s), so that no hop hides within it.

    Steps that grow fourfold from there resolve the gap on each scale of time. It begins as

        v t + a t^2/2 + j t^3/6

    and falls again where a falling term outweighs a rising one. The rates at y are in row 0 of
    `work`; rows 1 and 2 are filled.
    """
    short = SHORT / pace
    for n in (1, 2):
        at = y + n * short * work[0, :SIZE]
        rates.rate(p, at, work[n])
    v, soon, later = (float(work[n, GAP]) for n in range(3))
    a = (4.0 * soon - 3.0 * v - later) / (2.0 * short)
    j = (later - 2.0 * soon + v) / (short * short)
    rises = v if v > rates.ROUNDING * p[SWIFT] else 0.0
    if a < 0.0:
        return PAST * 2.0 * rises / -a if rises else math.inf
    if j < 0.0:
        return PAST * max(3.0 * a / -j, math.sqrt(6.0 * rises / -j))
    return math.inf


class Phase:
    """One phase, from an event to the next.

    Attributes
    ----------
    begin : float
        Time since the start of the course, s.
    kernels : module
        contact_march.py as it is bound.
    front : array
        The last point of the march, and where the phase ended.
    """

    def __init__(self, bound, p, y, tolerance, work, length):
        self.kernels = bound.kernels_of(int(p[MODE]), lies_low(p, y))
        self.p, self._work = p, work
        self.begin = float(y[TIME])
        self._meta = np.zeros(contact_march.META)
        self._meta[contact_march.TOLERANCE] = tolerance
        speed = float(p[SWIFT])
        self._meta[contact_march.SPEED], self._meta[contact_march.LENGTH] = speed, length
        self._meta[contact_march.RATE] = speed / length
        self.front = np.zeros(contact_march.POINT)
        self._store, self._sizes = np.empty((8, contact_march.POINT)), np.empty(64)
        self._cursor, self._y = np.empty((2, contact_march.POINT)), np.empty(SIZE)
        bound.rates.rate(p, y, work[0])
        self.kernels.begin(p, work[0], self.front, self._meta, y)
        if p[MODE] == FLIGHT:
            hop = _hop(bound.rates, p, y, work, self._meta[contact_march.RATE])
            planned = self._meta[contact_march.PLANNED]
            self._meta[contact_march.PLANNED] = min(planned, max(hop, LEAST * planned))

    @property
    def status(self):
        """Why the phase ended; RUNNING if it did not yet."""
        return self._meta[contact_march.STATUS]

    @property
    def ahead(self):
        """The time from the front to the event that ended the phase, s."""
        return float(self._meta[contact_march.AHEAD])

    @property
    def steps(self):
        """How many steps it has made."""
        return int(self._meta[contact_march.STEPS])

    def reach(self, elapsed, work):
        """March until the time is passed or the phase ends; return whether it ends before.

        Parameters
        ----------
        elapsed : float
            s.
        work : Work
            Bounds the steps.

        Raises
        ------
        TooMuchWork
        """
        meta = self._meta

        def arrived():
            return (meta[contact_march.STATUS] != contact_march.RUNNING
                    or self.front[TIME] > elapsed)

        if arrived():
            return self.front[TIME] <= elapsed

        def follow(limit):
            end = int(meta[contact_march.STEPS]) + limit
            if end > len(self._sizes):
                self._sizes = np.concatenate((self._sizes, np.empty(end)))
            while not arrived() and meta[contact_march.STEPS] < end:
                if meta[contact_march.STORED] == len(self._store) < contact_march.KEPT:
                    self._store = np.concatenate((self._store, np.empty_like(self._store)))
                self.kernels.march(self.p, self._work, self._store, self._sizes[:end],
                                   self.front, meta, elapsed)
            return arrived()

        before, steps = work.done, int(meta[contact_march.STEPS])
        work.go(follow, lambda: float(self.front[TIME]), elapsed)
        # `go` leaves out the last slice, whose size depends on the clock
        made = int(meta[contact_march.STEPS]) - steps - (work.done - before)
        work.count(made, float(self.front[TIME]), elapsed)
        return meta[contact_march.STATUS] != contact_march.RUNNING and self.front[TIME] <= elapsed

    def write(self, start, begin, times, order, out):
        """Fill rows of `out` with states at times that the march has passed (contact_march.py)."""
        self.kernels.states(self.p, self._work, self._store, self._sizes, self.front, self._meta,
                            self._cursor, self._y, start, begin, times, order, out)
