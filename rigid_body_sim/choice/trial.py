# SPDX-License-Identifier: Apache-2.0
"""Trial runs of a choice on the scene itself, since a motion may magnify errors.

The chosen method runs from the scene's start, strikes included, and again with a tolerance a
thousand times finer; the difference is the error of the choice. If it is below the tolerance of
that other run, it is taken from a still finer one. If the error is too large, the tolerance is
made finer by the same factor, until that no longer helps. The angular momentum of a slim body has
a larger error than its attitude, by the quotient of its moments: it counts too, so that the ledger
balances. Both runs lose the same digits of the start; the effect of that on the attitude is added
(forecast.py).
"""

import math
from typing import NamedTuple

import numpy as np

from rigid_body_sim.choice import forecast, measured
from rigid_body_sim.errors import NotConverged
from rigid_body_sim.integrators.marching.work import TooMuchWork
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.mechanics.bounds import drive

RADIANS = 2e4
"""Largest angle that a trial run turns over, rad: some 10 ms."""
LONGER = 10.0   # multiple of the span up to which a trial goes on to a strike
STEPS, STEPS_PER_RADIAN = 5000, 20    # most work of a trial run: three times that of the finest
FINER = 1e-3    # tolerance of the run that a choice is compared with, relative to its own
FINER_ONES = FINER, 0.03, 0.3    # the same, where such a run takes too much work
TRIES = 5       # largest number of tolerances
MOMENTA = 0.1   # weight of relative errors of the angular momentum as errors, rad
HELPS = 0.7     # a finer tolerance helps if the error falls below this share
MAGNIFIED = 1e-5    # rad: rounding magnified beyond this shows in the errors themselves


class Settled(NamedTuple):
    """The choice of `auto`.

    Attributes
    ----------
    method : str
    tolerance : float
        rad.
    expected_error : float
        Largest error of the attitude within the horizon, rad.
    met_until : float
        Time until which the accuracy asked is met, s.
    """

    method: str
    tolerance: float
    expected_error: float
    met_until: float


def settle(scene, able, accuracy, horizon):
    """Return the Settled choice that meets an accuracy on this scene.

    A method that takes many more steps than the motion requires is unsuitable, and the next one is
    tried. If none meets the accuracy, the most accurate method of the table is taken. The
    parameters are those of :func:`rigid_body_sim.choice.measured.pick`. A trial runs a part of a
    long horizon, and errors are taken to grow in proportion to time.

    Raises
    ------
    NotConverged
        No method follows the scene.
    """
    # a method that was not measured on such scenes is used only if it is named
    left, failed = [name for name in able if measured.rows(scene).get(name)], None
    while left:
        method, tolerance, promised = measured.pick(scene, left, accuracy, horizon)
        try:
            return _settled(scene, accuracy, horizon, method, tolerance, promised)
        except TooMuchWork as error:
            left.remove(method)
            failed = error
    raise NotConverged(f'no method follows the scene; the last one tried was {failed or "none"}')


def _settled(scene, accuracy, horizon, method, tolerance, promised):
    """Return what `settle` returns, for one method and the tolerance at which it begins.

    More than forty lines: its helpers share the runs made so far, each of which is made once.
    """
    time = min(horizon, _span(scene, horizon))
    if not time > 0.0:
        return Settled(method, tolerance, promised, horizon)
    part, runs = time / horizon, {}
    times = forecast.looks(time)
    radians = (_pace(scene) + 0.5 * drive(scene, None) * time) * time
    most = STEPS + int(min(STEPS_PER_RADIAN * radians, LONGER * STEPS_PER_RADIAN * RADIANS))

    def prototype(tolerance):
        return Stepped(scene, method, tolerance, horizon=horizon, most=most)

    def states(tolerance):
        """Return the states of a trial run; TooMuchWork is raised."""
        if tolerance not in runs:
            runs[tolerance] = forecast.run(
                scene, prototype(tolerance), scene.initial.vector, times)
        return runs[tolerance]

    def finer_run(tolerance):
        """Return the tolerance of a finer run, or None if none is within the work."""
        for share in FINER_ONES:
            finer = at_most(share * tolerance)
            try:
                states(finer)
                return finer if finer < tolerance else None
            except TooMuchWork:
                continue
        return None

    def below(finer, here):
        """Return the tolerance of a run whose own error is below its difference from `here`.

        The steps of `here` may happen to be better than was asked: then the difference from a
        finer run may be the error of that one, which only its tolerance bounds.
        """
        while float(forecast.apart(here, states(finer)).max()) < finer:
            more = finer_run(finer)
            if more is None:
                break
            finer = more
        return finer

    def at_most(tolerance):
        """Return the coarsest tolerance of the table up to a bound, else its finest."""
        known = [entry['tolerance'] for entry in measured.rows(scene)[method]]
        return max((one for one in known if one <= tolerance * (1.0 + 1e-9)), default=min(known))

    before, errors, finest = None, None, tolerance
    for _ in range(TRIES):
        here, finer = states(tolerance), finer_run(tolerance)
        if finer is None:    # no finer run to compare with: the error is below the last one
            errors = before[1] if before else None
            break
        finest, beside = finer, below(finer, here)
        errors = forecast.apart(here, states(beside))
        momenta = forecast.momenta_apart(scene, here, states(beside))
        error = max(float(errors.max()), MOMENTA * float(momenta.max())) / part
        if error <= accuracy:
            break
        if before and error > HELPS * before[2]:
            tolerance, errors, _ = before    # the motion magnifies round-off
            break
        before = tolerance, errors, error
        tolerance = at_most(tolerance * max(FINER, 0.5 * accuracy / error))
    if errors is None or not float(errors[0]) < math.inf:
        return Settled(method, tolerance, promised, horizon if promised <= accuracy else 0.0)
    best = states(finest)
    if float(errors.max()) < MAGNIFIED:
        errors = np.maximum(errors, forecast.lost(scene, prototype(finest), times, best))
    found = forecast.forecast(errors, times, accuracy, horizon)
    return Settled(method, tolerance, *found)


def _pace(scene):
    """Return an approximate bound of the rate of a body (rad/s), strikes included."""
    return measured.pace(scene) + forecast.struck_rate(scene)


def _span(scene, horizon):
    """Return the length of a trial, s: until the body could have turned by RADIANS.

    It goes on to a strike that comes later, within the horizon, and then for that angle again.
    """
    rate, acceleration = _pace(scene), drive(scene, None)
    times = [strike.time for strike in forecast.strikes(scene) if strike.time < horizon]
    own = RADIANS / rate if rate else math.inf
    if acceleration:
        own = 2.0 * RADIANS / (rate + math.sqrt(rate * rate + 2.0 * acceleration * RADIANS))
    return min(own + (times[-1] if times else 0.0), LONGER * own)
