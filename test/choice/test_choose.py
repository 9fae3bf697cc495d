# SPDX-License-Identifier: Apache-2.0
"""The choices of `auto`: accuracy on scenes outside its table, expected errors, and replay.

A recorded choice is taken again.
"""

import json
import pathlib

import numpy as np
import pytest
from data import choice_cases

from rigid_body_sim.analysis import resimulate
from rigid_body_sim.choice import choose as choose_module
from rigid_body_sim.choice import measured, settling
from rigid_body_sim.choice.choose import choose
from rigid_body_sim.choice.trial import Trial
from rigid_body_sim.cli import simulate
from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.integrators import METHODS
from rigid_body_sim.numerics.rotations import angle_between
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import load_scene, parse_scene
from rigid_body_sim.simulation.simulation import Simulation

REFERENCE = json.loads((pathlib.Path(__file__).resolve().parents[1] / 'data'
                        / 'choice.json').read_text())

DAMPED_TOP = """
scene: damped_top
body:
  mass: 1.0
  inertia: [0.03, 0.022, 0.012]
  inertia_about: origin
  center_of_mass: [0.01, 0.005, 0.1]
constraint: pivot
effects: [drag: {angular: 0.002}, gravity: {g: 9.81}]
initial: {euler_zyz: [0.2, 0.8, 0.3], angular_velocity: [3, -2, 40]}
"""


def scene_of(name):
    return parse_scene(choice_cases.text(name))


def test_where_no_measured_method_is_left_the_choice_gives_up():
    """Only measured methods are tried: what was left after the last once gave a traceback."""
    with pytest.raises(NotConverged, match='no method follows'):
        settling.settle(scene_of(next(iter(choice_cases.CASES))), ['rk4'], 1e-6, 1.0)


# the other cases need kernels that no other test compiles: bench/choice.py has them all
@pytest.mark.parametrize('accuracy', choice_cases.ACCURACIES)
@pytest.mark.parametrize('name', ['slow_top', 'fast_top'])
def test_error_meets_the_request_on_tops_outside_the_table(name, accuracy):
    scene, duration, expected = scene_of(name), choice_cases.CASES[name][-1], REFERENCE[name]
    choice, out = choose(scene, accuracy=accuracy, horizon=duration), np.empty(14)
    choice.solver(scene.initial.vector, Wrench()).state(duration, out)
    error = angle_between(*out[1:5], *map(float, expected['orientation']))
    assert error < 10.0 * accuracy + expected['floor']
    assert choice.expected_error < 2.0 * accuracy + 1e-12


@pytest.mark.parametrize('name', choice_cases.CASES)
def test_every_kind_of_scene_has_a_choice_and_finer_requests_expect_less(name, monkeypatch):
    # choices of the table without trial runs: compiling those of all kinds takes minutes
    monkeypatch.setattr(
        settling, 'settle',
        lambda *asked, coarsest: settling.Settled(*measured.pick(*asked), asked[-1]))
    choices = [choose(scene_of(name), accuracy=accuracy) for accuracy in (1e-2, 1e-6, 1e-10)]
    assert all(choice.method in METHODS for choice in choices)
    assert [choice.expected_error for choice in choices] == sorted(
        (choice.expected_error for choice in choices), reverse=True)
    assert all(choice.expected_error <= asked
               for choice, asked in zip(choices, (1e-2, 1e-6, 1e-10), strict=True))


def test_the_cheapest_that_is_good_enough_is_taken(monkeypatch):
    def rows(*costs):
        return [{'tolerance': 10.0 ** -k, 'error': 10.0 ** -k, 'cost': cost}
                for k, cost in zip((3, 6, 9), costs, strict=True)]
    monkeypatch.setattr(
        measured, 'table',
        lambda: {'kinds': {'pivot': {'one': rows(1.0, 4.0, 9.0), 'other': rows(2.0, 3.0, 8.0)}}})
    scene = scene_of('slow_top')
    assert measured.pick(scene, ['one', 'other'], 1e-3, 1.0)[:2] == ('one', 1e-3)
    assert measured.pick(scene, ['one', 'other'], 1e-5, 1.0)[:2] == ('other', 1e-6)
    assert measured.pick(scene, ['one'], 1e-5, 1.0)[:2] == ('one', 1e-6)
    assert measured.pick(scene, ['one', 'other'], 1e-12, 1.0) == ('other', 1e-9, 1e-9)
    assert measured.pick(scene, ['one', 'other'], 1e-9, 1e12)[2] > 1e-4


def test_a_table_that_promises_too_much_is_found_out_and_the_error_told_is_that_of_the_scene(
        monkeypatch):
    honest = measured.table()
    rows = {method: [entry | {'error': 1e-5 * entry['error']} for entry in found]
            for method, found in honest['kinds']['pivot'].items()}
    monkeypatch.setattr(measured, 'table', lambda: {'kinds': {'pivot': rows}})
    scene, duration, out = scene_of('slow_top'), choice_cases.CASES['slow_top'][-1], np.empty(14)
    choice = choose(scene, accuracy=1e-6, horizon=duration)
    choice.solver(scene.initial.vector, Wrench()).state(duration, out)
    error = angle_between(*out[1:5], *map(float, REFERENCE['slow_top']['orientation']))
    # measured: 1.3e-8 both
    assert 0.9 * error < choice.expected_error <= 1e-6


