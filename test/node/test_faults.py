# SPDX-License-Identifier: Apache-2.0
"""Faults of other nodes and inside the node: it goes on, or ends in order."""

import os
import pathlib
import signal
import types

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray
from node.test_load import diagnosis
from node.test_shutdown import messages_in, recording_of
from notices import without_notices
from std_msgs.msg import Float64

from rigid_body_sim.errors import NotConverged
from rigid_body_sim.node import engine
from rigid_body_sim.recording.reader import Recording

READER = """
import rclpy
from std_msgs.msg import Float64
rclpy.init()
node = rclpy.create_node('reader')
heard = [0]
def count(message):
    heard[0] += 1
    if heard[0] % 100 == 0:
        print(heard[0], flush=True)
node.create_subscription(Float64, 'energy', count, 10)
rclpy.spin(node)
"""
FAILING = """
import sys
from rigid_body_sim.node import engine, sim_node
start = engine.Engine.start
def fail():
    raise RuntimeError('on purpose')
def start_and_fail(self):
    start(self)
    self._node.create_timer(0.5, fail)
engine.Engine.start = start_and_fail
sim_node.main(sys.argv[1:])
"""
BACK = """
import itertools, sys, time
from rigid_body_sim.node import sim_node
real, calls = time.time_ns, itertools.count()
time.time_ns = lambda: real() - (3600 * 10**9 if next(calls) > 100 else 0)
sim_node.main(sys.argv[1:])
"""


def test_subscriber_that_stops_reading_holds_nothing_up(run_node):
    """A stopped reliable subscriber fills its queue; the other hears every tick, none skipped."""
    with run_node('-p', 'rate:=200', '-p', 'record:=false') as node, node.domain.process(
            '-c', READER) as reader:
        energies, arrays = (node.client.collect(Float64, 'energy', 1000),
                            node.client.collect(DiagnosticArray, '/diagnostics'))
        assert reader.stdout.readline() == '100\n'
        reader.send_signal(signal.SIGSTOP)
        before = len(energies)
        node.client.until(lambda: len(energies) > before + 600, what='three seconds of ticks')
        arrays.clear()
        node.client.until(lambda: diagnosis(arrays, 'timing'), what='diagnostics')
        assert diagnosis(arrays, 'timing')['skipped'] == '0'
        reader.send_signal(signal.SIGCONT)
        assert reader.stdout.readline() == '200\n'


def test_a_motion_that_ends_before_the_last_ledger_is_one_line(capsys):
    """Lifting a disk off its plane between two ticks once ended the node with a traceback."""
    def end():
        raise NotConverged('at t = 1.5 s ideal rolling needs a plane that pulls')
    quiet = types.SimpleNamespace(close=lambda *_: None, on_change=lambda *_: None, status=None)
    stands_for = types.SimpleNamespace(
        _settings=quiet, _status_line=quiet, _source=quiet, journal=quiet, _report=lambda: None,
        _node=types.SimpleNamespace(get_name=lambda: 'sim_node'),
        ticker=types.SimpleNamespace(is_alive=lambda: False, failure=None),
        session=types.SimpleNamespace(take_balance=end, next_tick=1500))
    assert engine.Engine.close(stands_for) == 1
    assert capsys.readouterr().err == (
        'sim_node: tick 1500: NotConverged: at t = 1.5 s ideal rolling needs a plane that pulls\n')


def test_callback_that_fails_ends_it_with_a_whole_recording(
        ros_domain, tmp_path, compiled_kernels):
    node = ros_domain.run('-c', FAILING, '--ros-args', '-p', 'rate:=200', '-p',
                          f'recording.directory:={tmp_path / "recordings"}', timeout=90)
    assert (node.returncode, without_notices(node.stderr)) == (
        1, 'sim_node: a callback failed: RuntimeError: on purpose\n')
    [folder] = (tmp_path / 'recordings').iterdir()
    assert messages_in(folder)['/energy'] > 10


def test_wall_clock_set_back_by_an_hour_loses_and_doubles_no_tick(
        ros_domain, tmp_path, compiled_kernels):
    """Stamps count ticks from the first one; only times of publication follow the wall clock."""
    node = ros_domain.run('-c', BACK, '--ros-args', '-p', 'rate:=200', '-p', 'duration:=1.0', '-p',
                          f'recording.directory:={tmp_path / "recordings"}', timeout=90)
    assert (node.returncode, without_notices(node.stderr)) == (0, '')
    [folder] = (tmp_path / 'recordings').iterdir()
    with Recording(folder) as recording:
        stamps = recording.read('/pose', ['header.stamp'])['header.stamp']
        published = [message.publish_time for message in recording.messages(['/pose'])]
    assert set(np.diff(stamps)) == {5_000_000}
    assert len(stamps) == 201
    assert min(np.diff(published)) < -3599e9


def shared_memory(process):
    """Paths of the files of shared memory that a process has open, by their inode numbers.

    The number tells a file from the next one of its name: Fast DDS numbers its ports from 7000 on
    across all domains, so another node takes a name as soon as it is free.
    """
    folder = pathlib.Path('/proc', str(process))
    mapped = [line.split(maxsplit=5)[4:] for line in (folder / 'maps').read_text().splitlines()]
    opened = [(os.stat(link).st_ino, os.readlink(link))
              for link in (folder / 'fd').iterdir() if link.exists()]
    return {int(place[0]): place[1] for place in mapped + opened
            if place[1:] and place[1].startswith('/dev/shm/')}


def test_nothing_of_its_own_is_left_in_shared_memory(run_node):
    with run_node('-p', 'rate:=200') as node:
        energies = node.client.collect(Float64, 'energy')
        node.client.until(lambda: len(energies) > 10, what='ticks')
        own = shared_memory(node.process.pid)
        node.process.terminate()
        assert node.process.wait(5.0) == 0
        recording_of(node)
        present = {entry.inode() for entry in os.scandir('/dev/shm')}
        left = (own.keys() & present) - shared_memory('self').keys()
    assert own
    assert not {own[number] for number in left}
