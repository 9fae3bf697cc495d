# SPDX-License-Identifier: Apache-2.0
"""Intervals of expressions hold the values at any time within; single operations are exact."""

import math

import numpy as np
import pytest
from near import near

from rigid_body_sim.scene.expressions import reader
from rigid_body_sim.scene.expressions.intervals import fixed, ranges


def found(text, begin, end, **given):
    """Return the interval of an expression in one interval of time."""
    one = reader.read(text, {'t', 'wx', *given}, 'x')
    times = np.array([float(begin)]), np.array([float(end)])
    names = {name: fixed(value, times[0]) for name, value in given.items()}
    low, high = ranges((one,), {'t': times} | names)[one]
    return float(low[0]), float(high[0])


INF = math.inf


@pytest.mark.parametrize(('text', 'begin', 'end', 'expected'), [
    ('2 + t', 1, 3, (3, 5)), ('2 - t', 1, 3, (-1, 1)), ('-t', 1, 3, (-3, -1)),
    ('t - t', 1, 3, (-2, 2)),
    ('3*t', -1, 2, (-3, 6)), ('-3*t', -1, 2, (-6, 3)), ('t*(t - 3)', 1, 2, (-4, -1)),
    ('1/t', 2, 4, (0.25, 0.5)), ('1/t', -4, -2, (-0.5, -0.25)), ('1/t', -1, 2, (-INF, INF)),
    ('6/(t - 3)', 1, 2, (-6, -3)),
    ('t^2', -3, 2, (0, 9)), ('t^2', -3, -2, (4, 9)), ('t^3', -3, 2, (-27, 8)),
    ('t^(-2)', 1, 2, (0.25, 1)), ('t^(-2)', -1, 2, (-INF, INF)), ('t^1.5', -1, 4, (0, 8)),
    ('2^t', 1, 2, (-INF, INF)), ('sqrt(t)', -1, 4, (0, 2)), ('log(t)', 0, 1, (-INF, 0)),
    ('exp(t)', 0, 1, (1, math.e)), ('tanh(t)', -1, 0, (-math.tanh(1), 0)),
    ('sin(t)', 0, 1, (0, math.sin(1))), ('sin(t)', 1, 3, (math.sin(3), 1)),
    ('sin(t)', 4, 5, (-1, math.sin(4))), ('sin(t)', 0, 7, (-1, 1)),
    ('sin(t)', 101, 101.5, (math.sin(101), math.sin(101.5))),
    ('cos(t)', -1, 2, (math.cos(2), 1)), ('cos(t)', 3, 4, (-1, math.cos(4))),
    ('tan(t)', 0, 1, (-INF, INF)), ('abs(t)', 0, 1, (-INF, INF)), ('wx', 0, 1, (-INF, INF)),
    ('0*wx', 0, 1, (0, 0)), ('wx - wx', 0, 1, (-INF, INF)), ('exp(wx)', 0, 1, (0, INF))])
def test_they_are_those_of_the_operation(text, begin, end, expected):
    assert found(text, begin, end) == pytest.approx(expected, rel=1e-14, abs=1e-15)


def test_parameters_are_numbers():
    assert found('k*t + c', 1, 2, k=-2.0, c=0.5) == (-3.5, -1.5)
    assert found('t^k', 1, 2, k=3.0) == near((1.0, 8.0), rel=1e-15)


@pytest.mark.parametrize('text', [
    'exp(-((t - 2)/0.3)^2)', 'sin(3*t)*cos(t)/(2 + sin(t))', 'tanh(t - 1) - tanh(t - 2)',
    '1/(1 + (t - 2)^4)', 'sqrt(t + 1)*log(t + 2)^3', '-exp(-t)*(t - 1)^2'])
def test_values_within_lie_within(text):
    one = reader.read(text, {'t'}, 'x')
    edges = np.linspace(0.0, 4.0, 33)
    low, high = ranges((one,), {'t': (edges[:-1], edges[1:])})[one]
    times = edges[:-1, np.newaxis] + np.diff(edges)[:, np.newaxis] * np.linspace(0.0, 1.0, 9)
    values = np.array([ranges((one,), {'t': (row, row)})[one][0] for row in times])
    ulp = 1e-14 * np.abs(values).max()
    assert (values >= low[:, np.newaxis] - ulp).all()
    assert (values <= high[:, np.newaxis] + ulp).all()
    # and they shrink with the intervals of time
    assert (high - low).max() < 2.0 * np.ptp(values, axis=1).max() + 0.6 * np.ptp(values)
