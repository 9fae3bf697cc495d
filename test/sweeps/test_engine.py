# SPDX-License-Identifier: Apache-2.0
"""Pieces go to an executor as it has room, and no outcome is lost, however a sweep ends."""

import concurrent.futures
import errno
import time
import types

import pytest

from rigid_body_sim.errors import BadInput
from rigid_body_sim.sweeps import engine
from rigid_body_sim.sweeps.engine import Stopped, Workers


class Client:
    """What a sweep asks of a client of Dask."""

    def __init__(self, ncores, status='running'):
        self._ncores, self.status = ncores, status

    def get_executor(self, pure):
        assert pure is False    # a call that is made again is run again
        return 'executor'

    def ncores(self):
        return self._ncores


@pytest.mark.parametrize(('executor', 'count'), [
    (None, engine.cores()), (concurrent.futures.ThreadPoolExecutor(3), 3),
    (Client({'a': 2, 'b': 3}), 5), (Client({}), 1),
    (concurrent.futures.Executor(), engine.cores())])
def test_as_many_blocks_run_as_there_are_workers(executor, count):
    workers = Workers(executor)
    assert workers.count == count
    assert workers.local == (executor is None)


def test_workers_that_come_and_go_are_counted_now_and_then(monkeypatch):
    clock, client = [100.0], Client({'a': 2})
    monkeypatch.setattr(engine, 'time', types.SimpleNamespace(monotonic=lambda: clock[0]))
    workers = Workers(client)
    assert workers.count == 2
    client.ncores()['b'] = 4
    clock[0] += engine.PATIENCE
    assert workers.count == 2
    clock[0] += 0.5
    assert workers.count == 6


@pytest.mark.parametrize('wrong', [3, 'threads', object()])
def test_what_is_no_executor_is_refused(wrong):
    with pytest.raises(BadInput, match=r'executor: got .*; a concurrent\.futures\.Executor or'):
        Workers(wrong)


@pytest.mark.parametrize(('status', 'gone'), [
    ('running', False), ('newly-created', False), ('closed', True), ('connecting', True)])
def test_a_scheduler_that_is_gone_stops_the_sweep(status, gone):
    workers = Workers(Client({}, status))
    if gone:
        with pytest.raises(Stopped, match='the Dask scheduler is gone'):
            workers.check()
    else:
        workers.check()
    Workers(None).check()


def test_an_executor_that_takes_no_more_stops_the_sweep():
    with concurrent.futures.ThreadPoolExecutor(1) as executor:
        workers = Workers(executor)
        assert workers.submit(pow, 2, 5).result() == 32
    with pytest.raises(Stopped, match=r'the workers are gone \(RuntimeError: cannot schedule'):
        workers.submit(pow, 2, 5)


class KilledWorker(Exception):
    """As Dask's, which is told by its name."""


@pytest.mark.parametrize(('error', 'becomes', 'said'), [
    (BadInput('a', 'b', 'c'), BadInput, 'a: b; c'),
    (ImportError('no numpy'), BadInput, r'worker: cannot import what it needs \(no numpy\)'),
    (concurrent.futures.CancelledError(), Stopped, 'the workers or their scheduler are gone'),
    (concurrent.futures.BrokenExecutor('x'), Stopped, r'are gone \(BrokenExecutor: x\)'),
    (OSError('lost\nit'), Stopped, r'the workers are gone \(OSError: lost it\)'),
    (OSError(errno.ENOSPC, 'No space'), Stopped, r'the disk refuses \(No space\)'),
    (KilledWorker('w'), Stopped, r'the workers are gone \(KilledWorker: w\)'),
    (ZeroDivisionError('mine'), ZeroDivisionError, 'mine')])
def test_errors_that_a_user_can_mend_are_one_line(error, becomes, said):
    future = concurrent.futures.Future()
    future.set_exception(error)
    with pytest.raises(becomes, match=said) as told:
        engine._result(future)
    assert '\n' not in str(told.value)


