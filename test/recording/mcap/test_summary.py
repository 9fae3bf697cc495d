# SPDX-License-Identifier: Apache-2.0
"""Tails of files made of the library's records: what they tell, which of them are not whole."""

import tempfile
import zlib

import pytest
from mcap.records import (
    Channel,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
)
from mcap.writer import MCAP0_MAGIC

from rigid_body_sim.recording.mcap import summary
from rigid_body_sim.recording.mcap.contents import ChunkPlace, Contents
from rigid_body_sim.recording.mcap.records import Damaged, to_bytes

HEADER = MCAP0_MAGIC + to_bytes(Header('', ''))
END = 9 + 20 + 8    # bytes of the footer and the magic
SCHEMA, CHANNEL = Schema(1, b'', '', 'a/B'), Channel(2, '/a', 'cdr', {}, 1)
CHUNKS = [ChunkIndex(40, 500, '', 10, 9, 20, {2: 545}, 5, 10),
          ChunkIndex(50, 100, '', 10, 7, 20, {2: 155}, 3, 10)]


def totals(counts, chunks=2, total=None):
    return Statistics(0, 1, counts, chunks, sum(counts.values()) if total is None else total,
                      9, 3, 1, 1)


def file(content):
    """Return an open file with this content."""
    stream = tempfile.TemporaryFile()    # noqa: SIM115, it is read later on
    stream.write(content)
    stream.flush()
    return stream


def tail(records, begin, checked=True, start=None):
    """Return a summary of some records, its footer and the magic, from a place on."""
    content = to_bytes(*records)
    footer = to_bytes(Footer(begin if start is None else start, 0, 0))[:-4]
    checksum = zlib.crc32(content + footer) if checked else 0
    return content + footer + checksum.to_bytes(4, 'little') + MCAP0_MAGIC


def made(records, checked=True, data=b''):
    """Return the bytes of a file, and where its data section ends."""
    before = HEADER + data + to_bytes(DataEnd(0))
    return before + tail(records, len(before), checked), len(HEADER + data)


WHOLE = [SCHEMA, CHANNEL, totals({2: 5}), *CHUNKS, MetadataIndex(60, 30, 'about')]


def test_the_shortest_file_is_two_magics_and_a_footer():
    content = MCAP0_MAGIC + to_bytes(Footer(0, 0, 0)) + MCAP0_MAGIC
    assert len(content) == 8 + END
    with file(content) as stream:
        assert summary.read_tail(stream) == (0, content[8:])
    with file(content[1:]) as stream:
        assert summary.read_tail(stream) is None


@pytest.mark.parametrize('checked', [False, True])
def test_a_summary_tells_chunks_counts_times_and_descriptions(checked):
    content, end = made(WHOLE, checked)
    with file(content) as stream:
        assert summary.read_tail(stream) == (end + 13, content[end + 13:])
        contents, places = summary.read_summary(stream)
        assert contents.counts == {2: 5} and contents.chunk_count == 2
        assert (contents.start_time, contents.end_time) == (3, 9)
        assert (contents.schemas, contents.channels) == ({1: SCHEMA}, {2: CHANNEL})
        assert contents.metadata_indexes == [MetadataIndex(60, 30, 'about')]
        assert places == [ChunkPlace(100, 50, 3, 7, {2}), ChunkPlace(500, 40, 5, 9, {2})]
        assert places[0].channels is places[1].channels
        told = summary.read_told(stream)
        assert (told.data_end, told.checked, told.places) == (end, checked, places)
        assert summary.chunk_indexes(stream) == {500: CHUNKS[0], 100: CHUNKS[1]}
        for off in (-1, 0, 1):
            assert summary.tail_is_whole(stream, end + off) == (off == 0)


def test_a_file_without_a_summary_ends_its_data_before_the_footer():
    content, end = made([])
    content = content[:end + 13] + to_bytes(Footer(0, 0, 0)) + MCAP0_MAGIC
    with file(content) as stream:
        assert summary.read_tail(stream) == (0, content[-END:])
        assert summary.read_told(stream) is None and summary.chunk_indexes(stream) == {}
        for off in (-1, 0, 1):
            assert summary.tail_is_whole(stream, end + off) == (off == 0)


