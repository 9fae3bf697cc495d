# SPDX-License-Identifier: Apache-2.0
"""taylor: its recurrence, error control, dense output, and what it refuses."""

import math

import numpy as np
import pytest
from data import smooth_cases
from near import near

from rigid_body_sim.choice.choose import choose
from rigid_body_sim.compilation import lanes
from rigid_body_sim.errors import BadInput
from rigid_body_sim.integrators import runnable
from rigid_body_sim.integrators.marching import taylor_series
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.numerics.rotations import angle_between
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.study.precision import reference, suite

ULP = np.finfo(float).eps


@pytest.fixture(scope='module')
def top():
    return parse_scene(smooth_cases.text('asymmetric_heavy_top'))


@pytest.fixture(scope='module')
def exact(top):
    """Return the heavy top at 20 s, by another method."""
    out = np.empty(14)
    Stepped(top, 'dop8', accuracy=1e-15).start(top.initial.vector).state(20.0, out)
    return out


def state(scene, time, **control):
    out = np.empty(14)
    Stepped(scene, 'taylor', **control).start(scene.initial.vector).state(time, out)
    return out


def cauchy(a, b, k):
    return math.fsum(a[i] * b[k - i] for i in range(k + 1))


def test_products_of_series_are_complete():
    """Coefficients of a b up to order 15 for random series, by eight lanes and Cauchy's sum."""
    a, b = np.random.default_rng(3).uniform(-1.0, 1.0, (2, taylor_series.ORDER))
    o = lanes.Plain()
    first, second = taylor_series.Series(o, a[0]), taylor_series.Series(o, b[0])
    product = taylor_series.Products(o, (-1, first, second))
    for k in range(taylor_series.ORDER):
        assert abs(product.at(k) + cauchy(a, b, k)) < 8 * ULP    # 2.5
        if k + 1 < taylor_series.ORDER:
            first.add(a[k + 1])
            second.add(b[k + 1])


@pytest.mark.without_numba
def test_a_step_errs_by_the_next_order():
    scene = parse_scene(smooth_cases.text('driven_body'))
    errors = []
    for time in (0.6, 0.7):
        fine = np.empty(14)
        Stepped(scene, 'dop8', accuracy=1e-15, horizon=1.0).start(scene.initial.vector).state(
            time, fine)
        errors.append(np.linalg.norm(state(scene, time, step=time)[1:8] - fine[1:8]))
    # 17.20
    slope = math.log(errors[1] / errors[0]) / math.log(0.7 / 0.6)
    assert slope == pytest.approx(taylor_series.ORDER + 1, abs=0.5)


@pytest.mark.parametrize('accuracy', [1e-3, 1e-6, 1e-9, 1e-12])
def test_accuracy_asked_is_met(top, exact, accuracy):
    # at most 0.09 of it (1e-3)
    found = state(top, 20.0, accuracy=accuracy, horizon=20.0)
    assert angle_between(*found[1:5], *exact[1:5]) < 0.2 * accuracy


def test_steps_follow_a_motion_that_begins_gently():
    """A body falls over from 1e-6 rad off its upper rest: a step planned there is far too long."""
    body = ('{mass: 1.0, inertia: [0.03, 0.02, 0.01], inertia_about: origin, center_of_mass: [0, '
            '0, 0.1]}')
    gentle = parse_scene(f'scene: gentle\nbody: {body}\nconstraint: pivot\n'
                         f'effects: [gravity: {{g: 9.81}}]\ninitial: {{tilt: 1.0e-6}}\n')
    fine = np.empty(14)
    Stepped(gentle, 'dop8', accuracy=1e-14, horizon=5.0).start(gentle.initial.vector).state(
        2.5, fine)
    # 5.5e-11; 1.2 rad with the plans as they are
    assert angle_between(*state(gentle, 2.5, accuracy=1e-9, horizon=5.0)[1:5], *fine[1:5]) < 1e-9


