# SPDX-License-Identifier: Apache-2.0
"""A small file of the library's read a chunk at a time: bounds, channels, order, pieces."""

import io
import itertools
import random
import types

import numpy as np
import pytest
from mcap.records import Channel, ChunkIndex, MetadataIndex, Schema
from mcap.writer import CompressionType, IndexType, Writer

from rigid_body_sim.recording.mcap import reading
from rigid_body_sim.recording.mcap.contents import Contents
from rigid_body_sim.recording.mcap.reading import FileReader
from rigid_body_sim.recording.mcap.records import Damaged

FORMS = {'uncompressed': {'compression': CompressionType.NONE},
         'lz4': {'compression': CompressionType.LZ4},
         'zstd': {'compression': CompressionType.ZSTD}, 'no chunks': {'use_chunking': False},
         'no statistics': {'use_statistics': False},
         'no index': {'index_types': IndexType.NONE}}


def written(path, **options):
    """Write 30 messages on three channels; every fifth is late: its log time is of before."""
    stream, draw, found = io.BytesIO(), random.Random(3), []
    writer = Writer(stream, chunk_size=300, **options)
    writer.start('ros2', 'theirs')
    schema = writer.register_schema('a/B', 'ros2msg', b'float64 data')
    channels = [writer.register_channel(f'/{name}', 'cdr', schema) for name in 'xyz']
    for k in range(30):
        time = 1000 + 10 * k - 25 * (k % 5 == 4)
        data = draw.randbytes(8 + k % 3)
        writer.add_message(channels[k % 3], time, data, 5000 + 10 * k, k)
        found.append((time, '/' + 'xyz'[k % 3], 5000 + 10 * k, k, data))
    writer.add_metadata('about', {'a': 'b'})
    writer.finish()
    path.write_bytes(stream.getvalue())
    return found


def flat(pieces):
    return list(itertools.chain.from_iterable(pieces))


def read(path, topics='xyz', start=0, end=2 ** 62):
    reader = FileReader(path)
    names = {number: channel.topic for number, channel in reader.channels.items()}
    wanted = [number for number, topic in names.items() if topic[1:] in topics]
    pieces = [reader.piece(place, wanted, start, end).messages(names, lambda *parts: parts)
              for place in reader.places()]
    reader.close()
    return pieces


@pytest.mark.parametrize('form', FORMS)
def test_every_message_is_read_with_its_numbers(tmp_path, form):
    path = tmp_path / 'a.mcap'
    truth = written(path, **FORMS[form])
    pieces = read(path)
    assert sorted(flat(pieces)) == sorted(truth)
    for piece in pieces:
        assert [message[0] for message in piece] == sorted(message[0] for message in piece)
    reader = FileReader(path)
    assert sum(reader.counts.values()) == 30
    assert (reader.start_time, reader.end_time) == (1000, max(one[0] for one in truth))
    if form != 'no index':
        assert reader.metadata('about') == {'a': 'b'}
    assert reader.metadata('else') is None
    for place, piece in zip(reader.places(), pieces, strict=True):
        assert (place.start_time, place.end_time) == (piece[0][0], piece[-1][0])
    reader.close()


@pytest.mark.parametrize('form', ['zstd', 'no chunks'])
@pytest.mark.parametrize(('topics', 'start', 'end'), [
    ('x', 0, 2 ** 62), ('yz', 0, 2 ** 62), ('', 0, 2 ** 62), ('xyz', 1000, 1000),
    ('xyz', 1001, 1180), ('xyz', 1180, 1180), ('xyz', 1181, 1189), ('y', 1100, 1200)])
def test_channels_and_times_are_chosen_both_ends_included(tmp_path, form, topics, start, end):
    path = tmp_path / 'a.mcap'
    truth = written(path, **FORMS[form])
    expected = [one for one in truth if one[1][1:] in topics and start <= one[0] <= end]
    assert sorted(flat(read(path, topics, start, end))) == sorted(expected)


@pytest.mark.parametrize('size', [60, 100, 333, 2000])
def test_a_file_without_chunks_is_read_in_pieces_of_whole_records(tmp_path, monkeypatch, size):
    path = tmp_path / 'a.mcap'
    truth = written(path, use_chunking=False)
    monkeypatch.setattr(reading, '_PIECE', size)
    pieces = read(path)
    assert sum(map(len, pieces)) == 30
    assert sorted(flat(pieces)) == sorted(truth)
    assert (len(pieces) > 1) == (size < 1500)


