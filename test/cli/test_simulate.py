# SPDX-License-Identifier: Apache-2.0
"""The command `simulate`: rosbags reads its recording, and its numbers are those of Simulation."""

import contextlib
import fcntl
import json
import math
import os
import pathlib
import pty
import resource
import signal
import struct
import subprocess
import sys
import termios
import time
import types

import numpy as np
import pytest
import yaml
from notices import without_notices

from rigid_body_sim.analysis.resimulate import main as resimulate
from rigid_body_sim.choice.choose import methods_for
from rigid_body_sim.cli import simulate as module
from rigid_body_sim.cli.simulate import interruptible, main, simulate
from rigid_body_sim.errors import BadInput
from rigid_body_sim.integrators import METHODS
from rigid_body_sim.recording.reader import Recording
from rigid_body_sim.recording.recover import recover
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.simulation.simulation import Simulation

rosbags = pytest.importorskip('rosbags.highlevel')

ROOT = pathlib.Path(__file__).resolve().parents[2]
FLIPPING = """
scene: flipping
body: {mass: 1.0, inertia: [1.0, 2.0, 3.0]}
constraint: free
effects: []
initial: {orientation: [0, 0, 0, 1], angular_velocity: [0.3, 5.0, 0.2],
          position: [1, 2, 3], velocity: [0.1, 0.2, 0.3]}
"""


@pytest.fixture(scope='module')
def flipping(tmp_path_factory):
    """Return the path of a recording of 2 s at 500 Hz, in several blocks and chunks."""
    folder = tmp_path_factory.mktemp('simulate')
    (folder / 'flipping.yaml').write_text(FLIPPING)
    assert main(['--scene', str(folder / 'flipping.yaml'), '--set', 'body.mass=2.0', '--duration',
                 '10', '--rate', '500', '--output', str(folder / 'run')]) == 0
    return folder / 'run'


def read(path):
    """Return {topic: [(log time, message)]} as rosbags reads it."""
    found = {}
    with rosbags.AnyReader([path]) as reader:
        for connection, stamp, data in reader.messages():
            found.setdefault(connection.topic, []).append((
                stamp, reader.deserialize(data, connection.msgtype)))
    return found


def test_a_stranger_reads_every_tick_with_all_its_bits(flipping):
    found = read(flipping)
    assert set(found) == {'/pose', '/angular_velocity', '/energy', '/angular_momentum_squared',
                          '/scene', '/events', '/journal'}
    scene = yaml.safe_load(found['/scene'][0][1].data)
    assert scene['body']['mass'] == 2.0
    simulation = Simulation(
        load_scene(flipping.parent / 'flipping.yaml', ['body.mass=2.0']), rate=500.0)
    epoch = found['/pose'][0][0]
    for name in ('/pose', '/angular_velocity', '/energy', '/angular_momentum_squared'):
        assert [stamp - epoch for stamp, _ in found[name]] == [k * 2_000_000 for k in range(5001)]
    # here the states come one by one, not in blocks
    for k in range(5001):
        pose, omega = found['/pose'][k][1], found['/angular_velocity'][k][1]
        assert (pose.header.frame_id, omega.header.frame_id) == ('world', 'body')
        assert pose.header.stamp.sec * 10**9 + pose.header.stamp.nanosec == found['/pose'][k][0]
        q, p = pose.pose.orientation, pose.pose.position
        recorded = [simulation.time, q.x, q.y, q.z, q.w, omega.vector.x, omega.vector.y,
                    omega.vector.z, p.x, p.y, p.z]
        assert recorded == simulation.vector[:11].tolist()
        assert found['/energy'][k][1].data == simulation.energy
        assert found['/angular_momentum_squared'][k][1].data == simulation.angular_momentum_squared
        simulation.advance()


def test_events_stand_at_their_ticks(flipping):
    simulation = Simulation(flipping.parent / 'flipping.yaml', rate=500.0)
    simulation.advance(5000)
    found = read(flipping)
    events = found['/events']
    assert len(events) == len(simulation.events) == 3
    for (stamp, message), event in zip(events, simulation.events, strict=True):
        values = {pair.key: pair.value for pair in message.values}
        assert (message.name, values['tick'], values['time']) == (
            event.name, str(event.tick), repr(float(event.time)))
        assert stamp == found['/pose'][event.tick][0]


