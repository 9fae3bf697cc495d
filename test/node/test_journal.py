# SPDX-License-Identifier: Apache-2.0
"""A node's recording: states as published, and every command, reset and change with its tick."""

import datetime
import types

import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped, Vector3, Wrench, WrenchStamped
from mcap.reader import make_reader
from node.conftest import START
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from std_srvs.srv import Trigger

from rigid_body_sim.analysis.resimulate import resimulate
from rigid_body_sim.errors import BadInput
from rigid_body_sim.node import journal
from rigid_body_sim.recording.command_messages import CommandTopics
from rigid_body_sim.recording.compression import DEFAULT
from rigid_body_sim.recording.reader import Recording
from rigid_body_sim.simulation.simulation import Simulation

RATE = 200.0


def command(frame, **torque):
    message = WrenchStamped(wrench=Wrench(torque=Vector3(**torque)))
    message.header.frame_id = frame
    return message


@pytest.fixture(scope='module')
def recording(tmp_path_factory, run_node_in):
    """Return the recording of a node that was commanded, reset and changed."""
    folder = tmp_path_factory.mktemp('journal')
    with run_node_in(folder, '-p', f'rate:={RATE}', '-p', 'stamp_origin:=zero', '-p',
                     'command_timeout:=0.1', '-p', 'recording.split_seconds:=0.4', '-p',
                     'recording.compression:=lz4') as node:
        client = node.client
        poses = client.collect(PoseStamped, 'pose')
        impulses, wrenches = (client.publisher(WrenchStamped, 'cmd_impulse'),
                              client.publisher(WrenchStamped, 'cmd_wrench'))
        client.until(lambda: len(poses) > 20, what='ticks')
        for k in range(50):
            impulses.publish(command('body' if k % 2 else 'world', x=0.001 * k, y=0.1))
        wrenches.publish(command('world', z=0.3))
        client.spin(0.3)
        assert client.call(Trigger, '/sim_node/reset').success
        client.spin(0.1)
        impulses.publish(command('', z=0.7))
        value = ParameterValue(type=ParameterType.PARAMETER_STRING, string_value='dop8')
        # the node answers when the method is compiled, which it may not be yet
        client.call(SetParameters, '/sim_node/set_parameters', timeout=START,
                    parameters=[Parameter(name='integrator', value=value)])
        client.spin(0.2)
        node.process.terminate()
        assert node.process.wait(5.0) == 0
    [path] = (folder / 'recordings').iterdir()
    return Recording(path)


def test_files_are_split_and_compressed_as_asked(recording):
    files = sorted(recording.path.glob('*.mcap'))
    assert len(files) > 1
    for path in files:
        with open(path, 'rb') as stream:
            summary = make_reader(stream).get_summary()
        assert {index.compression for index in summary.chunk_indexes} == {'lz4'}
        # and what came in a last chunk
        assert summary.statistics.message_end_time - summary.statistics.message_start_time < 1.4e9
    # each begins with all about the run, and a moment later the full state: the last one may have
    # ended before
    assert len(entries(recording, 'begin')) == len(files)
    assert len(entries(recording, 'state')) in (len(files) - 1, len(files))


def entries(recording, kind):
    return [entry for entry in recording.journal() if entry['kind'] == kind]


def test_every_command_stands_there_with_its_tick_in_order(recording):
    given = [(entry['tick'], one) for entry in entries(recording, 'commands')
             for one in entry['commands']]
    impulses = [one for _, one in given if one['topic'] == 'cmd_impulse']
    assert [one['torque'][0] for one in impulses] == [*(0.001 * k for k in range(50)), 0.0]
    assert {one['frame'] for one in impulses} == {'body', 'world'}
    [hold] = [tick for tick, one in given if one['topic'] == 'cmd_wrench']
    [release] = [tick for tick, one in given if one['topic'] == 'release']
    # 0.1 s of ticks
    assert release - hold == 20
    assert [tick for tick, _ in given] == sorted(tick for tick, _ in given)


