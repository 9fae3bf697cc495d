# SPDX-License-Identifier: Apache-2.0
"""A running node as other nodes see it: topics, stamps, commands, services, diagnostics."""

import itertools
import math

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import PoseStamped, Vector3, Vector3Stamped, Wrench, WrenchStamped
from near import near
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import DescribeParameters, SetParameters
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Float64, String
from std_srvs.srv import SetBool, Trigger
from visualization_msgs.msg import Marker

from rigid_body_sim.numerics.rotations import rotate
from rigid_body_sim.theory import asymmetric_top

RATE = 250
PERIOD = 10**9 // RATE
# a second of messages may wait on both sides: a client that is kept from running loses none
DEPTHS = [word for topic in ('pose', 'angular_velocity', 'energy', 'angular_momentum_squared')
          for word in ('-p', f'qos_overrides./{topic}.publisher.depth:=1000')]
ARGUMENTS = (
    '-p', f'rate:={RATE}', '-p', 'scene:=free_body', '-p', 'publish:=[odom, imu, marker]', *DEPTHS)
LATCHED = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
# two momenta of size 10 (kg m^2/s), each turned to the world by a rounded quaternion: 8 roundings
# of each; measured up to 1.2e-14
TURNED = 16 * np.finfo(float).eps * 10.0


def nanoseconds(message):
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


def wrench(frame, torque=(0.0, 0.0, 0.0), force=(0.0, 0.0, 0.0)):
    message = WrenchStamped(wrench=Wrench(
        force=Vector3(**dict(zip('xyz', force))), torque=Vector3(**dict(zip('xyz', torque)))))
    message.header.frame_id = frame
    return message


def vector(v):
    return np.array([v.x, v.y, v.z])


@pytest.fixture
def client(shared_node):
    """Return a client of the running node, with the state at its start."""
    assert shared_node.client.call(SetBool, '/sim_node/pause', data=False).success
    assert shared_node.client.call(Trigger, '/sim_node/reset').success
    yield shared_node.client
    shared_node.client.forget()


class States:
    """Attitude and angular velocity of every tick, joined by their stamps."""

    def __init__(self, client):
        self.poses = client.collect(PoseStamped, 'pose', 1000)
        self.spins = client.collect(Vector3Stamped, 'angular_velocity', 1000)

    def momenta(self, inertia):
        """Return stamps and angular momenta (world) of the ticks of which both messages came."""
        spins = {nanoseconds(spin): vector(spin.vector) for spin in list(self.spins)}
        stamps, momenta = [], []
        for pose in list(self.poses):
            if (omega := spins.get(nanoseconds(pose))) is not None:
                q = pose.pose.orientation
                stamps.append(nanoseconds(pose))
                momenta.append(rotate(q.x, q.y, q.z, q.w, *(inertia * omega)))
        return np.array(stamps), np.array(momenta)


INERTIA = np.array([1.0, 2.0, 2.5])


def test_every_tick_reaches_a_plain_subscriber_with_exact_stamps(client):
    poses, spins = (client.collect(PoseStamped, 'pose', 1000),
                    client.collect(Vector3Stamped, 'angular_velocity', 1000))
    energies, squares = (
        client.collect(Float64, 'energy'), client.collect(Float64, 'angular_momentum_squared'))
    client.until(lambda: min(map(len, (poses, spins, energies, squares))) >= 100, what='100 ticks')
    stamps = [nanoseconds(pose) for pose in poses]
    assert len({stamp % PERIOD for stamp in stamps + [nanoseconds(spin) for spin in spins]}) == 1
    assert {after - before for before, after in itertools.pairwise(stamps)} == {PERIOD}
    assert {pose.header.frame_id for pose in poses} == {'world'}
    assert {spin.header.frame_id for spin in spins} == {'body'}
    assert all(math.isclose(np.linalg.norm([q.x, q.y, q.z, q.w]), 1.0, rel_tol=1e-15)
               for q in (pose.pose.orientation for pose in poses))


