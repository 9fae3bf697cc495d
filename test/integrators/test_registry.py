# SPDX-License-Identifier: Apache-2.0
"""The table of methods: which ones can follow what acts."""

import types

import pytest

from rigid_body_sim.errors import BadInput
from rigid_body_sim.integrators import METHODS
from rigid_body_sim.integrators.registry import Methods


def page(name, like='rk4', **changes):
    """Return the page of a method of this package under another name."""
    made = types.ModuleType(name)
    made.__dict__.update(vars(METHODS[like]) | {'NAME': name} | changes)
    return made


def test_what_was_asked_before_changes_with_the_table():
    table = Methods({'one': page('one')})
    views = frozenset({METHODS['rk4'].NEEDS})
    assert table.able(views, False, False, False) == ('one',)
    table['two'] = page('two')
    assert table.able(views, False, False, False) == ('one', 'two')
    del table['one']
    assert table.able(views, False, False, False) == ('two',)
    table['two'] = page('two', HEAT=False)
    assert table.able(views, True, False, False) == ()
    assert table.able(views, False, False, False) == ('two',)


@pytest.mark.parametrize(('acts', 'declared'), [('hot', 'HEAT'), ('in_field', 'FIELD')])
def test_a_method_runs_what_it_declares(acts, declared):
    table = Methods({'with': page('with', **{declared: True}),
                     'without': page('without', **{declared: False})})
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
        Methods({'two': page('one')})
