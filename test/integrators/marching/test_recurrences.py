# SPDX-License-Identifier: Apache-2.0
"""taylor on formulas: each recurrence against its series to 40 digits, and what it refuses."""

import math

import mpmath
import numpy as np
import pytest

from rigid_body_sim.choice import measured
from rigid_body_sim.compilation.lanes import Plain
from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.integrators import runnable
from rigid_body_sim.integrators.equations import plan as plans
from rigid_body_sim.integrators.marching import recurrences
from rigid_body_sim.integrators.marching.taylor_series import ORDER
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.scene.expressions import reader
from rigid_body_sim.scene.expressions.source import OR_ZERO
from rigid_body_sim.scene.scene import parse_scene

BITS = '0x1.ebe941ccd4609p-1'
ULP = np.finfo(float).eps
BY_HAND = {
    # of u = y0 and v = y1; what mpmath makes of them
    'u*v': lambda u, v: u * v, 'u/v': lambda u, v: u / v, '2/v': lambda u, v: 2 / v,
    'u/3 - 2 + v': lambda u, v: u / 3 - 2 + v, '3 - u': lambda u, v: 3 - u,
    'exp(u)': lambda u, v: mpmath.exp(u), 'log(v)': lambda u, v: mpmath.log(v),
    'sin(u)': lambda u, v: mpmath.sin(u), 'cos(u*v)': lambda u, v: mpmath.cos(u * v),
    'tan(u)': lambda u, v: mpmath.tan(u), 'tanh(u)': lambda u, v: mpmath.tanh(u),
    'sqrt(v)': lambda u, v: mpmath.sqrt(v), 'v^1.7': lambda u, v: v ** mpmath.mpf(1.7),
    'v^(-0.5)': lambda u, v: v ** -0.5, 'u^7': lambda u, v: u ** 7, 'u^-3': lambda u, v: u ** -3,
    'v^u': lambda u, v: v ** u, '-u*abs(2)': lambda u, v: -2 * u}
U, V = (-0.6, 0.7, 0.3, -0.2), (1.3, -0.4, 0.25)


@pytest.mark.without_numba
@pytest.mark.parametrize('text', BY_HAND)
def test_a_recurrence_gives_the_series_of_its_function(text):
    """y0 and y1 are polynomials of t; y2' is the function, so y2 has its series over k + 1."""
    names = {'u': plans.unknown(0), 'v': plans.unknown(1)}
    one, = plans.rewritten([reader.read(text, names, 'here')], names, {})
    plan = plans.Plan([one])
    o = Plain()
    series = [[*numbers, *[0.0] * ORDER] for numbers in (U, V)]

    def first(node):
        """Return the value of a node at t = 0, to round-off."""
        known = {'_y0': mpmath.mpf(U[0]), '_y1': mpmath.mpf(V[0])}
        operations = {
            '+': lambda a, b: a + b, '-': lambda a, b: a - b, '*': lambda a, b: a * b,
            '/': lambda a, b: a / b, '^': lambda a, b: a ** b, 'negative': lambda a: -a,
            'abs': abs, OR_ZERO: lambda a, b: a / b}
        if node.op == 'number':
            return mpmath.mpf(node.args[0])
        if node.op == 'name':
            return known[node.args[0]]
        return operations.get(node.op, getattr(mpmath, node.op, None))(*map(first, node.args))

    with mpmath.workdps(40):
        made = recurrences._Recurrence(o, plan.steps, [float(first(n)) for n in plan.firsts],
                                       [float(first(n)) for n in plan.fixed])
        for k in range(1, ORDER):
            made.advance(k, [numbers[k] for numbers in series])
        u, v = (lambda t, numbers=numbers: mpmath.polyval([*reversed(numbers)], t)
                for numbers in ([mpmath.mpf(x) for x in row] for row in (U, V)))
        exact = mpmath.taylor(lambda t: BY_HAND[text](u(t), v(t)), 0, ORDER - 1)
    found = [made.coefficient(plan.rates[0], k) for k in range(ORDER)]
    sizes = np.maximum.accumulate(np.abs([float(x) for x in exact]))
    # measured: 25 ulp of the largest coefficient so far (tan)
    assert np.abs([float(a - b) for a, b in zip(found, exact, strict=True)]).max() \
        < 200 * ULP * sizes.max()


def scene_of(effects, constraint='free', initial='{angular_velocity: [1, -2, 3]}'):
    return parse_scene('scene: a\nparameters: {n: 2.0, k: 0.3}\n'
                       'body: {mass: 1, inertia: [0.2, 0.3, 0.4]}\n'
                       f'constraint: {constraint}\neffects: [{effects}]\ninitial: {initial}\n')


