# SPDX-License-Identifier: Apache-2.0
"""What an MCAP file really holds, from its first byte on, whoever wrote it.

For files that are cut, damaged or without a summary. Why not `mcap.stream_reader.StreamReader`: it
does not say where a record begins, and it ends at the first one that is cut or damaged.
"""

import os

import numpy as np
from mcap.exceptions import InvalidMagic
from mcap.opcode import Opcode
from mcap.records import Chunk, ChunkIndex, Metadata
from mcap.writer import MCAP0_MAGIC

from rigid_body_sim.recording.mcap.compression import LARGEST_CHUNK, records_of
from rigid_body_sim.recording.mcap.contents import Contents
from rigid_body_sim.recording.mcap.records import (
    HEAD,
    Damaged,
    attachment_index,
    of_bytes,
)
from rigid_body_sim.recording.mcap.summary import place_of
from rigid_body_sim.recording.mcap.walk import HEADS, MESSAGE, heads, walk

LARGEST_RECORD = LARGEST_CHUNK + 2**16
_ATTACHMENT_START = 2**16       # bytes of an attachment that are read: its data is not needed
_AFTER_DATA = (Opcode.FOOTER, Opcode.CHUNK_INDEX, Opcode.ATTACHMENT_INDEX, Opcode.STATISTICS,
               Opcode.METADATA_INDEX, Opcode.SUMMARY_OFFSET, Opcode.DATA_END)


def check_magic(stream):
    """Read what an MCAP file begins with; InvalidMagic if another one does.

    A file that is cut in there counts as one.
    """
    magic = stream.read(len(MCAP0_MAGIC))
    if magic != MCAP0_MAGIC[:len(magic)]:
        raise InvalidMagic(magic)


class FoundChunk:
    """A whole chunk, its place in the file, its messages, and the message indexes behind it.

    Attributes
    ----------
    channels, times, offsets : arrays
        One element a message.
    others : list
        See :func:`rigid_body_sim.recording.mcap.walk.walk`.
    counts : dict
        Channel number -> messages.
    index_places : dict
        Channel number -> position of its message index in the file.
    index_length : int
        Bytes of these indexes.
    """

    def __init__(self, chunk, offset, length, records):
        self._chunk, self._offset, self._length = chunk, offset, length
        offsets, self.others = walk(records)
        message_heads = heads(records, offsets)
        self.channels, self.times = message_heads['channel'], message_heads['log_time']
        self.offsets = offsets.astype(np.uint64)
        numbers, counts = np.unique(self.channels, return_counts=True)
        self.counts = dict(zip(numbers.tolist(), counts.tolist(), strict=True))
        self.index_places, self.index_length = {}, 0

    def index(self):
        """Return its ChunkIndex."""
        chunk = self._chunk
        return ChunkIndex(self._length, self._offset, chunk.compression, len(chunk.data),
                          chunk.message_end_time, self.index_length, self.index_places,
                          chunk.message_start_time, chunk.uncompressed_size)


