# SPDX-License-Identifier: Apache-2.0
"""The plan of a series: what stands before a product does not make it another one."""

import math

import numpy as np
import pytest
from near import near

from rigid_body_sim.integrators.equations import plan as plans
from rigid_body_sim.integrators.equations.expanded import Expanded
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.scene.expressions import reader
from rigid_body_sim.scene.expressions.source import OR_ZERO
from rigid_body_sim.scene.expressions.tree import number, over, parts
from rigid_body_sim.study.precision import suite

NAMES = {'u': plans.unknown(0), 'v': plans.unknown(1), 'w': plans.unknown(2)}


def plan_of(*texts, **parameters):
    """Return the Plan of formulas in the unknowns u, v and w."""
    trees = [reader.read(text, {**NAMES, **dict.fromkeys(parameters)}, 'here') for text in texts]
    return plans.Plan(plans.rewritten(trees, NAMES, parameters))


def operations(tree):
    """Return the operations of a tree."""
    return {one.op for one in parts(tree)}


def value_of(tree, known):
    """Return the value of a tree, given those of its names."""
    if tree.op in ('name', 'number'):
        return known.get(tree.args[0], tree.args[0])
    a, *b = (value_of(one, known) for one in tree.args)
    return {'+': lambda: a + b[0], '-': lambda: a - b[0], '*': lambda: a * b[0],
            '/': lambda: a / b[0], '^': lambda: a ** b[0], 'negative': lambda: -a,
            OR_ZERO: lambda: a / b[0] if b[0] else 0.0,
            **{name: lambda name=name: getattr(math, name)(a)
               for name in ('sin', 'cos', 'exp', 'log', 'sqrt')}}[tree.op]()


@pytest.mark.parametrize(('texts', 'products', 'scalings'), [
    (['u*v', 'v*u'], 1, 0),
    (['2*u*v', '(3*u)*v', 'u*(v/5)', '-u*v', 'u*(-2*v)'], 1, 3),
    (['(k*u)*v + (k*u)*w'], 2, 1),
    (['2*(u*v) - 2*(u*w)'], 2, 1),
    (['(-u)*(-v) + u*v'], 1, 0),
    (['3*(-u)', '-(3*u)', 'u*3'], 0, 1),
    (['u*u*u', '(2*u)*(u*u)'], 2, 1),
    (['exp(u)'], 1, 0), (['sin(u)', 'cos(u)'], 2, 0), (['tan(u)'], 3, 0), (['tanh(u)'], 2, 0),
    (['log(u)'], 1, 0), (['sqrt(u)', 'u^0.5'], 1, 0), (['u^2.5'], 2, 0),
    (['u/v'], 1, 0), (['2/u'], 1, 0), (['u^3'], 2, 0), (['u^7', 'u^k'], 4, 0), (['u^64'], 6, 0),
    (['u^v'], 3, 0), (['u^-1'], 1, 0), (['u^(5 - k)'], 2, 0), (['u^0', '2^k'], 0, 0)])
def test_a_product_is_made_once_whatever_multiplies_it(texts, products, scalings):
    plan = plan_of(*texts, k=7.0)
    assert plan.products == products
    assert sum(step[0] == 'scaled' for step in plan.steps) == scalings


@pytest.mark.parametrize(('text', 'value'), [
    ('2*u*v - (-3)*u*w', lambda u, v, w: 2 * u * v + 3 * u * w),
    ('-(2*u) - (-v)', lambda u, v, w: v - 2 * u),
    ('(-u) + (-v)', lambda u, v, w: -u - v),
    ('-u - v', lambda u, v, w: -u - v),
    ('3*u - 3*v', lambda u, v, w: 3 * (u - v)),
    ('(-2*u)/4*(-w)', lambda u, v, w: u * w / 2),
    ('(u*3)*(5*2) - 0.5*(v - 2*w)', lambda u, v, w: 30 * u - v / 2 + w),
    *((f'v*u^{n}', lambda u, v, w, n=n: v * u ** n) for n in (
        0, 1, 2, 3, 4, 5, 7, 12, 63, 64, -1, -2, -5, -64)),
    ('u^k', lambda u, v, w: u ** 3), ('u^(2*k - 1)', lambda u, v, w: u ** 5),
    ('u^(k + 1)', lambda u, v, w: u ** 4), ('u^(-k)', lambda u, v, w: u ** -3)])
def test_what_stands_before_a_product_keeps_its_sign_and_size(text, value):
    """A whole power is made of products, also where a parameter says that it is one."""
    names = {**NAMES, 'k': None}
    tree, = plans.rewritten([reader.read(text, names, 'here')], NAMES, {'k': 3.0})
    assert '^' not in operations(tree)
    for numbers in np.random.default_rng(1).normal(size=(5, 3)).tolist():
        known = dict(zip(('_y0', '_y1', '_y2'), numbers, strict=True))
        assert value_of(tree, known) == near(value(*numbers), rel=1e-13)


