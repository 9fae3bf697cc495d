"""What the table of measurements promises, tried on the scene itself: a motion may magnify errors, which no table knows.

The choice is run from the scene's start, and so is the same method with a tolerance a thousand times finer; what lies between the two is the
error of the choice. Where it is too large, the tolerance is made finer by as much, until that helps no more.
"""

import math

import numpy as np

from rigid_body_sim.choice import measured
from rigid_body_sim.errors import NotConverged
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.mechanics.bounds import drive
from rigid_body_sim.numerics.rotations import angle_between
from rigid_body_sim.scene.state import ORIENTATION, STATE_SIZE

RADIANS = 2e4
"""Turned over in a run of a trial, at most: some 10 ms."""
FINER, TRIES, HELPS = 1e-3, 5, 0.7


def settle(scene, able, accuracy, horizon):
    """Return (method, tolerance, expected error in rad) that meets an accuracy on this scene, else the most accurate one of the table.

    Parameters as of :func:`rigid_body_sim.choice.measured.pick`; of a long horizon the trial runs a part, and errors are taken to grow
    with time.
    """
    method, tolerance, promised = measured.pick(scene, able, accuracy, horizon)
    part, ends = min(1.0, _span(scene) / horizon), {}
    if not part > 0.0:
        return method, tolerance, promised

    def end(tolerance):
        """Return where it gets to."""
        if tolerance not in ends:
            out = np.empty(STATE_SIZE)
            try:
                Stepped(scene, method, tolerance, horizon=horizon).start(scene.initial.vector).state(part * horizon, out)
            except NotConverged:
                out[:] = math.nan
            ends[tolerance] = out[ORIENTATION]
        return ends[tolerance]

    def at_most(tolerance):
        """Return the coarsest tolerance of the table that is at most so much, or its finest."""
        known = [entry['tolerance'] for entry in measured.rows(scene)[method]]
        return max((one for one in known if one <= tolerance * (1.0 + 1e-9)), default=min(known))

    floor, before = measured.floor(scene, horizon), (tolerance, math.inf)
    for _ in range(TRIES):
        finer = at_most(FINER * tolerance)
        if finer == tolerance:    # nothing to hold it against: at least it is better than the one before
            error = before[1]
            break
        error = angle_between(*end(tolerance), *end(finer)) / part
        error = math.inf if math.isnan(error) else error
        if error <= accuracy:
            break
        if before[1] < math.inf and error > HELPS * before[1]:    # it is round-off that is magnified
            tolerance, error = before
            break
        before = tolerance, error
        tolerance = at_most(tolerance * max(FINER, 0.5 * accuracy / error))
    return method, tolerance, max(error, floor) if error < math.inf else promised


def _span(scene):
    """Return how long the body takes at least to turn by RADIANS (s): rate and acceleration are bounds."""
    rate, acceleration = measured.pace(scene), drive(scene, None)
    if acceleration:
        return 2.0 * RADIANS / (rate + math.sqrt(rate * rate + 2.0 * acceleration * RADIANS))
    return RADIANS / rate if rate else math.inf
