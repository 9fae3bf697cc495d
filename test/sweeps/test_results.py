# SPDX-License-Identifier: Apache-2.0
"""What is kept of states and events that are chosen; runs that fail, and why."""

import math
import types

import numpy as np
import pytest
from near import near

from rigid_body_sim.choice.choose import choose
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.scene.state import PLACES
from rigid_body_sim.sweeps import results
from rigid_body_sim.sweeps import spec as specs
from rigid_body_sim.sweeps.plan import DONE, FUNCTION_FAILED, NOT_FINITE, Plan
from rigid_body_sim.sweeps.results import Block, Results, room

PARTS = 'orientation', 'angular_velocity', 'position', 'velocity'


def plan(keep, times=(1.0, 2.0, 4.0), runs=4, **more):
    return Plan(specs.read({
        'scene': 'tennis_racket', 'times': list(times), 'keep': keep,
        'vary': {'initial.angular_velocity.0': [0.1 * (k + 1) for k in range(runs)]}, **more}))


def some_states(one):
    """Return states (runs, times, 14) all of whose numbers differ; quaternions are units."""
    states = np.random.default_rng(1).normal(size=(one.spec.size, len(one.spec.times), 14))
    states[..., 1:5] /= np.linalg.norm(states[..., 1:5], axis=-1)[..., np.newaxis]
    return states


def kept(one, states, events=None, where=slice(None), first=10, values=None):
    """Return the Block of runs 10, 11, ... with these results."""
    arrays, _ = room(one, len(states))
    block = Block(first, first + len(states), arrays, values or {}, {})
    Results(one, block).keep(one.template, one.choice, states[:, 0].copy(), states, events, where)
    return block


@pytest.mark.parametrize(('where', 'places'), [
    (slice(1, 3), [1, 2]), (slice(None), [0, 1, 2]), (np.array([2, 0]), [2, 0])])
def test_places_of_a_block(where, places):
    block = Block(5, 8, {}, {'a': np.array([1.0, 2.0, 3.0]), 'b': ['x', 'y', [1]]}, {})
    assert block.size == 3
    assert block.places(where).tolist() == places
    assert (block.value('a', 1), block.value('b', 2)) == (2.0, [1])
    assert type(block.value('a', 1)) is float


@pytest.mark.parametrize(('keep', 'times', 'in_place'), [
    (['states'], 3, ['']), (['final'], 1, ['final_']), (['states', 'final'], 1, ['', 'final_']),
    (['final', 'states'], 3, ['']), (['final'], 3, []), (['final'], 2, []),
    ([{'states': 'position'}], 3, []), ([{'final': 'position'}], 1, []), (['residuals'], 1, [])])
def test_states_that_are_all_kept_are_computed_where_they_stay(keep, times, in_place):
    one = plan(keep, range(1, times + 1))
    arrays, states = room(one, 2)
    assert {each.name: (2, *each.shape) for each in one.variables} == {
        name: array.shape for name, array in arrays.items()}
    assert {name for name, array in arrays.items()
            if states is not None and np.may_share_memory(array, states)} == {
        prefix + part for prefix in in_place for part in PARTS}
    if states is None:
        assert not in_place
        return
    assert states.shape == (2, times, 14)
    states[:] = np.arange(states.size).reshape(states.shape)
    for prefix in in_place:
        for part in PARTS:
            expected = states[..., PLACES[part]]
            assert (arrays[prefix + part] == (expected[:, -1] if prefix else expected)).all()


def test_parts_and_extremes_are_those_of_the_states():
    one = plan(['states', {'final': ['position', 'orientation']}, {'minimum': 'position.z'},
                {'maximum': 'position.z'}])
    states = some_states(one)
    arrays = kept(one, states).arrays
    for part in PARTS:
        assert (arrays[part] == states[..., PLACES[part]]).all()
    assert (arrays['final_position'] == states[:, -1, 8:11]).all()
    assert (arrays['final_orientation'] == states[:, -1, 1:5]).all()
    assert (arrays['minimum_position_z'] == states[..., 10].min(axis=1)).all()
    assert (arrays['maximum_position_z'] == states[..., 10].max(axis=1)).all()
    assert (arrays['status'] == DONE).all() and (arrays['method'] == 0).all()


