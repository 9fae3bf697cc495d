# SPDX-License-Identifier: Apache-2.0
"""The units of a top: tilts and swings far below 1e-60 are taken up to it, by powers of two."""

import math

import pytest

from rigid_body_sim.motions.lagrange_top.anchor import TINY, _units
from rigid_body_sim.motions.lagrange_top.theta import Klein

pytestmark = pytest.mark.without_numba

ONE, NONE = (0.6, 0.8), (0.0, 0.0)


def units(a, b, omega=NONE, n=20.0, k=4.0):
    """Return the Units of a state with spin n and the square k of the rate of falling."""
    return _units(Klein(a, b, omega), (n, 0.0), (k, 0.0))


@pytest.mark.parametrize('size', [1e-61, 1e-100, 3e-200, 1e-290])
@pytest.mark.parametrize('turn', [(1.0, 0.0), (0.0, -1.0), (0.6, 0.8)])
def test_what_is_tiny_is_taken_up_standing_and_hanging(size, turn):
    tiny = size * turn[0], size * turn[1]
    standing, hanging = units(ONE, tiny), units(tiny, ONE)
    assert (standing.a, hanging.b) == (1.0, 1.0)
    assert standing.b == standing.swing == hanging.a == hanging.swing
    assert math.frexp(standing.b)[0] == 0.5
    assert 0.4 * TINY < max(map(abs, tiny)) / standing.b <= TINY


def test_a_swing_is_taken_up_as_a_tilt_is():
    """Its size is in units of the faster of spin and fall."""
    for n, k, own in ((20.0, 4.0, 20.0), (3.0, 4.0, 4.0)):
        found = units(ONE, NONE, (0.0, own * 1e-100), n, k)
        assert 0.4 * TINY < 1e-100 / found.swing <= TINY
        assert found.b == found.swing


@pytest.mark.parametrize(('a', 'b'), [(ONE, (1e-59, 0.0)), (ONE, NONE), (NONE, ONE), (ONE, ONE)])
def test_what_is_not_tiny_or_is_zero_stays(a, b):
    found = units(a, b)
    assert (found.a, found.b, found.swing) == (1.0, 1.0, 1.0)


@pytest.mark.parametrize('fast', [1e-30, 0.3, 20.0, 1e9, 1e100])
def test_rates_are_counted_in_the_power_of_two_above_the_fastest(fast):
    for found in (units(ONE, NONE, n=fast, k=0.01 * fast * fast),
                  units(ONE, NONE, n=0.1 * fast, k=0.25 * fast * fast),
                  units(ONE, NONE, (0.2 * fast, -fast), 0.1 * fast, 1e-3 * fast * fast)):
        assert math.frexp(found.rate)[0] == 0.5
        assert found.rate / 2.0 <= fast * (1.0 + 1e-15) <= found.rate * (1.0 + 1e-15)
    assert units(ONE, NONE, n=0.0, k=0.0).rate == 1.0
