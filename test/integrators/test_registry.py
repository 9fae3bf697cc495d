# SPDX-License-Identifier: Apache-2.0
"""The table of methods: what a page has to declare, and which pages can follow what acts."""

import types

import pytest

from rigid_body_sim.errors import BadInput
from rigid_body_sim.integrators import METHODS
from rigid_body_sim.integrators.registry import Methods

FAMILY = {'ASKS': {'accuracy': ('A', 'E'), 'step': ('A',)}, 'TABLE': True, 'TAKES_WRENCH': True,
          'LANES': False, 'KINKS': False, 'ROOTS': False, 'FINEST': 1e-15, 'bind': None}
PAGE = {'NAME': 'mine', 'ORDER': 2, 'PRESERVES': (), 'SOURCE': 'a book', 'NEEDS': 'acting',
        'HEAT': True, 'FIELD': True, 'STIFF': (), 'TABLE': False, 'TAKES': ('accuracy', 'step'),
        'A': 1, 'E': 2}


def add(page=(), family=(), without=()):
    """Add a page that differs from a good one; return the table."""
    table, of = Methods(), types.SimpleNamespace(**{**FAMILY, **dict(family)})
    entries = {name: value for name, value in {**PAGE, **dict(page)}.items()
               if name not in without}
    table['mine'] = types.SimpleNamespace(FAMILY=of, **entries)
    return table


@pytest.mark.parametrize(('page', 'family', 'without'), [
    ({}, {}, ()), ({'TABLE': True}, {}, ()), ({'TAKES': ('step',)}, {}, ('E',)),
    ({'TAKES': ('step',)}, {'ASKS': {'step': ()}}, ('A', 'E')),
    ({'TAKES': ('accuracy',), 'TABLE': True}, {}, ())])
def test_a_page_that_declares_what_its_family_asks_for_is_in_the_table(page, family, without):
    assert list(add(page, family, without)) == ['mine']


@pytest.mark.parametrize(('page', 'family', 'without', 'said'), [
    ({}, {}, ('ORDER',), 'lacks ORDER'), ({}, {}, ('STIFF', 'HEAT'), 'lacks HEAT, STIFF'),
    ({'NAME': 'yours'}, {}, (), "calls itself 'yours'"),
    ({'TAKES': ()}, {}, (), r'TAKES: got \(\)'), ({'TAKES': ('order',)}, {}, (), 'TAKES: got'),
    ({'TAKES': ('order', 'step')}, {'ASKS': {'order': (), 'step': ()}}, (), 'some of step'),
    ({}, {'ASKS': {'step': ('A',)}}, (), 'some of step'),
    ({'TABLE': True, 'TAKES': ('step',)}, {}, (), 'TABLE: got True'),
    ({'TABLE': True}, {'TABLE': False}, (), 'TABLE: got True'),
    ({}, {}, ('E',), r'lacks E\b'), ({'TAKES': ('step',)}, {}, ('A',), r'lacks A\b')])
def test_a_page_that_lacks_something_is_refused_and_told_what(page, family, without, said):
    with pytest.raises(BadInput, match=f'method mine.*{said}'):
        add(page, family, without)


@pytest.mark.parametrize('name', [*FAMILY])
def test_a_family_declares_everything_too(name):
    of = types.SimpleNamespace(**{one: value for one, value in FAMILY.items() if one != name})
    with pytest.raises(BadInput, match=f'method mine: FAMILY.*lacks {name}'):
        Methods()['mine'] = types.SimpleNamespace(FAMILY=of, **PAGE)


def renamed(name, **changes):
    """Return the page of rk4 under another name."""
    made = types.ModuleType(name)
    made.__dict__.update(vars(METHODS['rk4']) | {'NAME': name} | changes)
    return made


def test_what_was_asked_before_changes_with_the_table():
    table = Methods({'one': renamed('one')})
    views = frozenset({METHODS['rk4'].NEEDS})
    assert table.able(views, False, False, False) == ('one',)
    table['two'] = renamed('two')
    assert table.able(views, False, False, False) == ('one', 'two')
    del table['one']
    assert table.able(views, False, False, False) == ('two',)
    table['two'] = renamed('two', HEAT=False)
    assert table.able(views, True, False, False) == ()
    assert table.able(views, False, False, False) == ('two',)


@pytest.mark.parametrize(('acts', 'declared'), [('hot', 'HEAT'), ('in_field', 'FIELD')])
def test_a_method_runs_what_it_declares(acts, declared):
    table = Methods({'with': renamed('with', **{declared: True}),
                     'without': renamed('without', **{declared: False})})
    views = frozenset({METHODS['rk4'].NEEDS})
    calm = {'hot': False, 'kinked': False, 'in_field': False}
    assert table.able(views, **calm) == ('with', 'without')
    assert table.able(views, **calm | {acts: True}) == ('with',)


def test_only_methods_that_stop_at_kinks_run_what_has_some():
    names = METHODS.able(frozenset(one.NEEDS for one in METHODS.values()), False, True, False)
    assert names == tuple(name for name, one in METHODS.items() if one.FAMILY.KINKS) != ()


def test_a_view_counts_where_every_effect_has_it():
    table = Methods({name: METHODS[name] for name in ('dop8', 'taylor')})
    needs = METHODS['dop8'].NEEDS, METHODS['taylor'].NEEDS
    both = types.SimpleNamespace(**dict.fromkeys(needs, print))
    first = types.SimpleNamespace(**{needs[0]: print, needs[1]: None})
    assert table.views([]) == table.views([both]) == set(needs)
    assert table.views([both, first]) == {needs[0]}
    assert table.able(table.views([both, first]), False, False, False) == ('dop8',)


def test_a_table_of_a_wrong_page_is_refused_when_it_is_made():
    with pytest.raises(BadInput, match="its page calls itself 'one'"):
        Methods({'two': renamed('one')})