@pytest.mark.parametrize(('text', 'value'), [
    ('u^0.5', lambda u, v, w: u ** 0.5), ('u^-0.5', lambda u, v, w: u ** -0.5),
    ('u^2.5', lambda u, v, w: u ** 2.5), ('u^(v - w)', lambda u, v, w: u ** (v - w)),
    ('2^v', lambda u, v, w: 2 ** v), ('tan(u)', lambda u, v, w: math.tan(u)),
    ('u^(h + 1)', lambda u, v, w: u ** 1.5), ('u^h', lambda u, v, w: u ** 0.5),
    ('u^m', lambda u, v, w: u ** 65), ('u^(m - 1)', lambda u, v, w: u ** 64)])
def test_what_is_no_whole_power_is_a_root_or_an_exponential(text, value):
    """One of more than 64 is not multiplied out."""
    more = {'h': 0.5, 'm': 65.0}
    tree, = plans.rewritten(
        [reader.read(text, {**NAMES, 'h': None, 'm': None}, 'here')], NAMES, more)
    known = {'_y0': 1.3, '_y1': 0.7, '_y2': -0.4, **more}
    assert value_of(tree, known) == near(value(1.3, 0.7, -0.4), rel=1e-14)
    assert 'tan' not in operations(tree)
    assert ('^' in operations(tree)) == (text in ('u^-0.5', 'u^2.5', 'u^(h + 1)', 'u^m'))
    assert ('sqrt' in operations(tree)) == (text in ('u^0.5', 'u^h'))


@pytest.mark.parametrize(('text', 'op', 'series', 'value'), [
    ('u/v', '/', [0.5, 4.0], 0.25), ('3/v', '/', [None, 4.0], 0.25),
    ('log(v)', 'log', [4.0], 0.25), ('sqrt(v)', 'sqrt', [4.0], 0.25),
    ('v^2.5', '^', [4.0, None], 0.25), ('u*v', '*', [0.5, 4.0], None),
    ('v^2.5 + w', '^', [4.0, None], 0.25), ('sqrt(w)', 'sqrt', [0.0], 0.0),
    ('w^2.5', '^', [0.0, None], 0.0), ('u*3', 'scaled', [0.5], 3.0)])
def test_a_step_takes_series_and_the_inverse_of_what_it_divides_by(text, op, series, value):
    """Half of one over a root; nothing over what is 0. Numbers count down from -1."""
    plan, known = plan_of(text), {'_y0': 0.5, '_y1': 4.0, '_y2': 0.0}
    (_, *operands), = (step for step in plan.steps if step[0] == op)
    found = [value_of(plan.firsts[k] if k >= 0 else plan.fixed[-1 - k], known) for k in operands]
    assert [one for one, k in zip(found, operands, strict=True) if k >= 0] == [
        one for one in series if one is not None]
    assert value is None or found[-1] == value
    assert plan.bases == (tuple(operands[:1]) if op in ('sqrt', '^') else ())
    last, = plan.rates
    assert ' + ' in text or plan.steps[last][0] == op


def test_what_is_over_a_number_is_scaled_by_its_inverse():
    u = plans.unknown(0)
    plan = plans.Plan([over(u, number(4.0)), over(number(1.0), number(4.0))])
    assert plan.steps[0] == ('unknown', 0)
    assert plan.steps[1][:2] == ('scaled', 0)
    assert value_of(plan.fixed[-1 - plan.steps[1][2]], {}) == 0.25
    assert value_of(plan.fixed[-1 - plan.rates[1]], {}) == 0.25


def test_a_top_that_a_spring_ties_takes_no_more_products_than_its_equations():
    """Q' 12, omega' 3; nine of R; three squares of d, its root, 1/root; two components of pull d.

    The tie acts at a point of the third axis, so the third component turns nothing.
    """
    equations = Expanded(suite.problem('tied_top').scene)
    assert plans.Plan(equations.rates).products == 12 + 3 + 9 + 3 + 1 + 1 + 2


@pytest.mark.without_numba
def test_a_velocity_that_rises_shortens_no_step():
    """Drag takes the root of omega^2, which comes near 0 at each swing of the axis.

    Steps between two zeros end where the base would fall to a tenth, not where it rises as much.
    """
    problem = suite.problem('top_in_air')
    started = Stepped(problem.scene, 'taylor', 1e-3).start(problem.scene.initial.vector)
    started.state(1.0, np.empty(14))
    course = started._course
    # measured: 37; 68 where a rise counted
    assert course._bound.steps_of(course._pieces[0]) < 50
