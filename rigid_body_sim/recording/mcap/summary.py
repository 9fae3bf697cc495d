# SPDX-License-Identifier: Apache-2.0
"""The tail of an MCAP file: whether it is whole, and what its summary says is in the file.

The records of the summary are read by `mcap.stream_reader`. Why not
`mcap.reader.SeekingReader.get_summary`: it does not check the summary's checksum nor any length,
so a damaged tail makes it read whatever follows, or allocate what a record claims; and it keeps an
object of 0.8 kB per chunk.
"""

import io
import os
import struct
import typing
import zlib

from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.reader import FOOTER_SIZE
from mcap.records import (
    Channel,
    ChunkIndex,
    DataEnd,
    Footer,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
)
from mcap.stream_reader import StreamReader
from mcap.writer import MCAP0_MAGIC

from rigid_body_sim.recording.mcap.contents import ChunkPlace, Contents
from rigid_body_sim.recording.mcap.records import HEAD, Damaged, of_bytes, to_bytes

_END_SIZE = FOOTER_SIZE + len(MCAP0_MAGIC)
_DATA_END_SIZE = len(to_bytes(DataEnd(0)))
_FOOTER_HEAD = to_bytes(Footer(0, 0, 0))[:HEAD.size]
_LARGEST_SUMMARY = 2**30


def read_tail(stream):
    """Return (summary_start, summary with footer and magic), or None where there is no whole tail.

    `summary_start` is 0 where the file has no summary.
    """
    size = os.fstat(stream.fileno()).st_size
    if size < len(MCAP0_MAGIC) + _END_SIZE:
        return None
    stream.seek(size - _END_SIZE)
    end = stream.read(_END_SIZE)
    if not end.endswith(MCAP0_MAGIC) or not end.startswith(_FOOTER_HEAD):
        return None
    footer = of_bytes(Footer, end[HEAD.size:])
    start = footer.summary_start
    if start == 0:
        return 0, end
    if not len(MCAP0_MAGIC) < start <= size - _END_SIZE or size - start > _LARGEST_SUMMARY:
        return None
    stream.seek(start)
    summary = stream.read(size - start)
    checked = summary[:-len(MCAP0_MAGIC) - 4]
    if footer.summary_crc and zlib.crc32(checked) != footer.summary_crc:
        return None
    return start, summary


def tail_is_whole(stream, data_end):
    """Return whether a whole tail follows the data section, which ends at `data_end`.

    A summary without a checksum has to make sense at least.
    """
    try:
        read_summary(stream)
    except Damaged:
        return False
    tail = read_tail(stream)
    size = os.fstat(stream.fileno()).st_size
    return data_end + _DATA_END_SIZE == (tail[0] or size - _END_SIZE)


def read_summary(stream):
    """Return the Contents (without `chunk_indexes`) and the ChunkPlaces that a summary tells.

    Returns None where the summary does not tell all: then the file has to be scanned. Raises
    Damaged where the file is cut, or its tail makes no sense.
    """
    tail = read_tail(stream)
    if tail is None:
        raise Damaged('the file is cut or damaged: its tail is not whole')
    reader = StreamReader(io.BytesIO(tail[1]), skip_magic=True, emit_chunks=True,
                          record_size_limit=len(tail[1]))
    contents, places, totals, known = Contents(), [], None, {}
    try:
        for record in reader.records:
            if isinstance(record, ChunkIndex):
                places.append(place_of(record, known))
            elif isinstance(record, Statistics):
                totals = record
            elif isinstance(record, MetadataIndex):
                contents.metadata_indexes.append(record)
            elif isinstance(record, (Schema, Channel)):
                contents.note(record)
    except (McapError, struct.error, ValueError, OverflowError, MemoryError) as error:
        raise Damaged(f'a summary that makes no sense ({error})') from error
    if totals is None or totals.chunk_count != len(places):
        return None
    contents.chunk_count = len(places)
    contents.start_time, contents.end_time = totals.message_start_time, totals.message_end_time
    contents.counts = {number: count for number, count in totals.channel_message_counts.items()
                       if count}
    if not set(contents.counts) <= set(contents.channels):
        return None
    if contents.counts and sum(contents.counts.values()) != totals.message_count:
        return None
    return contents, sorted(places, key=lambda place: place.offset)


class Told(typing.NamedTuple):
    """What a whole summary says about a file that may be damaged before it.

    Attributes
    ----------
    contents : Contents
        Without `chunk_indexes`.
    places : list of ChunkPlace
    data_end : int
        Where the record is that ends the data section.
    checked : bool
        Whether a checksum vouches for it.
    """

    contents: Contents
    places: list
    data_end: int
    checked: bool


def read_told(stream):
    """Return what the summary tells, as Told; None where it is not whole or does not tell all."""
    try:
        summary, tail = read_summary(stream), read_tail(stream)
    except Damaged:
        return None
    if summary is None or not tail[0]:
        return None
    footer = of_bytes(Footer, tail[1][HEAD.size - _END_SIZE:])
    return Told(*summary, tail[0] - _DATA_END_SIZE, footer.summary_crc != 0)


def chunk_indexes(stream):
    """Return the ChunkIndexes of a summary: offset of the chunk -> record.

    There are none where the summary is not whole. One without statistics has them, too.
    """
    try:
        read_summary(stream)
    except Damaged:
        return {}
    reader = StreamReader(io.BytesIO(read_tail(stream)[1]), skip_magic=True, emit_chunks=True)
    return {record.chunk_start_offset: record for record in reader.records
            if isinstance(record, ChunkIndex)}


def place_of(index, known):
    """Return the ChunkPlace of a ChunkIndex; chunks with the same channels share their set."""
    channels = frozenset(index.message_index_offsets)
    return ChunkPlace(index.chunk_start_offset, index.chunk_length, index.message_start_time,
                      index.message_end_time, known.setdefault(channels, channels))


def read_metadata(stream, contents, name):
    """Return the texts of the first metadata record of that name, or None."""
    size = os.fstat(stream.fileno()).st_size
    for index in contents.metadata_indexes:
        if index.name == name and index.length <= _LARGEST_SUMMARY and index.offset < size:
            stream.seek(index.offset)
            record = stream.read(index.length)
            if record[:1] == bytes([Opcode.METADATA]):
                return of_bytes(Metadata, record[HEAD.size:]).metadata
    return None
