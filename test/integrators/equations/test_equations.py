# SPDX-License-Identifier: Apache-2.0
"""The sources of the sums of what acts: each takes its own values and the state it asks for."""

import functools
import types

import numpy as np
import pytest
from near import near

from rigid_body_sim.errors import BadInput
from rigid_body_sim.integrators.equations import (
    carried,
    equations,
    euler,
    field,
    flying,
    hinged,
    hinged_field,
    turning,
)
from rigid_body_sim.integrators.equations.equations import Equations
from rigid_body_sim.scene.effects.protocol import Acting
from rigid_body_sim.scene.scene import parse_scene

pytestmark = pytest.mark.without_numba


def two(*arguments):
    """Return what it was called with, for each of two switches."""
    return ('first', arguments), ('second', arguments)


def alone(*arguments):
    """Return what it was called with, for one switch."""
    return (('alone', arguments),)


def acting(kernel, values, modes, in_field):
    """Return what stands for an Acting."""
    return types.SimpleNamespace(switching=kernel and f'{__name__}:{kernel}',
                                 values=(0.0,) * values, modes=[0] * modes, in_field=in_field)


def test_switches_take_the_values_of_their_own_effects():
    """Values stand after the fixed parameters, those of effects without a switch among them."""
    made = object.__new__(Equations)
    made.fixed_count = 4
    made._acting = lambda time: [
        acting('', 2, 0, False), acting('two', 3, 2, False), acting('', 1, 1, True),
        acting('alone', 1, 1, True), acting('alone', 2, 1, False)]
    names = {'compiled': lambda function: function}
    exec(made.switching_source(), names)
    state, place = tuple(range(100, 110)), tuple(range(110, 114))
    assert names['switching'](np.arange(20.0), *state, *place) == (
        ('first', (6.0, 7.0, 8.0, *state)), ('second', (6.0, 7.0, 8.0, *state)),
        ('alone', (10.0, *state, *place)), ('alone', (11.0, 12.0, *state)))


ROWS = np.random.default_rng(2).normal(size=(5, 3, 20)).round(3)


def linear(k, *numbers):
    """Return what kernel k makes of its values and the state: another linear function of each."""
    return tuple((ROWS[k][:, :len(numbers)] @ numbers).tolist())


weighs, blows, creeps, brakes, drags = (functools.partial(linear, k) for k in range(5))
ACTS = [Acting(f'{__name__}:weighs', (2.0, 3.0), 'torque', 'potential'),
        Acting(f'{__name__}:blows', (4.0,), 'force', 'work', in_field=True),
        Acting(f'{__name__}:creeps', (0.5, 6.0), 'turning', 'heat'),
        Acting(f'{__name__}:brakes', (7.0,), 'torque', 'heat', in_field=True, inner=True),
        Acting(f'{__name__}:drags', (), 'force', 'heat')]
MOMENTS, EULER, INVERSE = (2.0, 3.0, 4.0), (-0.5, 0.7, -0.2), (0.5, 0.3, 0.25)
BODY = (0.1, -0.5, 0.5, 0.7, 1.0, -2.0, 3.0, 7.0, -8.0, 9.0)
PLACE = (0.4, 4.0, -5.0, 6.0)


def made(source, name, *arguments):
    """Return what a kernel returns, given its source, for the parameters of ACTS."""
    p = np.zeros(euler.FIXED)
    for first, numbers in ((euler.MOMENTS, MOMENTS), (euler.EULER, EULER),
                           (euler.INVERSE, INVERSE)):
        p[first:first + 3] = numbers
    names = {'compiled': lambda function: function}
    exec(source, names)
    return names[name]((*p.tolist(), 2.0, 3.0, 4.0, 0.5, 6.0, 7.0), *arguments)


def test_what_acts_is_summed_by_what_it_gives_and_booked_by_what_it_is():
    """Axes that creep under an angular momentum L = I omega turn by the potential's torque, too.

    They take with them a torque I omega x u, which the ledger books with the heat; what acts
    against a part inside the body is in the couple and told apart.
    """
    acts, (wx, wy, wz), v = (*BODY, *PLACE), BODY[4:7], BODY[7:10]
    weight, wind, brake, drag = (np.array(force) for force in (
        weighs(2.0, 3.0, *BODY), blows(4.0, *acts), brakes(7.0, *acts), drags(*BODY)))
    turn = creeps(0.5, 6.0, *BODY) + 0.5 * weight
    kept = np.cross(np.multiply(MOMENTS, BODY[4:7]), turn)
    calls, fields = equations._calls(ACTS, euler.FIXED), equations.STATE + equations.FIELD
    found = made(equations.torque_source(calls, fields), 'torque', *acts)
    assert found == near(weight + brake + kept, rel=1e-13)
    found = made(equations.force_source(calls, fields), 'force', *acts)
    assert found == near(wind + drag, rel=1e-13)
    # a rate of turning that asks for no place, after what asks for none
    plain = equations._calls([ACTS[0], ACTS[2]], euler.FIXED)
    p_turn = creeps(4.0, 0.5, *BODY) + 4.0 * weight
    assert made(equations.turning_source(plain), 'turning', *BODY) == near(p_turn, rel=1e-13)
    found = made(equations._axes_rate(calls, fields), 'axes_rate', *acts)
    assert found == near(BODY[4:7] + turn, rel=1e-13)
    found = made(equations._omega_rate(calls, fields), 'omega_rate', *acts)
    assert found == near(np.multiply(EULER, (wy * wz, wz * wx, wx * wy))
                         + np.multiply(INVERSE, weight + brake + kept), rel=1e-13)
    found = made(equations.applied_source(ACTS, euler.FIXED), 'applied', *acts)
    heat = -(kept @ BODY[4:7] + brake @ BODY[4:7] + drag @ v)
    assert found == near([*wind + drag, *weight + brake, wind @ v, heat, *brake], rel=1e-13)


