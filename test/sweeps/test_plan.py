# SPDX-License-Identifier: Apache-2.0
"""The plan of a sweep: values of its runs, what may be computed together, variables by hand."""

import itertools
import json
import math
import types

import numpy as np
import pytest

from rigid_body_sim.choice.choice import HORIZON
from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.scene import load_scene, parse_scene
from rigid_body_sim.sweeps import plan as plans
from rigid_body_sim.sweeps import spec as specs
from rigid_body_sim.sweeps.plan import Plan

BASE = {'scene': 'tennis_racket', 'vary': {'initial.angular_velocity.0': [0.1, 0.2]},
        'keep': ['final']}
ROTATION = {'runs': 5, 'seed': 2, 'initial.orientation': 'rotation'}
ROD = {'scene': 'rod', 'body': {'mass': 1.0, 'inertia': [0.1, 0.1, 0.0]}, 'constraint': 'free',
       'effects': [], 'initial': {'angular_velocity': [1.0, 0.0, 0.0]}}
LEANING = {'scene': 'leaning', 'constraint': 'pivot', 'effects': [{'gravity': {'g': 9.81}}],
           'body': {'mass': 1.0, 'inertia': [0.05, 0.04, 0.01], 'center_of_mass': [0.01, 0, 0.1]},
           'initial': {'angular_velocity': [0.0, 0.0, 30.0]}}


def plan(**changes):
    return Plan(specs.read({**BASE, **changes}))


@pytest.mark.parametrize('size', [1, 2, 30, 46])
def test_whichever_run_alone_is_valid_is_found(size):
    """64 multiples of the golden ratio leave no gap above its eighth power (three-gap theorem).

    It is 0.0213 < 1/46.
    """
    for good in range(size):
        def scene_of(run, good=good):
            if run != good:
                raise BadInput('run', 'is refused', 'another')
            return 'scene'
        found = Plan._template(types.SimpleNamespace(
            spec=types.SimpleNamespace(size=size), scene_of=scene_of))
        assert found == ('scene', good)


