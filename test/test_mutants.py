# SPDX-License-Identifier: Apache-2.0
"""The check that changes the code at random: what it draws, and what it takes for equivalent."""

import ast
import random
import types

import pytest
import yaml

pytest.importorskip('coverage')

import mutants

TABLE = yaml.safe_load(mutants.EQUIVALENT.read_text())
SOURCE = '''
"""A text with - and < in it."""
MOST = 3


def f(x1, x2, limit: int = -1):
    """Return 1 + 1."""
    if x1 < limit and not x2:
        return f'{x1 + 1}'
    for k, _ in zip(range(2), 'ab', strict=True):
        x1 += min(x1, x2) * k
    return x1 - x2
'''


def all_of(path, root, among=None):
    """Return every mutant of a file, or of statements that have one of the texts."""
    found = []
    for makers in mutants.mutants_of(path, root, among).values():
        for make in makers:
            for place in range(3):
                one = make(types.SimpleNamespace(
                    choice=lambda others, place=place: others[min(place, len(others) - 1)]))
                found.append(one)
    return {one.source: one for one in found}.values()


def test_each_kind_of_change_is_made_once_at_its_place(tmp_path):
    path = tmp_path / 'a.py'
    path.write_text(SOURCE)
    found = sorted(all_of(path, tmp_path), key=lambda one: (one.line, one.after))
    assert [(one.line, one.function, one.after) for one in found] == [
        (3, '', 'MOST = 2'), (3, '', 'MOST = 4'),
        (6, 'f', 'def f(x1, x2, limit: int=-0):'), (6, 'f', 'def f(x1, x2, limit: int=-2):'),
        (6, 'f', 'def f(x1, x2, limit: int=1):'), (8, 'f', 'if x1 < limit and (not x1):'),
        (8, 'f', 'if x1 < limit and x2:'), (8, 'f', 'if x1 < limit or not x2:'),
        (8, 'f', 'if x1 <= limit and (not x2):'), (8, 'f', 'if x1 > limit and (not x2):'),
        (8, 'f', 'if x2 < limit and (not x2):'),
        (10, 'f', "for k, _ in zip(range(1), 'ab', strict=True):"),
        (10, 'f', "for k, _ in zip(range(3), 'ab', strict=True):"),
        (11, 'f', 'x1 += max(x1, x2) * k'), (11, 'f', 'x1 += min(x1, x1) * k'),
        (11, 'f', 'x1 += min(x1, x2) / k'),
        (11, 'f', 'x1 += min(x2, x2) * k'), (11, 'f', 'x1 -= min(x1, x2) * k'),
        (12, 'f', 'return x1 + x2'), (12, 'f', 'return x1 - x1'), (12, 'f', 'return x2 - x2')]
    for one in found:
        tree = ast.unparse(ast.parse(one.source))
        assert tree != ast.unparse(ast.parse(SOURCE))
        assert one.after.rstrip(':') in tree.replace(' = ', ' = ')
        assert one.source.count('\n') == SOURCE.count('\n')


def test_a_seed_draws_the_same_mutants_and_another_one_others():
    folder = ['rigid_body_sim/mechanics']
    first, again, other = (mutants.drawn(seed, 20, folder) for seed in ('1', '1', '2'))
    assert first == again
    assert len({one.source for one in first}) == 20
    assert not {str(one) for one in first} >= {str(one) for one in other}
    assert len({one.kind for one in first}) == 7
    for one in first:
        ast.parse(one.source)


def test_a_kind_of_which_all_are_drawn_leaves_the_rest_to_the_others():
    found = mutants.drawn('1', 99, ['rigid_body_sim/node/gaps.py'])
    assert len({one.source for one in found}) == len(found) == 18
    assert sorted(one.kind for one in found)[:3] == ['call', 'call', 'comparison']


@pytest.mark.parametrize('file', sorted({entry['file'] for entry in TABLE}))
def test_each_equivalent_mutant_is_still_one(file):
    entries = [entry for entry in TABLE if entry['file'] == file]
    found = all_of(mutants.ROOT / file, mutants.ROOT, [entry['statement'] for entry in entries])
    gone = [entry for entry in entries
            if not any(mutants.why_equivalent(one, [entry]) for one in found)]
    assert not gone, 'their statements are gone: remove the entries'


def test_what_bears_on_a_file_begins_with_its_own_test():
    for file, first in (('mechanics/panels.py', 'test/mechanics/test_panels.py'),
                        ('errors.py', 'test/test_errors.py'),
                        ('scene/effects/strike.py', 'test/scene/effects/test_strike.py')):
        assert mutants.stages(f'rigid_body_sim/{file}')[0] == [first]
    chance = random.Random(3)
    for path in chance.sample(sorted((mutants.ROOT / 'rigid_body_sim').rglob('*.py')), 20):
        for stage in mutants.stages(str(path.relative_to(mutants.ROOT))):
            assert stage


def test_near_are_the_tests_of_its_name_a_few_that_import_it_and_the_digests():
    files = ('motions/nearly.py', 'scene/effects/spring.py', 'recording/mcap/scan.py')
    of_name, of_folder, of_room = (
        mutants.stages(f'rigid_body_sim/{file}', near=True) for file in files)
    assert of_name[0] == ['test/motions/test_nearly.py']
    assert of_name[-1] == [mutants.DIGESTS]
    for importing in of_name[1:-1]:
        assert len(importing) <= mutants.FEW
        assert all('motions.nearly' in (mutants.ROOT / test).read_text() for test in importing)
    assert of_folder[0] == [mutants.DIGESTS]    # no test has its name: its folder, then its room
    assert of_folder[1][0].startswith('test/scene/effects/')
    assert of_folder[1][-1].startswith('test/scene/test_')
    assert of_room[0][0].startswith('test/recording/mcap/')
    assert len(mutants.stages('rigid_body_sim/scene/scene.py', near=True)[1]) == mutants.FEW
