# SPDX-License-Identifier: Apache-2.0
"""dop8: coefficients, order, and what a solver that steps promises."""

import math

import numpy as np
import pytest
from data import smooth_cases
from integrators.order_conditions import defects, largest_defect
from scipy.integrate import DOP853

from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.integrators.methods import dop8
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.numerics.rotations import angle_between
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import parse_scene


@pytest.fixture(scope='module')
def top():
    return parse_scene(smooth_cases.text('asymmetric_heavy_top'))


def state(scene, time, **control):
    out = np.empty(14)
    Stepped(scene, 'dop8', **control).start(scene.initial.vector).state(time, out)
    return out


@pytest.mark.parametrize('order', range(1, 9))
def test_order_conditions(order):
    # measured: 3.5e-18, above order 5 7.1e-16, the rounding of the coefficients to doubles
    assert largest_defect(order, dop8.A, dop8.B) < (4e-18 if order <= 5 else 1e-15)


def test_coefficients_are_those_of_the_method_to_an_ulp():
    """Those of scipy are the nearest doubles."""
    theirs = [*DOP853.A[:len(dop8.A)], DOP853.B]
    for row, nearest in zip((*dop8.A, dop8.B), theirs, strict=True):
        ours = np.array([row.get(j, 0.0) for j in range(len(nearest))])
        assert (np.abs(ours - nearest) <= 1.01 * np.spacing(np.abs(nearest))).all()


@pytest.mark.parametrize('accuracy', [1e-12, 1e-14])
def test_a_body_that_turns_far_lags_by_no_more_than_rounding(accuracy):
    """It lagged by 7e-17 rad a radian, at any accuracy: the weights did not add up to 1."""
    scene = parse_scene('scene: ball\nbody: {mass: 1.0, shape: {solid_sphere: {radius: 1.0}}}\n'
                        'constraint: free\neffects: []\n'
                        'initial: {angular_velocity: [0, 0, 1.0]}\n')
    exact = 0.0, 0.0, math.sin(1.5e4), math.cos(1.5e4)
    found = state(scene, 3e4, accuracy=accuracy, horizon=3e4)
    # measured: 3.2e-14 and 1.3e-14, where it was 2.1e-12
    assert angle_between(*found[1:5], *exact) < 3e-13


def test_order_is_not_nine():
    assert any(defect > 1e-5 for defect in defects(9, dop8.A, dop8.B))


@pytest.mark.parametrize(('estimate', 'order'), [(dop8.E5, 5), (dop8.E3, 3)])
def test_error_estimates_compare_with_methods_of_lower_order(estimate, order):
    lower = {stage: dop8.B.get(stage, 0.0) - estimate.get(stage, 0.0)
             for stage in {*dop8.B, *estimate}}
    assert max(largest_defect(k, dop8.A, lower) for k in range(1, order + 1)) < 2e-15    # 1.1e-15
    assert largest_defect(order + 1, dop8.A, lower) > 1e-4


@pytest.mark.without_numba
def test_slope_of_the_error_is_the_order(top):
    exact = state(top, 0.4, accuracy=1e-14)
    errors = [angle_between(*state(top, 0.4, step=0.4 / steps)[1:5], *exact[1:5])
              for steps in (20, 40)]
    assert math.log2(errors[0] / errors[1]) == pytest.approx(8.0, abs=0.6)    # 8.2


@pytest.mark.parametrize('accuracy', [1e-4, 1e-7, 1e-10])
def test_accuracy_asked_is_met(top, accuracy):
    exact, found = state(top, 20.0, accuracy=1e-14), state(top, 20.0, accuracy=accuracy)
    assert angle_between(*found[1:5], *exact[1:5]) < accuracy


def test_states_do_not_depend_on_what_else_was_asked(top):
    times = np.random.default_rng(7).uniform(0.0, 30.0, 400)
    solver = Stepped(top, 'dop8', accuracy=1e-9).start(top.initial.vector)
    together, reversed_ = np.empty((400, 14)), np.empty((400, 14))
    solver.states(times, together)
    solver.states(times[::-1], reversed_)
    alone = np.empty(14)
    for k in (0, 199, 399):
        Stepped(top, 'dop8', accuracy=1e-9).start(top.initial.vector).state(times[k], alone)
        assert np.array_equal(alone, together[k])
    assert np.array_equal(reversed_, together[::-1])


@pytest.mark.without_numba
def test_checkpoints_are_thinned_and_still_right(top):
    solver = Stepped(top, 'dop8', step=0.005).start(top.initial.vector)
    early, late, again = np.empty(14), np.empty(14), np.empty(14)
    solver.state(0.123, early)
    solver.state(30.0, late)    # 6000 steps, 128 checkpoints, at first every 32nd
    solver.state(0.123, again)
    assert np.array_equal(early, again)
    solver.state(30.0, again)
    assert np.array_equal(late, again)


@pytest.mark.without_numba
def test_states_are_continuous_at_the_nodes(top):
    times = np.linspace(0.0, 0.02, 20001)
    out = np.empty((20001, 14))
    Stepped(top, 'dop8', step=0.001).start(top.initial.vector).states(times, out)
    assert np.abs(np.diff(out[:, 1:5], axis=0)).max() < 60e-6    # omega/2 times 1e-6 s


@pytest.mark.without_numba
def test_the_norm_of_the_quaternion_stays():
    scene = parse_scene(smooth_cases.text('asymmetric_heavy_top'))
    out = state(scene, 100.0, step=0.01)
    assert abs(out[1:5] @ out[1:5] - 1.0) < 5e-16


@pytest.mark.without_numba
def test_a_start_between_breakpoints_keeps_the_time():
    scene = parse_scene(smooth_cases.text('driven_in_pieces'))
    through, middle, on = np.empty(14), np.empty(14), np.empty(14)
    first = Stepped(scene, 'dop8', accuracy=1e-14).start(scene.initial.vector)
    first.state(2.0, middle)
    first.state(4.0, through)
    Stepped(scene, 'dop8', accuracy=1e-14).start(middle).state(4.0, on)
    assert np.abs(on - through).max() < 4e-15    # 1.4e-15


def test_what_does_nothing_is_not_computed():
    scene = parse_scene(smooth_cases.text('driven_body').replace(
        '[torque: {value: [0.3, -0.2, 0.5]}]', '[]'))
    idle = Stepped(scene, 'dop8', accuracy=1e-9, wrench=Wrench())
    assert not idle.start(scene.initial.vector).entries(5.0).any()


@pytest.mark.parametrize(('control', 'where'),
                         [({}, 'method'), ({'step': 0.0}, 'step'), ({'step': math.nan}, 'step'),
                          ({'accuracy': 1e-17}, 'accuracy'), ({'accuracy': math.nan}, 'accuracy')])
def test_control_that_cannot_be_is_refused(top, control, where):
    with pytest.raises(BadInput) as refused:
        Stepped(top, 'dop8', **control)
    assert refused.value.where == where


@pytest.mark.parametrize('times', [[-0.1], [math.nan], [1.0, math.inf]])
def test_times_that_cannot_be_are_refused(top, times):
    solver = Stepped(top, 'dop8', accuracy=1e-6).start(top.initial.vector)
    with pytest.raises(BadInput, match='finite times'):
        solver.states(np.array(times), np.empty((len(times), 14)))


def test_failure_says_when_and_is_not_nan(top):
    solver = Stepped(top, 'dop8', step=1e6).start(top.initial.vector)
    with pytest.raises(NotConverged, match='dop8 on asymmetric_heavy_top: at t = '):
        solver.state(1e8, np.empty(14))
