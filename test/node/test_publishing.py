# SPDX-License-Identifier: Apache-2.0
"""With which quality of service topics are offered, and what is sent on each."""

import types

import pytest
from rclpy.qos import DurabilityPolicy, ReliabilityPolicy

from rigid_body_sim.messages import state_topics
from rigid_body_sim.node import publishing
from rigid_body_sim.node.publishing import Publishing
from rigid_body_sim.scene.scene import load_scene


class Node:
    """Stands for a node: it keeps the profiles of its publishers, by topic."""

    def __init__(self):
        self.profiles, self.sent = {}, []

    def create_publisher(self, message_type, topic, profile, **_):
        self.profiles[topic] = profile
        return types.SimpleNamespace(
            topic_name=f'/a/{topic}', qos_profile=profile, handle=types.SimpleNamespace(
                publish_raw=lambda data: self.sent.append((f'/a/{topic}', data))))

    def get_name(self):
        return 'sim_node'


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


def test_each_message_goes_to_its_topic_and_into_the_recording(monkeypatch):
    node, displayed = Node(), []
    monkeypatch.setattr(publishing, 'Display', lambda *_: types.SimpleNamespace(
        tick=displayed.append))
    monkeypatch.setattr(publishing, 'import_type', lambda output: None)
    outputs = state_topics.chosen(['tf', 'marker', 'odom'])
    made = Publishing(node, outputs, state_topics.Frames(), 'of the scene', True)
    assert made.messages == 'of the scene'
    names = [topic.name for topic in made.every_tick()]
    assert len(names) == len(outputs.ticking) > 2
    data = [name.encode() for name in names]
    made.tick(data)
    assert node.sent == list(zip(names, data, strict=True)) and displayed == [data]
    node.sent.clear()
    others = [topic.name for topic in made.others()]
    assert others == ['/a/events', '/a/scene', '/a/robot_description', '/a/marker', '/a//tf']
    assert made.paced([b'shape', b'turn']) == node.sent == [
        ('/a/marker', b'shape'), ('/a//tf', b'turn')]
    node.sent.clear()
    topic, data = made.event(1, 'strike', 'has hit', {'time': 0.5})
    assert (topic, node.sent) == ('/a/events', [(topic, data)])
    assert b'strike' in data and b'has hit' in data
    node.sent.clear()
    scene = load_scene('tennis_racket')
    assert made.scene(scene) == node.sent
    assert [topic for topic, _ in node.sent] == ['/a/scene', '/a/robot_description']
    assert b'tennis_racket' in node.sent[0][1] and b'<robot' in node.sent[1][1]
    messages = made.messages_for(scene)
    assert messages.ticking is not None and messages.paced is not None
