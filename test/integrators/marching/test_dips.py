# SPDX-License-Identifier: Apache-2.0
"""Where functions of time dip below zero between two looks."""

import math

import pytest

from rigid_body_sim.integrators.marching.dips import TRIES, dip


@pytest.mark.parametrize('depth', [1e-3, 1e-9, 1e-15])
@pytest.mark.parametrize('shape', [
    lambda time: (time - 0.3) ** 2, lambda time: 1.0 - math.cos(3.0 * (time - 0.6)),
    lambda time: (time - 0.9) ** 2 * math.exp(time)])
def test_a_dip_is_found_however_shallow_it_is(shape, depth):
    def values(time):
        seen.append(time)
        return [shape(time) - depth]
    seen = []
    found = dip(values, 0.0, 1.0)
    assert 0.0 < found < 1.0
    assert shape(found) < depth
    assert len(seen) <= 4 + 3 * TRIES
    assert all(0.0 <= time <= 1.0 for time in seen)


@pytest.mark.parametrize('shape', [
    lambda time: (time - 0.3) ** 2 + 1e-15, lambda time: 1.0 - time, lambda time: time,
    lambda time: 0.0, lambda time: math.nan, lambda time: (time - 0.3) ** 2 + 2.0,
    lambda time: 1.0 + 1e-17 * time])
def test_what_stays_above_zero_has_no_dip(shape):
    assert dip(lambda time: [shape(time)], 0.0, 1.0) is None


def test_the_earliest_dip_of_several_functions_is_told():
    found = dip(lambda time: [(time - 0.7) ** 2 - 1e-6, 1.0, (time - 0.2) ** 2 - 1e-6], 0.0, 1.0)
    assert abs(found - 0.2) < 1e-3


def test_nothing_is_between_times_that_rounding_hardly_tells_apart():
    """Slopes would be taken over less than an ulp."""
    low = 1e6
    assert dip(lambda time: [-1.0], low, low + 100.0 * math.ulp(low)) is None
