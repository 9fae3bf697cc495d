# SPDX-License-Identifier: Apache-2.0
"""One wrong byte anywhere in a small file of the library's: what it costs, and what is said.

The files are a few kB, so that every byte can be tried: all of them with `make soak`, one of
eleven here. Their schemas and channels stand inside of the first chunk.
"""

import contextlib
import io
import random
import struct
import tempfile
import types

import pytest
import zstandard
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.records import Channel, Chunk, Message, Schema
from mcap.stream_reader import StreamReader
from mcap.writer import MCAP0_MAGIC, CompressionType, Writer
from near import near
from soak import SOAK, some_of

from rigid_body_sim.recording.mcap import mending
from rigid_body_sim.recording.mcap.bytes import MemoryBytes
from rigid_body_sim.recording.mcap.chunks import message
from rigid_body_sim.recording.mcap.compression import compressor, records_of, zstd_length
from rigid_body_sim.recording.mcap.forms import record_end
from rigid_body_sim.recording.mcap.found import Damage
from rigid_body_sim.recording.mcap.mending import Losses, mend
from rigid_body_sim.recording.mcap.records import HEAD, of_bytes, to_bytes
from rigid_body_sim.recording.mcap.walk import heads, walk

COUNT = 24
ERRORS = (McapError, zstandard.ZstdError, EOFError, ValueError, LookupError, RuntimeError,
          MemoryError, OverflowError, struct.error, OSError)
FORMS = {'uncompressed': CompressionType.NONE, 'lz4': CompressionType.LZ4,
         'zstd': CompressionType.ZSTD, 'no chunks': None}


