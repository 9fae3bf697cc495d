# SPDX-License-Identifier: Apache-2.0
"""Work shared among all cores; it scales because kernels release the interpreter lock."""

import concurrent.futures
import contextlib
import os
import threading

PARTS = 8    # for each core: the last one to finish is short then
_THREAD = threading.local()


@contextlib.contextmanager
def one_core():
    """Let the calling thread do all work by itself, where others keep the other cores busy."""
    before = getattr(_THREAD, 'alone', False)
    _THREAD.alone = True
    try:
        yield
    finally:
        _THREAD.alone = before


def on_all_cores(work, count, least=1):
    """Call work(slice) on all cores until all of `count` items are done.

    Within :func:`one_core` no thread is started.

    Parameters
    ----------
    work : function (slice)
    count : int
    least : int
        Smallest number of items in a slice, but for the last one.
    """
    if getattr(_THREAD, 'alone', False):
        if count:
            work(slice(0, count))
        return
    chunk = max(1, least, -(-count // (PARTS * os.cpu_count())))
    parts = iter([slice(first, min(first + chunk, count)) for first in range(0, count, chunk)])

    def take():
        for part in parts:
            work(part)
    if count <= chunk:
        take()
        return
    # the calling thread takes its share: starting one more costs as much as a hundred tops in
    # closed form
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as threads:
        others = [threads.submit(take) for _ in range(os.cpu_count() - 1)]
        take()
        for other in others:
            other.result()
