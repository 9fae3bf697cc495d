# SPDX-License-Identifier: Apache-2.0
"""Elementary functions: errors against mpmath, special values of C, the same bits everywhere."""

import json
import math
import os
import pathlib
import subprocess
import sys
from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest
from numerics.arguments import SPECIAL, arguments
from soak import SOAK

from rigid_body_sim.compilation.jit import HAVE_NUMBA
from rigid_body_sim.numerics import functions, make_functions

ROOT = pathlib.Path(__file__).resolve().parents[2]
COUNT = 250_000 if SOAK else 60         # arguments of each of 4 to 8 kinds
SEED = int(os.environ.get('RIGID_BODY_SIM_SEED', '1'))

# name: (exact function, digits for mpmath, largest error in ulp); measured: the largest error of
# 2e6 to 1e7 arguments of each kind
EXACT = {
    'sin': (mp.sin, 30, 0.6),                                     # measured 0.583
    'cos': (mp.cos, 30, 0.6),                                     # measured 0.586
    'exp': (mp.exp, 30, 0.51),                                    # measured 0.508
    'log': (mp.log, 40, 0.51),                                    # measured 0.501
    'asinh': (mp.asinh, 40, 0.51),                                # measured 0.506
    'power': (mp.power, 40, 0.52),                                # measured 0.510
    'atan2': (mp.atan2, 40, 0.51),                                # measured 0.502
    'hypot': (mp.hypot, 40, 0.51),                                # measured 0.501
    'hypot3': (lambda x, y, z: mp.sqrt(x * x + y * y + z * z), 40, 0.51)}    # measured 0.503
SUBNORMAL = 0.76    # where a result below 2^-1022 is rounded a second time; measured 0.75


def ulps(found, exact):
    """Return the error in units of the spacing of doubles at the exact result."""
    if abs(exact) >= mp.mpf(2) ** 1024 * (1 - mp.mpf(2) ** -54):
        return 0.0 if found == math.copysign(math.inf, exact) else math.inf
    if exact == 0 or not math.isfinite(found):
        return 0.0 if found == exact else math.inf
    exponent = max(mp.frexp(exact)[1] - 53, -1074)
    return float(abs(found - exact) / mp.mpf(2) ** exponent)


