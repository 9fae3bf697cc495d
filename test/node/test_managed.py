# SPDX-License-Identifier: Apache-2.0
"""The managed node through its life, as a launch system leads it."""

import itertools

import pytest
from geometry_msgs.msg import PoseStamped
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetState
from node.conftest import START
from notices import without_notices
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from std_srvs.srv import SetBool, Trigger

pytestmark = pytest.mark.usefixtures('compiled_kernels')
NODE = '/lifecycle_sim_node'


class Managed:
    """Leads the node through its states."""

    def __init__(self, client):
        self.client = client

    def go(self, transition):
        """Ask for a transition, which may compile; return whether it took place."""
        return self.client.call(ChangeState, f'{NODE}/change_state', timeout=START,
                                transition=Transition(id=transition)).success

    @property
    def state(self):
        return self.client.call(GetState, f'{NODE}/get_state').current_state.label

    def set(self, name, text):
        """Set a text parameter; return the result."""
        value = ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=text)
        return self.client.call(SetParameters, f'{NODE}/set_parameters',
                                parameters=[Parameter(name=name, value=value)]).results[0]

    def topics(self):
        return {name
                for name, _ in self.client.node.get_publisher_names_and_types_by_node(
                    'lifecycle_sim_node', '/')}


def test_life_of_a_managed_node(ros_domain, new_client, tmp_path):
    arguments = ['-p', 'rate:=100', '-p', f'recording.directory:={tmp_path / "recordings"}']
    with ros_domain.process('-m', 'rigid_body_sim.node.lifecycle_sim_node', '--ros-args',
                            *arguments) as process, new_client(ros_domain) as client:
        node = Managed(client)
        client.until(lambda: NODE[1:] in client.node.get_node_names(), 60.0, 'the node')
        assert node.state == 'unconfigured'
        assert '/pose' not in node.topics()
        # what is fixed while it runs is not fixed yet; what is wrong keeps it unconfigured
        assert node.set('frame_prefix', 'ball/').successful
        assert node.set('scene', 'no_such_scene').successful
        assert not node.go(Transition.TRANSITION_CONFIGURE)
        assert node.state == 'unconfigured'
        assert node.set('scene', 'sphere').successful

        assert node.go(Transition.TRANSITION_CONFIGURE)
        assert node.state == 'inactive'
        assert '/pose' in node.topics()
        assert not node.set('frame_prefix', 'other/').successful
        poses = client.collect(PoseStamped, 'pose', 100)
        # a pause that ends does not wake what is inactive
        assert client.call(SetBool, f'{NODE}/pause', data=False).success
        client.spin(0.5)
        assert poses == []

        assert node.go(Transition.TRANSITION_ACTIVATE)
        client.until(lambda: len(poses) > 20, what='ticks')
        assert poses[0].header.frame_id == 'ball/world'
        assert node.go(Transition.TRANSITION_DEACTIVATE)
        client.spin(0.3)
        before = len(poses)
        client.spin(0.3)
        assert len(poses) == before
        assert client.call(Trigger, f'{NODE}/reset').success
        assert node.go(Transition.TRANSITION_ACTIVATE)
        client.until(lambda: len(poses) > before + 20, what='ticks after')
        stamps = [pose.header.stamp.sec * 10**9 + pose.header.stamp.nanosec for pose in poses]
        assert all(after - before == 10**7 for before, after in itertools.pairwise(stamps))

        assert node.go(Transition.TRANSITION_DEACTIVATE)
        assert node.go(Transition.TRANSITION_CLEANUP)
        assert node.state == 'unconfigured'
        assert not {'/pose', '/events', '/diagnostics'} & node.topics()
        [first] = (tmp_path / 'recordings').iterdir()
        assert (first / 'metadata.yaml').exists()

        assert node.go(Transition.TRANSITION_CONFIGURE)
        assert node.go(Transition.TRANSITION_ACTIVATE)
        count = len(poses)
        client.until(lambda: len(poses) > count + 20, what='ticks of the second run')
        assert node.go(Transition.TRANSITION_ACTIVE_SHUTDOWN)
        assert process.wait(5.0) == 0
        assert without_notices(process.communicate()[1]).count('\n') <= 1
    assert len([path
                for path in (tmp_path / 'recordings').iterdir()
                if (path / 'metadata.yaml').exists()]) == 2


