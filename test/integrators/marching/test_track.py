# SPDX-License-Identifier: Apache-2.0
"""States at any times along a made-up march: its n-th point stands at n s, whose unknown is n.

What its restarts cost is known too: every n-th point is kept, n = 32 at first and twice as many
each time that 128 are kept.
"""

import functools
import math

import numpy as np
import pytest

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.integrators.marching import track
from rigid_body_sim.integrators.marching.points import (
    LOST,
    PAUSED,
    REACHED,
    STEP,
    TIME,
    VALUES,
    onward,
)
from rigid_body_sim.scene.state import STATE_SIZE

pytestmark = pytest.mark.without_numba

LENGTH = VALUES + 1
POINT, FOLLOWING, COUNTS = 2, 2 + LENGTH, 2 + 2 * LENGTH
STORE = COUNTS + track.STORE
SIZE = STORE + track.CHECKPOINTS * LENGTH
# a piece: [the time after which no step is good], [steps made in all], points
MARCH = f"""
def march(p, control, point, following, target, end, most):
    moved = 0
    while moved < most and point[{TIME}] + 1.0 <= min(target, end):
        if point[{TIME}] >= p[0]:
            return moved, False
        for place in ({TIME}, {VALUES}):
            point[place] += 1.0
        moved += 1
    following[{TIME}] = point[{TIME}] + 1.0
    control[0] += moved
    return moved, True
"""
TRACK = specialise(
    track, march=MARCH, CONTROL='CONTROL = 1\n', POINT=f'POINT = {POINT}\n',
    FOLLOWING=f'FOLLOWING = {FOLLOWING}\n', COUNTS=f'COUNTS = {COUNTS}\n',
    VALUES=f'VALUES = {VALUES}\n',
    start='def start(p, vector, piece, place):\n    piece[place] = vector[8]\n',
    begin=f'def begin(p, control, point):\n    point[{STEP}] = 0.5\n',
    between=f'def between(p, control, point, following, dt):\n    return point[{VALUES}], dt\n',
    write='def write(p, time, y, out):\n    out[0], (out[1], out[2]) = time, y\n',
    arrive='arrive = None\n', final='final = in_steps\n')


def prototype(good=math.inf):
    """Return the beginning of a piece whose steps are good up to a time."""
    return np.array([good, 0.0, *np.zeros(LENGTH)])


def piece_at_start(begin=0.0, good=math.inf):
    """Return a piece at its start, with the number of the point in place of an unknown."""
    vector, piece = np.zeros(STATE_SIZE), np.full(SIZE, math.nan)
    vector[0] = vector[8] = begin
    TRACK.first_piece(prototype(good), vector, piece)
    return piece


@functools.cache
def far():
    """Return a piece after 20,000 steps."""
    piece = piece_at_start()
    TRACK.follow(piece, 20000.0, math.inf, 10 ** 6)
    return piece


def known(time):
    """Return what `write` makes of a state."""
    return [time, math.floor(time), time - math.floor(time)]


@pytest.mark.parametrize(('reached', 'stride', 'kept'), [
    (0, 32, 1), (31, 32, 1), (32, 32, 2), (4095, 32, 128), (4096, 64, 65), (8191, 64, 128),
    (20000, 256, 79)])
def test_every_so_many_points_are_kept(reached, stride, kept):
    piece = piece_at_start()
    assert TRACK.follow(piece, reached + 0.5, math.inf, 10 ** 6) == REACHED
    assert piece[POINT + TIME] == piece[POINT + VALUES] == piece[1] == reached
    assert TRACK.follow(piece, float(reached), math.inf, 10 ** 6) == REACHED    # it stands there
    assert piece[1] == reached
    assert piece[COUNTS:STORE].tolist() == [kept, stride, reached]
    store = piece[STORE:].reshape(-1, LENGTH)[:kept]
    assert store[:, VALUES].tolist() == store[:, TIME].tolist() == [
        float(stride * k) for k in range(kept)]
    assert (store[:, STEP] == 0.5).all()


@pytest.mark.parametrize(('time', 'steps'), [
    (9984.0, 0), (9983.9, 255), (10000.5, 16), (0.0, 0), (0.5, 0), (255.5, 255), (256.0, 0),
    (19968.0, 0), (19967.9, 255), (19999.9, 31)])
def test_an_earlier_time_costs_a_restart_from_the_point_kept_before_it(time, steps):
    """Of 20,000 points every 256th is kept; the march back is the same as the march there."""
    piece = far().copy()
    store, made = piece[STORE:].copy(), piece[1]
    assert TRACK.follow(piece, time, math.inf, 10 ** 6) == REACHED
    assert piece[1] - made == steps
    assert piece[POINT + VALUES] == piece[COUNTS + 2] == math.floor(time)
    assert piece[FOLLOWING + TIME] == math.floor(time) + 1.0
    assert TRACK.follow(piece, time + 300.0, math.inf, 10 ** 6) == REACHED
    assert piece[STORE:][:79 * LENGTH].tobytes() == store[:79 * LENGTH].tobytes()


