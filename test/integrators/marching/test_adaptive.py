# SPDX-License-Identifier: Apache-2.0
"""How a march chooses its steps, on made-up errors: C h^8 of a step h of a method of order 8.

With the allowed error e h the best step is (e/C)^(1/7), and 0.9 times it is planned.
"""

import math

import numpy as np
import pytest
from near import near

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.integrators.marching import adaptive, unroll
from rigid_body_sim.integrators.marching.points import (
    LEAST_ERROR,
    SCALES,
    STEP,
    TIME,
    TOLERANCE,
    VALUES,
)

pytestmark = pytest.mark.without_numba

# p: C, a constant error, the step above which errors are no numbers, the first squared scale
TRIAL = """
def trial(p, w, y, c, k0, h, scales):
    tried.append(h)
    error = w[0] * (p[0] * h ** 8 + p[1]) if h <= p[2] else math.nan if p[2] > 0.0 else math.inf
    return (y[0] + k0[0] * h,), c, (p[3], 1.0), error
tried = []
"""
MARCH = specialise(
    adaptive, trial=TRIAL, SIZE='SIZE = 1\n', ORDER='ORDER = 8\n', FLIGHT='FLIGHT = ()\n',
    load=unroll.load_source('load', 1), put=unroll.put_source('put', 1),
    load_scales=unroll.load_source('load_scales', 2),
    put_scales=unroll.put_source('put_scales', 2), rate='def rate(p, y):\n    return (1.0,)\n',
    settled='def settled(y, c):\n    return y, (c[0] + 1.0,)\n',    # counts the steps
    fastest='def fastest(y, k):\n    return y[0]\n',
    balanced='def balanced(moving, scales, k):\n    return 0.0, (moving, *scales[1:])\n')


def start(planned, tolerance=1e-7, C=1.0, error=0.0, most=math.inf, square=0.0, rounding=0.0):
    """Return (p, control, point, following) of a march at its start."""
    control, point = np.zeros(MARCH.WEIGHTS + 1), np.zeros(VALUES + 2)
    control[TOLERANCE], control[MARCH.ROUNDING], point[STEP] = tolerance, rounding, planned
    control[MARCH.WEIGHTS] = 1.0
    MARCH.tried.clear()
    return np.array([C, error, most, square]), control, point, point.copy()


@pytest.mark.parametrize(('speed', 'planned'), [(5.0, 0.02), (0.5, 0.2), (0.0, 0.01)])
def test_the_first_step_is_short_beside_the_fastest_rate(speed, planned):
    """The eighth root of 1e-8, over a rate; of a body that rests over 10/s."""
    p, control, point, _ = start(0.0, tolerance=1e-8)
    point[VALUES], point[SCALES:SCALES + 2], control[MARCH.MOVING] = speed, (2.0, 3.0), 7.0
    MARCH.begin(p, control, point)
    # what acts on a body that is let go is no scale
    assert (control[MARCH.MOVING], *point[SCALES:SCALES + 2]) == (0.0, 7.0, 3.0)
    assert point[STEP] == near(planned, rel=1e-14)    # 2e-16


@pytest.mark.parametrize(('planned', 'tried', 'after'), [
    (0.05, [0.05], 0.09), (0.01, [0.01], 0.04), (0.0999, [0.0999], 0.09),
    (0.1001, [0.1001, 0.09], 0.09), (0.2, [0.2, 0.09], 0.09), (2.0, [2.0, 0.2, 0.09], 0.09)])
def test_a_step_that_errs_too_much_is_tried_anew(planned, tried, after):
    """None grows by more than 4, or shrinks to less than 0.1 at a time."""
    of = start(planned)
    point = of[2]
    assert MARCH.march(*of, target=1.001 * tried[-1], end=math.inf, limit=1) == (1, True)
    assert MARCH.tried[:len(tried)] == near(tried, rel=1e-13)    # 3e-16
    assert point[TIME] == point[VALUES] == near(tried[-1], rel=1e-13)
    assert point[STEP] == near(after, rel=1e-13)
    assert point[VALUES + 1] == 1.0


@pytest.mark.parametrize(('square', 'rounding', 'allowed'), [
    (4.0, 2e-5, 1e-5), (0.0, 2e-5, 1e-7), (4.0, 1e-9, 1e-7), (0.25, 1e-5, 2e-5)])
