# SPDX-License-Identifier: Apache-2.0
"""A long run with random commands, changes, services, subscribers, a full disk, a dead recorder.

The quick form takes seconds; RIGID_BODY_SIM_SOAK=1 makes it RIGID_BODY_SIM_SOAK_SECONDS (7200) at
1 kHz. Whatever happened, the recording alone gives every state again to the last bit.
"""

import os
import pathlib
import random
import resource
import signal

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import WrenchStamped
from node.test_load import diagnosis
from notices import without_notices
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from soak import SOAK
from std_msgs.msg import Float64
from std_srvs.srv import SetBool, Trigger

from rigid_body_sim.analysis.resimulate import resimulate

SECONDS = float(os.environ.get('RIGID_BODY_SIM_SOAK_SECONDS', '7200')) if SOAK else 3.0
RATE = 1000.0 if SOAK else 200.0
DISK_FULL = 60.0 if SOAK else 1.5
ROUNDS = 10_000 if SOAK else 40

VALUES = {
    'scene': ['tennis_racket', 'sphere', 'no_such_scene', '../etc/passwd', ''],
    'scene_overrides': [[], ['initial.angular_velocity=[0.2, 4.0, 0.1]'], ['body.mass=-1'],
                        ['nonsense'], ['a=b=c']],
    'integrator': ['auto', 'exact', 'best', ''],
    'accuracy': [1e-12, 1e-6, 0.0, -1.0, 1e300],
    'rate': [100.0, 200.0, 250.0, -5.0, 0.0, 1e9],
    'real_time_factor': [1.0, 2.0, 0.5, -1.0],
    'overrun': ['slip', 'skip_publish', 'stop'],
    'command_timeout': [0.0, 0.05, 0.5, -1.0],
    'diagnostics.lateness_warn': [1e-3, 0.5, -1.0],
    'world_frame': ['map'],
    'ratee': [5.0],
}


# a subscriber that comes, hears some messages and goes
NEWCOMER = """
import rclpy
from std_msgs.msg import Float64
rclpy.init()
node, heard = rclpy.create_node('newcomer'), []
node.create_subscription(Float64, 'energy', heard.append, 10)
while len(heard) < 10:
    rclpy.spin_once(node)
"""


def parameter(name, value):
    kinds = {str: (ParameterType.PARAMETER_STRING, 'string_value'),
             float: (ParameterType.PARAMETER_DOUBLE, 'double_value'),
             list: (ParameterType.PARAMETER_STRING_ARRAY, 'string_array_value')}
    kind, field = kinds[type(value)]
    return Parameter(name=name, value=ParameterValue(type=kind, **{field: value}))


def random_wrench(chance):
    message = WrenchStamped()
    message.header.frame_id = chance.choice(['body', 'world', '', 'nobody'])
    message.wrench.torque.x, message.wrench.torque.y, message.wrench.force.z = (
        chance.uniform(-1e-3, 1e-3) for _ in range(3))
    return message


def disturb(client, publishers, chance):
    """Do one thing to the node that anybody may do."""
    act = chance.random()
    if act < 0.4:
        for publisher in publishers:
            publisher.publish(random_wrench(chance))
    elif act < 0.8:
        names = chance.sample(sorted(VALUES), chance.randint(1, 2))
        results = client.call(
            SetParameters, '/sim_node/set_parameters',
            parameters=[parameter(name, chance.choice(VALUES[name])) for name in names]).results
        assert all(result.successful or result.reason for result in results)
    elif act < 0.9:
        client.call(Trigger, f'/sim_node/{chance.choice(["reset", "step"])}')
    else:
        client.call(SetBool, '/sim_node/pause', data=chance.random() < 0.3)


@pytest.mark.timeout(60.0 + 2.0 * ROUNDS)
def test_storm_of_parameters_and_services_leaves_it_consistent(run_node):
    chance = random.Random(2026)
    with run_node('-p', f'rate:={RATE}') as node:
        client = node.client
        energies, arrays = (
            client.collect(Float64, 'energy'), client.collect(DiagnosticArray, '/diagnostics'))
        publishers = [client.publisher(WrenchStamped, topic)
                      for topic in ('cmd_impulse', 'cmd_wrench')]
        for _ in range(ROUNDS):
            disturb(client, publishers, chance)
        assert client.call(SetBool, '/sim_node/pause', data=False).message == 'running'
        energies.clear()
        arrays.clear()
        client.until(lambda: len(energies) > 20, what='ticks after the storm')
        client.until(lambda: diagnosis(arrays, 'timing').get('paused') == 'False',
                     what='diagnostics after the storm')
        node.process.terminate()
        assert node.process.wait(5.0) == 0
        assert without_notices(node.process.stderr.read()) == ''
    assert_resimulation_is_identical(node)


@pytest.mark.timeout(120.0 + 2.0 * SECONDS)
def test_run_with_all_that_can_befall_it_is_resimulated_to_the_last_bit(run_node):
    chance = random.Random(305)
    with run_node('-p', f'rate:={RATE}') as node:
        client = node.client
        arrays = client.collect(DiagnosticArray, '/diagnostics')
        publishers = [client.publisher(WrenchStamped, topic)
                      for topic in ('cmd_impulse', 'cmd_wrench')]

        def go_on(seconds):
            """Send random commands, while another subscriber comes, listens and goes."""
            for _ in range(max(1, round(seconds / 10.0))):
                with node.domain.process('-c', NEWCOMER) as newcomer:
                    for _ in range(10):
                        publishers[chance.random() < 0.2].publish(random_wrench(chance))
                        client.spin(min(seconds, 10.0) / 10.0)
                    assert newcomer.wait(60.0) == 0

        def recorder():
            client.until(lambda: children(node.process.pid), what='a recorder')
            return children(node.process.pid)[0]

        go_on(SECONDS / 3)
        # as a full disk: writes beyond the present size fail
        pid = recorder()
        [folder] = (node.folder / 'recordings').iterdir()
        size = max(path.stat().st_size for path in folder.iterdir())
        _, most = resource.prlimit(pid, resource.RLIMIT_FSIZE)
        resource.prlimit(pid, resource.RLIMIT_FSIZE, (size, most))
        client.until(lambda: int(diagnosis(arrays, 'recording').get('level', b'\0')[0]) == 2,
                     timeout=60.0, what='the error in /diagnostics')
        go_on(DISK_FULL)
        resource.prlimit(pid, resource.RLIMIT_FSIZE, (most, most))
        client.until(lambda: diagnosis(arrays, 'recording').get('error') == '', timeout=60.0,
                     what='the end of the error')
        go_on(SECONDS / 3)
        os.kill(recorder(), signal.SIGKILL)
        client.until(lambda: int(diagnosis(arrays, 'recording').get('restarts', '0')) > 0,
                     what='another recorder')
        go_on(SECONDS / 3)
        node.process.terminate()
        # on a busy machine a recorder that has begun anew may finish after the node, which says so
        assert node.process.wait(60.0) in (0, 1)
        client.until((folder / 'metadata.yaml').exists, timeout=60.0, what='a whole recording')
    assert_resimulation_is_identical(node)


def children(pid):
    return [int(child) for task in pathlib.Path(f'/proc/{pid}/task').iterdir()
            for child in (task / 'children').read_text().split()]


def assert_resimulation_is_identical(node):
    [path] = (node.folder / 'recordings').iterdir()
    [(_, _, comparison)] = resimulate(path)
    assert comparison.parting is None
    assert comparison.ticks > 20
