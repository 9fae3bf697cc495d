# SPDX-License-Identifier: Apache-2.0
"""Chunks composed from arrays are what the library writes of the same messages."""

import zlib

import numpy as np
import pytest
from mcap.records import Chunk, ChunkIndex, Message, MessageIndex

from rigid_body_sim.recording.mcap import chunks
from rigid_body_sim.recording.mcap.records import to_bytes

TIMES, WALL_CLOCK = np.array([30, 10, 20]), np.array([31, 12, 23])
DATA = [np.arange(12, dtype=np.uint8).reshape(3, 4), np.arange(6, dtype=np.uint8).reshape(3, 2)]
FIRST = 2**32 - 2    # of three numbers of ticks, the last is 0 again
SIZES = 31 + 4, 31 + 2
RECORDS = b''.join(to_bytes(Message(
    channel_id=channel + 1, sequence=(FIRST + k) % 2**32, log_time=int(TIMES[k]),
    publish_time=int(WALL_CLOCK[k]), data=DATA[channel][k].tobytes()))
    for k in range(3) for channel in range(2))
ENTRIES = [(channel + 1, int(TIMES[k]), 500 + k * sum(SIZES) + channel * SIZES[0])
           for k in range(3) for channel in range(2)]


def test_a_message_is_the_record_of_the_library():
    assert chunks.message(1, FIRST, 30, 31, bytes([0, 1, 2, 3])) == RECORDS[:35]


def test_ticks_are_one_message_of_each_channel_after_another():
    dtype = chunks.tick_records([4, 2])
    records, entries = chunks.ticks(dtype, FIRST, TIMES, WALL_CLOCK, DATA, 500)
    assert records == RECORDS
    assert np.frombuffer(entries, chunks.ENTRY).tolist() == ENTRIES
    assert entries == b''.join(chunks.ENTRY_BYTES(*entry) for entry in ENTRIES)


@pytest.mark.parametrize('sure', [None, True, False])
def test_a_chunk_and_its_indexes_are_the_records_of_the_library(sure):
    """Each channel has an index, in the order of their numbers, of its messages in theirs."""
    numbers, times, offsets = map(np.array, zip(*ENTRIES, strict=True))
    packed = chunks.pack(7000, 'some', b'packed', RECORDS, 3 - numbers, times, offsets,
                         **({} if sure is None else {'sure': sure}))
    checksum = 0 if sure is False else zlib.crc32(RECORDS)
    chunk = to_bytes(Chunk('some', b'packed', 30, 10, checksum, len(RECORDS)))
    indexes = [to_bytes(MessageIndex(number, [entry[1:] for entry in ENTRIES
                                              if entry[0] == 3 - number])) for number in (1, 2)]
    assert packed.data == chunk + b''.join(indexes)
    assert packed.counts == {1: 3, 2: 3}
    begin = 7000 + len(chunk)
    assert packed.index == ChunkIndex(
        chunk_length=len(chunk), chunk_start_offset=7000, compression='some', compressed_size=6,
        message_end_time=30, message_index_length=len(b''.join(indexes)),
        message_index_offsets={1: begin, 2: begin + len(indexes[0])}, message_start_time=10,
        uncompressed_size=len(RECORDS))
