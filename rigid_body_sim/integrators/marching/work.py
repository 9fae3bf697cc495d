# SPDX-License-Identifier: Apache-2.0
"""A bound on the work of a march: it gives up where the way ahead asks for more steps than pay.

A march goes in slices, so that an interrupt is heard between two of them (compilation/threads.py).
Whether it gives up depends on its steps alone, not on the clock.
"""

import math

from rigid_body_sim.compilation.threads import in_slices
from rigid_body_sim.errors import NotConverged

SLICE = 32              # steps of the first slice
FIRST_LOOK = 1 << 17    # steps before the first look at what lies ahead; then at each doubling
MOST = 3e8              # steps between two times that are asked for: minutes
PATIENCE = 1e15         # steps done times steps ahead: beyond, and beyond MOST, a march gives up


class TooMuchWork(NotConverged):
    """A march would take more steps than its work is bounded to."""


class Work:
    """The steps of a march on its way to one time.

    Parameters
    ----------
    name : str
        Of the method and the scene, for the message.
    most : int or None
        Steps after which the march gives up whatever lies ahead; None is no such bound.
    """

    def __init__(self, name, most):
        self._name, self._most, self.done = name, most, 0
        self._look, self._seen = FIRST_LOOK, (0, None)

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
        begin = self._seen = (self.done, now())

        def arrived(limit):
            if follow(limit):
                return True
            self.done += limit
            if self._most is not None and self.done >= self._most:
                raise self._given_up(now(), target, begin)
            if self.done == self._look:
                self._look_ahead(now(), target, begin)
            return False

        in_slices(arrived, SLICE, self._until_look)

    def _until_look(self):
        most = (
            self._look if self._most is None else min(self._look, max(self._most, self.done + 1))
        )
        return most - self.done

    def _look_ahead(self, time, target, begin):
        """Compare the steps done since the last look with the time that is left."""
        done, before = self._seen
        pace = (time - before) / (self.done - done)
        ahead = (target - time) / pace if pace > 0.0 else math.inf
        if ahead > max(MOST, PATIENCE / self.done):
            raise self._given_up(time, target, begin)
        self._look, self._seen = 2 * self._look, (self.done, time)

    def _given_up(self, time, target, begin):
        done, before = begin
        return TooMuchWork(
            f'{self._name}: {self.done - done} steps from t = {before!r} s led to t = {time!r} s; '
            f'to reach {target!r} s asks for too many. A slower body, weaker effects, a coarser '
            'accuracy, a shorter time, or another integrator would do')
