# SPDX-License-Identifier: Apache-2.0
"""Template: states at any times along a march, with checkpoints.

The points of a march depend on its start only. Every `stride`-th point is kept; when the store is
full, every other one is dropped and the stride doubles, so an earlier time costs a restart from
the checkpoint before it. A state between two points is one step of the method from the earlier
one: it is as accurate as the points, continuous, and does not depend on which times were asked.

A piece is one array, because numba takes a quarter of a microsecond for each that it is handed:
parameters, control, point, following point of the method, [kept points, stride, steps made], kept
points. Its beginning, up to the point, is copied from a prototype.
"""

import math

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.marching.points import LOST, PAUSED, REACHED, STEP, TIME
from rigid_body_sim.numerics.vectors import dot
from rigid_body_sim.scene.state import STATE

start = UNBOUND
begin = UNBOUND
march = UNBOUND
between = UNBOUND
arrive = UNBOUND
write = UNBOUND
VALUES = UNBOUND
# places in a piece
CONTROL = UNBOUND
POINT = UNBOUND
FOLLOWING = UNBOUND
COUNTS = UNBOUND

STORED, STRIDE, COUNT, STORE = 0, 1, 2, 3    # after COUNTS
CHECKPOINTS = 128                   # number of points that are kept
SPACING = 32                        # stride at first: every n-th point is kept
# numba compiles a function once more where a constant is handed to it, but not for int(constant)
AT_ONCE = 64                        # steps of a call from Python that asks for a state: no more
                                    # than work.DOUBLED, or Doublings would not see them
IN_ONE_CALL = 8192                  # steps of a call that asks for a final state
MOST_TURNS = 1e15                   # rad, of a final state: then somebody else says what is wrong
load_state = STATE.load


@compiled
def _copy(source, target):
    # an assignment of slices would compile numba's own error texts, for seconds
    for k in range(len(source)):
        target[k] = source[k]


@compiled
def _copy_point(source, target):
    for k in range(FOLLOWING - POINT):
        target[k] = source[k]


@compiled
def first_piece(prototype, vector, piece):
    """Fill a piece at its start, a state vector."""
    _copy(prototype, piece)
    piece[POINT + TIME] = load_state(vector).time
    start(piece[:CONTROL], vector, piece, POINT + VALUES)
    opened(piece)


@compiled
def opened(piece):
    """Complete a piece whose parameters, control, and first time and unknowns are set."""
    begin(piece[:CONTROL], piece[CONTROL:POINT], piece[POINT:FOLLOWING])
    _copy_point(piece[POINT:], piece[FOLLOWING:])
    _copy_point(piece[POINT:], piece[COUNTS + STORE:])
    piece[COUNTS + STORED], piece[COUNTS + STRIDE], piece[COUNTS + COUNT] = 1.0, SPACING, 0.0


