"""One MCAP file being written: whole records are appended or nothing is, and the tail that closes a file is made from what is in it.

Bytes are written by one call a chunk, its message indexes included, so that a killed writer leaves a file that is whole but for its tail.
"""

import os
import struct
import zlib

import numpy as np

from rigid_body_sim.recording import compression, mcap_format


class Contents:
    """What a file holds so far, enough to write its tail: the schemas, channels, counts and indexes.

    Attributes: `schemas` and `channels` map numbers to their record's bytes; `counts` channel number -> messages; `start_time`, `end_time`
    in ns (0 while there is no message); `chunk_indexes`, `metadata_indexes`, `attachment_indexes` hold records end to end.
    """

    def __init__(self):
        self.schemas, self.channels, self.counts = {}, {}, {}
        self.start_time = self.end_time = 0
        self.chunk_indexes, self.metadata_indexes, self.attachment_indexes = bytearray(), bytearray(), bytearray()
        self.chunk_count = self.metadata_count = self.attachment_count = 0
        self.told_chunks = 0    # by the summary of a file that is read

    @property
    def message_count(self):
        """Number of messages."""
        return sum(self.counts.values())

    def add_messages(self, counts, start_time, end_time):
        """Count messages: channel number -> how many."""
        self.start_time = min(self.start_time, start_time) if self.counts else start_time
        self.end_time = max(self.end_time, end_time)
        for number, count in counts.items():
            self.counts[number] = self.counts.get(number, 0) + count

    def add_chunk(self, index):
        """Note a chunk by its chunk index record."""
        self.chunk_indexes += index
        self.chunk_count += 1

    def add_metadata(self, offset, length, name):
        """Note a metadata record."""
        self.metadata_indexes += mcap_format.metadata_index(offset, length, name)
        self.metadata_count += 1

    def add_attachment(self, offset, length, attachment):
        """Note an attachment (as from read_attachment)."""
        self.attachment_indexes += mcap_format.attachment_index(offset, length, attachment)
        self.attachment_count += 1

    def describe(self, opcode, content):
        """Note a schema or channel record by its content; others are nothing to note. ValueError where it makes no sense."""
        if opcode == mcap_format.SCHEMA:
            self.schemas[mcap_format.read_schema(content)[0]] = mcap_format.record(opcode, content)
        elif opcode == mcap_format.CHANNEL:
            self.channels[mcap_format.read_channel(content).id] = mcap_format.record(opcode, content)

    def tail(self, offset):
        """Return all that follows the data section of a file, if that ends at `offset`: end of data, summary, footer, magic."""
        data_end = mcap_format.record(mcap_format.DATA_END, struct.pack('<I', 0))
        counts = {number: self.counts.get(number, 0) for number in self.channels}
        totals = mcap_format.statistics(len(self.schemas), len(self.channels), self.attachment_count, self.metadata_count, self.chunk_count,
                                        self.start_time, self.end_time, counts)
        groups = ((mcap_format.SCHEMA, b''.join(self.schemas.values())), (mcap_format.CHANNEL, b''.join(self.channels.values())),
                  (mcap_format.STATISTICS, totals), (mcap_format.CHUNK_INDEX, self.chunk_indexes),
                  (mcap_format.ATTACHMENT_INDEX, self.attachment_indexes), (mcap_format.METADATA_INDEX, self.metadata_indexes))
        summary_start = offset + len(data_end)
        summary, offsets = bytearray(), bytearray()
        for opcode, group in groups:
            if group:
                place = struct.pack('<BQQ', opcode, summary_start + len(summary), len(group))
                offsets += mcap_format.record(mcap_format.SUMMARY_OFFSET, place)
            summary += group
        offsets_start = summary_start + len(summary)
        summary += offsets + mcap_format.HEAD.pack(mcap_format.FOOTER, 20) + struct.pack('<QQ', summary_start, offsets_start)
        return data_end + summary + struct.pack('<I', zlib.crc32(summary)) + mcap_format.MAGIC


class PackedChunk:
    """A chunk ready to be written at `position`: `data` with its message indexes; and its chunk `index` record and message `counts`.

    `compressed` are the `records` (message records end to end) compressed as `compression_name` says (``''`` for not at all); `channels`,
    `times` (ns) and `offsets` (in the records) have one entry a message.
    """

    def __init__(self, position, compression_name, compressed, records, channels, times, offsets):
        self.start_time, self.end_time = int(times.min()), int(times.max())
        head = mcap_format.Chunk(self.start_time, self.end_time, len(records), zlib.crc32(records), compression_name, 0, len(compressed))
        chunk = mcap_format.chunk(*head[:5], compressed)
        indexes, places, self.counts = index_messages(position + len(chunk), channels, times, offsets)
        self.data = chunk + indexes
        self.index = mcap_format.chunk_index(head, position, len(chunk), places, len(indexes))


def index_messages(position, channels, times, offsets):
    """Return the message indexes that follow a chunk at `position`; channel number -> position of its index; channel number -> messages."""
    indexes, places, counts = bytearray(), {}, {}
    for number in np.unique(channels).tolist():
        mine = channels == number
        places[number] = position + len(indexes)
        counts[number] = int(mine.sum())
        indexes += mcap_format.message_index(number, np.stack((times[mine], offsets[mine]), axis=1))
    return indexes, places, counts


class McapFile:
    """A file being written.

    Parameters
    ----------
    descriptor : int
        An open, empty file. Closed by :meth:`finish` or :meth:`close`.
    compression_name : str
        ``zstd``, ``lz4`` or ``none``.
    prologue : callable
        Called with the new Contents and the offset of the next byte, returns the records that come before the first chunk.

    Every method raises OSError when the disk refuses; then the file is as it was before the call.
    """

    def __init__(self, descriptor, compression_name, prologue):
        self._descriptor = descriptor
        self._compression = '' if compression_name == 'none' else compression_name
        self._compress = compression.compressor(compression_name)
        self.contents = Contents()
        self.size = 0
        head = mcap_format.MAGIC + mcap_format.header('ros2', 'rigid_body_sim')
        self._append(head + prologue(self.contents, len(head)))

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
        """Append one chunk: message records end to end, and for each of them the channel number, log time (ns) and offset in `records`."""
        chunk = PackedChunk(self.size, self._compression, self._compress(records), records, channels, times, offsets)
        self._append(chunk.data)
        self.contents.add_chunk(chunk.index)
        self.contents.add_messages(chunk.counts, chunk.start_time, chunk.end_time)

    def metadata(self, name, texts):
        """Append a metadata record."""
        data = mcap_format.metadata(name, texts)
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
