# SPDX-License-Identifier: Apache-2.0
"""The findings of a scan of an MCAP file: chunks, whole places, and damage (scan.py).

Why not the records of `mcap`: they do not say where in a file they lie, nor what of it is damaged.
"""

import dataclasses

import numpy as np
from mcap.records import ChunkIndex

from rigid_body_sim.recording.mcap.contents import Contents
from rigid_body_sim.recording.mcap.records import HEAD
from rigid_body_sim.recording.mcap.walk import heads, walk


class FoundChunk:
    """A whole chunk, its place in the file, its messages, and the message indexes after it.

    Attributes
    ----------
    offset, end : int
        Where its record begins and ends in the file.
    heads : structured array
        One element per message, see :data:`rigid_body_sim.recording.mcap.walk.HEADS`.
    offsets : array
        One element per message.
    others : list
        See :func:`rigid_body_sim.recording.mcap.walk.walk`.
    counts : dict
        Channel number -> messages.
    index_places : dict
        Channel number -> position of its message index in the file.
    index_length : int
        Bytes of these indexes.
    index_wrong : bool
        Whether one of these is not the index of these messages.
    """

    def __init__(self, chunk, offset, length, records):
        self._chunk, self.offset, self.end = chunk, offset, offset + length
        offsets, self.others = walk(records)
        self.heads, self.offsets = heads(records, offsets), offsets.astype(np.uint64)
        numbers, counts = np.unique(self.heads['channel'], return_counts=True)
        self.counts = dict(zip(numbers.tolist(), counts.tolist(), strict=True))
        self.index_places, self.index_length, self.index_wrong = {}, 0, False

    @property
    def times(self):
        """Log times of the messages, ns."""
        return self.heads['log_time']

    def takes_index(self, offset, content):
        """Note the message index with this content, if it is one of these messages."""
        number = int.from_bytes(content[:2], 'little')
        pairs = np.frombuffer(content, '<u8', offset=6).reshape(-1, 2)
        mine = self.heads['channel'] == number
        own = np.stack((self.times[mine], self.offsets[mine]), axis=1)
        good = number not in self.index_places and pairs.shape == own.shape and (
            (pairs == own).all()
            or (pairs[np.argsort(pairs[:, 1], kind='stable')] == own).all())
        if good:
            self.index_places[number] = offset
        else:
            self.index_wrong = True
        self.index_length += len(content) + HEAD.size

    def index(self):
        """Return its ChunkIndex."""
        chunk = self._chunk
        return ChunkIndex(self.end - self.offset, self.offset, chunk.compression,
                          len(chunk.data), chunk.message_end_time, self.index_length,
                          self.index_places, chunk.message_start_time, chunk.uncompressed_size)


@dataclasses.dataclass
class Whole:
    """Bytes of a file that are kept as they are, and what they hold."""

    begin: int
    end: int
    contents: Contents = dataclasses.field(default_factory=Contents)


@dataclasses.dataclass
class Unindexed:
    """A whole chunk among the bytes before, whose message indexes are to be made anew."""

    offset: int


@dataclasses.dataclass
class Broken:
    """A damaged chunk to be rescued, see :func:`rigid_body_sim.recording.mcap.rescue.rescue`."""

    offset: int
    hint: ChunkIndex
    cut: bool


@dataclasses.dataclass
class Loose:
    """Message records that were found in what is left of a chunk, to be written as one."""

    begin: int
    end: int


@dataclasses.dataclass
class Replaced:
    """A record in place of one with a wrong head."""

    data: bytes


@dataclasses.dataclass
class Damage:
    """A stretch of a file that is not whole.

    Attributes
    ----------
    lost_bytes : int
        Bytes of which nothing was kept.
    kept, doubtful : int
        Messages that were kept of it, and those among them that no checksum vouches for though
        there is one.
    lost : int or None
        Messages that are missing, where the file tells exactly.
    claimed : int
        Bytes of messages that are missing, by what the damaged chunk claims; 0 if nothing does.
    until : int
        Log time of the last message that the damaged chunk claims, ns; 0 if nothing tells.
    before, after : FoundChunk or None
        The last whole chunk before and the first after it.
    """

    lost_bytes: int
    kept: int = 0
    doubtful: int = 0
    lost: int = None
    claimed: int = 0
    until: int = 0
    before: FoundChunk = None
    after: FoundChunk = None
