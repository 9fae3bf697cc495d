# SPDX-License-Identifier: Apache-2.0
"""A running node takes a scene of every effect: it changes, publishes, and takes a command."""

import contextlib

import pytest
import ros
from geometry_msgs.msg import PoseStamped, WrenchStamped
from node.conftest import Running
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from recording.conftest import SOAK
from scene import effect_cases
from std_msgs.msg import String

PATIENCE = 120.0    # s
FIRST = [(name, number) for name, number in effect_cases.ALL if number == 0]


@contextlib.contextmanager
def plain_node(folder, new_client, first):
    """Yield a Running of a node without numba: a scene takes less than compiling it would."""
    with ros.held_domain(folder / 'log') as domain, domain.process(
            '-m', 'rigid_body_sim', 'sim_node', '--ros-args', '-p', f'scene:={first}',
            '-p', 'rate:=20.0', '-p', 'integrator:=dop8', '-p', 'accuracy:=1.0e-6',
            '-p', 'record:=false', env=domain.environment | {'NUMBA_DISABLE_JIT': '1'}
    ) as process, new_client(domain) as client:
        client.until(lambda: process.poll() is not None
                     or client.node.count_publishers('energy'), PATIENCE, 'the node')
        assert process.poll() is None, process.communicate()[1]
        yield Running(domain, process, client, folder)


def change(client, path):
    value = ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=str(path))
    # plain Python tries a scene before it takes it
    [result] = client.call(SetParameters, '/sim_node/set_parameters', timeout=PATIENCE,
                           parameters=[Parameter(name='scene', value=value)]).results
    assert result.successful, f'{path.stem}: {result.reason}'


@pytest.mark.skipif(not SOAK, reason='a minute: RIGID_BODY_SIM_SOAK=1')
def test_a_node_runs_a_scene_of_every_effect(tmp_path, new_client):
    paths = []
    for name, number in FIRST:
        paths.append(tmp_path / f'{name}.yaml')
        paths[-1].write_text(effect_cases.text(name, number))
    with plain_node(tmp_path, new_client, paths[0]) as running:
        client = running.client
        poses, scenes = client.collect(PoseStamped, 'pose', 1000), client.collect(String, 'scene')
        push = client.publisher(WrenchStamped, 'cmd_impulse')
        for path in paths[1:]:
            change(client, path)
            begins = f'scene: {path.stem}_'
            client.until(lambda begins=begins: scenes and scenes[-1].data.startswith(begins),
                         PATIENCE, path.stem)
            message = WrenchStamped()
            message.wrench.torque.z = 1e-4
            push.publish(message)
            poses.clear()
            client.until(lambda: len(poses) > 2, PATIENCE, f'poses of {path.stem}')
        assert running.process.poll() is None
