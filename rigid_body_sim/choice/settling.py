# SPDX-License-Identifier: Apache-2.0
"""What `auto` settles on: a method and its tolerance, found good by trials on the scene."""

import contextlib
import functools
import math

import numpy as np

from rigid_body_sim.choice import comparison, forecast, measured, runs
from rigid_body_sim.choice.trial import HELPS, Trial
from rigid_body_sim.choice.trial_on_plane import TrialOnPlane
from rigid_body_sim.errors import NotConverged
from rigid_body_sim.integrators import GENERAL, METHODS
from rigid_body_sim.integrators.marching.work import TooMuchWork
from rigid_body_sim.integrators.protocols import FINEST
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.mechanics.energy import DIAGNOSIS
from rigid_body_sim.mechanics.parameters import parameters
from rigid_body_sim.mechanics.potential import energies
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.scene import kept

FASTER = 4.0        # times the pace of the body: a nutation that its attitude hardly shows
RADIANS = 64.0      # of a nutation that are followed, rad
AGREES = 4.0        # times the expected error of a run: what an accurate one differs from it by
ALIKE = 1.25        # a method whose least error is up to so many times another's is as accurate
PATIENCE = 1, 16    # factors on the steps of trials; the second if no method passes with the first


class Settled:
    """What `auto` chose.

    Parameters
    ----------
    method : str
    tolerance : float
        rad.
    expected_error, met_until : float, optional
        Those of the forecast, where they are known.
    find : callable, optional
        Returns the Forecast where they are not; it is called when somebody asks.
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


def settle(scene, able, accuracy, horizon, coarsest=math.inf):
    """Return the Settled choice that meets an accuracy on this scene.

    The parameters are those of :func:`rigid_body_sim.choice.measured.pick`, and the largest
    tolerance that a run may have (rad), whatever a trial finds sufficient. A trial runs a part of
    a long horizon, and errors are taken to grow in proportion to time.

    A method that takes many more steps than the motion asks for does not suit the scene, and the
    next one is tried. If none suits, or none meets the accuracy in so many steps, all of them are
    tried again with more patience, since what acts may be faster than the body, and from the
    coarsest tolerance on, since rounding of what acts may be more than a fine one allows. If the
    table has no method that meets the accuracy, its most accurate one is taken. If a trial shows
    that a method errs by more than the accuracy and by more than rounding, the next one is tried
    too, and the most accurate one is taken. If the best one errs by more than the accuracy, be it
    by rounding, another one that is as accurate in the table is tried as well.

    Raises
    ------
    NotConverged
        No method follows the scene.
    """
    kind = TrialOnPlane if scene.constraint.mechanism is Mechanism.PLANE else Trial
    # a method that was not measured on such scenes is for those who name it
    measured_ones = [name for name in able if measured.on_such(scene, name)]
    failed, tried = 'none', set()
    for patience in PATIENCE:
        left, least, best, cut_short = measured_ones.copy(), math.inf, None, False
        while left:
            method, tolerance, promised = measured.pick(scene, left, accuracy, horizon)
            trial = kind(scene, accuracy, horizon, method, promised, patience,
                         len(measured_ones) > 1)
            left.remove(method)
            tried.add(method)
            try:
                found = trial.take(tolerance)
                excess = trial.excess(found, least) if left or best else 0.0
            except TooMuchWork as error:
                failed, cut_short = error, True
                continue
            cut_short = cut_short or trial.is_cut_short
            if best is None or excess < HELPS * least:
                least, settled_by = excess, trial
                best = _settled(trial, min(found, coarsest))    # the forecast is that of the run
            if not excess > 0.0:
                break
        if best and (not least > 0.0 or not cut_short):
            break
    if not best:
        raise NotConverged(f'no method follows the scene; the last one tried was {failed}')
    untried = [name for name in able if name not in tried
               and (name in measured_ones or measured.is_doubted(scene, name))]
    worst = ALIKE * measured.least_error(scene, best.method)
    others = [name for name in untried if measured.least_error(scene, name) <= worst]
    if not others or not settled_by.misses(best.tolerance):
        return best
    method, tolerance, promised = measured.pick(scene, others, 0.0, horizon)
    trial = kind(scene, accuracy, horizon, method, promised, PATIENCE[0], True)
    return _more_accurate(settled_by, best, trial, tolerance, coarsest)


def side_by_side(settled, settle_on, able, accuracy):
    """Return the Settled choice for many bodies: of a method that has them side by side, if any.

    Parameters
    ----------
    settled : Settled
        The choice for one body.
    settle_on : function (names)
        Settles on one of some methods.
    able : list of str
        The methods that can run the scene.
    accuracy : float
        rad.
    """
    together = [name for name in able if METHODS[name].FAMILY.LANES]
    if settled.method not in together and together:
        with contextlib.suppress(NotConverged):    # also where none was measured on such scenes
            found = settle_on(together)
            # None: untried, as the table promises
            if (found.expected_error or 0.0) <= max(accuracy, settled.expected_error or 0.0):
                return found
    return settled


def _settled(trial, tolerance):
    """Return the Settled choice of a trial's method with a tolerance."""
    return Settled(trial.prototype.method.NAME, tolerance, prototype=trial.prototype,
                   find=functools.partial(trial.forecast, tolerance))


