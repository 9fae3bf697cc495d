# SPDX-License-Identifier: Apache-2.0
"""CDR against rosbags, against rclpy's own deserialiser, and against bytes that are no message."""

import contextlib
import importlib
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_typestore

from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages import cdr
from rigid_body_sim.messages.cdr import decode, encode
from rigid_body_sim.messages.definitions import parse, schema

HEADER = {'stamp': {'sec': -2, 'nanosec': 999_999_999}, 'frame_id': 'wörld'}
SAMPLES = {
    'std_msgs/msg/Float64': {'data': -math.pi}, 'std_msgs/msg/String': {'data': 'Kreisel ⟳ \n'},
    'rosgraph_msgs/msg/Clock': {'clock': {'sec': 7, 'nanosec': 5}},
    'geometry_msgs/msg/PoseStamped': {
        'header': HEADER,
        'pose': {'position': {'x': 1.0, 'y': 5e-324, 'z': -0.0},
                 'orientation': {'x': 0.1, 'y': 0.2, 'z': 0.3, 'w': math.inf}}},
    'geometry_msgs/msg/Vector3Stamped': {
        'header': HEADER, 'vector': {'x': 1.0, 'y': 2.0, 'z': 3.0}},
    'geometry_msgs/msg/WrenchStamped': {'header': HEADER,
                                        'wrench': {'force': {'x': 1.0, 'y': 2.0, 'z': 3.0},
                                                   'torque': {'x': 4.0, 'y': 5.0, 'z': 6.0}}},
    'nav_msgs/msg/Odometry': {'header': HEADER, 'child_frame_id': 'b',
                              'pose': {'covariance': [float(k) for k in range(36)]}},
    'sensor_msgs/msg/Imu': {'header': HEADER, 'orientation_covariance': [-1.0] + [0.0] * 8,
                            'linear_acceleration': {'x': 9.81, 'y': 0.0, 'z': 0.0}},
    'sensor_msgs/msg/JointState': {'header': HEADER, 'name': ['hinge', 'b'],
                                   'position': [1.0, 2.0], 'velocity': [3.0, 4.0], 'effort': []},
    'diagnostic_msgs/msg/DiagnosticStatus': {
        'level': 2, 'name': 'n', 'message': '',
        'values': [{'key': 'a', 'value': '1'}, {'key': '', 'value': 'b'}]},
    'diagnostic_msgs/msg/DiagnosticArray': {
        'header': HEADER,
        'status': [{'level': 1, 'values': [{'key': 'k', 'value': 'v'}]}, {'name': 'x'}]},
    'visualization_msgs/msg/Marker': {
        'header': HEADER, 'ns': 'body', 'type': 1, 'points': [{'x': 1.0, 'y': 2.0, 'z': 3.0}],
        'frame_locked': True},
    'tf2_msgs/msg/TFMessage': {'transforms': [{'header': HEADER, 'child_frame_id': 'body'}, {}]}}


IMU = 'sensor_msgs/msg/Imu'


def plain(message):
    """Turn a rosbags message into nested dicts and lists."""
    if hasattr(message, '__msgtype__'):
        return {name: plain(value)
                for name, value in vars(message).items()
                if not name.isupper() and name != '__msgtype__'}
    if isinstance(message, np.ndarray):
        return message.tolist()
    return [plain(item) for item in message] if isinstance(message, list) else message


def in_full(message):
    """Turn a message of rclpy into nested dicts and lists."""
    if hasattr(message, 'get_fields_and_field_types'):
        return {name: in_full(getattr(message, name))
                for name in message.get_fields_and_field_types()}
    if isinstance(message, bytes):
        return message[0]
    if isinstance(message, (str, bool, int, float)):
        return message
    return [in_full(item) for item in message]


@pytest.mark.parametrize('type_name', sorted(SAMPLES))
def test_bytes_are_those_of_rosbags_and_decode_to_the_same(type_name):
    store = get_typestore(Stores.ROS2_JAZZY)
    data = encode(type_name, SAMPLES[type_name])
    theirs = store.deserialize_cdr(data, type_name)
    assert bytes(store.serialize_cdr(theirs, type_name)) == data
    assert decode(schema(type_name), type_name, data) == plain(theirs)


@pytest.mark.parametrize('type_name', sorted(SAMPLES))
def test_rclpy_reads_the_same(type_name):
    serialization = pytest.importorskip('rclpy.serialization')
    package, _, name = type_name.split('/')
    try:
        message_type = getattr(importlib.import_module(f'{package}.msg'), name)
    except ImportError:
        pytest.skip(f'{package} is not installed')
    data = encode(type_name, SAMPLES[type_name])
    message = serialization.deserialize_message(data, message_type)
    assert in_full(message) == decode(schema(type_name), type_name, data)
    # the other way: we decode what rclpy packs (its padding is arbitrary) to the same values
    assert decode(
        schema(type_name), type_name, serialization.serialize_message(message)) == in_full(message)


def test_padding_is_zero_and_bytes_repeat():
    data = encode('geometry_msgs/msg/Vector3Stamped', {'header': {'frame_id': 'ab'}})
    assert data == encode('geometry_msgs/msg/Vector3Stamped', {'header': {'frame_id': 'ab'}})
    assert data[19:24] == bytes(5)