@pytest.mark.parametrize(('constraint', 'moments', 'coefficient', 'stiff', 'tolerance'), [
    ('free', [1.0, 1.000005, 1e-5], 0.02, True, 1e-6),    # the spin about the slim axis is
    ('free', [1.0, 2.0, 3.0], 0.02, False, 1e-6), ('free', [1.0, 2.0, 3.0], 5.0, True, 1e-9),
    ('pivot', [1.0, 1.1, 1.2], 0.02, False, 1e-6), ('pivot', [1.0, 1.1, 1.2], 5.0, True, 1e-9),
    ('pivot', [1.0, 1.000005, 1e-5], 0.02, False, 1e-6)])    # the pivot is off the slim axis
def test_dissipation_is_stiff_where_slim_axes_follow_faster_than_the_body_turns(
        constraint, moments, coefficient, stiff, tolerance, monkeypatch):
    fit = []
    monkeypatch.setattr(settling, 'settle', lambda scene, able, *asked, **_: (
        fit.extend(able) or settling.Settled('dop8', asked[0])))
    scene = parse_scene(
        f'scene: s\nbody: {{mass: 1, inertia: {moments}, center_of_mass: [0, 1, 0]}}\n'
        f'constraint: {constraint}\n'
        f'effects: [internal_dissipation: {{coefficient: {coefficient}}}]\n'
        'initial: {angular_velocity: [1, 2, 1e-3]}\n')
    assert choose(scene, accuracy=1e-6).tolerance == tolerance
    assert ('gauss16' not in fit) == stiff and 'dop8' in fit
    assert choose(scene, 'dop8', 1e-6).tolerance == tolerance


def test_an_axis_of_zero_moment_does_not_dissipate():
    rod = parse_scene('scene: s\nbody: {mass: 1, inertia: [1, 1, 0]}\nconstraint: free\n'
                      'effects: [internal_dissipation: {coefficient: 0.5}]\n'
                      'initial: {angular_velocity: [3, 4, 0]}\n')
    assert choose_module._inner_rates(rod) == (2.5, 2.5)


def test_closed_forms_cost_no_choice():
    choice = choose(load_scene('tennis_racket'), accuracy=1e-3)
    assert (choice.method, choice.expected_error < 1e-12) == ('exact', True)


def test_a_recorded_choice_is_taken_whatever_the_table_says(monkeypatch):
    now = choose(scene_of('slow_top'), accuracy=1e-6)
    monkeypatch.setattr(settling, 'settle', lambda *_: pytest.fail('it looked into the table'))
    then = choose(scene_of('slow_top'), accuracy=1e-6, settled=now.settled)
    assert (then.method, then.tolerance) == (now.method, now.tolerance)


def test_the_horizon_is_the_duration_and_counts():
    short, long = (Simulation(load_scene('heavy_top'), horizon=horizon) for horizon in (1.0, 1e6))
    assert short.choice.expected_error < long.choice.expected_error
    with pytest.raises(BadInput, match='horizon'):
        choose(scene_of('slow_top'), horizon=0.0)


def test_a_resimulation_makes_the_recorded_choice(tmp_path, capsys, monkeypatch):
    (tmp_path / 'top.yaml').write_text(choice_cases.text('slow_top'))
    asked = ['--scene', str(tmp_path / 'top.yaml'), '--duration', '0.2', '--accuracy', '1e-6',
             '--output', str(tmp_path / 'run'), '--json']
    assert simulate.main(asked) == 0
    method = json.loads(capsys.readouterr().out)['method']
    assert method['horizon'] == 0.2
    assert 0.0 < method['expected_error'] <= 1e-6
    monkeypatch.setattr(settling, 'settle', lambda *_: settling.Settled('rk4', None, 1.0, 0.0))
    assert resimulate.main([str(tmp_path / 'run')]) == 0
    assert 'identical' in capsys.readouterr().out


def test_a_missing_numba_is_said_once(monkeypatch, caplog):
    monkeypatch.setattr(choose_module.jit, 'numba', None)
    choose_module._say_what_is_slow.cache_clear()
    for _ in range(3):
        choose_module._say_what_is_slow()
    [line] = [record.getMessage() for record in caplog.records]
    assert 'numba is not installed' in line and 'pip install numba' in line
    choose_module._say_what_is_slow.cache_clear()


