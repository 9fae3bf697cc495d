# SPDX-License-Identifier: Apache-2.0
"""The fused multiply-add has one rounding in all its implementations."""

import itertools
import math
import os
from fractions import Fraction

import numpy as np
import pytest
from soak import SOAK

from rigid_body_sim.compilation import fused
from rigid_body_sim.compilation.jit import HAVE_NUMBA, compiled

SEED = int(os.environ.get('RIGID_BODY_SIM_SEED', '1'))
# their products and sums overflow, underflow, cancel and end halfway between two doubles
CORNERS = [0.0, -0.0, 1.0, -1.0, 1.0 + 2.0 ** -52, 1.0 - 2.0 ** -53, 3.0, 2.0 ** -53, -2.0 ** -106,
           5e-324, -5e-324, 2.0 ** -1022, 2.0 ** -538, 2.0 ** -537, 1.5, 2.0 ** 512, 2.0 ** 990,
           -2.0 ** 1000, 1.7976931348623157e308, math.inf, -math.inf, math.nan]


@compiled
def machine(a, b, c, out):
    """Store the results of compiled code for arrays."""
    for i in range(a.size):
        out[i] = fused.fma(a[i], b[i], c[i])


def by_fractions(a, b, c):
    """Return a b + c rounded once, for finite numbers that are not all zero."""
    exact = Fraction(a) * Fraction(b) + Fraction(c)
    if exact == 0:
        return a * b + c if 0.0 in (a, b) else 0.0
    try:
        rounded = float(exact)
    except OverflowError:
        return math.copysign(math.inf, 1.0 if exact > 0 else -1.0)
    # a number that underflows has the sign of the exact one
    return rounded if rounded else math.copysign(0.0, 1.0 if exact > 0 else -1.0)


def bits(x):
    """Return the bits of a float, the same for all nans."""
    return 'nan' if x != x else float(x).hex()


def triples(seed, count):
    """Yield arrays of arguments, random and hard to round."""
    rng = np.random.default_rng(seed)

    def number(first=-1.0, last=1.0):
        return rng.uniform(first, last, count)

    def power(first, last):
        return np.ldexp(rng.choice([-1.0, 1.0], count), rng.integers(first, last, count))

    def short(digits):
        return rng.integers(-2 ** digits, 2 ** digits, count).astype(float)

    yield number(), number(), number()
    yield number(), number(), number() * power(-120, 60)
    a, b = number(), number()
    yield a, b, -a * b                                        # the error of a product
    yield a, b, np.nextafter(-a * b, power(0, 1) * np.inf)
    a, b = short(27), short(26)
    yield a, b, power(52, 108)                                # products of 53 bits beside a power
    yield 1.0 + short(8) * 2.0 ** -52, 1.0 + short(8) * 2.0 ** -53, power(-110, 2)
    # products of 54 bits end halfway between two doubles, plus less than an ulp of the product
    yield short(28), short(27), power(-60, 2)
    yield short(28), short(27), number() * power(-1000, 10)
    yield 2.0 ** 53 + short(3), 1.0 + 2.0 ** -52 * short(3), power(-3, 3) + short(2)
    yield number() * power(-540, -440), number() * power(-540, -440), number() * power(-1074, -900)
    yield number() * power(400, 512), number() * power(400, 512), number() * power(900, 1024)
    yield tuple(rng.integers(0, 0x7FF0000000000000, count).view(float) * power(0, 1)
                for _ in range(3))


@pytest.mark.parametrize('way', ['exact_fma', 'emulated_fma', 'python_fma', 'guarded_fma'])
def test_scalars(way):
    function = getattr(fused, way)
    if way == 'guarded_fma' and not hasattr(math, 'fma'):
        pytest.skip('math.fma exists from Python 3.13 on')
    for arrays in triples(SEED, 20000 if SOAK else 200):
        for a, b, c in zip(*(array.tolist() for array in arrays), strict=True):
            assert bits(function(a, b, c)) == bits(by_fractions(a, b, c)), (a, b, c)
    for a, b, c in itertools.product(CORNERS, repeat=3):
        if all(map(math.isfinite, (a, b, c))):
            assert bits(function(a, b, c)) == bits(by_fractions(a, b, c)), (a, b, c)


@pytest.mark.skipif(not HAVE_NUMBA, reason='about compiled code')
def test_infinities_and_nans_are_those_of_the_machine():
    a, b, c = np.array(list(itertools.product(CORNERS, repeat=3))).T
    out = np.empty(a.size)
    machine(a.copy(), b.copy(), c.copy(), out)
    found = [fused.python_fma(*numbers) for numbers in zip(a.tolist(), b.tolist(), c.tolist())]
    assert list(map(bits, found)) == list(map(bits, out))


@pytest.mark.skipif(not HAVE_NUMBA, reason='about compiled code')
def test_plain_python_against_the_machine():
    """Twelve kinds of a few thousand triples, and of two hundred thousand in the long tests."""
    for arrays in triples(SEED + 1, 200000 if SOAK else 3000):
        out = np.empty(arrays[0].size)
        machine(*arrays, out)
        found = list(map(fused.python_fma, *(array.tolist() for array in arrays)))
        different = np.nonzero(np.array(found).view(np.int64) != out.view(np.int64))[0]
        assert not different.size, [[array[k] for array in arrays] for k in different[:3]]


@pytest.mark.skipif(not HAVE_NUMBA, reason='about compiled code')
def test_compiled_code_against_fractions():
    for a, b, c in triples(SEED + 2, 20000 if SOAK else 200):
        out = np.empty(a.size)
        machine(a, b, c, out)
        for k in range(a.size):
            numbers = float(a[k]), float(b[k]), float(c[k])
            assert bits(out[k]) == bits(by_fractions(*numbers)), numbers
