"""Work shared out to all cores: kernels hold no interpreter lock."""

import concurrent.futures
import os

PARTS = 8    # for each core: the last one to finish is short then


def on_all_cores(work, count, least=1):
    """Call work(slice) until all of `count` things are done, at least so many at a time where there are as many."""
    chunk = max(1, least, -(-count // (PARTS * os.cpu_count())))
    parts = iter([slice(first, min(first + chunk, count)) for first in range(0, count, chunk)])

    def take():
        for part in parts:
            work(part)
    if count <= chunk:
        take()
        return
    # the calling thread does its share: to start another costs as much as a hundred tops in closed form
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as threads:
        others = [threads.submit(take) for _ in range(os.cpu_count() - 1)]
        take()
        for other in others:
            other.result()
