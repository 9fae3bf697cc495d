# SPDX-License-Identifier: Apache-2.0
"""Runs of a scene with its strikes, by a method that is prepared for it."""

import math

import numpy as np

from rigid_body_sim.errors import NotConverged
from rigid_body_sim.integrators.marching.work import TooMuchWork
from rigid_body_sim.mechanics import impulse
from rigid_body_sim.mechanics.ledger import ENTRIES_SIZE
from rigid_body_sim.mechanics.parameters import parameters
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.scene.state import ANGULAR_VELOCITY, STATE_SIZE

LOOKS = 64    # times at which runs are compared
QUARTER = LOOKS // 4
EARLIER = 0.5    # largest part of the time between two looks by which one is earlier than evenly
GOLDEN = 0.6180339887498949    # the golden ratio less one, whose multiples are near no fraction


def looks(time):
    """Return the times (s) up to one at which runs are compared, shape (LOOKS,).

    A motion that repeats itself as often as even looks would be seen at the same place each time,
    perhaps where it turns back and an error in time does not show. Each look but the last of a
    quarter is earlier than that, by parts that never repeat.
    """
    k = np.arange(1, LOOKS + 1)
    earlier = np.where(k % QUARTER, EARLIER * (k * GOLDEN % 1.0), 0.0)
    return time * ((k - earlier) / LOOKS)


def run(scene, prototype, vector, times, allowances=None, over=-math.inf):
    """Return the states at rising times (s), shape (n, 14), with the strikes of the scene.

    They are NaN where the run did not converge.

    Parameters
    ----------
    prototype : Solver
    vector : array (14,)
        The start.
    allowances : list, optional
        What solvers have allowed themselves (Solver.allowance) is appended to it.
    over : float, optional
        Time up to which strikes are over, s.

    Raises
    ------
    TooMuchWork
    """
    out, first, final = np.full((len(times), STATE_SIZE), math.nan), 0, float(times[-1])
    try:
        for solver, end in _solvers(scene, prototype, vector, final, over):
            last = len(times) if end == math.inf else int(np.searchsorted(times, end))
            solver.states(times[first:last], out[first:last])
            first, found = last, solver.allowance(min(end, final))
            if found and allowances is not None:
                allowances.append(found)
    except TooMuchWork:
        raise
    except NotConverged:
        out[:] = math.nan
    return out


def step_ends(scene, prototype, vector, until, most):
    """Return the times (s) before another at which the steps of a run end, rising.

    None stands for more than `most` of them, and for a run that did not converge.

    Raises
    ------
    TooMuchWork
    """
    found = []
    try:
        for solver, end in _solvers(scene, prototype, vector, until):
            ends = solver.step_ends(min(end, until), most - len(found))
            if ends is None:
                return None
            found += ends
    except TooMuchWork:
        raise
    except NotConverged:
        return None
    return found


def _solvers(scene, prototype, vector, until, over=-math.inf):
    """Yield the solvers up to a time (s), started one after the other; each with its end, s.

    A strike ends all but the last one, whose end is infinite.
    """
    solver = prototype.start(vector)
    for strike in scene.strikes:
        if over < strike.time <= until:
            yield solver, strike.time
            solver = prototype.start(_struck(scene, strike, solver))
    yield solver, math.inf


def _struck(scene, strike, solver):
    """Return the state just after a strike."""
    vector = np.empty(STATE_SIZE)
    solver.state(max(strike.time, 0.0), vector)
    return _pushed(scene, strike, vector)


def _pushed(scene, strike, vector):
    impulse.push(parameters(scene), vector, *strike.as_impulse(scene.body, vector),
                 np.zeros(ENTRIES_SIZE))
    return vector


def struck_rate(scene):
    """Return approximately what the strikes of a scene add to the rate of its body (rad/s)."""
    total, start = 0.0, scene.initial.vector
    for strike in scene.strikes:
        after = _pushed(scene, strike, start.copy())[ANGULAR_VELOCITY]
        total += hypot3(*(after - start[ANGULAR_VELOCITY]).tolist())
    return total
