# SPDX-License-Identifier: Apache-2.0
"""The parts of a step of eight bodies, each beside its formula, in plain Python."""

import math

import numpy as np
import pytest
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.compilation.lanes import LANES, Plain
from rigid_body_sim.integrators.marching import (
    batch_directions,
    batch_hinge,
    batch_lane,
    batch_step,
    batch_turning,
)
from rigid_body_sim.integrators.marching.taylor_march import GROWTH, UNMOVED
from rigid_body_sim.numerics.rotations import multiply

O = Plain()


def longest(final, before, last, scale, tolerance2=1e-20, form=batch_directions.FORM):
    """Return the step that the last two orders allow, in the eight lanes.

    `final` and `before` are nine coefficients: of the attitude, and of omega.
    """
    table = np.zeros((batch_lane.ROWS, LANES))
    table[batch_lane.STEP] = last
    for order, values in ((form.order, final), (form.order - 1, before)):
        begin = batch_lane.SERIES + batch_lane.UNKNOWNS * order
        table[begin:begin + batch_lane.UNKNOWNS] = np.reshape(values, (-1, 1))
    found = batch_step.longest(
        O, batch_step.Rows(O, table.ravel(), form.order), tolerance2, np.full(LANES, scale), form)
    assert (found == found[0]).all()
    return float(found[0])


def allowed(square, tolerance2=1e-20, order=batch_lane.ORDER):
    return (tolerance2 / square) ** (0.5 / (order - 2))


CASES = [([3e-3] * 6 + [5e-3] * 3, [1e-9] * 9), ([1e-9] * 9, [3e-3] * 6 + [5e-3] * 3),
         ([1e-9] * 6 + [5e-3] * 3, [1e-9] * 9), ([2e-3] + [0.0] * 8, [0.0] * 9),
         ([0.0] * 9, [0.0] * 8 + [2e-3])]


@pytest.mark.parametrize(('final', 'before'), CASES)
@pytest.mark.parametrize('last', [0.5, 2.0])
@pytest.mark.parametrize('scale', [1.0, 100.0])
def test_a_step_is_what_the_larger_of_the_last_two_terms_allows(final, before, last, scale):
    """Each is |e|^2 + |omega|^2/scale; the last one counts as at the step before."""
    def square(values):
        return sum(x * x for x in values[:6]) + sum(x * x for x in values[6:]) / scale
    larger = max(square(final) * last * last, square(before))
    step = min(allowed(larger), GROWTH * last)
    # the power is good to 6 %, and what is allowed is one too
    assert longest(final, before, last, scale) == near(step, rel=0.08)


@pytest.mark.parametrize(('form', 'attitude', 'omega'), [
    (batch_turning.FORM, (0, 1, 2, 3), (6, 7, 8)), (batch_hinge.FORM, (0, 1), (8,))],
    ids=['turning', 'hinge'])
def test_terms_of_other_attitudes_count_several_times_and_what_does_not_move_not_at_all(
        form, attitude, omega):
    final = np.full(9, 1e30)
    final[list(attitude)], final[list(omega)] = 3e-3, 5e-3
    square = form.counts * len(attitude) * 9e-6 + len(omega) * 25e-6 / 4.0
    assert longest(final, [0.0] * 9, 0.5, 4.0, form=form) == near(allowed(square * 0.25), rel=0.08)


def test_a_shorter_series_ends_with_its_own_last_terms():
    form = batch_directions.FORM._replace(order=batch_lane.COARSE)
    final, before = CASES[0]
    square = sum(x * x for x in final[:6]) + sum(x * x for x in final[6:])
    assert longest(final, before, 1.0, 1.0, form=form) == near(
        allowed(square, order=batch_lane.COARSE), rel=0.08)


def test_a_step_grows_by_a_bounded_factor_also_where_all_terms_vanish():
    assert longest([0.0] * 9, [0.0] * 9, 0.25, 1.0) == GROWTH * 0.25


@pytest.mark.filterwarnings('ignore:divide by zero')    # lanes of machine code divide in silence
def test_the_first_step_counts_the_terms_at_one_radian():
    """At a rate of 10 rad/s that is 0.1 s, for a body that does not move 1 ms."""
    final, before = CASES[0]
    at_once = longest(final, before, 0.0, 100.0)
    assert at_once == longest(final, before, 0.1, 100.0)
    assert longest([0.0] * 9, [0.0] * 9, 0.0, 0.0) == GROWTH * UNMOVED


def lanes(values):
    return [np.full(LANES, value) for value in values]


@pytest.mark.parametrize('angle', [(0.3, -0.2, 0.5), (2.0, 1.0, -3.0), (0.0, 0.0, 6.0)])
def test_a_guess_turns_about_the_rotation_vector(angle):
    q = Rotation.from_rotvec([0.4, 1.0, -0.7])
    found = np.array(batch_directions._turned(O, lanes(q.as_quat()), lanes(angle)))[:, 0]
    half = 0.5 * np.linalg.norm(angle)
    turn = [*(np.sin(half) / half * 0.5 * np.array(angle)), np.cos(half)]
    x, y, z, w = turn
    a, b, c, d = q.as_quat()
    expected = [d * x + a * w + b * z - c * y, d * y + b * w + c * x - a * z,
                d * z + c * w + a * y - b * x, d * w - a * x - b * y - c * z]
    # the series of sine and cosine end with the eighth power
    assert found == pytest.approx(expected, abs=2.0 * half ** 10 / math.factorial(10))


