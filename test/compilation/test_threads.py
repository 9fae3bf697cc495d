# SPDX-License-Identifier: Apache-2.0
"""Work shared among cores: every item once, slices that suit the clock, and what fails is told."""

import concurrent.futures
import os
import threading
import types

import pytest

from rigid_body_sim.compilation import threads

pytestmark = pytest.mark.without_numba


class AtOnce:
    """Stands for the pool of threads: what is submitted runs before the caller goes on."""

    def __init__(self):
        self.submitted = 0

    def submit(self, work):
        self.submitted += 1
        future = concurrent.futures.Future()
        future.set_running_or_notify_cancel()
        try:
            future.set_result(work())
        except BaseException as error:
            future.set_exception(error)
        return future


class TooBusy(AtOnce):
    """A pool that has no thread free before the caller has done all."""

    def submit(self, work):
        self.submitted += 1
        return concurrent.futures.Future()


@pytest.fixture
def three_cores(monkeypatch):
    """Return a function that puts a pool in place; nothing is known of this thread yet."""
    def put(pool):
        monkeypatch.setattr(threads, '_pool', lambda: pool)
        return pool
    monkeypatch.setattr(os, 'cpu_count', lambda: 3)
    monkeypatch.setattr(threads, '_mine', threading.local())
    return put


@pytest.mark.parametrize('kind', [AtOnce, TooBusy])
@pytest.mark.parametrize(('count', 'least', 'size'), [
    # eight slices for each of three cores, or as many items in each as there have to be
    (24, None, 1), (24, 1, 1), (25, 1, 2), (240, 1, 10), (241, 1, 11), (240, 30, 30),
    (31, 30, 30)])
def test_slices_are_as_large_as_is_asked_and_each_item_comes_once(
        three_cores, kind, count, least, size):
    pool, seen = three_cores(kind()), []
    threads.on_all_cores(seen.append, count, *([] if least is None else [least]))
    assert seen == [slice(k, min(k + size, count)) for k in range(0, count, size)]
    assert pool.submitted == 2    # the third core is the caller's


@pytest.mark.parametrize(('count', 'least'), [(0, 1), (1, 1), (5, 5), (5, 6)])
def test_what_is_one_slice_is_for_the_caller(three_cores, count, least):
    pool, seen = three_cores(TooBusy()), []
    threads.on_all_cores(seen.append, count, least)
    assert seen == [slice(0, count)] * (count > 0)
    assert pool.submitted == 0


def test_work_is_for_one_core_only_as_long_as_that_is_said(three_cores):
    pool, seen = three_cores(TooBusy()), []
    with threads.one_core():
        with threads.one_core():
            threads.on_all_cores(seen.append, 100)
        threads.on_all_cores(seen.append, 100)
        threads.on_all_cores(seen.append, 0)
    assert seen == [slice(0, 100)] * 2 and pool.submitted == 0
    threads.on_all_cores(seen.append, 100)
    assert pool.submitted == 2


def test_what_fails_on_another_core_ends_the_work_and_is_told(three_cores):
    three_cores(AtOnce())
    seen = []

    def work(part):
        seen.append(part.start)
        if part.start == 10:
            raise ValueError('the third slice')
    with pytest.raises(ValueError, match='the third slice'):
        threads.on_all_cores(work, 100)    # slices of five
    assert seen == [0, 5, 10]
    threads.look()    # that work is over: nothing is to be abandoned


def sizes(monkeypatch, size, durations, most=None):
    """Return the sizes of calls that take so long, of which the last says that all is done."""
    asked, now = [], [0.0]

    def work(size):
        now[0] += durations[len(asked)]
        asked.append(size)
        return len(asked) == len(durations)
    monkeypatch.setattr(threads, 'time', types.SimpleNamespace(perf_counter=lambda: now[0]))
    monkeypatch.setattr(threads, 'SLICE', 0.25)
    threads.in_slices(work, size, most)
    return asked


@pytest.mark.parametrize(('size', 'durations', 'expected'), [
    (4, [0.125, 0.125, 0.0], [4, 8, 16]), (4, [0.25, 0.5, 0.0], [4, 4, 4]),
    (6, [0.75, 0.75, 0.75, 0.0], [6, 3, 1, 1]), (4, [9.0], [4])])
def test_a_slice_takes_between_one_and_two_times_what_it_should(
        monkeypatch, size, durations, expected):
    """Shorter ones grow twofold; longer ones are halved."""
    assert sizes(monkeypatch, size, durations) == expected


def test_a_slice_is_no_larger_than_what_is_left(monkeypatch):
    left = [100, 9, 5]
    assert sizes(monkeypatch, 8, [0.0, 0.0, 0.0], lambda: left.pop(0)) == [8, 9, 5]


def test_a_process_has_one_pool_and_its_child_one_of_its_own(monkeypatch):
    monkeypatch.setattr(threads, '_threads', types.SimpleNamespace(process=None, pool=None))
    first = threads._pool()
    assert threads._pool() is first
    monkeypatch.setattr(os, 'getpid', lambda: -1)
    other = threads._pool()
    assert other is not first and threads._pool() is other
