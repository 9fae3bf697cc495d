# SPDX-License-Identifier: Apache-2.0
"""The division of a grid of runs into blocks, each of which is a shard of a store."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Layout:
    """Blocks of runs that follow each other and are a box of the grid too.

    A block has one place along the dimensions before `along`, a range of places along it, and all
    places along those after it.

    Attributes
    ----------
    shape : tuple of int
        Shape of the grid of runs.
    along : int
    chunk : int
        Places along that dimension which are read at once.
    chunks : int
        Chunks of a block.
    """

    shape: tuple
    along: int
    chunk: int
    chunks: int

    @classmethod
    def of(cls, shape, block_runs, chunk_runs):
        """Return the Layout with blocks and chunks of about so many runs, at most."""
        along, behind = 0, math.prod(shape[1:])
        while behind > block_runs and along < len(shape) - 1:
            along += 1
            behind = math.prod(shape[along + 1:])
        places = shape[along]
        wide = min(places, max(1, block_runs // behind))
        # blocks of about the same width: none is a small rest
        wide = -(-places // -(-places // wide))
        chunks = min(wide, -(-wide * behind // max(1, chunk_runs)))
        return cls(tuple(shape), along, -(-wide // chunks), chunks)

    @property
    def wide(self):
        """The number of places of a block along the dimension that is cut."""
        return self.chunk * self.chunks

    @property
    def behind(self):
        """The number of runs of one place along the dimension that is cut."""
        return math.prod(self.shape[self.along + 1:])

    @property
    def in_a_row(self):
        """The number of blocks along the dimension that is cut."""
        return -(-self.shape[self.along] // self.wide)

    @property
    def blocks(self):
        """The number of blocks."""
        return math.prod(self.shape[:self.along]) * self.in_a_row

    @property
    def shard_shape(self):
        """The shape of a block."""
        return (1,) * self.along + (self.wide, *self.shape[self.along + 1:])

    @property
    def chunk_shape(self):
        """The shape of a chunk."""
        return (1,) * self.along + (self.chunk, *self.shape[self.along + 1:])

    def runs(self, block):
        """Return (first, stop): the runs of a block."""
        row, place = divmod(block, self.in_a_row)
        begin = row * self.shape[self.along]
        first = begin + place * self.wide
        return first * self.behind, min(first + self.wide, begin + self.shape[self.along]) \
            * self.behind

    def box(self, block):
        """Return the slices of a block in the grid."""
        row, place = divmod(block, self.in_a_row)
        before = []
        for size in reversed(self.shape[:self.along]):
            row, k = divmod(row, size)
            before.append(slice(k, k + 1))
        first = place * self.wide
        return (*reversed(before), slice(first, min(first + self.wide, self.shape[self.along])),
                *(slice(0, size) for size in self.shape[self.along + 1:]))
