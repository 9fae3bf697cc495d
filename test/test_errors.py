# SPDX-License-Identifier: Apache-2.0
"""Which known word a wrong one stands for, and errors that stay one printable line."""

import pickle

import pytest

from rigid_body_sim.errors import BadInput, _slips, nearest, printable

WORDS = ('gravity', 'gravity_gradient', 'drag', 'torque', 'force', 'free', 'tennis_racket',
         'heavy_top', 'fast_top', 'mu', 'g')


@pytest.mark.parametrize(('one', 'other', 'slips'), [
    ('', '', 0), ('abc', 'abc', 0), ('abc', '', 3), ('', 'ab', 2), ('abc', 'abd', 1),
    ('abc', 'ab', 1), ('ab', 'abc', 1), ('abc', 'acb', 1), ('abc', 'bac', 1), ('abcd', 'badc', 2),
    ('abc', 'cab', 2), ('kitten', 'sitting', 3), ('abc', 'xyz', 3), ('aab', 'aba', 1),
    ('ca', 'abc', 3), ('abcdef', 'abcdfe', 1), ('baab', 'abba', 2)])
def test_slips_are_letters_left_out_put_in_replaced_or_swapped(one, other, slips):
    assert _slips(one, other) == slips
    assert _slips(other, one) == slips


@pytest.mark.parametrize(('word', 'meant'), [
    ('gravty', 'gravity'), ('garvity', 'gravity'), ('grvty', None), ('gravitx', 'gravity'),
    ('torqeu', 'torque'), ('tourqeu', 'torque'), ('toque', 'torque'), ('froce', 'force'),
    ('fore', 'force'), ('racket', 'tennis_racket'), ('tennis', 'tennis_racket'), ('top', None),
    ('heavy', 'heavy_top'), ('drga', 'drag'), ('dgra', None), ('gravity', 'gravity'),
    ('gradient', 'gravity_gradient'), ('mv', 'mu'), ('h', 'g'), ('banana', None),
    ('gravity_gradeint', 'gravity_gradient'), ('gravity_grdaeint', 'gravity_gradient'),
    ('gravty_grdaeint', None), (3, 'g')])
def test_a_wrong_word_stands_for_a_near_one_or_for_the_only_longer_one(word, meant):
    assert nearest(word, WORDS) == meant


def test_among_no_words_none_is_near():
    assert nearest('gravity', ()) is None


def test_an_error_is_one_printable_line_and_travels_between_processes():
    error = BadInput('a\nb', 'got \x1b[31m', 'ü is fine')
    assert str(error) == 'a\\nb: got \\x1b[31m; ü is fine'
    again = pickle.loads(pickle.dumps(error))
    assert (again.where, again.problem, again.remedy) == (error.where, error.problem, error.remedy)
    assert printable(12) == '12'