@pytest.mark.parametrize('keep', [['kinetic_energy'], ['position.z', 'kinetic_energy'],
                                  ['kinetic_energy', 'position.z']])
def test_an_energy_is_kept_beside_what_needs_none(keep):
    """The racket's origin is its center of mass: 1/2 (m v^2 + I1 w1^2 + I2 w2^2 + I3 w3^2)."""
    one = plan([{'maximum': name} for name in keep])
    states, body = some_states(one), one.template.body
    energy = 0.5 * (body.mass * (states[..., 11:] ** 2).sum(axis=-1)
                    + (body.about_center.moments * states[..., 5:8] ** 2).sum(axis=-1))
    assert kept(one, states).arrays['maximum_kinetic_energy'] == near(
        energy.max(axis=1), rel=1e-14)


def test_residuals_are_those_of_the_last_time(monkeypatch):
    one, seen = plan(['residuals']), []
    states = some_states(one)

    def residuals(scene, choice, starts, ends, time):
        seen.append(time)
        assert (starts == states[:, 0]).all() and (ends == states[:, 2]).all()
        return [{'energy_residual': float(k), 'momentum_residual': -float(k)} for k in range(4)]
    monkeypatch.setattr(results, '_residuals', residuals)
    arrays = kept(one, states).arrays
    assert seen == [4.0]
    assert arrays['energy_residual'].tolist() == [0.0, 1.0, 2.0, 3.0]
    assert arrays['momentum_residual'].tolist() == [0.0, -1.0, -2.0, -3.0]


@pytest.mark.without_numba
def test_residuals_of_a_body_that_is_stopped_again_are_those_of_its_way():
    """Turned for a second and stopped in the next one: both ends are at rest."""
    scene = parse_scene(
        'scene: slewed\nbody: {mass: 1, inertia: [0.03, 0.02, 0.01]}\nconstraint: free\n'
        'effects: [torque: {times: [0, 1, 2], values: [[0, 0, 0.02], [0, 0, -0.02], [0, 0, 0]]}]\n'
        'initial: {euler_zyz: [0, 0.5, 0]}\n')
    choice, start = choose(scene, 'dop8', 1e-9), scene.initial.vector[np.newaxis]
    ends = np.empty((1, 1, 14))
    choice.many(start, np.array([3.0]), ends)
    found, = results._residuals(scene, choice, start, ends[:, 0], 3.0)
    # measured: 2e-33 and 7e-17; beside the two ends they were of order 1
    assert abs(found['energy_residual']) < 1e-8
    assert found['momentum_residual'] < 1e-8


def test_some_runs_of_a_block_are_kept_at_their_places():
    one = plan(['final', {'minimum': 'speed'}])
    states = some_states(one)[:2]
    arrays, _ = room(one, 4)
    for array in arrays.values():
        array[:] = 7
    block = Block(0, 4, arrays, {}, {})
    Results(one, block).keep(one.template, one.choice, states[:, 0], states, None,
                             np.array([3, 1]))
    assert (arrays['final_velocity'][[3, 1]] == states[:, -1, 11:]).all()
    assert arrays['status'].tolist() == [7, DONE, 7, DONE]
    assert (arrays['final_velocity'][[0, 2]] == 7).all()


@pytest.mark.parametrize('times', [1, 2, 3, 4, 5, 14, 15])
@pytest.mark.parametrize('wrong', [math.nan, math.inf, -math.inf])
def test_a_run_whose_states_overflow_fails_alone(times, wrong):
    one = plan(['final', {'all': 'flip', 'most': 2}], range(1, times + 1))
    for where in {0, times - 1}:
        states = some_states(one)
        states[1, where:, 9] = wrong
        block = kept(one, states, [[]] * 4)
        assert block.arrays['status'].tolist() == [DONE, NOT_FINITE, DONE, DONE]
        assert block.texts == {11: 'run 11: the states are not finite'}
        assert np.isnan(block.arrays['final_position'][1]).all()
        assert block.arrays['flip_count'].tolist() == [0, -1, 0, 0]
        assert np.isfinite(block.arrays['final_position'][[0, 2, 3]]).all()