def test_what_is_no_product_is_refused():
    scene = parse_scene(smooth_cases.text('major_axis_relaxation'))
    assert 'taylor' not in runnable(scene)
    with pytest.raises(BadInput, match='taylor cannot run the scene'):
        Stepped(scene, 'taylor', accuracy=1e-9)


def test_a_body_that_does_not_move_stays():
    still = parse_scene('scene: still\nbody: {mass: 1.0, inertia: [1.0, 2.0, 2.5]}\n'
                        'constraint: free\neffects: [torque: {value: [0, 0, 0]}]\n'
                        'initial: {}\n')
    assert np.array_equal(state(still, 1000.0, accuracy=1e-9)[1:], still.initial.vector[1:])


def test_a_body_that_hardly_turns_is_set_turning():
    barely = parse_scene('scene: barely\nbody: {mass: 1.0, inertia: [1.0, 2.0, 2.5]}\n'
                         'constraint: free\neffects: [torque: {value: [0, 0, 1]}]\n'
                         'initial: {angular_velocity: [0, 0, 1.0e-160]}\n')
    found = state(barely, 1.0, accuracy=1e-12)
    # omega' = 1/2.5; measured 6e-17 rad
    assert found[7] == near(0.4, rel=4e-16)
    assert angle_between(*found[1:5], 0.0, 0.0, np.sin(0.1), np.cos(0.1)) < 5e-16


@pytest.mark.without_numba
def test_a_thrown_body_turns_as_if_it_did_not_fall_and_falls_in_a_parabola():
    """Centre of mass off the body's origin; torque in the body."""
    def scene(effects):
        return parse_scene('scene: thrown\nbody: {mass: 2.0, inertia: [0.8, 0.9, 1.3], '
                           'center_of_mass: [0.1, -0.2, 0.3]}\nconstraint: free\n'
                           f'effects: [{effects}torque: {{value: [0.1, 0, 0.5], frame: body}}]\n'
                           'initial: {angular_velocity: [0.4, -0.2, -1.1], velocity: [3.0, 0.0, '
                           '8.0], position: [1.0, 2.0, 3.0]}\n')
    thrown = scene('gravity: {g: 9.81}, ')
    assert 'taylor' in runnable(thrown)
    still, fallen = (state(one, 5.0, accuracy=1e-9) for one in (scene(''), thrown))
    assert np.array_equal(still[:8], fallen[:8])
    # 1 ulp
    assert fallen[8:11] == near(np.add(still[8:11], (0.0, 0.0, -4.905 * 25.0)), 4.0 * ULP)
    # 1 ulp
    assert fallen[11:] == near(np.add(still[11:], (0.0, 0.0, -9.81 * 5.0)), 4.0 * ULP)


@pytest.mark.without_numba
def test_a_hinge_of_any_axis_is_a_body_that_takes_no_torque_across_it():
    """An oblique hinge beside the origin under gravity alone, against the closed form."""
    scene = parse_scene(smooth_cases.text('held_hinge_body'))
    exact = np.empty(14)
    choose(scene, 'exact').solver(scene.initial.vector, Wrench()).state(3.0, exact)
    found = state(scene, 3.0, accuracy=1e-14)
    # an ulp of the angle, 40 rad; measured 4.4
    assert np.abs(found - exact).max() < 40 * ULP * np.abs(exact).max()


@pytest.mark.without_numba
@pytest.mark.parametrize('name', ['driven_pendulum', 'damped_pendulum'])
def test_a_driven_and_a_damped_pendulum_reach_the_reference(name):
    problem = suite.problem(name)
    truth = reference.load(problem)
    floor = truth.floor[-1] + 16 * ULP
    found = state(problem.scene, problem.duration, accuracy=1e-14, horizon=problem.duration)
    error = angle_between(*found[1:5], *map(float, truth.orientation[-1]))
    assert error < 2.0 * floor    # 0.41, 0.76
