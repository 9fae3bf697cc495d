# SPDX-License-Identifier: Apache-2.0
"""The table of measured methods: its kinds of scenes, and which method is picked for what."""

import math

import pytest

from rigid_body_sim.choice import measured
from rigid_body_sim.scene.scene import parse_scene

ROWS = {'quick': [{'tolerance': 1e-3, 'error': 1e-4, 'cost': 1.0},
                  {'tolerance': 1e-6, 'error': 1e-7, 'cost': 3.0}],
        'fine': [{'tolerance': 1e-5, 'error': 1e-6, 'cost': 2.0},
                 {'tolerance': 1e-12, 'error': 1e-13, 'cost': 9.0}],
        'dear': [{'tolerance': 1e-5, 'error': 1e-9, 'cost': 5.0}]}


def scene(constraint='free', effects='', omega='[0, 0, 3]', inertia='[1, 2, 2.5]'):
    return parse_scene(f'scene: s\nbody: {{mass: 2, inertia: {inertia}, '
                       f'center_of_mass: [0, 0, 0.5]}}\nconstraint: {constraint}\n'
                       f'effects: [{effects}]\ninitial: {{angular_velocity: {omega}}}\n')


@pytest.fixture
def table(monkeypatch):
    monkeypatch.setattr(measured, 'table', lambda: {'kinds': {'free': ROWS}})


@pytest.mark.parametrize(('accuracy', 'able', 'method', 'tolerance', 'error'), [
    (1e-3, ('quick', 'fine', 'dear'), 'quick', 1e-3, 1e-4),
    (1e-4, ('quick', 'fine', 'dear'), 'quick', 1e-3, 1e-4),      # what is just met is met
    (0.99e-4, ('quick', 'fine', 'dear'), 'fine', 1e-5, 1e-6),
    (1e-7, ('quick', 'fine', 'dear'), 'quick', 1e-6, 1e-7),
    (1e-8, ('quick', 'fine', 'dear'), 'dear', 1e-5, 1e-9),
    (1e-10, ('quick', 'fine', 'dear'), 'fine', 1e-12, 1e-13),
    (1e-14, ('quick', 'fine', 'dear'), 'fine', 1e-12, 1e-13),    # none meets it: the finest
    (1e-14, ('quick', 'dear'), 'dear', 1e-5, 1e-9), (1e-3, ('dear',), 'dear', 1e-5, 1e-9),
    (1e-3, ('unknown', 'dear'), 'dear', 1e-5, 1e-9)])
def test_the_cheapest_that_meets_it_is_picked(table, accuracy, able, method, tolerance, error):
    assert measured.pick(scene(), able, accuracy, 1.0) == (
        method, tolerance, max(error, measured.floor(scene(), 1.0)))


def test_no_method_is_expected_to_do_better_than_rounding(table):
    _, _, error = measured.pick(scene(), ('fine',), 1e-10, 1e9)
    assert error == measured.floor(scene(), 1e9) == 2.0 ** -53 * (4.0 + 3.0 * 1e9)


def test_the_pace_is_the_rate_and_what_the_weight_adds():
    assert measured.pace(scene(omega='[2, 3, 6]')) == 7.0
    top = scene('pivot', 'gravity: {g: 10}', '[0, 0, 3]')
    middle = sorted(top.constraint.inertia(top.body).moments)[1]
    assert measured.pace(top) == pytest.approx(3.0 + math.sqrt(4.0 * 2.0 * 10.0 * 0.5 / middle))


@pytest.mark.parametrize(('constraint', 'effects', 'kind'), [
    ('free', '', 'free'), ('pivot', 'gravity: {g: 1}', 'pivot'),
    ('free', 'drag: {angular: 1}', 'free, damped'),
    ('pivot', 'drag: {linear: 1}', 'pivot, damped'),
    ('free', 'internal_dissipation: {coefficient: 0.1}', 'free, dissipating'),
    ('free', 'internal_dissipation: {coefficient: 0.1}, drag: {angular: 1}', 'free, dissipating')])
def test_a_scene_has_a_kind(constraint, effects, kind):
    assert measured.kind(scene(constraint, effects)) == kind


@pytest.mark.parametrize(('drag', 'collocates'), [
    ('angular: 0.1', True), ('angular_quadratic: 0.1', False),
    ('angular: 1e8, angular_quadratic: 0.1', True)])
def test_collocation_is_not_taken_on_roots_unless_the_scene_is_stiff(drag, collocates):
    damped = scene('free', f'drag: {{{drag}}}')
    assert measured.on_such(damped, 'gauss16') == collocates
    assert measured.on_such(damped, 'dop8')


@pytest.mark.parametrize(('effects', 'method', 'such', 'doubted'), [
    ('', 'taylor', True, False), ('', 'gauss16', True, False), ('', 'rk4', False, False),
    ("torque: {value: ['wx', 0, 0]}", 'taylor', False, False),
    # one root among others is enough
    ('torque: {value: [1, 0, 0]}, drag: {angular_quadratic: 1}', 'gauss16', False, True),
    ('torque: {value: [1, 0, 0]}, drag: {angular_quadratic: 1}', 'dop8', True, False)])
def test_what_was_measured_on_such_scenes_and_what_is_doubted(effects, method, such, doubted):
    one = scene('free', effects)
    assert measured.on_such(one, method) == such
    assert measured.is_doubted(one, method) == doubted


@pytest.mark.parametrize(('accuracy', 'taken'), [
    (1.0, 0.1), (0.1, 0.1), (1e-5, 1e-5), (0.9e-5, 1e-6), (1e-15, 1e-15), (1e-16, 1e-15)])
def test_on_a_plane_the_general_method_promises_what_it_is_given(accuracy, taken):
    """From a tenth to 1e-15; power series were not measured there."""
    disk = parse_scene('scene: s\nbody: {mass: 1, shape: {disk: {radius: 1}}}\nconstraint: '
                       '{table: {}}\neffects: [gravity: {g: 9.8}, sliding_friction: {mu: 0.2}]\n'
                       'initial: {}\n')
    assert measured.pick(disk, ['dop8'], accuracy, 1e-3) == (
        'dop8', taken, max(taken, measured.floor(disk, 1e-3)))
    assert not measured.on_such(disk, 'taylor')


def test_what_was_not_measured_is_not_doubted(table):
    assert not measured.is_doubted(scene('free', 'drag: {angular_quadratic: 1}'), 'gauss16')


def test_the_least_error_of_a_method_is_that_of_its_best_tolerance(table):
    assert measured.least_error(scene(), 'fine') == 1e-13
    assert measured.least_error(scene(), 'unknown') == math.inf


def test_a_kind_that_was_not_measured_is_taken_as_if_it_made_no_heat(table):
    assert measured.rows(scene('free', 'drag: {angular: 1}')) is ROWS


def test_the_shipped_table_falls_in_error_from_coarse_to_fine():
    for methods in measured.table()['kinds'].values():
        for entries in methods.values():
            tolerances = [entry['tolerance'] for entry in entries]
            assert tolerances == sorted(tolerances, reverse=True)
