# SPDX-License-Identifier: Apache-2.0
"""A node as a source, from messages made by hand: states, velocities, residuals, commands."""

import math
import types

import numpy as np
import pytest

pytest.importorskip('rclpy')

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import PoseStamped, Vector3Stamped
from scipy.spatial.transform import Rotation
from std_msgs.msg import Float64

from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.simulation.command_rows import HOLD, IMPULSE, LET_GO, row_of
from rigid_body_sim.view import node_source
from rigid_body_sim.view.node_source import NodeSource

ARM = np.array([0.1, 0.0, -0.2])    # from the body's origin to its centre of mass


@pytest.fixture
def source(monkeypatch):
    """Return a NodeSource without a node, on which messages wait in lists by topic."""
    one = NodeSource.__new__(NodeSource)
    one._name, one.messages, one._residuals, one._wrench = '/a/sim', [], {}, Wrench()
    one._start, one._last, one._shown, one._net = None, {}, None, None
    one._velocity, one._asked, one._middle = np.zeros(3), False, ARM
    one._heard, one._gone, one._asking = 0.0, False, None
    one.waiting = {}
    monkeypatch.setattr(one, '_take', lambda topic: one.waiting.pop(topic, []))
    monkeypatch.setattr(node_source.rclpy, 'spin_once', lambda node, timeout_sec: None)
    monkeypatch.setattr(one, '_take_scene', lambda: False)
    monkeypatch.setattr(one, '_miss', lambda fresh: None)
    return one


def state(source, sec, nanosec=0, position=(0.0, 0.0, 0.0), turn=(0.0, 0.0, 0.0), omega=(0, 0, 0)):
    """Let a state wait on the topics of a source; return the quaternion of its turn."""
    pose, turning = PoseStamped(), Vector3Stamped()
    pose.header.stamp.sec, pose.header.stamp.nanosec = sec, nanosec
    at, q, to = pose.pose.position, pose.pose.orientation, turning.vector
    at.x, at.y, at.z = position
    q.x, q.y, q.z, q.w = found = Rotation.from_rotvec(turn).as_quat().tolist()
    to.x, to.y, to.z = map(float, omega)
    source.waiting |= {'pose': [pose], 'angular_velocity': [turning]}
    return found


def test_a_snapshot_has_the_latest_state_at_the_time_since_the_first_one(source):
    assert source.poll() == []
    source.waiting['pose'] = [PoseStamped()]
    assert source.poll() == []    # half a state
    q = state(source, 100, 500_000_000, (1.0, 2.0, 3.0), (0.1, 0.2, 0.3), (4, 5, 6))
    [first] = source.poll()
    assert first.time == 0.0 and math.isnan(first.energy) and math.isnan(first.energy_residual)
    assert first.vector[:11] == pytest.approx([0.0, *q, 4.0, 5.0, 6.0, 1.0, 2.0, 3.0])
    assert first.trail.tolist() == [first.vector.tolist()]
    assert source.poll() == []    # nothing new
    state(source, 100, 750_000_000, omega=(0.0, 0.0, 0.3), turn=(0.0, 0.0, 0.5))
    source.waiting |= {'energy': [Float64(data=1.0), Float64(data=7.5)], 'events': [
        DiagnosticStatus(name='flip', message='a flip'), DiagnosticStatus(name='end')]}
    [second] = source.poll()
    assert (second.time, second.energy) == (0.25, 7.5)
    assert second.events == ((0.25, 'a flip'), (0.25, 'end'))
    assert len(second.trail) > 1 and second.trail[-1].tolist() == second.vector.tolist()
    assert second.net is None and second.wrench == Wrench()


def test_velocities_are_those_of_the_last_moves_of_the_centre_and_a_reset_is_none(source):
    """The body turns at 2 rad/s about z, and its centre of mass goes at (1, 0, -0.5) m/s."""
    speed, omega = np.array([1.0, 0.0, -0.5]), np.array([0.0, 0.0, 2.0])

    def at(time, shift=0.0):
        turn = omega * time
        arm = Rotation.from_rotvec(turn).apply(ARM)
        state(source, 0, round(1e9 * time), tuple(speed * time + shift - arm), tuple(turn), omega)
        [snapshot] = source.poll()
        return snapshot.vector[11:14] + np.cross(omega, arm)    # that of the centre
    assert at(0.0) == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)
    assert at(0.1) == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)    # one move might be a leap
    assert at(0.2) == pytest.approx(speed, abs=1e-9)
    assert at(0.3, 5.0) == pytest.approx(speed, abs=1e-9)    # a leap by 5 m
    assert at(0.4, 5.0) == pytest.approx(speed, abs=1e-9)
    for later in (0.9, 0.95 - 0.1):    # after half a second, and back in time, nothing is known
        assert at(later, 9.0) == pytest.approx(speed, abs=1e-9)


