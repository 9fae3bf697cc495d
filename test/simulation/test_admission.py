# SPDX-License-Identifier: Apache-2.0
"""Which commands of a tick a body takes, and what they amount to, beside hand calculations."""

import math
from fractions import Fraction

import numpy as np
import pytest
from near import near

from rigid_body_sim.errors import NotConverged
from rigid_body_sim.mechanics.impulse import WORK
from rigid_body_sim.mechanics.parameters import parameters
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation import admission
from rigid_body_sim.simulation.admission import (
    LARGEST_TURN,
    NOT_FINITE,
    NOT_SOLVABLE,
    TAKEN,
    TOO_FAST,
    TOO_MUCH_WORK,
    Given,
)
from rigid_body_sim.simulation.command_rows import HOLD, IMPULSE, LET_GO, row_of

pytestmark = pytest.mark.without_numba
RATE = 1000.0    # ticks/s
MOMENTS = 2.0, 3.0, 4.0


def body(moments=MOMENTS, **initial):
    """Return the scene of a free body of 2 kg."""
    return parse_scene(f'scene: a\nbody: {{mass: 2, inertia: {list(moments)}}}\nconstraint: free\n'
                       f'effects: []\ninitial: {initial}\n')


def impulse(force=(0, 0, 0), torque=(0, 0, 0), frame='world'):
    return row_of(IMPULSE, force, torque, frame)


def hold(force=(0, 0, 0), torque=(0, 0, 0), frame='world'):
    return row_of(HOLD, force, torque, frame)


def turned(q, v):
    """Return R v exactly, for a quaternion of any norm."""
    *u, w = map(Fraction, q)
    square, along = sum(x * x for x in u), sum(x * y for x, y in zip(u, v, strict=True))
    side = np.cross(u, v).tolist()
    return [((w * w - square) * v[k] + 2 * along * u[k] + 2 * w * side[k]) / (w * w + square)
            for k in range(3)]


def admitted(scene, *rows, given=None):
    """Return (Given, verdicts, amounts, row of the last hold or release, number of refused)."""
    given, rows = given or Given.at(scene.initial.vector), np.concatenate(rows)
    verdicts, amounts = np.full(len(rows), 9), np.full(len(rows), 9.0)
    last, refused = admission.admit(parameters(scene), RATE, rows, *given, verdicts, amounts)
    return given, verdicts.tolist(), amounts.tolist(), last, refused


def test_impulses_of_a_tick_are_added_and_the_body_goes_on_from_their_sum():
    """Delta v = J/m and delta w = K/I; the work goes with the mean of before and after."""
    scene = body(velocity=[1, 0, 0], angular_velocity=[0, 0, 3])
    given, verdicts, amounts, last, refused = admitted(
        scene, impulse((4, 0, 0), (0, 0, 1)), hold((5, 6, 7)), impulse((2, -2, 0), (0, 0, 1)),
        LET_GO)
    assert (verdicts, amounts, last, refused) == ([TAKEN] * 4, [0.0] * 4, 3, 0)
    assert given.sums.tolist() == [6, -2, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0]
    assert given.start.tolist() == scene.initial.vector.tolist()
    assert given.after[5:8].tolist() == [0.0, 0.0, 3.5]
    assert given.after[11:14].tolist() == [4.0, -1.0, 0.0]
    assert given.response[WORK] == 6 * 2.5 + -2 * -0.5 + 2 * 3.25
    assert given.any_impulse
    # those of a later call add to them
    again = admitted(scene, impulse((0, 2, 0)), given=given.copy())[0]
    assert again.after[11:14].tolist() == [4.0, 0.0, 0.0] and again.sums[1] == 0.0
    assert given.sums[1] == -2.0    # a copy has its own arrays


