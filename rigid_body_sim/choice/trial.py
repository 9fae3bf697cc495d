# SPDX-License-Identifier: Apache-2.0
"""Trial runs of a choice on the scene itself: a motion may magnify errors, which no table knows.

The chosen method runs from the scene's start, strikes included, with a tolerance that is likely to
meet the accuracy, and with a much finer one; the difference is the error. How errors grow with the
tolerance then leads to the tolerance that spends what is asked: a tenth of it to two fifths.
Tolerances are powers of two, so that nothing depends on the last digit of a difference. The
angular momentum of a slim body errs more than its attitude, by the quotient of its moments, and
the flight of a body that hardly turns errs where its attitude does not: angular momentum and
velocity count too, so that the ledger balances. Both runs lose the same digits of the start: what
that does to the attitude is found when somebody asks for the expected error (forecast.py).

Where a body that is not slim turns too little for a trial to pay, and no force moves it, the
tolerance of the table is taken, and eight times less to be safe: its scenes are others.

On a plane no table says how many steps a radian takes, and an eighth of a tolerance costs a third
more. So where a trial would be dear, none is made: two coarse runs tell how the errors of the
motion go with the tolerance, and an eighth of what follows is taken. All is counted in steps, so
that the choice does not depend on the clock, or on numba.
"""

import functools
import math

import numpy as np

from rigid_body_sim.choice import forecast, measured
from rigid_body_sim.errors import NotConverged
from rigid_body_sim.integrators.marching.contact import CANCELS
from rigid_body_sim.integrators.marching.work import TooMuchWork
from rigid_body_sim.integrators.methods import dop8
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.mechanics.bounds import drive
from rigid_body_sim.mechanics.contact.numbers import weight
from rigid_body_sim.numerics.functions import hypot3, log, power
from rigid_body_sim.scene.constraints.protocol import Mechanism

RADIANS = 2e4
"""Largest angle that a trial run turns over, rad: some 10 ms."""
LONGER = 10.0   # times that: up to there a trial goes on to a strike
SHORT = 3.0     # rad: over less there is no trial, the run costs some microseconds
SLIM = 10.0     # quotient of moments
STEPS, STEPS_PER_RADIAN = 5000, 20    # of a trial run, at most: three times what the finest takes
LEAST, MOST, AIM = 0.1, 0.4, 0.2      # of the accuracy: the error that is taken, and aimed at
PATIENCE = 1, 16    # times so many, where no method follows: what acts is faster than the body
ALONE = 16          # times so many for the only method there is: a disk turns ever faster
SATURATED = 0.3     # rad: two runs that far apart do not tell how errors go with the tolerance
COARSER = 8.0   # between the tolerance of the table and that of a scene, either way
FINER = 2.0 ** -7    # of a tolerance, the one of the run that it is compared with
NEAR = 2.0 ** -4     # of a tolerance: a run that is less fine is none to compare it with
FINER_ONES = FINER, NEAR, 0.25    # where a run that much finer takes too much work
TRIES = 6       # largest number of tolerances
GROWTH = 1.1    # power of the tolerance with which errors grow, until two are known
GROWTHS = 0.5, 2.0
FARTHEST = 2.0 ** 12    # from one tolerance tried to the next, as a factor
ROUNDS = 0.3    # an error that falls with a lower power of the tolerance is mostly round-off
MOMENTA = 0.1   # share at which relative errors of momenta count as errors, rad
HELPS = 0.7     # a finer tolerance helps if the error falls below this share
ROUNDED = 10.0  # times what rounding does: an error below it may be magnified rounding
MAGNIFIED = 1e-5    # rad: rounding that is magnified to more shows in the errors themselves
DEAR = 12288        # steps of the finer run of a trial on a plane: where it has more, none is made
COARSE = 2.0 ** -10, 2.0 ** -14     # tolerances of the two runs that are made instead
WITHIN = 4 * DEAR   # steps of each of them; beyond, the finest tolerance is taken
CAREFUL = 8.0       # share of the tolerance that follows from them


class Settled:
    """What `auto` chose.

    Parameters
    ----------
    method : str
    tolerance : float
        rad.
    expected_error, met_until : float, optional
        As the attributes, where they are known.
    find : callable, optional
        Returns the Forecast where they are not: it is called when somebody asks.
    prototype : Stepped, optional
        The method at some accuracy, on the scene and the horizon of the choice.

    Attributes
    ----------
    method : str
    tolerance : float
        rad.
    """

    def __init__(self, method, tolerance, expected_error=None, met_until=None, find=None,
                 prototype=None):
        self.method, self.tolerance, self.prototype = method, tolerance, prototype
        self._find = find or functools.partial(forecast.Forecast, expected_error, met_until)

    @functools.cached_property
    def forecast(self):
        """The Forecast of the choice."""
        found, self._find = self._find(), None    # what it kept is no longer needed
        return found

    @property
    def expected_error(self):
        """Largest error of the attitude within the horizon, rad."""
        return self.forecast.error

    @property
    def met_until(self):
        """Time until which the accuracy asked is met, s."""
        return self.forecast.met_until

    def __eq__(self, other):
        return self is other or (
            isinstance(other, Settled)
            and (self.method, self.tolerance) == (other.method, other.tolerance)
            and self.forecast == other.forecast)

    def __hash__(self):
        return hash((self.method, self.tolerance))

    def __reduce__(self):
        return Settled, (self.method, self.tolerance, *self.forecast)

    def __deepcopy__(self, memo):
        return self


