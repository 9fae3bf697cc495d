# SPDX-License-Identifier: Apache-2.0
"""Nodes in namespaces share only /diagnostics; two of one name are told of each other."""

import contextlib
import select

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped, Vector3Stamped
from notices import without_notices

from rigid_body_sim.compilation.jit import HAVE_NUMBA

pytestmark = pytest.mark.usefixtures('compiled_kernels')
PLATFORM = {'/rosout', '/parameter_events', '/diagnostics'}


@contextlib.contextmanager
def nodes(domain, folder, *names):
    """Run nodes with the given remappings beside each other."""
    with contextlib.ExitStack() as stack:
        yield [stack.enter_context(domain.process(
            '-m', 'rigid_body_sim', 'sim_node', '--ros-args', '-p', 'rate:=100', '-p',
            f'recording.directory:={folder / "recordings"}', '-r', name)) for name in names]


def test_two_namespaced_nodes_share_nothing_but_diagnostics(ros_domain, new_client, tmp_path):
    with nodes(ros_domain, tmp_path, '__ns:=/left', '__ns:=/right') as both, new_client(
            ros_domain) as client:
        arrays = client.collect(DiagnosticArray, '/diagnostics', 100)
        poses = {name: client.collect(PoseStamped, f'/{name}/pose') for name in ('left', 'right')}
        spins = {name: client.collect(Vector3Stamped, f'/{name}/angular_velocity')
                 for name in ('left', 'right')}
        client.until(lambda: all((*poses.values(), *spins.values()))
                     and len({one.status[0].name for one in arrays}) == 2,
                     60.0, 'both nodes')
        topics = {name: {topic
                         for topic, _ in client.node.get_publisher_names_and_types_by_node(
                             'sim_node', f'/{name}')}
                  | {topic
                     for topic, _ in client.node.get_subscriber_names_and_types_by_node(
                         'sim_node', f'/{name}')}
                  for name in poses}
        assert topics['left'] & topics['right'] <= PLATFORM
        for name in ('left', 'right'):
            assert (topics[name] - PLATFORM
                    >= {f'/{name}/pose', f'/{name}/cmd_wrench', f'/{name}/events'})
            assert {pose.header.frame_id for pose in poses[name]} == {f'{name}/world'}
            assert {spin.header.frame_id for spin in spins[name]} == {f'{name}/body'}
        statuses = [{status.name for status in array.status} for array in arrays]
        assert {name.split(':')[0] for names in statuses for name in names} == {
            'left/sim_node', 'right/sim_node'}
        for process in both:
            process.terminate()
            assert process.wait(5.0) == 0
    assert (sorted(path.name.split('_tennis')[0] for path in (tmp_path / 'recordings').iterdir())
            == ['left_sim_node', 'right_sim_node'])


def test_second_node_of_the_same_name_is_warned_of(ros_domain, new_client, tmp_path):
    with nodes(ros_domain, tmp_path, '__node:=twin', '__node:=twin') as twins, new_client(
            ros_domain) as client:
        client.until(lambda: client.node.count_publishers('/pose') == 2, 60.0, 'both nodes')
        if not HAVE_NUMBA:
            said = [one.stderr.readline() for one in twins]
            assert without_notices(''.join(said)) == ''
        # they look once a second, ten times
        client.until(lambda: select.select([one.stderr for one in twins], [], [], 0.0)[0], 30.0,
                     'a warning')
        said = []
        for process in twins:
            process.terminate()
            said.append(process.communicate(timeout=5.0)[1])
    lines = [line for text in said for line in text.splitlines()]
    assert any('there is another node /twin; give one of them another name: --ros-args -r '
               '__node:=NAME'
               in line
               for line in lines), lines
    assert len(lines) <= 2
    assert len(list((tmp_path / 'recordings').iterdir())) == 2


def test_frames_can_be_named(run_node):
    with run_node('-p', 'frame_prefix:=ball/', '-p', 'world_frame:=map', '-p',
                  'body_frame:=racket', '-p', 'rate:=100') as node:
        spins = node.client.collect(Vector3Stamped, 'angular_velocity')
        poses = node.client.collect(PoseStamped, 'pose')
        node.client.until(lambda: spins and poses, what='messages')
        assert (poses[0].header.frame_id, spins[0].header.frame_id) == ('ball/map', 'ball/racket')