@pytest.mark.parametrize('seed', range(6))
@pytest.mark.parametrize('sign', [1.0, -1.0])
def test_an_attitude_is_that_of_its_directions_with_the_sign_of_the_guess(seed, sign):
    q = sign * Rotation.random(random_state=seed).as_quat()
    matrix = Rotation.from_quat(q).as_matrix()
    guess = q + 0.1 * np.random.default_rng(seed).normal(size=4)
    found = batch_directions._attitude(O, lanes([*matrix[0], *matrix[1]]), lanes(guess))
    assert np.array(found)[:, 0] == pytest.approx(q, abs=1e-15)


@pytest.mark.parametrize('q', np.vstack([np.eye(4), -np.eye(4)]).tolist())
def test_an_attitude_of_a_half_turn_has_no_division_by_nothing(q):
    matrix = Rotation.from_quat(q).as_matrix()
    found = batch_directions._attitude(O, lanes([*matrix[0], *matrix[1]]), lanes(q))
    assert np.array(found)[:, 0] == pytest.approx(q, abs=1e-15)


# -- a whole step of eight bodies, beside the equations ------------------------------------------

def law(form, number, y):
    """Return the rates of the unknowns that move; `number` gives the numbers of the equations."""
    def table(first, *shape):
        return np.array([number(first + k) for k in range(math.prod(shape))]).reshape(shape)
    euler, constant, drag = (table(first, *shape) for first, shape in (
        (batch_lane.EULER, (3,)), (batch_lane.CONSTANT, (3,)), (batch_lane.DRAG, (3, 3))))
    dragged = form in (batch_directions.DRAGGED, batch_turning.DRAGGED, batch_hinge.FORM)
    if len(form.moving) == 3:
        x, z, rate = y
        u = table(batch_lane.U, 3, 3)[2]
        return [z * rate, -x * rate, constant[2] + u[0] * x + u[1] * z + drag[2, 2] * rate]
    attitude, w = y[:-3], y[-3:]
    grown = (euler * [w[1] * w[2], w[2] * w[0], w[0] * w[1]] + constant
             + (drag @ w if dragged else 0.0))
    if len(attitude) == 4:
        return [*0.5 * np.array(multiply(*attitude, *w, 0.0)), *grown]
    e1, e2 = attitude[:3], attitude[3:]
    grown = grown + table(batch_lane.U, 3, 3) @ e1 + table(batch_lane.V, 3) * e2
    return [*np.cross(e1, w), *np.cross(e2, w), *grown]


def start_of(form):
    """Return the rows of eight bodies with random numbers, each at a time and rates of its own."""
    draw, module = np.random.default_rng(7), {3: batch_hinge, 7: batch_turning,
                                              9: batch_directions}[len(form.moving)]
    table = np.zeros((batch_lane.ROWS, LANES))
    table[batch_lane.EULER:batch_lane.EULER + 3] = [[-0.3], [0.6], [-0.4]]
    table[batch_lane.CONSTANT:batch_lane.INVERSES] = draw.uniform(-1.0, 1.0, (24, 1))
    table[batch_lane.INVERSES:] = 1.0 / np.arange(1.0, batch_lane.ORDER + 1.0).reshape(-1, 1)
    for lane in range(LANES):
        q, omega = draw.normal(size=4), draw.uniform(-1.0, 1.0, 3)
        if form is batch_hinge.FORM:
            q[:2] = omega[:2] = 0.0
        q /= np.linalg.norm(q)
        table[batch_lane.QUATERNION:batch_lane.SERIES, lane] = q
        table[batch_lane.SERIES:batch_lane.SERIES + batch_lane.UNKNOWNS, lane] = np.concatenate(
            module.unknowns(tuple(q), tuple(omega)))
    table[batch_lane.TIME], table[batch_lane.END] = np.arange(LANES) / 8.0, 1e3
    table[batch_lane.LOST:batch_lane.LOST + batch_lane.UNKNOWNS] = 2.0 ** -60
    return module, table


@pytest.mark.without_numba
@pytest.mark.parametrize('form', [
    batch_directions.FORM, batch_directions.DRAGGED, batch_turning.FORM, batch_turning.DRAGGED,
    batch_hinge.FORM], ids=['directions', 'dragged', 'turning', 'dragged turning', 'hinge'])
