# SPDX-License-Identifier: Apache-2.0
"""Recordings as other readers see them: rosbags, mcap with mcap_ros2, PyYAML."""

import errno
import itertools
import os
import shutil
import subprocess

import numpy as np
import pytest
import yaml
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader
from mcap_ros2.decoder import DecoderFactory
from recording.conftest import (
    ABOUT,
    JOURNAL,
    LATE,
    PACKERS,
    SCENE,
    START,
    TICKING,
    Ticks,
    scene_text,
    write,
)
from rosbags.highlevel import AnyReader
from rosbags.interfaces import QosDurability, QosReliability
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_typestore

from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages.definitions import definition
from rigid_body_sim.recording import writer as module
from rigid_body_sim.recording.metadata import FileRecord
from rigid_body_sim.recording.reader import Recording
from rigid_body_sim.recording.recover import recover
from rigid_body_sim.recording.topics import Topic
from rigid_body_sim.recording.writer import CHUNK_SIZE, Writer

COUNTS = {**{topic.name: 1000 for topic, _ in TICKING}, '/scene': 1, '/journal': 1}


def test_rosbags_reads_every_message_as_written(recording):
    ticks = Ticks(0, 1000)
    with Reader(recording) as reader:
        assert {
            connection.topic: connection.msgcount for connection in reader.connections
        } == COUNTS
        assert reader.message_count == 4002
        assert reader.start_time == START
        found = {}
        for connection, timestamp, data in reader.messages():
            found.setdefault(connection.topic, []).append((timestamp, bytes(data)))
    for topic, rows in ticks.rows.items():
        assert found[topic] == list(
            zip(ticks.stamps.tolist(), (row.tobytes() for row in rows), strict=True)
        )
    assert found['/scene'] == [(START, scene_text(ABOUT['scene']))]


def test_any_reader_decodes_by_the_recorded_definitions(recording):
    ticks = Ticks(0, 1000)
    with AnyReader([recording], default_typestore=get_typestore(Stores.EMPTY)) as reader:
        connections = [
            connection for connection in reader.connections if connection.topic == '/pose'
        ]
        poses = [
            reader.deserialize(data, connection.msgtype)
            for connection, _, data in reader.messages(connections)
        ]
    assert [
        pose.header.stamp.sec * 10**9 + pose.header.stamp.nanosec for pose in poses
    ] == ticks.stamps.tolist()
    turned = [
        (
            pose.pose.orientation.x,
            pose.pose.orientation.y,
            pose.pose.orientation.z,
            pose.pose.orientation.w,
        )
        for pose in poses
    ]
    assert turned == [tuple(row) for row in ticks.orientation.tolist()]


@pytest.mark.parametrize('compression_name', ['zstd', 'lz4', 'none'])
def test_mcap_ros2_decodes_with_checksums_validated(tmp_path, compression_name):
    path = write(tmp_path / 'bag', count=300, compression_name=compression_name)
    ticks = Ticks(0, 300)
    with open(path / 'bag_0.mcap', 'rb') as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        energies = [(message.log_time, message.publish_time, message.sequence, decoded.data)
                    for _, _, message, decoded in reader.iter_decoded_messages(topics=['/energy'])]
        assert reader.get_header().profile == 'ros2'
        assert {chunk.compression for chunk in reader.get_summary().chunk_indexes} == {
            compression_name.replace('none', '')
        }
    assert energies == list(
        zip(
            ticks.stamps.tolist(),
            ticks.wall_clock.tolist(),
            range(300),
            ticks.energy.tolist(),
            strict=True,
        )
    )


def test_indexes_lead_to_the_messages_they_name(recording):
    first, last = START + 123 * 10**6, START + 456 * 10**6
    with open(recording / 'racket_0.mcap', 'rb') as stream:
        # a seeking reader goes by chunk and message indexes alone
        window = [
            message.log_time
            for _, channel, message in make_reader(stream, validate_crcs=True).iter_messages(
                topics=['/pose'], starting_at=first, ending_before=last
            )
        ]
    assert window == list(range(first, last, 10**6))
    with open(recording / 'racket_0.mcap', 'rb') as stream:
        summary = make_reader(stream).get_summary()
    assert summary.statistics.message_count == 4002
    assert summary.statistics.chunk_count == len(summary.chunk_indexes) == 10
    assert [len(chunk.message_index_offsets) for chunk in summary.chunk_indexes] == [6] + [4] * 9
    assert {index.name for index in summary.metadata_indexes} == {'rigid_body_sim', 'rosbag2'}


