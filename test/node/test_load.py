# SPDX-License-Identifier: Apache-2.0
"""The node under load, on other clocks, and among clients that fit badly."""

import itertools
import subprocess
import sys

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import PoseStamped, WrenchStamped
from notices import without_notices
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Float64

from rigid_body_sim.recording.reader import Recording

FLOOD = """
import sys, time, rclpy
from geometry_msgs.msg import WrenchStamped
from rclpy.duration import Duration
rclpy.init()
node = rclpy.create_node('flood')
publisher = node.create_publisher(WrenchStamped, 'cmd_impulse', 5000)
while not publisher.get_subscription_count():
    time.sleep(0.01)
time.sleep(0.2)
message = WrenchStamped()
message.header.frame_id = 'body'
message.wrench.force.x = float(sys.argv[1])
began = time.monotonic()
for k in range(int(sys.argv[2])):
    message.wrench.torque.z = 1e-9 * k
    publisher.publish(message)
    if (ahead := began + k / float(sys.argv[3]) - time.monotonic()) > 0.002:
        time.sleep(ahead)
sys.exit(not publisher.wait_for_all_acked(Duration(seconds=50)))
"""


def stamp(message):
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


def diagnosis(arrays, name):
    """Return the values of the last status of that name."""
    for array in reversed(arrays):
        for status in array.status:
            if status.name == f'sim_node: {name}':
                return ({pair.key: pair.value for pair in status.values}
                        | {'level': status.level, 'message': status.message})
    return {}


def set_parameter(client, name, value):
    parameter = Parameter(
        name=name, value=ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=value))
    assert client.call(
        SetParameters, '/sim_node/set_parameters', parameters=[parameter]).results[0].successful


def test_flood_from_two_publishers_is_applied_once_each_and_in_order(run_node):
    """Two processes send 2500 impulses a second; the journal has all in their senders' order."""
    count = 2500
    # room for all, however late the machine lets the node look
    with run_node('-p', 'rate:=500', '-p',
                  f'qos_overrides./cmd_impulse.subscription.depth:={2 * count}') as node:
        arrays = node.client.collect(DiagnosticArray, '/diagnostics')
        senders = [subprocess.Popen([sys.executable, '-c', FLOOD, str(sender), str(count), '2500'],
                                    env=node.domain.environment)
                   for sender in (1, 2)]
        for sender in senders:
            assert sender.wait(60) == 0
        node.client.until(
            lambda: int(diagnosis(arrays, 'commands').get('applied', 0)) >= 2 * count,
            what='all commands')
        found = diagnosis(arrays, 'commands')
        node.process.terminate()
        assert node.process.wait(5.0) == 0
    assert ([found[name] for name in ('received', 'accepted', 'applied', 'refused', 'waiting')]
            == [str(2 * count)] * 3 + ['0', '0'])
    [path] = (node.folder / 'recordings').iterdir()
    with Recording(path) as recording:
        entries = [entry for entry in recording.journal() if entry['kind'] == 'commands']
        assert recording.topics['/cmd_impulse'].count == 2 * count
    commands = [command for entry in entries for command in entry['commands']]
    assert [entry['tick'] for entry in entries] == sorted({entry['tick'] for entry in entries})
    for sender in (1.0, 2.0):
        assert [command['torque'][2] for command in commands if command['force'][0] == sender] == [
            1e-9 * k for k in range(count)]


def test_commands_that_a_full_queue_drives_out_are_counted(run_node):
    """Room for five, a look every 10 ms: most of 2000 at once are lost, and all are counted."""
    count = 2000
    with run_node('-p', 'rate:=1', '-p', 'record:=false', '-p',
                  'qos_overrides./cmd_impulse.subscription.depth:=5') as node:
        arrays = node.client.collect(DiagnosticArray, '/diagnostics')
        publisher = node.client.publisher(WrenchStamped, 'cmd_impulse', QoSProfile(depth=count))
        publisher.publish(WrenchStamped())
        node.client.until(
            lambda: diagnosis(arrays, 'commands').get('received') == '1', what='the first command')
        for _ in range(count):
            publisher.publish(WrenchStamped())

        def counted():
            found = diagnosis(arrays, 'commands')
            return int(found['received']) + int(found['lost']) == count + 1
        node.client.until(counted, what='all commands')
        warned = [status for array in arrays for status in array.status
                  if status.name == 'sim_node: commands' and 'lost on the way' in status.message]
        assert {status.level for status in warned} == {DiagnosticStatus.WARN}
        assert int(diagnosis(arrays, 'commands')['lost']) > count // 2


