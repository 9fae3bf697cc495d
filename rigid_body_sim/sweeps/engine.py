# SPDX-License-Identifier: Apache-2.0
"""The engine of a sweep: it hands pieces of work to an executor and collects the outcomes.

Which piece runs where and when has no influence on any bit of the result.
"""

import concurrent.futures
import contextlib
import functools
import itertools
import math
import os
import time

from rigid_body_sim.errors import BadInput
from rigid_body_sim.sweeps.runs import compute

BLOCK_BYTES = 2**25
"""Largest size of the results of a block, where it has more than one run."""
SECONDS = 1.0
"""Work in a block that goes to another process or into a store, s."""
SECONDS_TO_LEAD = 0.005
"""Cost of a block for the leading process and the scheduler, s: blocks are longer if many workers
would make it the limit."""
BLOCKS = 8
"""Blocks of a store for each worker, if there is enough work: the last one to finish is short."""
PIECES = 4
"""Pieces of a result in memory for each worker: there no other process waits for a block."""
ENOUGH_QUICK = 24_576
"""Least number of runs in a piece, for single states in closed form: some 10 ms of work."""
FIRST_PIECE, FIRST_QUICK = 16, 2**15
"""Runs of the first pieces, which show how long runs take: of any kind, and of single states in
closed form."""
PATIENCE = 5.0
"""Time between two checks of the workers, s."""
LOOK = 0.2    # time within which a forecast is measured, s


class Stopped(RuntimeError):
    """The workers are gone, or the disk refuses; finished blocks are in the store."""


def cores():
    """Return how many processors this process may use."""
    return len(os.sched_getaffinity(0))


@functools.cache
def _threads():
    """Return the threads of this process: they keep their memory from one sweep to the next."""
    return concurrent.futures.ThreadPoolExecutor(cores(), 'sweep')


# a child of fork has no threads but the one that forked
os.register_at_fork(after_in_child=_threads.cache_clear)


class Workers:
    """The executor of the work, or a client of Dask.

    Parameters
    ----------
    executor : concurrent.futures.Executor, distributed.Client or None
        By default threads of this process.
    """

    def __init__(self, executor):
        self.local = executor is None
        self._client = executor if hasattr(executor, 'get_executor') else None
        if executor is not None and self._client is None and \
                not isinstance(executor, concurrent.futures.Executor):
            raise BadInput('executor', f'got {type(executor).__name__}',
                           'a concurrent.futures.Executor or a distributed.Client')
        if self._client is not None:
            self._executor = executor.get_executor(pure=False)
        else:
            self._executor = executor or _threads()
        self._looked, self._count = -math.inf, 0

    def submit(self, function, *arguments):
        """Return the Future of a call; raises Stopped where the executor takes no more."""
        try:
            return self._executor.submit(function, *arguments)
        except (RuntimeError, OSError) as error:
            raise Stopped(f'the workers are gone ({_brief(error)})') from error

    @property
    def count(self):
        """Number of blocks that can run at the same time, as far as is known."""
        if time.monotonic() - self._looked > PATIENCE:
            self._looked = time.monotonic()
            if self._client is not None:
                self._count = sum(self._client.ncores().values())
            else:
                self._count = getattr(self._executor, '_max_workers', None) or cores()
        return max(1, self._count)

    def check(self):
        """Raise Stopped where the scheduler of Dask is gone."""
        if self._client is not None and self._client.status not in ('running', 'newly-created'):
            raise Stopped('the Dask scheduler is gone')


def _brief(error):
    return ' '.join(f'{type(error).__name__}: {error}'.split())[:200]


def run(workers, pieces, submit, take, window):
    """Run pieces of work; return when all are done.

    Parameters
    ----------
    workers : Workers
    pieces : iterator
        Arguments of `submit`; each is taken as late as possible.
    submit : callable
        (workers, piece) -> Future.
    take : callable
        Called with the Outcome of each.
    window : callable
        () -> the number of pieces that may wait or run.

    Raises
    ------
    Stopped, BadInput, KeyboardInterrupt
        Running pieces are waited for and taken first, so that none is lost.
    """
    pending, finished = set(), set()
    try:
        while True:
            for piece in itertools.islice(pieces, max(0, window() - len(pending))):
                pending.add(submit(workers, piece))
            if not pending:
                return
            finished, pending = concurrent.futures.wait(
                pending, PATIENCE, concurrent.futures.FIRST_COMPLETED)
            if not finished:
                workers.check()
            while finished:
                take(_result(finished.pop()))
    except BaseException:
        for future in pending:
            future.cancel()
        # a second Ctrl-C ends this wait
        more, _ = concurrent.futures.wait(pending, 30.0)
        for future in finished | more:
            if not future.cancelled() and future.exception() is None:
                with contextlib.suppress(OSError):
                    take(future.result())
        raise


def _result(future):
    """Return the result of a Future; errors that the user can mend become one line."""
    try:
        return future.result()
    except BadInput:
        raise
    except ImportError as error:
        raise BadInput('worker', f'cannot import what it needs ({error})',
                       'install this version of rigid_body_sim on all workers') from error
    except concurrent.futures.CancelledError as error:
        raise Stopped('the workers or their scheduler are gone') from error
    except concurrent.futures.BrokenExecutor as error:
        raise Stopped(f'the workers are gone ({_brief(error)})') from error
    except OSError as error:
        if error.strerror is None:
            raise Stopped(f'the workers are gone ({_brief(error)})') from error
        raise Stopped(f'the disk refuses ({error.strerror})') from error
    except Exception as error:
        if type(error).__name__ in ('KilledWorker', 'FutureCancelledError'):
            raise Stopped(f'the workers are gone ({_brief(error)})') from error
        raise


def seconds_a_run(plan, patience=LOOK):
    """Return the time of a run on one core, s, measured on some runs from the middle.

    Kernels are compiled on the way, so that workers on this machine find them.
    """
    size = plan.spec.size
    for first in {min(plan.template_run, size - 1), (size - 1) // 2}:
        compute(plan, first, first + 1)
    spent, count = 0.0, 1
    most = max(1, min(size, BLOCK_BYTES // plan.bytes))
    while True:
        first = (size - count) // 2
        begin = time.perf_counter()
        compute(plan, first, first + count)
        took = time.perf_counter() - begin
        spent += took
        if count >= most or spent + 4.0 * took > patience:
            return took / count
        count = min(most, 4 * count)


def block_runs(plan, seconds, workers):
    """Return how many runs a block of a store has, where a run takes `seconds`."""
    whole = seconds * plan.spec.size
    target = min(max(SECONDS, SECONDS_TO_LEAD * workers), max(0.05, whole / (BLOCKS * workers)))
    return max(1, min(int(target / seconds), BLOCK_BYTES // plan.bytes))


def pieces_in_memory(plan, workers, rate):
    """Yield (first, stop, number) of pieces for a result in memory.

    Parameters
    ----------
    plan : Plan
    workers : Workers
    rate : callable
        () -> runs per second of a worker, None while unknown.
    """
    size, first = plan.spec.size, 0
    unknown = FIRST_QUICK if plan.is_quick else FIRST_PIECE
    most = max(1, BLOCK_BYTES // plan.bytes)
    for number in itertools.count():
        if first >= size:
            return
        known = rate()
        count = unknown if known is None else int(known * SECONDS)
        pieces = min(PIECES, max(1, size // (ENOUGH_QUICK * workers.count))) if plan.is_quick \
            else PIECES
        fair = -(-size // (pieces * workers.count))
        stop = min(size, first + max(1, min(count, fair, most)))
        yield first, stop, number
        first = stop
