# SPDX-License-Identifier: Apache-2.0
"""Records of which some may be wrong, beside their message indexes."""

import zlib

import numpy as np
import pytest
from mcap.records import Channel, Chunk, ChunkIndex, MessageIndex, Schema

from rigid_body_sim.recording.mcap import chunks, rescue
from rigid_body_sim.recording.mcap.bytes import MemoryBytes
from rigid_body_sim.recording.mcap.compression import compressor
from rigid_body_sim.recording.mcap.records import HEAD, to_bytes
from rigid_body_sim.recording.mcap.walk import walk

RECORDS = b''.join(chunks.message(1 + k % 2, k, 10**9 + k, 7, bytes(8)) for k in range(4))
SIZE = len(RECORDS) // 4
CHANNEL, TIME = 9, 15    # of a record of a message: the places of their first bytes


def entries():
    found = np.empty(4, [('channel', '<u2'), ('time', '<u8'), ('offset', '<u8')])
    found['channel'], found['offset'] = [1, 2, 1, 2], SIZE * np.arange(4)
    found['time'] = 10**9 + np.arange(4)
    return found


@pytest.mark.parametrize('place', [CHANNEL, CHANNEL + 1, TIME, TIME + 7])
@pytest.mark.parametrize('number', range(4))
def test_one_wrong_byte_of_one_head_is_mended_by_the_indexes(number, place):
    wrong = bytearray(RECORDS)
    wrong[number * SIZE + place] ^= 4
    records, offsets, others = rescue._sift(bytes(wrong), entries())
    assert (records, offsets.tolist(), others) == (RECORDS, [SIZE * k for k in range(4)], [])


def test_records_that_agree_with_their_indexes_are_returned_as_they_are():
    records, offsets, others = rescue._sift(RECORDS, entries())
    assert records is RECORDS
    assert (offsets.tolist(), others) == ([SIZE * k for k in range(4)], [])


@pytest.mark.parametrize('name', ['channel', 'time', 'offset'])
@pytest.mark.parametrize('number', [0, 3])
def test_records_of_which_one_is_not_as_its_index_says_do_not_agree(name, number):
    offsets, wrong = SIZE * np.arange(4), entries()
    wrong[name][number] += 1
    assert rescue._agree(RECORDS, offsets, entries())
    assert not rescue._agree(RECORDS, offsets, wrong)
    assert not rescue._agree(RECORDS, offsets, entries()[:3])


def test_schemas_and_channels_among_the_messages_do_not_become_part_of_them():
    """They come first, as they are; each message ends where the first of them behind it begins."""
    described = [to_bytes(Schema(1, b'float64 data', 'ros2msg', 'a/B')),
                 *(to_bytes(Channel(number, '/x', 'cdr', {}, 1)) for number in (1, 2))]
    messages = [RECORDS[k * SIZE:(k + 1) * SIZE] for k in range(4)]
    mixed = bytearray(b''.join([messages[0], *described[:2], messages[1], described[2],
                                *messages[2:]]))
    found = entries()
    found['offset'] = walk(bytes(mixed))[0]
    mixed[found['offset'][3] + TIME] ^= 4
    records, offsets, others = rescue._sift(bytes(mixed), found)
    assert records == b''.join([*described, *messages])
    whole_offsets, whole_others = walk(records)
    assert (offsets.tolist(), others) == (whole_offsets.tolist(), whole_others)


def test_without_indexes_what_is_wrong_is_passed_over_each_time():
    """Also where the last byte before it and what is wrong would make a record together."""
    last = chunks.message(1, 9, 10**9, 7, bytes(7) + b'\x05')
    wrong = (256).to_bytes(8, 'little') + bytes(256)
    good = [last, RECORDS, RECORDS + last, RECORDS]
    records, offsets, others = rescue._sift(wrong.join(good), None)
    assert records == b''.join(good)
    assert (len(offsets), others) == (14, [])


@pytest.mark.parametrize('name', ['zstd', 'lz4'])
def test_data_is_decompressed_up_to_the_limit(name):
    content = bytes(400_000)
    packed = compressor(name)(content)
    assert rescue.decompress(name, packed, 400_000) == (content, len(packed))
    assert rescue.decompress(name, packed + b'more', 400_000) == (content, len(packed))
    assert rescue.decompress(name, packed, 399_999)[1] == 0
    assert rescue.decompress(name, packed[:-5], 500_000)[1] == 0
    records, length = rescue.decompress(name, packed, 100_000)
    assert length == 0
    assert len(records) <= 100_000 + 2**16    # a step beyond