def test_a_step_goes_along_the_series_of_the_equations(form):
    """The polynomials of the unknowns have the rates that the equations say, at 0.05 s."""
    order = batch_lane.COARSE
    short, (module, table) = form._replace(order=order), start_of(form)
    begin, W = table.copy(), table.ravel().copy()
    batch_step.advance(O, W, 1e-24, short)
    table = W.reshape(table.shape)
    h = table[batch_lane.STEP]
    assert table[batch_lane.TIME] == near(begin[batch_lane.TIME] + h, rel=1e-15)
    assert 0.05 < h.min() < h.max() < 2.0
    first = batch_lane.UNKNOWNS + batch_lane.SERIES
    higher = table[first:first + order * batch_lane.UNKNOWNS].reshape(order, -1, LANES)
    places = slice(batch_lane.SERIES, batch_lane.SERIES + batch_lane.UNKNOWNS)
    for lane in range(LANES):
        coefficients = np.vstack([begin[places, lane], higher[:, :, lane]])[:, form.moving]
        y = np.polynomial.polynomial.polyval(0.05, coefficients)
        slope = np.polynomial.polynomial.polyval(
            0.05, np.polynomial.polynomial.polyder(coefficients))
        # measured: 4e-16
        assert slope == pytest.approx(
            np.array(law(form, lambda place, lane=lane: begin[place, lane], y)), abs=1e-14)
        end = np.polynomial.polynomial.polyval(h[lane], coefficients)
        moved = table[places, lane][list(form.moving)]
        assert moved == pytest.approx(end, abs=1e-11)    # 1e-12: lengths are made 1 again
        omega = table[batch_lane.SERIES + batch_lane.OMEGA:, lane][:3]
        q = table[batch_lane.QUATERNION:batch_lane.SERIES, lane]
        turned = np.concatenate(module.unknowns(tuple(q), tuple(omega)))[list(form.moving)]
        assert moved == pytest.approx(turned, abs=2e-15)    # 5e-16
        assert table[batch_lane.SOUND, lane] == near(moved @ moved, rel=1e-14)
    before = slice(batch_lane.BEFORE_TIME, batch_lane.END)
    kept = [begin[batch_lane.TIME], *begin[batch_lane.QUATERNION:batch_lane.SERIES],
            *begin[places]]
    moving = [k for k in range(len(kept)) if k < 5 or k - 5 in form.moving]
    assert (table[before][moving] == np.array(kept)[moving]).all()
    # between the points the attitude is that of the same series
    W[LANES * batch_lane.SINCE:LANES * (batch_lane.SINCE + 1)] = 0.3 * h
    batch_step.between(O, W, short)
    for lane in range(LANES):
        found = W.reshape(table.shape)[batch_lane.FOUND:batch_lane.FOUND + 7, lane]
        coefficients = np.vstack([begin[places, lane], higher[:, :, lane]])
        y = np.polynomial.polynomial.polyval(0.3 * h[lane], coefficients)
        turned = np.concatenate(module.unknowns(tuple(found[:4]), tuple(found[4:])))
        assert turned[list(form.moving)] == pytest.approx(y[list(form.moving)], abs=1e-11)
        q = begin[batch_lane.QUATERNION:batch_lane.SERIES, lane]
        assert found[:4] @ q > 0.5    # its sign is the one that is near


@pytest.mark.without_numba
@pytest.mark.parametrize(('room', 'ends'), [(1.05, True), (1.15, False), (0.5, True)])
def test_a_step_that_leaves_less_than_a_tenth_of_itself_goes_to_the_end(room, ends):
    """The lanes end at times of their own."""
    form = batch_hinge.FORM._replace(order=batch_lane.COARSE)
    _, table = start_of(batch_hinge.FORM)
    W = table.ravel().copy()
    batch_step.advance(O, W, 1e-24, form)
    h = W.reshape(table.shape)[batch_lane.STEP].copy()
    table[batch_lane.END] = table[batch_lane.TIME] + room * h
    W = table.ravel().copy()
    batch_step.advance(O, W, 1e-24, form)
    found = W.reshape(table.shape)
    assert found[batch_lane.STEP] == near(room * h if ends else h, rel=1e-14)
    if ends:
        assert (found[batch_lane.TIME] == table[batch_lane.END]).all()


@pytest.mark.without_numba
def test_a_scale_is_the_largest_rate_so_far_or_what_the_torque_gives():
    """Of a body at rest: the root of omega'^2, a squared rate; else the larger of both."""
    form = batch_hinge.FORM._replace(order=batch_lane.COARSE)
    for rate, scale, expected in ((0.0, 0.0, 0.75), (2.0, 0.0, 4.0), (0.5, 9.0, 9.0)):
        table = np.zeros((batch_lane.ROWS, LANES))
        table[[batch_lane.QUATERNION + 3, batch_lane.SERIES]] = 1.0
        table[batch_lane.SERIES + batch_hinge.RATE] = rate
        table[batch_lane.SCALE], table[batch_lane.CONSTANT + 2] = scale, -0.75
        table[batch_lane.INVERSES:] = 1.0 / np.arange(1.0, batch_lane.ORDER + 1.0).reshape(-1, 1)
        table[batch_lane.END] = 1e3
        W = table.ravel()
        batch_step.advance(O, W, 1e-24, form)
        assert (W.reshape(table.shape)[batch_lane.SCALE] == expected).all()
