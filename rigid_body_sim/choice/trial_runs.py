# SPDX-License-Identifier: Apache-2.0
"""The runs of a trial, and how far they are apart: the errors of the coarser ones.

Both runs of a pair lose the same digits of the start; what that does to the attitude is computed
when somebody asks for the expected error (rounding.py). The angular momentum of a slim body errs
more than its attitude, by the quotient of its moments, and the flight of a body that hardly turns
errs where its attitude does not: angular momentum and velocity count too, so that the ledger
balances. Tolerances are powers of two, so that nothing depends on the last digit of a difference.
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
from rigid_body_sim.scene.state import TIME, VELOCITY

STEPS, STEPS_PER_RADIAN = 5000, 20    # most of a trial run: three times what the finest takes
SETTLING = 2 ** 16    # steps of a coarse run to the horizon that shows whether a body settles
FEW = 4    # looks of a part of a run that tell how it goes on
ALONE = 16          # factor on the steps of the only method there is: a disk turns ever faster
COARSER = 8.0   # factor between the tolerance of the table and that of a scene, either way
NEAR = 2.0 ** -4     # largest such share: a run that is less fine does not tell the error
FINER_ONES = FINER, NEAR, 0.25    # shares that are tried in turn where runs take too much work
ENDS = 2048    # of steps, at most, at which runs are compared, too
AROUND = 4      # finer runs whose mean rounds half as much as each of them
PAIR = 2        # least number of them
MOMENTA = 0.1   # share at which relative errors of momenta count as errors, rad
CUT, CUTS = 0.25, 2     # share of what a run reached that is the time of the next one; runs made


class TrialRuns:
    """The runs of one method on a scene, from its start, each made once.

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
        self._runs, self._momenta, self._at_ends = {}, {}, {}
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

    @property
    def is_cut_short(self):
        """Whether any of its runs took too much work: more patience may tell more."""
        return bool(self._beyond)

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

    def _apart(self, tolerance, finer):
        """Return what counts as error (rad) of a run beside a finer one, shape (LOOKS,)."""
        here, best = self._states(tolerance), self._states(finer)
        momentum, speed = self._at_start
        shares = comparison.shares(
            self._momenta_of(tolerance), self._momenta_of(finer), momentum)
        if self._flies:
            shares = np.maximum(shares, comparison.velocities_apart(here, best, speed))
        return np.maximum(comparison.apart(here, best), MOMENTA * shares)

    def _between_looks(self, tolerance, finer, errors):
        """Return what errors at the ends of steps add to those at looks, rad, shape (LOOKS,).

        A long step errs most at its end. Where heat slows a body, that error may have gone before
        the next look, and so may those of the time before it slowed.
        """
        if not forecast.has_slowed(self._scene, self._states(tolerance)):
            return np.zeros(len(errors))
        if (tolerance, finer) not in self._at_ends:
            self._at_ends[tolerance, finer] = self._apart_at_ends(tolerance, finer)
        errors = np.maximum.accumulate(errors)
        return np.maximum(self._at_ends[tolerance, finer], errors) - errors

    def _apart_at_ends(self, tolerance, finer):
        """Return the largest error at the ends of steps before each look, rad, beside a finer run.

        It is 0 where there are too many of them, or none.
        """
        largest, start = np.zeros(len(self._times)), self._scene.initial.vector
        coarse, fine = (self.prototype.at(one, self._most) for one in (tolerance, finer))
        with contextlib.suppress(TooMuchWork):
            ends = runs.step_ends(self._scene, coarse, start, float(self._times[-1]), ENDS)
            if ends:
                apart = comparison.apart(*(runs.run(self._scene, one, start, np.array(ends))
                                           for one in (coarse, fine)))
                np.maximum.at(largest, np.searchsorted(self._times, ends), apart)
        return np.maximum.accumulate(largest)

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


def _flies(scene):
    """Return whether forces move the body, of which the table tells nothing."""
    frame = scene.constraint.frame(scene.body)
    return frame.pushed and any(
        one.gives == 'force' for effect in scene.effects if effect.acting is not None
        for one in effect.acting(frame, 0.0))
