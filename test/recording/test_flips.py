# SPDX-License-Identifier: Apache-2.0
"""One wrong byte in a head, a length or an index costs `recover` no message that mcap can read.

The original stays until the mended file was read back, and what is lost is counted or said to be
unknown.
"""

import io
import random
import struct

import pytest
import zstandard
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.records import Metadata
from mcap.stream_reader import StreamReader
from mcap.writer import CompressionType, IndexType
from mcap.writer import Writer as TheirWriter
from recording.conftest import write
from soak import SOAK, some_of

from rigid_body_sim.cli.simulate import main as simulate
from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording.mcap.records import HEAD, to_bytes
from rigid_body_sim.recording.recover import recover

FLIPS = 60 if SOAK else 3       # flips in each recording, whole and without its tail
ERRORS = (McapError, zstandard.ZstdError, EOFError, ValueError, LookupError, RuntimeError,
          MemoryError, OverflowError, struct.error)


def messages_of(content, records):
    """Return what the library reads until it gives up: messages as tuples, in their order.

    By the summary, or with `records` from the first byte on.
    """
    found, channels = [], {}
    try:
        if records:
            for record in StreamReader(io.BytesIO(content), record_size_limit=2**24).records:
                if type(record).__name__ == 'Channel':
                    channels[record.id] = record.topic
                elif type(record).__name__ == 'Message':
                    found.append(_message(channels[record.channel_id], record))
        else:
            for _, channel, message in make_reader(io.BytesIO(content)).iter_messages(
                    log_time_order=False):
                found.append(_message(channel.topic, message))
    except ERRORS:
        pass
    return found


def _message(topic, message):
    return topic, message.log_time, message.publish_time, message.sequence, message.data


def heads_of(content):
    """Return the places of all bytes that are no payload, by what they belong to."""
    places, at = {'magic': list(range(8)), 'end': list(range(len(content) - 8, len(content)))}, 8
    while at < len(content) - 8:
        opcode, length = HEAD.unpack_from(content, at)
        end = at + HEAD.size + length
        if opcode == Opcode.CHUNK:
            name = int.from_bytes(content[at + 37:at + 41], 'little')
            places.setdefault(opcode, []).extend(range(at, at + 49 + name))
            if not name:
                inner = at + 49
                while inner < end:
                    places.setdefault('messages', []).extend(range(inner, inner + 31))
                    inner += HEAD.size + HEAD.unpack_from(content, inner)[1]
        elif opcode == Opcode.MESSAGE:
            places.setdefault(opcode, []).extend(range(at, at + 31))
        else:
            places.setdefault(opcode, []).extend(range(at, min(end, at + 400)))
        at = end
    return list(places.values())


def simulated(path, scene, compression):
    arguments = f'--scene {scene} --duration 1 --rate 250 --compression {compression} --output'
    assert simulate([*arguments.split(), str(path / 'bag')]) == 0
    return path / 'bag' / 'bag_0.mcap'


