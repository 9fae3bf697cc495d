# SPDX-License-Identifier: Apache-2.0
"""A march with steps of one size, on made-up rates: y' = 1, so y is the sum of the steps made."""

import math

import numpy as np
import pytest

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.integrators.marching import fixed, unroll
from rigid_body_sim.integrators.marching.points import (
    CONTROL,
    FIXED,
    ORIGIN,
    STEP,
    TIME,
    VALUES,
)

pytestmark = pytest.mark.without_numba

MARCH = specialise(
    fixed, SIZE='SIZE = 1\n', load=unroll.load_source('load', 1),
    put=unroll.put_source('put', 1), rate='def rate(p, y):\n    return (p[0],)\n',
    settled='def settled(y, c):\n    return y, (c[0] + 1.0,)\n',    # counts the steps
    step='def step(p, y, c, k, h):\n    return (y[0] + k[0] * h,), c\n')


def start(begin=0.0, h=0.1, rate=1.0):
    """Return (p, control, point, following) of a march at its start."""
    p, control, point = np.array([rate]), np.zeros(CONTROL.size), np.zeros(VALUES + 2)
    point[TIME], control[FIXED] = begin, h
    MARCH.begin(p, control, point)
    return p, control, point, point.copy()


def test_points_stand_at_multiples_of_the_step_from_the_first_one():
    """Formed anew each time: 0.1 s ten times added up is 1 - 2^-53 s, and 2 s before it moved."""
    of = start(begin=2.0)
    control, point = of[1:3]
    assert control[ORIGIN] == 2.0
    for n in range(1, 31):
        assert MARCH.march(*of, target=2.0 + n * 0.1, end=math.inf, limit=9) == (1, True)
        assert point[TIME] == 2.0 + n * 0.1
        assert point[STEP] == point[VALUES + 1] == n
        assert point[VALUES] == pytest.approx(0.1 * n, abs=1e-14)    # 1.4e-15
    assert MARCH.march(*of, target=math.nextafter(2.0 + 31 * 0.1, 0.0), end=math.inf,
                       limit=9) == (0, True)


@pytest.mark.parametrize(('limit', 'moved'), [(0, 0), (1, 1), (4, 4), (5, 4)])
def test_a_march_makes_no_more_steps_than_it_may(limit, moved):
    of = start()
    assert MARCH.march(*of, target=0.45, end=math.inf, limit=limit) == (moved, True)
    assert of[2][TIME] == moved * 0.1


@pytest.mark.parametrize(('end', 'steps'), [
    (0.3, 3), (0.3 + 0.9e-10, 3), (0.3 - 0.9e-10, 3), (0.3 + 1.1e-10, 4), (0.35, 4), (0.25, 3),
    (0.02, 1)])
def test_the_last_point_stands_at_the_end(end, steps):
    """A point that is nearer to it than a billionth of a step is that point."""
    of = start()
    assert MARCH.march(*of, target=1.0, end=end, limit=99) == (steps, True)
    assert of[2][TIME] == end
    assert of[2][VALUES] == pytest.approx(end, abs=1e-16)
    assert MARCH.march(*of, target=1.0, end=end, limit=99) == (0, True)


def test_what_is_no_number_is_not_good():
    of = start(rate=math.nan)
    assert MARCH.march(*of, target=0.05, end=math.inf, limit=99) == (0, True)
    assert MARCH.march(*of, target=0.15, end=math.inf, limit=99) == (1, False)


@pytest.mark.parametrize('dt', [0.0, 0.04, -0.04])
def test_a_state_between_points_is_one_step_of_the_method(dt):
    of = start(rate=2.0)
    of[2][VALUES] = 5.0
    assert MARCH.between(*of, dt) == (5.0 + 2.0 * max(dt, 0.0),)
