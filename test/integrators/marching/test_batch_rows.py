# SPDX-License-Identifier: Apache-2.0
"""The numbers of the equations in the lanes of a batch, beside the laws that they stand for."""

import math
import types

import numpy as np
import pytest
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.compilation.lanes import LANES
from rigid_body_sim.integrators.equations import euler
from rigid_body_sim.integrators.equations.series import COUNT, SERIES
from rigid_body_sim.integrators.marching import batch, batch_lane
from rigid_body_sim.integrators.marching.batch_march import ANYBODY, NOBODY, SEATS

pytestmark = pytest.mark.without_numba

UNIT = np.eye(3)


@pytest.mark.parametrize(('force', 'couple', 'second'), [
    ((0.0, 0.0, -9.0), (0.0, 2.0, 1.0), (0.0, 1.0, 0.0)),
    ((0.0, 3.0, 4.0), (-2.0, 0.0, 0.0), (-1.0, 0.0, 0.0)),
    ((0.0, 0.0, 0.0), (0.0, 0.0, 5.0), (1.0, 0.0, 0.0)),
    ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
    ((0.0, -2.0, 0.0), (0.0, 7.0, 5e-3), (1.0, 0.0, 0.0)),       # a couple almost along the force
    ((0.0, -2.0, 0.0), (0.0, 7.0, 8e-3), (0.0, 0.0, 1.0)),       # and one that is not
    ((0.0, 2.0, 0.0), (0.0, 0.0, 1e-9), (0.0, 0.0, 1.0)),
    ((2.0, 1.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)), ((1.0, 2.0, 3.0), (0.0,) * 3, None)])
def test_the_first_direction_lies_along_the_force_and_the_second_in_the_plane_of_the_couple(
        force, couple, second):
    """A couple along the force, to a thousandth, leaves the axis that is farthest from it."""
    rows = np.array(batch.directions(force, couple))
    along = np.array(force) if any(force) else np.array(couple) if any(couple) else UNIT[0]
    if second is None:
        second = (13.0, -2.0, -3.0) / np.sqrt(182.0)    # of x, what is across (1, 2, 3)
    # measured: 1e-16
    assert rows[0] == pytest.approx(along / np.linalg.norm(along), abs=4e-16)
    assert rows[1] == pytest.approx(np.array(second), abs=4e-16)
    assert rows[2] == pytest.approx(np.cross(rows[0], rows[1]), abs=4e-16)


def parameters(moments, axes=(0.0, 0.0, 0.0, 1.0), **values):
    """Return the parameters of a body in its frame, whose axes lie so in the body."""
    p = np.zeros(COUNT)
    euler.EQUATION.part('inverse').store(p, tuple(1.0 / I if I else 0.0 for I in moments))
    a, b, c = moments
    euler.EQUATION.part('euler').store(
        p, ((b - c) / a, (c - a) / b, (a - b) / c) if a else (0.0, 0.0, 0.0))
    euler.BODY.part('frame_axes').store(p, axes)
    for name, value in values.items():
        SERIES.part(name).store(p, value)
    return p


def rate(table, e1, e2, omega, lane):
    """Return omega' by the rows of a lane, batch_directions.py has how."""
    own = np.array([omega[1] * omega[2], omega[2] * omega[0], omega[0] * omega[1]])

    def part(first, *shape):
        return table[first:first + math.prod(shape), lane].reshape(shape)
    return (part(batch_lane.EULER, 3) * own + part(batch_lane.CONSTANT, 3)
            + part(batch_lane.U, 3, 3) @ e1 + part(batch_lane.V, 3) * e2
            + part(batch_lane.DRAG, 3, 3) @ omega)