@pytest.mark.parametrize('limit', [1, 31, 32, 33, 40, 100])
def test_a_march_in_slices_keeps_the_same_points(limit):
    piece, whole, calls = piece_at_start(), piece_at_start(), 0
    TRACK.follow(whole, 199.5, math.inf, 10 ** 6)
    while TRACK.follow(piece, 199.5, math.inf, limit) == PAUSED:
        calls += 1
        assert piece[COUNTS + 2] == calls * limit
    assert calls == 199 // limit
    assert piece[1] == 199.0
    assert piece[:STORE + 7 * LENGTH].tobytes() == whole[:STORE + 7 * LENGTH].tobytes()


def test_a_march_that_is_lost_says_so_and_where():
    piece = piece_at_start(good=70.0)
    assert TRACK.follow(piece, 70.5, math.inf, 1000) == REACHED
    assert TRACK.follow(piece, 71.5, math.inf, 1000) == LOST
    assert piece[POINT + TIME] == piece[COUNTS + 2] == 70.0


@pytest.mark.parametrize('end', [math.inf, 10.0])
def test_a_state_within_the_step_costs_nothing_and_none_is_later_than_the_end(end):
    piece, out = piece_at_start(), np.zeros(3)
    for time in (3.25, 3.75, 3.0, 7.5, 8.0, 4.5):    # a step ends before its end
        assert TRACK.state(piece, time, end, out) == REACHED
        assert out.tolist() == known(time)
    made = piece[1]
    assert made == 8 + 4    # back from the start, to the fourth point
    for time in (4.0, 4.999):
        assert TRACK.state(piece, time, end, out) == REACHED
    assert piece[1] == made
    assert TRACK.state(piece, 20.0, end, out) == REACHED
    assert piece[POINT + TIME] == min(20.0, end)


def test_a_call_that_asks_for_a_state_makes_so_many_steps_and_no_more():
    """It leaves `out` as it is where they do not lead there."""
    ahead = track.AT_ONCE
    for begin in (False, True):
        out, piece, vector = np.full(3, 7.0), np.empty(SIZE), np.zeros(STATE_SIZE)
        if begin:
            asked = (prototype(), vector, piece, ahead + 0.5, math.inf, out)
            assert TRACK.first_state(*asked) == PAUSED
        else:
            TRACK.first_piece(prototype(), vector, piece)
            assert TRACK.state(piece, ahead + 0.5, math.inf, out) == PAUSED
        assert out.tolist() == [7.0] * 3
        assert piece[1] == ahead
        assert TRACK.first_state(prototype(), vector, piece, ahead - 0.5, math.inf, out) == REACHED
        assert out.tolist() == known(ahead - 0.5)


def test_states_in_an_order_are_filled_up_to_the_first_that_is_far():
    times, out = np.array([9.5, 0.25, 0.5, 500.0, 9.0, 501.0]), np.full((6, 3), -1.0)
    piece, order = piece_at_start(), np.argsort(times)
    assert TRACK.states(piece, times, order, math.inf, out) == 4
    for time, row in zip(times, out, strict=True):
        assert row.tolist() == (known(time) if time < 100.0 else [-1.0] * 3)
    assert piece[1] == 9 + track.AT_ONCE    # those within a step cost nothing
    out[:] = -1.0
    assert TRACK.states(piece, times, order[:4], math.inf, out) == 4    # from its start again
    assert out[order[:4]].tolist() == [known(time) for time in times[order[:4]]]


@pytest.mark.parametrize(('begin', 'time', 'omega', 'expected'), [
    (2.0, 5.5, 1.0, REACHED), (2.0, 2.0, 1.0, REACHED), (1.5, 1.5, 1.0, REACHED),
    (2.0, 1.9, 1.0, LOST), (1.4, 3.0, 1.0, LOST),          # before the start, a breakpoint
    (2.0, 3.0, 0.199e15, REACHED), (2.0, 3.0, 0.201e15, LOST),    # five times as many rad/s
    (2.0, 7.0, 0.0399e15, REACHED), (2.0, 7.0, 0.0401e15, LOST),
    (2.0, track.IN_ONE_CALL + 1.5, 1.0, REACHED), (2.0, track.IN_ONE_CALL + 2.5, 1.0, PAUSED)])
def test_a_final_state_is_reached_in_one_call_or_left_to_others(begin, time, omega, expected):
    """What acts is constant from 1.5 s on."""
    room, vector, out = np.full(FOLLOWING + SIZE, math.nan), np.zeros(STATE_SIZE), np.zeros(3)
    room[:FOLLOWING] = prototype()
    room[POINT + TIME] = 1.5
    vector[0], vector[5:8], vector[8] = begin, (0.0, 3.0 * omega, -4.0 * omega), begin
    for _ in range(2):    # the room is filled anew
        assert TRACK.final(room, vector, time, out) == expected
        if expected == REACHED:
            whole = math.floor(time - begin)
            assert out.tolist() == [time, begin + whole, time - (begin + whole)]
    assert room[POINT + TIME] == 1.5


@pytest.mark.parametrize(('following', 'target', 'expected'), [
    (2.0, 2.5, 1), (2.0, 2.0, 1), (2.0, 1.5, -1), (1.0, 2.5, 0), (0.5, 0.7, 0), (0.5, 2.5, 0)])
def test_a_point_moves_on_to_one_that_is_known_and_not_after_the_target(
        following, target, expected):
    point, after = np.arange(1.0, 8.0), np.arange(8.0, 15.0)
    point[TIME], after[TIME] = 1.0, following
    kept = after.copy() if expected == 1 else point.copy()
    assert onward(point, after, target) == expected
    assert point.tobytes() == kept.tobytes()
