# SPDX-License-Identifier: Apache-2.0
"""The words of a sweep's spec: which are accepted, within which bounds, and which are refused."""

import numpy as np
import pytest
from near import near

from rigid_body_sim.errors import BadInput
from rigid_body_sim.sweeps.draws import DIRECTION, NORMAL, UNIFORM
from rigid_body_sim.sweeps.spec import Kept, again, fingerprint, read

BASE = {'scene': 'tennis_racket', 'vary': {'body.mass': [1, 2]}, 'keep': 'final'}
WHOLE = ('orientation', 'angular_velocity', 'position', 'velocity')


def spec(**changes):
    return read({**BASE, **changes})


def kept(*entries):
    return spec(keep=list(entries)).keep


@pytest.mark.parametrize(('values', 'expected'), [
    ([1, 2.5], [1.0, 2.5]), ({'linspace': [1, 3, 5]}, [1.0, 1.5, 2.0, 2.5, 3.0]),
    ({'linspace': [4, 4, 1]}, [4.0]), ({'logspace': [-1, 1, 3]}, [0.1, 1.0, 10.0]),
    (np.array([3.0, 1.0]), [3.0, 1.0])])
def test_numbers_are_an_array(values, expected):
    found = spec(vary={'body.mass': values}).vary['body.mass']
    assert isinstance(found, np.ndarray)
    assert found == near(expected, rel=1e-15)


@pytest.mark.parametrize('values', [[[1, 2, 3], [3, 2, 1]], ['a', 'b'], [True, False], [1, True]])
def test_other_values_are_kept_as_they_are(values):
    assert spec(vary={'body.inertia': values}).vary['body.inertia'] == values


@pytest.mark.parametrize('values', [
    [], 3, 'a', {'linspace': [1, 2]}, {'linspace': [1, 2, 0]}, {'linspace': [1, 2, 2.0]},
    {'linspace': [1, 2, 10 ** 7 + 1]}, {'linspace': [1, float('inf'), 3]},
    {'linspace': [True, 2, 3]}, {'space': [1, 2, 3]}, {'linspace': {}}, [1.0, float('nan')],
    {'linspace': [1, 2, 3], 'logspace': [1, 2, 3]}])
def test_what_are_no_values_is_refused(values):
    with pytest.raises(BadInput, match=r'sweep: vary\.body\.mass'):
        spec(vary={'body.mass': values})


@pytest.mark.parametrize(('value', 'expected'), [
    (2, [2.0]), ([0, 1, 3], [0.0, 1.0, 3.0]), ({'linspace': [0, 1, 3]}, [0.0, 0.5, 1.0]),
    (0.0, [0.0])])
def test_times_rise_from_zero_on(value, expected):
    assert spec(times=value).times.tolist() == expected


@pytest.mark.parametrize('value', [[], -1.0, [1, 1], [2, 1], [-0.1, 1], float('nan'), 'soon'])
def test_other_times_are_refused(value):
    with pytest.raises(BadInput, match='sweep: times'):
        spec(times=value)


@pytest.mark.parametrize(('given', 'kind', 'a', 'b'), [
    ({'uniform': [1, 2]}, UNIFORM, 1.0, 2.0), ({'uniform': [2, 2]}, UNIFORM, 2.0, 2.0),
    ({'normal': [-1, 0]}, NORMAL, -1.0, 0.0), ({'normal': [3, 2]}, NORMAL, 3.0, 2.0),
    ({'direction': 5}, DIRECTION, 5.0, 0.0)])
def test_samples_have_their_numbers(given, kind, a, b):
    one = spec(sample={'runs': 3, 'body.mass': given, 'seed': 4}, vary={})
    sampled = one.sample['body.mass']
    assert (sampled.kind, sampled.a, sampled.b, one.runs, one.size) == (kind, a, b, 3, 3)


@pytest.mark.parametrize('given', [
    {'uniform': [2, 1]}, {'normal': [1, -0.1]}, {'uniform': [1]}, {'uniform': [1, 2, 3]},
    {'rotation': 1}, {'direction': 'up'}, {'gamma': [1, 2]}, 'uniform', [1, 2],
    {'uniform': [1, 2], 'normal': [1, 2]}, {'uniform': 3}])
def test_what_is_no_distribution_is_refused(given):
    with pytest.raises(BadInput, match=r'sweep: sample\.body\.mass'):
        spec(vary={}, sample={'runs': 3, 'body.mass': given})


