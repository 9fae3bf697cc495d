# SPDX-License-Identifier: Apache-2.0
"""The process of a node, on an executor that is made by hand: what its exit status is."""

import types

import pytest
from rclpy.executors import ExternalShutdownException

from rigid_body_sim.command_line import BAD_INPUT, CHECK_FAILED, GOOD
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
