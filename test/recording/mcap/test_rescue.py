# SPDX-License-Identifier: Apache-2.0
"""Records of which some may be wrong, beside their message indexes."""

import zlib

import numpy as np
import pytest
from mcap.records import Channel, Schema

from rigid_body_sim.recording.mcap import chunks, rescue
from rigid_body_sim.recording.mcap.bytes import MemoryBytes
from rigid_body_sim.recording.mcap.compression import compressor
from rigid_body_sim.recording.mcap.records import to_bytes
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


def test_data_that_does_not_end_ends_where_the_index_of_the_file_says():
    """Behind each of three lengths a record begins; the one of the index is the last of them."""
    packed = compressor('zstd')(RECORDS)[:-5]
    source, size = MemoryBytes(packed + 4 * RECORDS[:SIZE]), len(packed)
    lengths = [size, size + 2 * SIZE, size + SIZE]
    claims = len(RECORDS), zlib.crc32(RECORDS)
    for count in (1, 2, 3):
        found = rescue._packed(source, 0, 'zstd', lengths[:count], claims, False)
        assert found[0] is None
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
