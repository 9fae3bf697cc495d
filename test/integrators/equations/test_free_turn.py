# SPDX-License-Identifier: Apache-2.0
"""The drift of compositions: the free rotation by its series, and its kinetic energy.

References of 36 digits come from test/data/make_free_body.py.
"""

import json
import math
import pathlib
from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest

from rigid_body_sim.integrators.equations import free_turn
from rigid_body_sim.integrators.equations.euler import EULER, FIXED, MOMENTS
from rigid_body_sim.integrators.equations.free_turn import LEAST, turned_freely
from rigid_body_sim.numerics.rotations import angle_between

RECORDS = json.loads((pathlib.Path(__file__).resolve().parents[2] / 'data'
                      / 'free_body.json').read_text())
NOTHING = (0.0,) * 7
# rad; a racket that has tumbled beyond forgets its start, for the state was rounded on the way
LONGEST = 20.0
EPSILON = np.finfo(float).eps


def parameters_of(moments):
    """Return the parameters that the kernel takes; a thin rod has no moment about one axis."""
    p = np.zeros(FIXED)
    p[MOMENTS:MOMENTS + 3] = moments
    p[EULER:EULER + 3] = [(moments[(k + 1) % 3] - moments[(k + 2) % 3]) / moments[k] if moments[k]
                          else 0.0
                          for k in range(3)]
    return p


def twice_energy(moments, y, c):
    """Return sum I omega^2 exactly, omega with what its sums have lost."""
    return sum(Fraction(i) * (Fraction(w) + Fraction(lost)) ** 2
               for i, w, lost in zip(moments, y[4:], c[4:], strict=True))


def cases():
    found = []
    for record in RECORDS:
        times = [state
                 for state in record['states']
                 if 0.0 < math.hypot(*record['angular_velocity']) * state['time'] < LONGEST]
        if times and 'axes' not in record and 'center_of_mass' not in record:
            found.append(pytest.param(record, times, id=record['name']))
    return found


@pytest.mark.without_numba
@pytest.mark.parametrize(('record', 'states'), cases())
def test_against_digits(record, states):
    moments, omega = record['moments'], record['angular_velocity']
    p, size, start = parameters_of(moments), math.hypot(*omega), (*record['orientation'], *omega)
    for state in states:
        y, c = turned_freely(p, start, NOTHING, state['time'])
        floor = EPSILON * (1.0 + size * state['time'])
        turned = angle_between(*y[:4], *(float(x) for x in state['orientation']))
        assert turned < 3.0 * max(floor, state['one_ulp']), state['time']    # 1.6
        change = max(abs(float(mp.mpf(x) - w))
                     for x, w in zip(state['angular_velocity'], y[4:], strict=True))
        assert change <= max(floor, state['one_ulp_omega']) * size, state['time']    # 0.52
        before = twice_energy(moments, start, NOTHING)
        if before > LEAST:
            # 1.1e-31: one span or many
            assert abs(float(twice_energy(moments, y, c) / before - 1)) < 1e-30, state['time']


@pytest.mark.parametrize(('h', 'bound'), [(1e-3, 2e-19), (1e-6, 2e-22)])    # 5.4e-20; 5.5e-23
def test_increments_err_by_a_rounding_of_themselves(h, bound):
    """Two halves and the whole agree to much less than a rounding of the state.

    The low part of the state is kept.
    """
    p, start = parameters_of((2.0, 3.0, 4.0)), (0.1, 0.2, -0.3, math.sqrt(0.86), 0.7, -0.4, 1.1)
    once = turned_freely(p, start, NOTHING, h)
    twice = turned_freely(p, *turned_freely(p, start, NOTHING, 0.5 * h), 0.5 * h)
    apart = [float(Fraction(a) + Fraction(b) - Fraction(d) - Fraction(e))
             for a, b, d, e in zip(*once, *twice, strict=True)]
    assert 0.0 < max(map(abs, apart)) < bound


def test_drift_of_more_turns_than_mean_anything_is_not_a_number():
    y, _ = turned_freely(
        parameters_of((2.0, 3.0, 4.0)), (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1e6), NOTHING, 1.0)
    assert all(math.isnan(value) for value in y)


@pytest.mark.parametrize('h', [1.0, -1.0, 0.5])
@pytest.mark.parametrize('axis', range(3))
def test_a_body_that_turns_about_one_axis_turns_by_its_rate_times_the_time(axis, h):
    """Twenty radians, eighty spans of a fourth of one, forward or back."""
    p, omega = parameters_of((2.0, 3.0, 4.0)), [0.0, 0.0, 0.0]
    omega[axis] = 20.0
    y, _ = turned_freely(p, (0.0, 0.0, 0.0, 1.0, *omega), NOTHING, h)
    expected = [0.0, 0.0, 0.0, math.cos(10.0 * h), *omega]
    expected[axis] = math.sin(10.0 * h)
    assert y == pytest.approx(expected, abs=1e-13)    # 1.3e-14


def test_a_drift_of_no_time_changes_nothing():
    start, lost = (0.1, 0.2, -0.3, math.sqrt(0.86), 0.7, -0.4, 1.1), (1e-18,) * 7
    assert turned_freely(parameters_of((2.0, 3.0, 4.0)), start, lost, 0.0) == (start, lost)


@pytest.mark.without_numba
def test_nothing_is_read_of_a_series_that_is_not_written(monkeypatch):
    p, start = parameters_of((2.0, 3.0, 4.0)), (0.1, 0.2, -0.3, math.sqrt(0.86), 0.7, -0.4, 1.1)
    expected = turned_freely(p, start, NOTHING, 0.2)
    monkeypatch.setattr(free_turn.np, 'empty', lambda shape: np.full(shape, math.nan))
    assert turned_freely(p, start, NOTHING, 0.2) == expected
