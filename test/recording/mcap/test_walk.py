# SPDX-License-Identifier: Apache-2.0
"""The fast walk over records against one that takes them one by one."""

import random
import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.records import Schema

from rigid_body_sim.recording.mcap import chunks
from rigid_body_sim.recording.mcap.records import HEAD, to_bytes
from rigid_body_sim.recording.mcap.walk import Cut, heads, walk


def one_by_one(records):
    """Return (message offsets, others, whole) the slow way."""
    position, offsets, others = 0, [], []
    while position + 9 <= len(records):
        opcode, length = struct.unpack_from('<BQ', records, position)
        end = position + 9 + length
        if end > len(records) or opcode == 0 or (opcode == 5 and length < 22):
            break
        if opcode == 5:
            offsets.append(position)
        else:
            others.append((opcode, position + 9, end))
        position = end
    return offsets, others, position


KINDS = st.lists(st.tuples(st.integers(1, 3), st.integers(0, 3)), min_size=1, max_size=8)


def message(channel, size, sequence):
    return chunks.message(channel, sequence, 10**9 + sequence, 7, bytes(size))


@given(
    runs=st.lists(st.tuples(KINDS, st.integers(1, 12), st.booleans()), max_size=6),
    cut=st.integers(0, 60),
)
@settings(deadline=None, max_examples=300)
def test_runs_of_ticks_broken_by_other_records(runs, cut):
    records, sequence = b'', 0
    for tick, repeats, other in runs:
        for _ in range(repeats):
            for channel, size in tick:
                records += message(channel, size, sequence)
                sequence += 1
        if other:
            records += to_bytes(Schema(1, b'', 'ros2msg', 'a/msg/B'))
    records = records[:len(records) - cut]
    offsets, others, whole = one_by_one(records)
    if whole == len(records):
        found = walk(records)
    else:
        with pytest.raises(Cut) as caught:
            walk(records)
        assert caught.value.whole == whole
        found = caught.value.found
    assert found[0].tolist() == offsets
    assert found[1] == others


def test_any_order_of_topics_is_walked():
    random.seed(3)
    records = b''.join(
        message(random.randrange(4), random.choice((8, 8, 8, 9)), sequence)
        for sequence in range(3000)
    )
    offsets, _ = walk(records)
    assert offsets.tolist() == one_by_one(records)[0]
    assert heads(records, offsets)['sequence'].tolist() == list(range(3000))


def test_heads_are_what_was_written():
    records = chunks.message(3, 4, 5, 6, b'seven') * 9
    found = heads(records, walk(records)[0])
    assert set(found.tolist()) == {(5, 27, 3, 4, 5, 6)}


def test_tick_of_more_messages_than_are_remembered():
    tick = b''.join(message(channel, 8, 0) for channel in range(100))
    assert np.array_equal(walk(tick * 20)[0], np.arange(2000) * len(tick) // 100)


@pytest.mark.parametrize(
    'junk', [b'\x05', b'\0' * 40, b'\x05' + b'\xff' * 30, HEAD.pack(5, 21) + bytes(21)]
)
def test_junk_after_messages_is_cut_off(junk):
    records = message(1, 8, 0) * 10
    with pytest.raises(Cut) as caught:
        walk(records + junk)
    assert caught.value.whole == len(records)
    assert len(caught.value.found[0]) == 10