def test_rate_that_cannot_be_held_is_told_and_recovers(run_node):
    with run_node('-p', 'record:=false', '-p', 'stamp_origin:=zero') as node:
        client = node.client
        arrays = client.collect(DiagnosticArray, '/diagnostics')
        set_parameter(client, 'rate', 1e5)
        client.until(lambda: diagnosis(arrays, 'timing').get('level') == DiagnosticStatus.ERROR,
                     what='an error')
        found = diagnosis(arrays, 'timing')
        assert found['message'].startswith('it does not keep up: ')
        assert 0.0 < float(found['achieved_rate']) < 1e5
        assert float(found['slipped']) > 0.0
        set_parameter(client, 'rate', 100.0)
        poses = client.collect(PoseStamped, 'pose', 100)
        client.until(lambda: len(poses) > 50, what='ticks')
        stamps = [stamp(pose) for pose in poses]
        assert {after - before for before, after in itertools.pairwise(stamps)} == {10**7}
        arrays.clear()
        client.until(lambda: len(arrays) > 3, what='diagnostics')
        before, after = (float(diagnosis(arrays[:k], 'timing')['slipped']) for k in (2, 4))
        assert before == after


def test_external_clock_is_followed_through_pauses_and_jumps(run_node):
    with run_node('-p', 'use_sim_time:=true', '-p', 'rate:=100', '-p', 'record:=false') as node:
        client = node.client
        poses, arrays = (client.collect(PoseStamped, 'pose', 1000),
                         client.collect(DiagnosticArray, '/diagnostics'))
        client.until(lambda: diagnosis(arrays, 'timing').get('message')
                     == 'waiting for the first message on /clock',
                     what='diagnostics')
        assert poses == []
        clock = client.publisher(Clock, '/clock', QoSProfile(depth=1))

        def show(*instants):
            for instant in instants:
                message = Clock()
                message.clock.sec, message.clock.nanosec = divmod(instant, 10**9)
                clock.publish(message)
                client.spin(0.05)
        start = 1000 * 10**9
        # the first message may be lost while the clock's subscription and our publisher match
        client.until(lambda: show(start) or poses, what='the first tick')
        assert stamp(poses[0]) == start
        show(*(start + k * 10**8 for k in range(1, 11)))
        client.until(lambda: len(poses) == 101, what='one second of ticks')
        arrays.clear()
        client.until(lambda: len(arrays) > 1, what='diagnostics while the clock stands')
        assert len(poses) == 101
        show(start - 10 * 10**9, start - 10 * 10**9 + 10**8)
        client.until(lambda: len(poses) >= 112, what='ticks after the jump')
        stamps = np.array([stamp(pose) for pose in poses])
        assert set(np.diff(stamps)) == {10**7}
        client.until(
            lambda: diagnosis(arrays, 'timing').get('clock_jumps') == '1', what='the jump')


def test_as_fast_as_possible_with_its_own_clock(run_node):
    with run_node('-p', 'real_time_factor:=0', '-p', 'publish:=[clock]', '-p', 'rate:=100', '-p',
                  'record:=false') as node:
        clocks = node.client.collect(Clock, '/clock', 1000)
        arrays = node.client.collect(DiagnosticArray, '/diagnostics')
        node.client.until(lambda: len(clocks) > 100
                          and float(diagnosis(arrays, 'timing').get('achieved_rate', 0)) > 1000.0,
                          what='fast ticks')
        instants = np.array([message.clock.sec * 10**9 + message.clock.nanosec
                             for message in clocks])
        assert (np.diff(instants) % 10**7 == 0).all()
        set_parameter(node.client, 'real_time_factor', 1.0)
        node.client.until(
            lambda: float(diagnosis(arrays, 'timing').get('achieved_rate', 0)) < 110.0,
            what='real time')


def test_own_clock_cannot_be_followed(run_node, ros_domain):
    node = ros_domain.run('-m', 'rigid_body_sim', 'sim_node', '--ros-args', '-p',
                          'publish:=[clock]', '-p', 'use_sim_time:=true')
    assert (node.returncode, without_notices(node.stderr)) == (
        2,
        'parameter publish: got clock together with use_sim_time; a node cannot follow the /clock '
        'that it publishes\n')


def test_clients_that_ask_too_much_are_told_of_once(run_node):
    with run_node('-p', 'record:=false', '-p', 'rate:=100') as node:
        client = node.client
        greedy = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        unreliable = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
        heard = [client.collect(Float64, 'energy', greedy) for _ in range(2)]
        client.node.create_publisher(WrenchStamped, 'cmd_wrench', unreliable)
        client.spin(4.0)
        assert heard == [[], []]
        node.process.terminate()
        lines = [line.split(': ', 1)[1] for line in without_notices(
            node.process.communicate(timeout=5.0)[1]).splitlines()]
    assert sorted(lines) == [
        '/cmd_wrench: a publisher offers less reliability than this node asks for and its '
        'messages do not arrive; offer reliable there, '
        'or start this node with -p '
        'qos_overrides./cmd_wrench.subscription.reliability:=best_effort',
        '/energy: a subscriber asks for more durability than this node offers and gets no '
        'messages; ask for volatile there, '
        'or start this node with -p qos_overrides./energy.publisher.durability:=transient_local']


def test_qos_override_serves_them(run_node):
    with run_node('-p', 'qos_overrides./energy.publisher.durability:=transient_local', '-p',
                  'record:=false', '-p', 'rate:=100') as node:
        heard = node.client.collect(
            Float64, 'energy', QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL))
        node.client.until(lambda: len(heard) > 10, what='messages')
        assert heard[0].data > 0.0
