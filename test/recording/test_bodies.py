# SPDX-License-Identifier: Apache-2.0
"""A recording from Python: scene, states, events and commands of a body, and tables of topics."""

import sys

import numpy as np
import pytest
from mcap.writer import Writer as TheirWriter
from packing import Packed
from recording.conftest import START, Ticks

from rigid_body_sim import Recording
from rigid_body_sim.cli.simulate import main as simulate
from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages import cdr
from rigid_body_sim.messages.definitions import definition
from rigid_body_sim.recording.topics import Topic, journal_message, journal_topic
from rigid_body_sim.recording.writer import Writer
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.simulation.simulation import Simulation

WRENCH = 'geometry_msgs/msg/WrenchStamped'
FLIGHT = [
    '--set',
    'initial.velocity=[0.1,0.2,0.3]',
    '--set',
    'initial.angular_velocity=[0.3,5,0.2]',
]


@pytest.fixture(scope='module')
def flight(tmp_path_factory):
    """Return the path of the racket in flight, 10 s at 100 Hz, by `simulate`."""
    path = tmp_path_factory.mktemp('python') / 'flight'
    assert simulate(['--duration', '10', '--rate', '100', '--output', str(path), *FLIGHT]) == 0
    return path


def test_scene_and_states_are_those_of_the_simulation(flight):
    scene = load_scene('tennis_racket', [word for word in FLIGHT if word != '--set'])
    expected = Simulation(scene, rate=100.0).states(np.arange(1001) / 100)
    with Recording(flight) as recording:
        assert recording.scene().text == scene.text
        states = recording.states()
    assert len(states) == 1001
    np.testing.assert_allclose(states.time, expected.time, rtol=1e-15, atol=1e-9)
    for name in ('orientation', 'angular_velocity', 'position'):
        np.testing.assert_array_equal(getattr(states, name), getattr(expected, name))
    assert np.isnan(states.velocity).all()      # odom was not recorded


def test_states_of_an_interval_keep_their_times(flight):
    with Recording(flight) as recording:
        whole = recording.states()
        some = recording.states(start=recording.start_time + 2 * 10**9,
                                end=recording.start_time + 3 * 10**9)
        none = recording.states(start=recording.end_time + 1)
    np.testing.assert_array_equal(some.vector[:, 0], whole.vector[200:301, 0])
    assert none.vector.shape == (0, 14)


def bag(path, entries, about=None):
    """Make a recording of messages: (topic, type, log time since START, values)."""
    types = {name: kind for name, kind, _, _ in entries}
    with Writer(path, [], [Topic(name, kind) for name, kind in types.items()], journal_topic(),
                about or {}) as writer:
        for name, kind, time, values in entries:
            if values is not None:
                writer.message(name, START + time, START + time, cdr.encode(kind, values))
    return path


POSE, TURN = 'geometry_msgs/msg/PoseStamped', 'geometry_msgs/msg/Vector3Stamped'


def stamped(time, **values):
    return {'header': {'stamp': {'sec': 100, 'nanosec': time}}, **values}


def test_states_are_those_of_stamps_that_both_topics_have(tmp_path):
    """The only body's topics were renamed; one of pose and of angular_velocity is missing."""
    entries = [(name, kind, time, stamped(time, **values(time))) for name, kind, times, values in (
        ('/at', POSE, (3, 5, 8, 9), lambda time: {'pose': {'position': {'y': float(time)}}}),
        ('/turn', TURN, (3, 8, 9, 12), lambda time: {'vector': {'z': -float(time)}}))
        for time in times]
    about = {'topics': '{"pose": "/at", "angular_velocity": "/turn", "odom": 3}'}
    with Recording(bag(tmp_path / 'a', entries, about)) as recording:
        states = recording.states()
        for alone in (5, 12):    # one of them has messages in this interval, the other none
            assert len(recording.states(start=START + alone, end=START + alone)) == 0
    assert states.time.tolist() == [0.0, 5e-9, 6e-9]
    assert states.position[:, 1].tolist() == [3.0, 8.0, 9.0]
    assert states.angular_velocity[:, 2].tolist() == [-3.0, -8.0, -9.0]
    assert np.isnan(states.velocity).all()
    for topics in ('[]', '{', '{"pose": 3}'):
        with Recording(bag(tmp_path / f'b{len(topics)}', entries, {'topics': topics})) as one, \
                pytest.raises(BadInput, match='were not both recorded'):
            one.states()


def test_a_topic_without_a_message_or_of_another_type_was_not_recorded(tmp_path):
    entries = [('/pose', POSE, 0, stamped(0)), ('/angular_velocity', TURN, 0, None),
               ('/events', 'std_msgs/msg/String', 0, {'data': 'flip'})]
    with Recording(bag(tmp_path / 'a', entries)) as recording:
        with pytest.raises(BadInput, match='were not both recorded'):
            recording.states()
        assert recording.events() == []


