"""Template of the loops over a motion in closed form: many times from one start, many starts.

Bound to a motion by rigid_body_sim/motions/exact.py. A state has the same bits whether it is asked for alone, among a million, or out of order:
either every state comes from the motion's kernel `state`, or the motion has its own kernel `states` of the same operations in the same order.
"""

import numpy as np

from rigid_body_sim.compiled import compiled, compiled_allocating
from rigid_body_sim.specialise import UNBOUND

BINDINGS = ('ANCHOR_SIZE', 'anchor', 'state', 'states')
ONE_BY_ONE = 'states = one_by_one\n'     # binding of `states` for a motion that has none of its own

ANCHOR_SIZE = UNBOUND
anchor = UNBOUND
state = UNBOUND


@compiled
def one_by_one(anchored, times, out):
    """Fill out, shape (n, 14), with the states at n times, in any order, of a motion anchored before."""
    for k in range(len(times)):
        state(anchored, times[k], out[k])


states = UNBOUND


@compiled_allocating
def ensemble(parameters, starts, times, out):
    """Fill out, shape (bodies, n, 14), with the states at n times of many bodies.

    Parameters
    ----------
    parameters : array (bodies, PARAMETER_SIZE) or (1, PARAMETER_SIZE)
        One row a body, or one for all.
    starts : array (bodies, 14)
        Each with its own time.
    times : array (n,)
    """
    stride = 0 if len(parameters) == 1 else 1
    anchored = np.empty(ANCHOR_SIZE)
    for body in range(len(starts)):
        anchor(parameters[stride * body], starts[body], anchored)
        states(anchored, times, out[body])