@pytest.mark.parametrize('frame', ['world', 'body'])
def test_opposite_impulses_cancel_to_the_last_bit_and_others_add_up_exactly(frame):
    scene = body(orientation=[0.5, -0.5, 0.1, 0.7], angular_velocity=[0.1, 0.2, 0.3])
    some = [((0.1, 1e9, -3.3), (7e-9, 0.7, 1.1)), ((0.2, -0.3, 1e-3), (1e5, 0.1, -0.9))]
    back = [tuple(tuple(-x for x in part) for part in one) for one in some]
    # components of a body turn by rounded numbers: only neighbours cancel wholly
    order = (*some, *back) if frame == 'world' else (some[0], back[0], some[1], back[1])
    given = admitted(scene, *(impulse(*one, frame) for one in order))[0]
    assert not given.any_impulse
    assert given.after.tolist() == scene.initial.vector.tolist()
    assert not given.response.any()
    given = admitted(scene, *(impulse(*one, frame) for one in some))[0]
    assert given.any_impulse
    for place in (0, 1):
        total = [sum(Fraction(one[place][k]) for one in some) for k in range(3)]
        if frame == 'body':
            total = turned(scene.initial.orientation, total)
        rounded, lost = given.sums[6 * place:][:3], given.sums[6 * place + 3:][:3]
        for one, rest, expected in zip(rounded.tolist(), lost.tolist(), total, strict=True):
            assert abs(Fraction(one) + Fraction(rest) - expected) <= 1e-30 * max(map(abs, total))


@pytest.mark.parametrize('axis', range(3))
@pytest.mark.parametrize(('share', 'verdict'), [(0.999999, TAKEN), (1.000001, TOO_FAST)])
def test_a_wrench_may_turn_the_body_by_so_much_within_a_tick(axis, share, verdict):
    """From rest, a torque T held for a tick gives the rate T/(I f), and the turn T/(I f^2)."""
    torque = np.zeros(3)
    torque[axis] = -share * LARGEST_TURN * MOMENTS[axis] * RATE ** 2
    given, verdicts, amounts, last, refused = admitted(body(), hold(torque=torque))
    assert verdicts == [verdict]
    assert amounts == [near(share * LARGEST_TURN, rel=1e-12) if verdict else 0.0]
    assert (last, refused) == ((-1, 1) if verdict else (0, 0))
    assert not given.any_impulse and given.after.tolist() == body().initial.vector.tolist()
    # as an impulse, or where nothing is held any more, any rate will do
    assert admitted(body(), impulse(torque=torque))[1] == [TAKEN]
    rates = (np.array(torque) / MOMENTS / RATE).tolist()
    spun = body(angular_velocity=rates)
    assert admitted(spun, LET_GO, hold(), hold((1e-9, 0, 0)))[1] == [TAKEN, TAKEN, verdict]


@pytest.mark.parametrize(('rows', 'verdict', 'amount'), [
    (impulse((0, 2.1e125, 0)), TOO_MUCH_WORK, 2.1e125 ** 2 / 4),
    (impulse((0, 1.9e125, 0)), TAKEN, 0.0),
    (impulse(torque=(0, 0, 2.9e125)), TOO_MUCH_WORK, 2.9e125 ** 2 / 8),
    (hold((2.1e128, 0, 0)), TOO_MUCH_WORK, 2.1e125 ** 2 / 4),
    (hold((0, 2.1e128, 0)), TOO_MUCH_WORK, 2.1e125 ** 2 / 4),
    (hold((0, 0, 2.1e128)), TOO_MUCH_WORK, 2.1e125 ** 2 / 4), (hold((0, 0, 1.9e128)), TAKEN, 0.0),
    (impulse((1e200, 0, 0)), TOO_MUCH_WORK, math.inf),
    (impulse((0, math.nan, 0)), NOT_FINITE, 0.0), (hold((0, 0, math.inf)), NOT_FINITE, 0.0),
    (impulse(torque=(-math.inf, 0, 0)), NOT_FINITE, 0.0)])