@pytest.mark.parametrize('name', ['zstd', 'lz4'])
def test_data_of_whole_steps_is_decompressed_up_to_the_limit(name):
    for more in (0, 1):
        packed = compressor(name)(bytes(2**17 + more))
        assert rescue.decompress(name, packed, 2**17)[1] == (0 if more else len(packed))


@pytest.mark.parametrize('shift', [0, 8, 16, 24])
def test_a_checksum_with_one_wrong_byte_is_still_believed_and_with_two_is_not(shift):
    checksum = zlib.crc32(RECORDS)
    assert rescue._right(RECORDS, checksum)
    assert rescue._right(RECORDS, checksum ^ 0xa5 << shift)
    assert not rescue._right(RECORDS, checksum ^ 0xa5 << shift ^ 1 << (shift + 8) % 32)


@pytest.mark.parametrize('more', [-1, 0, 1])
def test_without_a_checksum_the_number_of_bytes_vouches_for_the_records(more):
    packed = compressor('zstd')(RECORDS)
    found = rescue._packed(MemoryBytes(packed + RECORDS), 0, 'zstd', [len(packed)],
                           (len(RECORDS) + more, 0), False)
    assert found == (packed, RECORDS, more == 0, len(packed))
    assert found == rescue._packed(MemoryBytes(packed), 0, 'zstd', [len(packed)],
                                   (len(RECORDS) + more, 0), False)


def test_data_that_does_not_end_ends_where_the_index_of_the_file_says():
    """Behind each of three lengths a record begins; the one of the index is the last of them."""
    packed = compressor('zstd')(RECORDS)[:-5]
    source, size = MemoryBytes(packed + 4 * RECORDS[:SIZE]), len(packed)
    lengths = [size, size + 2 * SIZE, size + SIZE]
    claims = len(RECORDS), zlib.crc32(RECORDS)
    for count in (1, 2, 3):
        found = rescue._packed(source, 0, 'zstd', lengths[:count], claims, False)
        assert found[0] is None
        assert not found[2]    # no checksum of all is that of a part
        assert found[3] == lengths[count - 1]
    assert rescue._packed(source, 0, 'zstd', [size + 1], claims, False) is None
    assert rescue._packed(source, 0, 'zstd', [size + 1], claims, True)[3] == source.size


def test_of_two_lengths_of_plain_records_the_one_that_ends_first_is_taken():
    source, claims = MemoryBytes(RECORDS), (0, 0)
    for lengths in ([SIZE, 2 * SIZE], [2 * SIZE, SIZE]):
        found = rescue._plain(source, 0, '', lengths, claims, False)
        assert found == (None, RECORDS[:SIZE], False, SIZE)
    assert rescue._plain(source, 0, '', [SIZE + 1], claims, False) is None
    assert rescue._plain(source, SIZE, '', [SIZE + 1], claims, True) == (
        None, RECORDS[SIZE:], False, len(RECORDS))
    right = rescue._plain(source, 0, '', [SIZE, 2 * SIZE],
                          (0, zlib.crc32(RECORDS[:2 * SIZE])), False)
    assert right == (RECORDS[:2 * SIZE], RECORDS[:2 * SIZE], True, 2 * SIZE)


def test_plain_records_end_with_the_file_or_before_a_record_and_not_beyond(monkeypatch):
    whole = rescue._plain(MemoryBytes(RECORDS), 0, '', [4 * SIZE], (0, 0), False)
    assert whole == (None, RECORDS, False, 4 * SIZE)
    source = MemoryBytes(RECORDS[:2 * SIZE] + bytes(20))
    assert rescue._plain(source, 0, '', [SIZE], (0, 0), False)[3] == SIZE
    rest = RECORDS[SIZE:]
    claims = 0, zlib.crc32(rest)
    assert rescue._plain(MemoryBytes(RECORDS), SIZE, '', [3 * SIZE + 1], claims, False) is None
    for most in (3 * SIZE, 3 * SIZE - 1):
        monkeypatch.setattr(rescue, 'LARGEST_CHUNK', most)
        found = rescue._plain(MemoryBytes(RECORDS), SIZE, '', [9], (0, 0), True)
        assert (found and found[1]) == (rest if most == 3 * SIZE else None)


