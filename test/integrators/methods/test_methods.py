# SPDX-License-Identifier: Apache-2.0
"""The methods beside dop8: documented, of the order they say, and what each keeps or refuses."""

import json
import pathlib
import types
from fractions import Fraction

import numpy as np
import pytest
from data import smooth_cases
from integrators import slopes
from integrators.order_conditions import largest_defect
from numba_only import LONG_IN_PYTHON
from soak import IN_SOAK

from rigid_body_sim.choice.choose import choose, methods_for
from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.integrators import METHODS, protocols, runnable
from rigid_body_sim.integrators.methods import dop8, rk4
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.mechanics.energy import DIAGNOSIS_SIZE
from rigid_body_sim.mechanics.parameters import parameters
from rigid_body_sim.mechanics.potential import energies
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import load_scene, parse_scene
from rigid_body_sim.simulation.simulation import Simulation

TEST = pathlib.Path(__file__).resolve().parent.parent.parent
REFERENCE = json.loads((pathlib.Path(smooth_cases.__file__).parent / 'smooth.json').read_text())
BY_STEP = ('dop8', 'rk4', 'semi_implicit_euler', 'split2', 'split4', 'split6', 'split8')
SPLITS = ('split2', 'split4', 'split6', 'split8')


def scene_of(name):
    return parse_scene(smooth_cases.text(name))


def state(scene, method, time, start=None, **control):
    out = np.empty(14)
    Stepped(scene, method, **control).start(scene.initial.vector if start is None
                                            else start).state(time, out)
    return out


def energy(scene, vector):
    out = np.empty(DIAGNOSIS_SIZE)
    energies(scene).diagnose(parameters(scene), vector, out)
    return out[0] + out[1]


@pytest.fixture(scope='module')
def measured_slopes(plain):
    return plain('integrators/slopes.py')


@pytest.mark.parametrize('name', METHODS)
def test_every_method_is_documented(name):
    method = METHODS[name]
    assert name == method.NAME
    assert len(method.__doc__) > 80
    assert method.__doc__.startswith(name) or name == 'dop8'
    assert method.SOURCE
    assert method.ORDER >= 1
    assert set(method.TAKES) <= {'accuracy', 'step'}
    assert isinstance(method.FAMILY, protocols.Family)


@pytest.mark.parametrize('order', range(1, 5))
def test_order_conditions_of_rk4(order):
    # measured: 0 to order 2, then 9e-18
    assert largest_defect(order, rk4.A, rk4.B) < (1e-20 if order <= 2 else 2e-17)


@pytest.mark.parametrize('name', SPLITS)
def test_compositions_are_symmetric_and_make_a_whole_step(name):
    method = METHODS[name]
    assert method.DRIFTS[::-1] == method.DRIFTS
    assert method.KICKS[::-1] == method.KICKS
    assert len(method.KICKS) == len(method.DRIFTS) + 1
    # what they lack would turn the body by as much in each radian; measured: 5.2e-18 of split6
    for parts in method.DRIFTS, method.KICKS:
        assert abs(sum(map(Fraction, parts)) - 1) < 6e-18


@pytest.mark.parametrize('name', ['rk4', *SPLITS, 'semi_implicit_euler'])
def test_what_takes_a_step_needs_one(name):
    scene = scene_of('asymmetric_heavy_top')
    with pytest.raises(BadInput, match='step'):
        Stepped(scene, name, accuracy=1e-9)


def test_a_convex_body_is_followed_by_methods_with_steps_of_their_own_there_alone(monkeypatch):
    """The general step is written for dop8's coefficients: another method would be a false name.

    taylor and gauss16 have phases of a top that slides and rolls and of a disk that viscous
    rolling friction slows, but not of one that dry rolling friction does.
    """
    other = types.ModuleType('other')
    other.__dict__.update(vars(dop8) | {'NAME': 'other'})
    monkeypatch.setitem(METHODS, 'other', other)
    ball, top, disk = map(load_scene, ('billiard_center', 'tippe_top', 'euler_disk'))
    assert runnable(ball) == ['dop8', 'other']
    assert runnable(top) == ['dop8', 'taylor', 'gauss16']
    assert runnable(disk) == ['dop8', 'taylor', 'gauss16']
    assert runnable(load_scene('euler_disk', {
        'effects.rolling_friction': {'dry': 1e-4}})) == ['dop8']
    with pytest.raises(BadInput,
                       match=r"'other' cannot run a body on the table; .* can: dop8, taylor"):
        Stepped(top, 'other', accuracy=1e-9)


@pytest.mark.parametrize('name', ['lsoda', 'radau'])
def test_what_chooses_its_steps_takes_none(name):
    with pytest.raises(BadInput, match='accuracy'):
        Stepped(scene_of('asymmetric_heavy_top'), name, step=1e-3)


@pytest.mark.parametrize('case', ['thrown_with_drag', 'damped_top', 'major_axis_relaxation'])
def test_heat_leaves_split2_alone_of_the_compositions(case):
    scene = scene_of(case)
    assert (set(runnable(scene)) - {'taylor'}
            == set(METHODS) - {'split4', 'split6', 'split8', 'taylor'})
    assert ('taylor' in runnable(scene)) == (
        case != 'major_axis_relaxation'), 'series have drag, but no dissipation'
    with pytest.raises(BadInput) as caught:
        choose(scene, 'split6', step=0.01)
    for name in methods_for(scene):
        assert name in str(caught.value)
    assert 'split4' not in str(caught.value)


def test_scenes_without_heat_run_by_every_method():
    assert set(runnable(scene_of('asymmetric_heavy_top'))) == set(METHODS)