@pytest.mark.parametrize(('sample', 'where'), [
    ({'body.mass': {'uniform': [1, 2]}}, 'sample: the key .runs. is missing'),
    ({'runs': 0, 'a': 'rotation'}, r'sample\.runs'), ({'runs': 2.5, 'a': 'rotation'}, 'runs'),
    ({'runs': True, 'a': 'rotation'}, 'runs'), ({'runs': 10 ** 12 + 1, 'a': 'rotation'}, 'runs'),
    ({'runs': 3}, 'names no key'), ({'runs': 3, 'seed': -1, 'a': 'rotation'}, r'sample\.seed'),
    ({'runs': 3, 'seed': 2 ** 63 + 1, 'a': 'rotation'}, 'seed')])
def test_samples_that_will_not_do_are_refused(sample, where):
    with pytest.raises(BadInput, match=where):
        spec(vary={}, sample=sample)


def test_bounds_themselves_are_taken():
    one = spec(vary={}, sample={'runs': 10 ** 12, 'seed': 2 ** 63, 'body.mass': {'direction': 1}})
    assert one.runs == 10 ** 12
    assert spec(vary={}, sample={'runs': 1, 'seed': 0, 'body.mass': {'direction': 1}}).runs == 1


def test_the_shape_is_that_of_the_keys_and_then_of_the_samples():
    both = spec(vary={'body.mass': [1, 2], 'initial.tilt': [0, 1, 2]},
                sample={'runs': 5, 'initial.orientation': 'rotation'})
    assert (both.shape, both.size) == ((2, 3, 5), 30)
    assert (spec().shape, spec().size) == ((2,), 2)


@pytest.mark.parametrize(('entry', 'expected'), [
    ('final', Kept('final', WHOLE)), ({'final': 'position'}, Kept('final', ('position',))),
    ({'states': ['velocity', 'orientation']}, Kept('states', ('velocity', 'orientation'))),
    ('residuals', Kept('residuals')), ({'first': 'flip'}, Kept('first', 'flip')),
    ({'all': 'flip'}, Kept('all', 'flip', 16)),
    ({'all': 'flip', 'most': 3}, Kept('all', 'flip', 3)),
    ({'minimum': 'energy'}, Kept('minimum', 'energy')),
    ({'maximum': 'speed'}, Kept('maximum', 'speed'))])
def test_what_is_kept_is_read(entry, expected):
    assert kept(entry) == (expected,)


@pytest.mark.parametrize('entry', [
    'finl', {'final': 'place'}, {'final': []}, {'final': ['position', 'position']}, 3, {},
    {'first': 3}, {'first': None}, {'maximum': 'joy'}, {'minimum': None},
    {'all': 'flip', 'most': 0}, {'all': 'flip', 'least': 1}, {'first': 'flip', 'most': 2},
    {'function': 'nowhere.at_all:f'}])
def test_what_cannot_be_kept_is_refused(entry):
    with pytest.raises(BadInput, match='sweep: keep'):
        kept(entry)


@pytest.mark.parametrize(('changes', 'said'), [
    ({'kep': 'final'}, r'sweep: kep: is not a word of a sweep; did you mean keep\?'),
    ({'colour': 3}, 'sweep: colour: is not .*; the words are scene, .*, keep'),
    ({'keep': 'finall'}, r"did you mean 'final'\?"), ({'keep': 'colour'}, 'one of final, .*'),
    ({'keep': {'first': 'flip', 'most': 2}}, 'one of final, .*'),
    ({'keep': {'maximum': 'kinetic_enrgy'}}, r'did you mean kinetic_energy\?'),
    ({'keep': {'maximum': 'colour'}}, 'one of orientation.x, .*'),
    ({'keep': {'maximum': 3}}, 'one of orientation.x, .*'),
    ({'keep': {'first': 3}}, r'the name of an event \(flip, .*')])
def test_a_word_that_is_nearly_right_is_told_what_it_may_mean(changes, said):
    with pytest.raises(BadInput, match=f'{said}$'):
        spec(**changes)


@pytest.mark.parametrize('key', ['a/b', 'run', 'time', 'axis', 'quaternion', 'block'])
def test_names_of_dimensions_are_no_keys(key):
    with pytest.raises(BadInput, match='is not a key of a scene'):
        spec(vary={key: [1]})


