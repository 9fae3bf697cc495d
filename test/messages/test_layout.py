# SPDX-License-Identifier: Apache-2.0
"""Fast paths against the plain encoder: from numbers, from columns, and back."""

import struct

import numpy as np
import pytest

from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages.cdr import decode, encode
from rigid_body_sim.messages.definitions import parse, schema
from rigid_body_sim.messages.layout import Layout, Packer

POSE = (
    'geometry_msgs/msg/PoseStamped',
    {'header': {'frame_id': 'world'}},
    ('header.stamp', 'pose'),
)
IMU = ('sensor_msgs/msg/Imu', {'header': {'frame_id': 'racket/body'}},
       ('header.stamp', 'orientation', 'angular_velocity', 'linear_acceleration'))
ODOMETRY = (
    'nav_msgs/msg/Odometry',
    {'header': {'frame_id': 'w'}, 'child_frame_id': 'body'},
    ('header.stamp', 'pose.pose', 'twist.twist'),
)
JOINT = (
    'sensor_msgs/msg/JointState',
    {'name': ['hinge'], 'position': [0.0], 'velocity': [0.0]},
    ('header.stamp', 'position', 'velocity'),
)
TRANSFORM = ('tf2_msgs/msg/TFMessage', {'transforms': [{'child_frame_id': 'body'}]},
             ('transforms[0].header.stamp', 'transforms[0].transform'))


@pytest.mark.parametrize('case', [POSE, IMU, ODOMETRY, JOINT, TRANSFORM], ids=lambda case: case[0])
def test_one_message_is_what_the_encoder_makes(case):
    type_name, constants, _ = case
    packer = Packer(*case)
    numbers = [float(number) for number in range(2, packer.count)]
    message = packer.pack(-1, 250_000_000, *numbers)
    decoded = decode(schema(type_name), type_name, message)
    assert encode(type_name, decoded) == message
    blank = decode(schema(type_name), type_name, encode(type_name, constants))
    assert _numbers(decoded, blank) == [-1, 250_000_000, *numbers]


def _numbers(value, blank):
    """All numbers in `value` that differ from those in `blank`, in order."""
    if isinstance(value, dict):
        return [number for name in value for number in _numbers(value[name], blank[name])]
    if isinstance(value, list):
        return [
            number
            for one, other in zip(value, blank, strict=True)
            for number in _numbers(one, other)
        ]
    return [] if value == blank else [value]


def test_many_messages_are_the_same_bytes_as_one_by_one():
    packer = Packer(*POSE)
    random = np.random.default_rng(1)
    stamps = random.integers(-10**18, 2 * 10**18, 50)
    positions, orientations = random.normal(size=(50, 3)), random.normal(size=(50, 4))
    rows = packer.pack_many(
        {'header.stamp': stamps, 'pose.position': positions, 'pose.orientation': orientations}
    )
    assert rows.shape == (50, packer.size)
    for row, stamp, position, orientation in zip(
        rows, stamps.tolist(), positions, orientations, strict=True
    ):
        assert row.tobytes() == packer.pack(*divmod(stamp, 10**9), *position, *orientation)


@pytest.mark.parametrize('case', [POSE, IMU, ODOMETRY, JOINT, TRANSFORM], ids=lambda case: case[0])
def test_columns_come_back(case):
    packer = Packer(*case)
    random = np.random.default_rng(2)
    columns = packer.layout.unpack(packer.pack_many({packer.layout.columns[0]: np.arange(7)}))
    given = {
        name: random.integers(0, 10**18, 7)
        if column.dtype == np.int64
        else random.normal(size=column.shape)
        for name, column in columns.items()
        if column.dtype.kind != 'S'
    }
    back = packer.layout.unpack(packer.pack_many(given))
    for name, column in given.items():
        np.testing.assert_array_equal(back[name], column)


def test_columns_are_named_and_shaped_as_documented():
    columns = Packer(*POSE).layout.unpack(
        Packer(*POSE).pack_many({'header.stamp': np.zeros(3, int)})
    )
    assert {name: column.shape for name, column in columns.items()} == {
        'header.stamp': (3,),
        'header.frame_id': (3,),
        'pose.position': (3, 3),
        'pose.orientation': (3, 4),
    }
    assert columns['header.frame_id'].tolist() == [b'world'] * 3
    assert Packer(*POSE).layout.components['pose.orientation'] == ['x', 'y', 'z', 'w']


def test_messages_of_another_form_do_not_fit():
    type_name = POSE[0]
    one, other = (
        encode(type_name, {'header': {'frame_id': frame}}) for frame in ('world', 'earth')
    )
    longer = encode(type_name, {'header': {'frame_id': 'worlds'}})
    assert len(longer) == len(
        one
    )  # the padding hides the difference; the length of the string tells
    rows = np.array([list(one), list(longer), list(other)], np.uint8)
    assert Layout(schema(type_name), type_name, one).fits(rows).tolist() == [True, False, True]


def test_wrong_number_of_numbers_is_an_error():
    with pytest.raises(struct.error, match='takes 9 numbers here, got 8'):
        Packer(*POSE).pack(*range(8))


def test_unknown_variable_is_refused():
    with pytest.raises(BadInput, match=r'none of header\.stamp is a number in it; some of data'):
        Packer('std_msgs/msg/Float64', {}, ('header.stamp',))


def test_a_struct_that_only_resembles_a_time_keeps_its_numbers():
    """As in the definition of a stranger, or in a damaged one."""
    schemas = parse('a/msg/B', f'T t\n{"=" * 80}\nMSG: a/T\nint32 sec\nuint32 nanosed\n')
    layout = Layout(schemas, 'a/msg/B', b'\0\1\0\0' + bytes(8))
    rows = np.frombuffer(b'\0\1\0\0' + b'\5\0\0\0\7\0\0\0', np.uint8)[np.newaxis]
    assert {name: column.tolist() for name, column in layout.unpack(rows).items()} == {
        't.sec': [5], 't.nanosed': [7]}
