# SPDX-License-Identifier: Apache-2.0
"""What the runs of a trial tell of a choice: its largest error, and until when it is met."""

import math

import numpy as np

from rigid_body_sim.choice import comparison, forecast, rounding
from rigid_body_sim.choice.trial_runs import COARSER, TrialRuns
from rigid_body_sim.integrators.marching.work import TooMuchWork

SHARED = 4.0    # times what finer runs tell: beyond, they share the rounding of the run itself
MAGNIFIED = 1e-5    # rad: rounding that is magnified to more shows in the errors themselves


class Foretelling(TrialRuns):
    """Runs that tell the error of the one with a tolerance, as far as rounding lets them."""

    def forecast(self, tolerance):
        """Return the Forecast of a choice: of nothing where the trial sees no end."""
        if self._sees_no_end:
            return forecast.Forecast(None, None)
        accuracy, horizon, times = self._accuracy, self._horizon, self._times
        finer = self._reference(tolerance)
        below = None if finer is None else self._below(finer, tolerance)
        errors = self._errors(tolerance, below)
        if errors is None or not float(errors[0]) < math.inf:
            return self._untold()
        here, last, finest = self._states(tolerance), 0.0, finer or tolerance
        between = self._between_looks(tolerance, below, errors) if below else 0.0
        beside = None if below is None or self._allowed else self._states(below)
        if float(errors.max()) < MAGNIFIED:
            best, prototype = self._states(finest), self.prototype.at(finest, self._most)
            try:
                lost = rounding.lost(self._scene, prototype, times, best)
            except TooMuchWork:    # of a body that no longer rests where its start is moved
                return forecast.Forecast(None, None)
            # what moving the start does grows with time, whatever drives the body
            turned = rounding.of_angle_turned(self._scene, prototype, best, times)
            last = max(float(lost.max()) * forecast.turned_later(self._scene, best, self._longer),
                       self._later(best, turned))
            if float(errors.max()) <= comparison.ROUNDINGS * float(lost.max()):
                around = self._around(below, tolerance) if below else None
                errors = comparison.apart_from_mean(here, around) if around else errors
                begun = self._beside_one_begun_later(tolerance, below or tolerance)
                told, apart = max(float(errors.max()), float(lost.max())), float(begun.max())
                if SHARED * told < apart < math.inf and (    # one that fails tells nothing
                        SHARED * self._lost_as_it_begins(below or tolerance) < apart):
                    errors, beside = begun, None
        else:
            lost = np.zeros(len(times))
        for one, error, since in self._allowed:
            if one in (tolerance, finer):    # both allow it themselves, and do not differ by it
                errors = np.maximum(errors, np.where(times >= since, error, 0.0))
        errors = errors + between
        last = max(last, self._later(here, errors, beside))
        return forecast.forecast(np.maximum(errors, lost), times, accuracy, horizon, last)

    def _untold(self):
        """Return the Forecast where runs tell nothing: what the table promises, if it does."""
        promised = self._promised
        if promised is None:
            return forecast.Forecast(None, None)
        return forecast.Forecast(promised, self._horizon if promised <= self._accuracy else 0.0)

    def _errors(self, tolerance, below):
        """Return the errors at looks, rad, beside a run that errs less; None if nothing tells.

        Where there is none, a coarser run is taken. It errs by COARSER times as much as this one,
        or as much where both err by rounding; the middle is told.
        """
        coarser = self._grid(COARSER * tolerance)
        if below is None and coarser == tolerance:
            return None
        try:
            here = self._states(tolerance)
            if below is None:
                return comparison.apart(here, self._states(coarser)) / math.sqrt(COARSER)
            return comparison.apart(here, self._states(below))
        except TooMuchWork:
            return None
