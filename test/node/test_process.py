# SPDX-License-Identifier: Apache-2.0
"""The process of a node, on an executor that is made by hand: what its exit status is."""

import contextlib
import types

import pytest
from rclpy.exceptions import InvalidParameterTypeException
from rclpy.executors import ExternalShutdownException
from rclpy.parameter import Parameter

from rigid_body_sim.command_line import BAD_INPUT, CHECK_FAILED, GOOD
from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.node import process


class Stop:
    """Stands for a shutdown.Stop: wanted after the first turn."""

    def __init__(self):
        self.wanted, self.asked = False, []

    def on_request(self, act):
        self.asked.append(act)


class Executor:
    """Stands for the executor: its one turn asks for the end, and may fail."""

    failure: Exception | None = None

    def __init__(self, stop):
        self._stop, self.log = stop, []

    def add_node(self, node):
        self.log.append(node.get_name())

    def wake(self):
        self.log.append('wake')

    def spin_once(self):
        self.log.append('turn')
        self._stop.wanted = True
        if self.failure:
            raise self.failure

    def shutdown(self, timeout_sec):
        self.log.append(('shutdown', timeout_sec))


@pytest.mark.parametrize(('failure', 'closed', 'status', 'said'), [
    (None, GOOD, GOOD, ''),
    (None, CHECK_FAILED, CHECK_FAILED, ''),
    (None, BAD_INPUT, BAD_INPUT, ''),
    (ExternalShutdownException(), GOOD, GOOD, ''),
    (ExternalShutdownException(), CHECK_FAILED, CHECK_FAILED, ''),
    (RuntimeError('on\npurpose'), GOOD, CHECK_FAILED,
     'sim_node: a callback failed: RuntimeError: on purpose\n'),
    (RuntimeError('on purpose'), BAD_INPUT, BAD_INPUT,
     'sim_node: a callback failed: RuntimeError: on purpose\n')])
def test_the_status_is_that_of_the_end_or_of_a_callback_that_failed(
        failure, closed, status, said, monkeypatch, capsys):
    stop = Stop()
    executor = Executor(stop)
    executor.failure = failure
    monkeypatch.setattr(process, 'SingleThreadedExecutor', lambda: executor)
    node = types.SimpleNamespace(get_name=lambda: 'sim_node', close=lambda: closed)
    assert process._spin(node, stop) == status
    assert capsys.readouterr().err == said
    assert executor.log == ['sim_node', 'turn', ('shutdown', 0.0)]
    # a request wakes the executor, and after the end nothing that is gone
    assert stop.asked[0] == executor.wake
    assert len(stop.asked) == 2
    stop.asked[1]()
    assert executor.log[-1] == ('shutdown', 0.0)


def stand_in(monkeypatch, settled=('settled',)):
    """Replace what process.run asks of ROS; return what is called, in order."""
    called = []

    @contextlib.contextmanager
    def named(arguments):
        called.append(('settle', arguments))
        yield [*settled], {'shared'}
    monkeypatch.setattr(process.overrides, 'settled', named)
    monkeypatch.setattr(process.rclpy, 'init', lambda args, **_: called.append(('init', args)))
    monkeypatch.setattr(process.rclpy, 'try_shutdown', lambda: called.append('shutdown'))
    monkeypatch.setattr(process, 'set_logger_level', lambda name, level: called.append(level.name))
    return called


@pytest.mark.parametrize(('failure', 'status', 'said'), [
    (BadInput('scene', 'got x', 'needs y'), BAD_INPUT, 'scene: got x; needs y\n'),
    (NotConverged('t = 0 s: no\nway'), CHECK_FAILED, 't = 0 s: no'),
    (process.RCLError('two\n lines'), BAD_INPUT, 'ROS: two lines\n'),
    (InvalidParameterTypeException(Parameter('rate', value='a'), 'DOUBLE'), BAD_INPUT,
     "parameter Trying to set parameter 'rate' to 'a'")])
def test_a_node_that_cannot_be_made_has_a_status_and_one_line(
        failure, status, said, monkeypatch, capsys):
    called = stand_in(monkeypatch)

    def make_node(stop, shared):
        assert shared == {'shared'}
        raise failure
    assert process.run(make_node, ['given'], Stop()) == status
    assert capsys.readouterr().err.startswith(said)
    assert called == ['FATAL', ('settle', ['given']), ('init', ['', 'settled']), 'UNSET',
                      'shutdown']


@pytest.mark.parametrize('status', [GOOD, CHECK_FAILED])
def test_a_node_is_destroyed_at_the_end_of_its_turns(status, monkeypatch):
    called, stop = stand_in(monkeypatch), Stop()
    node = types.SimpleNamespace(destroy_node=lambda: called.append('destroyed'))
    monkeypatch.setattr(process, '_spin', lambda *of: called.append(of) or status)
    assert process.run(lambda *_: node, ['given'], stop) == status
    assert called[-3:] == [(node, stop), 'destroyed', 'shutdown']
    stop.last_resort()
    assert called[-1] == 'shutdown'


def test_arguments_that_ros_refuses_are_told_as_they_were_given(monkeypatch, capsys):
    """First it is asked with the settled ones, whose files the user does not know."""
    called = stand_in(monkeypatch)

    def refuse(args, **_):
        called.append(('init', args))
        raise process.RCLError(f'{args[1]} is\n' + 'long ' * 100)
    monkeypatch.setattr(process.rclpy, 'init', refuse)
    assert process.run(None, ['given'], Stop()) == BAD_INPUT
    said = capsys.readouterr().err
    assert said.startswith('ROS arguments: given is long long')
    assert said.endswith('; see --help\n')
    assert len(said) == len('ROS arguments: ; see --help\n') + 300
    assert called[2:] == [('init', ['', 'settled']), ('init', ['', 'given'])]