@pytest.mark.parametrize('name', EXACT)
def test_accuracy(name):
    function = getattr(functions, name)
    exact, digits, bound = EXACT[name]
    worst = (0.0, ())
    for kind in arguments(SEED, COUNT)[name]:
        for numbers in zip(*(k.tolist() for k in kind), strict=True):
            # sums with an angle or with 1 need the digits of both
            small = min(abs(math.frexp(x)[1]) for x in numbers)
            large = max(abs(math.frexp(x)[1]) for x in numbers)
            with mp.workdps(digits + (large if len(numbers) == 1 else min(small, large)) // 3):
                right = exact(*map(mp.mpf, numbers))
                found = function(*numbers)
                error = ulps(found, right)
            if name.startswith('hypot') and found < 2.0 ** -1022:
                error *= bound / SUBNORMAL
            worst = max(worst, (error, numbers))
    assert worst[0] < bound, worst


@pytest.mark.without_numba
def test_the_logarithm_in_a_power_has_15_bits_more_than_a_double():
    worst, some = 0.0, np.linspace(181.0 / 256.0, 181.0 / 128.0, 500)[1:-1]
    with mp.workdps(40):
        for m in some.tolist():
            high, low = functions._logarithm_pair(m, 0)
            exact = mp.log(mp.mpf(m))
            worst = max(worst, abs(float((mp.mpf(high) + mp.mpf(low) - exact) / exact)))
    assert worst < 2.0 ** -68    # measured: 2^-72.7


@pytest.mark.without_numba
def test_the_reduced_argument_of_a_logarithm_is_a_double():
    """Each interval of the table, at its ends: there the reduced argument is largest."""
    for k in range(182, 362):
        inverse = Fraction(functions.LOGARITHMS[4 * k])
        for m, inward in (((k - 0.5) / 256.0, 4.0), ((k + 0.5) / 256.0, 0.0)):
            for _ in range(3):
                m = math.nextafter(m, inward)
                assert functions._reduced_logarithm(m, 0)[2] == Fraction(m) * inverse - 1


def test_arguments_that_are_hardest_to_reduce():
    """Doubles very near multiples of pi/2 (Muller, section 11.3.2, has the nearest) are right."""
    for x in (6381956970095103.0 * 2.0 ** 797, 5.319372648326541e255, 6.123233995736766e-17,
              math.pi, 355.0, 1e22, 1.7976931348623157e308, 1647099.0, 1647099.5, 2.0 ** 53):
        with mp.workdps(700):
            s, c = mp.sin(x), mp.cos(x)
        for sign in (1.0, -1.0):
            assert ulps(functions.sin(sign * x), sign * s) < 0.6
            assert ulps(functions.cos(sign * x), c) < 0.6
            assert functions.sin_cos(sign * x) == (functions.sin(sign * x), functions.cos(x))


def test_results_that_are_exact():
    for k in range(-1074, 1024):
        x = math.ldexp(1.0, k)
        assert functions.power(2.0, float(k)) == x
        assert functions.hypot(0.0, x) == functions.hypot3(-x, 0.0, 0.0) == x
        if abs(k) < 500:
            assert functions.power(x * x, 0.5) == functions.hypot3(2.0 * x, x, 2.0 * x) / 3.0 == x
            assert functions.hypot(3.0 * x, -4.0 * x) == 5.0 * x
            assert functions.power(3.0 * x, 1.0) == 3.0 * x


def same(a, b):
    """Return whether two floats are equal, signs of zeros included; nan equals nan."""
    return (a != a and b != b) or (a == b and math.copysign(1.0, a) == math.copysign(1.0, b))


def c_library(function, *numbers):
    """Return the result of the C library; Python raises where it is inf or nan."""
    with np.errstate(all='ignore'):
        return float(function(*map(np.float64, numbers)))


@pytest.mark.parametrize(('name', 'function'), [
    ('sin', np.sin), ('cos', np.cos), ('exp', np.exp), ('log', np.log), ('asinh', np.arcsinh)])
def test_special_values_of_one_number(name, function):
    for x in SPECIAL:
        found, expected = getattr(functions, name)(x), c_library(function, x)
        assert type(found) is float
        assert same(found, expected) or abs(found - expected) <= math.ulp(expected), (x, found)


@pytest.mark.parametrize(('name', 'function'), [('atan2', np.arctan2), ('hypot', np.hypot),
                                                ('power', np.power)])
def test_special_values_of_two_numbers(name, function):
    """All signs of zeros and infinities are tried."""
    for x in SPECIAL:
        for y in SPECIAL:
            found, expected = getattr(functions, name)(x, y), c_library(function, x, y)
            if name == 'power' and (x < 0.0 or same(x, -0.0)):
                continue
            assert type(found) is float
            assert same(found, expected) or abs(found - expected) <= math.ulp(expected), (x, y)
    assert math.isnan(functions.power(-2.0, 2.0))
    assert math.isnan(functions.power(-math.inf, 1.0))
    assert functions.hypot3(math.nan, 1.0, -math.inf) == math.inf
    assert math.isnan(functions.hypot3(math.nan, 1.0, 1.0))
    assert functions.hypot3(0.0, -0.0, 0.0) == 0.0


def test_ends_of_the_range():
    assert functions.exp(709.782712893384) == 1.7976931348622732e308
    assert functions.exp(709.7827128933841) == math.inf
    assert functions.exp(-745.1332191019411) == 5e-324
    assert functions.exp(-745.1332191019412) == 0.0
    assert functions.hypot(1.3e308, 1.3e308) == math.inf
    assert functions.power(1.0 + 2.0 ** -52, 1e300) == math.inf
    assert functions.power(1.0 - 2.0 ** -53, 1e300) == 0.0
    assert functions.power(5e-324, -1.0) == math.inf
    assert functions.power(5e-324, 1.0) == 5e-324


def test_constants_are_those_that_the_script_makes():
    made = {}
    exec(make_functions.listing(), made)
    del made['__builtins__']
    assert {name: getattr(functions, name) for name in made} == made
    assert len(made) > 40
    with mp.workdps(60):
        for j in range(128):
            value = mp.mpf(2) ** (mp.mpf(j) / 128)
            assert functions.POWERS[2 * j] == float(value)
            assert functions.POWERS[2 * j + 1] == float(value - float(value))
        for j in range(65):
            value = mp.atan(mp.mpf(j) / 64)
            assert functions.ARCTANGENTS[2 * j] == float(value)
            assert functions.ARCTANGENTS[2 * j + 1] == float(value - float(value))
        for j in range(181, 363):
            inverse, high, low, _ = functions.LOGARITHMS[4 * j:4 * j + 4]
            assert abs(high + mp.mpf(low) + mp.log(inverse)) < mp.mpf(2) ** -95
            assert high * 2.0 ** 42 == math.floor(high * 2.0 ** 42)


@pytest.fixture(scope='module')
def digests():
    """Return a function that computes the digests of arguments.py in another process."""
    def run(**settings):
        environment = os.environ | {'PYTHONPATH': f'{ROOT}:{ROOT / "test"}'} | settings
        done = subprocess.run([sys.executable, ROOT / 'test' / 'numerics' / 'arguments.py'],
                              capture_output=True, text=True, env=environment, timeout=300,
                              check=True)
        return json.loads(done.stdout)
    return run


@pytest.fixture(scope='module')
def plain(digests):
    return digests(NUMBA_DISABLE_JIT='1')


@pytest.mark.skipif(not HAVE_NUMBA, reason='compares compiled code with plain Python')
@pytest.mark.parametrize('settings', [
    {},
    # 64-bit x86 without AVX and FMA, or the plain instruction set of another processor
    {'NUMBA_CPU_NAME': 'generic', 'NUMBA_CPU_FEATURES': ''},
    # the same with the C library's own fma in software, on x86 with glibc
    {'NUMBA_CPU_NAME': 'generic', 'NUMBA_CPU_FEATURES': '',
     'GLIBC_TUNABLES': 'glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4'}],
    ids=['this processor', 'any processor', 'any processor, fma in software'])
def test_the_same_bits_as_plain_python(digests, plain, settings):
    compiled = digests(**settings)
    assert [name for name, digest in plain.items() if compiled[name] != digest] == []


def test_lengths_of_vectors_are_those_of_each():
    vectors, out = np.array([[3.0, 4.0, 12.0], [0.0, 0.0, 0.0], [2e200, 3e200, 6e200],
                             [np.nan, 1.0, 0.0], [np.inf, 0.0, np.nan]]), np.empty(5)
    functions.hypot3_of_each(vectors, out)
    assert out[:3].tolist() == [13.0, 0.0, 7e200]
    assert np.isnan(out[3]) and out[4] == np.inf
