# SPDX-License-Identifier: Apache-2.0
"""Values of a sweep: what lists, spaces, samples and times mean, and what they cannot be."""

import math

import numpy as np
import pytest
from near import near

from rigid_body_sim.errors import BadInput
from rigid_body_sim.sweeps import values
from rigid_body_sim.sweeps.draws import Sampled
from rigid_body_sim.sweeps.values import a_count, a_number, sample_of, times_of, values_of


@pytest.mark.parametrize(('given', 'expected'), [
    ([1, 2.5, 4], [1.0, 2.5, 4.0]), (np.array([1, 2]), [1.0, 2.0]), ((7,), [7.0]),
    ({'linspace': [1, 3, 5]}, [1.0, 1.5, 2.0, 2.5, 3.0]), ({'linspace': [3, 1, 2]}, [3.0, 1.0]),
    ({'logspace': [-1, 2, 4]}, [0.1, 1.0, 10.0, 100.0]), ({'linspace': [4, 9, 1]}, [4.0])])
def test_numbers_are_an_array(given, expected):
    found = values_of(given, 'k')
    assert found.dtype == float
    assert found.tolist() == near(expected, rel=1e-15)


@pytest.mark.parametrize('given', [
    [[1, 2], [3, 4]], ['auto', 'rk4'], [1, 'auto'], [True, False], [1, True], [{'a': 1}]])
def test_what_is_not_all_numbers_is_a_list(given):
    assert values_of(given, 'k') == given


@pytest.mark.parametrize(('given', 'words'), [
    ([], 'a list of values'), (3, 'a list of values'), ('abc', 'a list of values'),
    ([1, math.inf], 'a finite number'), ([math.nan], 'a finite number'),
    ({'linspace': [1, 2, 3], 'logspace': [1, 2, 3]}, 'a list, {linspace'), ({}, 'a list, {lins'),
    ({'geomspace': [1, 2, 3]}, 'a list, {linspace'), ({'linspace': [1, 2]}, 'k.linspace: got'),
    ({'linspace': [1, 2, 3, 4]}, 'k.linspace: got'), ({'logspace': 'abc'}, 'k.logspace: got'),
    ({'linspace': [1, 'b', 3]}, 'a finite number'), ({'linspace': [1, math.inf, 3]}, 'a finite'),
    ({'linspace': [1, 2, 0]}, 'a whole number from 1 to 10000000'),
    ({'linspace': [1, 2, 10 ** 7 + 1]}, 'a whole number from 1 to 10000000')])
def test_what_is_no_list_of_values_is_refused(given, words):
    with pytest.raises(BadInput, match=words):
        values_of(given, 'k')


def test_there_are_no_more_values_than_the_most(monkeypatch):
    assert values.MOST_VALUES == 10 ** 7
    monkeypatch.setattr(values, 'MOST_VALUES', 3)
    assert len(values_of([1, 2, 3], 'k')) == len(values_of({'linspace': [1, 2, 3]}, 'k')) == 3
    for given in ([1, 2, 3, 4], {'linspace': [1, 2, 4]}):
        with pytest.raises(BadInput):
            values_of(given, 'k')


@pytest.mark.parametrize('value', [True, '1', None, math.inf, -math.inf, math.nan, [1]])
def test_a_number_is_finite_and_no_truth_value(value):
    assert [a_number(one, 'k') for one in (2, -0.5, np.float32(0.25))] == [2.0, -0.5, 0.25]
    assert type(a_number(2, 'k')) is float
    with pytest.raises(BadInput, match='a finite number'):
        a_number(value, 'k')


@pytest.mark.parametrize('value', [True, 1.0, '1', 0, -1, 10 ** 12 + 1])
def test_a_count_is_whole_and_within_its_bounds(value):
    assert [a_count(one, 'k') for one in (1, np.int64(7), 10 ** 12)] == [1, 7, 10 ** 12]
    assert [a_count(one, 'k', 3, 5) for one in (3, 5)] == [3, 5]
    for bad in (2, 6):
        with pytest.raises(BadInput, match='from 3 to 5'):
            a_count(bad, 'k', 3, 5)
    with pytest.raises(BadInput, match='from 1 to 1000000000000'):
        a_count(value, 'k')


def test_samples_have_their_kind_and_numbers_and_the_seed_of_all():
    found, runs, seed = sample_of({
        'runs': 5, 'seed': 7, 'a': {'uniform': [4, 6]}, 'b': {'normal': [1, 0]},
        'c': {'direction': 2}, 'd': 'rotation', 'e': {'uniform': [3, 3]}}, 's')
    assert (runs, seed) == (5, 7)
    for key, expected in {'a': ('uniform', 4.0, 6.0), 'b': ('normal', 1.0, 0.0),
                          'c': ('direction', 2.0, 0.0), 'd': ('rotation', 0.0, 0.0),
                          'e': ('uniform', 3.0, 3.0)}.items():
        same = Sampled(*expected, 7, key)
        assert found[key].of_runs(0, 4).tolist() == same.of_runs(0, 4).tolist()
    assert sample_of({'runs': 1, 'a': 'rotation'}, 's')[1:] == (1, 0)
    assert sample_of({'runs': 1, 'seed': 2 ** 63, 'a': 'rotation'}, 's')[2] == 2 ** 63
    assert sample_of({}, 's') == ({}, 0, 0)


@pytest.mark.parametrize(('given', 'words'), [
    ({'a': 'rotation'}, "the key 'runs' is missing"), ({'runs': 3}, 'names no key'),
    ({'runs': 0, 'a': 'rotation'}, 's.runs: got 0'), ({'runs': 1, 'seed': -1}, 's.seed: got -1'),
    ({'runs': 1, 'seed': 2 ** 63 + 1}, 's.seed: got'),
    *(({'runs': 3, 'a': one}, 's.a: got') for one in (
        {'uniform': [6, 4]}, {'normal': [1, -0.5]}, {'uniform': 4}, {'uniform': [1, 2, 3]},
        {'rotation': 1}, {'flat': [1, 2]}, 'flat', {}, {'uniform': [1, 2], 'normal': [1, 2]},
        {'direction': 'x'}, {'uniform': [1, math.inf]}))])
def test_what_is_no_sample_is_refused(given, words):
    with pytest.raises(BadInput, match=words):
        sample_of(given, 's')


def test_times_are_from_zero_on_each_later_than_the_one_before():
    assert times_of(3, 't').tolist() == [3.0]
    assert times_of([0, 0.5, 2], 't').tolist() == [0.0, 0.5, 2.0]
    assert times_of({'linspace': [0, 1, 3]}, 't').tolist() == [0.0, 0.5, 1.0]
    for bad in ([], [-0.5, 1], [0, 1, 1], [2, 1, 3], {'linspace': [1, 0, 3]}, -1, 'soon'):
        with pytest.raises(BadInput, match='seconds'):
            times_of(bad, 't')
