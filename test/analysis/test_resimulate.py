# SPDX-License-Identifier: Apache-2.0
"""A recorded run, run again from the recording alone: the same bits, or the first that differs."""

import json
import pathlib
import types

import numpy as np
import pytest
from analysis import made
from near import near
from recording.damage import without_checksums
from rosbags.rosbag2 import Reader, StoragePlugin
from rosbags.rosbag2 import Writer as ForeignWriter
from rosbags.typesys import Stores, get_typestore

from rigid_body_sim.analysis import resimulate
from rigid_body_sim.analysis.rerun import Rerun
from rigid_body_sim.analysis.resimulate import main
from rigid_body_sim.analysis.source import sources
from rigid_body_sim.cli.simulate import main as simulate
from rigid_body_sim.recording import about, metadata
from rigid_body_sim.recording.reader import Recording
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.simulation import arithmetic
from rigid_body_sim.simulation.simulation import Simulation

DATA = pathlib.Path(__file__).resolve().parents[1] / 'data'
ZERO = (0.0, 0.0, 0.0)
ACTS = {0: [('cmd_impulse', ZERO, (0.1, 0.0, 0.2), 'body')],
        500: [('cmd_impulse', (1.0, 2.0, 3.0), (0.5, 0.1, 0.0), 'world'),
              ('cmd_impulse', ZERO, (-0.5, -0.1, 0.0), 'world')],
        900: [('cmd_wrench', (0.1, 0.2, 0.3), (0.3, 2.0, 0.1), 'body')],
        901: [('cmd_impulse', ZERO, (0.0, 0.0, 1.0), 'body')],
        1300: [('cmd_wrench', ZERO, (0.0, 0.0, -1.0), 'world')],
        1500: [('release', ZERO, ZERO, 'world')],
        1700: [('reset',), ('cmd_impulse', ZERO, (0.0, 0.3, 0.0), 'world')],
        1900: [('cmd_impulse', ZERO, (0.0, -0.3, 0.0), 'world')]}


@pytest.fixture(scope='module')
def commanded(tmp_path_factory):
    """Return the path of a recording with every kind of command and a gap around one of them."""
    path = tmp_path_factory.mktemp('resimulate') / 'commanded'
    made.record(path, 'tennis_racket', 2200, acts=ACTS, left_out=range(880, 920))
    return path


def outcome(capsys, *arguments):
    status = main([*map(str, arguments), '--json'])
    return status, json.loads(capsys.readouterr().out)['bodies'][0]


def test_commands_resets_and_gaps_are_reproduced_to_the_bit(commanded, capsys):
    assert main([str(commanded)]) == 0
    assert capsys.readouterr().out == 'identical, 2161 states (8644 messages)\n'


@pytest.mark.without_numba
@pytest.mark.parametrize('known', [None, 3e-9])
def test_the_method_that_auto_chose_is_taken_again_whatever_was_known_of_its_error(known):
    """Nobody knew where a strike comes later than trials go; `auto` would choose anew."""
    scene = load_scene('asymmetric_top')
    asked = about.run_of(Simulation(scene, 'auto', accuracy=1e-6)) | {
        'method': 'dop8', 'tolerance': 3e-8, 'expected_error': known, 'met_until': known}
    entries = [{'kind': 'begin', 'scene': scene.text, 'simulation': json.dumps(asked)},
               {'kind': 'state', 'tick': 0, 'stamp': 0, 'log_time': 0}]
    choice = Rerun(entries, {}).simulation.choice
    assert (choice.method, choice.tolerance, choice.expected_error) == ('dop8', 3e-8, known)


def test_a_stamp_that_lies_years_away_is_a_jump_without_a_search_for_events(tmp_path):
    """A damaged stamp of one message may lead there; a racket flips all the way."""
    made.record(tmp_path / 'run', 'tennis_racket', 120)
    with Recording(tmp_path / 'run') as recording:
        [source] = sources(recording)
        rerun = Rerun(source.entries, {})
        rerun.to(10**7)
    assert rerun.simulation.tick == 10**7
    assert rerun.simulation.events == []


def test_what_simulate_wrote_is_reproduced_to_the_bit(tmp_path, capsys):
    assert simulate([
        '--duration', '12.3', '--rate', '789', '--output', str(tmp_path / 'run')]) == 0
    capsys.readouterr()
    status, found = outcome(capsys, tmp_path / 'run')
    assert (status, found['identical'], found['states']) == (0, True, 9706)


