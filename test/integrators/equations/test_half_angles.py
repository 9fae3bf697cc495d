# SPDX-License-Identifier: Apache-2.0
"""What acts on a hinge as sums of half and whole angles: the same numbers, with fewer products."""

import math

import numpy as np
import pytest
from near import near

from rigid_body_sim.integrators.equations import plan as plans
from rigid_body_sim.integrators.equations.half_angles import Sums
from rigid_body_sim.scene.expressions import reader, tree

PHI, RATE = plans.unknown(0), plans.unknown(1)
HALF = tree.times(tree.number(0.5), PHI)
NAMES = {'s': tree.term('sin', HALF), 'c': tree.term('cos', HALF), 'phi': PHI, 'v': RATE}
A, B = (tree.term('name', name) for name in 'ab')
BY_OP = {'+': lambda a, b: a + b, '-': lambda a, b: a - b, '*': lambda a, b: a * b,
         '/': lambda a, b: a / b, 'negative': lambda a: -a, 'sin': math.sin, 'cos': math.cos,
         'exp': math.exp}


def value(one, known):
    """Return the value of a tree."""
    if one.op == 'number' or one in known:
        return known.get(one, one.args[0])
    return BY_OP[one.op](*(value(arg, known) for arg in one.args))


@pytest.mark.parametrize(('text', 'products'), [
    ('s*s', 0), ('s*c', 0), ('c*s', 0), ('c*c', 0), ('2*s*c - 3*c*c + s*s', 0),
    ('(a*s + b*c)*(c - 2*s)', 0), ('(a*s - b*c)*(1 + c)', 0), ('(1 - s)*(a*s)', 0),
    ('-(s*s) - a*(c*s)', 0), ('(s*c - b)/a', 0), ('(s*s)*(a*b) + (a - b)*c', 0),
    ('(s*v)*c', 1), ('c*(s*v)', 1), ('(a*s - c)*(b*v*s)', 1), ('s*(c*v - s*v)', 1),
    ('(s*c)*s', 1), ('s*(1 + v)', 1), ('(s + v)*(c - v)', 2), ('v*v - phi*s', 2),
    ('v/(2 + s*c)', 1), ('(a/b)*s - 0*c', 0), ('s*s - s*s', 0), ('a*b - 2', 0)])
def test_a_sum_has_the_value_of_its_tree_and_no_product_of_half_angles(text, products):
    """Products of two half angles are whole ones; each other series is multiplied once."""
    read = reader.read(text, {**NAMES, 'a': A, 'b': B}, 'here')
    one, = plans.rewritten([read], NAMES, {})
    found, = Sums(PHI).of([one])
    for numbers in np.random.default_rng(1).normal(size=(4, 4)).tolist():
        known = dict(zip((PHI, RATE, A, B), numbers, strict=True))
        # measured: 1e-15
        assert value(found, known) == pytest.approx(value(one, known), rel=1e-13, abs=1e-14)
    made = plans.Plan([found])
    assert sum(step[0] in '*/' for step in made.steps) <= products


def test_an_exponential_of_half_angles_is_a_series_of_its_own():
    one = tree.term('exp', tree.times(NAMES['s'], NAMES['c']))
    found, = Sums(PHI).of([tree.times(NAMES['s'], one)])
    known = {PHI: 0.7}
    assert value(found, known) == near(math.sin(0.35) * math.exp(0.5 * math.sin(0.7)), rel=1e-15)


@pytest.mark.parametrize('factor', [-2.0, -1.0, -0.5, 1.0, 3.0])
def test_a_number_before_a_sum_multiplies_all_of_it(factor):
    one = tree.term('*', tree.number(factor), tree.plus(NAMES['s'], RATE))
    found, = Sums(PHI).of([one])
    assert value(found, {PHI: 0.7, RATE: 1.3}) == near(
        factor * (math.sin(0.35) + 1.3), rel=1e-15)
