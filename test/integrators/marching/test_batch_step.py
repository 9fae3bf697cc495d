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