def test_one_bit_in_one_message_is_found(commanded, tmp_path, capsys):
    """The last bit of omega_y at tick 1234 is flipped on the disk, in an uncompressed copy."""
    recording = Recording(commanded)
    value = recording.read('/angular_velocity')['vector'][1234 - 40, 1]
    damaged = rewritten(
        commanded, tmp_path / 'damaged', np.float64(value), np.nextafter(value, np.inf))
    status, found = outcome(capsys, damaged, '--output', tmp_path)
    assert status == 1 and not found['identical']
    parting = found['parting']
    assert (parting['tick'], parting['quantity']) == (1234, 'angular_velocity')
    assert (parting['recorded'][1] == np.nextafter(value, np.inf)
            and parting['resimulated'][1] == value)
    assert main([str(damaged), '--output', str(tmp_path)]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == 'differs from tick 1234 on (t = 1.234 s), angular velocity:'
    assert repr(float(value)) in lines[2]
    assert (tmp_path / 'difference.png').stat().st_size > 10_000
    rows = [line.split(',') for line in (tmp_path / 'difference.csv').read_text().splitlines()[1:]]
    assert {row[1] for row in rows if float(row[2]) > 0.0} == {'1.234'}


def rewritten(source, folder, old, new):
    """Return a copy of a recording, without compression, in which one number is another."""
    from rigid_body_sim.recording.topics import Topic
    from rigid_body_sim.recording.writer import Writer
    recording = Recording(source)
    topics = [Topic(name, topic.type)
              for name, topic in recording.topics.items() if name != '/journal']
    journal = Topic('/journal', recording.topics['/journal'].type)
    changed = 0
    with Writer(folder, [], topics, journal, {}, 'none') as writer:
        for message in recording.messages():
            data = message.data
            if message.topic == '/angular_velocity' and old.tobytes() in data:
                data, changed = data.replace(old.tobytes(), new.tobytes()), changed + 1
            writer.message(message.topic, message.log_time, message.publish_time, data)
    assert changed == 1
    return folder


def test_a_converted_recording_without_our_metadata_is_reproduced(commanded, tmp_path, capsys):
    """After `ros2 bag convert` the journal is enough.

    Chunks are other ones, and metadata record, custom_data and sequence numbers are lost.
    """
    copy = rewritten(commanded, tmp_path / 'copy',
                     np.float64(Recording(commanded).read('/angular_velocity')['vector'][7, 0]),
                     np.float64(0.0))
    path = copy / metadata.FILE_NAME
    bag = metadata.load(path.read_text())
    bag[metadata.ROOT]['custom_data'] = None
    path.write_text(metadata.dump(bag))
    status, found = outcome(capsys, copy, '--output', tmp_path)
    assert status == 1 and found['parting']['tick'] == 7 and found['states'] == 2161
    assert found['largest']['orientation']['difference'] == 0.0


def test_gaps_of_any_length_are_skipped_not_computed(tmp_path, capsys, monkeypatch):
    """1500 ticks are missing, with commands among them; and runs are compared piece by piece."""
    from rigid_body_sim.analysis import compare
    made.record(tmp_path / 'run', 'tennis_racket', 2200, acts=ACTS, left_out=range(400, 1900))
    assert main([str(tmp_path / 'run')]) == 0
    assert capsys.readouterr().out == 'identical, 701 states (2804 messages)\n'
    monkeypatch.setattr(compare, 'SPAN', 7)
    assert main([str(tmp_path / 'run')]) == 0
    assert capsys.readouterr().out == 'identical, 701 states (2804 messages)\n'


@pytest.mark.parametrize('writer', ['mcap', 'rosbags'])
def test_a_recording_written_again_by_others_is_reproduced(commanded, tmp_path, capsys, writer):
    """Other chunks, other channel numbers, no metadata of ours: as after `ros2 bag convert`."""
    if writer == 'mcap':
        path = tmp_path / 'again.mcap'
        path.write_bytes((commanded / f'{commanded.name}_0.mcap').read_bytes())
        without_checksums(path)
    else:
        path, store = tmp_path / 'again', get_typestore(Stores.ROS2_JAZZY)
        with Reader(commanded) as reader, ForeignWriter(
                path, version=9, storage_plugin=StoragePlugin.MCAP) as copy:
            numbers = {one.topic: copy.add_connection(one.topic, one.msgtype, typestore=store)
                       for one in reader.connections}
            for connection, stamp, data in reader.messages():
                copy.write(numbers[connection.topic], stamp, data)
    assert main([str(path)]) == 0
    assert capsys.readouterr().out == 'identical, 2161 states (8644 messages)\n'


@pytest.mark.without_numba
def test_another_method_shows_what_it_would_have_changed(commanded, tmp_path, capsys):
    status, found = outcome(
        capsys, commanded, '--integrator', 'dop8', '--accuracy', '1e-6', '--output', tmp_path)
    assert status == 0 and not found['identical']
    assert found['resimulated']['method'] == 'dop8' and found['recorded']['method'] == 'exact'
    coarse = found['largest']['orientation']['difference']
    assert 1e-11 < coarse < 1e-5
    _, found = outcome(
        capsys, commanded, '--integrator', 'dop8', '--accuracy', '1e-12', '--output', tmp_path)
    assert found['largest']['orientation']['difference'] < 1e-3 * coarse
    assert (tmp_path / 'difference.png').exists()


def test_bits_are_promised_on_every_machine_by_the_same_arithmetic(
        commanded, tmp_path, monkeypatch, capsys):
    """Another processor, C library or Python is no excuse."""
    monkeypatch.setattr(about, 'machine', lambda: {'processor': 'another'})
    value = Recording(commanded).read('/angular_velocity')['vector'][1234 - 40, 1]
    damaged = rewritten(
        commanded, tmp_path / 'damaged', np.float64(value), np.nextafter(value, np.inf))
    status, found = outcome(capsys, damaged, '--output', tmp_path)
    assert status == 1 and not found['identical'] and found['unpromised'] == []


def test_by_another_arithmetic_the_bits_may_differ_within_a_tolerance(
        commanded, tmp_path, monkeypatch, capsys):
    here = arithmetic.version()
    value = Recording(commanded).read('/angular_velocity')['vector'][1234 - 40, 1]
    damaged = rewritten(
        commanded, tmp_path / 'damaged', np.float64(value), np.nextafter(value, np.inf))
    monkeypatch.setattr(arithmetic, 'version', lambda: 'another')
    status, found = outcome(capsys, damaged, '--output', tmp_path)
    assert status == 0 and not found['identical']
    assert found['unpromised'] == [f'it was made by arithmetic {here}, this is another']
    main([str(damaged), '--output', str(tmp_path)])
    assert 'bits are not promised: it was made by arithmetic' in capsys.readouterr().out
    # a state that is really another one is not excused
    worse = rewritten(commanded, tmp_path / 'worse', np.float64(value), np.float64(value + 1e-6))
    status, found = outcome(capsys, worse, '--output', tmp_path)
    assert status == 1 and found['largest']['orientation']['difference'] == 0.0
    assert outcome(capsys, worse, '--output', tmp_path, '--tolerance', '1e-6')[0] == 0


def test_scipys_methods_promise_their_bits_on_the_same_machine_only(tmp_path, monkeypatch, capsys):
    path = tmp_path / 'run'
    assert simulate(['--duration', '0.05', '--integrator', 'lsoda', '--accuracy', '1e-6',
                     '--output', str(path)]) == 0
    capsys.readouterr()
    status, found = outcome(capsys, path)
    assert (status, found['identical'], found['unpromised']) == (0, True, [])
    monkeypatch.setattr(
        about, 'machine',
        lambda: json.loads(Recording(path).about['machine']) | {'numpy': 'another'})
    assert outcome(capsys, path)[1]['unpromised'] == ['lsoda is compiled for each machine; these '
                                                      'differ: numpy']


@pytest.mark.without_numba
@pytest.mark.parametrize('scene', ['skew_top', 'heavy_top'])
def test_recordings_of_version_0_1_0_are_reproduced_within_the_tolerance_they_state(
        scene, tmp_path, capsys):
    """Made before bits were the same on every machine: by taylor, and in closed form."""
    path = DATA / 'recordings_0.1.0' / scene
    status, found = outcome(capsys, path, '--output', tmp_path)
    assert status == 0 and found['states'] == 301
    assert found['unpromised'] == ['it was made by arithmetic none, this is '
                                   f'{arithmetic.version()}']
    assert found['tolerance'] < 2e-11


@pytest.mark.parametrize('case', ['foreign', 'missing', 'method'])
def test_bad_input_is_one_line(case, tmp_path, commanded, capsys):
    path, more = tmp_path / 'run', []
    said = {'foreign': 'a recording by sim_node or simulate', 'missing': 'holds no metadata.yaml',
            'method': "did you mean 'dop8'?"}[case]
    if case == 'foreign':
        made.record_foreign(path, Simulation('tennis_racket'), 100, 0.001)
    elif case == 'method':
        path, more = commanded, ['--integrator', 'dop9']
    assert main([str(path), *more]) == 2
    error = capsys.readouterr().err
    assert said in error and error.count('\n') == 1


SAME = {'namespace': '/', 'identical': True, 'messages': 20, 'states': 5, 'not_compared': [],
        'unpromised': [], 'good': True, 'tolerance': 1e-9, 'parting': None, 'largest': {}}
OTHER = SAME | {
    'identical': False, 'good': False,
    'parting': {'tick': 7, 'time': 0.07, 'quantity': 'angular_velocity', 'recorded': [1.0, 0.25],
                'resimulated': [1.0, 0.5]},
    'largest': {'angular_velocity': {'difference': 0.25, 'since_start': 0.08}}}
PARTS = ['differs from tick 7 on (t = 0.07 s), angular velocity:', '  recorded    1.0, 0.25',
         '  resimulated 1.0, 0.5',
         '  largest difference of angular velocity: 2.500e-01, 0.08 s after the start']


@pytest.mark.parametrize(('found', 'changed', 'said'), [
    (SAME, False, ['identical, 5 states (20 messages)']),
    (SAME | {'namespace': '/left', 'unpromised': ['x']}, True,
     ['/left: identical, 5 states (20 messages)']),
    (SAME | {'not_compared': ['energy']}, False,
     ['identical in 3 of 4 topics, 5 states (20 messages)', '  not compared: energy (not recorded '
      'under this name, or played again without all of its messages)']),
    (OTHER, False, PARTS), (OTHER | {'namespace': '/left'}, True,
                            [f'/left: as expected, {PARTS[0]}', *PARTS[1:]]),
    (OTHER | {'unpromised': ['another machine']}, True, [f'as expected, {PARTS[0]}', *PARTS[1:]]),
    *[(OTHER | {'unpromised': ['another machine'], 'good': good}, False,
       [*PARTS, '  bits are not promised: another machine',
        f'  allowed are 1.0e-09 rad: the differences are {than}'])
      for good, than in ((True, 'less'), (False, 'more than that explains'))]])
def test_the_outcome_is_told_in_words(found, changed, said):
    assert resimulate.lines(found, changed) == said


@pytest.mark.parametrize(('difference', 'changed', 'unpromised', 'allowed', 'good'), [
    (None, False, [], None, True), (1e-12, False, [], None, False), (1e-12, True, [], None, True),
    (1.0, True, [], None, True), (1e-12, False, ['x'], None, True),
    (0.1, False, ['x'], None, False), (0.1, False, ['x'], 0.11, True),
    (0.1, False, [], 0.11, False), (1e-12, False, ['x'], 0.0, False)])
def test_a_run_is_reproduced_to_the_bit_or_within_what_is_allowed(
        difference, changed, unpromised, allowed, good, monkeypatch):
    monkeypatch.setattr(resimulate, 'broken_promises', lambda rerun: unpromised)
    monkeypatch.setattr(resimulate.about, 'run_of', lambda simulation: {})
    rerun = types.SimpleNamespace(recorded={'method': 'dop8', 'accuracy': 1e-9}, simulation=None)
    differs = difference is not None
    comparison = types.SimpleNamespace(
        parting={'tick': 3} if differs else None, messages=8, ticks=4, turned=10.0,
        topics={'pose': '/pose'},
        largest={'orientation': {'difference': difference, 'since_start': 0.5, 'scale': 1.0}}
        if differs else {})
    found = resimulate.verdict(
        types.SimpleNamespace(namespace='/'), rerun, comparison, changed, allowed)
    assert (found['good'], found['identical']) == (good, not differs)
    assert found['not_compared'] == ['angular_velocity', 'energy', 'angular_momentum_squared']


def test_the_tolerance_is_the_accuracy_that_was_asked_and_round_off_of_the_turns():
    """Ten times the accuracy that was asked; a closed form has round-off only."""
    def allowed(method, turned, accuracy=1e-6):
        return resimulate.tolerance(
            types.SimpleNamespace(recorded={'method': method, 'accuracy': accuracy}),
            types.SimpleNamespace(turned=turned))
    assert allowed('exact', 0.0) == 1e-12
    assert allowed('dop8', 0.0) == near(1e-5 + 1e-12, rel=1e-12)
    # 64 units of 2**-52 for each radian
    assert allowed('exact', 2.0**40) == near(2.0**(6 - 52 + 40) + 1e-12, rel=1e-12)
    assert allowed('dop8', 2.0**40, 1e-3) == near(1e-2 + 2.0**-6 + 1e-12, rel=1e-12)
