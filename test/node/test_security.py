# SPDX-License-Identifier: Apache-2.0
"""The policy for SROS2 allows the node exactly what it uses."""

import pathlib
from xml.etree import ElementTree

import pytest

POLICY = pathlib.Path(__file__).resolve().parents[2] / 'config' / 'security' / 'policy.xml'
FILES = ('identity_ca.cert.pem', 'cert.pem', 'key.pem', 'permissions_ca.cert.pem',
         'governance.p7s', 'permissions.p7s')
NOT_HERE = {'/tf', '/joint_states', '/reaction'}
"""Published only where tf2 is installed, by a hinge, by what is held."""


def allowed(node, kind, way):
    """Return the full names that the policy allows a node."""
    profile = ElementTree.parse(POLICY).find(f'.//profile[@node="{node}"]')
    names = [entry.text for entry in profile.findall(f'{kind}s[@{way}="ALLOW"]/{kind}')]
    assert len(names) == len(set(names))
    return {name.replace('~', f'/{node}') if name[0] in '~/' else f'/{name}' for name in names}


def test_node_may_use_exactly_what_it_uses(run_node):
    topics = '["odom","imu","marker","clock"]'
    with run_node('-p', 'rate:=100', '-p', 'record:=false', '-p', f'publish:={topics}') as node:
        asked = node.client.node
        node.client.until(lambda: ('sim_node', '/') in asked.get_node_names_and_namespaces(),
                          what='the name of the node')

        def names(query):
            return {name for name, _ in query('sim_node', '/')}
        published = node.client.until(lambda: {'/clock', '/diagnostics'} <= (found := names(
                                          asked.get_publisher_names_and_types_by_node)) and found,
                                      what='the publishers')
        services = node.client.until(lambda: '/sim_node/step' in (found := names(
                                         asked.get_service_names_and_types_by_node)) and found,
                                     what='the services')
        subscribed = node.client.until(
            lambda: '/cmd_impulse' in (found := names(
                asked.get_subscriber_names_and_types_by_node)) and found,
            what='the subscriptions')
    assert published == allowed('sim_node', 'topic', 'publish') - NOT_HERE
    assert (subscribed
            == allowed('sim_node', 'topic', 'subscribe') - {'/clock', '/parameter_events'})
    assert services == allowed('sim_node', 'service', 'reply')


def test_listener_can_change_nothing():
    assert allowed('listener', 'topic', 'publish') == {'/rosout', '/parameter_events'}
    assert allowed('listener', 'service', 'request') == set()
    assert allowed('operator', 'service', 'request') <= allowed('sim_node', 'service', 'reply')
    assert ({'/cmd_wrench', '/cmd_impulse'}
            <= allowed('operator', 'topic', 'publish') & allowed('sim_node', 'topic', 'subscribe'))


@pytest.mark.parametrize('keys', [False, True])
def test_node_that_cannot_be_as_secure_as_asked_does_not_run(ros_domain, tmp_path, keys):
    """Nothing of ROS runs without keys, nor with files that are none.

    The Fast DDS of the wheels is built without security and never runs then.
    """
    enclave = tmp_path / 'enclaves' / 'rigid_body_sim' / 'sim_node'
    enclave.mkdir(parents=True)
    for name in FILES if keys else ():
        (enclave / name).write_text('none')
    environment = {**ros_domain.environment, 'ROS_SECURITY_KEYSTORE': str(tmp_path),
                   'ROS_SECURITY_ENABLE': 'true', 'ROS_SECURITY_STRATEGY': 'Enforce'}
    done = ros_domain.run('-m', 'rigid_body_sim', 'sim_node', '--ros-args', '--enclave',
                          '/rigid_body_sim/sim_node', '-p', 'record:=false', env=environment)
    assert done.returncode == 2
    assert 'Traceback' not in done.stderr
    assert done.stderr.splitlines()[-1].lower().startswith('ros')
