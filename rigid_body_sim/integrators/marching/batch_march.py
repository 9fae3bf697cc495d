# SPDX-License-Identifier: Apache-2.0
"""Template: march of many bodies, eight at a time; one that arrives gives its lane to the next.

Bound are the step, what is between two points and the unknowns of a Form (batch_step.py).
"""

import math

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.lanes import LANES
from rigid_body_sim.compilation.layout import layout
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.equations.euler import read_state
from rigid_body_sim.integrators.equations.falling import write
from rigid_body_sim.integrators.marching.batch_lane import (
    Lane,
    Point,
    Unknowns,
)
from rigid_body_sim.numerics.rotations import multiply
from rigid_body_sim.scene.state import TIME as STATE_TIME

advance = UNBOUND
between = UNBOUND
unknowns = UNBOUND

# a lane is a column of W: its numbers stand LANES places apart
COLUMN = layout(Lane, LANES)
POINT, BEFORE = COLUMN.part('point'), COLUMN.part('before')
store_point, load_found = POINT.store, COLUMN.part('found').load
load_sound = COLUMN.part('sound').load
load_time, load_before = POINT.part('time').load, BEFORE.part('time').load
load_q, load_omega = POINT.part('q').load, POINT.part('y').part('omega').load
store_end, store_since = COLUMN.part('end').store, COLUMN.part('since').store
NONE_LOST = Unknowns((0.0, 0.0, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0))

NOBODY, ANYBODY = -1, -2    # no number of a body: none has failed; the march has paused
# in `seats`: which body sits in a lane, and the place of its next time; which body is next, how
# many sit, and whether a lane may be free
BODY, NEXT, WAITING, BUSY, FREE = 0, LANES, 2 * LANES, 2 * LANES + 1, 2 * LANES + 2
SEATS = 2 * LANES + 3


@compiled
def empty(seats):
    """Set the seats as they are before the first call of `march`."""
    for lane in range(len(seats)):
        seats[lane] = NOBODY if lane < LANES else 0
    seats[FREE] = 1


@compiled
def march(W, p, turn, tolerance, seats, states, times, order, first, last, end, out, rounds):
    """Fill out with the states at times[order[first]] ... times[order[last - 1]], rising.

    Return (NOBODY, 0.0) or who failed, and when; (ANYBODY, 0.0) after so many rounds of steps:
    the next call with the same W and seats goes on. More than eight arguments: compiled code is
    handed arrays and scalars, and one call marches all bodies. More than forty lines: seats are
    counted in local variables.

    Parameters
    ----------
    W : array
        Rows of lanes (batch_lane.py), the numbers of the equations set.
    p : array (LANES, ...)
        Parameters (euler.py), a row for each lane.
    turn : tuple of 4 floats
        Quaternion that turns the directions of the unknowns to the world's axes.
    tolerance : float
        For a second.
    seats : int array (SEATS,)
    states : array (bodies, 14)
        Where the bodies are. With a finite `end` they are brought there, those that are not beyond
        it.
    out : array (bodies, n, 14)
    """
    target = end if end < math.inf else times[order[last - 1]]
    following, busy, free = seats[WAITING], seats[BUSY], seats[FREE] == 1
    lanes = len(p)    # LANES, but the compiler shall not unroll the loops
    for _ in range(rounds):
        if free:
            for lane in range(lanes):
                while following < len(states) and states[following, STATE_TIME] > target:
                    following += 1
                if seats[BODY + lane] == NOBODY and following < len(states):
                    _seat(W, p[lane], turn, lane, states[following], target)
                    seats[BODY + lane], seats[NEXT + lane] = following, first
                    following, busy = following + 1, busy + 1
        if busy == 0:
            return NOBODY, 0.0
        advance(W, (tolerance * tolerance,))
        free = due = False
        for lane in range(lanes):
            body, t, t1 = (
                seats[BODY + lane],
                load_before(W, lane),
                load_time(W, lane),
            )
            if body != NOBODY:
                if not ((t1 > t or t >= target) and load_sound(W, lane) < math.inf):
                    return body, t
                free |= t1 >= target
                due |= seats[NEXT + lane] < last and times[order[seats[NEXT + lane]]] <= t1
        if due:
            _give(W, p, turn, seats, times, order, last, out)
        if free:
            for lane in range(lanes):
                body = seats[BODY + lane]
                if body != NOBODY and load_time(W, lane) >= target:
                    if end < math.inf:
                        _write(p[lane], turn, load_q(W, lane), load_omega(W, lane), end,
                               states[body])
                    seats[BODY + lane], busy = NOBODY, busy - 1
    seats[WAITING], seats[BUSY], seats[FREE] = following, busy, 1 if free else 0
    return ANYBODY, 0.0


@compiled
def _seat(W, p, turn, lane, state, target):
    """Put a body into a lane."""
    q, omega, _, _ = read_state(p, state)
    x, y, z, w = turn
    q = multiply(-x, -y, -z, w, *q)
    store_point(
        W, Point(state[STATE_TIME], 0.0, 0.0, NONE_LOST, q, unknowns(q, omega)), lane)
    store_end(W, target, lane)


@compiled
def _write(p, turn, q, omega, time, out):
    """Write the state at a time from quaternion and omega of a lane."""
    write(p, time, (*multiply(*turn, *q), *omega), out)


@compiled
def _give(W, p, turn, seats, times, order, last, out):
    """Write the states at all times within the step: of each lane one time in turn.

    At the end of a step the state is that of the point itself.
    """
    due = True
    while due:
        due = among = False
        for lane in range(len(p)):
            store_since(W, 0.0, lane)
            body = seats[BODY + lane]
            if body != NOBODY and seats[NEXT + lane] < last:
                k, begin, end = (order[seats[NEXT + lane]], load_before(W, lane),
                                 load_time(W, lane))
                if times[k] < end:
                    store_since(W, times[k] - begin, lane)
                    due = among = True
                elif times[k] == end:
                    _write(p[lane], turn, load_q(W, lane), load_omega(W, lane), end, out[body, k])
                    seats[NEXT + lane] += 1
                    due = True
        if among:
            between(W, ())
            for lane in range(len(p)):
                body = seats[BODY + lane]
                if body != NOBODY and seats[NEXT + lane] < last:
                    k = order[seats[NEXT + lane]]
                    if times[k] < load_time(W, lane):
                        found = load_found(W, lane)
                        _write(p[lane], turn, found.q, found.omega, times[k], out[body, k])
                        seats[NEXT + lane] += 1