def test_residuals_are_those_of_the_ledger_of_this_node(source):
    def status(name, value):
        return DiagnosticStatus(name=name, values=[
            KeyValue(key='energy_residual', value=value), KeyValue(key='energy', value='3'),
            KeyValue(key='momentum_residual', value='-2e-15'), KeyValue(key='method', value='x')])
    source.waiting['diagnostics'] = [DiagnosticArray(status=[
        status('b/sim: ledger', '1.0'), status('a/sim: ledger', '5e-16'),
        status('a/sim: timing', '2.0')])]
    source.poll()
    assert source._residuals == {'energy_residual': 5e-16, 'momentum_residual': -2e-15}


def test_impulses_are_sent_apart_and_a_release_is_a_wrench_of_zero(source):
    held, struck = [], []
    source._held, source._struck = (types.SimpleNamespace(publish=sent.append)
                                    for sent in (held, struck))
    source._asked = True
    source.command(row_of(HOLD, (1.0, 2.0, 3.0), (4.0, 5.0, 6.0), 'world'))
    assert source._wrench == Wrench((1.0, 2.0, 3.0), (4.0, 5.0, 6.0))
    source.command(row_of(IMPULSE, (0.1, 0.0, 0.0), (0.0, 0.0, 0.2), 'world'))
    assert source._wrench.force == (1.0, 2.0, 3.0)
    source.command(LET_GO)
    assert source._wrench == Wrench()
    assert [(one.wrench.force.x, one.wrench.torque.z) for one in held] == [(1.0, 6.0), (0.0, 0.0)]
    assert [(one.wrench.force.x, one.wrench.torque.z) for one in struck] == [(0.1, 0.2)]


@pytest.mark.parametrize(('timeout', 'warns'), [(0.0, True), (0.5, False)])
def test_a_node_that_holds_a_pull_for_ever_is_told_of_at_the_first_pull(timeout, warns, source):
    asked, ready = [], [False]

    def call(request):
        asked.append(request.names)
        value = types.SimpleNamespace(double_value=timeout)
        future = types.SimpleNamespace(result=lambda: types.SimpleNamespace(values=[value]))
        return types.SimpleNamespace(add_done_callback=lambda answered: answered(future))
    source._clients = {'timeout': types.SimpleNamespace(
        service_is_ready=lambda: ready[0], call_async=call)}
    source._held = types.SimpleNamespace(publish=lambda message: None)
    for ready[0] in (False, True, True):
        source.command(row_of(HOLD, (1.0, 0.0, 0.0), (0.0, 0.0, 0.0), 'world'))
    assert asked == [['command_timeout']]
    assert [' holds a pull until it is replaced' in text for text in source.messages] == (
        [True] * warns)


def test_services_that_are_missing_or_refuse_are_said(source):
    asked, answers = [], {'pause': (True, ''), 'step': (False, 'it is running')}

    def client(name):
        success, message = answers.get(name, (None, None))
        future = types.SimpleNamespace(
            result=lambda: types.SimpleNamespace(success=success, message=message))
        return types.SimpleNamespace(
            service_is_ready=lambda: success is not None,
            call_async=lambda request: asked.append(request) or types.SimpleNamespace(
                add_done_callback=lambda answered: answered(future)))
    source._clients = {name: client(name) for name in ('pause', 'step', 'reset')}
    source.tell('pause', True)
    assert asked[0].data is True and source.messages == []
    source.tell('step')
    source.tell('reset')
    assert source.messages == ['step: it is running', '/a/sim has no service reset']
    assert (source.pushes, source.edits, source.plays, source.paces) == (True, False, False, False)
    assert (source.speed, source.tick) == (1.0, 0.0)


@pytest.mark.parametrize(('published', 'used'), [
    ({'angular_velocity', 'energy', 'pose'}, 'shown'), ({'pose'}, 'ticks'), (set(), 'ticks')])
def test_topics_for_pages_are_used_where_all_of_them_come_within_a_second(
        published, used, source, monkeypatch):
    """A replay has none; the topics of every tick are used then."""
    clock, subscribed = [7.0], {}
    monkeypatch.setattr(node_source, 'time', types.SimpleNamespace(
        monotonic=lambda: clock[0], sleep=lambda s: clock.__setitem__(0, clock[0] + s)))
    shown = {node_source.display.topic_of(name).replace('~', '/a/sim'): name
             for name in node_source.STATES}
    source._node = types.SimpleNamespace(count_publishers=lambda topic: shown[topic] in published)
    monkeypatch.setattr(source, '_subscribe', lambda name, kind, topic, profile: (
        subscribed.__setitem__(name, topic)))
    source._subscribe_to_states('/a')
    names = {name: f'/a/{name}' for name in node_source.STATES}
    assert subscribed == ({name: topic for topic, name in shown.items()} if used == 'shown'
                          else names)
    assert clock[0] == pytest.approx(7.0 if used == 'shown' else 8.0, abs=0.051)
