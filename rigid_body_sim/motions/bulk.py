"""Template of the loops over a motion in closed form: many times from one start, many starts.

Bound to a motion by :func:`rigid_body_sim.specialise.specialise` with the names in ``BINDINGS``. Every state comes from the motion's own
``state`` kernel, so a state has the same bits whether it is asked for alone, among a million, or out of order.
"""

import numpy as np

from rigid_body_sim.compiled import compiled, compiled_parallel, parallel_range
from rigid_body_sim.specialise import UNBOUND

BINDINGS = ('ANCHOR_SIZE', 'anchor', 'state')

ANCHOR_SIZE = UNBOUND
anchor = UNBOUND
state = UNBOUND


@compiled
def states(anchored, times, out):
    """Fill out, shape (n, 14), with the states at n times, in any order, of a motion anchored before."""
    for k in range(len(times)):
        state(anchored, times[k], out[k])


@compiled_parallel
def ensemble(parameters, starts, times, out):
    """Fill out, shape (bodies, n, 14), with the states at n times of many bodies, on all cores.

    Parameters
    ----------
    parameters : array (bodies, PARAMETER_SIZE) or (1, PARAMETER_SIZE)
        One row a body, or one for all.
    starts : array (bodies, 14)
        Each with its own time.
    times : array (n,)
    """
    stride = 0 if len(parameters) == 1 else 1
    for body in parallel_range(len(starts)):
        anchored = np.empty(ANCHOR_SIZE)
        anchor(parameters[stride * body], starts[body], anchored)
        for k in range(len(times)):
            state(anchored, times[k], out[body, k])