# measured: 1.01, 3.95, 2.00, 3.92, 6.03, 8.29, 15.4; split6 is above its order on the top, 7.1
@pytest.mark.parametrize('name', [name for name, *_ in slopes.CASES])
def test_slope_of_the_error_is_the_order(name, measured_slopes):
    order = METHODS[name].ORDER
    assert measured_slopes[name] == pytest.approx(order, abs=max(0.35, order / 16.0))


@pytest.mark.without_numba
@pytest.mark.parametrize('name', ['split4', pytest.param('split8', marks=IN_SOAK)])
def test_reversed_motion_comes_back(name):
    scene = scene_of('asymmetric_heavy_top')
    there = state(scene, name, 2.0, step=0.01)
    there[0], there[5:8] = 0.0, -there[5:8]
    back = state(scene, name, 2.0, start=there, step=0.01)
    back[5:8] *= -1.0
    assert slopes.error(back, scene.initial.vector) < 1e-12


@pytest.mark.without_numba
def test_runge_kutta_does_not_come_back():
    scene = scene_of('asymmetric_heavy_top')
    there = state(scene, 'rk4', 2.0, step=0.01)
    there[0], there[5:8] = 0.0, -there[5:8]
    back = state(scene, 'rk4', 2.0, start=there, step=0.01)
    back[5:8] *= -1.0
    assert slopes.error(back, scene.initial.vector) > 1e-6


@LONG_IN_PYTHON
def test_energy_does_not_walk():
    scene = scene_of('asymmetric_heavy_top')
    out = np.empty((201, 14))
    # 1e5 steps
    solver = Stepped(scene, 'split4', step=5e-4).start(scene.initial.vector)
    solver.states(np.linspace(0.0, 50.0, 201), out)
    start = energy(scene, out[0])
    residual = np.array([energy(scene, row) / start - 1.0 for row in out])
    # 1.8e-15, of which 1e-15 is truncation and does not grow; plain sums: 3e-14
    assert np.abs(residual).max() < 5e-15


@pytest.mark.without_numba
@pytest.mark.filterwarnings('error')
@pytest.mark.parametrize('law', ['log(x)', 'sqrt(0.01 - t)'])
@pytest.mark.parametrize('name', ['lsoda', 'radau'])
def test_rates_that_are_not_finite_end_with_one_error(name, law):
    """SciPy raises a ValueError of its own where it takes the Jacobian apart."""
    scene = parse_scene('scene: a\nbody: {mass: 1, inertia: [1, 2, 2.5]}\nconstraint: free\n'
                        f"effects: [torque: {{value: ['{law}', 0, 0]}}]\n"
                        'initial: {angular_velocity: [1, 2, 3]}\n')
    with pytest.raises(NotConverged, match=r'not finite|no longer finite'):
        Stepped(scene, name, accuracy=1e-6, horizon=1.0).start(scene.initial.vector).state(
            1.0, np.empty(14))


@pytest.mark.parametrize('name', ['dop8', 'lsoda', 'radau'])
def test_too_many_turns_to_count_end_with_one_error(name):
    scene = parse_scene(smooth_cases.text('driven_body').replace(
        '[0.1, 2.0, 0.3]', '[0.0, 0.0, 1.0e+75]'))
    with pytest.raises(NotConverged, match=r'at t = 0\.0 s the body turns with 1e\+75 rad/s'):
        state(scene, name, 1.0, accuracy=1e-6)


# 4.9e-10; 5.4e-8
@pytest.mark.parametrize(('name', 'accuracy', 'bound'), [
    ('lsoda', 1e-10, 5e-9), ('radau', 1e-7, 5e-7)])
def test_solvers_of_scipy_are_as_good_as_asked(name, accuracy, bound):
    scene = scene_of('driven_body')
    found, coarse = (state(scene, name, 1.0, accuracy=accuracy),
                     state(scene, name, 1.0, accuracy=1e3 * accuracy))
    exact = np.array([float(x) for x in REFERENCE['driven_body']['1.0']['state']])
    assert slopes.error(found, [0.0, *exact]) < bound
    assert slopes.error(coarse, [0.0, *exact]) > 10.0 * slopes.error(found, [0.0, *exact])


@pytest.mark.parametrize('name', ['rk4', 'gauss16', 'split4', 'lsoda'])
def test_ball_under_a_wrench_is_refused_where_steps_cannot_end_with_sliding(name):
    ball = load_scene('billiard_center')
    control = {'accuracy': 1e-6} if 'accuracy' in METHODS[name].TAKES else {'step': 1e-3}
    with pytest.raises(BadInput, match='those that can: dop8'):
        Stepped(ball, name, wrench=Wrench((1.0, 0.0, 0.0)), **control)


@pytest.mark.without_numba
@pytest.mark.parametrize('name', ['lsoda', 'radau'])
def test_scipys_methods_start_a_body_at_rest(name):
    """The first step of lsoda would be infinite: a bat before its strike gave 't = inf s'."""
    simulation = Simulation(load_scene('baseball_bat'), integrator=name, accuracy=1e-3)
    simulation.advance(2)
    assert abs(simulation.state.angular_velocity[2]) > 1.0
    still = parse_scene('scene: still\nbody: {mass: 1, inertia: [1, 2, 3]}\nconstraint: free\n'
                        'effects: [torque: {times: [0.5], values: [[0, 0, 3]]}]\ninitial: {}\n')
    simulation = Simulation(still, integrator=name, accuracy=1e-6)
    simulation.advance(1500)
    assert abs(simulation.state.angular_velocity[2] - 1.0) < 1e-5