def test_it_says_all_that_is_needed_to_run_it_again(flipping):
    recording = Recording(flipping)
    about = {key: json.loads(recording.about[key])
             for key in ('simulation', 'parameters', 'machine')}
    assert recording.about['made_by'] == 'simulate' and recording.about['version']
    assert about['simulation'] == {
        'integrator': 'auto', 'accuracy': 1e-12, 'step': None, 'rate': 500.0, 'method': 'exact',
        'horizon': 10.0, 'tolerance': 1e-12,
        'expected_error': about['simulation']['expected_error'],
        'met_until': 10.0}
    assert 0.0 < about['simulation']['expected_error'] < 1e-13
    assert about['parameters'] == {
        'scene': str(flipping.parent / 'flipping.yaml'), 'scene_overrides': ['body.mass=2.0'],
        'rate': 500.0, 'integrator': 'auto', 'accuracy': 1e-12, 'step': None, 'duration': 10.0,
        'publish': []}
    assert {'processor', 'libc', 'python', 'numpy', 'numba', 'sources'} <= set(about['machine'])
    begin, state = recording.journal()
    assert begin['kind'] == 'begin' and begin['scene'] == recording.about['scene']
    pose = recording.read('/pose', ['pose.orientation'])
    assert (state['kind'] == 'state' and state['tick'] == 0
            and state['vector'][1:5] == pose['pose.orientation'][0].tolist())
    assert pose['sequence'].tolist() == list(range(5001))


def test_json_is_the_state_to_the_last_bit_with_and_without_a_recording(tmp_path, capsys):
    arguments = ['--duration', '3.5', '--rate', '333', '--json']
    assert main(arguments) == 0
    result = json.loads(capsys.readouterr().out)
    simulation = Simulation('tennis_racket', rate=333.0)
    simulation.advance(1166)    # the first tick at 3.5 s or later
    state = result['state']
    assert [state['time'], *state['orientation'], *state['angular_velocity'], *state['position'],
            *state['velocity']] == simulation.vector.tolist()
    assert result['ledger'] == simulation.ledger()
    assert result['method']['method'] == 'exact'
    assert result['cost']['ticks'] == 1166 and result['cost']['messages'] == 0
    assert main([*arguments, '--output', str(tmp_path / 'run')]) == 0
    recorded = json.loads(capsys.readouterr().out)
    assert {**recorded, 'cost': None} == {**result, 'cost': None}
    assert recorded['cost']['messages'] == Recording(tmp_path / 'run').message_count


def test_topics_on_request_are_recorded_with_every_tick(tmp_path):
    """The reaction and the proper acceleration of a top are those of the simulation's ticks."""
    path = tmp_path / 'top'
    assert main(['--scene', 'heavy_top', '--duration', '0.2', '--output', str(path), '--publish',
                 'imu', 'odom', 'reaction', 'clock', 'tf']) == 0
    simulation = Simulation('heavy_top')
    times = np.arange(201) / 1000.0
    states, reactions = simulation.states(times), simulation.reactions(times)
    recording = Recording(path)
    assert set(recording.topics) >= {'/pose', '/imu', '/odom', '/reaction', '/clock'}
    # tf at 30 Hz: at 0, 34, 67, 100, ... ms
    assert recording.topics['/tf'].count == 7
    force = recording.read('/reaction', ['wrench.force', 'header.stamp'])
    assert np.array_equal(force['wrench.force'], reactions.force)
    assert np.array_equal(
        recording.read('/pose', ['header.stamp'])['header.stamp'], force['header.stamp'])
    assert np.array_equal(recording.read('/clock', ['clock'])['clock'], force['header.stamp'])
    assert np.array_equal(recording.read('/odom', ['twist.twist.angular'])['twist.twist.angular'],
                          states.angular_velocity)
    assert np.array_equal(
        recording.read('/imu', ['angular_velocity'])['angular_velocity'], states.angular_velocity)
    with pytest.raises(SystemExit):
        main(['--output', str(tmp_path / 'other'), '--publish', 'imo'])