def test_without_indexes_one_wrong_byte_between_records_is_passed_over():
    records, offsets, others = rescue._sift(b'\0'.join(3 * [RECORDS]), None)
    assert (records, len(offsets), others) == (3 * RECORDS, 12, [])


def test_messages_without_data_are_whole_by_their_indexes():
    empty = b''.join(chunks.message(1, k, 10**9 + k, 7, b'') for k in range(4))
    found, wrong = entries(), bytearray(empty)
    found['channel'], found['offset'] = 1, 31 * np.arange(4)
    wrong[TIME] ^= 4
    assert rescue._sift(bytes(wrong), found)[0] == empty
    records, offsets, others = rescue._sift(empty[:30], found)
    assert (records, offsets.tolist(), others) == (b'', [], [])


def test_private_records_among_messages_are_left_out_where_one_is_wrong():
    private = HEAD.pack(0x80, 3) + b'own'
    mixed = bytearray(RECORDS[:SIZE] + private + RECORDS[SIZE:])
    found = entries()
    found['offset'] = walk(bytes(mixed))[0]
    mixed[TIME] ^= 4
    records, offsets, others = rescue._sift(bytes(mixed), found)
    assert len(offsets) == 4 and others == []
    assert records[SIZE + len(private):] == RECORDS[SIZE:]    # what is in between has no place


def test_a_place_within_the_head_of_another_message_leaves_that_out():
    found = entries()
    found['offset'][2] = SIZE + 10
    records, offsets, others = rescue._sift(RECORDS, found)
    assert walk(records)[0].tolist() == offsets.tolist()
    assert (len(offsets), others) == (3, [])


@pytest.mark.parametrize(('zstd', 'lz4', 'plain', 'best'), [
    ((False, 3), (False, 5), None, 'lz4'), ((False, 5), (False, 3), None, 'zstd'),
    ((False, 5), (False, 5), None, 'zstd'), ((False, 5), (True, 3), (True, 9), 'lz4'),
    ((False, 5), None, (True, 3), ''), (None, None, (False, 3), None)])
def test_the_surer_reading_of_a_chunk_is_taken_then_the_longer(
        zstd, lz4, plain, best, monkeypatch):
    """Its lengths tell of zstd, its index of lz4; of none at all only its opcode."""
    readings = {'zstd': zstd, 'lz4': lz4, '': plain}

    def reading(_source, _begin, name, *_):
        found = readings[name]
        return found and (name.encode(), bytes(found[1]), found[0], 99)
    monkeypatch.setattr(rescue, '_packed', reading)
    monkeypatch.setattr(rescue, '_plain', reading)
    record = to_bytes(Chunk('zstd', RECORDS, 900, 5, 0, 0))
    hint = ChunkIndex(0, 0, 'lz4', 1, 77, 0, {}, 66, 55)
    found = rescue._best(MemoryBytes(record), 0, hint, False)
    assert found == (None if best is None else (
        best, best.encode(), bytes(readings[best][1]), readings[best][0], 99))


INDEXES = [to_bytes(MessageIndex(number, [(10**9 + k, k * SIZE) for k in range(number - 1, 4, 2)]))
           for number in (1, 2)]
BEHIND = [(1, 10**9, 0), (2, 10**9 + 1, SIZE), (1, 10**9 + 2, 2 * SIZE),
          (2, 10**9 + 3, 3 * SIZE)]


def test_entries_behind_a_chunk_are_those_of_its_indexes_by_their_places():
    source = MemoryBytes(b'chunk' + INDEXES[1] + INDEXES[0] + RECORDS)
    assert rescue.entries_behind(source, 5).tolist() == BEHIND
    assert rescue.entries_behind(MemoryBytes(INDEXES[0]), 0).tolist() == BEHIND[::2]
    high = to_bytes(MessageIndex(258, [(5, 7)]))
    assert rescue.entries_behind(MemoryBytes(high), 0).tolist() == [(258, 5, 7)]


@pytest.mark.parametrize('content', [
    b'', RECORDS, INDEXES[0][:14], INDEXES[0][:-1], INDEXES[0] + INDEXES[1][:-1],
    INDEXES[0][:1] + b'\x27' + INDEXES[0][2:]])
def test_entries_behind_a_chunk_are_none_where_an_index_makes_no_sense(content):
    """None of all, the first or the second is cut, or its two lengths do not agree."""
    assert rescue.entries_behind(MemoryBytes(content), 0) is None


