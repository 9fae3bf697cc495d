# SPDX-License-Identifier: Apache-2.0
"""Mean rates of a top beside integrals over a nutation by mpmath."""

import types

import pytest
from mpmath import mp, mpf
from near import near

from rigid_body_sim.motions.lagrange_top.means import NEVER, mean_rates

pytestmark = pytest.mark.without_numba
COUNT = 120    # nodes of an integral over a nutation: the remainder is below 1e-25
BOUND = 1e-22    # the means end where one more step would change them by 6e-23; measured: 3e-23


def pair(x):
    """Return a number as a pair."""
    return float(x), float(x - mpf(float(x)))


def number(p):
    """Return the number of a pair."""
    return mpf(p[0]) + mpf(p[1])


def roots_of(u1, u2, u3, k, signs=(1, 1), unit=1.0, steady=False):
    """Return what mean_rates reads of Roots; near the upper pole squares are counted in unit^2."""
    x, y = [1 + u for u in (u1, u2, u3)], [1 - u1, 1 - u2, u3 - 1]
    x[2], y[2] = 2 * k * x[2], 2 * k * y[2]
    sigma, delta = (sign * mp.sqrt(mp.fprod(z)) for sign, z in zip(signs, (x, y)))
    square = mpf(unit) ** 2
    return types.SimpleNamespace(
        steady=steady, sigma=pair(sigma), delta=pair(delta), x1=pair(x[0]), x2=pair(x[1]),
        x3=pair(x[2]), y1=pair(y[0]), y2=pair(y[1] / square), y3=pair(y[2] / square),
        wide=pair(2 * k * (u3 - u1)), narrow=pair(2 * k * (u3 - u2) / square)), sigma, delta


@pytest.mark.parametrize(('u1', 'u2', 'u3'), [
    ('-0.3', '0.4', '1.7'), ('-0.9', '0.7', '1.1'), ('0.5', '0.500001', '30'), ('-1', '0.3', '2'),
    ('-0.5', '1', '1.2')])
@pytest.mark.parametrize('signs', [(1, 1), (-1, 1), (1, -1)])
@pytest.mark.parametrize('unit', [1.0, 2.0 ** -10])
def test_the_phases_grow_at_the_means_of_their_rates_over_a_nutation(u1, u2, u3, signs, unit):
    """The integrands are periodic in s, u = u1 + (u2 - u1) sin^2 s: equal weights serve.

    In which unit 1 - u2 is counted changes nothing. Through a pole (u1 = -1) the phase of `a` is
    torn, and steps on by half a turn each time, on average forwards.
    """
    with mp.workdps(34):
        a, b, c, k = mpf(u1), mpf(u2), mpf(u3), mpf('2.3')
        roots, sigma, delta = roots_of(a, b, c, k, signs, unit)
        found = mean_rates(roots, unit)

        def mean(rate):
            return mp.fsum(rate(u) / mp.sqrt(2 * k * (c - u)) for u in places) * mp.pi / COUNT
        places = [a + (b - a) * mp.sin(mp.pi * j / COUNT) ** 2 for j in range(COUNT)]
        half = mean(lambda u: mpf(1))
        expected_a = (mean(lambda u: sigma / (2 * (1 + u))) / half if a > -1
                      else mp.pi / 2 / half)
        expected_b = (mean(lambda u: delta / (2 * (1 - u))) / half if b < 1
                      else mp.pi / 2 / half)
        assert abs(number(found.nutation) * 2 * half - 1) < BOUND
        assert found.mean == near(
            float(mp.pi / half / mp.sqrt(2 * k * (c - a))), rel=1e-15)
        assert abs(number(found.a) / expected_a - 1) < BOUND
        assert abs(number(found.b) / expected_b - 1) < BOUND


def test_a_steady_top_and_one_on_the_separatrix_turn_at_the_rates_of_where_they_stay():
    with mp.workdps(34):
        k = mpf('2.3')
        roots, sigma, delta = roots_of(mpf('0.3'), mpf('0.3'), mpf(2), k, steady=True)
        found = mean_rates(roots, 1.0)
        assert (found.mean, found.nutation) == (1.0, (0.0, 0.0))
        assert abs(number(found.a) / (sigma / 2 / mpf('1.3')) - 1) < 1e-29
        assert abs(number(found.b) / (delta / 2 / mpf('0.7')) - 1) < 1e-29
        roots, sigma, _ = roots_of(mpf('-0.3'), mpf(1), mpf(1), k)
        found = mean_rates(roots, 1.0)
        assert (found.mean, found.b) == (0.0, (0.0, 0.0))
        assert abs(number(found.a) / (sigma / 4) - 1) < 1e-29
        # NEVER stands for the half period, in units of 2/sqrt(2 k (u3 - u1))
        period = 4 * NEVER / mp.sqrt(2 * k * mpf('1.3'))
        assert abs(number(found.nutation) * period - 1) < 1e-29