def _more_accurate(known, best, trial, tolerance, coarsest):
    """Return the choice of a trial if it helps; else `best`, which is that of the trial `known`.

    A method may err without a sign of it, so the two trials must agree.
    """
    with contextlib.suppress(TooMuchWork):
        found = min(trial.take(tolerance), coarsest)
        other, error = _settled(trial, found), best.expected_error
        if (trial.beside(found, known, best.tolerance) <= AGREES * error
                and other.expected_error < HELPS * error):
            return other
    return best


def of_named(scene, prototype, accuracy, horizon):
    """Return the Forecast of a method that was named; it holds None where nothing is known.

    Where a rotor makes the body nutate, and the angular velocity errs by a larger share than the
    accuracy, this share is the error.

    Parameters
    ----------
    scene : Scene
    prototype : Stepped
        The method at the tolerance that it runs with.
    accuracy : float
        Asked for, rad.
    horizon : float
        s.
    """
    found, lost = forecast.Forecast(None, None), _nutation_lost(scene, prototype, horizon)
    with contextlib.suppress(TooMuchWork):
        trial = Trial(scene, accuracy, horizon, prototype.name, None, PATIENCE[0], False)
        found = trial.forecast(prototype.accuracy)
    if lost > max(accuracy, found.error or 0.0):
        return forecast.Forecast(lost, min(horizon * accuracy / lost, found.met_until or horizon))
    return found


@kept
def nutation(scene):
    """Return the rate of a nutation (rad/s) that is much faster than the body turns; else 0."""
    diagnosis = np.empty(DIAGNOSIS.size)
    energies(scene).diagnose(parameters(scene), scene.initial.vector, diagnosis)
    momentum = hypot3(*diagnosis[DIAGNOSIS.part('momentum').places].tolist())
    rate = momentum / max(scene.frame.moments)
    fast = scene.constraint.axis is None and rate > FASTER * measured.pace(scene)
    return rate if fast else 0.0


def _nutation_lost(scene, prototype, horizon):
    """Return by which share the angular velocity errs at the horizon in a fast nutation, about.

    Implicit methods damp a nutation, and a finer run of the same method damps it, too; the
    attitude hardly shows it. So the general method is the reference, along the first RADIANS of
    the nutation, which is as fast as |L|/I. Errors are taken to grow in proportion to time, up to
    the whole angular velocity. It is 0 where the body itself turns as fast, and where a run does
    not get so far.
    """
    rate, start = nutation(scene), scene.initial.vector
    if rate == 0.0:
        return 0.0
    part = min(horizon, RADIANS / rate)
    times = runs.looks(part)
    best = Stepped(scene, GENERAL.NAME, max(FINEST, comparison.FINER * prototype.accuracy),
                   horizon=part)
    try:
        states, others = (runs.run(scene, one, start, times) for one in (prototype, best))
    except TooMuchWork:
        return 0.0
    return min(1.0, float(comparison.rates_apart(states, others).max()) * (horizon / part))