def test_a_marker_comes_thirty_times_a_second_whatever_the_ticks(client):
    markers = client.collect(Marker, 'marker', 100)
    client.until(lambda: len(markers) >= 10, what='10 markers')
    ticks = [(nanoseconds(marker) - nanoseconds(markers[0])) / PERIOD for marker in markers]
    # 250 / 30 = 8 1/3: the first tick at or after each instant
    assert set(np.diff(ticks)) == {8.0, 9.0}
    assert abs(np.diff(ticks).sum() - (len(ticks) - 1) * RATE / 30.0) < 1.0


def test_topics_are_reliable_and_only_those_asked_for(client):
    topics = dict(client.node.get_topic_names_and_types())
    for name in ('pose', 'angular_velocity', 'energy', 'angular_momentum_squared', 'odom', 'imu',
                 'marker', 'events', 'scene'):
        [publisher] = client.node.get_publishers_info_by_topic(f'/{name}')
        assert publisher.qos_profile.reliability.name == 'RELIABLE', name
    assert not {'/joint_states', '/tf', '/clock', '/reaction'} & set(topics)


@pytest.mark.parametrize('frame', ['body', 'world', ''])
def test_impulse_changes_the_momentum_by_exactly_its_value_at_one_tick(client, frame):
    publisher = client.publisher(WrenchStamped, 'cmd_impulse')
    states = States(client)
    client.until(lambda: len(states.poses) > 20, what='ticks before')
    given = (0.25, -0.5, 1.0)
    publisher.publish(wrench(frame, torque=given))
    client.spin(0.4)
    stamps, momenta = states.momenta(INERTIA)
    steps = np.diff(momenta, axis=0)
    [k] = np.flatnonzero(np.abs(steps).max(axis=1) > 1e-9)
    assert stamps[k + 1] - stamps[k] == PERIOD
    expected = given
    if frame == 'body':
        q = next(pose.pose.orientation
                 for pose in states.poses if nanoseconds(pose) == stamps[k + 1])
        expected = rotate(q.x, q.y, q.z, q.w, *given)
    # measured 9e-16: round-off of momenta of size 3
    np.testing.assert_allclose(steps[k], expected, rtol=0.0, atol=TURNED)


def test_held_wrench_is_the_same_whatever_its_rate_of_messages(client):
    """A torque along L of a free body in world axes: L grows by torque x time at every tick."""
    publisher = client.publisher(WrenchStamped, 'cmd_wrench')
    states = States(client)
    client.until(lambda: len(states.poses) > 5, what='ticks')
    torque = np.array([0.0, 0.5, 0.25])
    for _ in range(200):
        publisher.publish(wrench('world', torque=torque))
    client.spin(0.3)
    publisher.publish(wrench('world'))
    client.spin(0.2)
    _, momenta = states.momenta(INERTIA)
    growing = np.diff(momenta, axis=0)
    held = np.abs(growing).max(axis=1) > 1e-9
    assert 20 < held.sum() < len(held)
    # measured 2e-13, the accuracy asked for is 1e-12
    np.testing.assert_allclose(
        growing[held], np.tile(torque / RATE, (held.sum(), 1)), rtol=0.0, atol=1e-11)
    assert np.all(np.diff(np.flatnonzero(held)) == 1)


