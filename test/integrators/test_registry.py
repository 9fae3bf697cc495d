# SPDX-License-Identifier: Apache-2.0
"""The table of methods takes pages that keep their contract, and says what another one lacks."""

import types

import pytest

from rigid_body_sim.errors import BadInput
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