def settle(scene, able, accuracy, horizon):
    """Return the Settled choice that meets an accuracy on this scene.

    A method that takes many more steps than the motion asks for is no method for the scene: the
    next one is tried. Where none follows, all of them are tried again with more patience, since
    what acts may be faster than the body, and from the coarsest tolerance on, since rounding of
    what acts may be more than a fine one allows. Where none meets the accuracy, the most accurate
    method of the table is taken. Where a trial shows that a method errs by more than the accuracy
    and than rounding, the next one is tried, too, and the most accurate one is taken. The
    parameters are those of :func:`rigid_body_sim.choice.measured.pick`. A trial runs a part of a
    long horizon, and errors are taken to grow in proportion to time.

    Raises
    ------
    NotConverged
        No method follows the scene.
    """
    # a method that was not measured on such scenes is for those who name it
    measured_ones = [name for name in able if measured.on_such(scene, name)]
    failed = 'none'
    for patience in PATIENCE:
        left, least, best = measured_ones.copy(), math.inf, None
        while left:
            method, tolerance, promised = measured.pick(scene, left, accuracy, horizon)
            trial = _Trial(scene, accuracy, horizon, method, promised, patience,
                           len(measured_ones) > 1)
            left.remove(method)
            try:
                found = trial.take(tolerance)
                excess = trial.excess(found) if left or best else 0.0
            except TooMuchWork as error:
                failed = error
                continue
            if best is None or excess < HELPS * least:
                least = excess
                best = Settled(method, found, find=functools.partial(trial.forecast, found),
                               prototype=trial.prototype)
            if not excess > 0.0:
                break
        if best:
            return best
    raise NotConverged(f'no method follows the scene; the last one tried was {failed}')


