# SPDX-License-Identifier: Apache-2.0
"""One whole MCAP file read: its channels, and its messages a chunk at a time as columns.

Why not `mcap.reader.make_reader`: it gives messages one by one, which takes 21 times as long as a
chunk at once (bench/recordings.py); and it believes the sizes that a file claims (see
compression.py and summary.py).
"""

import os
import typing

import numpy as np
from mcap.opcode import Opcode
from mcap.records import Chunk
from mcap.writer import MCAP0_MAGIC

from rigid_body_sim.recording.mcap.compression import records_of
from rigid_body_sim.recording.mcap.contents import ChunkPlace
from rigid_body_sim.recording.mcap.records import HEAD, Damaged, of_bytes
from rigid_body_sim.recording.mcap.scan import LARGEST_RECORD, Scan, check_magic
from rigid_body_sim.recording.mcap.summary import read_metadata, read_summary
from rigid_body_sim.recording.mcap.walk import MESSAGE_HEAD, Cut, heads, walk

_PIECE = 4 * 2**20      # bytes of a file without chunks that are read at once


class Piece(typing.NamedTuple):
    """Messages of one chunk: `records` and where in them each message's record begins.

    `heads` is a structured array, see :data:`rigid_body_sim.recording.mcap.walk.HEADS`.
    """

    records: bytes
    offsets: np.ndarray
    heads: np.ndarray

    def messages(self, channels, make):
        """Return a list of make(log_time, topic, publish_time, sequence, data) by log time.

        `channels` maps channel numbers to topics.
        """
        order = np.argsort(self.heads['log_time'], kind='stable')
        heads_, offsets = self.heads[order], self.offsets[order]
        begins = offsets + MESSAGE_HEAD.size
        ends = offsets + HEAD.size + heads_['length'].astype(np.int64)
        columns = (heads_['log_time'], heads_['channel'], heads_['publish_time'],
                   heads_['sequence'], begins, ends)
        return [make(log_time, channels[number], publish_time, sequence, self.records[begin:end])
                for log_time, number, publish_time, sequence, begin, end
                in zip(*(column.tolist() for column in columns), strict=True)]


class FileReader:
    """A whole MCAP file.

    Attributes
    ----------
    channels, schemas : dict
        Number -> Channel or Schema of `mcap.records`.
    counts : dict
        Channel number -> messages.
    start_time, end_time : int
        Log times of the first and last message, ns; 0 without messages.

    Raises
    ------
    OSError
        Where the file cannot be opened.
    Damaged
        Where it is cut or makes no sense; the methods raise it as well.
    mcap.exceptions.InvalidMagic, mcap.exceptions.UnsupportedCompressionError
        Where it is no MCAP file, or its chunks are compressed by something else than zstd and lz4.
    """

    def __init__(self, path):
        self._stream = open(path, 'rb')     # noqa: SIM115, closed with the reader
        try:
            check_magic(self._stream)
            told = read_summary(self._stream)
            if told is None:
                self._stream.seek(0)
                scan = Scan(self._stream)
                if scan.damages or scan.cut:
                    raise Damaged('the file is damaged')
                told = scan.contents, scan.places
            self._contents, self._places = told
            size = os.fstat(self._stream.fileno()).st_size
            if any(place.offset + place.length > size for place in self._places):
                raise Damaged('an index that points beyond the end of the file')
        except BaseException:
            self._stream.close()
            raise
        self.schemas, self.channels = self._contents.schemas, self._contents.channels
        self.counts = self._contents.counts
        self.start_time, self.end_time = self._contents.start_time, self._contents.end_time

    def close(self):
        """Close the file."""
        self._stream.close()

    def metadata(self, name):
        """Return the texts of a metadata record, or None."""
        return read_metadata(self._stream, self._contents, name)

    def places(self):
        """Yield where to read a Piece, as ChunkPlaces.

        These are the chunks, or in a file without, stretches of its data section.
        """
        if self._places or not self.counts:
            yield from self._places
            return
        position, size, last = len(MCAP0_MAGIC), _PIECE, False
        while not last:
            data = self._read(position, size)
            whole, last, times = _whole_records(data)
            if not whole and not last:
                if len(data) < size:
                    raise Damaged('a record that does not end')
                size *= 2
                continue
            if len(times):
                yield ChunkPlace(position, whole, int(times.min()), int(times.max()))
            position += whole

    def _read(self, offset, length):
        self._stream.seek(offset)
        return self._stream.read(min(length, LARGEST_RECORD))

    def piece(self, place, channels, start, end):
        """Return the Piece at a place with the messages of some channels in [start, end] ns."""
        data = self._read(place.offset, place.length)
        if self._places:
            data = _uncompressed(data)
        offsets, _ = walk(data)
        message_heads = heads(data, offsets)
        times = message_heads['log_time']
        chosen = np.zeros(2**16, bool)      # one entry for each channel number: faster than isin
        chosen[list(channels)] = True
        wanted = chosen[message_heads['channel']] & (times >= start) & (times <= end)
        if not wanted.all():
            offsets, message_heads = offsets[wanted], message_heads[wanted]
        return Piece(data, offsets, message_heads)


def _uncompressed(data):
    """Return the records of a chunk's record."""
    length = len(data) - HEAD.size
    if length < 0 or data[:HEAD.size] != HEAD.pack(Opcode.CHUNK, length):
        raise Damaged('an index that points at no chunk')
    return records_of(of_bytes(Chunk, data[HEAD.size:]))


def _whole_records(data):
    """Return what of the data section is whole at the start of some bytes.

    Returns
    -------
    whole : int
        Bytes of whole records.
    last : bool
        Whether the section ends after them.
    times : array
        Log times of their messages, ns.
    """
    try:
        (offsets, others), whole = walk(data), len(data)
    except Cut as cut:
        (offsets, others), whole = cut.found, cut.whole
    end = next((begin - HEAD.size for opcode, begin, _ in others
                if opcode in (Opcode.DATA_END, Opcode.FOOTER)), None)
    whole = whole if end is None else end
    return whole, end is not None, heads(data, offsets[offsets < whole])['log_time']