def test_the_scene_is_that_of_the_journal_or_else_the_latched_one(tmp_path):
    texts = [load_scene(name).text for name in ('tennis_racket', 'heavy_top')]
    entries = [('/scene', 'std_msgs/msg/String', 0, {'data': texts[0]})]
    for about, name in (({'scene': texts[1]}, 'heavy_top'), ({}, 'tennis_racket'),
                        ({'scene': ''}, 'tennis_racket')):
        with Recording(bag(tmp_path / f'a{len(about)}{name}', entries, about)) as recording:
            assert recording.scene().name == name


def test_velocity_comes_from_odom_turned_into_the_world(tmp_path):
    ticks = Ticks(0, 50)
    turn = np.array([np.sin(0.3), 0.0, 0.0, np.cos(0.3)])       # 0.6 rad about x
    packers = {'/odom': Packed('nav_msgs/msg/Odometry', {}),
               '/pose': Packed('geometry_msgs/msg/PoseStamped', {}),
               '/angular_velocity': Packed('geometry_msgs/msg/Vector3Stamped', {})}
    columns = {'/odom': {'twist.twist.linear': np.tile([0.0, 2.0, 0.0], (50, 1))},
               '/pose': {'pose.orientation': np.tile(turn, (50, 1))}, '/angular_velocity': {}}
    ticking = [(Topic(name, packer.type_name), packer.size) for name, packer in packers.items()]
    with Writer(tmp_path / 'bag', ticking, [], journal_topic(), {}) as writer:
        writer.ticks(0, ticks.stamps, ticks.stamps, [
            packer.pack_many({'header.stamp': ticks.stamps, **columns[name]})
            for name, packer in packers.items()])
    with Recording(tmp_path / 'bag') as recording:
        velocity = recording.states().velocity
    np.testing.assert_allclose(velocity, np.tile([0.0, 2 * np.cos(0.6), 2 * np.sin(0.6)], (50, 1)),
                               atol=1e-15)


def test_events_carry_name_time_and_values(flight):
    with Recording(flight) as recording:
        flips = [event for event in recording.events() if event.name == 'flip']
        assert len(flips) > 1
        for event in flips:
            assert event.log_time == recording.start_time + int(event.values['tick']) * 10**7
            assert event.time == (event.log_time - recording.start_time) / 1e9


def test_commands_come_from_the_journal_with_their_ticks(tmp_path):
    journal = journal_topic('/left')
    sent = [{'topic': 'cmd_impulse', 'frame': 'body', 'force': [1, 2, 3], 'torque': [4, 5, 6]},
            {'topic': 'cmd_wrench', 'frame': 'world', 'force': [0, 0, 1], 'torque': [0, 0, 0]}]
    with Writer(tmp_path / 'bag', [], [], journal, {}) as writer:
        for tick, some in ((3, sent), (7, sent[:1])):
            writer.message(journal.name, START + tick, START,
                           journal_message('commands', tick=tick, commands=some))
    with Recording(tmp_path / 'bag') as recording:
        commands = recording.commands()
    assert commands['tick'].tolist() == [3, 3, 7]
    assert commands['log_time'].tolist() == [START + 3, START + 3, START + 7]
    assert commands['topic'].tolist() == ['cmd_impulse', 'cmd_wrench', 'cmd_impulse']
    assert commands['frame'].tolist() == ['body', 'world', 'body']
    np.testing.assert_array_equal(commands['force'], [[1, 2, 3], [0, 0, 1], [1, 2, 3]])
    np.testing.assert_array_equal(commands['torque'], [[4, 5, 6], [0, 0, 0], [4, 5, 6]])


@pytest.fixture
def theirs(tmp_path):
    """Return the path of a recording of another writer: two bodies, commands, a foreign topic."""
    path = tmp_path / 'theirs.mcap'
    text = 'float64[] ranges\nstring label\n'
    messages = [('/left/pose', 'geometry_msgs/msg/PoseStamped', {}, None),
                ('/right/pose', 'geometry_msgs/msg/PoseStamped', {}, None),
                ('/left/cmd_wrench', WRENCH, {'header': {'frame_id': 'hand'},
                                              'wrench': {'force': {'x': 1.0, 'z': -2.0}}}, None),
                ('/scan', 'their_msgs/msg/Scan', None, text)]
    ranges = b'\0\1\0\0' + b'\2\0\0\0' + bytes(4) + np.array([1.5, 2.5]).tobytes() \
        + b'\3\0\0\0ab\0'
    with open(path, 'wb') as stream:
        writer = TheirWriter(stream)
        writer.start('ros2', 'theirs')
        for topic, kind, values, own in messages:
            schema = writer.register_schema(kind, 'ros2msg',
                                            (own or definition(kind).text).encode())
            channel = writer.register_channel(topic, 'cdr', schema)
            data = ranges if values is None else cdr.encode(kind, values)
            writer.add_message(channel, START, data, START)
        writer.finish()
    return path


