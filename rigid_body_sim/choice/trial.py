# SPDX-License-Identifier: Apache-2.0
"""Trial runs of a choice on the scene itself: a motion may magnify errors, which no table knows.

The chosen method runs from the scene's start, strikes included, with a tolerance that is likely to
meet the accuracy, and with a much finer one; the difference is the error. How errors grow with the
tolerance then leads to the tolerance that spends what is asked: a tenth of it to a half.
Tolerances are powers of two, so that nothing depends on the last digit of a difference. The
angular momentum of a slim body errs more than its attitude, by the quotient of its moments, and
the flight of a body that hardly turns errs where its attitude does not: angular momentum and
velocity count too, so that the ledger balances. Both runs lose the same digits of the start; what
that does to the attitude is computed when somebody asks for the expected error (rounding.py).

A trial does not pay for a body that turns little, is not slim and is moved by no force. Such a
body gets an eighth of the tolerance of the table, to be safe: the table has other scenes.
"""

import contextlib
import functools
import math

import numpy as np

from rigid_body_sim.choice import comparison, forecast, measured, rounding, runs, trial_time
from rigid_body_sim.choice.comparison import FINER
from rigid_body_sim.integrators import METHODS
from rigid_body_sim.integrators.marching.work import TooMuchWork
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.mechanics.bounds import drives, pushed_unbounded
from rigid_body_sim.numerics.functions import log, power
from rigid_body_sim.scene.state import TIME, VELOCITY

SHORT = 3.0     # rad: over less there is no trial, the run costs some microseconds
SLIM = 10.0     # quotient of moments
STEPS, STEPS_PER_RADIAN = 5000, 20    # most of a trial run: three times what the finest takes
SETTLING = 2 ** 16    # steps of a coarse run to the horizon that shows whether a body settles
FEW = 4    # looks of a part of a run that tell how it goes on
LEAST, MOST, AIM = 0.1, 0.5, 0.22     # shares of the accuracy: errors that are taken; the aim
ALONE = 16          # factor on the steps of the only method there is: a disk turns ever faster
SATURATED = 0.3     # rad: two runs that far apart do not tell how errors go with the tolerance
COARSER = 8.0   # factor between the tolerance of the table and that of a scene, either way
LIKELY, MEASURED = 2.0, 100.0    # factor on the tolerance of the table up to such an angle (rad)
NEAR = 2.0 ** -4     # largest such share: a run that is less fine does not tell the error
FINER_ONES = FINER, NEAR, 0.25    # shares that are tried in turn where runs take too much work
AROUND = 4      # finer runs whose mean rounds half as much as each of them
PAIR = 2        # least number of them
TRIES = 6       # largest number of tolerances
GROWTH = 1.1    # power of the tolerance with which errors grow, until two are known
GROWTHS = 0.5, 2.0
FARTHEST = 2.0 ** 12    # from one tolerance tried to the next, as a factor
ROUNDS = 0.3    # an error that falls with a lower power of the tolerance is mostly round-off
MOMENTA = 0.1   # share at which relative errors of momenta count as errors, rad
CUT, CUTS = 0.25, 2     # share of what a run reached that is the time of the next one; runs made
HELPS = 0.7     # a finer tolerance helps if the error falls below this share
ROUNDED = 10.0  # times what rounding does: an error below it may be magnified rounding
SHARED = 4.0    # times what finer runs tell: beyond, they share the rounding of the run itself
MAGNIFIED = 1e-5    # rad: rounding that is magnified to more shows in the errors themselves


