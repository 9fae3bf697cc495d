# SPDX-License-Identifier: Apache-2.0
"""What a sweep asks of its workers and tells at its end, with workers that only say they are."""

import contextlib
import types

import numpy as np
import pytest

pytest.importorskip('xarray')

from rigid_body_sim.errors import BadInput
from rigid_body_sim.sweeps import sweep as module
from rigid_body_sim.sweeps.engine import Stopped


class Bar:
    """Stands for the progress bar."""

    def __init__(self):
        self.done, self.said = [], ''

    def update(self, runs):
        self.done.append(runs)

    def set_postfix_str(self, text, refresh):
        assert not refresh
        self.said = text


def outcome(first, stop, seconds=0.5, failed=0, number=0, values=None):
    return types.SimpleNamespace(
        first=first, stop=stop, seconds=seconds, failed=failed, number=number,
        block=types.SimpleNamespace(arrays={'energy': values}, texts={first: 'why'}))


@pytest.fixture
def engine(monkeypatch):
    """Return what a stand-in of the engine was told."""
    told = types.SimpleNamespace(limits=[], rates=[], outcomes=[], failure=None, patience=[])

    def run(workers, pieces, submit, take, most):
        told.limits.append(most())
        told.pieces = list(pieces)
        for one in told.outcomes:
            take(one)
            if told.rate:
                told.rates.append(told.rate())
        if told.failure:
            raise told.failure

    def pieces_in_memory(plan, workers, rate):
        told.rate = rate
        told.rates.append(rate())
        return [(0, 3, 0)]
    told.rate = None
    monkeypatch.setattr(module.engine, 'run', run)
    monkeypatch.setattr(module.engine, 'pieces_in_memory', pieces_in_memory)
    monkeypatch.setattr(module.engine, 'seconds_a_run', lambda plan, patience=None: (
        told.patience.append(patience) or 0.25))
    return told


def plan_of(size=6, size_of_run=8):
    return types.SimpleNamespace(
        spec=types.SimpleNamespace(size=size, text='', carried=None), bytes=size_of_run,
        outputs=[], drawn=lambda: None)


@pytest.mark.parametrize(('local', 'most'), [(True, 3), (False, 4)])
def test_results_of_other_processes_are_put_together_and_their_pace_is_told(
        local, most, engine, monkeypatch):
    arrays = {'energy': np.zeros(6)}
    monkeypatch.setattr(module, 'room', lambda plan, size: (arrays, None))
    monkeypatch.setattr(module.stores, 'in_memory', lambda plan, arrays, texts: (arrays, texts))
    monkeypatch.setattr(module, '_task', lambda plan: None)
    engine.outcomes = [outcome(0, 4, 0.5, values=np.arange(4.0)),
                       outcome(4, 6, 0.0, failed=2, values=np.array([7.0, 8.0]))]
    bar = Bar()
    found, texts = module._to_memory(
        plan_of(), types.SimpleNamespace(local=local, count=3), bar)
    # a local worker writes them there itself
    assert found['energy'].tolist() == ([0.0] * 6 if local else [0.0, 1.0, 2.0, 3.0, 7.0, 8.0])
    assert texts == {0: 'why', 4: 'why'}
    assert engine.rates == [None, 8.0, pytest.approx(2e9, rel=1e-12, abs=0.0)]
    assert engine.limits == [most] and engine.patience == ([] if local else [0.0])
    assert (bar.done, bar.said, bar.failed) == ([4, 2], '2 failed', 2)


@pytest.mark.parametrize(('free', 'refused'), [(1000.0, False), (48.0, True)])
def test_results_take_a_share_of_the_free_memory(free, refused, engine, monkeypatch):
    monkeypatch.setattr(module, 'free_memory', lambda: free / module.SHARE - 1e-9)
    monkeypatch.setattr(module, 'room', lambda plan, size: ({}, None))
    monkeypatch.setattr(module.stores, 'in_memory', lambda *_: 'a Dataset')
    workers = types.SimpleNamespace(local=True, count=1)
    if refused:
        with pytest.raises(BadInput, match=r'the results of 6 runs need 4\.8e-08 GB'):
            module._to_memory(plan_of(), workers, Bar())
    else:
        assert module._to_memory(plan_of(), workers, Bar()) == 'a Dataset'


@pytest.mark.parametrize(('failure', 'said'), [
    (KeyboardInterrupt(), '7 of 9 blocks are in here; the same sweep goes on from there'),
    (Stopped('gone'), 'gone: 7 of 9 blocks are in here; the same sweep goes on from there')])
