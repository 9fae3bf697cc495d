# SPDX-License-Identifier: Apache-2.0
"""Work shared among all cores; it scales because kernels release the interpreter lock."""

import concurrent.futures
import os

PARTS = 8    # parts for each core: the last one to finish is then short


def on_all_cores(work, count, least=1):
    """Call work(slice) on all cores until all of `count` items are done.

    Parameters
    ----------
    work : function (slice)
    count : int
    least : int
        Smallest number of items in a slice, but for the last one.
    """
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
