# SPDX-License-Identifier: Apache-2.0
"""A bound on the work of a march, which gives up if the time left would take too many steps.

A march goes in slices, so that an interrupt is handled between two of them
(compilation/threads.py). Whether it gives up depends on its steps alone, not on the clock. Steps
that Python makes, and events between two phases of a march, count as the steps of a compiled march
that they cost. So do the steps of an uncompiled march when the steps ahead are judged. A run
with its own bound, such as a trial, gives up after the same steps with numba and without; it looks
ahead early, since it is one of many. An early look lets a march go on if its steps grow: it may
begin with a stiff part.

A march also gives up where its steps shrink geometrically, as under a torque of exp(500 t): the
number of steps doubles again and again in the same time, or in less, and would do so until there
are far more than it may take.
"""

import math

from rigid_body_sim.compilation.environment import HAVE_NUMBA
from rigid_body_sim.compilation.threads import in_slices
from rigid_body_sim.errors import NotConverged
from rigid_body_sim.numerics.functions import log

SLICE = 64              # steps of the first slice
FIRST_LOOK = 1 << 17    # steps before the first look at what lies ahead; then at each doubling
MOST = 3e8              # steps between two times that are asked for: minutes
PATIENCE = 1e15         # steps done times steps ahead: beyond, and beyond MOST, a march gives up
SLOWER = 1 if HAVE_NUMBA else 100    # steps that one costs which is not compiled
EARLY = 1 << 9          # steps before the first look of a run under a bound of its own
HOPELESS = 100.0        # times its bound: where as many steps lie ahead, it gives up
GROWING = 2.0           # steps that are so many times longer than those up to the look before
DOUBLED = 1 << 6        # steps from which on doublings of their number are timed
EVEN = 1.05             # times the doubling before: one that takes up to that is no slower
AGAIN = 4               # doublings in succession that are no slower than the one before


class TooMuchWork(NotConverged):
    """A march would exceed the bound on its work."""


class Doublings:
    """The times in which the number of steps of a march doubles.

    Parameters
    ----------
    last : float
        The time up to which the march is to go, s.
    times : int
        The number of times that are asked for.

    Attributes
    ----------
    next : int
        The number of steps to see next.
    """

    def __init__(self, last, times):
        self.next, self._last, self._times = DOUBLED, last, times
        self._seen, self._took, self._again = None, 0.0, 0

    def see(self, steps, time, most):
        """Take down that a march has reached a time (s); return whether it is hopeless to go on.

        So it is where the number of steps, if it goes on to double as it did, would be HOPELESS
        times `most` for each time that is asked for.
        """
        if self._seen:
            before, then = self._seen
            took = (time - then) / log(steps / before)    # for e times as many
            self._again = self._again + 1 if took <= EVEN * self._took else 0
            self._took = took
        self.next, self._seen = 2 * steps, (steps, time)
        if self._again < AGAIN:
            return False
        folds = log(max(HOPELESS * self._times * most / steps, 1.0))
        return time + folds * self._took < self._last


class Work:
    """The steps of a march on its way to one time.

    Parameters
    ----------
    name : str
        Name of the method and the scene, for the message.
    most : int or None
        Steps after which the march gives up in any case; None for no such bound.
    comes_to_rest : bool
        Whether the steps done tell nothing of those ahead, since the body may come to rest: then
        only MOST and PATIENCE bound what lies ahead.
    dear : int
        Compiled steps that one step costs, for judging the steps that lie ahead; at least SLOWER,
        but for runs under a bound of their own and bodies that may come to rest.
    made : int
        Steps that the march made before.
    doublings : Doublings, optional
        Of the march.
    origin : float
        The time from which the march counts its times, s.
    """

    def __init__(self, name, most, dear=1, comes_to_rest=False, made=0, doublings=None,
                 origin=0.0):
        self._name, self._most, self.done, self._origin = name, most, 0, origin
        self._dear = max(dear, SLOWER) if most is None and not comes_to_rest else dear
        self._sure, first = FIRST_LOOK // dear, max(1, FIRST_LOOK // self._dear)
        self._early = most is not None and not comes_to_rest
        self._look, self._target = min(first, EARLY) if self._early else first, None
        self._begin = self._seen = (0, math.nan)
        self._pace = 0.0    # s a step, up to the look before
        self._made, self._doublings = made, doublings

    def go(self, follow, now, target):
        """Call follow(limit), which returns whether it has arrived, until it has.

        Parameters
        ----------
        follow : callable
            Makes at most `limit` steps.
        now : callable
            Returns the time that the march has reached, s.
        target : float
            The time to which it goes, s.

        Raises
        ------
        TooMuchWork
        """
        if target != self._target:
            self._target = target
            self._begin, self._pace = (self.done, float(now())), 0.0
            self._seen = self._begin

        def arrived(limit):
            if follow(limit):
                return True
            self.count(limit, float(now()), target)
            return False

        in_slices(arrived, SLICE, self._until_look)

    def count(self, steps, time, target):
        """Count steps that were made on the way to a time, besides those that `go` counts.

        Parameters
        ----------
        steps : int
        time : float
            That the march has reached, s.
        target : float
            As `go` has it, s.

        Raises
        ------
        TooMuchWork
        """
        self.done += steps
        if self._most is not None and self.done >= self._most:
            raise self._given_up(time, target)
        made = self._made + self.done
        if self._doublings and made >= self._doublings.next and self._doublings.see(
                made, time, MOST if self._most is None else self._most):
            raise self._given_up(time, target)
        if self.done >= self._look:
            self._look_ahead(time, target)

    def _until_look(self):
        most = (
            self._look if self._most is None else min(self._look, max(self._most, self.done + 1))
        )
        if self._doublings:
            most = min(most, max(self._doublings.next - self._made, self.done + 1))
        return most - self.done

    def _look_ahead(self, time, target):
        """Compare the steps done since the last look with the time that is left."""
        done, before = self._seen
        pace = (time - before) / (self.done - done)
        ahead = (target - time) / pace if pace > 0.0 else math.inf
        bound = max(MOST, PATIENCE / (self._dear * self.done))
        if self._early:
            bound = min(bound, self._dear * HOPELESS * self._most)
        grows, self._pace = pace > GROWING * self._pace, pace
        if self._dear * ahead > bound and not (grows and self.done < self._sure):
            raise self._given_up(time, target)
        self._look, self._seen = max(2 * self._look, self.done + 1), (self.done, time)

    def _given_up(self, time, target):
        done, before = self._begin
        before, time, target = (self._origin + one for one in (before, time, target))
        return TooMuchWork(
            f'{self._name}: {self.done - done} steps from t = {before!r} s '
            f'led to t = {time!r} s; '
            f'to reach {target!r} s asks for too many. A slower body, weaker effects, a coarser '
            'accuracy, a shorter time, or another integrator would do', time)
