# SPDX-License-Identifier: Apache-2.0
"""Template of the loops over a motion in closed form: many times from one start, many starts.

solver.py binds it to a motion. A state has the same bits whether it is asked for alone, among a
million, or out of order: either every state comes from the motion's kernel `state`, or the motion
has a kernel `fill_columns` of the same operations in the same order.
"""

import math

import numpy as np

from rigid_body_sim.compilation.jit import compiled, compiled_allocating
from rigid_body_sim.compilation.layout import layout
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.scene.state import STATE, STATE_SIZE, StateView

BINDINGS = ('ANCHOR_SIZE', 'anchor', 'state')
# bindings of `fill_columns` and `states`: for a motion without a `fill_columns`, and with one
ONE_BY_ONE = {'fill_columns': 'fill_columns = None\n', 'states': 'states = one_by_one\n'}
IN_COLUMNS = {'fill_columns': '{}:fill_columns', 'states': 'states = in_columns\n'}
BLOCK = 128         # states that are computed side by side
FEW = 8             # below that they are taken one by one

load_state = STATE.load
COLUMNS = layout(StateView, BLOCK)    # one for each number of a state

ANCHOR_SIZE = UNBOUND
anchor = UNBOUND
state = UNBOUND
fill_columns = UNBOUND


@compiled
def final(room, start, time, out):
    """Fill out, shape (14,), with the state at a time from a start; return whether it is one.

    `room` holds an anchor, which is filled anew, and then the parameters. Going back, a motion may
    grow beyond what doubles hold.
    """
    anchor(room[ANCHOR_SIZE:], start, room[:ANCHOR_SIZE])
    state(room[:ANCHOR_SIZE], time, out)
    if time < load_state(start).time:
        for k in range(STATE_SIZE):
            if not abs(out[k]) < math.inf:
                return False
    return True


@compiled
def one_by_one(anchored, times, out):
    """Fill out, shape (n, 14), with the states of an anchored motion at n times, in any order."""
    for k in range(len(times)):
        state(anchored, times[k], out[k])


@compiled_allocating
def in_columns(anchored, times, out):
    """Fill out as `one_by_one` does, many times side by side."""
    if len(times) < FEW:
        one_by_one(anchored, times, out)
        return
    columns = np.empty(STATE_SIZE * BLOCK)
    for first in range(0, len(times), BLOCK):
        count = min(BLOCK, len(times) - first)
        fill_columns(anchored, times[first:first + count], columns)
        # not by COLUMNS.load: as a loop over the columns it takes 5 % less time a state
        for k in range(count):
            for j in range(STATE_SIZE):
                out[first + k, j] = columns[j * BLOCK + k]


states = UNBOUND


@compiled_allocating
def ensemble(parameters, starts, times, out):
    """Fill out, shape (bodies, n, 14), with the states at n times of many bodies.

    Parameters
    ----------
    parameters : array (bodies, PARAMETER_SIZE) or (1, PARAMETER_SIZE)
        One row per body, or one for all.
    starts : array (bodies, 14)
        Each with its own time.
    times : array (n,)
    """
    stride = 0 if len(parameters) == 1 else 1
    anchored = np.empty(ANCHOR_SIZE)
    for body in range(len(starts)):
        anchor(parameters[stride * body], starts[body], anchored)
        states(anchored, times, out[body])
