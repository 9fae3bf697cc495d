# SPDX-License-Identifier: Apache-2.0
"""What a worker does with its task: the versions, the store and the functions that it has."""

import json
import types

import numpy as np
import pytest

from rigid_body_sim.errors import BadInput
from rigid_body_sim.sweeps import spec as specs
from rigid_body_sim.sweeps import work as module
from rigid_body_sim.sweeps.plan import DONE, GAVE_UP, REFUSED, Plan
from rigid_body_sim.sweeps.results import Block
from rigid_body_sim.sweeps.work import Task, do, work

pytestmark = pytest.mark.without_numba


@pytest.fixture
def task(monkeypatch):
    """Return a function that makes a task; nothing is known of earlier ones."""
    monkeypatch.setattr(module, '_PLANS', {})
    monkeypatch.setattr(module, '_STORES', {})
    monkeypatch.setattr(module.stores, 'versions', lambda: {'package': '1', 'arithmetic': '2'})

    def task(store='', versions=None, carried=None):
        spec = specs.read({'scene': 'tennis_racket', 'vary': {'body.mass': [1.0, 2.0]},
                           'keep': 'final'})
        return Task(spec.text, json.dumps(Plan(spec).outputs), carried or {},
                    {'package': '1', 'arithmetic': '2'} | (versions or {}), str(store), 'layout')
    return task


@pytest.fixture
def computed(monkeypatch):
    """Keep what is computed: (plan, first, stop, into, whether with the values)."""
    asked = []

    def compute(plan, first, stop, into, values):
        asked.append((plan, first, stop, into, values))
        status = np.array([DONE, GAVE_UP, REFUSED, DONE, GAVE_UP])[:stop - first]
        return Block(first, stop, {'status': status}, {}, {})
    monkeypatch.setattr(module, 'compute', compute)
    now = iter([5.0, 7.5, 8.0, 8.25])
    monkeypatch.setattr(module, 'time', types.SimpleNamespace(perf_counter=lambda: next(now)))
    return asked


@pytest.mark.parametrize(('versions', 'said'), [
    ({'package': '3'}, 'has version 1 of package, and the sweep was started by 3'),
    ({'other': '1'}, 'has version None of other, and the sweep was started by 1')])
def test_a_worker_of_another_version_does_nothing(task, computed, versions, said):
    with pytest.raises(BadInput, match=f'worker: {said}'):
        work(task(versions=versions), 0, 1, 0)
    assert computed == []


def test_a_worker_without_a_store_returns_the_results_and_what_failed(task, computed):
    found = work(task(), 3, 8, 6)
    assert (found.first, found.stop, found.number, found.failed, found.seconds) == (
        3, 8, 6, 3, 2.5)
    assert found.block.arrays['status'][0] == DONE
    assert work(task(), 8, 9, 7).failed == 0
    # the plan is made once
    assert computed[0][0] is computed[1][0]
    assert [asked[1:] for asked in computed] == [(3, 8, None, False), (8, 9, None, False)]


def test_functions_that_a_task_carries_are_known_to_the_plan(task, computed):
    for function in (len, max):
        work(task(carried={'mine': function}), 0, 1, 0)
        assert computed[-1][0].spec.functions['mine'] is function


@pytest.mark.parametrize('rows', [False, True])
def test_a_store_gets_the_results_instead(task, computed, monkeypatch, tmp_path, rows):
    written, opened = [], []
    store = types.SimpleNamespace(ROWS=rows, write=lambda *told: written.append(told))
    monkeypatch.setattr(module.stores, 'store_at', lambda path: opened.append(path) or store)
    found = work(task(tmp_path), 0, 2, 4)
    assert found.block is None and found.failed == 1
    work(task(tmp_path), 2, 4, 5)
    assert opened == [str(tmp_path)]    # once
    assert [(layout, block.first, number) for layout, block, number in written] == [
        ('layout', 0, 4), ('layout', 2, 5)]
    assert [asked[4] for asked in computed] == [rows, rows]
    with pytest.raises(BadInput, match='does not see the store'):
        work(task(tmp_path / 'nowhere'), 0, 2, 4)


def test_results_go_where_there_is_memory_for_them(task, computed):
    do('plan', 1, 2, 0, into='here')
    assert computed == [('plan', 1, 2, 'here', False)]