class Trial:
    """The trial runs of one method on a scene.

    Parameters
    ----------
    promised : float or None
        The error at the tolerance of the table, rad: what is expected where runs tell nothing.
    patience : int
        A run may take so many times the steps that the motion of the body asks for.
    others : bool
        Whether other methods could run the scene.
    """

    def __init__(self, scene, accuracy, horizon, method, promised, patience, others):
        self._scene, self._accuracy, self._horizon = scene, accuracy, horizon
        self._promised, self._patience, self._others = promised, patience, others
        self._times = None
        self._flies = _flies(scene)
        rows = measured.rows(scene)
        known = [entry['tolerance'] for entry in rows.get(method) or rows['dop8']]
        self._finest = max(min(known), METHODS[method].FAMILY.FINEST)
        self._coarsest = max(known)
        self.prototype = Stepped(scene, method, self._coarsest, horizon=horizon)
        self._changes = trial_time.changes(scene, horizon)
        pace = measured.pace(scene) + runs.struck_rate(scene)
        self._begin_at(pace, horizon)
        if pushed_unbounded(scene):
            self._begin_at(max(pace, self._pace_seen()), float(self._times[-1]))
        time = float(self._times[-1])
        if time < horizon and measured.makes_heat(scene):
            self._go_on(time, self._radians)
            self._go_on_settling(float(self._times[-1]), self._radians)

    def _begin_at(self, pace, most):
        """Let runs end where a body of a pace (rad/s) has turned far, at most at a time (s)."""
        pushes = drives(self._scene)
        time = min(most, trial_time.trial_time(self._changes, pace, pushes))
        self._begin(time, trial_time.turned_by(time, pace, pushes))

    def _begin(self, time, radians):
        """Let runs end at a time (s) in which the body turns by an angle, about."""
        self._radians = radians
        self._most = self._patience * (1 if self._others else ALONE) * (STEPS + int(
            STEPS_PER_RADIAN * min(radians, trial_time.LONGER * trial_time.RADIANS)))
        self._beyond = {}     # what a run that took too much work said
        if self._times is not None and self._times[-1] == time:
            return    # what ran stands
        self._longer, self._times = self._horizon / time, runs.looks(time)
        self._runs, self._momenta = {}, {}
        self._allowed = []    # (tolerance, error, since): what runs allowed themselves

    def _pace_seen(self):
        """Return the mean rate of the body in a run, rad/s, where no bounds of it are known.

        Where the run takes too much work, a part of it is made, and that is the trial.
        """
        for _ in range(CUTS):
            try:
                states = self._states(self._coarsest)
            except TooMuchWork as error:
                part = CUT * (error.time or 0.0)
                if part == 0.0:
                    break
                self._begin(part, self._radians)
                continue
            turned = rounding.angle_turned(self._scene, states, self._times)
            return turned / float(self._times[-1]) if turned < math.inf else 0.0
        return 0.0

    def _go_on(self, time, radians):
        """Let runs end at the horizon if heat makes the body turn little from a time (s) on."""
        with contextlib.suppress(TooMuchWork):
            slowing = self._states(self._coarsest)
            more = forecast.turned_later(self._scene, slowing, self._longer)
            if more > trial_time.LONGER:
                return
            self._begin(self._horizon, more * radians)
            try:
                self._states(self._coarsest)
            except TooMuchWork:    # what it does at rest takes many steps
                self._begin(time, radians)

    def _go_on_settling(self, time, radians):
        """Let runs end at the horizon if inner heat makes the body spin steadily long before.

        It does where it spins so in LONGER times the time (s) of a trial. The rest then costs
        little, and the errors made until then stay.
        """
        if self._scene.inner_dissipation == 0.0 or time == self._horizon:
            return
        self._begin(self._horizon, max(radians, trial_time.LONGER * trial_time.RADIANS))
        with contextlib.suppress(TooMuchWork):
            states = self._run(self._coarsest, SETTLING)
            if forecast.is_steady(self._scene,
                                  states[self._times >= trial_time.LONGER * time]):
                self._runs[self._coarsest] = states
                return
        self._begin(time, radians)

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

    @property
    def _sees_no_end(self):
        """Whether something changes behind the trial: nobody knows what errors do from then on."""
        seen = np.count_nonzero(self._times > self._changes[-1])
        return self._longer > 1.0 and (bool(seen < FEW) or self._may_tumble)

    @property
    def _may_tumble(self):
        """Whether the body spins so far, and inner heat may make it tumble behind the trial."""
        if self._scene.inner_dissipation == 0.0 or not self._runs:
            return False
        return forecast.may_tumble(self._scene, self._runs[min(self._runs)],
                                   self._horizon - float(self._times[-1]))

    @property
    def is_cut_short(self):
        """Whether any of its runs took too much work: more patience may tell more."""
        return bool(self._beyond)

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

    def _grid(self, tolerance):
        """Return the largest power of two up to a tolerance, within those of the table."""
        exponent = math.frexp(max(tolerance, self._finest))[1]    # a share may underflow to 0
        return min(max(math.ldexp(0.5, exponent), self._finest), self._coarsest)

    def _states(self, tolerance):
        """Return the states of a trial run; one that took too much work is not made again."""
        if tolerance in self._beyond:
            raise TooMuchWork(self._beyond[tolerance])
        if tolerance not in self._runs:
            try:
                self._runs[tolerance] = self._run(tolerance, self._most)
            except TooMuchWork as error:
                self._beyond[tolerance] = str(error)
                raise
        return self._runs[tolerance]

    def _momenta_of(self, tolerance):
        """Return the angular momenta of a trial run."""
        if tolerance not in self._momenta:
            self._momenta[tolerance] = comparison.momenta(self._scene, self._states(tolerance))
        return self._momenta[tolerance]

    @functools.cached_property
    def _at_start(self):
        """The angular momentum (kg m^2/s) and the speed (m/s) at the start."""
        start = self._scene.initial.vector[np.newaxis]
        return (float(comparison.lengths(comparison.momenta(self._scene, start))[0]),
                float(comparison.lengths(start[:, VELOCITY])[0]))

    def _run(self, tolerance, most):
        """Return the states of a run that takes at most so many steps."""
        found = []
        states = runs.run(self._scene, self.prototype.at(tolerance, most),
                          self._scene.initial.vector, self._times, found)
        self._allowed += [(tolerance, *one) for one in found]
        return states

    def _reference(self, tolerance):
        """Return the tolerance of a finer run, or None if none is within the work."""
        able = [one for one in self._runs if one <= NEAR * tolerance]
        if able:
            return max(able)
        for share in FINER_ONES:
            finer = self._grid(share * tolerance)
            try:
                self._states(finer)
                return finer if finer < tolerance else None
            except TooMuchWork:
                continue
        return None

    def _below(self, finer, tolerance):
        """Return the tolerance of a run that errs less than it differs from a coarser one.

        The steps of the coarser one may happen to be better than was asked: then the difference
        from a finer run may be the error of that one, which only its tolerance bounds.
        """
        here = self._states(tolerance)
        while float(comparison.apart(here, self._states(finer)).max()) < finer:
            more = self._reference(finer)
            if more is None:
                break
            finer = more
        return finer

    def _around(self, finer, tolerance):
        """Return the states of a finer run, and of others with tolerances a little larger.

        Runs that take the same steps as one before count once: beside the finest tolerance there
        are many. Where one takes the steps of the run itself, so do all between them. Where no two
        others are finer, coarser ones are taken.
        """
        here, found = self._states(tolerance), []
        while finer <= FINER_ONES[-1] * tolerance or (
                len(found) < PAIR and finer <= COARSER * tolerance):
            with contextlib.suppress(TooMuchWork):
                states = self._states(finer)
                if np.array_equal(states, here):
                    finer = max(finer, tolerance)
                elif not any(np.array_equal(states, one) for one in found):
                    found.append(states)
            if len(found) == AROUND:
                break
            finer *= 2.0
        return found

    def _beside_one_begun_later(self, tolerance, finer):
        """Return how far a run is from a finer one that begins anew at the first look, rad.

        Where the tolerance hardly changes the steps, finer runs round as this one does. One that
        begins later takes other steps.
        """
        here = self._states(tolerance)
        with contextlib.suppress(TooMuchWork):
            begun = runs.run(self._scene, self.prototype.at(finer, self._most),
                             self._states(finer)[0], self._times, over=float(self._times[0]))
            return comparison.apart(here, begun)
        return np.zeros(len(here))

    def _lost_as_it_begins(self, tolerance):
        """Return what half an ulp on each number of the first look does to a run, rad.

        That look may have been rounded to more than the start: a slim body that has gained speed
        spins about its thin axis at a small difference of large numbers.
        """
        prototype, start = self.prototype.at(tolerance, self._most), self._states(tolerance)[0]
        with contextlib.suppress(TooMuchWork):
            begun = runs.run(self._scene, prototype, start, self._times, over=float(start[TIME]))
            return float(rounding.conditioning(
                self._scene, prototype, self._times, begun, start=start).max())
        return 0.0

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
        beside = None if self._flies else self._states(finer)
        return self._later(here, self._apart(tolerance, finer), beside)

    def _apart(self, tolerance, finer):
        """Return what counts as error (rad) of a run beside a finer one, shape (LOOKS,)."""
        here, best = self._states(tolerance), self._states(finer)
        momentum, speed = self._at_start
        shares = comparison.shares(
            self._momenta_of(tolerance), self._momenta_of(finer), momentum)
        if self._flies:
            shares = np.maximum(shares, comparison.velocities_apart(here, best, speed))
        return np.maximum(comparison.apart(here, best), MOMENTA * shares)

    def _later(self, states, errors, beside=None):
        """Return the error (rad) at the horizon after those of a run, beside another one.

        Its part since the last change tells it, too: what acts then goes on, and adds to the error
        that the run has by then.
        """
        last = forecast.later(self._scene, states, errors, self._longer, beside)
        since = self._changes[-1]
        if since == 0.0 or self._longer == 1.0 or self._sees_no_end:
            return last    # no more is known
        part = self._times > since
        longer = (self._horizon - since) / (float(self._times[-1]) - since)
        before = float(errors[~part].max(initial=0.0))
        own = np.maximum(errors[part] - before, 0.0) if before < math.inf else errors[part]
        beside = None if beside is None else beside[part]
        return max(last, before + forecast.later(self._scene, states[part], own, longer, beside))

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


def _flies(scene):
    """Return whether forces move the body, of which the table tells nothing."""
    frame = scene.constraint.frame(scene.body)
    return frame.pushed and any(
        one.gives == 'force' for effect in scene.effects if effect.acting is not None
        for one in effect.acting(frame, 0.0))
