# SPDX-License-Identifier: Apache-2.0
"""A node ends soon, with exit status 0 and a whole recording.

If it cannot begin, it says why.
"""

import os
import pathlib
import resource
import signal
import subprocess
import sys
import time

import pytest
import yaml
from notices import without_notices
from soak import IN_SOAK
from std_msgs.msg import Float64

pytestmark = pytest.mark.usefixtures('compiled_kernels')

WITHIN = 1.0
"""Processor time from the signal to the end of the process and its recorder, s."""


def processor_time():
    """Return the processor time of the children that have ended, s."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def of_process(pid):
    """Return the processor time that a process and its children have taken so far, s."""
    fields = pathlib.Path(f'/proc/{pid}/stat').read_text().rpartition(')')[2].split()
    children = [int(child) for task in pathlib.Path(f'/proc/{pid}/task').iterdir()
                for child in (task / 'children').read_text().split()]
    return ((int(fields[11]) + int(fields[12])) / os.sysconf('SC_CLK_TCK')
            + sum(map(of_process, children)))


def recording_of(running):
    """Return the only recording of a node, once it is complete.

    Its recorder may outlive a killed node for a moment.
    """
    [folder] = (running.folder / 'recordings').iterdir()
    deadline = time.monotonic() + 5.0
    while not (folder / 'metadata.yaml').exists():
        assert time.monotonic() < deadline, list(folder.iterdir())
        time.sleep(0.02)
    return folder


def messages_in(folder):
    """Return the number of messages of each topic in metadata.yaml; rosbags has read as many."""
    from rosbags.highlevel import AnyReader
    told = yaml.safe_load((folder / 'metadata.yaml').read_text())['rosbag2_bagfile_information']
    counts = {entry['topic_metadata']['name']: entry['message_count']
              for entry in told['topics_with_message_count']}
    with AnyReader([folder]) as reader:
        assert sum(1 for _ in reader.messages()) == sum(counts.values())
    return counts


def one(process, number):
    process.send_signal(number)


def interrupt_twice(process, _):
    os.killpg(process.pid, signal.SIGINT)
    time.sleep(0.02)
    os.killpg(process.pid, signal.SIGINT)


@pytest.mark.parametrize(('send', 'number'),
                         [(one, signal.SIGINT), (interrupt_twice, signal.SIGINT),
                          pytest.param(one, signal.SIGTERM, marks=IN_SOAK),
                          pytest.param(one, signal.SIGHUP, marks=IN_SOAK)],
                         ids=['SIGINT', 'SIGINT twice to the group', 'SIGTERM', 'SIGHUP'])
def test_signal_ends_it_with_a_whole_recording(run_node, send, number):
    with run_node() as node:
        energies = node.client.collect(Float64, 'energy', 1000)
        node.client.until(lambda: len(energies) > 300, what='300 ticks')
        before = processor_time() + of_process(node.process.pid)
        send(node.process, number)
        out, err = node.process.communicate(timeout=5.0)
        assert (node.process.returncode, without_notices(err)) == (0, '')
        assert processor_time() - before < WITHIN
        assert 'recorded' in out
        assert messages_in(recording_of(node))['/energy'] >= len(energies)


def test_killed_node_leaves_a_complete_recording(run_node):
    with run_node() as node:
        energies = node.client.collect(Float64, 'energy', 1000)
        node.client.until(lambda: len(energies) > 300, what='300 ticks')
        node.process.kill()
        node.process.wait(5.0)
        counts = messages_in(recording_of(node))
        assert counts['/energy'] >= len(energies)
        assert counts['/energy'] == counts['/pose'] == counts['/angular_velocity']


def test_duration_ends_it_with_a_report(ros_domain, tmp_path):
    node = ros_domain.run('-m', 'rigid_body_sim', 'sim_node', '--ros-args', '-p', 'duration:=0.5',
                          '-p', 'rate:=200', '-p', f'recording.directory:={tmp_path}', timeout=90)
    assert (node.returncode, without_notices(node.stderr)) == (0, '')
    # ticks 0 to 100
    assert node.stdout.startswith('/sim_node: tennis_racket, 101 ticks in 0.5')
    [folder] = tmp_path.glob('sim_node_tennis_racket_*')
    assert messages_in(folder)['/pose'] == 101
    assert str(folder) in node.stdout


def test_a_closed_terminal_does_not_turn_the_end_into_a_failure(ros_domain, tmp_path):
    reading, writing = os.pipe()
    os.close(reading)
    with ros_domain.process(
            '-m', 'rigid_body_sim', 'sim_node', '--ros-args', '-p', 'duration:=0.1', '-p',
            'record:=false', cwd=None, stdout=writing, stderr=writing, text=False) as node:
        os.close(writing)
        assert node.wait(90) == 0


def test_early_signal_ends_it_too(ros_domain, tmp_path):
    with ros_domain.process('-m', 'rigid_body_sim', 'sim_node', '--ros-args', '-p',
                            f'recording.directory:={tmp_path}') as node:
        # handlers are set before rclpy and numba are loaded; /proc says when
        status = pathlib.Path(f'/proc/{node.pid}/status')
        deadline = time.monotonic() + 20.0
        while not (int(next(line
                            for line in status.read_text().splitlines()
                            if line.startswith('SigCgt')).split()[1],
                       16)
                   & (1 << (signal.SIGTERM - 1))):
            assert time.monotonic() < deadline
            time.sleep(0.005)
        node.terminate()
        _, err = node.communicate(timeout=5.0)
        assert (node.returncode, without_notices(err)) == (0, '')


@pytest.mark.parametrize(('arguments', 'line'), [
    (['-p', 'ratee:=5'], 'parameter ratee: there is none of that name; did you mean rate?'),
    (['-p', 'rate'], 'ROS arguments: '),
    (['-p', 'recording.directory:=/proc/nowhere'], 'no recording can be made here'),
], ids=['unknown parameter', 'broken argument', 'unwritable'])
def test_what_cannot_begin_says_why_in_one_line(ros_domain, arguments, line):
    node = ros_domain.run('-m', 'rigid_body_sim', 'sim_node', '--ros-args', *arguments, timeout=90)
    assert node.returncode == 2
    said = without_notices(node.stderr)
    assert len(said.splitlines()) == 1, said
    assert line in said
    assert node.stdout == ''


def test_a_motion_that_cannot_begin_says_so_in_one_line(ros_domain, tmp_path, monkeypatch):
    """It ended with a traceback: a rod that slips into Painleve's paradox."""
    monkeypatch.setenv('NUMBA_DISABLE_JIT', '1')
    (tmp_path / 'rod.yaml').write_text(
        'scene: rod\nbody: {mass: 1.0, inertia: [0.0833333333333, 0.0833333333333, 1.0e-4], '
        'surface: {ellipsoid: {semi_axes: [0.005, 0.005, 0.5]}}}\nconstraint: table\n'
        'effects: [gravity: {g: 9.81}, sliding_friction: {mu: 2.5}]\n'
        'initial: {euler_zyz: [0, 0.5, 0], velocity: [-4.0, 0, 0]}\n')
    node = ros_domain.run(
        '-m', 'rigid_body_sim', 'sim_node', '--ros-args', '-p', f'scene:={tmp_path}/rod.yaml',
        '-p', 'integrator:=dop8', '-p', 'accuracy:=1e-9', '-p', 'record:=false', timeout=90)
    assert node.returncode == 1
    said = without_notices(node.stderr)
    assert said.count('\n') == 1 and "Painleve's paradox at t = 0.0 s" in said


def test_help_does_not_start_ros(ros_domain):
    shown = subprocess.run(
        [sys.executable, '-S', '-m', 'rigid_body_sim', 'sim_node', '--help'], capture_output=True,
        text=True, timeout=20, cwd=pathlib.Path(__file__).resolve().parents[2], check=True).stdout
    assert 'example' in shown
