# SPDX-License-Identifier: Apache-2.0
"""A whole chunk of a file, and which message indexes are those of its messages."""

import dataclasses

import numpy as np
import pytest
from mcap.records import Chunk, ChunkIndex, Schema

from rigid_body_sim.recording.mcap.chunks import message
from rigid_body_sim.recording.mcap.found import Damage, FoundChunk
from rigid_body_sim.recording.mcap.records import HEAD, to_bytes

RECORDS = b''.join(message(number, k, time, 0, b'four')
                   for k, (number, time) in enumerate(((258, 7), (3, 5), (258, 6))))
OTHER = to_bytes(Schema(1, b'', '', 'a'))
OWN = ((7, 0), (6, 70))    # time and place of each message of channel 258: a message has 35 bytes


def chunk():
    return FoundChunk(Chunk('zstd', b'packed', 7, 5, 0, 105), 1000, 90, RECORDS + OTHER)


def index(number, *entries):
    return number.to_bytes(2, 'little') + (16 * len(entries)).to_bytes(4, 'little') + np.array(
        entries, '<u8').tobytes()


def test_a_chunk_tells_its_messages_and_its_place():
    one = chunk()
    assert one.counts == {258: 2, 3: 1} and one.end == 1090
    assert one.times.tolist() == [7, 5, 6] and one.offsets.tolist() == [0, 35, 70]
    assert one.others == [(3, 105 + HEAD.size, 105 + len(OTHER))]
    assert (one.index_length, one.index_places, one.index_wrong) == (0, {}, False)
    one.takes_index(1090, index(258, *OWN))
    one.takes_index(1137, index(3, (5, 35)))
    assert one.index() == ChunkIndex(90, 1000, 'zstd', 6, 7, 15 + 32 + 15 + 16,
                                     {258: 1090, 3: 1137}, 5, 105)


@pytest.mark.parametrize(('number', 'entries', 'good'), [
    (258, OWN, True), (258, OWN[::-1], True), (3, OWN, False), (2, OWN, False),
    (258, OWN[:1], False), (258, (*OWN, OWN[0]), False), (258, ((7, 0), (6, 71)), False),
    (258, ((7, 0), (5, 70)), False),
    (258, ((8, 1), (9, 71)), False), (258, ((6, 0), (7, 70)), False), (258, (), False)])
def test_an_index_has_the_time_and_the_place_of_each_message_in_any_order(number, entries, good):
    one = chunk()
    one.takes_index(1090, index(number, *entries))
    assert one.index_places == ({258: 1090} if good else {})
    assert one.index_wrong != good and one.index_length == 15 + 16 * len(entries)


def test_a_second_index_of_a_channel_is_a_wrong_one():
    one = chunk()
    for place in (1090, 1137):
        one.takes_index(place, index(258, *OWN))
    assert one.index_places == {258: 1090} and one.index_wrong and one.index_length == 94


def test_of_a_damage_nothing_is_known_but_the_bytes_that_are_lost():
    assert dataclasses.astuple(Damage(5)) == (5, 0, 0, None, 0, 0, None, None)
