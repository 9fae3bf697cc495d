# SPDX-License-Identifier: Apache-2.0
"""The command `hard_cases`: table, JSON, exit status."""

import json

import pytest

from rigid_body_sim.study.hard_cases import hard_cases
from rigid_body_sim.study.hard_cases.case import Case, Outcome
from rigid_body_sim.study.hard_cases.table import of_group


@pytest.fixture
def few(monkeypatch):
    cases = [*of_group(2)[:2], *of_group(9)]
    monkeypatch.setattr(hard_cases, 'CASES', cases)
    return cases


def test_json_has_every_case(few, capsys):
    assert hard_cases.main(['--json']) == 0
    found = json.loads(capsys.readouterr().out)['cases']
    assert [row['case'] for row in found] == [case.name for case in few]
    assert all(row['good'] and row['error'] <= row['bound'] and row['why'] for row in found)


@pytest.mark.parametrize('error', [2.0, float('nan'), float('inf')])
def test_a_case_that_fails_is_said_and_is_the_exit_status(few, capsys, error):
    few.append(Case(
        9, 'made to fail', 'it must be seen', lambda: Outcome(error, 1.0, 'rad', 'none')))
    assert hard_cases.main([]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[-2].startswith('FAILS  commands     made to fail: ')
    assert lines[-1] == f'{len(few) - 1} of {len(few)} cases within their bounds'
