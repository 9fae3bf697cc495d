# SPDX-License-Identifier: Apache-2.0
"""Each mutant of test/hard_cases/mutations.py fails its test; two here, all with `make soak`.

That the tests pass on the original is shown by themselves here, and in the same way with
`make soak`.
"""

import pytest
from hard_cases import mutations
from soak import SOAK


@pytest.mark.parametrize('name', mutations.MUTANTS if SOAK else mutations.QUICK)
def test_mutant_is_found_out(name, tmp_path):
    assert mutations.killed(name, tmp_path)


@pytest.mark.parametrize('name', mutations.MUTANTS)
def test_what_a_mutant_changes_stands_in_its_file(name):
    file, found, put, _ = mutations.MUTANTS[name]
    assert found in (mutations.ROOT / 'rigid_body_sim' / file).read_text() and found != put


@pytest.mark.skipif(not SOAK, reason='make soak')
@pytest.mark.parametrize('name', mutations.MUTANTS)
def test_what_is_not_mutated_passes(name, tmp_path, monkeypatch):
    file, found, _, test = mutations.MUTANTS[name]
    monkeypatch.setitem(mutations.MUTANTS, name, (file, found, found, test))
    assert not mutations.killed(name, tmp_path)
