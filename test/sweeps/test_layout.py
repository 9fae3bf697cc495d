# SPDX-License-Identifier: Apache-2.0
"""Blocks are boxes of the grid, whole shards, and together all runs once."""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as some

from rigid_body_sim.sweeps.layout import Layout


@settings(deadline=None)
@given(some.lists(some.integers(1, 9), min_size=1, max_size=4), some.integers(1, 200),
       some.integers(1, 50))
def test_blocks_cover_the_grid_once(shape, block_runs, chunk_runs):
    layout = Layout.of(tuple(shape), block_runs, chunk_runs)
    grid = np.arange(math.prod(shape)).reshape(shape)
    seen = []
    for block in range(layout.blocks):
        first, stop = layout.runs(block)
        box = grid[layout.box(block)]
        assert box.ravel().tolist() == list(range(first, stop))
        # the box begins with a shard and lies within it
        for part, size in zip(layout.box(block), layout.shard_shape, strict=True):
            assert part.start % size == 0 and part.stop - part.start <= size
        seen += range(first, stop)
    assert seen == list(range(math.prod(shape)))
    assert all(shard % chunk == 0 for shard, chunk in
               zip(layout.shard_shape, layout.chunk_shape, strict=True))


def test_a_block_of_less_than_two_places_has_one():
    assert Layout.of((9, 5), 7, 7).runs(0) == (0, 5)
    assert Layout.of((9, 5), 10, 10).runs(0) == (0, 10)


def test_blocks_have_about_the_size_asked():
    for shape in ((10**6, 3), (3, 10**6), (1000, 1001), (7, 11, 13, 17)):
        layout = Layout.of(shape, 1000, 100)
        sizes = [stop - first for first, stop in map(layout.runs, range(min(layout.blocks, 50)))]
        assert 300 <= max(sizes) <= 1100, shape
        assert max(sizes) <= 2 * min(sizes), shape