def test_what_is_left_out_is_zero_and_empty():
    assert decode(schema(IMU), IMU, encode(IMU, {})) == {
        'header': {'stamp': {'sec': 0, 'nanosec': 0}, 'frame_id': ''},
        'orientation': {'x': 0.0, 'y': 0.0, 'z': 0.0, 'w': 0.0},
        'orientation_covariance': [0.0] * 9,
        **{name: value for field in ('angular_velocity', 'linear_acceleration')
           for name, value in ((field, {'x': 0.0, 'y': 0.0, 'z': 0.0}),
                               (f'{field}_covariance', [0.0] * 9))}}


def test_a_text_may_be_without_its_final_zero_where_its_length_is_zero():
    leaves = []
    assert decode(parse('a/msg/B', 'string s\nstring t\nbool b'), 'a/msg/B',
                  b'\0\1\0\0' + bytes(4) + b'\3\0\0\0hi\0\1', leaves) == {
        's': '', 't': 'hi', 'b': True}
    assert leaves == [('s', '#', 4, 1), ('s', 's', 8, 0), ('t', '#', 8, 1), ('t', 's', 12, 2),
                      ('b', '?', 15, 1)]


@pytest.mark.parametrize(('values', 'problem'), [
    ({'datum': 1.0}, "no field 'datum'; one of data"),
    ({'data': 'one'}, 'does not fit'),
])
def test_values_that_do_not_fit_are_refused(values, problem):
    with pytest.raises(BadInput, match=problem):
        encode('std_msgs/msg/Float64', values)


def test_array_of_wrong_length_is_refused():
    with pytest.raises(BadInput, match='orientation_covariance: 8 elements; 9 elements'):
        encode('sensor_msgs/msg/Imu', {'orientation_covariance': [0.0] * 8})


@given(type_name=st.sampled_from(sorted(SAMPLES)), cut=st.floats(0, 1, exclude_max=True),
       junk=st.binary(max_size=12), at=st.integers(4, 60))
@settings(deadline=None, max_examples=200)
def test_damaged_bytes_never_do_worse_than_bad_input(type_name, cut, junk, at):
    data = encode(type_name, SAMPLES[type_name])
    for damaged in (data[:int(cut * len(data))], data[:at] + junk + data[at + len(junk):]):
        with contextlib.suppress(BadInput):
            decode(schema(type_name), type_name, damaged)


def test_big_endian_is_refused_with_what_is_read():
    with pytest.raises(BadInput, match='starts with 00000000; little-endian CDR'):
        decode(schema('std_msgs/msg/Float64'), 'std_msgs/msg/Float64', bytes(12))


def test_claimed_lengths_cost_nothing():
    with pytest.raises(BadInput, match='claims 4294967295 bytes'):
        decode(schema('std_msgs/msg/String'), 'std_msgs/msg/String', b'\0\1\0\0\xff\xff\xff\xff')
    with pytest.raises(BadInput, match='claims 4294967295 elements'):
        decode(parse('a/msg/B', 'float64[] x'), 'a/msg/B', b'\0\1\0\0\xff\xff\xff\xff')


def test_a_length_beyond_the_end_is_not_a_shorter_value():
    with pytest.raises(BadInput, match='data claims 3 bytes'):
        decode(schema('std_msgs/msg/String'), 'std_msgs/msg/String', b'\0\1\0\0\3\0\0\0ab')
    with pytest.raises(BadInput, match='x claims 3 elements'):
        decode(parse('a/msg/B', 'uint8[] x'), 'a/msg/B', b'\0\1\0\0\3\0\0\0ab')


@pytest.mark.parametrize(('kind', 'value'), [
    ('bool', True), ('byte', 255), ('char', 255), ('int8', -128), ('uint8', 255),
    ('int16', -32768), ('uint16', 65535), ('int32', -2**31), ('uint32', 2**32 - 1),
    ('int64', -2**63), ('uint64', 2**64 - 1), ('float32', 1.5), ('float64', -math.pi)])
def test_every_primitive_stands_at_a_multiple_of_its_size(kind, value, monkeypatch):
    """After one byte, so many zeros are left that the size is reached; numpy knows the sizes."""
    monkeypatch.setattr(cdr, 'schema',
                        lambda name: parse(name, f'uint8 first\n{kind}[] then\n{kind} last\n'))
    wanted = np.array(value, {'byte': 'u1', 'char': 'u1'}.get(kind, kind)).tobytes()
    data = encode('pkg/msg/T', {'first': 1, 'then': [value, value], 'last': value})
    head = b'\1\0\0\0' + b'\2\0\0\0'    # the sequence has two
    assert data == cdr.ENCAPSULATION + head + 3 * wanted
    monkeypatch.setattr(cdr, 'schema',
                        lambda name: parse(name, f'uint8 first\n{kind} last\n'))
    data = encode('pkg/msg/T', {'first': 1, 'last': value})
    assert data == cdr.ENCAPSULATION + b'\1' + bytes(len(wanted) - 1) + wanted
    assert decode(cdr.schema('pkg/msg/T'), 'pkg/msg/T', data) == {'first': 1, 'last': value}