def test_file_order_is_the_order_of_time_tick_by_tick(recording):
    with open(recording / 'racket_0.mcap', 'rb') as stream:
        records = [
            record
            for record in StreamReader(stream, validate_crcs=True).records
            if type(record).__name__ == 'Message'
        ]
    assert all(a.log_time <= b.log_time for a, b in itertools.pairwise(records))


def test_metadata_yaml_is_that_of_rosbag2_version_9(recording):
    bag = yaml.safe_load((recording / 'metadata.yaml').read_text())['rosbag2_bagfile_information']
    assert list(bag) == [
        'version',
        'storage_identifier',
        'duration',
        'starting_time',
        'message_count',
        'topics_with_message_count',
        'compression_format',
        'compression_mode',
        'relative_file_paths',
        'files',
        'custom_data',
        'ros_distro',
    ]
    topics = bag.pop('topics_with_message_count')
    assert bag == {
        'version': 9,
        'storage_identifier': 'mcap',
        'duration': {'nanoseconds': 999 * 10**6},
        'starting_time': {'nanoseconds_since_epoch': START},
        'message_count': 4002,
        'compression_format': '',
        'compression_mode': '',
        'relative_file_paths': ['racket_0.mcap'],
        'files': [
            {
                'path': 'racket_0.mcap',
                'starting_time': {'nanoseconds_since_epoch': START},
                'duration': {'nanoseconds': 999 * 10**6},
                'message_count': 4002,
            }
        ],
        'custom_data': ABOUT,
        'ros_distro': 'jazzy',
    }
    assert {topic['topic_metadata']['name']: topic['message_count'] for topic in topics} == COUNTS
    forever = {'sec': 9223372036, 'nsec': 854775807}
    assert next(topic for topic in topics if topic['topic_metadata']['name'] == '/scene')[
        'topic_metadata'
    ] == {
        'name': '/scene',
        'type': 'std_msgs/msg/String',
        'serialization_format': 'cdr',
        'offered_qos_profiles': [
            {
                'history': 'keep_last',
                'depth': 1,
                'reliability': 'reliable',
                'durability': 'transient_local',
                'deadline': forever,
                'lifespan': forever,
                'liveliness': 'automatic',
                'liveliness_lease_duration': forever,
                'avoid_ros_namespace_conventions': False,
            }
        ],
        'type_description_hash': definition('std_msgs/msg/String').hash,
    }


def test_channels_and_metadata_records_are_those_of_rosbag2(recording):
    with open(recording / 'racket_0.mcap', 'rb') as stream:
        reader = make_reader(stream)
        summary, records = (
            reader.get_summary(),
            {record.name: record.metadata for record in reader.iter_metadata()},
        )
    for channel in summary.channels.values():
        assert list(channel.metadata) == ['offered_qos_profiles', 'topic_type_hash']
        assert channel.message_encoding == 'cdr'
        schema = summary.schemas[channel.schema_id]
        assert schema.encoding == 'ros2msg'
        assert schema.data.decode() == definition(schema.name).text
        assert channel.metadata['topic_type_hash'] == definition(schema.name).hash
        assert len(yaml.safe_load(channel.metadata['offered_qos_profiles'])[0]) == 9
    assert records['rigid_body_sim'] == ABOUT
    told = yaml.safe_load(records['rosbag2']['serialized_metadata'])
    assert (
        told
        == yaml.safe_load((recording / 'metadata.yaml').read_text())['rosbag2_bagfile_information']
    )


def test_qos_is_understood_by_rosbags(recording):
    with Reader(recording) as reader:
        profile = next(
            connection for connection in reader.connections if connection.topic == '/scene'
        ).ext.offered_qos_profiles[0]
    assert (profile.depth, profile.reliability, profile.durability) == (
        1,
        QosReliability.RELIABLE,
        QosDurability.TRANSIENT_LOCAL,
    )