@pytest.mark.parametrize(('message', 'reason'), [
    (wrench('bdy', torque=(1.0, 0.0, 0.0)), 'frame_id'),
    (wrench('body', torque=(math.nan, 0.0, 0.0)), 'not finite'),
    (wrench('world', force=(0.0, -math.inf, 0.0)), 'not finite'),
    (wrench('world', force=(1e300, 0.0, 0.0)), 'too large'),
])
def test_what_cannot_be_right_is_refused_with_the_line_that_would_be(client, message, reason):
    events = client.collect(DiagnosticStatus, 'events', 10)
    states = States(client)
    publisher = client.publisher(WrenchStamped, 'cmd_impulse')
    client.until(lambda: len(states.poses) > 5, what='ticks')
    # an event a second for each reason: ask again until one is told
    def refused():
        publisher.publish(message)
        client.spin(0.1)
        return [event
                for event in events if event.name == 'command refused' and reason in event.message]
    event = client.until(refused, what='the event')[0]
    values = {pair.key: pair.value for pair in event.values}
    assert event.level == DiagnosticStatus.ERROR
    assert values['right'].startswith('ros2 topic pub --once /cmd_impulse '
                                      'geometry_msgs/msg/WrenchStamped "{header: {frame_id: body}')
    assert int(values['tick']) > 0
    _, momenta = states.momenta(INERTIA)
    # nothing of it is applied: measured 1e-15
    assert np.abs(np.diff(momenta, axis=0)).max() < 1e-13


def test_late_joiner_gets_the_scene_and_past_events(client):
    scenes, events = (client.collect(String, 'scene', LATCHED),
                      client.collect(DiagnosticStatus, 'events', LATCHED))
    client.until(lambda: scenes, what='the latched scene')
    assert scenes[0].data.startswith('scene: free_body\n')
    # latched messages come one by one
    client.until(lambda: [event for event in events if event.name == 'reset'],
                 what='the event of the reset')


def test_reset_puts_the_state_back_and_stamps_go_on(client):
    states = States(client)
    client.until(lambda: len(states.poses) > 50, what='ticks before')
    response = client.call(Trigger, '/sim_node/reset')
    assert response.success
    assert response.message.startswith('the state went back at tick ')
    client.until(lambda: len(states.poses) > 100, what='ticks after')
    stamps = [nanoseconds(pose) for pose in states.poses]
    assert {after - before for before, after in itertools.pairwise(stamps)} == {PERIOD}
    start = [pose for pose in states.poses if pose.pose.orientation.w == 1.0]
    assert len(start) >= 1


def test_paused_node_queues_commands_and_steps_tick_by_tick(client):
    states = States(client)
    publisher = client.publisher(WrenchStamped, 'cmd_impulse')
    client.until(lambda: len(states.poses) > 5, what='ticks')
    assert not client.call(Trigger, '/sim_node/step').success
    assert client.call(SetBool, '/sim_node/pause', data=True).success
    client.settle(states.poses, states.spins)
    # the two topics may have been heard from different ticks on
    before, spins_before, (_, momenta) = (
        len(states.poses), len(states.spins), states.momenta(INERTIA))
    publisher.publish(wrench('world', torque=(1.0, 0.0, 0.0)))
    publisher.publish(wrench('world', torque=(0.0, 1.0, 0.0)))
    client.spin(0.2)
    assert len(states.poses) == before
    for _ in range(2):
        assert client.call(Trigger, '/sim_node/step').message.startswith('tick ')
    client.until(lambda: len(states.poses) == before + 2 and len(states.spins) == spins_before + 2,
                 what='two steps')
    stamps, stepped = states.momenta(INERTIA)
    assert (stamps[-1] - stamps[-2], stamps[-2] - stamps[-3]) == (PERIOD, PERIOD)
    np.testing.assert_allclose(stepped[-2] - momenta[-1], [1.0, 1.0, 0.0], rtol=0.0, atol=TURNED)
    np.testing.assert_allclose(stepped[-1], stepped[-2], rtol=0.0, atol=TURNED)
    assert client.call(SetBool, '/sim_node/pause', data=False).success
    client.until(lambda: len(states.poses) > before + 20, what='ticks after')
    stamps = [nanoseconds(pose) for pose in states.poses]
    assert {after - before for before, after in itertools.pairwise(stamps)} == {PERIOD}


