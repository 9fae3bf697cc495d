# SPDX-License-Identifier: Apache-2.0
"""Messages whose texts and sequences have several lengths, decoded into columns at once."""

import itertools

import numpy as np
import pytest

from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages import cdr
from rigid_body_sim.recording import columns
from rigid_body_sim.recording.columns import Decoder
from rigid_body_sim.recording.mcap.walk import MESSAGE_FIXED, MESSAGE_HEAD

POSE, JOINTS = 'geometry_msgs/msg/PoseStamped', 'sensor_msgs/msg/JointState'


def decoded(decoder, messages, names=None):
    """Return the columns of messages that lie in records, one after the other."""
    data = [cdr.encode(decoder.type_name, message) for message in messages]
    lengths = np.array([MESSAGE_FIXED + len(one) for one in data])
    records = b''.join(b'\xff' * MESSAGE_HEAD.size + one for one in data)
    ends = np.cumsum([MESSAGE_HEAD.size + len(one) for one in data])
    return decoder.columns(records, np.array([0, *ends[:-1]]), lengths, names)


def pose(k, frame):
    return {'header': {'frame_id': frame, 'stamp': {'sec': k, 'nanosec': 7}},
            'pose': {'position': {'x': float(k), 'y': 0.5}, 'orientation': {'w': -float(k)}}}


@pytest.mark.parametrize('frames', [
    ['a'], ['a', 'a'], ['a', 'bb', 'a'], ['ccc', 'a', 'bb', 'bb', 'ccc', 'a', 'dddd']])
def test_messages_of_several_lengths_keep_their_order(frames):
    decoder = Decoder(POSE)
    for _ in range(2):    # the second time its layouts are known
        found = decoded(decoder, [pose(k, frame) for k, frame in enumerate(frames)])
        count = len(frames)
        assert found['header.stamp'].tolist() == [k * 10 ** 9 + 7 for k in range(count)]
        assert found['header.frame_id'].tolist() == [frame.encode() for frame in frames]
        assert found['pose.position'].tolist() == [[float(k), 0.5, 0.0] for k in range(count)]
        assert found['pose.orientation'].tolist() == [
            [0.0, 0.0, 0.0, -float(k)] for k in range(count)]
    assert decoder.components['pose.orientation'] == ['x', 'y', 'z', 'w']
    assert len(decoder._layouts) == len(set(frames))    # each is made once


def joints(k, names, positions=()):
    return {'name': names, 'position': [float(k + j) for j in range(positions)],
            'velocity': [-float(k)]}


def test_messages_of_one_length_may_have_several_forms():
    """A text longer by eight bytes and a sequence shorter by a double: the sizes are the same."""
    forms = [joints(0, ['a' * 3], 2), joints(1, ['a' * 11], 1), joints(2, ['a' * 3], 2),
             joints(3, ['a' * 11], 1)]
    assert len({len(cdr.encode(JOINTS, form)) for form in forms}) == 1
    decoder = Decoder(JOINTS)
    for some in (forms, forms[1:]):
        found = decoded(decoder, some)
        assert found['velocity'].tolist() == [one['velocity'] for one in some]
        assert 'position' not in found
    assert decoded(decoder, forms[::2])['position'].tolist() == [[0.0, 1.0], [2.0, 3.0]]
    assert decoded(decoder, forms, ['velocity']).keys() == {'velocity'}
    with pytest.raises(BadInput, match='position: sequences of different lengths'):
        decoded(decoder, forms, ['velocity', 'position'])
    with pytest.raises(BadInput, match="a message without a column 'effort'"):
        decoded(decoder, forms, ['effort'])


def test_as_many_forms_as_are_taken_and_one_more(monkeypatch):
    monkeypatch.setattr(columns, '_MOST_LAYOUTS', 3)
    lengths = 'a', 'a' * 9, 'a' * 17, 'a' * 25
    for order in itertools.permutations(lengths[:3]):
        found = decoded(Decoder(POSE), [pose(k, frame) for k, frame in enumerate(order)])
        assert found['pose.position'][:, 0].tolist() == [0.0, 1.0, 2.0]
    with pytest.raises(BadInput, match='messages of many different forms; decode them'):
        decoded(Decoder(POSE), [pose(k, frame) for k, frame in enumerate(lengths)])


def test_without_a_choice_columns_are_those_of_all_messages():
    """The shorter message has a value more."""
    status = Decoder('diagnostic_msgs/msg/DiagnosticStatus')
    found = decoded(status, [{'level': 1, 'name': 'n' * 99},
                             {'level': 2, 'name': 'a', 'values': [{'key': 'k', 'value': 'v'}]}])
    assert found['level'].tolist() == [1, 2]
    assert found.keys() == {'level', 'name'}