def test_events_are_those_of_the_name_the_first_ones():
    one = plan([{'first': 'flip'}, {'all': 'flip', 'most': 2}, {'first': 'turning point'}])

    def told(*times):
        return [types.SimpleNamespace(name=name, time=time) for time in times
                for name in ('landed', 'flip')]
    arrays = kept(one, some_states(one), [told(), told(1.5), told(1.0, 2.0),
                                          told(0.5, 1.0, 3.0)]).arrays
    nan = math.nan
    np.testing.assert_array_equal(arrays['first_flip'], [nan, 1.5, 1.0, 0.5])
    np.testing.assert_array_equal(arrays['all_flip'], [[nan, nan], [1.5, nan], [1.0, 2.0],
                                                       [0.5, 1.0]])
    assert arrays['flip_count'].tolist() == [0, 1, 2, 3]
    assert np.isnan(arrays['first_turning_point']).all()


def test_a_function_sees_its_run_and_fails_alone():
    seen = []

    def mine(run):
        seen.append((run.number, run.values, run.states.vector.copy()))
        run.states.vector[:] = 0.0    # its own copy
        if run.number == 11:
            raise ZeroDivisionError('no')
        return {'low': 1.0} if run.number == 12 else {'low': 2.0, 'row': [run.number, 4.0]}
    spec = specs.read({'scene': 'tennis_racket', 'times': [1.0, 2.0], 'vary': {
        'initial.angular_velocity.0': [0.1, 0.2, 0.3, 0.4, 0.5]},
        'keep': ['states', {'function': mine}]})
    [name] = spec.functions
    one = Plan(spec, {name: [['low', None], ['row', 2]]})
    states = some_states(one)
    states[4] = math.nan
    before = states.copy()
    block = kept(one, states, values={'a': np.arange(5.0)})
    assert [number for number, _, _ in seen] == [10, 11, 12, 13]    # not the one that failed
    for k, (_, values, vector) in enumerate(seen):
        assert values == {'a': float(k)} and (vector == states[k]).all()
    np.testing.assert_array_equal(states, before)
    assert block.arrays['status'].tolist() == [
        DONE, FUNCTION_FAILED, FUNCTION_FAILED, DONE, NOT_FINITE]
    np.testing.assert_array_equal(block.arrays['row'], [
        [10, 4], [math.nan] * 2, [math.nan] * 2, [13, 4], [math.nan] * 2])
    assert block.texts[11] == f'{name}: ZeroDivisionError: no'
    assert block.texts[12].endswith('not as in the other runs')
    assert sorted(block.texts) == [11, 12, 14]


@pytest.mark.parametrize(('integrator', 'tolerance', 'known'), [
    ('auto', 1e-9, True), ('taylor', 1e-9, False)])
def test_tolerance_and_expected_error_are_those_of_the_choice(integrator, tolerance, known):
    one = plan(['final'], integrator=integrator, accuracy=1e-9)
    arrays = kept(one, some_states(one)).arrays
    assert (arrays['tolerance'] == tolerance).all()
    assert np.isfinite(arrays['expected_error']).tolist() == [known] * 4


@pytest.mark.parametrize(('settled', 'method', 'alone', 'expected'), [
    (None, 'exact', True, math.nan), ('auto', 'taylor', True, 3.0), ('auto', 'exact', False, 3.0),
    ('auto', 'exact', True, "of each ('scene', 'many', 'start', 1)"),
    ('auto', 'taylor', False, 3.0)])
def test_an_error_is_expected_of_each_start_where_starts_alone_differ(
        monkeypatch, settled, method, alone, expected):
    monkeypatch.setattr(results, 'of_bodies', lambda *given: f'of each {given}')
    choice = types.SimpleNamespace(settled=settled, method=method, expected_error=3.0, horizon=1,
                                   many='many')
    found = results._expected(choice, 'scene', 'start', alone)
    assert found == expected or (math.isnan(found) and math.isnan(expected))