def test_no_duration_is_the_first_state_alone(tmp_path, capsys):
    assert main(['--duration', '0', '--output', str(tmp_path / 'run'), '--json']) == 0
    assert json.loads(capsys.readouterr().out)['state']['time'] == 0.0
    assert Recording(tmp_path / 'run').topics['/pose'].count == 1


@pytest.mark.parametrize(('arguments', 'said'), [
    (['--scene', 'tennis_rackett'], 'did you mean tennis_racket?'),
    (['--set', 'body.mass=-1'], 'body.mass'),
    (['--integrator', 'exakt'], "did you mean 'exact'?"),
    (['--accuracy', '0'], 'accuracy'),
    (['--integrator', 'rk4'], 'rk4 does not control its error, it needs a step'),
    (['--integrator', 'rk4', '--step', '-1'], 'step: got -1.0'),
    (['--integrator', 'exact', '--step', '1e-3'], 'a closed form takes no steps'),
    (['--integrator', 'lsoda', '--step', '1e-3'], 'lsoda chooses its own steps'),
    (['--rate', '-5'], 'rate'),
    (['--rate', 'abc'], "invalid float value: 'abc'"),
    (['--duration', 'nan'], '--duration: got nan'),
    (['--duration', '-1'], '--duration: got -1.0'),
    (['--duration', '1e300'], '--duration'),
    (['--output', '/proc/run'], '/proc/run'),
    (['--output', '.'], 'exists already'),
])
def test_bad_input_is_one_line_and_status_2(arguments, said, capsys):
    try:
        status = main(arguments)
    except SystemExit as ended:
        status = ended.code
    captured = capsys.readouterr()
    assert (status, captured.out) == (2, '')
    assert said in captured.err and captured.err.count('\n') == 1


def start(*arguments, **options):
    return subprocess.Popen(
        [sys.executable, '-m', 'rigid_body_sim', 'simulate', *arguments], cwd=ROOT, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, **options)


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_with_a_whole_recording(tmp_path, number):
    path = tmp_path / 'run'
    with start('--duration', '100000', '--output', path) as process:
        while not (path / 'run_0.mcap').exists() or (path / 'run_0.mcap').stat().st_size < 2**20:
            assert process.poll() is None, process.stderr.read()
            time.sleep(0.02)
        process.send_signal(number)
        _, error = process.communicate(timeout=30)
    assert process.returncode == 128 + number
    missed, line = without_notices(error).splitlines()
    assert 'the accuracy asked, 1e-12 rad, is missed' in missed    # over 100,000 s
    assert line.startswith('interrupted at t = ') and line.endswith('is whole up to there')
    pose = Recording(path).read('/pose', ['pose.orientation'])
    assert np.diff(pose['log_time']).tolist() == [1_000_000] * (len(pose['log_time']) - 1)
    with rosbags.AnyReader([path]) as reader:
        assert reader.message_count == Recording(path).message_count > 4 * 5000


def test_a_signal_ends_a_run_whose_next_ticks_take_long(monkeypatch):
    """It was heard after 4096 ticks, which may take minutes."""
    simulation = Simulation('tennis_racket')
    advance = simulation.advance

    def slow(ticks):
        signal.raise_signal(signal.SIGINT)
        advance(ticks)
    monkeypatch.setattr(simulation, 'advance', slow)
    with interruptible() as asked:
        simulate(simulation, 10**6, stop=asked)
    assert asked == [signal.SIGINT]
    assert simulation.tick == 0


def test_a_full_disk_loses_nothing_recorded(tmp_path):
    def small_disk():
        resource.setrlimit(resource.RLIMIT_FSIZE, (2**20, 2**20))

    path = tmp_path / 'run'
    with start('--duration', '1000', '--output', path, preexec_fn=small_disk) as process:
        _, error = process.communicate(timeout=60)
    assert process.returncode == 1
    [line] = without_notices(error).splitlines()
    assert (line.startswith(f'{path}: the disk refuses (File too large) at t = ')
            and 'recover' in line)
    recover(path)
    count = Recording(path).topics['/pose'].count
    assert count > 5000
    with rosbags.AnyReader([path]) as reader:
        assert reader.message_count == Recording(path).message_count


