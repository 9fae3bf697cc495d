# SPDX-License-Identifier: Apache-2.0
"""Bytes of commands as they come: what is read of them, whatever the length of the frame_id."""

import struct

import pytest

from rigid_body_sim.messages import cdr
from rigid_body_sim.node.commands import decode

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
