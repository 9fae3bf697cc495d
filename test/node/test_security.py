"""The policy for SROS2 allows the node exactly what it uses."""

import pathlib
from xml.etree import ElementTree

POLICY = pathlib.Path(__file__).resolve().parents[2] / 'config' / 'security' / 'policy.xml'
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
        node.client.until(lambda: ('sim_node', '/') in asked.get_node_names_and_namespaces(), what='the name of the node')

        def names(query):
            return {name for name, _ in query('sim_node', '/')}
        published = node.client.until(lambda: {'/clock', '/diagnostics'} <= (found := names(asked.get_publisher_names_and_types_by_node))
                                      and found, what='the publishers')
        services = node.client.until(lambda: '/sim_node/step' in (found := names(asked.get_service_names_and_types_by_node)) and found,
                                     what='the services')
        subscribed = node.client.until(lambda: '/cmd_impulse' in (found := names(asked.get_subscriber_names_and_types_by_node)) and found,
                                       what='the subscriptions')
    assert published == allowed('sim_node', 'topic', 'publish') - NOT_HERE
    assert subscribed == allowed('sim_node', 'topic', 'subscribe') - {'/clock', '/parameter_events'}
    assert services == allowed('sim_node', 'service', 'reply')


def test_listener_can_change_nothing():
    assert allowed('listener', 'topic', 'publish') == {'/rosout', '/parameter_events'}
    assert allowed('listener', 'service', 'request') == set()
    assert allowed('operator', 'service', 'request') <= allowed('sim_node', 'service', 'reply')
    assert {'/cmd_wrench', '/cmd_impulse'} <= allowed('operator', 'topic', 'publish') & allowed('sim_node', 'topic', 'subscribe')