def test_files_are_split_and_compressed_as_asked(tmp_path, capsys):
    run = ['--duration', '3', '--rate', '100', '--output', str(tmp_path / 'run')]
    assert (main([*run, '--split-seconds', '-1']) == 2
            and '--split-seconds: got -1; a number from 0' in capsys.readouterr().err)
    assert main([*run, '--split-seconds', '0.5', '--compression', 'lz4']) == 0
    names = sorted(path.name for path in (tmp_path / 'run').glob('*.mcap'))
    assert len(names) > 1
    with rosbags.AnyReader([tmp_path / 'run']) as reader:
        assert sum(connection.msgcount
                   for connection in reader.connections if connection.topic == '/pose') == 301
    assert len([entry
                for entry in Recording(tmp_path / 'run').journal()
                if entry['kind'] == 'state']) == len(names)


def test_a_terminal_sees_from_the_first_moment_what_is_done(tmp_path):
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack('HHHH', 24, 80, 0, 0))
    command = [sys.executable, '-m', 'rigid_body_sim', 'simulate', '--duration', '5', '--output',
               str(tmp_path / 'run')]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=theirs) as process:
        os.close(theirs)
        shown = b''
        with contextlib.suppress(OSError):      # Linux: the other end is closed
            while part := os.read(ours, 4096):
                shown += part
        process.communicate(timeout=60)
    os.close(ours)
    assert process.returncode == 0
    first, *_ = [text for text in shown.decode().split('\r') if text.strip()]
    assert first.startswith('setting up: 0')
    assert 'tennis_racket: ' in shown.decode()
    assert '/5.00k' in shown.decode()


@pytest.mark.without_numba
def test_methods_that_are_listed_but_need_a_step_can_be_taken(capsys):
    listed = [name for name in methods_for(load_scene('tennis_racket'))
              if name != 'exact' and 'accuracy' not in METHODS[name].TAKES]
    assert {'rk4', 'semi_implicit_euler'} <= set(listed)
    for method in listed:
        given = ['--duration', '0.01', '--integrator', method, '--step', '1e-3', '--json']
        assert main(given) == 0
        told = json.loads(capsys.readouterr().out)['method']
        assert (told['method'], told['step']) == (method, 1e-3)


@pytest.mark.without_numba
def test_a_run_in_fixed_steps_runs_again_to_the_same_bits(tmp_path, capsys):
    given = ['--duration', '0.2', '--integrator', 'rk4', '--step', '2e-3']
    assert main([*given, '--output', str(tmp_path / 'run')]) == 0
    capsys.readouterr()
    assert resimulate([str(tmp_path / 'run')]) == 0


FAST = """
scene: fast
about: A body that rolls off the plane where no slip lets it down
body: {mass: 1.0, inertia: [0.01, 0.012, 0.02], center_of_mass: [0, 0, -0.03],
       surface: {ellipsoid: {semi_axes: [0.2, 0.1, 0.15]}}}
constraint: table
effects: [gravity: {g: 9.81}, sliding_friction: {mu: .inf}]
initial: {euler_zyz: [0, 0.6, 0.4], angular_velocity: [0, 14, 0], rolling: true}
"""


@pytest.mark.without_numba
@pytest.mark.parametrize('block', [4096, 30, 17])
def test_a_run_that_ends_keeps_every_tick_before_and_the_event(
        tmp_path, monkeypatch, capsys, block):
    """The block in which it ended was lost. A block may also stop just at the last tick."""
    monkeypatch.setattr('rigid_body_sim.cli.simulate.BLOCK', block)
    (tmp_path / 'fast.yaml').write_text(FAST)
    run = str(tmp_path / 'run')
    assert main(['--scene', str(tmp_path / 'fast.yaml'), '--duration', '1', '--accuracy', '1e-9',
                 '--integrator', 'dop8', '--output', run]) == 1
    printed = capsys.readouterr()
    assert 'at t = 0.0606' in printed.err and 'plane that pulls' in printed.err
    assert (printed.err.count('\n'), printed.out) == (1, '')
    found = read(tmp_path / 'run')
    stamps = [stamp for stamp, _ in found['/pose']]
    assert np.diff(stamps).tolist() == [1_000_000] * 60    # ticks 0 to 60
    [(stamp, event)] = found['/events']
    values = {pair.key: pair.value for pair in event.values}
    assert (event.name, values['tick'], stamp) == ('end', '60', stamps[-1])
    assert 0.0606 < float(values['time']) < 0.0607
    assert resimulate([run]) == 0
    assert 'identical, 61 states' in capsys.readouterr().out