@pytest.mark.parametrize(
    ('options', 'least'), [({'split_bytes': 30_000}, 5), ({'split_seconds': 0.3}, 3)]
)
def test_split_recordings_read_as_one(tmp_path, options, least):
    path = write(tmp_path / 'bag', **options)
    names = [f'bag_{number}.mcap' for number in range(len(list(path.glob('*.mcap'))))]
    assert len(names) >= least
    bag = yaml.safe_load((path / 'metadata.yaml').read_text())['rosbag2_bagfile_information']
    assert bag['relative_file_paths'] == names
    # the journal begins anew in each file
    assert (
        bag['message_count']
        == sum(file['message_count'] for file in bag['files'])
        == 4001 + len(names)
    )
    with Reader(path) as reader:
        stamps = [
            timestamp
            for connection, timestamp, _ in reader.messages()
            if connection.topic == '/pose'
        ]
    assert stamps == Ticks(0, 1000).stamps.tolist()
    with Recording(path) as opened:
        assert (opened.start_time, opened.end_time) == (stamps[0], stamps[-1])
    for name in names:
        with open(path / name, 'rb') as stream:
            topics = [
                channel.topic
                for _, channel, _ in make_reader(stream, validate_crcs=True).iter_messages(
                    log_time_order=False
                )
            ]
        assert topics[0] == '/journal'


def test_a_full_state_is_asked_for_in_each_file(tmp_path):
    ticks, asked = Ticks(0, 400), []
    with Writer(tmp_path / 'bag', TICKING, [], JOURNAL, {}, split_seconds=0.1) as writer:
        for index in range(400):
            writer.ticks(
                index,
                *(array[index : index + 1] for array in (ticks.stamps, ticks.wall_clock)),
                [rows[index : index + 1] for rows in ticks.rows.values()],
            )
            writer.flush()
            if writer.state_wanted:
                writer.state_wanted = False
                asked.append(index)
    # a file begins with the tick after the one that made it 0.1 s long
    assert asked == [0, 101, 202, 303]


def test_log_time_never_falls_and_publish_time_is_kept(tmp_path):
    ticks = Ticks(0, 4)
    with Writer(tmp_path / 'bag', TICKING, [SCENE], JOURNAL, {}) as writer:
        writer.message('/scene', START + 10**9, START, scene_text('late'))
        writer.ticks(0, ticks.stamps, ticks.wall_clock, list(ticks.rows.values()))
        writer.message('/scene', START - 10**9, START + 7, scene_text('early'))
    with open(tmp_path / 'bag' / 'bag_0.mcap', 'rb') as stream:
        messages = [
            (channel.topic, message.log_time, message.publish_time)
            for _, channel, message in make_reader(stream).iter_messages(log_time_order=False)
        ]
    assert {log_time for _, log_time, _ in messages} == {START + 10**9}
    assert [time for topic, _, time in messages if topic == '/pose'] == [
        START + k * 10**6 + (1 + k) * LATE for k in range(4)
    ]
    assert messages[-1] == ('/scene', START + 10**9, START + 7)


def test_nothing_is_larger_than_a_chunk_though_much_comes_at_once(tmp_path):
    ticks = Ticks(0, 5000)
    with Writer(tmp_path / 'bag', TICKING, [], JOURNAL, {}) as writer:
        writer.ticks(0, ticks.stamps, ticks.wall_clock, list(ticks.rows.values()))
    with open(tmp_path / 'bag' / 'bag_0.mcap', 'rb') as stream:
        sizes = [
            chunk.uncompressed_size for chunk in make_reader(stream).get_summary().chunk_indexes
        ]
    assert len(sizes) > 10
    assert max(sizes) < CHUNK_SIZE + 500