class _Trial:
    """The trial runs of one method on a scene.

    Parameters
    ----------
    promised : float
        The error at the tolerance of the table, rad: what is expected where runs tell nothing.
    patience : int
        How many times the steps that the motion of the body asks for a run may take.
    others : bool
        Whether other methods could run the scene.

    """

    def __init__(self, scene, accuracy, horizon, method, promised, patience, others):
        self._scene, self._accuracy, self._horizon = scene, accuracy, horizon
        self._promised, self._runs, self._patience = promised, {}, patience
        self._flies = _flies(scene)
        pace, push = measured.pace(scene) + forecast.struck_rate(scene), drive(scene, None)
        time = min(horizon, _span(scene, pace, push, horizon))
        self._part, self._times = time / horizon, forecast.looks(time)
        self._radians = (pace + 0.5 * push * time) * time    # by which it turns at most, about
        most = patience * (1 if others else ALONE) * (STEPS + int(
            min(STEPS_PER_RADIAN * self._radians, LONGER * STEPS_PER_RADIAN * RADIANS)))
        known = [entry['tolerance'] for entry in measured.rows(scene)[method]]
        self._finest, self._coarsest = min(known), max(known)
        self.prototype, self._most = Stepped(scene, method, self._coarsest, horizon=horizon), most

    def take(self, tolerance):
        """Return the tolerance to take, that of the table given.

        Raises
        ------
        TooMuchWork
            A run takes more steps than the motion asks for.
        """
        if self._scene.constraint.mechanism is Mechanism.PLANE and self._dear(tolerance):
            return self._careful()
        if (self._radians <= SHORT and self._promised <= self._accuracy
                and not (self._flies or _slim(self._scene))):
            return self._grid(tolerance / COARSER)
        return self.tolerance_from(tolerance)

    def tolerance_from(self, tolerance):
        """Return the tolerance that meets the accuracy, from the one of the table on.

        Raises
        ------
        TooMuchWork
            A run takes more steps than the motion asks for.
        """
        accuracy, good, bad, slow = self._accuracy, None, None, None
        here = self._grid(COARSER * tolerance)    # that of the table holds on most scenes
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
                # so it may; or the coarser steps happened to be better than was asked
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

    def _dear(self, tolerance):
        """Return whether a trial at a tolerance on a plane would take more than DEAR steps."""
        finer = self._grid(FINER * COARSER * tolerance)
        share = power(finer / COARSE[0], 1.0 / dop8.ORDER)    # steps of a coarse run in its steps
        try:
            self._run(COARSE[0], int(DEAR * min(1.0, share)))
        except TooMuchWork:
            return True
        return False

    def _careful(self):
        """Return a tolerance that meets the accuracy, from two coarse runs over the whole time.

        Errors are taken to go with the tolerance, or faster, as those of order eight do. Where the
        coarse runs part, or would be too long, nothing is known: the finest tolerance is taken
        that another run can be compared with.
        """
        finest, coarse = self._grid(max(self._finest / FINER, self._cancelling())), COARSE[0]
        try:
            for one in COARSE:
                self._runs[one] = self._run(one, WITHIN)
        except TooMuchWork:
            return finest
        error = self._error(coarse)
        if error > SATURATED:
            return finest
        return max(finest, self._grid(self._accuracy / (CAREFUL * max(1.0, error / coarse))))

    def _cancelling(self):
        """Return a tolerance that steps on a plane still follow, rad: a NEAR of it is the limit.

        The rounding of forces that cancel bounds the tolerance of a second (marching/contact.py).
        """
        heaviness, size = max(weight(self._scene), 1e-3), max(self._scene.body.surface.size)
        start = self._scene.initial
        speed = (hypot3(*start.velocity) + hypot3(*start.angular_velocity) * size
                 + math.sqrt(heaviness * size))
        return CANCELS / NEAR * heaviness / speed * self._horizon

    def excess(self, tolerance):
        """Return the error at a tolerance, rad, where another method may do better; else 0.

        That is where it is more than is asked, and more than rounding does to any method.
        """
        if tolerance not in self._runs:
            return 0.0    # it was not tried
        error = self._error(tolerance)
        if error is None or error <= self._accuracy:
            return 0.0
        finer = self._reference(tolerance)
        try:
            lost = forecast.lost(self._scene, self.prototype.at(finer, self._most), self._times,
                                 self._states(finer))
        except TooMuchWork:
            return 0.0    # nothing tells
        return error if error > ROUNDED * float(lost.max()) / self._part else 0.0

    def forecast(self, tolerance):
        """Return the Forecast of a choice."""
        accuracy, horizon, times = self._accuracy, self._horizon, self._times
        finer = self._reference(tolerance)
        errors = None if finer is None else forecast.apart(
            self._states(tolerance), self._states(self._below(finer, tolerance)))
        if errors is None or not float(errors[0]) < math.inf:
            return forecast.Forecast(
                self._promised, horizon if self._promised <= accuracy else 0.0)
        if float(errors.max()) < MAGNIFIED:
            errors = np.maximum(errors, forecast.lost(
                self._scene, self.prototype.at(finer, self._most), times, self._states(finer)))
        return forecast.forecast(errors, times, accuracy, horizon)

    def _grid(self, tolerance):
        """Return the largest power of two up to a tolerance, within those of the table."""
        exponent = math.frexp(tolerance)[1]
        return min(max(math.ldexp(0.5, exponent), self._finest), self._coarsest)

    def _states(self, tolerance):
        """Return the states of a trial run."""
        if tolerance not in self._runs:
            self._runs[tolerance] = self._run(tolerance, self._most)
        return self._runs[tolerance]

    def _run(self, tolerance, most):
        """Return the states of a run that takes at most so many steps."""
        return forecast.run(self._scene, self.prototype.at(tolerance, most),
                            self._scene.initial.vector, self._times)

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
        while float(forecast.apart(here, self._states(finer)).max()) < finer:
            more = self._reference(finer)
            if more is None:
                break
            finer = more
        return finer

    def _error(self, tolerance):
        """Return the error at a tolerance at the horizon, rad, or None if nothing tells it."""
        here, finer = self._states(tolerance), self._reference(tolerance)
        if finer is None:
            return None
        best = self._states(finer)
        shares = forecast.momenta_apart(self._scene, here, best)
        if self._flies:
            shares = np.maximum(shares, forecast.velocities_apart(here, best))
        return max(float(forecast.apart(here, best).max()),
                   MOMENTA * float(shares.max())) / self._part

    def _next(self, here, error, good, bad):
        """Return the tolerance to try after one with an error."""
        growth = GROWTH
        if good and bad and good[1] > 0.0 and bad[1] < math.inf:
            growth = log(bad[1] / good[1]) / log(bad[0] / good[0])
            growth = min(max(growth, GROWTHS[0]), GROWTHS[1])
        share = AIM * self._accuracy / error if error > 0.0 else math.inf
        factor = power(share, 1.0 / growth) if share < math.inf else FARTHEST
        return self._grid(here * min(max(factor, 1.0 / FARTHEST), FARTHEST))


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


def _span(scene, rate, acceleration, horizon):
    """Return the length of a trial, s: until the body could have turned by RADIANS.

    It goes on to a strike that comes later, within the horizon, and then for that angle again.
    """
    times = [strike.time for strike in forecast.strikes(scene) if strike.time < horizon]
    own = RADIANS / rate if rate else math.inf
    if acceleration:
        own = 2.0 * RADIANS / (rate + math.sqrt(rate * rate + 2.0 * acceleration * RADIANS))
    return min(own + (times[-1] if times else 0.0), LONGER * own)
