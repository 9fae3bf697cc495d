# SPDX-License-Identifier: Apache-2.0
"""Derivatives of expressions against differences with 60 digits, and what trees keep."""

import mpmath
import pytest

from rigid_body_sim.scene.expressions import tree
from rigid_body_sim.scene.expressions.reader import read

NAMES = {'x', 'y', 't'}
OPERATIONS = {
    '+': lambda a, b: a + b, '-': lambda a, b: a - b, '*': lambda a, b: a * b,
    '/': lambda a, b: a / b, '^': lambda a, b: a ** b, 'negative': lambda a: -a,
    'sqrt': mpmath.sqrt, 'sin': mpmath.sin, 'cos': mpmath.cos, 'tan': mpmath.tan,
    'exp': mpmath.exp, 'log': mpmath.log, 'tanh': mpmath.tanh, 'abs': abs, 'min': min, 'max': max,
    'less': lambda a, b: mpmath.mpf(a < b), 'sign': mpmath.sign,
    'where': lambda less, a, b: a if less else b}


def value(one, known):
    if one.op == 'number':
        return mpmath.mpf(one.args[0])
    if one.op == 'name':
        return known[one.args[0]]
    return OPERATIONS[one.op](*(value(arg, known) for arg in one.args))


@pytest.mark.parametrize('text', [
    'x*y + x/y - 3*x', 'x^3*y', 'x^y', '2^x', 'x^-2', 'sqrt(x^2 + y^2)', 'sin(x*y)*cos(x)',
    'tan(x) + tanh(x*y)', 'exp(-x*y)/(1 + x)', 'log(x + y)', 'abs(x - y)*x',
    'min(x, y)*max(x, 2*y)', '-(x - y)^2', 'sqrt(x)^3', 'exp(sin(x^2))',
    'where(x < y, x^2*y, y)', 'where(y > 3*x, x, sign(x)*x^3*y)', '(x < y)*x*y'])
@pytest.mark.parametrize('variable', ['x', 'y'])
def test_a_derivative_is_the_slope(text, variable):
    function = read(text, NAMES, 'here')
    slope, = tree.derivatives(function, [variable])
    with mpmath.workdps(60):
        at = {'x': mpmath.mpf('0.7'), 'y': mpmath.mpf('1.3')}
        h = mpmath.mpf('1e-20')
        up, down = (value(function, at | {variable: at[variable] + sign * h}) for sign in (1, -1))
        assert abs(value(slope, at) - (up - down) / (2 * h)) < mpmath.mpf('1e-35')


def test_what_does_not_depend_on_a_name_has_no_slope():
    assert tree.derivatives(read('sin(y) + 3*t', NAMES, 'here'), ['x', 't']) == \
        [tree.ZERO, tree.number(3.0)]


def test_equal_parts_are_the_same_node():
    one = read('sin(x*y)^2 + sin(x*y)', NAMES, 'here')
    assert sum(part.op == 'sin' for part in tree.parts(one)) == 1


def test_names_and_operations():
    one = read('k*sin(x) + 0*y', {'x', 'y', 'k'}, 'here')
    assert tree.names(one) == {'k', 'x'}
    assert {part.op for part in tree.parts(one)} == {'name', '*', 'sin'}