def test_the_rows_of_a_free_turn_are_those_of_euler():
    """I omega' = (I omega) x omega + body torque + arm x force + couple + drag."""
    I, arm, q = np.array([2.0, 3.0, 4.5]), np.array([0.3, -0.5, 0.7]), Rotation.random(
        random_state=2)
    force, couple = np.array([1.0, -2.0, 3.0]), np.array([-0.4, 0.9, 0.2])
    constant, omega = np.array([0.1, 0.2, -0.3]), np.array([1.5, -2.5, 0.7])
    drag = np.array([[-0.1, 0.02, 0.03], [0.04, -0.2, 0.05], [0.06, 0.07, -0.3]])
    (ix, iy, iz), (rx, ry, rz) = 1.0 / I, arm
    p = parameters(I.tolist(), force=tuple(force.tolist()), couple=tuple(couple.tolist()),
                   constant=tuple(constant.tolist()), drag=tuple(map(tuple, drag.tolist())),
                   pull=(ix * -rz, ix * ry, iy * -rx, iy * rz, iz * -ry, iz * rx))
    rows, table = batch.rows_for(p, None)
    e1, e2, _ = q.inv().apply(rows)
    expected = (np.cross(I * omega, omega) + np.cross(arm, q.inv().apply(force))
                + q.inv().apply(couple)) / I + constant + drag @ omega
    for lane in (0, LANES - 1):
        # measured: 2e-16
        assert rate(table, e1, e2, omega, lane) == pytest.approx(expected, abs=2e-15)
        assert table[batch_lane.INVERSES:, lane] == near(
            [1.0 / n for n in range(1, batch_lane.ORDER + 1)], rel=0.0)
    assert table.shape == (batch_lane.ROWS, LANES)


@pytest.mark.parametrize('angle', [0.0, 0.4, -2.0])
def test_the_rows_of_a_hinge_are_the_moment_about_it(angle):
    """I3 omega3' = n (arm x force + couple) + body torque + drag, n the third axis of the frame.

    The first direction, where the angle is 0, is the first axis of the frame.
    """
    zero, axes = Rotation.random(random_state=5), Rotation.random(random_state=6)
    arm, force, couple = np.array([0.3, -0.5, 0.7]), np.array([1.0, -2.0, 3.0]), np.array(
        [-0.4, 0.9, 0.2])
    i3, (rx, ry, _) = 1.0 / 2.5, arm
    p = parameters((0.0, 0.0, 2.5), axes=tuple(axes.as_quat().tolist()),
                   force=tuple(force.tolist()), couple=tuple(couple.tolist()),
                   constant=(0.0, 0.0, 0.3), pull=(0.0, 0.0, 0.0, 0.0, i3 * -ry, i3 * rx))
    rows, table = batch.rows_for(p, types.SimpleNamespace(zero=tuple(zero.as_quat().tolist())))
    frame = zero * axes * Rotation.from_rotvec([0.0, 0.0, angle])
    assert np.array(rows) == pytest.approx((zero * axes).as_matrix().T, abs=2e-15)    # 7e-16
    e1 = frame.inv().apply(rows[0])
    assert e1 == pytest.approx([math.cos(angle), -math.sin(angle), 0.0], abs=2e-15)
    moment = np.cross(arm, frame.inv().apply(force)) + frame.inv().apply(couple)
    found = rate(table, e1, np.ones(3), np.array([0.0, 0.0, 2.0]), 3)
    # measured: 2e-16
    assert found == pytest.approx([0.0, 0.0, i3 * moment[2] + 0.3], abs=2e-15)


@pytest.mark.parametrize(('breakpoints', 'stretches'), [
    ((), [(-math.inf, 0, 4, math.inf)]),
    ((0.5, 2.0, 9.0), [(-math.inf, 0, 1, 0.5), (0.5, 1, 2, 2.0), (2.0, 2, 4, math.inf)]),
    ((3.0,), [(-math.inf, 0, 3, 3.0), (3.0, 3, 4, math.inf)]),
    ((0.0, 0.1), [(-math.inf, 0, 0, 0.0), (0.0, 0, 1, 0.1), (0.1, 1, 4, math.inf)])])
def test_times_are_shared_out_to_the_stretches_between_breakpoints(breakpoints, stretches):
    """The times are 0, 1, 2 and 3 s: a breakpoint begins its stretch; none begins after them."""
    equations = types.SimpleNamespace(
        hinged=False, pushed=True, coupled=False, dragged=False, breakpoints=breakpoints)
    made = batch.Batch(equations, 1e-9, np.array([3.0, 0.0, 2.0, 1.0]))
    assert made._order.tolist() == [1, 3, 2, 0]
    assert made._stretches == stretches


def test_the_rows_begin_with_a_line_of_the_cache():
    table = np.arange(3.0 * LANES).reshape(3, LANES)
    for _ in range(8):
        copy = batch._on_lines(table)
        assert copy.ctypes.data % 64 == 0
        assert copy.tolist() == table.ravel().tolist()
        assert not np.shares_memory(copy, table)


INF = math.inf
OVER, EMPTY, LAST = (-INF, 0, 0, 0.5), (0.5, 0, 0, 2.0), (2.0, 0, 3, INF)


