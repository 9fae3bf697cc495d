# SPDX-License-Identifier: Apache-2.0
"""A bracketed root: Brent's method with every operation rounded."""

import math
import platform

import numpy as np
import pytest
from scipy.optimize import brentq

from rigid_body_sim.numerics.root import root

CASES = [(math.sin, 3.0, 4.0), (lambda x: x * x * x - 2.0, -1.0, 5.0),
         (lambda x: 1e-30 * (x - 0.3) ** 9, -2.0, 1.0), (lambda x: math.atan(1e6 * x), -1.0, 3.0),
         (lambda x: -1.0 if x < 1e-7 else 1.0, -5.0, 7.0), (lambda x: x - 1e6, 1e6 - 3, 1e6 + 2.5)]


@pytest.mark.parametrize('case', range(len(CASES)))
def test_the_root_is_bracketed_to_the_tolerance(case):
    function, begin, end = CASES[case]
    for first, last in ((begin, end), (end, begin)):
        x = root(function, first, last, 1e-15, 4e-16)
        reach = 1e-15 + 4e-16 * abs(x) + 2.0 * math.ulp(x)
        assert function(x) == 0.0 or function(x - reach) * function(x + reach) <= 0.0


def test_a_root_at_an_end_is_returned():
    assert root(lambda x: x - 1.0, 1.0, 2.0, 1e-15, 4e-16) == 1.0
    assert root(lambda x: x - 2.0, 1.0, 2.0, 1e-15, 4e-16) == 2.0


@pytest.mark.skipif(platform.machine() != 'x86_64', reason='SciPy may be compiled to fuse')
def test_it_is_the_method_of_scipy():
    rng = np.random.default_rng(4)
    for _ in range(300):
        a, b, c, d = rng.uniform(0.1, 3.0, 4).tolist()
        begin, end = rng.uniform(-9.0, 0.0), rng.uniform(0.0, 9.0)

        shift = rng.uniform(begin, end)

        def function(x, a=a, b=b, c=c, d=d, shift=shift):
            y = x - shift
            return a * y * abs(y) + b * y * y * y + c * math.copysign(math.sqrt(abs(y)), y) + d * y

        def wavy(x, function=function, a=a, begin=begin, end=end):
            return function(x) + 9.0 * a * math.sin(8.0 * x) * (x - begin) * (end - x)

        def stepped(x, function=function):
            y = function(x)
            return math.copysign(0.25 + round(abs(y)), y)

        # one that rises, one that comes back on its way, and one that has equal values
        for one in function, wavy, stepped:
            assert root(one, begin, end, 1e-15, 8.9e-16) == brentq(
                one, begin, end, xtol=1e-15, rtol=8.9e-16)
