# SPDX-License-Identifier: Apache-2.0
"""Trial runs of a choice on the scene itself: a motion may magnify errors, which no table knows.

The chosen method runs from the scene's start, and again with a tolerance a thousand times finer;
the difference is the error of the choice. Where the error is too large, the tolerance is made
finer by as much, until that helps no more.
"""

import math

import numpy as np

from rigid_body_sim.choice import measured
from rigid_body_sim.errors import NotConverged
from rigid_body_sim.integrators.marching.work import TooMuchWork
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.mechanics.bounds import drive
from rigid_body_sim.numerics.rotations import angle_between
from rigid_body_sim.scene.state import ORIENTATION, STATE_SIZE

RADIANS = 2e4
"""Largest angle that a trial run turns over, rad: some 10 ms."""
STEPS, STEPS_PER_RADIAN = 5000, 20    # of a trial run, at most: three times what the finest takes
FINER = 1e-3    # the tolerance of the run that a choice is compared with, over its own
FINER_ONES = FINER, 0.03, 0.3    # where a run that much finer takes too much work
TRIES = 5       # largest number of tolerances
HELPS = 0.7     # a finer tolerance helps if the error falls below this share


def settle(scene, able, accuracy, horizon):
    """Return (method, tolerance, expected error in rad) that meets an accuracy on this scene.

    A method that takes many more steps than the motion asks for is no method for the scene: the
    next one is tried. Where none meets the accuracy, the most accurate method of the table is
    taken. The parameters are those of :func:`rigid_body_sim.choice.measured.pick`. A trial runs a
    part of a long horizon, and errors are taken to grow in proportion to time.

    Raises
    ------
    NotConverged
        No method follows the scene.
    """
    left, failed = list(able), None
    while left:
        pick = measured.pick(scene, left, accuracy, horizon)
        try:
            return _settled(scene, accuracy, horizon, *pick)
        except TooMuchWork as error:
            left.remove(pick[0])
            failed = error
    raise NotConverged(f'no method follows the scene; the last one tried was {failed}')


def _settled(scene, accuracy, horizon, method, tolerance, promised):
    """Return what `settle` returns, for one method and the tolerance at which it begins."""
    part, ends = min(1.0, _span(scene) / horizon), {}
    if not part > 0.0:
        return method, tolerance, promised
    time = part * horizon
    radians = (measured.pace(scene) + 0.5 * drive(scene, None) * time) * time
    most = STEPS + int(min(STEPS_PER_RADIAN * radians, STEPS_PER_RADIAN * RADIANS))

    def end(tolerance):
        """Return the attitude at the end of a trial run; TooMuchWork is raised."""
        if tolerance not in ends:
            out = np.empty(STATE_SIZE)
            try:
                solver = Stepped(scene, method, tolerance, horizon=horizon, most=most)
                solver.start(scene.initial.vector).state(time, out)
            except TooMuchWork:
                raise
            except NotConverged:
                out[:] = math.nan
            ends[tolerance] = out[ORIENTATION]
        return ends[tolerance]

    def end_of_finer(tolerance):
        """Return the attitude at the end of a finer run, or None if none is within the work."""
        for share in FINER_ONES:
            finer = at_most(share * tolerance)
            try:
                return end(finer) if finer < tolerance else None
            except TooMuchWork:
                continue
        return None

    def at_most(tolerance):
        """Return the coarsest tolerance of the table up to a bound, else its finest."""
        known = [entry['tolerance'] for entry in measured.rows(scene)[method]]
        return max((one for one in known if one <= tolerance * (1.0 + 1e-9)), default=min(known))

    floor, before = measured.floor(scene, horizon), (tolerance, math.inf)
    for _ in range(TRIES):
        here, finer = end(tolerance), end_of_finer(tolerance)
        if finer is None:    # no finer run to compare with: the error is below the last one
            error = before[1]
            break
        error = angle_between(*here, *finer) / part
        error = math.inf if math.isnan(error) else error
        if error <= accuracy:
            break
        if before[1] < math.inf and error > HELPS * before[1]:    # the motion magnifies round-off
            tolerance, error = before
            break
        before = tolerance, error
        tolerance = at_most(tolerance * max(FINER, 0.5 * accuracy / error))
    return method, tolerance, max(error, floor) if error < math.inf else promised


def _span(scene):
    """Return the shortest time (s) in which the body could turn by RADIANS."""
    rate, acceleration = measured.pace(scene), drive(scene, None)
    if acceleration:
        return 2.0 * RADIANS / (rate + math.sqrt(rate * rate + 2.0 * acceleration * RADIANS))
    return RADIANS / rate if rate else math.inf