def state(scene, time, method='taylor', **control):
    out = np.empty(14)
    Stepped(scene, method, **control).start(scene.initial.vector).state(time, out)
    return out


@pytest.mark.without_numba
def test_a_step_errs_by_the_next_order():
    scene = scene_of("torque: {value: ['0.1*sin(3*t)', '-0.1*wy^3', 'k/(1 + t)']}")
    errors = []
    for time in (0.25, 0.3):
        fine = state(scene, time, 'dop8', accuracy=1e-15, horizon=1.0)
        errors.append(np.linalg.norm(state(scene, time, step=time)[1:8] - fine[1:8]))
    slope = math.log(errors[1] / errors[0]) / math.log(0.3 / 0.25)
    assert slope == pytest.approx(ORDER + 1, abs=0.7)


@pytest.mark.without_numba
@pytest.mark.parametrize('accuracy', [1e-3, 1e-6, 1e-9, 1e-12])
def test_accuracy_asked_is_met(accuracy):
    scene = scene_of("torque: {value: ['0.1*sin(3*t)', '-k*wy*sqrt(1 + wy^2)', '0.1*qx']}, "
                     "force: {value: ['-k*x', 0, '-z/(1 + z^2)'], frame: world}",
                     initial='{angular_velocity: [1, -2, 3], velocity: [1, 0, 2]}')
    fine = state(scene, 5.0, 'dop8', accuracy=1e-14, horizon=5.0)
    found = state(scene, 5.0, accuracy=accuracy, horizon=5.0)
    assert np.abs(found - fine).max() < accuracy


@pytest.mark.without_numba
def test_a_power_that_a_parameter_names_passes_through_zero():
    """From x = 0, x'' = -k x^n with n = 2: a product has a series there, a power none."""
    named, written = (
        scene_of(f"force: {{value: ['-k*{power}', 0, 0], frame: world}}",
                 initial='{velocity: [1, 0, 0]}') for power in ('x^n', 'x*x'))
    assert np.array_equal(*(state(one, 2.0, accuracy=1e-12) for one in (named, written)))


@pytest.mark.without_numba
def test_where_nothing_moves_yet_it_sets_out():
    """A spring pulls a body at rest: x = cos(t sqrt(k/M)) - 1."""
    scene = scene_of("force: {value: ['-k*(x + 1)', 0, 0], frame: world}", initial='{}')
    found = state(scene, 2.0, accuracy=1e-13)
    assert found[8] == pytest.approx(math.cos(2.0 * math.sqrt(0.3)) - 1.0, abs=4 * ULP)


@pytest.mark.without_numba
def test_a_series_without_an_end_is_said():
    scene = scene_of("force: {value: ['-k/sqrt(x)', 0, 0], frame: world}",
                     initial='{velocity: [1, 0, 0]}')
    with pytest.raises(NotConverged, match=r'taylor on a: at t = 0\.0 s the state is no'):
        state(scene, 1.0, accuracy=1e-9)


def test_kinks_are_not_for_it():
    scene = scene_of("torque: {value: ['abs(wx)', 0, 0]}")
    assert 'taylor' not in runnable(scene)
    with pytest.raises(BadInput, match='taylor cannot run the scene a'):
        Stepped(scene, 'taylor', accuracy=1e-9)


def test_a_formula_of_too_many_products_is_refused_in_one_line():
    long = [' + '.join(f'sin({k}*w{axis})' for k in range(2, 40)) for axis in 'xyz']
    with pytest.raises(BadInput, match='at most 200: dop8') as refused:
        Stepped(scene_of(f'torque: {{value: {long}}}'), 'taylor', accuracy=1e-9)
    assert 'products of series' in str(refused.value)


def test_auto_leaves_it_to_those_who_name_it():
    """It was measured where what acts is in numbers; a formula takes seconds to compile."""
    assert measured.on_such(scene_of('torque: {value: [1, 0, 0]}'), 'taylor')
    with_formula = scene_of("torque: {value: ['-wx', 0, 0]}")
    assert not measured.on_such(with_formula, 'taylor')
    assert measured.on_such(with_formula, 'gauss16')


def test_compiled_it_has_the_same_bits():
    scene = scene_of('spring: {stiffness: 2, damping: 0.1}', '{hinge: {axis: [1, 2, 2]}}',
                     '{angle: 0.4, rate: 2.0}')
    # the bits of plain Python, NUMBA_DISABLE_JIT=1
    assert state(scene, 2.0, accuracy=1e-12)[4].hex() == BITS
