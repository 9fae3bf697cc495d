# SPDX-License-Identifier: Apache-2.0
"""Bytes of commands as they come: what is read of them, whatever the length of the frame_id."""

import collections
import struct
import types

import numpy as np
import pytest

from rigid_body_sim.messages import cdr
from rigid_body_sim.node import commands
from rigid_body_sim.node.commands import MOST_HEADS, Commands, TakenElsewhere, decode
from rigid_body_sim.simulation.command_rows import BODY, HOLD, IMPULSE, TOPICS, WORLD

NUMBERS = (1.0, -2.0, 3.0, -4.0, 5.0, 1e-300)


def message(frame):
    force, torque = (dict(zip('xyz', part, strict=True)) for part in (NUMBERS[:3], NUMBERS[3:]))
    return cdr.encode('geometry_msgs/msg/WrenchStamped',
                      {'header': {'stamp': {'sec': 7, 'nanosec': 9}, 'frame_id': frame},
                       'wrench': {'force': force, 'torque': torque}})


@pytest.mark.parametrize('frame', ['', 'b', 'body', 'robot/1', 'robot_1/', 'a/rather/long/name'])
def test_frame_and_numbers_are_found_with_or_without_bytes_behind_them(frame):
    for data in (message(frame), message(frame) + b'\1\2\3\4'):
        found, end = decode(data)
        assert (found.decode(), end) == (frame, len(message(frame)))
        assert struct.unpack('<6d', data[end - 48:end]) == NUMBERS


@pytest.mark.parametrize(
    ('data', 'problem'),
    [(b'\0\0' + message('body')[2:], 'little-endian'), (b'', 'little-endian'),
     (message('body')[:-1], 'cut short'), (message('')[:15], 'cut short'),
     (message('body')[:12] + b'\xff\xff\xff\xff' + message('body')[16:], 'cut short')])
def test_what_is_no_message_is_none(data, problem):
    with pytest.raises(ValueError, match=problem):
        decode(data)


@pytest.fixture
def queue():
    """Return the queue of commands, and what it reports, without subscriptions."""
    queue = object.__new__(Commands)
    queue.told = []
    queue.report = lambda *told: queue.told.append(told)
    queue._axes = {b'': WORLD, b'world': WORLD, b'body': BODY}
    queue._frames = types.SimpleNamespace(body='body')
    queue.received = queue.accepted = queue.waiting = 0
    queue.refusals, queue._rows, queue._heads = collections.Counter(), [], {HOLD: {}, IMPULSE: {}}
    queue._subscriptions = [types.SimpleNamespace(topic_name=f'/{topic}') for topic in TOPICS]
    return queue


def test_rows_are_kind_axes_and_numbers_in_the_order_of_messages(queue):
    queue._receive(HOLD, [message('body'), message('')])
    queue._receive(IMPULSE, [message('world') + b'\1\2\3\4', message('body')])
    assert (queue.received, queue.accepted, queue.waiting, queue.told) == (4, 4, 4, [])
    assert queue.collect().tolist() == [
        [kind, axes, *NUMBERS] for kind, axes in
        ((HOLD, BODY), (HOLD, WORLD), (IMPULSE, WORLD), (IMPULSE, BODY))]
    assert queue.waiting == 0
    queue._receive(HOLD, [message('body')])    # its head is remembered by now
    assert queue.collect().tolist() == [[HOLD, BODY, *NUMBERS]]


def test_a_message_whose_head_is_known_is_not_looked_into(queue):
    """Senders hardly ever change more than the stamp and the numbers."""
    for frame in ('', 'body'):
        queue._receive(HOLD, [message(frame)])
    queue._examine = None
    for frame, axes in (('', WORLD), ('body', BODY)):
        data = message(frame)
        queue._receive(HOLD, [data[:4] + bytes(8) + data[12:-8] + struct.pack('<d', 5.0)])
        assert queue.collect()[-1].tolist() == [HOLD, axes, *NUMBERS[:5], 5.0]


@pytest.mark.parametrize('silent', [True, False])
def test_messages_are_taken_when_the_bell_has_rung(queue, silent):
    looked = []
    queue._bell = types.SimpleNamespace(silent=lambda: silent)
    queue.look = lambda: looked.append(1)
    queue.take()
    assert looked == [1] * (not silent)
    # and never by the executor
    assert not TakenElsewhere().can_execute(None)
    assert not TakenElsewhere().beginning_execution(None)


def test_what_is_no_command_is_refused_with_what_would_be_right(queue):
    good, cut = message('body'), message('body')[:-1]
    queue._receive(IMPULSE, [good, cut, b'\0\0' + good[2:], message('Body')])
    assert (queue.received, queue.accepted) == (4, 1)
    assert queue.refusals == {'malformed': 2, 'frame_id': 1}
    assert queue.told[0] == (TOPICS[IMPULSE], 'malformed', f'{len(cut)} bytes, cut short',
                             'a geometry_msgs/msg/WrenchStamped')
    assert queue.told[2][2] == "frame_id 'Body'"
    # the example is a command of this topic, about this body
    assert f'/{TOPICS[IMPULSE]} geometry' in queue.told[2][3] and 'frame_id: body' in (
        queue.told[2][3])


def test_more_commands_than_may_wait_are_refused_one_by_one(queue, monkeypatch):
    monkeypatch.setattr(commands, 'MOST_QUEUED', 3)
    queue._receive(HOLD, [message('body')] * 2)
    queue._receive(HOLD, [message('body'), message(''), message('')])
    assert (queue.accepted, queue.waiting, len(queue.collect())) == (3, 3, 3)
    assert queue.refusals == {'too many wait for the next tick': 2}
    queue._receive(HOLD, [message('')])
    assert queue.waiting == 1


def test_only_so_many_heads_are_remembered(queue):
    """What is behind the text of a frame_id, up to the numbers, may hold anything."""
    data = bytearray(message('body'))
    for k in range(MOST_HEADS + 3):
        data[21:24] = k.to_bytes(3, 'little')
        queue._receive(HOLD, [bytes(data)])
    assert len(queue._heads[HOLD]) == MOST_HEADS
    assert np.array_equal(queue.collect(), [[HOLD, BODY, *NUMBERS]] * (MOST_HEADS + 3))
