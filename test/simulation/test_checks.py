# SPDX-License-Identifier: Apache-2.0
"""What a Simulation is given is checked: numbers, counts of ticks, starts."""

import fractions
import math

import numpy as np
import pytest

from rigid_body_sim.errors import BadInput
from rigid_body_sim.mechanics.energy import DIAGNOSIS, NOT_FINITE, NOT_UNIT
from rigid_body_sim.simulation import checks

LAST = 9007199254740992    # beyond, a double does not tell n from n + 1


@pytest.mark.parametrize('value', [1.5, 2, np.float64(3.0), math.nan, fractions.Fraction(1, 3)])
def test_a_number_is_one(value):
    checks.refuse_no_number('step', value)


@pytest.mark.parametrize('value', [True, '1', None, 1j, [1.0], np.ones(1)])
def test_what_cannot_be_compared_with_a_number_is_none(value):
    with pytest.raises(BadInput, match=r'step: got .*; a number'):
        checks.refuse_no_number('step', value)


@pytest.mark.parametrize(('values', 'expected'), [
    (3, [3.0]), ([1, 2.5], [1.0, 2.5]), (np.array([1, 2], 'u1'), [1.0, 2.0]), ([], []),
    ([2 ** 70, fractions.Fraction(1, 2)], [2.0 ** 70, 0.5])])
def test_numbers_become_doubles(values, expected):
    found = checks.doubles('states', values, checks.TIMES)
    assert found.dtype == float and found.tolist() == expected


@pytest.mark.parametrize('values', [
    'now', ['1.5'], [True], [1j], [[1.0], [1.0, 2.0]], [None, 1.0], [2 ** 70, 'a'], [10 ** 400]])
def test_what_is_no_sequence_of_numbers_is_refused(values):
    with pytest.raises(BadInput, match=r'states: got .*; times in s'):
        checks.doubles('states', values, checks.TIMES)


@pytest.mark.parametrize(('ticks', 'now'), [
    (0, 0), (7, 3), (np.int64(5), 0), (LAST, 0), (LAST - 3, 3), (0, LAST)])
def test_ticks_are_counted_up_to_where_doubles_are_exact(ticks, now):
    count = checks.number_of_ticks('advance', ticks, now)
    assert (type(count), count) == (int, ticks)


@pytest.mark.parametrize(('ticks', 'now'), [
    (-1, 0), (LAST + 1, 0), (LAST - 2, 3), (1, LAST), (True, 0), (False, 0), (1.0, 0), ('1', 0)])
def test_what_is_no_number_of_ticks_is_refused(ticks, now):
    with pytest.raises(BadInput, match=f'advance: got .* an integer from 0 to {LAST - now}'):
        checks.number_of_ticks('advance', ticks, now)


def diagnosed(**parts):
    """Return what was diagnosed of a start, of parts by their names; the others are 1."""
    diagnosis = np.ones(DIAGNOSIS.size)
    for name, value in parts.items():
        diagnosis[DIAGNOSIS.part(name).places] = value
    return diagnosis


@pytest.mark.parametrize(('fault', 'parts', 'words'), [
    (NOT_FINITE, {}, 'got numbers that are not finite'),
    (NOT_UNIT, {}, r'got the orientation \[2.0, 3.0, 4.0, 5.0\]; a unit quaternion'),
    (-1, {'kinetic': math.inf}, r'the kinetic energy is beyond .* \(inf J\)'),
    (-1, {'kinetic': math.nan, 'potential': math.inf}, r'the kinetic energy .* \(nan J\)'),
    (-1, {'potential': -math.inf}, r'the potential energy is beyond .* \(-inf J\)'),
    (-1, {'momentum': [0.0, math.inf, 0.0]}, r'the angular momentum is beyond .* \(inf kg m'),
    (-1, {'momentum': [0.0, 4e200, 0.0]},
     r'the square of the angular momentum is beyond .* \(of 4e\+200 kg m')])
def test_a_start_that_is_none_is_refused_by_what_is_wrong_with_it(fault, parts, words):
    start = np.arange(1.0, 15.0)
    with pytest.raises(BadInput, match=f'a: initial: {words}'):
        checks.refuse_start('a', fault, start, diagnosed(**parts))
