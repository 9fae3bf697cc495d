# SPDX-License-Identifier: Apache-2.0
"""Work shared among all cores, and work in slices: kernels release the interpreter lock.

Python handles a signal between two of its own operations, not inside a kernel. So long work is a
loop in Python over calls of short kernels. Work that other threads share calls `look` between
these: only the calling thread receives the signal.
"""

import concurrent.futures
import contextlib
import os
import threading
import time
import types

PARTS = 8    # slices for each core, so that the last one to finish is short
SLICE = 0.05    # time that the call of a kernel should take, s
_mine = threading.local()
_threads = types.SimpleNamespace(process=None, pool=None)


class Abandoned(Exception):
    """Another thread of the same work has failed or was interrupted."""


@contextlib.contextmanager
def one_core():
    """Do all work in the calling thread, while other threads keep the other cores busy."""
    before = getattr(_mine, 'alone', False)
    _mine.alone = True
    try:
        yield
    finally:
        _mine.alone = before


def look():
    """Raise Abandoned in a thread of `on_all_cores` whose work is no longer wanted."""
    if getattr(_mine, 'stop', None) is not None and _mine.stop.is_set():
        raise Abandoned


def in_slices(work, size, most=None):
    """Call work(size), with growing sizes while it is quick, until it returns True.

    The sizes depend on the clock; the results of `work` must not.

    Parameters
    ----------
    work : callable
    size : int
        Size of the first call.
    most : callable, optional
        Returns the largest size of the next call.
    """
    while True:
        look()
        began = time.perf_counter()
        if work(size if most is None else min(size, most())):
            return
        spent = time.perf_counter() - began
        if spent < SLICE:
            size *= 2
        elif spent > 2.0 * SLICE:
            size = max(1, size // 2)


def on_all_cores(work, count, least=1):
    """Call work(slice) on all cores until all of `count` items are done.

    Within :func:`one_core` no thread is started. An exception in one thread, or an interrupt of
    the calling one, ends the work of the others at their next `look`.

    Parameters
    ----------
    work : function (slice)
    count : int
    least : int
        Smallest number of items in a slice, but for the last one.
    """
    if getattr(_mine, 'alone', False):
        if count:
            work(slice(0, count))
        return
    chunk = max(1, least, -(-count // (PARTS * os.cpu_count())))
    parts = iter([slice(first, min(first + chunk, count)) for first in range(0, count, chunk)])

    stop = threading.Event()

    def take():
        outer, _mine.stop = getattr(_mine, 'stop', None), stop
        try:
            for part in parts:
                look()
                work(part)
        except BaseException:
            stop.set()
            raise
        finally:
            _mine.stop = outer

    if count <= chunk:
        for part in parts:
            work(part)
        return
    # the calling thread does its share; when it has found no more, none is left for those that no
    # thread has taken up yet
    others = [_pool().submit(take) for _ in range(os.cpu_count() - 1)]
    try:
        take()
        _wait(others)
    except Abandoned:
        _wait(others)
    except BaseException:
        stop.set()
        _wait(others)
        raise
    for other in others:
        if not other.cancelled() and not isinstance(other.exception(), Abandoned):
            other.result()


def _wait(others):
    """Wait for those that have begun; the others are cancelled."""
    concurrent.futures.wait([other for other in others if not other.cancel()])


def _pool():
    """Return the threads of this process: starting them anew costs as much as 500 racket states.

    A process that was forked has none of them, and makes its own.
    """
    if _threads.process != os.getpid():
        _threads.process = os.getpid()
        _threads.pool = concurrent.futures.ThreadPoolExecutor(os.cpu_count(), 'kernels')
    return _threads.pool
