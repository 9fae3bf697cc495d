# SPDX-License-Identifier: Apache-2.0
"""The functions of a relaxation beside mpmath, where one way to compute them meets the next."""

import math

import mpmath
import numpy as np
import pytest
from near import near

from rigid_body_sim.numerics.relaxation import relaxation, relaxation_pairs, relaxed_time

ULP = 2.0 ** -53
PLACES = sorted({0.0, *(sign * x for sign in (1, -1) for x in (
    1e-300, 1e-9, 1e-3, 0.124, 0.125, 0.126, 0.3, 0.499, 0.5, 0.501, 0.75, 0.999, 1.0, 1.001, 2.0,
    7.7, 30.0, 79.9, 80.0, 80.1, 200.0, 700.0))})


def exact(x):
    """Return exp(-x), f1 = (1 - exp(-x))/x and f2 = (1 - f1)/x with 60 digits."""
    with mpmath.workdps(60 + int(abs(x))):
        if x == 0.0:
            return mpmath.mpf(1), mpmath.mpf(1), mpmath.mpf(0.5)
        with mpmath.workdps(700):
            x = mpmath.mpf(x)
            f1 = -mpmath.expm1(-x) / x
            return mpmath.exp(-x), f1, (1 - f1) / x


@pytest.mark.parametrize('x', PLACES)
def test_doubles_are_good_to_a_few_ulp(x):
    for found, expected in zip(relaxation(x), exact(x), strict=True):
        assert abs(found / expected - 1) < 4 * ULP    # measured 2


@pytest.mark.parametrize('x', PLACES)
def test_pairs_are_good_to_29_digits(x):
    for (high, low), expected in zip(relaxation_pairs((x, x * 2.0 ** -55)), exact(0.0)[1:],
                                     strict=True):
        with mpmath.workdps(60):
            whole = mpmath.mpf(x) + mpmath.mpf(x * 2.0 ** -55)
        expected = exact(whole)[1 + (expected == 0.5)] if x else expected
        with mpmath.workdps(60):
            found = mpmath.mpf(high) + mpmath.mpf(low)
            assert abs(found / expected - 1) < 6e-32 * (1 + abs(x))    # measured 1.8e-32
        assert abs(low) <= ULP * abs(high)


def test_far_below_both_are_infinite():
    assert relaxation_pairs((-740.1, 0.0)) == ((math.inf, 0.0),) * 2
    assert all(math.isfinite(high) for high, _ in relaxation_pairs((-709.0, 0.0)))


@pytest.mark.parametrize('rate', [-3.0, -1e-3, -1e-6, 1e-6, 1e-5, 1e-4, 0.5, 4.0])
@pytest.mark.parametrize('time', [1e-9, 0.03, 0.2, 5.0])
def test_the_time_is_found_again(rate, time):
    with mpmath.workdps(40):
        y = float(time * exact(rate * time)[1])
        truth = -mpmath.log(1 - mpmath.mpf(rate) * mpmath.mpf(y)) / rate
    # near its end a relaxation tells the time badly: y = 1/rate
    magnified = 1.0 + abs(rate * y / (1.0 - rate * y))
    assert relaxed_time(rate, y) == near(float(truth), rel=8 * ULP * magnified)


def test_what_is_never_reached_has_no_time():
    assert relaxed_time(2.0, 0.5) == math.inf
    assert relaxed_time(2.0, 0.6) == math.inf
    assert math.isfinite(relaxed_time(2.0, np.nextafter(0.5, 0.0)))
    assert math.isfinite(relaxed_time(-2.0, 100.0))