@pytest.mark.without_numba
@pytest.mark.parametrize(('effect', 'line', 'count'), [
    ("torque: {value: ['sqrt(0.0305 - t)', 0, 0]}", 'dop8 on fault: at t = ', 31),
    ('strike: {impulse: [1e75, 0, 0], point: [0, 1e75, 0], time: 0.0205}',
     'fault: strike: at 0.0205 s it would do a work of', 21)])
def test_a_run_that_cannot_go_on_keeps_every_tick_before(tmp_path, capsys, effect, line, count):
    """A state that is no longer finite, a strike that the body cannot take."""
    (tmp_path / 'fault.yaml').write_text(
        'scene: fault\nbody: {mass: 1, inertia: [1, 2, 2.5]}\nconstraint: free\n'
        f'effects: [{effect}]\ninitial: {{angular_velocity: [1, 2, 3]}}\n')
    run = str(tmp_path / 'run')
    assert main(['--scene', str(tmp_path / 'fault.yaml'), '--duration', '1', '--accuracy', '1e-6',
                 '--integrator', 'dop8', '--output', run]) == 1
    said = capsys.readouterr().err
    assert said.startswith(line)
    if 'sqrt' in effect:    # the clock of a step is a sum: it may end an ulp behind the last root
        assert 0.0304 < float(said.removeprefix(line).split()[0]) <= math.nextafter(0.0305, 1.0)
    assert Recording(run).topics['/pose'].count == count
    assert resimulate([run]) == 0


@pytest.mark.parametrize('name', ['split_bytes', 'split_seconds'])
def test_files_are_split_by_sizes_up_to_four_billion(name):
    options = types.SimpleNamespace(split_bytes=0, split_seconds=0, compression='zstd')
    for size, taken in ((0, True), (4e9, True), (4.001e9, False), (-1, False), (np.nan, False)):
        setattr(options, name, size)
        if taken:
            assert module._writing(options)[name] == size
            continue
        with pytest.raises(BadInput, match=f'--{name.replace("_", "-")}'):
            module._writing(options)


def test_a_run_has_at_most_a_billion_ticks(capsys):
    assert main(['--scene', 'sphere', '--duration', '1000000001', '--rate', '1']) == 2
    assert 'at most 1e+09 at this rate' in capsys.readouterr().err


def test_the_summary_counts_messages_by_the_second(capsys):
    result = {'state': {'time': 2.5, **{name: [0.5] for name in module.PARTS}},
              'ledger': {'energy_residual': 1e-15, 'momentum_residual': 2e-16},
              'method': {'method': 'dop8'}, 'events': {'flip': 3, 'bounce': 1},
              'cost': {'ticks': 100, 'run': 0.25, 'messages': 300}}
    module._tell(result, types.SimpleNamespace(name='top'), 'here')
    told = capsys.readouterr().out.splitlines()
    assert told[0] == 'top by dop8: 100 ticks, t = 2.5 s, in 0.250 s'
    assert told[1:5] == [f'  {name:17}0.5' for name in module.PARTS]
    assert told[5:] == ['  energy residual 1.00e-15, angular momentum residual 2.00e-16, '
                        '1 x bounce, 3 x flip', '  300 messages, 1200 a second: here']
    module._tell(result, types.SimpleNamespace(name='top'), None)
    assert capsys.readouterr().out.splitlines() == told[:-1]


def test_progress_is_told_in_the_ticks_of_each_block(monkeypatch):
    monkeypatch.setattr(module, 'BLOCK', 40)
    done = []
    simulate(Simulation('sphere', rate=100.0), 100, progress=done.append)
    assert done == [40, 40, 20]