NOT_ALL = {
    'no totals': [SCHEMA, CHANNEL, *CHUNKS], 'a chunk less': [*WHOLE[:3], CHUNKS[0]],
    'a chunk more': [*WHOLE, CHUNKS[0]], 'no channel': [SCHEMA, *WHOLE[2:]],
    'one message more': [SCHEMA, CHANNEL, totals({2: 5}, total=6), *CHUNKS],
    'one message less': [SCHEMA, CHANNEL, totals({2: 5}, total=4), *CHUNKS]}


@pytest.mark.parametrize('case', NOT_ALL)
def test_a_summary_that_does_not_tell_all_is_whole_and_tells_nothing(case):
    content, end = made(NOT_ALL[case])
    with file(content) as stream:
        assert summary.read_summary(stream) is None and summary.read_told(stream) is None
        assert summary.tail_is_whole(stream, end)
        # of the chunks it tells all the same
        assert 500 in summary.chunk_indexes(stream)


@pytest.mark.parametrize('counts', [{2: 5, 3: 0}, {}, {3: 0}])
def test_a_channel_without_messages_need_not_be_described(counts):
    """Where nothing is counted by channel, the number of all messages may be any."""
    content, _ = made([SCHEMA, CHANNEL, totals(counts, total=5), *CHUNKS])
    with file(content) as stream:
        assert summary.read_summary(stream)[0].counts == ({2: 5} if 2 in counts else {})


@pytest.mark.parametrize('place', [-1, -8, -9, -28, -29, -37, -40])
def test_a_tail_with_a_wrong_byte_is_not_whole(place):
    """In the magic, the checksum, the head of the footer, its summary_start, the summary."""
    content = bytearray(made(WHOLE)[0])
    content[place] ^= 1
    with file(content) as stream:
        assert summary.read_tail(stream) is None
        assert summary.read_told(stream) is None and summary.chunk_indexes(stream) == {}
        assert not summary.tail_is_whole(stream, made(WHOLE)[1])
        with pytest.raises(Damaged, match='its tail is not whole'):
            summary.read_summary(stream)


@pytest.mark.parametrize(('start', 'good'), [
    (8, False), (9, True), (20, True), (100 - END, True), (101 - END, False), (2 ** 40, False)])
def test_a_summary_begins_behind_the_magic_and_not_behind_the_footer(start, good):
    content = bytes(100 - END) + tail([], 0, False, start)
    assert len(content) == 100
    with file(content) as stream:
        assert summary.read_tail(stream) == ((start, content[start:]) if good else None)


@pytest.mark.parametrize(('largest', 'good'), [(80, True), (79, False)])
def test_no_summary_is_read_that_is_longer_than_memory_allows(largest, good, monkeypatch):
    assert summary._LARGEST_SUMMARY > 10 ** 8
    monkeypatch.setattr(summary, '_LARGEST_SUMMARY', largest)
    with file(bytes(100 - END) + tail([], 0, False, 20)) as stream:
        assert (summary.read_tail(stream) is not None) == good


def test_a_summary_of_other_bytes_makes_no_sense():
    before = HEADER + to_bytes(DataEnd(0))
    content = before + b'\x08' + (3).to_bytes(8, 'little') + b'123' + tail([], len(before), False)
    with file(content) as stream, pytest.raises(Damaged, match='makes no sense'):
        summary.read_summary(stream)


def test_metadata_are_read_by_name_where_the_index_leads_to_some():
    records = [to_bytes(Metadata(name, {'a': name})) for name in ('x', 'y', 'y')]
    data = b'1' + b''.join(records)
    contents, at = Contents(), 1
    for name, record in zip(('x', 'y', 'z'), records, strict=True):
        contents.add_metadata(at, len(record), name)
        at += len(record)
    contents.add_metadata(0, 5, 'no metadata')
    contents.add_metadata(len(data), 5, 'behind the end')
    contents.add_metadata(1, 2 ** 40, 'too long')
    with file(data) as stream:
        assert summary.read_metadata(stream, contents, 'x') == {'a': 'x'}
        assert summary.read_metadata(stream, contents, 'y') == {'a': 'y'}
        for name in ('no metadata', 'behind the end', 'too long', 'else'):
            assert summary.read_metadata(stream, contents, name) is None