def test_without_a_journal_commands_are_the_messages_themselves(theirs):
    with Recording(theirs) as recording:
        commands = recording.commands('/left')
        assert recording.commands('/right')['force'].shape == (0, 3)
    assert {name: column.tolist() for name, column in commands.items()} == {
        'log_time': [START], 'tick': [-1], 'topic': ['cmd_wrench'], 'frame': ['hand'],
        'force': [[1.0, 0.0, -2.0]], 'torque': [[0.0, 0.0, 0.0]]}


def test_commands_of_both_topics_come_in_the_order_of_time(tmp_path):
    path = tmp_path / 'two.mcap'
    with open(path, 'wb') as stream:
        writer = TheirWriter(stream)
        writer.start('ros2', 'theirs')
        pose = writer.register_schema(POSE, 'ros2msg', definition(POSE).text.encode())
        kind = writer.register_schema(WRENCH, 'ros2msg', definition(WRENCH).text.encode())
        channels = {name: writer.register_channel(name, 'cdr', schema) for name, schema in (
            ('/pose', pose), ('/cmd_impulse', kind), ('/cmd_wrench', kind))}
        for name, time in (('/cmd_impulse', 5), ('/cmd_wrench', 3), ('/cmd_impulse', 1),
                           ('/cmd_wrench', 7)):
            writer.add_message(channels[name], START + time, cdr.encode(
                WRENCH, {'wrench': {'torque': {'y': float(time)}}}), START)
        writer.finish()
    with Recording(path) as recording:
        commands = recording.commands()
    assert (commands['log_time'] - START).tolist() == [1, 3, 5, 7]
    assert commands['topic'].tolist() == ['cmd_impulse', 'cmd_wrench'] * 2
    assert commands['torque'].tolist() == [[0.0, time, 0.0] for time in (1.0, 3.0, 5.0, 7.0)]
    assert commands['force'].shape == (4, 3)


def test_foreign_topics_are_read_by_their_recorded_definition(theirs):
    with Recording(theirs) as recording:
        assert repr(recording.topics['/scan']) == '<1 messages their_msgs/msg/Scan>'
        assert recording.read('/scan')['ranges'].tolist() == [[1.5, 2.5]]
        assert list(recording.decoded('/scan')) == [
            (START, {'ranges': [1.5, 2.5], 'label': 'ab'})]


def test_the_body_has_to_be_named_where_there_are_several(theirs, flight):
    with Recording(theirs) as recording:
        with pytest.raises(BadInput, match=r'several bodies.*one of /left, /right'):
            recording.states()
        with pytest.raises(BadInput, match=r"namespace '/up'; namespace= one of /left, /right"):
            recording.commands('/up')
        with pytest.raises(BadInput, match='pose and angular_velocity were not both recorded'):
            recording.states('/left')
        with pytest.raises(BadInput, match='the scene was not recorded'):
            recording.scene('/left')
    with Recording(flight) as recording:
        assert len(recording.states('/')) == 1001


def test_a_topic_as_pandas(flight):
    pandas = pytest.importorskip('pandas')
    with Recording(flight) as recording:
        frame, pose = recording.to_pandas('/pose'), recording.read('/pose')
    assert isinstance(frame, pandas.DataFrame)
    np.testing.assert_array_equal(frame['pose.orientation.w'], pose['pose.orientation'][:, 3])
    np.testing.assert_allclose(frame.index, np.arange(1001) / 100, atol=1e-9)


def test_a_topic_as_xarray(flight):
    pytest.importorskip('xarray')
    with Recording(flight) as recording:
        found, pose = recording.to_xarray('/pose'), recording.read('/pose')
    turned = found['pose.orientation'].sel({'pose.orientation.component': 'w'})
    np.testing.assert_array_equal(turned, pose['pose.orientation'][:, 3])
    assert found['time'].attrs['units'] == 's'
    np.testing.assert_allclose(found['time'], np.arange(1001) / 100, atol=1e-9)
    assert found['pose.orientation'].dims == ('time', 'pose.orientation.component')
    assert found['header.frame_id'].dims == ('time',)
    assert set(found['header.frame_id'].values.tolist()) == {'world'}


@pytest.mark.parametrize('name', ['pandas', 'xarray'])
def test_what_is_not_installed_is_said_in_one_line(flight, monkeypatch, name):
    monkeypatch.setitem(sys.modules, name, None)
    line = f'{name}: is not installed; pip install {name}'
    with Recording(flight) as recording, pytest.raises(BadInput, match=line):
        getattr(recording, f'to_{name}')('/pose')
