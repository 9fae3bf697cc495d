# SPDX-License-Identifier: Apache-2.0
"""Columns of numbers from many messages at once."""

import struct

import numpy as np
import pytest
from packing import Packed

from rigid_body_sim.messages.cdr import encode
from rigid_body_sim.messages.definitions import parse, schema
from rigid_body_sim.messages.layout import Layout

POSE = ('geometry_msgs/msg/PoseStamped', {'header': {'frame_id': 'world'}})
IMU = ('sensor_msgs/msg/Imu', {'header': {'frame_id': 'racket/body'}})
ODOMETRY = ('nav_msgs/msg/Odometry', {'header': {'frame_id': 'w'}, 'child_frame_id': 'body'})
JOINT = ('sensor_msgs/msg/JointState', {'name': ['hinge'], 'position': [0.0], 'velocity': [0.0]})
TRANSFORM = ('tf2_msgs/msg/TFMessage', {'transforms': [{'child_frame_id': 'body'}]})


@pytest.mark.parametrize('case', [POSE, IMU, ODOMETRY, JOINT, TRANSFORM], ids=lambda case: case[0])
def test_columns_come_back(case):
    packed = Packed(*case)
    random = np.random.default_rng(2)
    columns = packed.layout.unpack(packed.pack_many({packed.layout.columns[0]: np.arange(7)}))
    given = {name: random.integers(0, 10**18, 7) if column.dtype == np.int64
             else random.normal(size=column.shape)
             for name, column in columns.items() if column.dtype.kind != 'S'}
    back = packed.layout.unpack(packed.pack_many(given))
    for name, column in given.items():
        np.testing.assert_array_equal(back[name], column)


def test_columns_are_named_and_shaped_as_documented():
    packed = Packed(*POSE)
    columns = packed.layout.unpack(packed.pack_many({'header.stamp': np.zeros(3, int)}))
    assert {name: column.shape for name, column in columns.items()} == {
        'header.stamp': (3,), 'header.frame_id': (3,), 'pose.position': (3, 3),
        'pose.orientation': (3, 4)}
    assert columns['header.frame_id'].tolist() == [b'world'] * 3
    assert packed.layout.components['pose.orientation'] == ['x', 'y', 'z', 'w']


def test_messages_of_another_form_do_not_fit():
    type_name = POSE[0]
    one, other = (encode(type_name, {'header': {'frame_id': frame}})
                  for frame in ('world', 'earth'))
    longer = encode(type_name, {'header': {'frame_id': 'worlds'}})
    # padding makes the sizes equal; only the length of the string differs
    assert len(longer) == len(one)
    rows = np.array([list(one), list(longer), list(other)], np.uint8)
    layout = Layout(schema(type_name), type_name, one)
    assert layout.fits(rows).tolist() == [True, False, True]
    changed = rows[:1] ^ np.eye(len(one), dtype=np.uint8)
    # two bytes tell the encoding, and four, behind the time, the length of the string
    assert np.flatnonzero(~layout.fits(changed)).tolist() == [0, 1, 12, 13, 14, 15]


def test_a_damaged_length_or_byte_order_does_not_fit_but_options_do():
    """Of the encapsulation the first two bytes tell the encoding, the others are options."""
    message = encode('std_msgs/msg/String', {'data': 'world'})
    rows = np.array([list(message)] * 9, np.uint8)
    rows[np.arange(8), np.arange(8)] += 1
    assert Layout(schema('std_msgs/msg/String'), 'std_msgs/msg/String', message).fits(
        rows).tolist() == [False, False, True, True, False, False, False, False, True]