def test_no_step_is_asked_to_resolve_the_rounding_of_its_rates(square, rounding, allowed):
    """It is that of the rates of the first group over its scale, where that is known."""
    of = start(0.08, square=square, rounding=rounding)
    MARCH.march(*of, target=0.0, end=math.inf, limit=9)
    best = allowed ** (1.0 / 7.0)
    assert of[3][TIME] == 0.08
    assert of[3][STEP] == near(0.9 * best, rel=1e-13)


@pytest.mark.parametrize(('error', 'moved'), [(1.0, 1), (1.01, 0)])
def test_an_error_of_rounding_is_allowed_however_short_the_step(error, moved):
    of = start(1e-3, tolerance=1e-30, C=0.0, error=error * LEAST_ERROR)
    assert MARCH.march(*of, target=1e-3, end=math.inf, limit=9)[0] == moved


@pytest.mark.parametrize(('settings', 'tried', 'after'), [
    ({'C': 0.0}, [0.05], 0.2),                        # no error is seen
    ({'C': 1e-7}, [0.05], 0.2), ({'most': 0.001}, [0.05, 0.005, 0.0005], 0.002)])
def test_where_no_error_is_seen_steps_grow_and_where_it_is_no_number_they_shrink(
        settings, tried, after):
    of = start(0.05, **settings)
    assert MARCH.march(*of, target=0.0, end=math.inf, limit=9) == (0, True)
    assert MARCH.tried == near(tried, rel=1e-13)
    assert of[3][STEP] == near(after, rel=1e-13)


@pytest.mark.parametrize('most', [0.0, 1e-300])
def test_a_step_that_is_refused_again_and_again_is_given_up(most):
    """Its errors are infinite, or no numbers: the next point is not known."""
    of = start(0.05, most=most)
    assert MARCH.march(*of, target=1.0, end=math.inf, limit=9) == (0, False)
    assert len(MARCH.tried) == MARCH.TRIALS
    assert of[2][TIME] == of[3][TIME] == 0.0


def test_a_step_that_does_not_move_the_time_is_none():
    """Its error is none, but nothing would ever come after it."""
    of = start(1e-30)
    of[2][TIME] = of[3][TIME] = 1.0
    assert MARCH.march(*of, target=2.0, end=math.inf, limit=9) == (0, False)


@pytest.mark.parametrize(('end', 'times'), [
    (0.0985, [0.0985]), (0.0995, [0.09, 0.0995]), (0.09, [0.09]), (0.2, [0.09, 0.18, 0.2])])
def test_the_last_step_ends_at_the_end_and_may_be_a_tenth_longer(end, times):
    of = start(0.09)    # 0.09 is what is planned again
    for time in times:
        assert MARCH.march(*of, target=time, end=end, limit=1)[0] == 1
        assert of[2][TIME] == near(time, rel=1e-13)
    assert of[2][TIME] == end
    assert MARCH.march(*of, target=1.0, end=end, limit=9) == (0, True)


def test_a_step_ahead_is_made_once_and_kept_until_the_target_is_past_it():
    of = start(0.09)
    point, following = of[2:]
    assert MARCH.march(*of, target=0.05, end=math.inf, limit=9) == (0, True)
    assert (point[TIME], following[TIME]) == (0.0, 0.09)
    assert MARCH.march(*of, target=0.08, end=math.inf, limit=9) == (0, True)
    assert MARCH.tried == [0.09]
    assert MARCH.march(*of, target=0.3, end=math.inf, limit=9) == (3, True)
    assert point[TIME] == near(0.27, rel=1e-13)
    assert following[TIME] == near(0.36, rel=1e-13)
    assert (point[VALUES + 1], following[VALUES + 1]) == (3.0, 4.0)
    assert MARCH.march(*of, target=9.0, end=math.inf, limit=2) == (2, True)
    assert len(MARCH.tried) == 6
    assert following[SCALES] == 0.0


@pytest.mark.parametrize('dt', [0.0, 0.04, -0.04])
def test_a_state_between_points_is_one_step_of_the_method(dt):
    of = start(0.09)
    of[2][VALUES] = 5.0
    assert MARCH.between(*of, dt) == (5.0 + max(dt, 0.0),)