def test_the_work_of_a_command_is_a_double_that_leaves_room(rows, verdict, amount):
    """J^2/(2 m) and K^2/(2 I), of a wrench within a tick; what is refused changes nothing."""
    one = impulse((2, 0, 0))
    given, verdicts, amounts, _, refused = admitted(body(), one, rows, one)
    assert verdicts == [TAKEN, verdict, TAKEN]
    assert amounts == [0.0, amount if math.isinf(amount) else near(amount, rel=1e-14), 0.0]
    assert refused == (verdict != TAKEN)
    assert given.sums[0] == 4.0
    if verdict != TAKEN:
        assert given.after[11:14].tolist() == [2.0, 0.0, 0.0]


@pytest.mark.parametrize('push', [2.0, -2.0])
def test_at_most_so_much_work_and_turn_is_taken_and_no_more(push, monkeypatch):
    """2 N s do J^2/(2 m) = 1 J; a torque of 3 f^2 N m about an axis of 3 kg m^2 turns by 1 rad."""
    monkeypatch.setattr(admission, 'LARGEST_WORK', 1.0)
    assert admitted(body(), impulse((push, 0, 0)))[1] == [TAKEN]
    assert admitted(body(), impulse((push * (1.0 + 1e-15), 0, 0)))[1] == [TOO_MUCH_WORK]
    monkeypatch.setattr(admission, 'LARGEST_WORK', 1e9)
    monkeypatch.setattr(admission, 'LARGEST_TURN', 1.0)
    most = 0.5 * push * 3.0 * RATE ** 2
    assert admitted(body(), hold(torque=(0, most, 0)))[1] == [TAKEN]
    assert admitted(body(), hold(torque=(0, most * (1.0 + 1e-15), 0)))[1] == [TOO_FAST]


@pytest.mark.parametrize('axis', range(3))
def test_an_axis_without_moment_takes_no_torque_of_any_command_alone(axis):
    moments, along, across = [1, 1, 1], [0, 0, 0], [0, 0, 0]
    moments[axis], along[axis], across[axis - 1] = 0, 1e-9, 1
    given, verdicts, _, last, refused = admitted(
        body(moments), impulse(torque=along), impulse(torque=across), hold(torque=along),
        hold(along), impulse(torque=np.negative(along)))
    assert verdicts == [NOT_SOLVABLE, TAKEN, NOT_SOLVABLE, TAKEN, NOT_SOLVABLE]
    assert (last, refused) == (3, 3)
    assert given.sums[6:9].tolist() == across


@pytest.mark.parametrize(('verdict', 'amount', 'words'), [
    (NOT_FINITE, 0.0, 'got force [0.0, 0.0, 0.0], torque [1.0, -2.0, 3.0]'),
    (TOO_MUCH_WORK, 4e250, 'torque [3.0, 1.0, -2.0] would do a work of 4e+250 J; at most 1e+250'),
    (NOT_SOLVABLE, 0.0, 'torque [3.0, 1.0, -2.0] (world axes)'),
    (TOO_FAST, 2e7, 'turn the body by 2e+07 rad within a tick; at most 1e+07 rad')])
def test_a_refusal_names_the_row_and_what_is_wrong_in_world_axes(verdict, amount, words):
    """The start turns x to y, y to z and z to x."""
    start = np.zeros(14)
    start[1:5] = 0.5
    rows = np.concatenate([LET_GO, hold(torque=(1, -2, 3), frame='body')])
    refusal, = admission.refusals(np.array([TAKEN, verdict]), np.array([0.0, amount]), rows, start)
    assert (refusal.place, refusal.reason) == (1, admission.REASONS[verdict])
    assert str(refusal.error).startswith('wrench: ') and words in str(refusal.error)


def test_refusals_of_a_scene_and_of_a_motion_that_would_end():
    assert [(one.place, one.reason) for one in admission.scene_refuses('b', 3)] == [
        (k, 'the scene refuses commands') for k in range(3)]
    one = admission.no_motion_follows(hold((1, 0, 0))[0], NotConverged('too fast'))
    assert (one.place, one.reason) == (0, 'the body cannot take it')
    assert str(one.error).startswith('wrench: no motion follows it: too fast')
