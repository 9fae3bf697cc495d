# SPDX-License-Identifier: Apache-2.0
"""Trial runs of a choice on the scene itself: a motion may magnify errors, which no table knows.

The chosen method runs from the scene's start, strikes included, with a tolerance that is likely to
meet the accuracy, and with a much finer one; the difference is the error (trial_runs.py). How
errors grow with the tolerance then leads to the tolerance that spends what is asked: a tenth of it
to a half. What the runs tell of the one that is taken is in trial_forecast.py.

A trial does not pay for a body that turns little, is not slim and is moved by no force. Such a
body gets an eighth of the tolerance of the table, to be safe: the table has other scenes.
"""

import math

from rigid_body_sim.choice import comparison, rounding
from rigid_body_sim.choice.trial_forecast import MAGNIFIED, Foretelling
from rigid_body_sim.choice.trial_runs import COARSER
from rigid_body_sim.integrators.marching.work import TooMuchWork
from rigid_body_sim.numerics.functions import log, power

SHORT = 3.0     # rad: over less there is no trial, the run costs some microseconds
SLIM = 10.0     # quotient of moments
LEAST, MOST, AIM = 0.1, 0.5, 0.22     # shares of the accuracy: errors that are taken; the aim
SATURATED = 0.3     # rad: two runs that far apart do not tell how errors go with the tolerance
LIKELY, MEASURED = 2.0, 100.0    # factor on the tolerance of the table up to such an angle (rad)
TRIES = 6       # largest number of tolerances
GROWTH = 1.1    # power of the tolerance with which errors grow, until two are known
GROWTHS = 0.5, 2.0
FARTHEST = 2.0 ** 12    # from one tolerance tried to the next, as a factor
ROUNDS = 0.3    # an error that falls with a lower power of the tolerance is mostly round-off
HELPS = 0.7     # a finer tolerance helps if the error falls below this share
ROUNDED = 10.0  # times what rounding does: an error below it may be magnified rounding


