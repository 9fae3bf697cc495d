# SPDX-License-Identifier: Apache-2.0
"""The contents of a file, and the tail that tells them, as the library reads it."""

import io
import zlib

import pytest
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.records import (
    AttachmentIndex,
    Channel,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    MetadataIndex,
    Schema,
)
from mcap.stream_reader import StreamReader
from mcap.writer import MCAP0_MAGIC

from rigid_body_sim.recording.mcap.contents import Contents
from rigid_body_sim.recording.mcap.records import HEAD, to_bytes

SCHEMA = Schema(1, b'float64 data', 'ros2msg', 'a/B')
CHANNELS = {number: Channel(number, f'/{number}', 'cdr', {}, 1) for number in (3, 1)}
CHUNK = ChunkIndex(40, 100, 'zstd', 7, 9, 31, {3: 140}, 5, 62)
ATTACHMENT = AttachmentIndex(300, 60, 7, 6, 9, 'a', 'text/plain')
BEFORE = MCAP0_MAGIC + to_bytes(Header('theirs', 'ros2'))


def contents(full=True):
    one = Contents()
    if full:
        for record in (SCHEMA, *CHANNELS.values()):
            one.note(record)
        one.add_messages({3: 2}, 5, 9)
        one.add_chunk(CHUNK)
        one.attachment_indexes.append(ATTACHMENT)
        one.add_metadata(200, 50, 'about')
    return one


def test_the_library_reads_from_the_tail_what_there_is():
    file = io.BytesIO(BEFORE + contents().tail(len(BEFORE)))
    summary = make_reader(file, validate_crcs=True).get_summary()
    assert summary.schemas == {1: SCHEMA} and summary.channels == CHANNELS
    assert summary.chunk_indexes == [CHUNK] and summary.attachment_indexes == [ATTACHMENT]
    assert summary.metadata_indexes == [MetadataIndex(200, 50, 'about')]
    totals = summary.statistics
    assert totals.channel_message_counts == {1: 0, 3: 2}
    assert (totals.message_count, totals.message_start_time, totals.message_end_time) == (2, 5, 9)
    assert (totals.schema_count, totals.channel_count, totals.chunk_count) == (1, 2, 1)
    assert (totals.attachment_count, totals.metadata_count) == (1, 1)


@pytest.mark.parametrize('full', [True, False])
def test_the_tail_has_its_places_and_a_checksum(full):
    """The end of the data claims no checksum; that of the summary is over all before it."""
    tail, begin = contents(full).tail(len(BEFORE)), len(BEFORE)
    data_end, file = to_bytes(DataEnd(0)), BEFORE + tail
    assert tail.startswith(data_end) and tail.endswith(MCAP0_MAGIC)
    footer = [one for one in StreamReader(io.BytesIO(file)).records if isinstance(one, Footer)][-1]
    end = len(file) - len(MCAP0_MAGIC)
    assert footer.summary_start == begin + len(data_end)
    assert footer.summary_crc == zlib.crc32(file[footer.summary_start:end - 4])
    at, groups, offsets = footer.summary_start, {}, {}
    while at < end:
        opcode, length = HEAD.unpack_from(file, at)
        size = HEAD.size + length
        if at < footer.summary_offset_start:
            first, so_far = groups.get(opcode, (at, 0))
            groups[opcode] = first, so_far + size
        elif opcode == Opcode.SUMMARY_OFFSET:
            offsets[file[at + 9]] = tuple(
                int.from_bytes(file[at + k:at + k + 8], 'little') for k in (10, 18))
        at += size
    assert offsets == groups
    assert len(groups) == (6 if full else 1)    # where there is nothing, the counts say so


@pytest.mark.parametrize('shift', [0, 1, -1, 1000])
def test_what_is_merged_lies_as_many_bytes_later(shift):
    one = contents(False)
    one.add_messages({3: 1, 1: 4}, 7, 8)
    one.add_chunk(CHUNK)
    one.merge(contents(), *([shift] if shift else []))
    assert (one.counts, one.message_count, one.chunk_count) == ({3: 3, 1: 4}, 7, 2)
    assert (one.start_time, one.end_time) == (5, 9)
    assert one.schemas == {1: SCHEMA} and one.channels == CHANNELS
    assert [index.offset for index in one.metadata_indexes] == [200 + shift]
    assert [index.offset for index in one.attachment_indexes] == [300 + shift]
    assert [(index.chunk_start_offset, index.message_index_offsets)
            for index in one.each_chunk()] == [(100, {3: 140}), (100 + shift, {3: 140 + shift})]


def test_only_schemas_and_channels_are_descriptions():
    one = contents(False)
    for record in (SCHEMA, CHANNELS[1], DataEnd(0)):
        content = to_bytes(record)
        one.describe(content[0], content[HEAD.size:])
    assert (one.schemas, one.channels) == ({1: SCHEMA}, {1: CHANNELS[1]})


def test_times_are_those_of_the_first_and_the_last_message():
    one = contents(False)
    for times in ((7, 8), (5, 6), (6, 9)):
        one.add_messages({1: 1}, *times)
    one.merge(contents(False))
    assert (one.start_time, one.end_time, one.counts) == (5, 9, {1: 3})