def test_columns_of_every_kind_of_field():
    """Structs of one double, of two and of mixed types; arrays; what is empty has no column."""
    line = '=' * 80
    schemas = parse('a/msg/All', f"""
One one
Two two
Mixed mixed
Time when
int32[2] array
string empty
string text
float64[] none
float32[] single
{line}\nMSG: a/One\nfloat64 x
{line}\nMSG: a/Two\nfloat64 x\nfloat64 y
{line}\nMSG: a/Mixed\nfloat64 x\nint32 n
{line}\nMSG: a/Time\nint32 sec\nuint32 nanosec
""")
    # nanoseconds beyond the half of their range occur in damaged recordings
    message = b'\0\1\0\0' + struct.pack('<d2ddiiI2iIs3xI4sIIf', 1.5, 2.5, 3.5, 4.5, 5, 6,
                                        4_000_000_000, 7, 8, 1, b'', 4, b'abc', 0, 1, 9.5)
    layout = Layout(schemas, 'a/msg/All', message)
    rows = np.frombuffer(message, np.uint8)[np.newaxis]
    assert {name: column.tolist() for name, column in layout.unpack(rows).items()} == {
        'one.x': [1.5], 'two': [[2.5, 3.5]], 'mixed.x': [4.5], 'mixed.n': [5],
        'when': [10_000_000_000], 'array': [[7, 8]], 'text': [b'abc'], 'single': [[9.5]]}
    assert layout.columns == ['one.x', 'two', 'mixed.x', 'mixed.n', 'when', 'array', 'text',
                              'single']
    assert layout.components == {'two': ['x', 'y']}


def test_a_struct_that_only_resembles_a_time_keeps_its_numbers():
    """Such fields occur in foreign or damaged definitions."""
    schemas = parse('a/msg/B', f'T t\n{"=" * 80}\nMSG: a/T\nint32 sec\nuint32 nanosed\n')
    layout = Layout(schemas, 'a/msg/B', b'\0\1\0\0' + bytes(8))
    rows = np.frombuffer(b'\0\1\0\0' + b'\5\0\0\0\7\0\0\0', np.uint8)[np.newaxis]
    assert {name: column.tolist() for name, column in layout.unpack(rows).items()} == {
        't.sec': [5], 't.nanosed': [7]}


@pytest.mark.parametrize(('fields', 'columns'), [
    ('float64 x', {'t.x': ('<f8', ())}), ('float64 x\nfloat64 y', {'t': ('<f8', (2,))}),
    ('float64[3] x', {'t.x': ('<f8', (3,))}), ('float64[1] x', {'t.x': ('<f8', ())}),
    ('float64 x\nfloat64[2] y', {'t.x': ('<f8', ()), 't.y': ('<f8', (2,))}),
    ('float64 x\nint32 y', {'t.x': ('<f8', ()), 't.y': ('<i4', ())})])
def test_two_or_more_doubles_of_a_struct_are_one_column(fields, columns):
    schemas = parse('a/msg/B', f'T t\n{"=" * 80}\nMSG: a/T\n{fields}\n')
    layout = Layout(schemas, 'a/msg/B', b'\0\1\0\0' + bytes(24))
    rows = np.zeros((1, layout.size), np.uint8)
    assert {name: (column.dtype.str, column.shape[1:])
            for name, column in layout.unpack(rows).items()} == columns
    assert list(layout.components) == [name for name in columns if name == 't']


def test_an_empty_sequence_is_no_column():
    layout = Layout(parse('a/msg/B', 'int32 x\nfloat64[] y\n'), 'a/msg/B',
                    b'\0\1\0\0' + bytes([3, 0, 0, 0, 0, 0, 0, 0]))
    assert layout.columns == ['x']


def test_nanoseconds_of_a_time_have_no_sign():
    layout = Layout(parse('a/msg/B', f'T t\n{"=" * 80}\nMSG: a/T\nint32 sec\nuint32 nanosec\n'),
                    'a/msg/B', b'\0\1\0\0' + bytes(8))
    rows = np.frombuffer(b'\0\1\0\0' + b'\xfe\xff\xff\xff' + b'\xff' * 4, np.uint8)[np.newaxis]
    assert layout.unpack(rows)['t'].tolist() == [-2 * 10**9 + 2**32 - 1]
