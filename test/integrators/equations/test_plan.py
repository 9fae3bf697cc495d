# SPDX-License-Identifier: Apache-2.0
"""The plan of a series: what stands before a product does not make it another one."""

import numpy as np
import pytest
from near import near

from rigid_body_sim.integrators.equations import plan as plans
from rigid_body_sim.integrators.equations.expanded import Expanded
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.scene.expressions import reader
from rigid_body_sim.study.precision import suite

NAMES = {'u': plans.unknown(0), 'v': plans.unknown(1), 'w': plans.unknown(2)}


def plan_of(*texts, **parameters):
    """Return the Plan of formulas in the unknowns u, v and w."""
    trees = [reader.read(text, {**NAMES, **dict.fromkeys(parameters)}, 'here') for text in texts]
    return plans.Plan(plans.rewritten(trees, NAMES, parameters))


@pytest.mark.parametrize(('texts', 'products', 'scalings'), [
    (['u*v', 'v*u'], 1, 0),
    (['2*u*v', '(3*u)*v', 'u*(v/5)', '-u*v', 'u*(-2*v)'], 1, 3),
    (['(k*u)*v + (k*u)*w'], 2, 1),
    (['2*(u*v) - 2*(u*w)'], 2, 1),
    (['(-u)*(-v) + u*v'], 1, 0),
    (['3*(-u)', '-(3*u)', 'u*3'], 0, 1),
    (['u*u*u', '(2*u)*(u*u)'], 2, 1)])
def test_a_product_is_made_once_whatever_multiplies_it(texts, products, scalings):
    plan = plan_of(*texts, k=1.5)
    assert plan.products == products
    assert sum(step[0] == 'scaled' for step in plan.steps) == scalings


@pytest.mark.parametrize(('text', 'value'), [
    ('2*u*v - (-3)*u*w', lambda u, v, w: 2 * u * v + 3 * u * w),
    ('-(2*u) - (-v)', lambda u, v, w: v - 2 * u),
    ('(-u) + (-v)', lambda u, v, w: -u - v),
    ('-u - v', lambda u, v, w: -u - v),
    ('3*u - 3*v', lambda u, v, w: 3 * (u - v)),
    ('(-2*u)/4*(-w)', lambda u, v, w: u * w / 2),
    ('(u*3)*(5*2) - 0.5*(v - 2*w)', lambda u, v, w: 30 * u - v / 2 + w)])
def test_what_stands_before_a_product_keeps_its_sign_and_size(text, value):
    tree, = plans.rewritten([reader.read(text, NAMES, 'here')], NAMES, {})
    for numbers in np.random.default_rng(1).normal(size=(5, 3)).tolist():
        known = dict(zip((plans.unknown(k) for k in range(3)), numbers, strict=True))

        def of(one, known=known):
            if one.op == 'number' or one in known:
                return known.get(one, one.args[0])
            a, *b = map(of, one.args)
            return {'+': lambda: a + b[0], '-': lambda: a - b[0], '*': lambda: a * b[0],
                    '/': lambda: a / b[0], 'negative': lambda: -a}[one.op]()
        assert of(tree) == near(value(*numbers), rel=1e-14)


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