def test_where_all_are_refused_the_first_problem_is_told():
    asked = []

    def scene_of(run):
        asked.append(run)
        raise BadInput(f'run {run}', 'is refused', 'another')
    with pytest.raises(BadInput, match='run 0: is refused'):
        Plan._template(types.SimpleNamespace(
            spec=types.SimpleNamespace(size=10 ** 6), scene_of=scene_of))
    # spread: no sixteenth of the sweep is left out, and none is asked twice
    assert {run * 16 // 10 ** 6 for run in asked} == set(range(16))
    assert len(set(asked)) == len(asked)


@pytest.mark.parametrize(('times', 'horizon'), [
    ([0.5, 1.0, 2.5], 2.5), (0.0, HORIZON), ([0.0, 3.0], 3.0)])
def test_the_accuracy_holds_to_the_last_time(times, horizon):
    assert plan(times=times).horizon == horizon


def test_bytes_are_those_of_the_variables_and_of_the_states():
    one = plan(times=[1.0, 2.0, 3.0], keep=['states', {'all': 'flip', 'most': 5}])
    told = 1 + 1 + 8 + 4    # status, method, tolerance, expected error
    assert one.bytes == 3 * 13 * 8 + 5 * 8 + 4 + told
    assert one.working_bytes == 3 * 14 * 8 + one.bytes
    assert plan().working_bytes == 14 * 8 + 13 * 8 + told


@pytest.mark.parametrize('drawn', [False, True])
def test_runs_are_numbered_like_the_elements_of_an_array(drawn):
    masses, names = np.array([1.0, 2.0]), ['a', 'b', 'c']
    one = plan(vary={'body.mass': masses, 'scene': names}, sample=ROTATION)
    turns = one.spec.sample['initial.orientation'].of_runs(0, 5)
    if drawn:
        assert one.drawn()['initial.orientation'].tobytes() == turns.tobytes()
    for first, stop in itertools.combinations(range(31), 2):
        found = one.values(first, stop)
        where = np.unravel_index(np.arange(first, stop), (2, 3, 5))
        for mine, theirs in zip(one.places(first, stop).values(), where, strict=True):
            assert mine.tolist() == theirs.tolist()
        assert found['body.mass'].tolist() == masses[where[0]].tolist()
        assert found['scene'] == [names[k] for k in where[1]]
        assert found['initial.orientation'].tobytes() == turns[where[2]].tobytes()
    assert one.overrides(29) == {'body.mass': 2.0, 'scene': 'c',
                                 'initial.orientation': turns[4].tolist()}


def test_one_run_has_its_own_values_alone():
    asked = []
    Plan.overrides(types.SimpleNamespace(
        values=lambda first, stop: asked.append((first, stop)) or {}), 7)
    assert asked == [(7, 8)]


@pytest.mark.parametrize(('keys', 'places'), [
    (['initial.orientation'], {'initial.orientation': (1, 5)}),
    (['initial.angular_velocity.0', 'initial.angular_velocity[2]'],
     {'initial.angular_velocity.0': (5, 6), 'initial.angular_velocity[2]': (7, 8)}),
    (['initial.position.1', 'initial.velocity', 'body.mass'],
     {'initial.position.1': (9, 10), 'initial.velocity': (11, 14)}),
    (['initial.spin', 'initial.position[2]'],
     {'initial.spin': (5, 8), 'initial.position[2]': (10, 11)}),
    (['initial.velocity.2', 'initial.velocity[1]', 'initial.velocity.0'],
     {'initial.velocity.2': (13, 14), 'initial.velocity[1]': (12, 13),
      'initial.velocity.0': (11, 12)}),
    (['initial.spin', 'initial.angular_velocity.0'], {}),    # one replaces the other
    (['initial.velocity.1', 'initial.velocity[1]'], {}),
    (['initial.tilt', 'initial.velocity'], {}),              # it turns the start
    (['initial.velocity.3'], {}), (['body.mass'], {})])
def test_keys_that_set_places_of_the_start(keys, places):
    assert plans._direct_places(keys) == {key: slice(*at) for key, at in places.items()}


@pytest.mark.parametrize(('scene', 'integrator', 'alone'), [
    ('tennis_racket', 'auto', True), ('tennis_racket', 'exact', True),
    ('tennis_racket', 'taylor', True), ('heavy_top', 'exact', True),
    ('major_axis_relaxation', 'taylor', False),    # stiff or not: that depends on the start
    ('rolling_disk', 'taylor', False),             # the constraint makes the start
    (json.dumps(LEANING), 'auto', False), (json.dumps(LEANING), 'taylor', True),
    (json.dumps(ROD), 'taylor', False)])           # refuses a spin about its axis
def test_runs_of_a_scene_differ_in_their_starts_alone(scene, integrator, alone):
    scene = parse_scene(scene) if '{' in scene else load_scene(scene)
    assert plans.starts_alone_differ(scene, integrator) == alone


@pytest.mark.parametrize(('changes', 'quick'), [
    ({}, True), ({'keep': ['states', {'maximum': 'speed'}, {'minimum': 'speed'}]}, True),
    ({'keep': ['final', 'states', {'maximum': 'speed'}, {'minimum': 'speed'}]}, True),
    ({'keep': ['final', {'first': 'flip'}]}, False), ({'keep': ['residuals']}, False),
    ({'integrator': 'taylor'}, False), ({'vary': {'body.mass': [1.0, 2.0]}}, False)])
def test_states_of_one_scene_in_closed_form_are_quick(changes, quick):
    assert plan(**changes).is_quick == quick


VARIABLES = {
    'final_orientation': (('quaternion',), (4,), 'f8', '1'),
    'final_angular_velocity': (('axis',), (3,), 'f8', 'rad/s'),
    'final_position': (('axis',), (3,), 'f8', 'm'),
    'final_velocity': (('axis',), (3,), 'f8', 'm/s'),
    'position': (('time', 'axis'), (2, 3), 'f8', 'm'),
    'first_turning_point': ((), (), 'f8', 's'),
    'all_turning_point': (('turning_point',), (3,), 'f8', 's'),
    'turning_point_count': ((), (), 'i4', '1'),
    'minimum_energy': ((), (), 'f8', 'J'), 'maximum_velocity_z': ((), (), 'f8', 'm/s'),
    'energy_residual': ((), (), 'f8', '1'), 'momentum_residual': ((), (), 'f8', '1'),
    'status': ((), (), 'i1', None), 'method': ((), (), 'i1', None),
    'tolerance': ((), (), 'f8', 'rad'), 'expected_error': ((), (), 'f4', 'rad')}


def test_variables_have_the_dimensions_and_units_of_what_is_kept():
    one = plan(scene='heavy_top', times=[1.0, 2.0], keep=[
        'final', {'states': 'position'}, {'first': 'turning point'},
        {'all': 'turning point', 'most': 3}, {'minimum': 'energy'}, {'maximum': 'velocity.z'},
        'residuals'])
    assert {each.name: (each.dims, each.shape, each.dtype.str[1:], each.attrs.get('units'))
            for each in one.variables} == VARIABLES
    for each in one.variables:
        assert math.isnan(each.fill) if each.dtype.kind == 'f' else each.fill == -1
    status = next(each for each in one.variables if each.name == 'status')
    assert dict(zip(status.attrs['flag_values'], status.attrs['flag_meanings'].split(),
                    strict=True)) == {
        -1: 'not_run', 0: 'done', 1: 'method_gave_up', 2: 'scene_refused', 3: 'function_failed',
        4: 'not_finite'}


@pytest.mark.parametrize(('dims', 'outputs', 'name'), [
    ({'final_position': 2}, [('speed', None)], 'final_position'),
    ({}, [('speed', None), ('speed', 2)], 'speed'),
    ({}, [('final_velocity', 2)], 'final_velocity')])
def test_a_name_stands_for_one_thing(dims, outputs, name):
    keep = (*specs.read(BASE).keep, specs.Kept('function', 'm:f'))
    with pytest.raises(BadInput, match=f'two things have the name {name!r}'):
        plans._variables(types.SimpleNamespace(
            spec=types.SimpleNamespace(keep=keep), dims=dims, outputs={'m:f': outputs}))


@pytest.mark.parametrize('outputs', [{}, {'m:f': [('speed', None)]}])
def test_a_plan_has_what_its_functions_give(outputs):
    assert Plan(specs.read(BASE), outputs).outputs == outputs
    assert Plan(specs.read(BASE)).outputs == {}


def test_what_a_function_returns_has_a_place_for_each_of_its_numbers():
    one = types.SimpleNamespace(outputs={'m:f': [('low', None), ('row', 5)]})
    low, row = plans._kept(one, specs.Kept('function', 'm:f'))
    assert (low.name, low.dims, low.shape) == ('low', (), ())
    assert (row.name, row.dims, row.shape) == ('row', ('row_place',), (5,))


def test_coordinates_are_the_values_with_their_units():
    one = plan(vary={'body.mass': [1.0, 2.0], 'body.inertia': [[1, 2, 3], [2, 2, 2]],
                     'scene': ['a', 'b']}, times=[1.0, 2.0], keep=[{'states': 'position'}])
    found = {name: (dims, list(values), attrs.get('units'))
             for name, (dims, values, attrs) in plans.coordinates(one).items()}
    assert found == {
        'body.mass': (('body.mass',), [1.0, 2.0], 'kg'),
        'body.inertia': (('body.inertia',), ['[1, 2, 3]', '[2, 2, 2]'], 'kg m2'),
        'scene': (('scene',), ['a', 'b'], ''), 'time': (('time',), [1.0, 2.0], 's'),
        'axis': (('axis',), ['x', 'y', 'z'], None)}


@pytest.mark.parametrize(('sample', 'dims', 'named'), [
    ({'initial.orientation': 'rotation'}, ('run', 'quaternion'), {'quaternion'}),
    ({'initial.velocity': {'direction': 1}}, ('run', 'axis'), {'axis'}),
    ({'body.mass': {'uniform': [1, 2]}}, ('run',), set())])
def test_samples_of_vectors_have_their_axes_as_coordinates(sample, dims, named):
    one = plan(vary={}, sample={'runs': 3, **sample}, keep=[{'maximum': 'speed'}])
    assert set(plans.coordinates(one)) == named
    [sampled] = one.spec.sample.values()
    assert plans.sample_dims(sampled) == dims
    assert (one.dims, one.slow) == ({'run': 3}, [] if named else ['body.mass'])


@pytest.mark.parametrize('kind', ['first', 'all'])
def test_an_event_of_any_motion_may_be_kept_and_no_other(kind):
    plan(keep=[{kind: 'flip'}, {'first': 'rolling began'}])
    with pytest.raises(BadInput, match=f"keep: {kind}: got 'flop'; an event: "):
        plan(keep=[{kind: 'flop'}])
