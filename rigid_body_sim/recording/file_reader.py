"""One MCAP file read: its channels, and its messages a chunk at a time."""

import os
import typing

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording import compression, mcap_format
from rigid_body_sim.recording.scan import Scan
from rigid_body_sim.recording.summary import (
    ChunkPlace,
    chunk_places,
    read_metadata_record,
    read_summary,
)
from rigid_body_sim.recording.walk import Cut, heads, walk

_LARGEST_RECORD = compression.LARGEST_CHUNK + 2**16
_PIECE = 4 * 2**20      # bytes of a file without chunks that are read at once


class Schema(typing.NamedTuple):
    """A message type as recorded."""

    name: str
    encoding: str
    text: str


class Piece(typing.NamedTuple):
    """Messages of one chunk: `records`, where in them each message's record begins, and its heads (structured array)."""

    records: bytes
    offsets: np.ndarray
    heads: np.ndarray

    def messages(self, channels, make):
        """Return a list of make(log_time, topic, publish_time, sequence, data), sorted by log time."""
        order = np.argsort(self.heads['log_time'], kind='stable')
        heads_, offsets = self.heads[order], self.offsets[order]
        begins = offsets + mcap_format.MESSAGE_HEAD.size
        ends = offsets + mcap_format.HEAD.size + heads_['length'].astype(np.int64)
        columns = (heads_['log_time'], heads_['channel'], heads_['publish_time'], heads_['sequence'], begins, ends)
        return [make(log_time, channels[number], publish_time, sequence, self.records[begin:end])
                for log_time, number, publish_time, sequence, begin, end in zip(*(column.tolist() for column in columns), strict=True)]


class FileReader:
    """A whole MCAP file. BadInput where it is cut or makes no sense. Attributes as of Recording, with channel numbers for topics."""

    def __init__(self, path):
        self.path = path
        try:
            self._stream = open(path, 'rb')     # noqa: SIM115, closed with the reader
        except OSError as error:
            raise BadInput(str(path), f'cannot be read ({error.strerror})', 'a recording') from error
        try:
            contents = self._contents()
            schemas = [mcap_format.read_schema(record[mcap_format.HEAD.size:]) for record in contents.schemas.values()]
            channels = [mcap_format.read_channel(record[mcap_format.HEAD.size:]) for record in contents.channels.values()]
            self._places = self._checked(chunk_places(contents))
        except BadInput:
            raise
        except ValueError as error:
            raise BadInput(str(path), str(error), '"recover" makes a cut recording whole') from error
        self._contents_found = contents
        self._schemas = {number: Schema(*rest) for number, *rest in schemas}
        self.channels = {channel.id: channel for channel in channels}
        self.counts, self.start_time, self.end_time = contents.counts, contents.start_time, contents.end_time

    def _contents(self):
        """Return Contents: from the summary if it tells all, else from the whole file."""
        if self._stream.read(len(mcap_format.MAGIC)) != mcap_format.MAGIC:
            raise BadInput(str(self.path), 'is not an MCAP file', 'a recording (.mcap)')
        contents = read_summary(self._stream)
        if contents is None:
            self._stream.seek(0)
            contents = Scan(self._stream).contents
        return contents

    def _checked(self, places):
        size = os.fstat(self._stream.fileno()).st_size
        if any(place.offset + place.length > size for place in places):
            raise ValueError('an index that points behind the end of the file')
        return places

    def close(self):
        """Close the file."""
        self._stream.close()

    def schema(self, channel):
        """Return the Schema of a channel; BadInput where there is none."""
        if channel.schema not in self._schemas:
            raise BadInput(f'{self.path}: {channel.topic}', 'has no message type', 'a recording of ROS 2 messages')
        return self._schemas[channel.schema]

    def metadata(self, name):
        """Return the texts of a metadata record, or None."""
        try:
            return read_metadata_record(self._stream, self._contents_found, name)
        except ValueError as error:
            raise self._nonsense(error) from error

    def _nonsense(self, error):
        return BadInput(str(self.path), str(error), 'an undamaged recording; "recover" keeps what can be read of it')

    def places(self):
        """Yield where to read a Piece: the chunks, or in a file without, stretches of its data section."""
        if self._places or not self.counts:
            yield from self._places
            return
        position, size, last = len(mcap_format.MAGIC), _PIECE, False
        while not last:
            data = self._read(position, size)
            whole, last, times = _whole_records(data)
            if not whole and not last:
                if len(data) < size:
                    raise self._nonsense('a record that does not end')
                size *= 2
                continue
            if len(times):
                yield ChunkPlace(position, whole, int(times.min()), int(times.max()))
            position += whole

    def _read(self, offset, length):
        self._stream.seek(offset)
        return self._stream.read(min(length, _LARGEST_RECORD))

    def piece(self, place, channels, start, end):
        """Return the Piece at a place with the messages of some channels (numbers) in [start, end] ns."""
        try:
            data = self._read(place.offset, place.length)
            if self._places:
                data = self._uncompressed(data)
            offsets, _ = walk(data)
        except BadInput:
            raise
        except ValueError as error:
            raise self._nonsense(error) from error
        message_heads = heads(data, offsets)
        times = message_heads['log_time']
        wanted = np.isin(message_heads['channel'], list(channels)) & (times >= start) & (times <= end)
        return Piece(data, offsets[wanted], message_heads[wanted])

    def _uncompressed(self, data):
        opcode, length = mcap_format.Cursor(data).numbers('BQ')
        if opcode != mcap_format.CHUNK or length != len(data) - mcap_format.HEAD.size:
            raise ValueError('an index that points at no chunk')
        head = mcap_format.read_chunk(data[mcap_format.HEAD.size:])
        begin = mcap_format.HEAD.size + head.data_offset
        return compression.decompress(head.compression, data[begin:begin + head.data_size], head.size, head.crc)


def _whole_records(data):
    """Return how many bytes of data section records there are at the start, whether the section ends behind them, and their log times."""
    try:
        (offsets, others), whole = walk(data), len(data)
    except Cut as cut:
        (offsets, others), whole = cut.found, cut.whole
    end = next((begin - mcap_format.HEAD.size for opcode, begin, _ in others if opcode in (mcap_format.DATA_END, mcap_format.FOOTER)), None)
    whole = whole if end is None else end
    return whole, end is not None, heads(data, offsets[offsets < whole])['log_time']