def by_the_library(path, **options):
    """Write a recording with the library: channels in the chunks, other sizes."""
    with open(path, 'wb') as stream:
        writer = TheirWriter(stream, chunk_size=3000, **options)
        writer.start('ros2', 'theirs')
        schema = writer.register_schema('std_msgs/msg/Float64', 'ros2msg', b'float64 data')
        channels = [writer.register_channel(f'/{name}', 'cdr', schema) for name in 'xyz']
        rng = random.Random(4)
        for k in range(900):
            writer.add_message(channels[k % 3], 10**18 + k * 1000, rng.randbytes(12 + k % 5),
                               10**18 + k * 1000, k // 3)
        writer.finish()
    return path


RECORDINGS = {
    'racket zstd': lambda path: write(path / 'bag', count=250, block=50) / 'bag_0.mcap',
    'racket lz4': lambda path: write(path / 'bag', count=250, block=50, compression_name='lz4')
    / 'bag_0.mcap',
    'racket uncompressed': lambda path: write(
        path / 'bag', count=250, block=50, compression_name='none')
    / 'bag_0.mcap',
    'heavy top zstd': lambda path: simulated(path, 'heavy_top', 'zstd'),
    'billiard lz4': lambda path: simulated(path, 'billiard_low', 'lz4'),
    'bat uncompressed': lambda path: simulated(path, 'baseball_bat', 'none'),
    'theirs zstd': lambda path: by_the_library(path / 'x.mcap', compression=CompressionType.ZSTD),
    'theirs lz4': lambda path: by_the_library(path / 'x.mcap', compression=CompressionType.LZ4),
    'theirs uncompressed': lambda path: by_the_library(path / 'x.mcap',
                                                       compression=CompressionType.NONE),
    'theirs without chunks': lambda path: by_the_library(path / 'x.mcap', use_chunking=False),
}


@pytest.mark.parametrize(('name', 'cut'), some_of(list(RECORDINGS), [False, True]))
def test_a_wrong_byte_costs_no_message_that_the_library_can_read(tmp_path, name, cut):
    content = RECORDINGS[name](tmp_path).read_bytes()
    truth = messages_of(content, records=False)
    assert len(truth) > 800
    kinds, rng = heads_of(content), random.Random(f'{name} {cut}')
    if cut:
        end = content.rindex(HEAD.pack(Opcode.DATA_END, 4))
        content, kinds = content[:end], [
            inside for places in kinds if (inside := [at for at in places if at < end])]
    path, bad = tmp_path / 'flipped.mcap', []
    for _ in range(FLIPS):
        at, wrong = rng.choice(rng.choice(kinds)), rng.randrange(1, 256)
        flipped = bytearray(content)
        flipped[at] ^= wrong
        path.write_bytes(flipped)
        readable = [messages_of(flipped, records) for records in (False, True)]
        try:
            result, = recover(path)
        except BadInput as error:
            if any(readable):
                bad.append((at, wrong, str(error), [len(one) for one in readable]))
            continue
        mended = messages_of(path.read_bytes(), records=False)
        again = messages_of(path.read_bytes(), records=True)
        lost = {*truth} & {*readable[0], *readable[1]} - {*mended}
        invented = {*mended} - {*truth} - {*readable[0], *readable[1]}
        if (lost or again != mended or len(mended) < max(map(len, readable))
                or len(mended) != result.messages
                or (invented and any(readable) and not result.doubtful_messages)
                or (result.certainty == 'counted'
                    and result.messages + result.lost_messages != len(truth))
                or recover(path)[0].changed):
            bad.append((at, wrong, len(lost), len(invented), len(mended),
                        [len(one) for one in readable], str(result)))
        if result.original:
            assert result.original.read_bytes() == flipped
            result.original.unlink()
        else:           # nothing but the tail was written
            assert path.read_bytes()[:100] == flipped[:100]
    assert not bad, bad[:5]


WRONG = b'\0', b'\xff', b'7'


@pytest.mark.parametrize(('compression', 'statistics', 'size'), some_of(
    list(CompressionType), [True, False], [4, 8]))
def test_wrong_bytes_over_the_header_and_the_first_chunk_cost_no_message(
        tmp_path, compression, statistics, size):
    path = by_the_library(tmp_path / 'x.mcap', compression=compression,
                          use_statistics=statistics)
    content = path.read_bytes()
    truth, header_end = messages_of(content, records=False), 8 + 9 + 4 + 4 + 4 + len('theirs')
    assert (len(truth), content[header_end]) == (900, Opcode.CHUNK)
    bad = []
    for at in range(header_end - size + 1, header_end + 1):
        for wrong in WRONG:
            flipped = bytearray(content)
            flipped[at:at + size] = wrong * size
            path.write_bytes(flipped)
            result, = recover(path)
            if messages_of(path.read_bytes(), records=False) != truth or result.lost_messages:
                bad.append((at, wrong, str(result)))
            path.with_name('x.mcap.orig').unlink()
    assert not bad


def test_a_summary_without_a_checksum_that_makes_no_sense_is_written_anew(tmp_path):
    path = by_the_library(tmp_path / 'x.mcap', enable_crcs=False)
    content = path.read_bytes()
    truth = messages_of(content, records=False)
    at = content.rindex(b'std_msgs/msg/Float64') - 4    # the length of the name
    path.write_bytes(content[:at] + b'\xfe' + content[at + 1:])
    assert messages_of(path.read_bytes(), records=False) == []
    result, = recover(path)
    assert (result.changed, result.lost_messages) == (True, 0)
    assert messages_of(path.read_bytes(), records=False) == truth


def test_a_metadata_record_that_says_it_is_empty_is_read_by_its_content(tmp_path):
    path = tmp_path / 'x.mcap'
    with path.open('wb') as stream:
        writer = TheirWriter(stream, chunk_size=300)
        writer.start('ros2', 'theirs')
        channel = writer.register_channel('/x', 'cdr', 0)
        for k in range(100):
            writer.add_message(channel, 10**18 + k, bytes(20), 10**18 + k, k)
            if k == 50:
                writer.add_metadata('made', {'by': 'them'})
        writer.finish()
    content = path.read_bytes()
    truth = messages_of(content, records=False)
    record = to_bytes(Metadata('made', {'by': 'them'}))
    damaged = content.replace(record, record[:1] + bytes(8) + record[HEAD.size:])
    assert damaged != content
    path.write_bytes(damaged)
    result, = recover(path)
    mended = path.read_bytes()
    assert messages_of(mended, records=False) == truth == messages_of(mended, records=True)
    assert (result.lost_messages, result.certainty) == (0, 'counted')
    assert record in mended


def test_a_header_that_says_it_is_empty_leaves_a_file_that_is_read_from_its_first_byte(tmp_path):
    path = by_the_library(tmp_path / 'x.mcap')
    content = path.read_bytes()
    truth = messages_of(content, records=False)
    path.write_bytes(content[:9] + bytes(8) + content[17:])
    recover(path)
    mended = path.read_bytes()
    assert messages_of(mended, records=False) == truth == messages_of(mended, records=True)


def test_statistics_that_contradict_themselves_count_nothing(tmp_path):
    path = by_the_library(tmp_path / 'x.mcap', enable_crcs=False)
    content = path.read_bytes()
    truth = messages_of(content, records=False)
    at = content.rindex(HEAD.pack(Opcode.STATISTICS, 42 + 4 + 3 * 10)) + HEAD.size + 42 + 4 + 2
    path.write_bytes(content[:at + 5] + b'\x01' + content[at + 6:])
    result, = recover(path)
    assert result.lost_messages == 0
    assert messages_of(path.read_bytes(), records=False) == truth


def test_a_chunk_that_went_with_the_header_is_not_said_to_cost_nothing(tmp_path):
    path = by_the_library(tmp_path / 'x.mcap', index_types=IndexType.NONE)
    content, header_end = path.read_bytes(), 8 + 9 + 4 + 4 + 4 + len('theirs')
    path.write_bytes(content[:header_end - 8] + b'\xff' * 16 + content[header_end + 8:])
    result, = recover(path)
    assert result.messages < 900
    assert (result.certainty == 'unknown' or result.messages + result.lost_messages == 900)