def test_resets_and_changes_stand_there_with_their_ticks(recording):
    [reset], [change] = entries(recording, 'reset'), entries(recording, 'parameters')
    assert change['tick'] > reset['tick'] > 0
    assert change['changed'] == {'integrator': 'dop8'}
    assert (change['simulation']['method'], change['keeps_state']) == ('dop8', True)
    assert change['scene'].startswith('scene: tennis_racket\n')


def test_recording_alone_gives_every_state_again_to_the_last_bit(recording):
    """The scene and the journal's commands give every recorded pose and velocity, bit for bit."""
    simulation = Simulation('tennis_racket', rate=RATE)
    acts = {}
    for entry in recording.journal():
        if entry['kind'] in ('commands', 'reset', 'parameters'):
            acts.setdefault(entry['tick'], []).append(entry)
    poses = recording.read('/pose', ['header.stamp', 'pose.orientation'])
    spins = recording.read('/angular_velocity', ['vector'])
    stamps = poses['header.stamp']
    assert np.array_equal(stamps, np.arange(len(stamps)) * round(1e9 / RATE))
    assert acts
    assert max(acts) < len(stamps)
    for tick in range(len(stamps)):
        if tick:
            simulation.advance()
        for entry in acts.get(tick, ()):
            simulation = act(simulation, entry)
        assert np.array_equal(simulation.state.orientation, poses['pose.orientation'][tick]), tick
        assert np.array_equal(simulation.state.angular_velocity, spins['vector'][tick]), tick


def act(simulation, entry):
    """Do what an entry of the journal says; return the simulation that goes on."""
    if entry['kind'] == 'reset':
        simulation.reset()
    elif entry['kind'] == 'parameters':
        following = Simulation('tennis_racket', entry['simulation']['integrator'], rate=RATE)
        following.follow(simulation, entry['keeps_state'])
        return following
    else:
        for one in entry['commands']:
            if one['topic'] == 'release':
                simulation.release()
            else:
                {'cmd_impulse': simulation.impulse, 'cmd_wrench': simulation.hold}[one['topic']](
                    one['force'], one['torque'], one['frame'])
    return simulation


def test_topics_that_the_node_remapped_are_run_again_as_well(tmp_path, run_node_in):
    with run_node_in(tmp_path, '-p', f'rate:={RATE}', '-r', 'angular_velocity:=lab/omega',
                     '-r', 'angular_momentum_squared:=L2') as node:
        poses = node.client.collect(PoseStamped, 'pose')
        node.client.until(lambda: len(poses) > 20, what='ticks')
        node.process.terminate()
        assert node.process.wait(5.0) == 0
    [path] = (tmp_path / 'recordings').iterdir()
    [(_, _, comparison)] = resimulate(path)
    assert comparison.topics['angular_velocity'] == '/lab/omega'
    assert len(comparison.topics) == 4
    assert comparison.parting is None
    with Recording(path) as opened:
        assert comparison.messages == 4 * len(opened.states())


class Chosen(dict):
    """Parameters by name, and the recordings that the node made."""

    def __init__(self, folder, name):
        super().__init__({'recording.directory': str(folder), 'recording.name': name})
        self.recordings = set()


NODE = types.SimpleNamespace(get_fully_qualified_name=lambda: '/lab/left/sim_node')


def test_a_recording_has_the_name_of_node_scene_and_time_and_a_number_if_that_is_taken(
        tmp_path, monkeypatch):
    monkeypatch.setattr(journal, 'datetime', types.SimpleNamespace(datetime=types.SimpleNamespace(
        now=lambda: datetime.datetime(2026, 3, 4, 5, 6, 7))))
    name = 'lab_left_sim_node_racket_2026-03-04_05-06-07'
    for expected in (name, f'{name}_2', f'{name}_3'):
        path = journal._free_path(NODE, Chosen(tmp_path, ''), 'racket')
        assert path == tmp_path / expected
        path.mkdir()


def test_a_name_that_was_asked_for_is_numbered_only_after_recordings_of_this_node(tmp_path):
    settings = Chosen(tmp_path, 'run')
    (tmp_path / 'run').mkdir()    # of somebody else: the recorder will refuse it
    for expected in ('run', 'run_2', 'run_3'):
        path = journal._free_path(NODE, settings, 'racket')
        assert path == tmp_path / expected
        settings.recordings.add(path)