@pytest.mark.parametrize('lengths', [[1], [7], [8], [9], [100], [2000], [3, 300, 1, 8]])
def test_the_file_does_not_tell_how_many_ticks_came_at_once(tmp_path, lengths):
    """Each chunk ends with the tick that fills it, whether ticks come one by one or many."""
    ticks = Ticks(0, 2000)
    columns = ticks.stamps - 10**6 * (np.arange(2000) % 3), ticks.wall_clock    # some are older
    for name, some in (('a', [2000]), ('b', lengths)):
        with Writer(tmp_path / name / 'bag', TICKING, [], JOURNAL, {}) as writer:
            first = 0
            for length in itertools.cycle(some):
                part = slice(first, first + length)
                first += writer.ticks(first, *(column[part] for column in columns),
                                      [rows[part] for rows in ticks.rows.values()])
                if first == 2000:
                    break
    files = [(tmp_path / name / 'bag' / 'bag_0.mcap').read_bytes() for name in 'ab']
    assert files[0] == files[1]
    with Recording(tmp_path / 'b' / 'bag') as recording:
        found = recording.read('/pose')
    np.testing.assert_array_equal(found['sequence'], np.arange(2000))
    np.testing.assert_array_equal(found['log_time'], np.maximum.accumulate(columns[0]))
    np.testing.assert_array_equal(found['publish_time'], ticks.wall_clock)
    np.testing.assert_array_equal(found['pose.orientation'], ticks.orientation)


@pytest.mark.parametrize('options', [{}, {'split_bytes': 20_000}])
def test_bytes_and_messages_are_counted_as_they_are_in_the_files(tmp_path, options):
    ticks = Ticks(0, 500)

    def size():
        return sum(path.stat().st_size for path in (tmp_path / 'bag').glob('*.mcap'))
    with Writer(tmp_path / 'bag', TICKING, [], JOURNAL, {}, **options) as writer:
        assert (writer.bytes_written, writer.messages_written) == (size(), 0)
        for first in range(0, 500, 100):
            part = slice(first, first + 100)
            writer.ticks(first, ticks.stamps[part], ticks.wall_clock[part],
                         [rows[part] for rows in ticks.rows.values()])
            writer.flush()
            assert writer.bytes_written == size()
    assert writer.bytes_written == size()
    with Recording(tmp_path / 'bag') as recording:
        assert writer.messages_written == recording.message_count >= 2001
    modes = {path.stat().st_mode & 0o777 for path in (tmp_path / 'bag').glob('*.mcap')}
    mask = os.umask(0)
    os.umask(mask)
    assert modes == {0o644 & ~mask}


def test_no_file_grows_beyond_the_largest(tmp_path, monkeypatch):
    assert module.LARGEST_FILE == 4 * 10**9    # as the class promises
    monkeypatch.setattr(module, 'LARGEST_FILE', 30_000)
    for split_bytes in (0, 10**12):
        write(tmp_path / f'b{split_bytes}', split_bytes=split_bytes)
        assert len(list((tmp_path / f'b{split_bytes}').glob('*.mcap'))) >= 5


def test_a_recording_goes_on_after_its_last_file(tmp_path):
    (tmp_path / 'bag').mkdir()
    files = [FileRecord(name, 0, end, {'/scene': 1}) for name, end in (
        ('bag_0.mcap', START), ('bag_10.mcap', START + 900), ('bag_9.mcap', START + 300))]
    with Writer(tmp_path / 'bag', [], [SCENE], JOURNAL, {}, resume=files) as writer:
        assert (writer.last_time, writer.state_wanted) == (START + 900, True)
        writer.message('/scene', START, START, scene_text('x'))
    assert [path.name for path in (tmp_path / 'bag').glob('*.mcap')] == ['bag_11.mcap']
    with Recording(tmp_path / 'bag' / 'bag_11.mcap') as recording:
        assert recording.start_time == recording.end_time == START + 900


