"""What an MCAP file really holds, from its first byte on: for files that are cut, damaged or without a summary, whoever wrote them."""

import os

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording import compression, mcap_format
from rigid_body_sim.recording.mcap_file import Contents
from rigid_body_sim.recording.walk import heads, walk

_LARGEST_RECORD = compression.LARGEST_CHUNK + 2**16
_AFTER_DATA = (mcap_format.FOOTER, mcap_format.CHUNK_INDEX, mcap_format.ATTACHMENT_INDEX, mcap_format.STATISTICS,
               mcap_format.METADATA_INDEX, mcap_format.SUMMARY_OFFSET, mcap_format.DATA_END)


class FoundChunk:
    """A whole chunk: its head, its place in the file, channels, times and offsets of its messages, and the message indexes behind it."""

    def __init__(self, head, offset, length, records):
        self.head, self.offset, self.length = head, offset, length
        offsets, self.others = walk(records)
        message_heads = heads(records, offsets)
        self.channels, self.times, self.offsets = message_heads['channel'], message_heads['log_time'], offsets.astype(np.uint64)
        numbers, counts = np.unique(self.channels, return_counts=True)
        self.counts = dict(zip(numbers.tolist(), counts.tolist(), strict=True))
        self.index_places, self.index_length = {}, 0

    def index_record(self):
        """Return the chunk index record."""
        return mcap_format.chunk_index(self.head, self.offset, self.length, self.index_places, self.index_length)


class Scan:
    """Everything found in a file, up to where it is cut.

    Attributes
    ----------
    contents : Contents
        All that is whole.
    end : int
        Where the data section ends: at its end record, or at the first byte that belongs to nothing whole. 0 if not even the head is whole.
    cut : bool
        True if no end record was found.
    last : FoundChunk or None
        The chunk at the very end, if the file is cut before all of its message indexes. Its index is not yet among the contents.
    lost_bytes : int
        What follows `end` in a cut file, unless it is part of a message index, which can be made again.
    cut_chunk : (Chunk, bytes) or None
        Head and what there is of the data of the chunk in which the file is cut.
    damaged : list of (offset, Chunk)
        Chunks that cannot be decompressed, or whose checksum is wrong. They are not among the contents.
    mean_message : float
        Mean size of a message in the chunks, record head included; 0.0 without chunks.
    """

    def __init__(self, stream):
        self._stream = stream
        self._size = os.fstat(stream.fileno()).st_size
        self.contents, self.end, self.cut, self.last, self.cut_chunk, self.damaged = Contents(), 0, True, None, None, []
        self.lost_bytes = self._chunk_bytes = self._chunk_messages = 0
        magic = stream.read(len(mcap_format.MAGIC))
        if magic != mcap_format.MAGIC[:len(magic)]:
            raise BadInput(stream.name, 'is not an MCAP file', 'a recording (.mcap)')
        while self._record():
            pass
        if self.last is not None and (not self.cut or set(self.last.index_places) == set(self.last.counts)):
            self._settle()

    def _record(self):
        """Read the next record; False where the data section ends."""
        head = self._stream.read(mcap_format.HEAD.size)
        opcode, length = mcap_format.HEAD.unpack(head) if len(head) == mcap_format.HEAD.size else (0, 0)
        if opcode in _AFTER_DATA:
            self.cut, self.lost_bytes = self.end == 0, 0
            return False
        self.lost_bytes = self._size - self.end
        if opcode == 0 or (self.end == 0) != (opcode == mcap_format.HEADER):
            return False
        begin = self._stream.tell()
        known = opcode not in (mcap_format.HEADER, mcap_format.ATTACHMENT) and opcode <= mcap_format.DATA_END
        content = self._stream.read(min(length, _LARGEST_RECORD if known else 2**16))
        if begin + length > self._size or (known and len(content) < length):
            self._cut_in(opcode, content)
            return False
        try:
            self._whole(opcode, content, begin - len(head), length + len(head))
        except BadInput:
            raise
        except ValueError:      # whole, but not what it says it is
            return False
        self.end = begin + length
        self._stream.seek(self.end)
        return True

    def _cut_in(self, opcode, content):
        if opcode == mcap_format.CHUNK:
            try:
                head = mcap_format.read_chunk(content)
            except ValueError:
                return
            self.cut_chunk = (head, content[head.data_offset:])
        elif opcode == mcap_format.MESSAGE_INDEX:
            self.lost_bytes = 0

    def _whole(self, opcode, content, offset, length):
        if opcode != mcap_format.MESSAGE_INDEX and self.last is not None:
            self._settle()
        if opcode == mcap_format.CHUNK:
            self._chunk(content, offset, length)
        elif opcode == mcap_format.MESSAGE_INDEX:
            if self.last is not None:
                self.last.index_places[int.from_bytes(content[:2], 'little')] = offset
                self.last.index_length += length
        elif opcode == mcap_format.MESSAGE:
            head = heads(mcap_format.HEAD.pack(opcode, length) + mcap_format.Cursor(content).take(22), np.zeros(1, int))[0]
            self.contents.add_messages({int(head['channel']): 1}, int(head['log_time']), int(head['log_time']))
        elif opcode == mcap_format.METADATA:
            self.contents.add_metadata(offset, length, mcap_format.read_metadata(content)[0])
        elif opcode == mcap_format.ATTACHMENT:
            self.contents.add_attachment(offset, length, mcap_format.read_attachment(content))
        else:
            self.contents.describe(opcode, content)

    def _chunk(self, content, offset, length):
        head = mcap_format.read_chunk(content)
        try:
            data = content[head.data_offset:head.data_offset + head.data_size]
            records = compression.decompress(head.compression, data, head.size, head.crc)
            chunk = FoundChunk(head, offset, length, records)
        except BadInput:
            raise
        except ValueError:
            self.damaged.append((offset, head))
            return
        for opcode, begin, end in chunk.others:
            self.contents.describe(opcode, records[begin:end])
        if chunk.counts:
            self.contents.add_messages(chunk.counts, int(chunk.times.min()), int(chunk.times.max()))
            self.last = chunk
            self._chunk_bytes += head.size
            self._chunk_messages += len(chunk.offsets)

    @property
    def mean_message(self):
        """See the class."""
        return self._chunk_bytes / self._chunk_messages if self._chunk_messages else 0.0

    def _settle(self):
        self.contents.add_chunk(self.last.index_record())
        self.last = None