@pytest.mark.parametrize('name', ['a/b', '/a', '.', 'a/'])
def test_a_name_is_one_word_of_a_path(tmp_path, name):
    with pytest.raises(BadInput, match=r'parameter recording\.name'):
        journal._free_path(NODE, Chosen(tmp_path, name), 'racket')


def begun(monkeypatch, folder, name, full, refused, asked='auto'):
    """Begin a recording whose recorder is refused so often; return the paths tried, and the rest.

    Another recording takes the name of each that is refused, unless the disk is full.
    """
    tried = []

    def recorder(path, ticking, others, topic, told, *options):
        tried.append((path, others, options))
        if len(tried) <= refused:
            if not full:
                path.mkdir(exist_ok=True)
            raise BadInput(str(path), 'exists', 'another name')
        return types.SimpleNamespace(tick=None, status=lambda: 'as it began')
    monkeypatch.setattr(journal, 'Recorder', recorder)
    monkeypatch.setattr(journal.about, 'about', lambda *_: {})
    node = types.SimpleNamespace(
        get_fully_qualified_name=lambda: '/left/sim', get_namespace=lambda: '/left',
        resolve_topic_name=lambda name: f'/left/{name}')
    publishing = types.SimpleNamespace(
        others=list, every_tick=list, names=list,
        messages=types.SimpleNamespace(ticking=types.SimpleNamespace(sizes=())))
    settings = Chosen(folder, name)
    settings |= {'recording.compression': asked, 'recording.split_bytes': 7.0,
                 'recording.split_seconds': 3.0}
    settings.values = {}
    try:
        found = journal.Journal(
            node, settings, types.SimpleNamespace(scene=types.SimpleNamespace(name='racket')),
            publishing, types.SimpleNamespace(world='world', body='body'))
    except BadInput:
        return tried, None, settings.recordings
    assert found.status == 'as it began'
    return tried, found.path, settings.recordings


@pytest.mark.parametrize(('name', 'full', 'refused', 'tries', 'begins'), [
    ('', False, 0, 1, True), ('', False, 1, 2, True), ('', False, 4, 5, True),
    ('', False, 5, 5, False), ('', True, 1, 1, False), ('run', False, 1, 1, False),
    ('run', False, 0, 1, True)])
def test_a_name_that_another_recording_took_meanwhile_is_left_to_it(
        monkeypatch, tmp_path, name, full, refused, tries, begins):
    """Five names are tried, unless the user gave the name or there is another reason."""
    tried, path, recordings = begun(monkeypatch, tmp_path, name, full, refused)
    assert len({path for path, *_ in tried}) == len(tried) == tries
    assert (path, recordings) == ((tried[-1][0], {tried[-1][0]}) if begins else (None, set()))


@pytest.mark.parametrize(('asked', 'compression'), [('auto', DEFAULT), ('lz4', 'lz4')])
def test_a_recording_is_begun_as_it_was_asked_for(monkeypatch, tmp_path, asked, compression):
    [(_, others, options)], *_ = begun(monkeypatch, tmp_path, '', False, 0, asked)
    assert options[:3] == (compression, 7.0, 3.0)
    # by the numbers of command_rows.py: impulse, then wrench; world, then body
    assert options[3] == CommandTopics(
        ('/left/cmd_impulse', '/left/cmd_wrench'), ('world', 'body'))
    assert {topic.name for topic in others} == set(options[3].topics)


def test_the_full_state_is_wanted_no_more_when_it_is_there(monkeypatch):
    noted, one = [], object.__new__(journal.Journal)
    one._recorder = types.SimpleNamespace(state_wanted=True, journal=lambda kind, stamp, now,
                                          **values: noted.append((kind, stamp, values)))
    monkeypatch.setattr(journal.about, 'state_entry', lambda *told: {'told': told})
    simulation = types.SimpleNamespace(tick=3)
    one.state(simulation, 70)
    assert noted == [('state', 70, {'told': (3, 70, simulation)})]
    assert one._recorder.state_wanted is False