@pytest.mark.parametrize(
    'transitions', [[], [Transition.TRANSITION_CONFIGURE]], ids=['unconfigured', 'inactive'])
def test_signal_ends_it_in_every_state(ros_domain, new_client, tmp_path, transitions):
    arguments = ['-p', f'recording.directory:={tmp_path / "recordings"}']
    with ros_domain.process('-m', 'rigid_body_sim.node.lifecycle_sim_node', '--ros-args',
                            *arguments) as process, new_client(ros_domain) as client:
        client.until(lambda: NODE[1:] in client.node.get_node_names(), 60.0, 'the node')
        for transition in transitions:
            assert Managed(client).go(transition)
        process.terminate()
        assert process.wait(5.0) == 0


def test_a_request_that_does_not_fit_is_answered(ros_domain, new_client, tmp_path):
    """Each transition in each state in which it does not fit; what rclpy itself raises on."""
    arguments = ['-p', 'rate:=100', '-p', f'recording.directory:={tmp_path / "recordings"}']
    unfit = {'unconfigured': [3, 4, 2, 99, 250],
             'inactive': [1, 4, 99],
             'active': [1, 2, 3, 99, 0]}
    with ros_domain.process('-m', 'rigid_body_sim.node.lifecycle_sim_node', '--ros-args',
                            *arguments) as process, new_client(ros_domain) as client:
        node = Managed(client)
        client.until(lambda: NODE[1:] in client.node.get_node_names(), 60.0, 'the node')
        for go in (None, Transition.TRANSITION_CONFIGURE, Transition.TRANSITION_ACTIVATE):
            if go is not None:
                assert node.go(go)
            state = node.state
            for transition in unfit[state]:
                assert not node.go(transition), f'{transition} from {state}'
                assert node.state == state
            for label in ('configure', 'no such word') if state == 'active' else ['deactivate']:
                given = Transition(label=label)
                assert not client.call(ChangeState, f'{NODE}/change_state',
                                       transition=given).success
                assert node.state == state
        # a type of parameter that does not exist: rclpy raises before it looks at the name
        wrong = Parameter(name='rate', value=ParameterValue(type=200))
        for service in (SetParameters, SetParametersAtomically):
            name = 'set_parameters' + ('_atomically' if service is SetParametersAtomically else '')
            client.call(service, f'{NODE}/{name}', parameters=[wrong])
        assert node.state == 'active'
        process.terminate()
        assert process.wait(5.0) == 0


def test_a_failed_configure_leaves_nothing_behind(ros_domain, new_client, tmp_path):
    folder = tmp_path / 'recordings'
    (folder / 'mine').mkdir(parents=True)
    arguments = ['-p', 'rate:=100', '-p', f'recording.directory:={folder}',
                 '-p', 'recording.name:=mine']
    with ros_domain.process('-m', 'rigid_body_sim.node.lifecycle_sim_node', '--ros-args',
                            *arguments) as process, new_client(ros_domain) as client:
        node = Managed(client)
        client.until(lambda: NODE[1:] in client.node.get_node_names(), 60.0, 'the node')
        for _ in range(2):
            # the folder of somebody else is never added to
            assert not node.go(Transition.TRANSITION_CONFIGURE)
            client.until(lambda: '/pose' not in node.topics(), what='the topics to go')
        (folder / 'mine').rmdir()
        names = 'mine', 'mine_2', 'mine_3'
        for count in range(len(names)):
            assert node.go(Transition.TRANSITION_CONFIGURE)
            client.until(lambda: '/pose' in node.topics(), what='the topics')
            publishers = client.node.get_publishers_info_by_topic('/pose')
            assert len(publishers) == 1
            assert node.go(Transition.TRANSITION_CLEANUP)
            assert sorted(path.name for path in folder.iterdir()) == sorted(names[:count + 1])
        assert all((folder / name / 'metadata.yaml').exists() for name in names)
        process.terminate()
        assert process.wait(5.0) == 0