def test_what_an_error_says_is_cut():
    told = engine._brief(ValueError('x' * 300))
    assert told == 'ValueError: ' + 'x' * 188 and len(told) == 200


def started(count, window, fail_at=None, error=None):
    """Run pieces in threads; return (taken, most that waited at a time, the error)."""
    taken, waiting, most = [], set(), [0]
    with concurrent.futures.ThreadPoolExecutor(2) as threads:
        def submit(_, piece):
            future = threads.submit(work, piece)
            waiting.add(piece)
            most[0] = max(most[0], len(waiting))
            return future

        def work(piece):
            if piece == fail_at:
                raise error
            time.sleep(0.002)
            return piece

        def take(piece):
            waiting.discard(piece)
            taken.append(piece)
        try:
            engine.run(Workers(None), iter(range(count)), submit, take, lambda: window)
        except type(error) as found:
            return taken, most[0], found
    return taken, most[0], None


@pytest.mark.parametrize('window', [1, 3, 100])
def test_all_pieces_run_and_no_more_wait_than_may(window):
    taken, most, _ = started(20, window)
    assert sorted(taken) == list(range(20))
    assert most == min(window, 20)


def test_pieces_that_run_are_taken_before_an_error_is_raised():
    taken, _, found = started(20, 4, 6, BadInput('a', 'b', 'c'))
    assert isinstance(found, BadInput)
    assert set(range(6)) <= set(taken) <= set(range(20)) - {6}


def test_pieces_that_end_together_with_one_that_fails_are_taken():
    """Also those that the executor reports in the same breath, in whatever order."""
    def submit(_, piece):
        future = concurrent.futures.Future()
        if piece == 5:
            future.set_exception(BadInput('a', 'b', 'c'))
        elif piece == 6:
            future.cancel()
            future.set_running_or_notify_cancel()
        else:
            future.set_result(piece)
        return future
    taken = []
    with pytest.raises((BadInput, Stopped)):
        engine.run(Workers(None), iter(range(12)), submit, taken.append, lambda: 12)
    assert sorted(taken) == [0, 1, 2, 3, 4, 7, 8, 9, 10, 11]


def test_workers_are_looked_at_when_nothing_ends_for_long(monkeypatch):
    monkeypatch.setattr(engine, 'PATIENCE', 1e-3)
    workers = Workers(Client({}, 'closed'))
    future = concurrent.futures.Future()
    monkeypatch.setattr(workers, 'check', lambda: (future.set_result(7), Workers.check(workers)))
    taken = []
    with pytest.raises(Stopped, match='the Dask scheduler is gone'):
        engine.run(workers, iter([1]), lambda *_: future, taken.append, lambda: 1)
    assert taken == [7]    # it ended while they were looked at


def test_the_processors_of_this_process_are_counted(monkeypatch):
    monkeypatch.setattr(engine.os, 'sched_getaffinity', lambda process: {0: {4, 5, 7}}[process])
    assert engine.cores() == 3


def test_a_window_that_shrinks_waits(monkeypatch):
    """Workers that went: what they have is waited for, and nothing is added."""
    futures, added, windows = [], [], iter([3, 1, 1, 1, 1, 1, 1])

    def submit(_, piece):
        added.append(piece)
        futures.append(concurrent.futures.Future())
        return futures[-1]

    def wait(pending, patience, when):
        done = futures.pop(0)
        done.set_result(1)
        return {done}, set(pending) - {done}
    monkeypatch.setattr(engine.concurrent.futures, 'wait', wait)
    seen = []
    engine.run(Workers(None), iter(range(5)), submit, lambda _: seen.append(list(added)),
               lambda: next(windows))
    assert seen == [[0, 1, 2], [0, 1, 2], [0, 1, 2], [0, 1, 2, 3], [0, 1, 2, 3, 4]]
