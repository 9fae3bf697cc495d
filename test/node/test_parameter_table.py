# SPDX-License-Identifier: Apache-2.0
"""One parameter of the table by itself: what it takes, what it refuses, what ROS is told of it."""

import array
import math

import pytest

from rigid_body_sim.errors import BadInput
from rigid_body_sim.node.parameter_table import Entry

NUMBER = Entry('number', 1.0, 'a number', 0.5, 2.0)
ANY = Entry('any', 1.0, 'any number')
WORD = Entry('word', 'slip', 'a word', choices=('slip', 'skip', 'stop'))
WORDS = Entry('words', (), 'words', choices=('pose', 'twist', 'odom', 'imu'), changeable=True)
TEXTS = Entry('texts', ('a',), 'texts')
SWITCH = Entry('switch', True, 'on or off')


@pytest.mark.parametrize(('entry', 'value', 'expected'), [
    (NUMBER, 0.5, 0.5), (NUMBER, 2, 2.0), (NUMBER, '1e0', 1.0), (ANY, -1e300, -1e300),
    (ANY, math.inf, math.inf), (ANY, -math.inf, -math.inf), (WORD, 'skip', 'skip'),
    (WORDS, None, ()), (WORDS, '', ()), (WORDS, 'odom', ('odom',)), (WORDS, [], ()),
    (WORDS, ['imu', 'pose'], ('imu', 'pose')), (TEXTS, array.array('u', 'xy'), ('x', 'y')),
    (SWITCH, False, False)])
def test_what_is_allowed_is_taken_with_the_type_of_the_table(entry, value, expected):
    found = entry.checked(value)
    assert (found, type(found)) == (expected, type(entry.default))


@pytest.mark.parametrize(('entry', 'value', 'said'), [
    (NUMBER, 0.4999, 'got 0.4999; needs a number from 0.5 to 2'),
    (NUMBER, 2.0001, 'got 2.0001; needs a number'), (NUMBER, math.nan, 'got nan; needs a number'),
    (NUMBER, True, 'got True; needs a number'), (NUMBER, None, 'got None; needs a number'),
    (NUMBER, array.array('d', [1.0]), r'got \[1\.0\]; needs a number'),
    # of three words all are told, of four the nearest one
    (WORD, 'slipp', "got 'slipp'; needs one of slip, skip, stop"),
    (WORDS, ['odo'], "got 'odo'; did you mean 'odom'"),
    (WORDS, ['xyzzy'], "got 'xyzzy'; needs one of pose, twist, odom, imu"),
    (WORDS, ['pose', 5], r"got \['pose', 5\]; needs a list of words, each one of pose, twist"),
    (WORDS, 5, 'got 5; needs a list of words, each'),
    (TEXTS, [5], r'got \[5\]; needs a list of words$'),
    (SWITCH, 1, 'got 1; needs true or false'), (WORD, True, 'got True; needs a text')])
def test_anything_else_is_refused_with_what_would_be_right(entry, value, said):
    with pytest.raises(BadInput, match=f'parameter {entry.name}: {said}'):
        entry.checked(value)


@pytest.mark.parametrize(('entry', 'kind', 'limits'), [
    (NUMBER, 'double', '0.5 to 2'), (ANY, 'double', '-inf to inf'),
    (WORD, 'string', 'slip, skip, stop'), (WORDS, 'string array', 'pose, twist, odom, imu'),
    (TEXTS, 'string array', ''), (SWITCH, 'bool', '')])
def test_kind_and_limits_are_told_in_words(entry, kind, limits):
    assert (entry.kind, entry.limits) == (kind, limits)
    assert entry.descriptor(True).additional_constraints == limits


@pytest.mark.parametrize(('entry', 'fixed', 'read_only'), [
    (NUMBER, True, True), (NUMBER, False, False), (Entry('x', 1.0, '', changeable=True), True,
                                                   False),
    # a list is declared before it has its value
    (TEXTS, True, False), (WORDS, True, False), (SWITCH, True, True)])
def test_what_never_changes_is_told_to_be_so_unless_it_is_a_list(entry, fixed, read_only):
    assert entry.descriptor(fixed).read_only is read_only


def test_what_says_nothing_else_is_fixed_while_the_node_runs():
    assert Entry('x', 1.0, '').changeable is False