PLACES = {'opcode': 0, 'length': 1, 'start': 9, 'claimed': 25, 'checksum': 33, 'name': 37}


def made(name, *wrong, checksum=None, hint=None):
    """Return a chunk behind ten bytes and before its indexes; of the fields `wrong` a byte is."""
    data = compressor(name)(RECORDS) if name else RECORDS
    checksum = zlib.crc32(RECORDS) if checksum is None else checksum
    record = bytearray(to_bytes(Chunk(name, data, 900, 5, checksum, len(RECORDS))))
    for field in wrong:
        record[PLACES[field] if field in PLACES else
               41 + len(name) + 7 * (field == 'high')] ^= 0x10    # of the length of the data
    source = MemoryBytes(bytes(10) + bytes(record) + b''.join(INDEXES) + RECORDS)
    told = hint and ChunkIndex(len(record), 10, hint, len(data), 77, 0, {}, 66, 55)
    return rescue.rescue(source, 10, told), data, 10 + len(record)


@pytest.mark.parametrize('wrong', [
    (), ('opcode',), ('length',), ('start',), ('claimed',), ('checksum',), ('name',), ('data',)])
@pytest.mark.parametrize('name', ['zstd', 'lz4', ''])
def test_a_chunk_with_one_wrong_byte_in_its_head_is_read_whole(name, wrong):
    for hint in (None, name or None):
        found, data, end = made(name, *wrong, hint=hint)
        assert (found.end, found.compression, found.compressed) == (end, name, data)
        assert (found.records, found.others, found.sure) == (RECORDS, [], True)
        assert found.offsets.tolist() == [SIZE * k for k in range(4)]
        assert found.expected == {1: 2, 2: 2}
        assert found.claimed == (55 if hint else len(RECORDS) ^ (0x10 * ('claimed' in wrong)))
        assert found.span == ((66, 77) if hint else (5 ^ (0x10 * ('start' in wrong)), 900))


@pytest.mark.parametrize(('name', 'wrong', 'hint', 'good'), [
    ('', (), None, True), ('', ('opcode',), None, False), ('', ('length',), None, False),
    ('', ('opcode',), 'zstd', False), ('', ('high',), None, False),
    ('zstd', ('opcode',), None, True), ('zstd', ('length',), None, True),
    ('zstd', ('name',), None, True), ('zstd', ('name', 'length', 'opcode'), 'zstd', True),
    ('zstd', ('opcode', 'name'), None, False), ('zstd', ('opcode', 'length'), None, False),
    ('zstd', ('name', 'length'), None, False), ('zstd', ('name', 'opcode'), 'lz4', False)])
def test_without_a_checksum_two_signs_tell_that_it_is_a_chunk(name, wrong, hint, good):
    """Its opcode, the name of a compression, and two equal lengths; one in the index is enough."""
    found, _, end = made(name, 'claimed', *wrong, checksum=0, hint=hint)
    assert (found is not None) == good
    if good:
        assert (found.end, found.records, found.sure) == (end, RECORDS, False)


def test_of_a_chunk_that_is_cut_in_its_head_nothing_is_read():
    record = to_bytes(Chunk('', RECORDS, 900, 5, 0, len(RECORDS)))
    assert rescue.rescue(MemoryBytes(record[:40]), 0, cut=True) is None
    assert rescue.rescue(MemoryBytes(record[:41]), 0, cut=True) is None
    assert rescue.rescue(MemoryBytes(record[:49 + SIZE + 5]), 0) is None
    cut = rescue.rescue(MemoryBytes(record[:49 + SIZE + 5]), 0, cut=True)
    assert (cut.records, cut.compressed, cut.sure) == (RECORDS[:SIZE], None, False)
    assert (cut.expected, cut.end) == (None, 49 + SIZE + 5)


@pytest.mark.parametrize('checksum', ['of the records', 'another', 'none'])
def test_a_message_that_its_index_mends_is_sure_if_the_checksum_is_that_of_the_mended(checksum):
    wrong = bytearray(RECORDS)
    wrong[SIZE + TIME] ^= 4
    claim = {'of the records': zlib.crc32(RECORDS), 'another': 99, 'none': 0}[checksum]
    record = to_bytes(Chunk('', bytes(wrong), 900, 5, claim, len(RECORDS)))
    found = rescue.rescue(MemoryBytes(record + b''.join(INDEXES)), 0)
    assert (found.records, found.compressed) == (RECORDS, None)
    assert found.sure == (checksum == 'of the records')
