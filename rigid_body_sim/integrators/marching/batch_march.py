# SPDX-License-Identifier: Apache-2.0
"""Template: march of many bodies, eight at a time; one that arrives gives its lane to the next."""

import math

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.lanes import LANES
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.equations.euler import read_state
from rigid_body_sim.integrators.equations.falling import write
from rigid_body_sim.integrators.marching.batch_series import (
    END,
    FOLLOWING,
    FOUND,
    OMEGA,
    POINT_SIZE,
    QUATERNION,
    SERIES,
    SINCE,
    SOUND,
    TIME,
    between,
)
from rigid_body_sim.numerics.rotations import multiply, rotate_back

advance = UNBOUND

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
        Rows of lanes (batch_series.py), the numbers of the equations set.
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
                while following < len(states) and states[following, 0] > target:
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
                W[LANES * TIME + lane],
                W[LANES * (FOLLOWING + TIME) + lane],
            )
            if body != NOBODY:
                if not ((t1 > t or t >= target) and W[LANES * SOUND + lane] < math.inf):
                    return body, t
                free |= t1 >= target
                due |= seats[NEXT + lane] < last and times[order[seats[NEXT + lane]]] <= t1
        if due:
            _give(W, p, turn, seats, times, order, last, out)
        for k in range(LANES * POINT_SIZE):
            W[k] = W[LANES * FOLLOWING + k]
        if free:
            for lane in range(lanes):
                body = seats[BODY + lane]
                if body != NOBODY and W[LANES * TIME + lane] >= target:
                    if end < math.inf:
                        _write(W, p[lane], turn, lane, QUATERNION, OMEGA, end, states[body])
                    seats[BODY + lane], busy = NOBODY, busy - 1
    seats[WAITING], seats[BUSY], seats[FREE] = following, busy, 1 if free else 0
    return ANYBODY, 0.0


@compiled
def _seat(W, p, turn, lane, state, target):
    """Put a body into a lane."""
    for place in range(POINT_SIZE):
        W[LANES * place + lane] = 0.0
    q, w, _, _ = read_state(p, state)
    q = multiply(-turn[0], -turn[1], -turn[2], turn[3], q[0], q[1], q[2], q[3])
    y = (
        *rotate_back(q[0], q[1], q[2], q[3], 1.0, 0.0, 0.0),
        *rotate_back(q[0], q[1], q[2], q[3], 0.0, 1.0, 0.0),
        *w,
    )
    W[LANES * TIME + lane], W[LANES * END + lane] = state[0], target
    for k in range(4):
        W[LANES * (QUATERNION + k) + lane] = q[k]
    for k in range(9):
        W[LANES * (SERIES + k) + lane] = y[k]


@compiled
def _write(W, p, turn, lane, quaternion, omega, time, out):
    """Write the state at a time; its quaternion and omega stand in the rows from two places on."""
    a, b = LANES * quaternion + lane, LANES * omega + lane
    q = multiply(
        turn[0], turn[1], turn[2], turn[3], W[a], W[a + LANES], W[a + 2 * LANES], W[a + 3 * LANES]
    )
    write(p, time, (*q, W[b], W[b + LANES], W[b + 2 * LANES]), out)


@compiled
def _give(W, p, turn, seats, times, order, last, out):
    """Write the states at all times within the step: of each lane one time in turn."""
    due = True
    while due:
        due = False
        for lane in range(len(p)):
            W[LANES * SINCE + lane] = 0.0
            if seats[BODY + lane] != NOBODY and seats[NEXT + lane] < last:
                time = times[order[seats[NEXT + lane]]]
                if time <= W[LANES * (FOLLOWING + TIME) + lane]:
                    W[LANES * SINCE + lane], due = time - W[LANES * TIME + lane], True
        if due:
            between(W, ())
            for lane in range(len(p)):
                if seats[BODY + lane] != NOBODY and seats[NEXT + lane] < last:
                    k = order[seats[NEXT + lane]]
                    if times[k] <= W[LANES * (FOLLOWING + TIME) + lane]:
                        _write(
                            W,
                            p[lane],
                            turn,
                            lane,
                            FOUND,
                            FOUND + 4,
                            times[k],
                            out[seats[BODY + lane], k],
                        )
                        seats[NEXT + lane] += 1