def test_diagnostics_tell_with_17_digits(client):
    arrays = client.collect(DiagnosticArray, '/diagnostics')
    client.until(lambda: arrays, what='/diagnostics')
    statuses = {status.name: status for status in arrays[0].status}
    assert set(statuses) >= {f'sim_node: {name}'
                             for name in ('ledger', 'timing', 'commands', 'recording')}
    assert statuses['sim_node: ledger'].level == DiagnosticStatus.OK
    ledger = {pair.key: pair.value for pair in statuses['sim_node: ledger'].values}
    assert f'{float(ledger["kinetic"]):.17g}' == ledger['kinetic']
    assert abs(float(ledger['energy_residual'])) < 1e-11
    assert ledger['method'] == 'exact' and 0.0 < float(ledger['expected_error']) < 1e-12
    assert statuses['sim_node: recording'].message == 'recording'
    prediction = {pair.key: pair.value for pair in statuses['sim_node: prediction'].values}
    expected = asymmetric_top.time_between_flips((1.0, 2.0, 2.5), (1.0, 0.8, -1.5))
    assert (prediction['event'], float(prediction['predicted_interval'])) == (
        'flip', near(expected, rel=1e-12))


def set_parameter(client, name, **value):
    types = {'double_value': ParameterType.PARAMETER_DOUBLE,
             'integer_value': ParameterType.PARAMETER_INTEGER,
             'string_value': ParameterType.PARAMETER_STRING}
    [field] = value
    parameter = Parameter(name=name, value=ParameterValue(type=types[field], **value))
    [result] = client.call(
        SetParameters, '/sim_node/set_parameters', parameters=[parameter]).results
    return result


@pytest.mark.parametrize(('name', 'value', 'reason'), [
    ('rate', {'double_value': -5.0}, 'Min: 0.001'),
    ('rate', {'string_value': 'abc'}, 'Wrong parameter type'),
    ('scene', {'string_value': 'tenis_racket'}, 'did you mean tennis_racket?'),
    ('integrator', {'string_value': 'dop9'}, "did you mean 'dop8'?"),
    ('record', {'string_value': 'no'}, 'read-only'),
    ('ratee', {'double_value': 5.0}, 'ratee; did you mean rate?'),
])
def test_wrong_parameter_is_refused_with_the_reason(client, name, value, reason):
    result = set_parameter(client, name, **value)
    assert not result.successful
    assert reason in result.reason


def test_rate_changes_at_a_tick_and_an_integer_will_do(client):
    poses = client.collect(PoseStamped, 'pose', 1000)
    client.until(lambda: len(poses) > 10, what='ticks before')
    assert set_parameter(client, 'rate', integer_value=100).successful

    def step():
        return nanoseconds(poses[-1]) - nanoseconds(poses[-2])
    client.until(lambda: step() == 10**7, what='ticks after')
    assert set_parameter(client, 'rate', double_value=float(RATE)).successful
    client.until(lambda: step() == PERIOD, what='ticks at the old rate')
    steps = np.diff([nanoseconds(pose) for pose in poses])
    changes = np.flatnonzero(np.diff(steps))
    assert [steps[0], *steps[changes + 1]] == [PERIOD, 10**7, PERIOD]
    [descriptor] = client.call(
        DescribeParameters, '/sim_node/describe_parameters', names=['rate']).descriptors
    assert descriptor.floating_point_range[0].from_value == 1e-3


def test_scene_changes_at_a_tick(client):
    poses, scenes, events = client.collect(PoseStamped, 'pose', 1000), client.collect(
        String, 'scene'), client.collect(DiagnosticStatus, 'events')
    client.until(lambda: len(poses) > 10, what='ticks before')
    assert set_parameter(client, 'scene', string_value='sphere').successful
    client.until(lambda: scenes and any(event.name != 'flip' for event in events),
                 what='the new scene')
    assert scenes[-1].data.startswith('scene: sphere\n')
    # the racket may have flipped before
    assert [event.name for event in events if event.name != 'flip'] == ['parameters changed']
    assert set_parameter(client, 'scene', string_value='free_body').successful
    client.until(lambda: len(scenes) == 2, what='the old scene')
    stamps = [nanoseconds(pose) for pose in poses]
    assert {after - before for before, after in itertools.pairwise(stamps)} == {PERIOD}