@pytest.mark.without_numba
@pytest.mark.parametrize('effects', [
    [{'spring': {'at': [0.1, 0, 0], 'anchor': [0, 0, 1], 'stiffness': 0}}],
    [{'torque': {'value': ['0', '0*wx', 0]}}],
    [{'force': {'value': ['0', 0, '-0.0*t'], 'at': [1, 2, 3]}}],
    [{'drag': {'linear': 0.2, 'quadratic': 0}}, {'gravity': {'g': 3}}],
    [{'drag': {'linear': [[0.2, 0, 0], [0, 0.2, 0], [0, 0, 0.2]]}}],
], ids=['spring', 'torque', 'force', 'no squares', 'a number times the identity'])
def test_what_does_not_act_leaves_the_closed_form(effects):
    scene = parse_scene(json.dumps({
        'scene': 'x', 'body': {'mass': 2.3, 'inertia': [0.03, 0.05, 0.07]}, 'constraint': 'free',
        'effects': effects, 'initial': {'angular_velocity': [3.1, -2.2, 5.3]}}))
    assert choose(scene).method == 'exact'


CANCELS = {
    'forces': [{'force': {'value': [1, -2, 3], 'at': [0.1, 0, 0]}},
               {'force': {'value': [-1, 2, -3], 'at': [0.1, 0, 0]}}],
    'torques in pieces': [{'torque': {'times': [0, 1], 'values': [[1, 2, 3], [0, 0, 1]]}},
                          {'torque': {'times': [0, 1], 'values': [[-1, -2, -3], [0, 0, -1]]}}],
    'rotors': [{'rotor': {'axis': [0, 0, 1], 'inertia': 0.1, 'rate': 7.0, 'torque': 0.2}},
               {'rotor': {'axis': [0, 0, 1], 'inertia': 0.1, 'rate': -7.0, 'torque': -0.2}}]}


@pytest.mark.without_numba
@pytest.mark.parametrize('effects', CANCELS.values(), ids=CANCELS)
def test_effects_that_cancel_each_other_leave_the_closed_form(effects):
    """The weight of a top is all that acts, and the ledger books both of what cancels."""
    scene = parse_scene(json.dumps({
        'scene': 'x', 'body': {'mass': 1.0, 'inertia': [0.03, 0.03, 0.01],
                               'center_of_mass': [0, 0, 0.1]},
        'constraint': 'pivot', 'effects': [{'gravity': {'g': 9.81}}, *effects],
        'initial': {'tilt': 0.5, 'angular_velocity': [1.0, 0.5, 30.0]}}))
    simulation = Simulation(scene, rate=10.0)
    assert simulation.choice.method == 'exact'
    simulation.advance(2)
    ledger = simulation.ledger()
    assert abs(ledger['energy_residual']) < 1e-14 and ledger['momentum_residual'] < 1e-14
    alone = parse_scene(scene.text, {'effects': [{'gravity': {'g': 9.81}}]})
    assert simulation.states([1.3]).vector.tolist() == Simulation(alone).states([
        1.3]).vector.tolist()


def test_one_effect_cancels_one_other():
    """Of three torques one is left; a formula has no opposite."""
    body = {'scene': 'x', 'body': {'mass': 1.0, 'inertia': [0.03, 0.04, 0.05]},
            'constraint': 'free', 'initial': {}}
    up, down = ({'torque': {'value': [0, 0, one]}} for one in (2.0, -2.0))
    scene = parse_scene(json.dumps(body | {'effects': [up, down, up]}))
    assert [effect.values for effect in scene.acting] == [((0.0, 0.0, 2.0),)]
    sides = [{'force': {'value': [0, 0, text]}} for text in ('sin(t)', '-sin(t)')]
    assert len(parse_scene(json.dumps(body | {'effects': sides})).acting) == 2


@pytest.mark.without_numba
@pytest.mark.parametrize('tolerance', [1e-9, 5e-324, 0.0])
def test_a_body_at_rest_has_a_first_tolerance_to_try(tolerance):
    scene = parse_scene('scene: rest\nbody: {mass: 1, inertia: [1, 2, 2.5]}\nconstraint: free\n'
                        'effects: [torque: {value: [1.0e-300, 0, 0], frame: world}]\n'
                        'initial: {angular_velocity: [0, 0, 0]}\n')
    trial = Trial(scene, 1e-9, 10.0, 'dop8', 1e-12, 1, True)
    first = trial._grid(trial._likely(tolerance))
    assert trial._finest <= first <= max(trial._finest, 2.0 * tolerance)
    assert trial.tolerance_from(tolerance) >= first    # nothing errs


@pytest.mark.without_numba
def test_many_bodies_take_a_method_that_has_them_side_by_side_where_it_meets_the_accuracy():
    """A top with drag goes by collocation to 1e-12; eight bodies at once by series are quicker."""
    scene = parse_scene(DAMPED_TOP)
    alone, together = (choose(scene, accuracy=1e-12, horizon=0.1, together=together)
                       for together in (False, True))
    assert (alone.method, together.method) == ('gauss16', 'taylor')
    assert together.expected_error <= 1e-12
    # one that would miss it is not taken
    missed = settling.Settled('taylor', 1e-9, 1e-9, 0.0)
    kept = settling.side_by_side(
        alone.settled, lambda able: missed, ['gauss16', 'taylor'], 1e-12)
    assert kept is alone.settled