class Trial(Foretelling):
    """The search of the coarsest tolerance of one method that meets the accuracy on a scene."""

    def take(self, tolerance):
        """Return the tolerance to take where the table has the one given.

        Raises
        ------
        TooMuchWork
            A run takes more steps than the motion asks for.
        """
        if self._sees_no_end:
            found = self.tolerance_from(tolerance)
            return self._grid((min(found, tolerance) if self._may_tumble else found) / COARSER)
        if (self._radians <= SHORT and self._promised <= self._accuracy
                and not (self._flies or _slim(self._scene))):
            return self._grid(tolerance / COARSER)
        return self.tolerance_from(tolerance)

    def tolerance_from(self, tolerance):
        """Return a tolerance that meets the accuracy; the search begins near that of the table.

        Raises
        ------
        TooMuchWork
            A run takes more steps than the motion asks for.
        """
        accuracy, good, bad, slow = self._accuracy, None, None, None
        here = self._grid(self._likely(tolerance))
        if self._patience > 1:
            here = self._coarsest    # fine ones are known to take too much
        for _ in range(TRIES):
            try:
                error = self._error(here)
            except TooMuchWork:
                if good or slow or (bad and (self._patience > 1 or bad[1] > SATURATED)):
                    break    # a finer run would be too long: what works is taken
                raise
            if error is None:    # no finer run to compare with: what was seen last is kept
                return here if bad is None else bad[0]
            if error <= self._rounding(here):
                return here
            if error <= MOST * accuracy:
                good = here, error
                if error >= LEAST * accuracy or here == self._coarsest:
                    return here
            elif error > SATURATED:
                bad, slow = (here, error), None
            elif (bad and good is None and here < bad[0]
                  and error > bad[1] * power(here / bad[0], ROUNDS)):
                if error <= accuracy:
                    return here
                if slow is not None:
                    return slow    # the motion magnifies round-off
                # so it may be; or the coarser steps happened to be better than was asked
                slow = bad[0] if error > HELPS * bad[1] else here
                bad = here, error
            else:
                bad, slow = (here, error), None
            last, here = here, self._next(here, error, good, bad)
            if here == last or (good and here == good[0]) or (bad and here == bad[0]):
                break
        if good:
            return good[0]
        return min(here, bad[0]) if here in self._runs else bad[0]

    def excess(self, tolerance, least=math.inf):
        """Return the error at a tolerance, rad, where another method may do better; else 0.

        Another one may where the error is more than is asked, and more than rounding does to any
        method, and where nothing tells the error: then it is infinite. A method tried before
        errs by `least`: an error beyond that is not excused by rounding.
        """
        if tolerance not in self._runs:
            return 0.0    # it was not tried
        error = self._error(tolerance)
        if error is None:
            return math.inf
        if error <= self._accuracy:
            return 0.0
        if error >= least:
            return error
        finer = self._reference(tolerance)
        rounded = float(self._apart(tolerance, finer).max()) / ROUNDED
        try:
            lost = rounding.lost(self._scene, self.prototype.at(finer, self._most), self._times,
                                 self._states(finer), enough=rounded)
        except TooMuchWork:
            return 0.0    # nothing tells
        return error if float(lost.max()) < rounded else 0.0

    def misses(self, tolerance):
        """Return whether the run at a tolerance errs by more than is asked, and is not lost.

        Where errors are magnified to more than MAGNIFIED, no method does much better.
        """
        if tolerance not in self._runs:
            return False    # it was not tried
        error = self._error(tolerance)
        return error is not None and self._accuracy < error < MAGNIFIED

    def beside(self, tolerance, other, its):
        """Return how far the run at a tolerance is, at the horizon, from another Trial's, rad."""
        here = self._states(tolerance)
        return self._later(here, comparison.apart(here, other._states(its)))

    def _likely(self, tolerance):
        """Return a tolerance that is likely to do where the table has the one given.

        It is rather too fine: a coarser one is then tried by one more run, a finer one by two.
        """
        return LIKELY * tolerance * (MEASURED / max(MEASURED, self._radians))

    def _rounding(self, tolerance):
        """Return the error (rad at the horizon) up to which rounding is taken to be its cause.

        It is 0 for a tolerance that is not below what rounding does.
        """
        states = self._states(tolerance)
        lost = self._later(states, rounding.of_angle_turned(
            self._scene, self.prototype.at(tolerance, self._most), states, self._times))
        return ROUNDED * lost if tolerance <= lost else 0.0

    def _error(self, tolerance):
        """Return the error at a tolerance at the horizon, rad, or None if nothing tells it.

        Raises
        ------
        TooMuchWork
            The run itself is too long.
        """
        here, finer = self._states(tolerance), self._reference(tolerance)
        if finer is None:
            return None
        errors = self._apart(tolerance, finer)
        beside = None if self._flies else self._states(finer)
        error = self._later(here, errors, beside)
        if not error <= self._accuracy:
            return error
        return self._later(here, errors + self._between_looks(tolerance, finer, errors), beside)

    def _next(self, here, error, good, bad):
        """Return the tolerance to try after one with an error."""
        growth = GROWTH
        if good and bad and good[1] > 0.0 and bad[1] < math.inf:
            growth = log(bad[1] / good[1]) / log(bad[0] / good[0])
            growth = min(max(growth, GROWTHS[0]), GROWTHS[1])
        share = AIM * self._accuracy / error if error > 0.0 else math.inf
        factor = power(share, 1.0 / growth) if share < math.inf else FARTHEST
        # the nearest one on the grid, not the one below
        return self._grid(math.sqrt(2.0) * here * min(max(factor, 1.0 / FARTHEST), FARTHEST))


def _slim(scene):
    """Return whether moments differ by more than those of the scenes of the table."""
    moments = scene.constraint.frame(scene.body).moments
    return max(moments) > SLIM * min(moments)