def test_where_nothing_acts_a_body_turns_by_itself():
    wx, wy, wz = BODY[4:7]
    assert made(equations.torque_source(()), 'torque', *BODY) == (0.0, 0.0, 0.0)
    assert made(equations.force_source(()), 'force', *BODY) == (0.0, 0.0, 0.0)
    assert made(equations.turning_source(()), 'turning', *BODY) == (0.0, 0.0, 0.0)
    assert made(equations._axes_rate((), equations.STATE), 'axes_rate', *BODY) == BODY[4:7]
    found = made(equations._omega_rate((), equations.STATE), 'omega_rate', *BODY)
    assert found == (-0.5 * wy * wz, 0.7 * wz * wx, -0.2 * wx * wy)
    found = made(equations.applied_source([], euler.FIXED), 'applied', *BODY, *PLACE)
    assert found == (0.0,) * 11


def test_a_path_takes_its_own_values_and_the_time():
    path = types.SimpleNamespace(name=f'{__name__}:drags', values=(0.0,) * 3)
    assert made(equations.path_source(path, euler.FIXED + 1), 'path', 0.4) == near(
        drags(3.0, 4.0, 0.5, 0.4), rel=1e-15)


def equations_of(constraint, *effects, inertia='[0.2, 0.3, 0.4]'):
    return Equations(parse_scene(
        f'scene: a\nbody: {{mass: 2, inertia: {inertia}, center_of_mass: [0.1, 0, 0]}}\n'
        f'constraint: {constraint}\neffects: [{", ".join(effects)}]\ninitial: {{}}\n'))


TORQUE, WEIGHT, HINGE = 'torque: {value: [0.1, 0, 0]}', 'gravity: {g: 9.81}', (
    '{hinge: {axis: [1, 2, 2]}}')


@pytest.mark.parametrize(('constraint', 'effect', 'kind', 'is_so'), [
    ('free', TORQUE, turning, {'polynomial'}),
    ('free', WEIGHT, flying, {'drifts', 'polynomial'}),
    ('free', 'drag: {linear: 0.1}', flying, {'drifts', 'polynomial', 'makes_heat'}),
    ('free', "torque: {value: ['0.1*wx', 0, 0]}", turning, {'makes_heat'}),
    ('free', "force: {value: ['0.1*t', 0, 0]}", field, {'drifts', 'in_field', 'timed'}),
    ('free', "force: {value: ['0.1*x', 0, 0]}", field, {'drifts', 'in_field'}),
    ('pivot', WEIGHT, turning, {'polynomial'}),
    ('pivot', 'internal_dissipation: {coefficient: 0.1}', turning, {'polynomial', 'makes_heat'}),
    ('{pivot: {motion: [0.1, 0.2, 0.3]}}', WEIGHT, carried, {'in_field', 'timed'}),
    (HINGE, WEIGHT, hinged, {'on_hinge', 'polynomial'}),
    (HINGE, "torque: {value: ['0.1*t', 0, 0]}", hinged_field, {'on_hinge', 'in_field', 'timed'})])
@pytest.mark.parametrize('first', [True, False])
def test_a_scene_has_the_unknowns_that_any_of_its_effects_asks_for(
        constraint, effect, kind, is_so, first):
    """Beside a constant torque, which asks for none; two of a kind are no other kind."""
    made = equations_of(constraint, *([effect, TORQUE] if first else [TORQUE, effect]))
    assert made.kind is kind
    names = 'on_hinge', 'drifts', 'in_field', 'timed', 'polynomial', 'makes_heat'
    assert {name for name in names if getattr(made, name)} == is_so
    assert len(made.held(0.0)) == made.parameter_count
    assert (made.modes, made.grip, made.gripping) == ([], 0.0, [])
    apart = 'dissipation' in effect
    assert made.groups == (turning.APART if apart else kind.GROUPS)


