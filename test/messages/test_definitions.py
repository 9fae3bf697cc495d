# SPDX-License-Identifier: Apache-2.0
"""Definitions of the installed ROS 2, kept ones and rosbags agree; foreign texts do no harm."""

import json
import sys

import pytest
from rosbags.typesys import Stores, get_typestore

from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages import definitions
from rigid_body_sim.messages.definitions import SEQUENCE, Field, definition, parse, schema
from rigid_body_sim.messages.state_topics import OUTPUTS
from rigid_body_sim.recording.about import STATUS_TYPE, STRING_TYPE
from rigid_body_sim.recording.command_messages import WRENCH_TYPE

SHIPPED = {STATUS_TYPE, STRING_TYPE, WRENCH_TYPE, 'diagnostic_msgs/msg/DiagnosticArray',
           *(output.type for output in OUTPUTS.values())}
"""All types that a node publishes or records."""


@pytest.fixture
def fresh():
    """Forget definitions before and after a test."""
    for function in (definition, schema):
        function.cache_clear()
    yield
    for function in (definition, schema):
        function.cache_clear()


def test_the_text_is_the_message_file_and_what_it_depends_on_as_rosbag2_writes_it():
    pytest.importorskip('geometry_msgs')
    text = definition('geometry_msgs/msg/PoseStamped').text
    assert text.startswith('# A Pose with reference coordinate frame and timestamp\n')
    names = [line[5:] for line in text.splitlines() if line.startswith('MSG: ')]
    assert names == ['geometry_msgs/Pose', 'geometry_msgs/Point', 'geometry_msgs/Quaternion',
                     'std_msgs/Header', 'builtin_interfaces/Time']
    assert text.count('=' * 80 + '\nMSG: ') == 5


def test_what_is_kept_is_what_the_installed_ros_says():
    kept = definitions._kept()
    assert set(kept) == SHIPPED
    for name, found in kept.items():
        assert definition(name) == found, (
            'run: python -m rigid_body_sim.messages.definitions > '
            'rigid_body_sim/messages/definitions.json')


@pytest.mark.parametrize('type_name', sorted(SHIPPED))
def test_without_ros_and_rosbags_the_definitions_are_there(type_name, fresh, monkeypatch):
    there = definition(type_name), schema(type_name)
    monkeypatch.setattr(definitions, '_message_file', lambda type_name: None)
    monkeypatch.setitem(sys.modules, 'rosbags', None)
    definition.cache_clear()
    schema.cache_clear()
    assert definition(type_name) == there[0]
    assert schema(type_name) == there[1]


def test_another_type_is_one_line_with_those_that_are_there():
    with pytest.raises(BadInput, match=r'std_msgs/msg/Floaty: .* or one of diagnostic_msgs/msg'):
        definition('std_msgs/msg/Floaty')


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


def test_of_an_installed_package_the_files_in_its_share_folder_are_read(
        tmp_path, monkeypatch, fresh):
    """Files in the folders above and below it, or a text without its hashes, are not."""
    prefix = tmp_path / 'prefix'
    modules = prefix / 'lib/python3.12/site-packages'
    (modules / 'toys_of_a_test').mkdir(parents=True)
    (modules / 'toys_of_a_test/__init__.py').touch()
    monkeypatch.syspath_prepend(modules)

    def put(folder, name, text, suffixes=('msg', 'json')):
        of_package = folder / 'share/toys_of_a_test/msg'
        of_package.mkdir(parents=True, exist_ok=True)
        hashes = {'type_hashes': [{'type_name': f'toys_of_a_test/msg/{name}',
                                   'hash_string': f'RIHS01_{name}'}]}
        for suffix in suffixes:
            (of_package / f'{name}.{suffix}').write_text(
                text if suffix == 'msg' else json.dumps(hashes))

    put(prefix, 'Top', 'Wheel[2] wheels\nBall ball\nstring name\n')
    put(prefix, 'Ball', 'float64 radius\n')
    put(prefix, 'Wheel', 'toys_of_a_test/Ball hub\n')
    put(prefix, 'Unhashed', 'bool b\n', ['msg'])
    put(tmp_path, 'Above', 'bool b\n')
    put(prefix / 'lib', 'Below', 'bool b\n')
    line = '=' * 80
    assert definition('toys_of_a_test/msg/Top') == (
        'toys_of_a_test/msg/Top',
        'Wheel[2] wheels\nBall ball\nstring name\n'
        f'\n{line}\nMSG: toys_of_a_test/Ball\nfloat64 radius\n'
        f'\n{line}\nMSG: toys_of_a_test/Wheel\ntoys_of_a_test/Ball hub\n', 'RIHS01_Top')
    for name in ('Unhashed', 'Above', 'Below'):
        with pytest.raises(BadInput, match='is a message type that is not installed here'):
            definition(f'toys_of_a_test/msg/{name}')


@pytest.mark.parametrize('type_name', ['std_msgs/msg/Floaty', 'x', 'os/msg/C', '../msg/X',
                                       'a b/msg/C', 'sys/msg/path', ''])
def test_unknown_types_are_refused(type_name):
    with pytest.raises(BadInput, match='is a message type that is not installed here'):
        definition(type_name)


def test_parser_reads_constants_defaults_bounds_and_arrays():
    text = (
        'uint8 A=1\nstring NAME="x # y"\n# comment\nfloat64 x 1.5\nstring<=10 s\n'
        'int8[3] three  # why\nInner[<=4] many\n'
        + '=' * 80
        + '\nMSG: pkg/Inner\nbool b\n'
    )
    assert parse('pkg/msg/Outer', text) == {
        'pkg/msg/Outer': [
            Field('x', 'float64', None),
            Field('s', 'string', None),
            Field('three', 'int8', 3),
            Field('many', 'pkg/msg/Inner', SEQUENCE),
        ],
        'pkg/msg/Inner': [Field('b', 'bool', None)],
    }


def test_empty_message_has_the_byte_that_ros_puts_there():
    assert parse('std_msgs/msg/Empty', '# nothing\n') == {
        'std_msgs/msg/Empty': [Field('structure_needs_at_least_one_member', 'uint8', None)]}


@pytest.mark.parametrize(('text', 'problem'), [
    ('float64', "the line 'float64'"),
    ('Missing m', 'pkg/msg/Missing is missing'),
    ('T t', 'contains itself'),
    ('float64[1000001] x', 'an array of 1000001 elements; at most 1000000'),
    ('float64 x\n' + '=' * 80 + '\nfloat64 y', 'after a separator'),
    ('wstring w', 'pkg/msg/wstring is missing'),
])
def test_texts_that_make_no_sense_are_refused(text, problem):
    with pytest.raises(BadInput, match=problem.replace('(', r'\(')):
        parse('pkg/msg/T', text)


def chain(count):
    """Return the text of a message in a message, `count` of them."""
    line = '=' * 80
    return 'T1 t\n' + ''.join(
        f'{line}\nMSG:pkg/T{k}\n' + (f'T{k + 1} t\n' if k + 1 < count else 'bool b\n')
        for k in range(1, count))


def test_the_longest_array_and_the_deepest_nesting():
    assert parse('pkg/msg/T', 'int8[1000000] x') == {'pkg/msg/T': [Field('x', 'int8', 1_000_000)]}
    assert len(parse('pkg/msg/T', chain(33))) == 33
    with pytest.raises(BadInput, match='T33 contains itself or is nested too deeply'):
        parse('pkg/msg/T', chain(34))
