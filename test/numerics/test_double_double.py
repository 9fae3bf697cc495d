# SPDX-License-Identifier: Apache-2.0
"""Pairs of doubles, phases in turns, sine, cosine and exponential function against mpmath."""

import math
import operator
from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.numerics import double_double
from rigid_body_sim.numerics.exponential import decay
from rigid_body_sim.numerics.phase import phase, sin_cos


def pairs(seed, signs=True):
    """Yield random pairs of doubles."""
    rng = np.random.default_rng(seed)
    for _ in range(300):
        high = (float(10.0 ** rng.uniform(-20.0, 20.0))
                * (rng.choice([-1.0, 1.0]) if signs else 1.0))
        yield high, float(rng.uniform(-0.5, 0.5)) * math.ulp(high)


def exact(pair):
    return Fraction(pair[0]) + Fraction(pair[1])


@pytest.mark.parametrize(('name', 'operation', 'bound'),
                         [('add', operator.add, 3.0), ('multiply', operator.mul, 7.0),
                          ('divide', operator.truediv, 15.0)])
def test_operations_on_pairs(name, operation, bound):
    """Bounds of the literature hold, in units of 2^-106, for sums of opposite signs too."""
    for a, b in zip(pairs(1), pairs(2), strict=True):
        for b_near in (b, (-a[0] * (1.0 + 1e-9), b[1] * a[0] / b[0])):
            right = operation(exact(a), exact(b_near))
            found = exact(getattr(double_double, name)(*a, *b_near))
            assert abs(found - right) <= bound * Fraction(1, 2**106) * abs(right)


def test_other_operations_on_pairs():
    for a, b in zip(pairs(3, False), pairs(4, False), strict=True):
        assert abs(exact(double_double.add_alike(*a, *b)) / (exact(a) + exact(b)) - 1) <= Fraction(
            3, 2**106)
        assert abs(exact(double_double.add_double(*a, b[0])) / (exact(a) + Fraction(b[0]))
                   - 1) <= Fraction(2, 2**106)
        assert abs(exact(double_double.multiply_double(*a, b[0])) / (exact(a) * Fraction(b[0]))
                   - 1) <= Fraction(3, 2**106)
        assert abs(exact(double_double.root(*a)) ** 2 / exact(a) - 1) <= Fraction(8, 2**106)
        assert (sum(map(Fraction, double_double.two_product(a[0], b[0])))
                == Fraction(a[0]) * Fraction(b[0]))
        assert (sum(map(Fraction, double_double.two_sum(a[0], -b[0])))
                == Fraction(a[0]) - Fraction(b[0]))
    assert double_double.root(0.0, 0.0) == (0.0, 0.0)


@pytest.mark.parametrize(('a', 'b'), [(1.1e305, 1.3e-20), (1.3e-20, 1.1e305), (1.1e200, 1.3e105),
                                      (1.1e-140, 1.3e-135), (0.0, 1.1), (1.1e305, 0.0)])
def test_a_product_is_exact_where_the_halves_of_a_factor_would_overflow(a, b):
    found = double_double.two_product(a, b)
    assert sum(map(Fraction, found)) == Fraction(a) * Fraction(b)


@compiled
def turned(turns, low):
    return sin_cos(turns, low)


@compiled
def reduced(rate, rate_low, time):
    return phase(rate, rate_low, time, 0.0)


@compiled
def decayed(x):
    return decay(x)


def test_sine_and_cosine_of_turns():
    rng = np.random.default_rng(5)
    with mp.workdps(40):
        quarters = [0.125 * k for k in range(-16, 17)]
        for x in [*rng.uniform(-2.0, 2.0, 3000), *rng.uniform(-1e-3, 1e-3, 100), *quarters]:
            s, c = turned(x, 1e-18)
            angle = 2 * mp.pi * (mp.mpf(x) + mp.mpf(1e-18))
            assert abs(s - mp.sin(angle)) < 1.4e-16     # measured 1.28e-16
            assert abs(c - mp.cos(angle)) < 1.4e-16
    for k in range(-8, 9):
        assert turned(0.25 * k, 0.0) == ((0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0))[k % 4]


def test_sine_and_cosine_round_to_no_side():
    """A sine short by the rounding of 2 pi (0.36 of 2^-53) would drain energy from a motion.

    It would do so where the motion is anchored anew at every tick.
    """
    sines, squares = [], []
    rng = np.random.default_rng(6)
    with mp.workdps(30):
        for x in rng.uniform(0.001, 0.125, 4000):
            s, c = turned(x, 0.0)
            sines.append(float((s / mp.sin(2 * mp.pi * mp.mpf(x)) - 1) * 2**53))
            squares.append(float((mp.mpf(s) ** 2 + mp.mpf(c) ** 2 - 1) * 2**53))
    assert abs(np.mean(sines)) < 0.05       # measured 0.01, spread 0.6 / sqrt(4000)
    assert abs(np.mean(squares)) < 0.05


def test_phase_loses_nothing():
    rng = np.random.default_rng(7)
    with mp.workdps(60):
        for _ in range(1000):
            rate = mp.mpf(10) ** rng.uniform(-10.0, 6.0)
            high = float(rate)
            time = float(rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-9.0, 8.0))
            low = float(rate - high)
            turns, turns_low = reduced(high, low, time)
            product = (mp.mpf(high) + low) * time
            rest = product - turns - turns_low
            assert abs(rest - mp.nint(rest)) < 1e-31 * max(1, abs(product))     # measured 2.6e-32
            assert abs(turns) <= 0.5


def test_decay():
    rng = np.random.default_rng(8)
    with mp.workdps(40):
        for x in [*rng.uniform(0.0, 700.0, 2000), *(10.0 ** rng.uniform(-12.0, 0.0, 500))]:
            assert abs(decayed(x) / mp.exp(-mp.mpf(x)) - 1) < 1.1 * 2.0**-52    # measured 0.88
    assert decayed(0.0) == 1.0
    assert decayed(745.0) == 5e-324
    assert decayed(746.0) == decayed(1e300) == decayed(math.inf) == 0.0
    assert math.isnan(decayed(math.nan))