@pytest.mark.parametrize(('starts', 'answers', 'found', 'marched'), [
    ((0.0, 0.0), [NOBODY] * 3, None, [OVER, EMPTY, LAST]),
    ((1.0, 0.5), [NOBODY] * 2, None, [EMPTY, LAST]),       # the first stretch is over by then
    ((2.0, 3.0), [ANYBODY, ANYBODY, NOBODY], None, [LAST] * 3),
    ((1.0, 0.0), [NOBODY, 1, NOBODY], (1, 7.0), [OVER, EMPTY]),
    ((1.0, 0.0), [0, NOBODY], (0, 7.0), [OVER]), ((), [NOBODY], None, [LAST])])
def test_bodies_go_through_the_stretches_that_are_not_over_until_one_fails(
        starts, answers, found, marched):
    """A march that pauses goes on with the same numbers; the next stretch has its own."""
    answers, seen, numbers, out = iter(answers), [], {}, np.zeros((len(starts), 3, 14))

    def march(W, p, turn, tolerance, seats, states, times, order, first, last, end, given, rounds):
        begin = W[0]
        assert seats.tolist() == [5] * SEATS
        assert (p.tolist(), turn, tolerance) == ([begin], 'turn', 1e-9)
        assert rounds >= batch.ROUNDS
        assert numbers.setdefault(begin, W) is W
        assert states.tolist() == state.tolist() and states is not state and given is out
        assert (times, order) == ('times', 'order')
        seen.append((begin, first, last, end))
        return next(answers), 7.0
    made = object.__new__(batch.Batch)
    made._stretches, made._tolerance, made._times, made._order = (
        [OVER, EMPTY, LAST], 1e-9, 'times', 'order')
    made._numbers_from = lambda begin: (np.full((2, LANES), begin), np.array([begin]), 'turn')
    made._kernels = types.SimpleNamespace(march=march, empty=lambda seats: seats.fill(5))
    state = np.zeros((len(starts), 14))
    state[:, 0] = starts
    assert made.run(state, out) == found
    assert seen == marched


def test_the_numbers_of_a_stretch_are_those_that_hold_from_its_beginning():
    """The turn takes the directions to the world's axes; the numbers are made once."""
    held = []

    def numbers(time):
        held.append(time)
        return parameters((2.0, 3.0, 4.5), force=(0.0, 2.0, 0.0), couple=(1.0, 0.0, 0.0))
    made = object.__new__(batch.Batch)
    made._numbers, made._equations = {}, types.SimpleNamespace(
        held=numbers, frame=types.SimpleNamespace(hinge=None))
    table, p, turn = made._numbers_from(2.5)
    assert made._numbers_from(2.5)[0] is table
    assert held == [2.5]
    assert p.shape == (LANES, COUNT)
    assert (p == numbers(2.5)).all()
    assert Rotation.from_quat(turn).apply(UNIT) == pytest.approx(
        np.array(batch.directions((0.0, 2.0, 0.0), (1.0, 0.0, 0.0))), abs=4e-16)


@pytest.mark.parametrize(('kind', 'form', 'dragged'), [
    ({'pushed': True}, 'directions', '_with_drag'),
    ({'coupled': True}, 'directions', '_with_drag'),
    ({}, 'turning', '_with_drag'), ({'hinged': True, 'pushed': True}, 'hinge', '')])
@pytest.mark.parametrize(('tolerance', 'coarse'), [
    (batch.COARSE_FROM, 'coarse_'), (0.99 * batch.COARSE_FROM, '')])
def test_each_kind_of_equations_has_its_kernels(
        kind, form, dragged, tolerance, coarse, monkeypatch):
    """A hinge takes its drag always; what nothing of the world turns needs no directions."""
    made = {}
    monkeypatch.setattr(batch, 'specialise', lambda template, **names: made.update(names))
    for drag in (True, False):
        equations = types.SimpleNamespace(**{
            'hinged': False, 'pushed': False, 'coupled': False, 'breakpoints': ()} | kind,
            dragged=drag)
        batch.Batch(equations, tolerance, np.array([1.0]))
        module = f'rigid_body_sim.integrators.marching.batch_{form}'
        assert made == {'advance': f'{module}:{coarse}advance{dragged if drag else ""}',
                        'between': f'{module}:{coarse}between', 'unknowns': f'{module}:unknowns'}