def test_a_key_stands_in_one_place_and_there_is_one():
    with pytest.raises(BadInput, match='is in vary too'):
        spec(sample={'runs': 2, 'body.mass': {'uniform': [1, 2]}})
    with pytest.raises(BadInput, match='neither vary nor sample'):
        spec(vary={})
    for missing in ('scene', 'keep'):
        with pytest.raises(BadInput, match=f"the key '{missing}' is missing"):
            read({key: value for key, value in BASE.items() if key != missing})


def test_a_spec_is_made_again_of_its_text():
    one = spec(vary={'body.mass': {'linspace': [1, 2, 5]}, 'initial.tilt': [0.0, 0.5]},
               sample={'runs': 4, 'seed': 9, 'initial.orientation': 'rotation'},
               times=[1, 2], keep=['final', {'all': 'flip', 'most': 3}], accuracy=1e-9,
               integrator='dop8')
    other = again(one.text, {})
    assert other.text == one.text
    assert (other.keep, other.runs, other.accuracy, other.integrator, other.shape) == (
        one.keep, one.runs, one.accuracy, one.integrator, one.shape)
    assert fingerprint(other) == fingerprint(one)
    assert (other.sample['initial.orientation'].of_runs(0, 4)
            == one.sample['initial.orientation'].of_runs(0, 4)).all()
    changed = fingerprint(spec(accuracy=1e-8))
    assert {word for word in changed if changed[word] != fingerprint(spec())[word]} == {'accuracy'}


def height(run):
    return run.states.position[-1, 2]


def test_a_function_is_carried_to_workers_unless_they_find_it_by_its_name():
    for keep in ([{'function': height}], [{'function': height}, 'final'], ['final', {
            'function': height}], {'function': height}):
        one = spec(keep=keep)
        [name] = one.functions
        assert one.carried == {name: height}
        assert again(one.text, one.carried).carried == {name: height}
    named = spec(keep=['final', {'function': 'math:sqrt'}])
    assert (list(named.functions), named.carried) == (['math:sqrt'], {})


def test_what_is_left_out_has_its_default():
    one = spec(vary={}, sample={'runs': 3, 'initial.orientation': 'rotation'})
    assert (one.accuracy, one.integrator, one.times.tolist()) == (1e-12, 'auto', [0.0])
    assert again(one.text, {}).times.tolist() == [0.0]
    assert (one.sample['initial.orientation'].of_runs(0, 3) == spec(vary={}, sample={
        'runs': 3, 'seed': 0, 'initial.orientation': 'rotation'}).sample[
            'initial.orientation'].of_runs(0, 3)).all()
    assert (spec().sample, spec().runs) == ({}, 0)
    assert Kept('residuals').most == 0


def test_as_many_times_of_an_event_as_may_be_kept():
    assert kept({'all': 'flip', 'most': 10 ** 6})[0].most == 10 ** 6
    for most in (10 ** 6 + 1, 0, 2.0, True):
        with pytest.raises(BadInput, match=r'keep\.0\.most'):
            kept({'all': 'flip', 'most': most})


def test_a_spec_is_a_mapping_a_text_or_a_file_and_its_scene_may_lie_beside_it(tmp_path):
    text = 'scene: {}\nvary: {{body.mass: [1, 2]}}\nkeep: final\n'
    expected = spec().text
    (tmp_path / 'tennis_racket').write_text('no scene: it has no suffix')
    (tmp_path / 'a.yaml').write_text(text.format('tennis_racket'))
    for given in (BASE, text.format('tennis_racket'), tmp_path / 'a.yaml',
                  str(tmp_path / 'a.yaml')):
        assert read(given).text == expected
    assert read(read(BASE)).text == expected
    for name in ('mine.yaml', 'mine.yml'):
        (tmp_path / name).write_text(spec().scene.replace('tennis_racket', 'mine'))
        (tmp_path / 'b.yaml').write_text(text.format(name))
        assert 'mine' in read(tmp_path / 'b.yaml').scene
    (tmp_path / 'b.yaml').write_text(text.format('nowhere.yaml'))
    with pytest.raises(BadInput, match=r'nowhere\.yaml'):
        read(tmp_path / 'b.yaml')


def test_a_file_that_cannot_be_read_is_one_line(tmp_path):
    (tmp_path / 'a.yaml').write_bytes(b'scene: \xff\n')
    with pytest.raises(BadInput, match=r'cannot read .*a\.yaml.: not UTF-8 text'):
        read(tmp_path / 'a.yaml')
    with pytest.raises(BadInput, match=r'cannot read .*b\.yaml.: No such file'):
        read(tmp_path / 'b.yaml')
