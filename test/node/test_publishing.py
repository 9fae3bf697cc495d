# SPDX-License-Identifier: Apache-2.0
"""With which quality of service topics are offered."""

import types

import pytest
from rclpy.qos import DurabilityPolicy, ReliabilityPolicy

from rigid_body_sim.messages import state_topics
from rigid_body_sim.node import publishing
from rigid_body_sim.node.publishing import Publishing


class Node:
    """Stands for a node: it keeps the profiles of its publishers, by topic."""

    def __init__(self):
        self.profiles = {}

    def create_publisher(self, message_type, topic, profile, **_):
        self.profiles[topic] = profile
        return types.SimpleNamespace(
            topic_name=f'/a/{topic}', qos_profile=profile, handle=types.SimpleNamespace(
                publish_raw=None))


@pytest.mark.parametrize('described', [True, False])
def test_events_and_the_scene_are_kept_for_late_joiners(monkeypatch, described):
    """The last hundred events and one scene; states are the ten last ones, as ROS has it."""
    node = Node()
    monkeypatch.setattr(publishing, 'Display', lambda *_: None)
    monkeypatch.setattr(publishing, 'import_type', lambda output: None)    # they may be missing
    made = Publishing(node, state_topics.chosen(['tf', 'odom']), state_topics.Frames(), None,
                      described)
    kept = {topic for topic, profile in node.profiles.items()
            if profile.durability == DurabilityPolicy.TRANSIENT_LOCAL}
    assert kept == {'events', 'scene', *(['robot_description'] if described else [])}
    assert {topic: profile.depth for topic, profile in node.profiles.items()} == {
        topic: 100 if topic == 'events' else 1 if topic in kept else 10
        for topic in node.profiles}
    # tf has one name for all nodes; others are those of the namespace
    assert {topic for topic in node.profiles if topic.startswith('/')} == {'/tf'}
    assert {'pose', 'angular_velocity', 'odom'} <= set(node.profiles)
    assert {profile.reliability for profile in node.profiles.values()} <= {
        ReliabilityPolicy.RELIABLE, ReliabilityPolicy.SYSTEM_DEFAULT}
    topics = {topic.name: topic for topic in (*made.every_tick(), *made.others())}
    assert topics['/a/events'].depth == 100 and topics['/a/scene'].depth == 1
    assert topics['/a/scene'].durability == 'transient_local'
    assert made.names()['pose'] == '/a/pose'
