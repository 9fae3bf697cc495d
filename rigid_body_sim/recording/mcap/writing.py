# SPDX-License-Identifier: Apache-2.0
"""One MCAP file being written: each call appends whole records, or it appends nothing.

A chunk is written by one call with its message indexes, so that a killed writer leaves a file that
is whole but for its tail. Why not `mcap.writer.Writer`: a disk that refuses leaves it in the
middle of a record, and it cannot take that back; for speed see chunks.py.
"""

import os

from mcap.records import Header, Metadata
from mcap.writer import MCAP0_MAGIC

from rigid_body_sim.recording.mcap import chunks
from rigid_body_sim.recording.mcap.compression import compressor
from rigid_body_sim.recording.mcap.contents import Contents
from rigid_body_sim.recording.mcap.records import to_bytes

HEADER = Header('ros2', 'rigid_body_sim')


class McapFile:
    """A file being written.

    Parameters
    ----------
    descriptor : int
        An open, empty file. Closed by :meth:`finish` or :meth:`close`.
    compression : str
        ``zstd``, ``lz4`` or ``''``.
    descriptions : sequence of mcap.records.Schema and mcap.records.Channel
        They come before the first chunk.
    about : (str, dict of str to str)
        Name and texts of the metadata record that follows them.

    Attributes
    ----------
    contents : Contents
    size : int
        Bytes.

    Every method raises OSError when the disk refuses; then the file is as it was before the call.
    """

    def __init__(self, descriptor, compression, descriptions=(), about=None):
        self._descriptor, self._compression = descriptor, compression
        self._compress = compressor(compression)
        self.contents, self.size = Contents(), 0
        head = MCAP0_MAGIC + to_bytes(HEADER, *descriptions)
        told = to_bytes(Metadata(*about)) if about else b''
        self._append(head + told)
        for record in descriptions:
            self.contents.note(record)
        if about:
            self.contents.add_metadata(len(head), len(told), about[0])

    def _append(self, data):
        done, view = 0, memoryview(data)
        try:
            while done < len(data):
                done += os.pwrite(self._descriptor, view[done:], self.size + done)
        except OSError:
            os.ftruncate(self._descriptor, self.size)
            raise
        self.size += len(data)

    @property
    def deleted(self):
        """True if the file has no name any more: what is written is lost."""
        return os.fstat(self._descriptor).st_nlink == 0

    def chunk(self, records, channels, times, offsets):
        """Append one chunk of message records end to end; one element of the arrays a message.

        See :func:`rigid_body_sim.recording.mcap.chunks.pack`.
        """
        chunk = chunks.pack(self.size, self._compression, self._compress(records), records,
                            channels, times, offsets)
        self._append(chunk.data)
        self.contents.add_chunk(chunk.index)
        self.contents.add_messages(chunk.counts, chunk.index.message_start_time,
                                   chunk.index.message_end_time)

    def metadata(self, name, texts):
        """Append a metadata record."""
        data = to_bytes(Metadata(name, texts))
        self._append(data)
        self.contents.add_metadata(self.size - len(data), len(data), name)

    def finish(self):
        """Write the tail, bring the file to the disk and close it."""
        self._append(self.contents.tail(self.size))
        os.fsync(self._descriptor)
        self.close()

    def close(self):
        """Close the file as it is."""
        os.close(self._descriptor)
