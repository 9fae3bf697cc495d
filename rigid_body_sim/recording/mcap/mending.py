# SPDX-License-Identifier: Apache-2.0
"""A cut file mended in place.

Whatever is whole stays where it is; what is missing of the last chunk's indexes, and the tail, are
written behind it. Why not reading all of it by `mcap.stream_reader` and writing it anew by
`mcap.writer`: that takes 15 times as long (bench/recordings.py) and the size of the file once
more, where a full disk has room for an index only; and it loses the messages of an uncompressed
chunk that is cut.
"""

import os
import typing

import numpy as np
from mcap.records import Metadata
from mcap.writer import MCAP0_MAGIC

from rigid_body_sim.recording.mcap import chunks
from rigid_body_sim.recording.mcap.contents import Contents
from rigid_body_sim.recording.mcap.records import PRIVATE, to_bytes
from rigid_body_sim.recording.mcap.scan import Scan
from rigid_body_sim.recording.mcap.summary import read_metadata, tail_is_whole
from rigid_body_sim.recording.mcap.walk import Cut, heads, walk
from rigid_body_sim.recording.mcap.writing import HEADER


class Mended(typing.NamedTuple):
    """What became of a file.

    `contents` it has now; `lost_messages` estimated from the size of what could not be kept,
    `lost_seconds` of log time between the last message kept and the last in the cut chunk,
    `lost_bytes` dropped; `changed` is False where the file was whole.
    """

    contents: Contents
    lost_messages: int = 0
    lost_seconds: float = 0.0
    lost_bytes: int = 0
    changed: bool = True


def mend(stream, texts):
    """Make a file whole; return Mended.

    Parameters
    ----------
    stream : binary file
        Open for reading and writing.
    texts : callable
        Called with the Contents, if the file lacks a metadata record ``rosbag2``; returns its
        texts.

    Raises
    ------
    OSError
        Where the disk refuses. The file may be mended again then.
    mcap.exceptions.InvalidMagic, mcap.exceptions.UnsupportedCompressionError
        See :class:`rigid_body_sim.recording.mcap.scan.Scan`.
    """
    scan = Scan(stream)
    if not scan.cut and not scan.damaged and tail_is_whole(stream, scan.end):
        return Mended(scan.contents, changed=False)
    contents, descriptor = scan.contents, stream.fileno()
    lost_bytes, lost_messages, lost_until = scan.lost_bytes, 0, 0
    for offset, chunk in scan.damaged:
        os.pwrite(descriptor, bytes([PRIVATE]), offset)
        lost_bytes += len(chunk.data)
        lost_messages += _messages_in(chunk.uncompressed_size, scan)
    end = _Appender(descriptor, scan.end, contents)
    if scan.last:
        end.index(scan.last)
    if scan.cut_chunk:
        kept = end.salvage(scan.cut_chunk)
        lost_bytes -= kept
        lost_messages += _messages_in(scan.cut_chunk.uncompressed_size - kept, scan)
        lost_until = scan.cut_chunk.message_end_time
    if read_metadata(stream, contents, 'rosbag2') is None:
        end.metadata('rosbag2', texts(contents))
    end.append(contents.tail(end.position))
    os.fsync(descriptor)
    lost_seconds = max(0, lost_until - contents.end_time) / 1e9
    return Mended(contents, lost_messages, lost_seconds, lost_bytes)


def _messages_in(size, scan):
    return max(0, round(size / scan.mean_message)) if scan.mean_message else 0


class _Appender:
    """Writes at the end of a file that is cut off at `position`, and notes it in its Contents."""

    def __init__(self, descriptor, position, contents):
        self._descriptor, self.position, self._contents = descriptor, position, contents
        os.ftruncate(descriptor, position)
        if position == 0:
            self.append(MCAP0_MAGIC + to_bytes(HEADER))

    def append(self, data):
        done = 0
        while done < len(data):
            done += os.pwrite(self._descriptor, data[done:], self.position + done)
        self.position += len(data)

    def index(self, chunk):
        """Write all message indexes of a whole chunk at the end, and note the chunk.

        Some may have been there, unknown to the tail.
        """
        indexes, chunk.index_places, _ = chunks.index_messages(self.position, chunk.channels,
                                                               chunk.times, chunk.offsets)
        chunk.index_length = len(indexes)
        self.append(indexes)
        self._contents.add_chunk(chunk.index())

    def salvage(self, chunk):
        """Write what is whole in the data of a cut chunk as a chunk, if it is not compressed.

        Returns the size of the records kept.
        """
        data = chunk.data
        if chunk.compression:
            return 0
        try:
            offsets, others = walk(data)
        except Cut as cut:
            data, (offsets, others) = data[:cut.whole], cut.found
        if not len(offsets):
            return 0
        for opcode, begin, stop in others:
            self._contents.describe(opcode, data[begin:stop])
        found = heads(data, offsets)
        packed = chunks.pack(self.position, '', data, data, found['channel'], found['log_time'],
                             offsets.astype(np.uint64))
        self.append(packed.data)
        self._contents.add_chunk(packed.index)
        self._contents.add_messages(packed.counts, packed.index.message_start_time,
                                    packed.index.message_end_time)
        return len(data)

    def metadata(self, name, texts):
        """Write a metadata record."""
        data = to_bytes(Metadata(name, texts))
        self._contents.add_metadata(self.position, len(data), name)
        self.append(data)