class Scan:
    """Everything found in a file, up to where it is cut.

    Attributes
    ----------
    contents : Contents
        All that is whole.
    places : list of ChunkPlace
        Of the chunks among the contents.
    end : int
        Where the data section ends: at its end record, or at the first byte that belongs to
        nothing whole. 0 if not even the head is whole.
    cut : bool
        True if no end record was found.
    last : FoundChunk or None
        The chunk at the very end, if the file is cut before all of its message indexes. Its index
        is not yet among the contents.
    lost_bytes : int
        What follows `end` in a cut file, unless it is part of a message index, which can be made
        again.
    cut_chunk : mcap.records.Chunk or None
        The chunk in which the file is cut, with what there is of its data.
    damaged : list of (offset, Chunk)
        Chunks that cannot be decompressed, or whose checksum is wrong; not among the contents.
    mean_message : float
        Mean size of a message in the chunks, record head included; 0.0 without chunks.

    Raises
    ------
    mcap.exceptions.InvalidMagic
        Where the file is no MCAP file.
    mcap.exceptions.UnsupportedCompressionError
        Where its chunks cannot be read here.
    """

    def __init__(self, stream):
        self._stream = stream
        self._size = os.fstat(stream.fileno()).st_size
        self.contents, self.places, self.damaged = Contents(), [], []
        self.end, self.cut, self.last, self.cut_chunk = 0, True, None, None
        self.lost_bytes = self._chunk_bytes = self._chunk_messages = 0
        self._channel_sets = {}
        check_magic(stream)
        while self._record():
            pass
        last = self.last
        if last is not None and (not self.cut or set(last.index_places) == set(last.counts)):
            self._settle()

    def _record(self):
        """Read the next record; False where the data section ends."""
        head = self._stream.read(HEAD.size)
        opcode, length = HEAD.unpack(head) if len(head) == HEAD.size else (0, 0)
        if opcode in _AFTER_DATA:
            self.cut, self.lost_bytes = self.end == 0, 0
            return False
        self.lost_bytes = self._size - self.end
        if opcode == 0 or (self.end == 0) != (opcode == Opcode.HEADER):
            return False
        begin = self._stream.tell()
        needed = opcode not in (Opcode.HEADER, Opcode.ATTACHMENT) and opcode <= Opcode.DATA_END
        content = self._stream.read(min(length, LARGEST_RECORD if needed else _ATTACHMENT_START))
        if begin + length > self._size or (needed and len(content) < length):
            self._cut_in(opcode, content)
            return False
        try:
            self._whole(opcode, content, begin - HEAD.size, length + HEAD.size)
        except Damaged:         # whole, but not what it says it is
            return False
        self.end = begin + length
        self._stream.seek(self.end)
        return True

    def _cut_in(self, opcode, content):
        if opcode == Opcode.CHUNK:
            try:
                self.cut_chunk = of_bytes(Chunk, content, whole=False)
            except Damaged:     # cut before its data
                return
        elif opcode == Opcode.MESSAGE_INDEX:
            self.lost_bytes = 0

    def _whole(self, opcode, content, offset, length):
        if opcode != Opcode.MESSAGE_INDEX and self.last is not None:
            self._settle()
        if opcode == Opcode.CHUNK:
            self._chunk(content, offset, length)
        elif opcode == Opcode.MESSAGE_INDEX:
            if self.last is not None:
                self.last.index_places[int.from_bytes(content[:2], 'little')] = offset
                self.last.index_length += length
        elif opcode == MESSAGE:
            record = HEAD.pack(opcode, len(content)) + content
            if len(record) < HEADS.itemsize:
                raise Damaged('a message without a head')
            head = heads(record, np.zeros(1, int))[0]
            time = int(head['log_time'])
            self.contents.add_messages({int(head['channel']): 1}, time, time)
        elif opcode == Opcode.METADATA:
            self.contents.add_metadata(offset, length, of_bytes(Metadata, content).name)
        elif opcode == Opcode.ATTACHMENT:
            self.contents.attachment_indexes.append(attachment_index(offset, length, content))
        else:
            self.contents.describe(opcode, content)

    def _chunk(self, content, offset, length):
        chunk = of_bytes(Chunk, content)
        try:
            records = records_of(chunk)
            found = FoundChunk(chunk, offset, length, records)
        except Damaged:
            self.damaged.append((offset, chunk))
            return
        for opcode, begin, end in found.others:
            self.contents.describe(opcode, records[begin:end])
        if found.counts:
            self.contents.add_messages(found.counts, int(found.times.min()),
                                       int(found.times.max()))
            self.last = found
            self._chunk_bytes += len(records)
            self._chunk_messages += len(found.offsets)

    @property
    def mean_message(self):
        """See the class."""
        return self._chunk_bytes / self._chunk_messages if self._chunk_messages else 0.0

    def _settle(self):
        index = self.last.index()
        self.contents.add_chunk(index)
        self.places.append(place_of(index, self._channel_sets))
        self.last = None