def test_friction_of_a_bearing_holds_by_its_torque_and_switches_with_the_rate():
    """A torque with a kink has a switch, too, but holds nothing."""
    made = equations_of(HINGE, TORQUE, "torque: {value: ['abs(angle)', 0, 0]}",
                        'dry_friction: {torque: 0.2}', WEIGHT)
    p, (first, *others, place) = made.held(0.0), made.modes
    assert (made.grip, made.gripping) == (0.2, [len(others) + 1])
    assert made.fixed_count + 3 <= first < place - 1    # behind those of the constant torque
    assert (p[first], *p[place - 1:place + 1]) == (0.0, 0.2, 0.0)
    assert p[place + 1:place + 4] == near([1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0], rel=1e-15)


def test_eulers_numbers_are_those_of_the_moments():
    """(I2 - I3)/I1 and 1/I1, about the pivot; 0 of a rod along itself, and of a hinge but one."""
    p = equations_of('pivot', TORQUE).held(0.0)
    moments = np.array([0.2, 0.32, 0.42])    # with 2 kg at 0.1 m along x
    assert euler.load_inverse(p) == near(1.0 / moments, rel=1e-14)
    differences = np.array([-0.1, 0.22, -0.12])
    assert euler.load_euler(p) == near(differences / moments, rel=1e-13)
    p = equations_of('free', TORQUE, inertia='[0, 0.3, 0.3]').held(0.0)
    assert euler.load_inverse(p) == near((0.0, 1.0 / 0.3, 1.0 / 0.3), rel=1e-14)
    assert euler.load_euler(p) == near((0.0, 1.0, -1.0), rel=1e-14)
    p = equations_of('{hinge: {axis: [0, 0, 1]}}', TORQUE).held(0.0)
    assert euler.load_inverse(p) == near((1.0 / 0.42, 0.0, 0.0), rel=1e-14)
    assert euler.load_euler(p) == (0.0, 0.0, 0.0)


def test_what_acts_holds_from_each_jump_on():
    made = equations_of('pivot', 'torque: {times: [1, 3], values: [[0, 0, 1], [0, 0, 2]]}',
                        'torque: {times: [2], values: [[5, 0, 0]]}')
    assert made.breakpoints == (1.0, 2.0, 3.0)
    values = [made.held(time)[made.fixed_count:].tolist() for time in (0.5, 1.0, 1.9, 2.0, 3.0)]
    assert values == [[0.0] * 6, [0.0, 0.0, 1.0, *[0.0] * 3], [0.0, 0.0, 1.0, *[0.0] * 3],
                      [0.0, 0.0, 1.0, 5.0, 0.0, 0.0], [0.0, 0.0, 2.0, 5.0, 0.0, 0.0]]
    p = made.held(0.5)
    p[:made.fixed_count] = 7.0
    later = made.continued(p, 2.5)
    assert (later[:made.fixed_count] == 7.0).all()
    assert later[made.fixed_count:].tolist() == values[3]
    assert made.held(0.5)[0] != 7.0    # an array of the caller's own


def test_a_body_without_a_moment_about_its_hinge_is_refused():
    scene, body = types.SimpleNamespace(name='rod'), types.SimpleNamespace(hinge_moment=1e-300)
    equations.refuse_no_moment(scene, body)
    body.hinge_moment = 0.0
    with pytest.raises(BadInput, match=r'rod: constraint\.hinge: the moment of inertia about'):
        equations.refuse_no_moment(scene, body)


@pytest.mark.parametrize('constraint', ['pivot', HINGE])
def test_a_force_is_refused_where_a_bearing_would_balance_it(constraint):
    """Also one beside a torque of the same effect, whatever the effects before it give."""
    sail = types.SimpleNamespace(name='sail', breakpoints=(), acting=lambda frame, time: [
        types.SimpleNamespace(gives=gives) for gives in ('torque', 'force')])
    scene = parse_scene(f'scene: s\nbody: {{mass: 1, inertia: [1, 1, 1]}}\nconstraint: '
                        f'{constraint}\neffects: [{TORQUE}]\ninitial: {{}}\n')
    with pytest.raises(BadInput, match=r'^effects\.sail: gives a force, and a bearing'):
        Equations(scene, sail)


def test_a_start_has_the_parameters_of_its_time_and_all_unknowns():
    made = equations_of(HINGE, 'torque: {times: [1], values: [[0, 0, 5]]}')
    vector = np.zeros(14)
    vector[0], vector[4], vector[5:8] = 2.0, 1.0, (1.0, 2.0, 2.0)
    p, y = made.start(vector)
    assert y == pytest.approx([0.0, 3.0], abs=1e-15)    # 0
    assert p[made.fixed_count:].tolist() == [0.0, 0.0, 5.0]
    assert euler.load_start(p).time == 2.0