def test_a_sweep_that_ends_early_tells_which_blocks_there_are(failure, said, engine):
    """Of 9 blocks 5 were there; of the other ones two are written."""
    engine.failure, marked = failure, []
    engine.outcomes = [outcome(0, 4, number=6), outcome(4, 8, number=8)]
    workers = types.SimpleNamespace(local=True, count=3)
    store, layout = types.SimpleNamespace(mark=marked.append, path='here'), types.SimpleNamespace(
        blocks=9)
    bar = Bar()
    with pytest.raises(type(failure)) as raised:
        module._fill(plan_of(), workers, store, layout, [5, 6, 7, 8], bar)
    assert str(raised.value) == said
    assert (marked, bar.done, engine.limits) == ([6, 8], [4, 4], [6])
    assert engine.pieces == [5, 6, 7, 8]


def test_a_forecast_shares_the_runs_among_the_workers(engine, monkeypatch):
    monkeypatch.setattr(module, 'prepared', lambda spec: plan_of(size=100))
    monkeypatch.setattr(module.engine, 'Workers', lambda executor: types.SimpleNamespace(count=5))
    assert module.forecast('a spec') == module.Forecast(100, 5, 5.0, 800)
    assert engine.patience == [0.5]


class Store:
    """Stands for a store of nine blocks of two runs, of which the third and the last are lacked.

    It notes what it is asked for.
    """

    def __init__(self, there, failure=None):
        self.asked, self._failure = [], failure
        self.path = types.SimpleNamespace(exists=lambda: there)

    def make(self, plan, runs):
        self.asked.append(runs)
        if self._failure:
            raise self._failure
        return types.SimpleNamespace(runs=lambda block: (2 * block, 2 * block + 2))

    def alone(self):
        return contextlib.nullcontext()

    def done(self, layout):
        return np.arange(9) % 6 != 2

    def finish(self):
        self.asked.append('finish')

    def dataset(self, plan):
        return 'a Dataset'


@pytest.mark.parametrize(('there', 'runs'), [(True, 1), (False, 75)])
def test_blocks_that_a_store_lacks_are_run(there, runs, engine, monkeypatch):
    """The size of blocks is chosen for a store that is not yet there."""
    filled, bar, store = [], Bar(), Store(there)
    monkeypatch.setattr(module, '_fill', lambda *of: filled.append(of[4]))
    monkeypatch.setattr(module.engine, 'block_runs', lambda plan, seconds, count: int(
        100 * seconds * count))
    workers = types.SimpleNamespace(count=3)
    assert module._to_store(plan_of(size=18), workers, store, bar) == 'a Dataset'
    assert (filled, bar.done, store.asked) == ([[2, 8]], [14], [runs, 'finish'])
    store = Store(True, OSError(28, 'No space left on device'))
    with pytest.raises(Stopped, match=r'the disk refuses \(No space left on device\); make'):
        module._to_store(plan_of(size=18), workers, store, bar)


def test_a_task_names_the_store_by_its_whole_path(monkeypatch):
    monkeypatch.chdir('/')
    monkeypatch.setattr(module.stores, 'versions', lambda: 'versions')
    assert module._task(plan_of()).store == ''
    found = module._task(plan_of(), types.SimpleNamespace(path='a/../b'), 'a layout')
    assert (found.store, found.layout) == ('/b', 'a layout')


@pytest.mark.parametrize('progress', [True, False])
@pytest.mark.parametrize('store', [None, 'a store'])
def test_a_sweep_goes_to_memory_or_to_a_store_beneath_its_bar(store, progress, monkeypatch):
    shown = []
    monkeypatch.setattr(module, 'tqdm', lambda **asked: shown.append(
        asked) or contextlib.nullcontext('bar'))
    plan = plan_of(size=18)
    plan.template = types.SimpleNamespace(name='top')
    monkeypatch.setattr(module, 'prepared', lambda spec: plan)
    monkeypatch.setattr(module.engine, 'Workers', lambda executor: 'workers')
    monkeypatch.setattr(module.stores, 'store_at', lambda path: f'the one at {path}')
    monkeypatch.setattr(module, '_to_memory', lambda *of: ('memory', of[1:]))
    monkeypatch.setattr(module, '_to_store', lambda *of: ('store', of[1:]))
    assert module.sweep('a spec', store=store, progress=progress) == (
        ('memory', ('workers', 'bar')) if store is None
        else ('store', ('workers', 'the one at a store', 'bar')))
    assert (shown[0]['total'], shown[0]['disable'], shown[0]['desc']) == (18, not progress, 'top')
