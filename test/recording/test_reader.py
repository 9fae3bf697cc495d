# SPDX-License-Identifier: Apache-2.0
"""Reading: our recordings and those of other writers, against mcap_ros2; files that lie."""

import contextlib
import inspect
import os
import random
import resource
import shutil
import struct
import types

import numpy as np
import pytest
import yaml
from mcap.reader import make_reader
from mcap.writer import CompressionType, IndexType
from mcap.writer import Writer as TheirWriter
from mcap_ros2.decoder import DecoderFactory
from recording.conftest import (
    ABOUT,
    JOURNAL,
    PACKERS,
    SCENE,
    START,
    TICKING,
    Ticks,
    scene_text,
    write,
)
from recording.damage import damaged_copy, without_checksums
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as RosbagsWriter
from rosbags.typesys import Stores, get_typestore
from soak import SOAK

from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages import cdr
from rigid_body_sim.messages.definitions import definition
from rigid_body_sim.recording import file_reader, reader
from rigid_body_sim.recording.file_reader import FileReader
from rigid_body_sim.recording.reader import Recording
from rigid_body_sim.recording.recover import recover
from rigid_body_sim.recording.topics import Topic, journal_message
from rigid_body_sim.recording.writer import Writer

STATUS = 'diagnostic_msgs/msg/DiagnosticStatus'
DAMAGED = 5000 if SOAK else 60      # damaged files of each kind


def test_columns_are_the_numbers_that_were_written(recording):
    ticks = Ticks(0, 1000)
    with Recording(recording) as opened:
        pose, energy = opened.read('/pose'), opened.read('/energy', ['data'])
        assert opened.about == ABOUT
        assert (opened.start_time, opened.end_time, opened.message_count) == (
            START,
            START + 999 * 10**6,
            4002,
        )
        assert {name: topic.count for name, topic in opened.topics.items()} == {
            **dict.fromkeys(PACKERS, 1000),
            '/scene': 1,
            '/journal': 1,
        }
        assert repr(opened) == f'Recording({str(recording)!r}: 4002 messages, 0.999 s)'
    assert list(pose) == [
        'log_time',
        'publish_time',
        'sequence',
        'header.stamp',
        'header.frame_id',
        'pose.position',
        'pose.orientation',
    ]
    np.testing.assert_array_equal(pose['pose.orientation'], ticks.orientation)
    np.testing.assert_array_equal(pose['header.stamp'], ticks.stamps)
    np.testing.assert_array_equal(pose['log_time'], ticks.stamps)
    np.testing.assert_array_equal(pose['publish_time'], ticks.wall_clock)
    np.testing.assert_array_equal(pose['sequence'], np.arange(1000))
    np.testing.assert_array_equal(energy['data'], ticks.energy)
    assert set(pose['header.frame_id']) == {b'world'}


def test_columns_are_those_of_mcap_ros2(recording):
    with open(recording / 'racket_0.mcap', 'rb') as stream:
        decoded = [
            message
            for *_, message in make_reader(
                stream, decoder_factories=[DecoderFactory()]
            ).iter_decoded_messages(topics=['/angular_velocity'])
        ]
    with Recording(recording) as opened:
        mine = opened.read('/angular_velocity')
    np.testing.assert_array_equal(
        mine['vector'], [(one.vector.x, one.vector.y, one.vector.z) for one in decoded]
    )
    np.testing.assert_array_equal(
        mine['header.stamp'],
        [one.header.stamp.sec * 10**9 + one.header.stamp.nanosec for one in decoded],
    )


def test_blocks_stream_and_choose_time_topics_and_columns(recording):
    first, last, done = START + 150 * 10**6, START + 449 * 10**6, []
    with Recording(recording) as opened:
        blocks = list(opened.blocks(['/pose', '/energy'], None, first, last, done.append))
    assert [topic for topic, _ in blocks] == ['/pose', '/energy'] * 4
    assert [len(columns['log_time']) for _, columns in blocks] == [
        50,
        50,
        100,
        100,
        100,
        100,
        50,
        50,
    ]
    assert sum(done) == 600
    assert (blocks[0][1]['log_time'][0], blocks[-1][1]['log_time'][-1]) == (first, last)


