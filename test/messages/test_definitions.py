"""Definitions as data: the same texts and hashes as an installed Jazzy, and a parser that strangers' texts cannot hurt."""

import json
import pathlib
import sys

import pytest
from rosbags.typesys import Stores, get_typestore

from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages import make_definitions
from rigid_body_sim.messages.definitions import SEQUENCE, Field, definition, parse, schema

SHIPPED = json.loads((pathlib.Path(make_definitions.__file__).parent / 'definitions.json').read_text())
SHARE = pathlib.Path(sys.prefix) / 'share'


@pytest.mark.skipif(not (SHARE / 'geometry_msgs').exists(), reason='the ROS wheels are not installed in this environment')
def test_shipped_definitions_are_what_the_generator_makes_of_the_installed_ros(capsys):
    make_definitions.main(SHARE)
    assert json.loads(capsys.readouterr().out) == SHIPPED


@pytest.mark.parametrize('type_name', sorted(SHIPPED))
def test_hashes_are_those_that_rosbags_computes(type_name):
    assert definition(type_name).hash == get_typestore(Stores.ROS2_JAZZY).hash_rihs01(type_name)


@pytest.mark.parametrize('type_name', sorted(SHIPPED))
def test_texts_are_understood_by_rosbags_and_name_the_same_fields(type_name):
    from rosbags.typesys import get_types_from_msg
    theirs = get_types_from_msg(definition(type_name).text, type_name)
    ours = schema(type_name)
    assert set(ours) == set(theirs)
    for name, fields in ours.items():
        assert [field.name for field in fields] == [field[0] for field in theirs[name][1]]


def test_unknown_type_is_refused_with_those_there_are():
    with pytest.raises(BadInput, match=r'std_msgs/msg/Floaty.*std_msgs/msg/Float64'):
        definition('std_msgs/msg/Floaty')


def test_parser_reads_constants_defaults_bounds_and_arrays():
    text = 'uint8 A=1\nstring NAME="x # y"\n# comment\nfloat64 x 1.5\nstring<=10 s\nint8[3] three  # why\nInner[<=4] many\n' \
        + '=' * 80 + '\nMSG: pkg/Inner\nbool b\n'
    assert parse('pkg/msg/Outer', text) == {
        'pkg/msg/Outer': [Field('x', 'float64', None), Field('s', 'string', None), Field('three', 'int8', 3),
                          Field('many', 'pkg/msg/Inner', SEQUENCE)],
        'pkg/msg/Inner': [Field('b', 'bool', None)]}


def test_empty_message_has_the_byte_that_ros_puts_there():
    assert parse('std_msgs/msg/Empty', '# nothing\n') == {
        'std_msgs/msg/Empty': [Field('structure_needs_at_least_one_member', 'uint8', None)]}


@pytest.mark.parametrize(('text', 'problem'), [
    ('float64', "the line 'float64'"),
    ('Missing m', 'pkg/msg/Missing is missing'),
    ('T t', 'contains itself'),
    ('float64[9999999999] x', 'an array of 9999999999 elements'),
    ('float64 x\n' + '=' * 80 + '\nfloat64 y', 'after a separator'),
    ('wstring w', 'pkg/msg/wstring is missing'),
])
def test_texts_that_make_no_sense_are_refused(text, problem):
    with pytest.raises(BadInput, match=problem.replace('(', r'\(')):
        parse('pkg/msg/T', text)