def test_an_index_that_leads_behind_the_end_or_to_no_chunk_is_refused(tmp_path):
    path = tmp_path / 'a.mcap'
    written(path, compression=CompressionType.NONE)
    reader = FileReader(path)
    place = next(iter(reader.places()))
    with pytest.raises(Damaged, match='points at no chunk'):
        reader.piece(place._replace(offset=place.offset + 1), [1], 0, 10)
    with pytest.raises(Damaged, match='points at no chunk'):
        reader.piece(place._replace(length=place.length - 1), [1], 0, 10)
    reader.close()
    path.write_bytes(path.read_bytes()[:-9])
    with pytest.raises(Damaged, match='cut or damaged'):
        FileReader(path)


def contents(begin, counts, times, chunks=1):
    found = Contents()
    for number in counts:
        found.note(Schema(id=number, name=f's{number}', encoding='', data=b''))
        found.note(Channel(id=number, topic=f'/{number}', message_encoding='', metadata={},
                           schema_id=number))
    if counts:
        found.add_messages(counts, *times)
    for k in range(chunks):
        places = {number: begin + 50 + number for number in counts}
        found.add_chunk(
            ChunkIndex(40, begin + 100 * k, '', 10, times[1], 20, places, times[0], 10))
    found.add_metadata(begin + 5, 7, 'about')
    return found


@pytest.mark.parametrize('shift', [0, 1000])
def test_contents_of_two_stretches_are_put_together_and_moved(shift):
    whole, other = contents(8, {1: 5, 2: 3}, (100, 200)), contents(500, {2: 4, 3: 1}, (50, 150), 2)
    whole.merge(other, shift)
    assert whole.counts == {1: 5, 2: 7, 3: 1}
    assert whole.message_count == 13
    assert (whole.start_time, whole.end_time) == (50, 200)
    assert sorted(whole.channels) == sorted(whole.schemas) == [1, 2, 3]
    assert whole.chunk_count == 3
    found = list(whole.each_chunk())
    assert [one.chunk_start_offset for one in found] == [8, 500 + shift, 600 + shift]
    assert [one.message_index_offsets for one in found] == [
        {1: 59, 2: 60}, {2: 552 + shift, 3: 553 + shift}, {2: 552 + shift, 3: 553 + shift}]
    assert whole.metadata_indexes == [MetadataIndex(13, 7, 'about'),
                                      MetadataIndex(505 + shift, 7, 'about')]
    empty = Contents()
    empty.merge(whole)
    assert (empty.counts, empty.start_time, empty.end_time) == (whole.counts, 50, 200)
    empty.merge(Contents(), 7)
    assert (empty.start_time, empty.end_time, empty.chunk_count) == (50, 200, 3)
    assert np.array_equal(np.frombuffer(empty.chunk_indexes, np.uint8),
                          np.frombuffer(whole.chunk_indexes, np.uint8))


@pytest.mark.parametrize(('damages', 'cut', 'refused'), [
    ([], False, False), (['a hole'], False, True), ([], True, True), (['a hole'], True, True)])
def test_a_file_without_a_summary_is_read_if_all_of_it_is_whole(
        damages, cut, refused, tmp_path, monkeypatch):
    written(tmp_path / 'a.mcap')
    monkeypatch.setattr(reading, 'read_summary', lambda stream: None)
    contents = types.SimpleNamespace(schemas={}, channels={}, counts={}, start_time=3, end_time=4)
    monkeypatch.setattr(reading, 'Scan', lambda stream: types.SimpleNamespace(
        damages=damages, cut=cut, contents=contents, places=[]))
    if refused:
        with pytest.raises(Damaged, match='the file is damaged'):
            FileReader(tmp_path / 'a.mcap')
        return
    reader = FileReader(tmp_path / 'a.mcap')
    assert (reader.start_time, reader.end_time) == (3, 4)
    reader.close()


@pytest.mark.parametrize('length', range(8))
def test_an_index_that_points_at_a_few_bytes_points_at_no_chunk(length):
    with pytest.raises(Damaged, match='points at no chunk'):
        reading._uncompressed(b'\x06' + bytes(length) if length else b'')