def test_messages_come_in_the_order_of_time_also_from_overlapping_chunks(tmp_path):
    path, times = tmp_path / 'theirs.mcap', random.Random(1).sample(range(1, 3000), 2000)
    path.write_bytes(b'')
    _write_theirs(
        path,
        [(START + 50 * (index // 50) + time % 97, index) for index, time in enumerate(times)],
        chunk_size=1000,
    )
    with Recording(path) as opened:
        found = [(message.log_time, message.sequence) for message in opened.messages()]
        columns = opened.read('/x')
    assert [time for time, _ in found] == sorted(time for time, _ in found)
    assert sorted(index for _, index in found) == list(range(2000))
    np.testing.assert_array_equal(columns['log_time'], [time for time, _ in found])
    assert set(columns['data']) == {float(index) for index in range(2000)}


def test_messages_are_the_bytes_that_went_over_the_wire(recording):
    ticks = Ticks(0, 1000)
    with Recording(recording) as opened:
        found = list(opened.messages(['/pose', '/scene']))
    assert found[0] == (START, '/scene', START + 5, 0, scene_text(ABOUT['scene']))
    assert [message.data for message in found[1:]] == [
        row.tobytes() for row in ticks.rows['/pose']
    ]


def test_chunks_without_a_topic_are_not_read_for_it(recording, monkeypatch):
    with Recording(recording) as opened:
        read = []
        piece = FileReader.piece
        monkeypatch.setattr(
            FileReader,
            'piece',
            lambda file, place, *rest: read.append(place) or piece(file, place, *rest),
        )
        assert len(list(opened.decoded('/scene'))) == 1
        assert len(read) == 1
        read.clear()
        list(opened.blocks(['/pose']))
        assert len(read) > 3


def test_journal_tells_in_order_what_happened(tmp_path):
    exact = 0.1 + 0.2
    with Writer(tmp_path / 'bag', TICKING, [], JOURNAL, {'scene': 's'}) as writer:
        writer.message(
            JOURNAL.name,
            START,
            START,
            journal_message('impulse', tick=3, torque=[exact, 5e-324, -1e308], frame='world'),
        )
    with Recording(tmp_path / 'bag') as opened:
        assert opened.journal() == [
            {'kind': 'begin', 'scene': 's', 'log_time': START, 'topic': '/journal'},
            {
                'kind': 'impulse',
                'tick': 3,
                'torque': [exact, 5e-324, -1e308],
                'frame': 'world',
                'log_time': START,
                'topic': '/journal',
            },
        ]


def test_what_the_recorder_left_is_found_in_the_journal_alone(tmp_path):
    """As after `ros2 bag convert`, which keeps messages only."""
    with Writer(tmp_path / 'bag', TICKING, [], JOURNAL, ABOUT) as writer:
        writer.message(JOURNAL.name, START, START, journal_message('reset', tick=0))
    with Recording(tmp_path / 'bag') as opened:
        messages = list(opened.messages())
    path = tmp_path / 'converted.mcap'
    with open(path, 'wb') as stream:
        writer = TheirWriter(stream)
        writer.start('ros2', 'theirs')
        schema = writer.register_schema('std_msgs/msg/String', 'ros2msg', b'string data')
        channel = writer.register_channel('/journal', 'cdr', schema)
        for message in messages:
            writer.add_message(channel, message.log_time, message.data, message.publish_time)
        writer.finish()
    with Recording(path) as opened:
        assert opened.about == ABOUT


def test_recording_of_rosbags_with_sequences_of_many_lengths(tmp_path):
    store = get_typestore(Stores.ROS2_JAZZY)
    with RosbagsWriter(tmp_path / 'bag', version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        status = writer.add_connection('/events', STATUS, typestore=store)
        joints = writer.add_connection('/joints', 'sensor_msgs/msg/JointState', typestore=store)
        for k in range(40):
            writer.write(
                status,
                START + k,
                cdr.encode(
                    STATUS, {'name': 'n' * k, 'values': [{'key': 'k', 'value': str(k)}] * (k % 3)}
                ),
            )
            writer.write(
                joints,
                START + k,
                cdr.encode(
                    'sensor_msgs/msg/JointState',
                    {
                        'name': ['a'],
                        'position': [float(k)] * (1 + k % 2),
                        'header': {'frame_id': 'f' * (k % 2)},
                    },
                ),
            )
    with Recording(tmp_path / 'bag') as opened:
        assert [message['name'] for _, message in opened.decoded('/events')] == [
            'n' * k for k in range(40)
        ]
        with pytest.raises(BadInput, match='many different forms; decode them one by one'):
            opened.read('/events')
        joined = opened.read('/joints')
        assert 'position' not in joined     # sometimes one, sometimes two
        np.testing.assert_array_equal(joined['log_time'], START + np.arange(40))
        with pytest.raises(BadInput, match='position: sequences of different lengths'):
            opened.read('/joints', ['position'])


def _write_theirs(path, entries, **options):
    with open(path, 'wb') as stream:
        writer = TheirWriter(stream, **options)
        writer.start('ros2', 'theirs')
        schema = writer.register_schema(
            'std_msgs/msg/Float64', 'ros2msg', definition('std_msgs/msg/Float64').text.encode()
        )
        channel = writer.register_channel('/x', 'cdr', schema)
        for log_time, index in entries:
            writer.add_message(
                channel,
                log_time,
                cdr.encode('std_msgs/msg/Float64', {'data': float(index)}),
                log_time,
                index,
            )
        writer.finish()


@pytest.mark.parametrize(
    'options',
    [
        {},
        {'compression': CompressionType.LZ4},
        {'compression': CompressionType.NONE},
        {'use_chunking': False},
        {'use_statistics': False},
        {'index_types': IndexType.NONE},
        {'repeat_channels': False, 'repeat_schemas': False},
        {'enable_crcs': False},
        {
            'use_chunking': False,
            'use_statistics': False,
            'repeat_channels': False,
            'repeat_schemas': False,
            'use_summary_offsets': False,
        },
    ],
    ids=str,
)
def test_files_of_other_writers_with_whatever_they_leave_out(tmp_path, options):
    _write_theirs(
        tmp_path / 'x.mcap',
        [(START + k, k) for k in range(3000)],
        **{'chunk_size': 8000, **options},
    )
    with Recording(tmp_path / 'x.mcap') as opened:
        assert opened.topics['/x'].count == 3000
        columns = opened.read('/x')
        assert [
            message.sequence for message in opened.messages(start=START + 10, end=START + 12)
        ] == [10, 11, 12]
    np.testing.assert_array_equal(columns['data'], np.arange(3000.0))


def test_long_file_without_chunks_is_read_in_pieces(tmp_path, monkeypatch):
    monkeypatch.setattr(
        'rigid_body_sim.recording.mcap.reading._PIECE', 10
    )  # less than one record: pieces grow
    _write_theirs(tmp_path / 'x.mcap', [(START + k, k) for k in range(300)], use_chunking=False)
    with Recording(tmp_path / 'x.mcap') as opened:
        np.testing.assert_array_equal(opened.read('/x')['data'], np.arange(300.0))


def test_cut_file_is_refused_with_what_helps(tmp_path, recording):
    shutil.copytree(recording, tmp_path / 'bag')
    os.truncate(tmp_path / 'bag' / 'racket_0.mcap', 30_000)
    with pytest.raises(BadInput, match=r'cut or damaged.*"recover" makes a cut recording whole'):
        Recording(tmp_path / 'bag')
    (tmp_path / 'bag' / 'metadata.yaml').unlink()
    with pytest.raises(BadInput, match=r'holds no metadata\.yaml'):
        Recording(tmp_path / 'bag')


def test_unknown_topic_and_column_are_refused_with_those_there_are(recording):
    with Recording(recording) as opened:
        with pytest.raises(
            BadInput,
            match="no topic '/poze' was recorded; one of /angular_momentum_squared, /angular_",
        ):
            opened.read('/poze')
        with pytest.raises(BadInput, match=r"without a column 'pose\.x'; some of header\.stamp"):
            opened.read('/pose', ['pose.x'])


@pytest.mark.parametrize(('change', 'problem'), [
    ({'storage_identifier': 'sqlite3'}, "is stored as 'sqlite3'; an mcap recording"),
    ({'compression_mode': 'FILE'}, 'whole files of it are compressed'),
    ({'relative_file_paths': ['other_0.mcap']}, 'other_0.mcap: cannot be read'),
    ({'relative_file_paths': ['../../../../../../etc/passwd']}, 'passwd: cannot be read'),
    ({'relative_file_paths': 3}, 'is not the metadata of a recording'),
])
def test_metadata_that_will_not_do_is_refused(tmp_path, recording, change, problem):
    shutil.copytree(recording, tmp_path / 'bag')
    bag = yaml.safe_load((recording / 'metadata.yaml').read_text())
    bag['rosbag2_bagfile_information'].update(change)
    (tmp_path / 'bag' / 'metadata.yaml').write_text(yaml.safe_dump(bag))
    with pytest.raises(BadInput, match=problem):
        Recording(tmp_path / 'bag')


@pytest.mark.parametrize('text', ['', '[', 'a: b', '\0', '&a [*a, *a]', '[' * 10_000])
def test_metadata_that_is_none_is_refused(tmp_path, recording, text):
    shutil.copytree(recording, tmp_path / 'bag')
    (tmp_path / 'bag' / 'metadata.yaml').write_text(text)
    with pytest.raises(BadInput, match='is not the metadata of a recording'):
        Recording(tmp_path / 'bag')


@pytest.mark.parametrize('checksums', [True, False])
def test_damaged_files_never_do_worse_than_bad_input(tmp_path, checksums):
    source = (
        write(
            tmp_path / 'bag', count=200, block=50, compression_name='zstd' if checksums else 'none'
        )
        / 'bag_0.mcap'
    )
    if not checksums:
        without_checksums(source)
    content, rng = source.read_bytes(), random.Random(5)
    refused, before = 0, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for _ in range(DAMAGED):
        path = tmp_path / 'damaged.mcap'
        path.write_bytes(damaged_copy(content, rng))
        try:
            with Recording(path) as opened:
                for topic in opened.topics:
                    opened.read(topic)
                for _ in opened.messages():
                    pass
        except BadInput:
            refused += 1
        with contextlib.suppress(BadInput):
            recover(path)
            assert recover(path)[0].changed is False
            Recording(path).close()
    assert refused > DAMAGED // 5
    assert (
        resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 600_000
    )  # KB: a chunk may claim 256 MB


def test_topic_of_a_shipped_type_without_its_text_is_decoded_all_the_same(tmp_path):
    with open(tmp_path / 'x.mcap', 'wb') as stream:
        writer = TheirWriter(stream)
        writer.start('ros2', 'theirs')
        idl = writer.register_schema('std_msgs/msg/Float64', 'ros2idl', b'module std_msgs {};')
        other = writer.register_schema('their/msg/Thing', 'ros2idl', b'module their {};')
        for topic, schema, encoding in (
            ('/x', idl, 'cdr'),
            ('/y', other, 'cdr'),
            ('/z', idl, 'json'),
        ):
            channel = writer.register_channel(topic, encoding, schema)
            writer.add_message(
                channel, START, cdr.encode('std_msgs/msg/Float64', {'data': 2.5}), START
            )
        writer.finish()
    with Recording(tmp_path / 'x.mcap') as opened:
        assert opened.read('/x')['data'].tolist() == [2.5]
        with pytest.raises(
            BadInput, match='their/msg/Thing: is a message type that is not installed here'
        ):
            opened.read('/y')
        with pytest.raises(BadInput, match="encoded as 'json'; a recording of ROS 2 messages"):
            opened.read('/z')


def test_namespaced_journal_is_found(tmp_path):
    journal = Topic('/left/journal', JOURNAL.type)
    with Writer(tmp_path / 'bag', [], [SCENE], journal, {}) as writer:
        writer.message('/scene', START, START, scene_text('x'))
    with Recording(tmp_path / 'bag') as opened:
        assert [entry['kind'] for entry in opened.journal()] == ['begin']


def test_an_index_that_points_at_the_end_of_the_file_is_refused(tmp_path, recording):
    content = bytearray((recording / 'racket_0.mcap').read_bytes())
    with open(recording / 'racket_0.mcap', 'rb') as stream:
        index = make_reader(stream).get_summary().chunk_indexes[0]
    told = struct.pack('<QQ', index.chunk_start_offset, index.chunk_length)
    for lie in (struct.pack('<QQ', len(content), 0), struct.pack('<QQ', len(content) - 5, 5),
                struct.pack('<QQ', 0, 8)):
        damaged = content.replace(told, lie)
        damaged[-12:-8] = bytes(4)      # no checksum of the summary
        (tmp_path / 'x.mcap').write_bytes(damaged)
        refused = pytest.raises(BadInput, match='an index that points at no chunk; an undamaged')
        with Recording(tmp_path / 'x.mcap') as opened, refused:
            list(opened.messages())


def test_all_messages_are_read_unless_an_interval_is_given(tmp_path):
    """Also those of the first and the last time that there is."""
    types = {'/pose': 'geometry_msgs/msg/PoseStamped',
             '/angular_velocity': 'geometry_msgs/msg/Vector3Stamped'}
    with open(tmp_path / 'x.mcap', 'wb') as stream:
        writer = TheirWriter(stream)
        writer.start('ros2', 'theirs')
        for topic, kind in types.items():
            schema = writer.register_schema(kind, 'ros2msg', definition(kind).text.encode())
            channel = writer.register_channel(topic, 'cdr', schema)
            for k, time in enumerate((0, 2**63 - 1)):
                writer.add_message(channel, time, cdr.encode(
                    kind, {'header': {'stamp': {'nanosec': k}}}), time)
        writer.finish()
    with Recording(tmp_path / 'x.mcap') as opened:
        assert opened.read('/pose')['log_time'].tolist() == [0, 2**63 - 1]
        assert sum(len(columns['log_time']) for _, columns in opened.blocks()) == 4
        assert len(list(opened.messages())) == 4
        assert len(list(opened.decoded('/pose'))) == 2
        assert len(opened.states()) == 2
    # the tables of other libraries, which take long to import, are of the same interval
    for method in (Recording.to_pandas, Recording.to_xarray):
        given = inspect.signature(method).parameters
        assert (given['start'].default, given['end'].default) == (0, 2**63)


@pytest.mark.parametrize(('start', 'end', 'count'), [
    (99, 99, 1), (100, 100, 1), (99, 100, 2), (0, 99, 100), (100, 199, 100), (101, 198, 98)])
def test_both_ends_of_an_interval_belong_to_it(recording, start, end, count):
    """A chunk has 100 ticks."""
    start, end = (START + tick * 10**6 for tick in (start, end))
    with Recording(recording) as opened:
        assert len(opened.read('/energy', None, start, end)['log_time']) == count
        assert len(list(opened.messages(['/energy'], start, end))) == count
        assert len(list(opened.decoded('/energy', start, end))) == count


def test_messages_of_one_time_come_as_recorded_from_whatever_chunks(tmp_path):
    _write_theirs(tmp_path / 'x.mcap', [(START, index) for index in range(60)], chunk_size=100)
    with Recording(tmp_path / 'x.mcap') as opened:
        assert len(opened._files[0].places()) > 5
        assert [message.sequence for message in opened.messages()] == list(range(60))
        assert opened.read('/x')['sequence'].tolist() == list(range(60))


def test_columns_are_sorted_for_one_nanosecond(tmp_path):
    _write_theirs(tmp_path / 'x.mcap', [(START + 1, 0), (START, 1), (START + 2, 2)])
    with Recording(tmp_path / 'x.mcap') as opened:
        assert opened.read('/x')['sequence'].tolist() == [1, 0, 2]


def test_a_sequence_of_another_length_in_a_later_chunk_is_no_column(tmp_path):
    joints = 'sensor_msgs/msg/JointState'
    with open(tmp_path / 'x.mcap', 'wb') as stream:
        writer = TheirWriter(stream, chunk_size=300)
        writer.start('ros2', 'theirs')
        schema = writer.register_schema(joints, 'ros2msg', definition(joints).text.encode())
        channel = writer.register_channel('/x', 'cdr', schema)
        for k in range(40):
            writer.add_message(channel, START + k, cdr.encode(
                joints, {'position': [1.0] * (1 + k // 20), 'velocity': [float(k)]}), START)
        writer.finish()
    with Recording(tmp_path / 'x.mcap') as opened:
        found = opened.read('/x')
        assert 'position' not in found
        assert found['velocity'].tolist() == [[float(k)] for k in range(40)]
        assert opened.read('/x', end=START + 9)['position'].shape == (10, 1)


def test_a_recording_lasts_from_its_first_file_that_holds_anything_to_its_last(monkeypatch):
    files = {name: types.SimpleNamespace(
        channels={}, counts=counts, start_time=first, end_time=last)
        for name, counts, first, last in (
            ('a', {1: 2}, 30, 60), ('b', {}, 0, 0), ('c', {1: 1}, 20, 70), ('d', {1: 1}, 25, 50))}
    monkeypatch.setattr(file_reader, 'FileReader', files.get)
    monkeypatch.setattr(Recording, '_about', lambda self, custom: custom)
    for names, span in (('abcd', (20, 70)), ('ab', (30, 60)), ('b', (0, 0))):
        monkeypatch.setattr(reader, 'files_of', lambda path, names=names: ([*names], {}))
        opened = Recording('a folder')
        assert (opened.start_time, opened.end_time) == span