@compiled
def follow(piece, target, end, limit):
    """Bring the point to the last one not later than `target`, in at most `limit` steps.

    Return LOST, REACHED or PAUSED; a march that pauses goes on at the next call, to the same bits.
    """
    p, control, point, following = (
        piece[:CONTROL],
        piece[CONTROL:POINT],
        piece[POINT:FOLLOWING],
        piece[FOLLOWING:COUNTS],
    )
    counts, store, length = piece[COUNTS:COUNTS + STORE], piece[COUNTS + STORE:], FOLLOWING - POINT
    if target < point[TIME]:
        low, high = 0, int(counts[STORED]) - 1
        while low < high:
            middle = (low + high + 1) // 2
            if store[length * middle + TIME] <= target:
                low = middle
            else:
                high = middle - 1
        _copy_point(store[length * low:], point)
        following[TIME] = point[TIME]
        counts[COUNT] = low * counts[STRIDE]
    while True:
        stride = int(counts[STRIDE])
        until_checkpoint = stride - int(counts[COUNT]) % stride
        most = min(until_checkpoint, limit)
        moved, good = march(p, control, point, following, target, end, most)
        counts[COUNT] += moved
        limit -= moved
        if not good:
            return LOST
        if moved < most:
            return REACHED
        if counts[COUNT] == counts[STORED] * counts[STRIDE]:
            if counts[STORED] == CHECKPOINTS:
                for k in range(CHECKPOINTS // 2):
                    _copy_point(store[2 * length * k:], store[length * k:])
                counts[STORED], counts[STRIDE] = CHECKPOINTS // 2, 2.0 * counts[STRIDE]
            if counts[COUNT] == counts[STORED] * counts[STRIDE]:
                _copy_point(point, store[length * int(counts[STORED]):])
                counts[STORED] += 1.0
        if limit == 0:
            return PAUSED


@compiled
def _within(piece, time, out):
    """Fill `out` with the state at a time within the present step of a piece."""
    p, point = piece[:CONTROL], piece[POINT:FOLLOWING]
    y = between(p, piece[CONTROL:POINT], point, piece[FOLLOWING:COUNTS], time - point[TIME])
    write(p, time, y, out)


@compiled
def state(piece, time, end, out):
    """Fill out with the state at a time if the march reaches it; return what `follow` returns."""
    status = REACHED
    if not piece[POINT + TIME] <= time < piece[FOLLOWING + TIME]:
        status = follow(piece, time, end, int(AT_ONCE))
    if status == REACHED:
        _within(piece, time, out)
    return status


@compiled
def first_state(prototype, vector, piece, time, end, out):
    """Fill a piece at its start, and out as `state` does: one call from Python."""
    first_piece(prototype, vector, piece)
    return state(piece, time, end, out)


@compiled
def in_steps(room, vector, time, out):
    """Fill out with the state at a time after a start, in one call; return as `follow` does.

    LOST also stands for a time that cannot be reached from the start, or not without a breakpoint,
    and for a start so slow that it may be an unstable one (growing.py).

    Parameters
    ----------
    room : array
        A prototype, with the time from which on what acts is constant in place of that of its
        point, and with the square of the slowest |omega| in place of its step; and a piece, which
        is filled anew.
    """
    if not _can_be_reached(room, vector, time):
        return LOST
    piece = room[FOLLOWING:]
    first_piece(room[:FOLLOWING], vector, piece)
    status = follow(piece, time, math.inf, int(IN_ONE_CALL))
    if status == REACHED:
        _within(piece, time, out)
    return status


@compiled
def without_points(room, vector, time, out):
    """Fill out as `in_steps` does, to the same bits, by a march that keeps no points.

    It works in the control of the prototype.
    """
    if not _can_be_reached(room, vector, time):
        return LOST
    piece = room[FOLLOWING:]
    p, point = piece[:CONTROL], piece[POINT:FOLLOWING]
    _copy(room[:CONTROL], p)
    start(p, vector, piece, POINT + VALUES)
    point[TIME] = load_state(vector).time
    status, y = arrive(p, room[CONTROL:POINT], point, time, int(IN_ONE_CALL))
    if status == REACHED:
        write(p, time, y, out)
    return status


@compiled
def _can_be_reached(room, vector, time):
    """Return whether doubles count the turns until a time, and one march alone leads there."""
    start_time, omega = load_state(vector).time, load_state(vector).angular_velocity
    square = dot(omega, omega)
    turns = (time - start_time) * math.sqrt(square)
    alone = start_time >= room[POINT + TIME] and square >= room[POINT + STEP]
    return alone and time >= start_time and turns < MOST_TURNS


final = UNBOUND


@compiled
def states(piece, times, order, end, out):
    """Fill row order[i] of out with the state at times[order[i]], times rising in that order.

    Return how many rows were filled: fewer than asked where one takes more than AT_ONCE steps.
    """
    point, following = piece[POINT:FOLLOWING], piece[FOLLOWING:COUNTS]
    for i in range(len(order)):
        k = order[i]
        within = point[TIME] <= times[k] < following[TIME]
        if not within and follow(piece, times[k], end, int(AT_ONCE)) != REACHED:
            return i
        _within(piece, times[k], out[k])
    return len(order)