def test_ticks_that_the_disk_refuses_are_told_and_can_come_again(tmp_path):
    ticks, full = Ticks(0, 3000), [False]
    columns, rows = (ticks.stamps, ticks.wall_clock), list(ticks.rows.values())
    with Writer(tmp_path / 'bag', TICKING, [], JOURNAL, {}) as writer:
        flush = writer.flush

        def refuses():
            if full[0]:
                raise OSError(errno.ENOSPC, 'No space left on device')
            flush()
        writer.flush = refuses
        full[0] = True
        done = writer.ticks(0, *columns, rows)
        assert 0 < done < 3000    # until the first chunk is full
        for _ in range(2):
            with pytest.raises(OSError, match='No space left'):
                writer.ticks(done, *(column[done:] for column in columns),
                             [some[done:] for some in rows])
        full[0] = False
        assert writer.ticks(done, *(column[done:] for column in columns),
                            [some[done:] for some in rows]) == 3000 - done
    with Recording(tmp_path / 'bag') as recording:
        np.testing.assert_array_equal(recording.read('/energy')['data'], ticks.energy)


def test_empty_recording_is_whole(tmp_path):
    Writer(tmp_path / 'bag', TICKING, [], JOURNAL, ABOUT).close()
    with Reader(tmp_path / 'bag') as reader:
        assert reader.message_count == 0
        assert len(reader.connections) == 5
    recording = Recording(tmp_path / 'bag')
    assert (recording.start_time, recording.end_time) == (0, 0)
    assert {topic.count for topic in recording.topics.values()} == {0}


def test_real_racket_takes_at_most_095_of_its_payload(tmp_path):
    from rigid_body_sim.simulation.simulation import Simulation
    simulation, ticks = Simulation('tennis_racket'), Ticks(0, 20_000)
    states = simulation.states(np.arange(20_000) / 1000)
    energy, momentum = simulation.diagnose(states)
    rows = [
        packer.pack_many(columns)
        for packer, columns in zip(
            PACKERS.values(),
            (
                {
                    'header.stamp': ticks.stamps,
                    'pose.position': states.position,
                    'pose.orientation': states.orientation,
                },
                {'header.stamp': ticks.stamps, 'vector': states.angular_velocity},
                {'data': energy},
                {'data': momentum},
            ),
            strict=True,
        )
    ]
    with Writer(tmp_path / 'bag', TICKING, [], JOURNAL, ABOUT) as writer:
        for first in range(0, 20_000, 100):     # as the node does: a chunk every 0.1 s
            part = slice(first, first + 100)
            writer.ticks(
                first, ticks.stamps[part], ticks.wall_clock[part], [one[part] for one in rows]
            )
            writer.flush()
    size = sum(file.stat().st_size for file in (tmp_path / 'bag').iterdir())
    assert size <= 0.95 * sum(
        one.size for one in rows
    )  # measured: 0.922 (payload 3.2 MB; of that 0.40 are indexes)


@pytest.mark.skipif(
    shutil.which('rerun') is None,
    reason='no program "rerun" on the path (pip install rerun-sdk, 800 MB)',
)
@pytest.mark.parametrize('mended', [False, True], ids=['whole', 'mended'])
def test_rerun_finds_no_fault(tmp_path, recording, mended):
    path = tmp_path / 'racket_0.mcap'
    path.write_bytes((recording / 'racket_0.mcap').read_bytes()[:-1000 if mended else None])
    assert recover(path)[0].changed == mended
    checked = subprocess.run(['rerun', 'mcap', 'check', str(path)], capture_output=True, text=True,
                             check=False)
    assert checked.returncode == 0
    assert checked.stdout.count('ok ') == 6


@pytest.mark.parametrize(
    ('place', 'problem'),
    [('there', 'exists already'), ('file/bag', 'no recording can be made here')],
)
def test_places_that_will_not_do_are_refused(tmp_path, place, problem):
    (tmp_path / 'there').mkdir()
    (tmp_path / 'file').write_text('')
    with pytest.raises(BadInput, match=problem):
        Writer(tmp_path / place, TICKING, [], JOURNAL, {})


def test_unknown_compression_and_twice_the_same_topic_are_refused(tmp_path):
    with pytest.raises(BadInput, match="'gzip'; one of zstd, lz4, none"):
        Writer(tmp_path / 'bag', TICKING, [], JOURNAL, {}, 'gzip')
    with pytest.raises(BadInput, match='two have the same name'):
        Writer(tmp_path / 'bag', TICKING, [Topic('/pose', 'std_msgs/msg/String')], JOURNAL, {})
    assert not (tmp_path / 'bag').exists()
