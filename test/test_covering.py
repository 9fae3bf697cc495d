# SPDX-License-Identifier: Apache-2.0
"""The notes of which test runs which line: by them the tests of a mutant are chosen."""

import json

import pytest

coverage = pytest.importorskip('coverage')

import covering  # noqa: E402

FILE = 'rigid_body_sim/mechanics/energy.py'


@pytest.fixture
def noted(tmp_path, monkeypatch):
    """Note made-up lines: by tests, by a fixture that two of them share, by a bound template."""
    root, bound = tmp_path / 'root', tmp_path / 'energy_0123456789ab.py'
    bound.write_text('\n' * ((covering.ROOT / FILE).read_text().count('\n') + 2))
    data = coverage.CoverageData(tmp_path / 'one.coverage')
    for context, path, lines in (
            ('', root / FILE, [1, 2]), ('test/a.py::test_1', root / FILE, [10, 11]),
            ('test/a.py::test_2[x-1]', root / FILE, [11, 12]),
            ('fixture: test/b.py::made', root / FILE, [20]),
            ('digest: top by exact', bound, [12, 32])):
        data.set_context(context)
        data.add_lines({str(path): lines})
    data.write()
    (tmp_path / 'one.json').write_text(json.dumps({
        'root': str(root), 'longer': {str(bound): covering._lines(bound)},
        'sources': {str(root / FILE): covering._hash(covering.ROOT / FILE)},
        'seconds': {'test/a.py::test_1': 0.5, 'test/a.py::test_2[x-1]': 3.0,
                    'test/b.py::test_3': 0.1, 'digest: top by exact': 0.2},
        'users': {'fixture: test/b.py::made': ['test/b.py::test_3', 'test/b.py::test_4']}}))
    monkeypatch.setattr(covering, 'FOLDER', tmp_path)
    for one in (covering._noted, covering._contexts, covering.short):
        one.cache_clear()
    yield
    for one in (covering._noted, covering._contexts, covering.short):
        one.cache_clear()


def test_a_line_is_run_by_its_tests_by_users_of_a_fixture_and_by_bound_templates(noted):
    assert covering.covering(FILE, 10, 10) == {
        'test/a.py::test_1': 0.5, 'digest: top by exact': 0.2}
    assert set(covering.covering(FILE, 11, 12)) == {'test/a.py::test_1', 'test/a.py::test_2[x-1]'}
    assert covering.covering(FILE, 20, 20) == {'test/b.py::test_3': 0.1}    # test_4 has failed
    assert covering.covering(FILE, 30, 30) == {'digest: top by exact': 0.2}


def test_what_is_run_at_import_is_run_by_all_that_use_the_file(noted):
    assert len(covering.covering(FILE, 1, 2)) == 4
    assert covering.covering('rigid_body_sim/errors.py', 1, 2) == {}


def test_a_test_is_short_if_each_of_its_runs_is(noted):
    assert covering.short() == {'test/a.py::test_1', 'test/b.py::test_3', 'digest: top by exact'}
    assert covering.noted_files() >= {'test/a.py', 'test/b.py'}


def test_of_a_file_that_was_edited_since_all_lines_count(noted, tmp_path):
    path = tmp_path / 'one.json'
    of = json.loads(path.read_text())
    of['sources'] = dict.fromkeys(of['sources'], 'another')
    path.write_text(json.dumps(of))
    covering._noted.cache_clear()
    assert len(covering.covering(FILE, 11, 11)) == 4