def small(form, sizes=(8, 9, 10), **options):
    """Return the bytes of a file with 24 messages on two channels, eight in a chunk."""
    stream, draw = io.BytesIO(), random.Random(1)
    writer = Writer(stream, chunk_size=300, compression=FORMS[form] or CompressionType.NONE,
                    use_chunking=FORMS[form] is not None, **options)
    writer.start('ros2', 'theirs')
    schema = writer.register_schema('a/B', 'ros2msg', b'float64 data')
    channels = [writer.register_channel(f'/{name}', 'cdr', schema) for name in 'xy']
    for k in range(COUNT):
        writer.add_message(channels[k % 2], 1000 + 10 * k, draw.randbytes(sizes[k % len(sizes)]),
                           2000 + 10 * k, k // 2)
    writer.finish()
    return stream.getvalue()


def messages(content):
    return [(channel.topic, message.log_time, message.publish_time, message.sequence,
             message.data) for _, channel, message in
            make_reader(io.BytesIO(content)).iter_messages(log_time_order=False)]


def readable(content):
    """Return how many messages the library reads, by the summary or record by record."""
    counts, channels = [0, 0], set()
    with contextlib.suppress(*ERRORS):
        counts[0] = len(messages(content))
    with contextlib.suppress(*ERRORS):
        for record in StreamReader(io.BytesIO(content), record_size_limit=2**20).records:
            if isinstance(record, Channel):
                channels.add(record.id)
            counts[1] += isinstance(record, Message) and record.channel_id in channels
    return max(counts)


def mended_file(content):
    """Return the bytes of a mended file, and the Losses."""
    with tempfile.TemporaryFile() as stream, tempfile.TemporaryFile() as beside:
        stream.write(content)
        stream.flush()
        losses = mend(stream, lambda *_: {'about': 'it'}, lambda: beside).losses
        out = beside if beside.seek(0, 2) else stream
        out.seek(0)
        return out.read(), losses


def mended(content):
    """Return what the library reads of a mended file, and the Losses."""
    made, losses = mended_file(content)
    if losses:
        check_summary(made)
    return messages(made), losses


@pytest.mark.parametrize('own', [None, {'kept': 'as it was'}])
def test_a_cut_file_gets_the_metadata_that_it_lacks_and_keeps_its_own(own):
    stream = io.BytesIO()
    writer = Writer(stream, chunk_size=300)
    writer.start('ros2', 'theirs')
    channel = writer.register_channel('/x', 'cdr', writer.register_schema('a/B', 'ros2msg', b''))
    if own:
        writer.add_metadata('rosbag2', own)
    for k in range(COUNT):
        writer.add_message(channel, 1000 + 10 * k, bytes(8), 2000 + 10 * k, k)
    writer.finish()
    made, losses = mended_file(stream.getvalue()[:-60])
    assert losses is not None
    assert [(one.name, one.metadata) for one in make_reader(io.BytesIO(made)).iter_metadata()] == [
        ('rosbag2', own or {'about': 'it'})]


def check_summary(content):
    """Check that the summary tells what the file holds, and where."""
    reader = make_reader(io.BytesIO(content), validate_crcs=False)
    found, told = messages(content), reader.get_summary()
    totals = told.statistics
    assert totals.message_count == len(found)
    times = [message[1] for message in found]
    assert (totals.message_start_time, totals.message_end_time) == (
        (min(times), max(times)) if times else (0, 0))
    for topic in {channel.topic for channel in told.channels.values()}:
        count = sum(totals.channel_message_counts[number]
                    for number, channel in told.channels.items() if channel.topic == topic)
        assert count == sum(message[0] == topic for message in found)
    kinds = [content[begin] for _, begin, _ in records(content)]
    assert totals.chunk_count == len(told.chunk_indexes) == kinds.count(Opcode.CHUNK)
    assert totals.metadata_count == len(told.metadata_indexes) == kinds.count(Opcode.METADATA)
    for index in told.chunk_indexes:
        begin, end = index.chunk_start_offset, index.chunk_start_offset + index.chunk_length
        assert content[begin] == Opcode.CHUNK
        assert begin + HEAD.size + HEAD.unpack_from(content, begin)[1] == end
        for number, place in index.message_index_offsets.items():
            assert end <= place < end + index.message_index_length
            assert content[place] == Opcode.MESSAGE_INDEX
            assert int.from_bytes(content[place + 9:place + 11], 'little') == number
        assert index.message_start_time <= index.message_end_time
    for index in told.metadata_indexes:
        assert content[index.offset] == Opcode.METADATA
        assert index.length == HEAD.size + HEAD.unpack_from(content, index.offset)[1]


def records(content):
    """Return (opcode, begin, end) of the records of a whole file."""
    found, at = [], 8
    while at < len(content) - 8:
        opcode, length = HEAD.unpack_from(content, at)
        found.append((opcode, at, at + HEAD.size + length))
        at += HEAD.size + length
    return found


def payload(content):
    """Return the places of the bytes that are data of a chunk, or a message without a chunk."""
    places = set()
    for opcode, begin, end in records(content):
        if opcode == Opcode.CHUNK:
            name = int.from_bytes(content[begin + 37:begin + 41], 'little')
            places.update(range(begin + 49 + name, end))
        elif opcode == Opcode.MESSAGE:
            places.update(range(begin, end))
    return places


@pytest.mark.parametrize(('form', 'wrong'), some_of(list(FORMS), [0x55, 0x80, 0x01]))
def test_a_wrong_byte_costs_what_it_must_and_all_of_it_is_told(form, wrong):
    content = small(form)
    truth, inside = messages(content), payload(content)
    assert len(truth) == COUNT
    for at in range(8 + wrong % 11, len(content) - 8, 1 if SOAK else 23):
        flipped = bytearray(content)
        flipped[at] ^= wrong
        found, losses = mended(flipped)
        told = losses or Losses()
        assert told.certainty == 'counted', at
        assert len(found) + told.messages == COUNT, at
        # a wrong offset of an index has the library read some messages twice
        assert len(found) >= min(readable(flipped), COUNT), at
        other = len(set(found) - set(truth))
        if at not in inside:
            assert found == truth, at
        elif form == 'uncompressed':
            assert len(found) == COUNT, at
            assert other <= 1, at
        elif form == 'no chunks':
            # no checksum tells of a wrong byte in the data of such a message
            assert len(found) >= COUNT - 1, at
            assert other <= 1, at
        else:
            assert len(found) >= COUNT - 8, at
        if other and form != 'no chunks':
            assert told.doubtful >= other, at
            assert told.doubtful <= 8, at


@pytest.mark.parametrize(('form', 'into', 'wrong'), [
    ('zstd', 2, 1), ('uncompressed', 1, 0x80), ('zstd', 12, 1), ('uncompressed', 11, 0x80)])
def test_a_message_index_with_a_wrong_length_does_not_swallow_a_chunk(form, into, wrong):
    """The wrong length, of the record or of its array, ends where another record begins."""
    content = small(form)
    index = [begin for opcode, begin, _ in records(content) if opcode == Opcode.MESSAGE_INDEX]
    for begin in index:
        flipped = bytearray(content)
        flipped[begin + into] ^= wrong
        assert mended(flipped)[0] == messages(content), begin


@pytest.mark.parametrize('opcode', [0x7F, Opcode.CHANNEL, Opcode.ATTACHMENT, Opcode.MESSAGE])
def test_a_message_index_with_a_wrong_opcode_is_one_by_its_lengths_and_costs_nothing(opcode):
    content = small('zstd')
    for begin in [begin for kind, begin, _ in records(content) if kind == Opcode.MESSAGE_INDEX]:
        flipped = bytearray(content)
        flipped[begin] = opcode
        found, losses = mended(flipped)
        assert found == messages(content), begin
        told = losses or Losses()
        assert (told.messages, told.bytes) == (0, 0), begin


def test_a_file_cut_within_the_record_that_ends_the_data_keeps_its_last_message():
    content = small('no chunks')
    [begin] = [begin for opcode, begin, _ in records(content) if opcode == Opcode.DATA_END]
    for size in range(begin, begin + 13):
        assert mended(content[:size])[0] == messages(content), size


@pytest.mark.parametrize('place', [0, 7, -1])
def test_a_message_without_data_whose_opcode_is_wrong_is_kept(place):
    """Also where the file is cut behind it: its length says that it is whole."""
    content = small('no chunks', sizes=(0,))
    kept = [(begin, end) for opcode, begin, end in records(content) if opcode == Opcode.MESSAGE]
    begin, end = kept[place]
    flipped = bytearray(content if place >= 0 else content[:end])
    flipped[begin] = Opcode.CHANNEL
    assert mended(flipped)[0] == messages(content)


@pytest.mark.parametrize('form', FORMS)
def test_a_file_cut_anywhere_keeps_what_was_there(form):
    content = small(form)
    truth, kept = messages(content), 0
    for size in range(60, len(content), 1 if SOAK else 23):
        found, losses = mended(content[:size])
        assert found == truth[:len(found)], size
        assert len(found) >= kept, size
        kept = len(found)
        assert losses is not None
        assert losses.doubtful == 0
    assert kept == COUNT


def sequences(*numbers, channel=1, start=0):
    """Return what a FoundChunk says of messages of one channel, a ns apart."""
    records = b''.join(message(channel, number, start + k, 0, b'')
                       for k, number in enumerate(numbers))
    found = heads(records, walk(records)[0])
    return types.SimpleNamespace(heads=found, counts={channel: len(numbers)},
                                 times=found['log_time'])


@pytest.mark.parametrize(('before', 'after', 'more', 'expected'), [
    ((3, 4, 5), (9, 10), {}, (3, 'counted')),
    ((2**32 - 2, 2**32 - 1), (1, 2), {}, (1, 'counted')),
    ((3, 4, 6), (9, 10), {}, (0, 'unknown')),
    ((3, 4, 6), (9, 10), {'lost_bytes': 0}, (0, 'counted')),
    ((3, 4, 5), (9,), {'claimed': 100}, (4, 'estimated')),
    ((3, 4, 5), (9, 10), {'claimed': 100, 'kept': 1}, (4, 'estimated')),
    ((3, 4, 5), (9, 10), {'lost': 2}, (2, 'counted'))])
def test_what_a_damage_cost_is_counted_by_sequence_or_estimated_by_size(
        before, after, more, expected):
    """100 bytes at 25 a message are four; sequence numbers that leave out some do not count."""
    damage = Damage(**{'lost_bytes': 50, **more}, before=sequences(*before),
                    after=sequences(*after))
    assert mending._count(damage, types.SimpleNamespace(mean_message=25.0)) == expected


def test_a_channel_that_is_not_on_both_sides_of_a_damage_does_not_keep_the_others_from_counting():
    before, after = sequences(3, 4, 5), sequences(9, 10)
    before.counts[2], after.counts[3] = 1, 1
    damage, scan = Damage(50, before=before, after=after), types.SimpleNamespace(mean_message=0.0)
    assert mending._count(damage, scan) == (3, 'counted')
    after.counts[2] = 1    # on both sides, and too short to tell whether its numbers count
    assert mending._count(damage, scan) == (0, 'unknown')


@pytest.mark.parametrize(('sure', 'described', 'all_kept'), [
    (True, True, True), (False, False, True), (False, True, False)])
def test_a_chunk_of_which_descriptions_may_be_wrong_is_written_without_what_is_no_message(
        sure, described, all_kept):
    other = to_bytes(Schema(1, b'', '', 'a')) * described + HEAD.pack(0x80, 1) + b'1'
    told = [message(1, k, 5 + k, 0, b'x') for k in range(2)]
    content = told[0] + other + told[1]
    offsets, others = walk(content)
    found = types.SimpleNamespace(offsets=offsets, others=others, records=content,
                                  compressed=content, compression='', sure=sure)
    with tempfile.TemporaryFile() as stream:
        mending._Composer(stream.fileno(), 0)._rescued(found, doubtful=not described)
        stream.seek(0)
        written = stream.read()
    chunk = of_bytes(Chunk, written[HEAD.size:])
    assert records_of(chunk) == (content if all_kept else b''.join(told))
    assert (chunk.message_start_time, chunk.message_end_time) == (5, 6)
    assert bool(chunk.uncompressed_crc) == described    # none vouches for what is doubtful


@pytest.mark.parametrize(('of', 'last', 'expected'), [
    ({'lost_bytes': 50}, 0, 98),
    ({'lost_bytes': 0, 'claimed': 7}, 0, 98),
    ({'lost_bytes': 0, 'lost': 7}, 0, 98),
    ({'lost_bytes': 0}, 0, 0),
    ({'lost_bytes': 50, 'after': None}, 170, 68),
    ({'lost_bytes': 50, 'after': None, 'until': 160}, 0, 58),
    ({'lost_bytes': 50, 'after': None, 'until': 10**15}, 0, 0),
    ({'lost_bytes': 50, 'before': None}, 0, 190)])
def test_a_hole_is_the_time_between_the_messages_around_it(of, last, expected):
    """Those before end at 102 ns, those after begin at 200; the file begins at 10."""
    damage = Damage(**{'before': sequences(1, 2, 3, start=100),
                       'after': sequences(7, 8, start=200), **of})
    scan = types.SimpleNamespace(
        damages=[damage], contents=types.SimpleNamespace(start_time=10, end_time=400))
    assert mending._hole(damage, scan, last) == expected


@pytest.mark.parametrize(('expected', 'of_summary', 'cut', 'messages', 'certainty'), [
    (10, None, True, 0, 'counted'), (12, None, True, 2, 'counted'), (12, 14, True, 2, 'counted'),
    (None, 14, True, 4, 'counted'), (9, 14, False, 3, 'counted'),
    (None, None, False, 3, 'counted'), (None, None, True, 3, 'unknown'),
    (None, 9, True, 3, 'unknown')])
def test_what_is_missing_is_told_by_who_knows_how_many_there_were_or_by_the_damages(
        expected, of_summary, cut, messages, certainty):
    """Of a cut file the damages do not tell how many more there were."""
    told = of_summary and types.SimpleNamespace(
        contents=types.SimpleNamespace(message_count=of_summary, end_time=40))
    scan = types.SimpleNamespace(
        contents=types.SimpleNamespace(message_count=10, start_time=10, end_time=30), told=told,
        damages=[Damage(50, lost=2, doubtful=5)], cut_damage=Damage(7, lost=1), cut=cut)
    found = mending.losses(scan, expected)
    assert (found.messages, found.certainty, found.bytes, found.doubtful) == (
        messages, certainty, 57, 5)
    assert Losses() == (0, 'counted', 0.0, 0, 0)


@pytest.mark.parametrize(('kinds', 'certainty'), [
    ('cc', 'counted'), ('ec', 'estimated'), ('ce', 'estimated'), ('uc', 'unknown'),
    ('cu', 'unknown'), ('eu', 'unknown'), ('ue', 'unknown')])
def test_what_is_missing_is_as_certain_as_the_least_of_the_damages(kinds, certainty):
    """Where no message is missing is no hole; the second damage is one from 10 to 210 ns."""
    of = {'c': {'lost': 1}, 'e': {'claimed': 100}, 'u': {}}
    scan = types.SimpleNamespace(
        contents=types.SimpleNamespace(message_count=10, start_time=10, end_time=30), told=None,
        damages=[Damage(50, lost=0, until=160), *(Damage(50, **of[kind]) for kind in kinds)],
        cut_damage=None, cut=False, mean_message=25.0)
    scan.damages[-1].until = 210
    found = mending.losses(scan)
    assert found.certainty == certainty
    assert found.messages == sum({'c': 1, 'e': 4, 'u': 0}[kind] for kind in kinds)
    assert found.seconds == near(200e-9, rel=1e-15)


@pytest.mark.parametrize('wrong', [0, 1, -1])
def test_an_attachment_is_one_if_its_length_and_that_of_its_data_agree(wrong):
    stream = io.BytesIO()
    writer = Writer(stream, use_chunking=False)
    writer.start('ros2', 'theirs')
    writer.add_attachment(3, 5, 'name', 'text/plain', b'some data')
    writer.finish()
    content = bytearray(stream.getvalue())
    [(begin, end)] = [(begin, end) for opcode, begin, end in records(content)
                      if opcode == Opcode.ATTACHMENT]
    content[end - 4 - 9 - 8] += wrong    # checksum, data, length of the data
    assert record_end(MemoryBytes(bytes(content)), begin) == (0 if wrong else end)


@pytest.mark.parametrize('options', [{}, {'enable_crcs': False}, {'use_statistics': False}])
def test_a_whole_file_is_left_alone(options):
    for form in FORMS:
        found, losses = mended(small(form, **options))
        assert len(found) == COUNT
        assert losses is None


def test_a_file_of_which_nothing_but_the_magic_is_left_is_finished_in_place():
    with tempfile.TemporaryFile() as stream:
        stream.write(MCAP0_MAGIC)
        stream.flush()
        mend(stream, lambda *_: {'about': 'it'}, pytest.fail)
        stream.seek(0)
        assert messages(stream.read()) == []


@pytest.mark.parametrize('number', [0, 1, 2])
def test_messages_that_a_chunk_lacks_are_counted_by_its_indexes(number):
    """The last message of a chunk is gone, and its lengths are what they would be without it."""
    content = small('uncompressed')
    kinds = records(content)
    end_of_data = next(begin for opcode, begin, _ in kinds if opcode == Opcode.DATA_END)
    begin, end = [(begin, end) for opcode, begin, end in kinds if opcode == Opcode.CHUNK][number]
    last = int(walk(content[begin + 49:end])[0][-1]) + begin + 49
    damaged = bytearray(content[:last] + content[end:end_of_data])
    for place in (begin + 1, begin + 41):    # of the record, of its data
        length = int.from_bytes(damaged[place:place + 8], 'little') - (end - last)
        damaged[place:place + 8] = length.to_bytes(8, 'little')
    found, losses = mended(damaged)
    missing = (5, 13, 21)[number] - 1
    truth = messages(content)
    assert found == truth[:missing] + truth[missing + 1:]
    assert losses.messages == 1


@pytest.mark.parametrize('form', ['uncompressed', 'lz4', 'zstd'])
def test_a_chunk_with_a_wrong_head_for_which_its_checksum_vouches_gets_one_again(form):
    content = bytearray(small(form))
    [begin, *_] = [begin for opcode, begin, _ in records(content) if opcode == Opcode.CHUNK]
    content[begin] = Opcode.CHANNEL
    with tempfile.TemporaryFile() as stream, tempfile.TemporaryFile() as beside:
        stream.write(content)
        stream.flush()
        losses = mend(stream, lambda *_: {'about': 'it'}, lambda: beside).losses
        beside.seek(0)
        chunks = [record for record in StreamReader(beside, emit_chunks=True).records
                  if isinstance(record, Chunk)]
    assert (losses.messages, losses.doubtful) == (0, 0)
    assert len(chunks) == 4
    assert all(chunk.uncompressed_crc for chunk in chunks)


@pytest.mark.parametrize('size', [0, 1, 100, 2 ** 17, 2 ** 17 + 1, 300_000])
@pytest.mark.parametrize('kind', ['random', 'zeros'])
def test_the_end_of_a_zstd_frame_is_found_from_its_blocks(size, kind):
    data = bytes(size) if kind == 'zeros' else random.Random(size).randbytes(size)
    frame = compressor('zstd')(data)
    assert zstd_length(frame) == len(frame)
    assert zstd_length(frame + b'more') == len(frame)
    assert zstd_length(frame[:-1]) == 0


@pytest.mark.parametrize('form', ['uncompressed', 'lz4', 'zstd'])
@pytest.mark.parametrize('lost', [0, 1])
def test_a_damaged_chunk_behind_one_that_is_gone_is_found_by_the_index(form, lost):
    """Of the first one, and the records behind it, nothing is left; of the second no head."""
    content = small(form)
    chunks = [(begin, end) for opcode, begin, end in records(content) if opcode == Opcode.CHUNK]
    truth, counts = messages(content), [5, 8, 8, 3]
    assert len(chunks) == 4
    gone, headless = chunks[lost], chunks[lost + 1]
    damaged = bytearray(content)
    damaged[gone[0]:headless[0] + 9] = bytes(headless[0] + 9 - gone[0])
    found, losses = mended(damaged)
    first = sum(counts[:lost])
    assert found == truth[:first] + truth[first + counts[lost]:]
    assert (losses.messages, losses.certainty, losses.doubtful) == (counts[lost], 'counted', 0)


@pytest.mark.parametrize('form', ['uncompressed', 'lz4', 'zstd'])
def test_without_a_tail_what_is_behind_a_chunk_that_is_gone_is_found_by_its_form(form):
    content = small(form)
    kinds = records(content)
    chunks = [(begin, end) for opcode, begin, end in kinds if opcode == Opcode.CHUNK]
    end = next(begin for opcode, begin, _ in kinds if opcode == Opcode.DATA_END)
    truth = messages(content)
    damaged = bytearray(content[:end])
    damaged[chunks[1][0]:chunks[1][1]] = bytes(chunks[1][1] - chunks[1][0])
    found, losses = mended(damaged)
    assert found == truth[:5] + truth[13:]
    # the sequence numbers of the chunks around it count what is missing
    assert losses.messages == 8
    assert losses.seconds == pytest.approx((1130 - 1040) * 1e-9)
