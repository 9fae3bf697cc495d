"""Publishers: the state at every tick, events and the scene for late joiners; each message is made once, as bytes, for wire and recording."""

import importlib

from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.qos_overriding_options import QoSOverridingOptions
from std_msgs.msg import String

from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages import state_topics
from rigid_body_sim.messages.tick_messages import TickMessages
from rigid_body_sim.node import qos
from rigid_body_sim.recording import about
from rigid_body_sim.recording.topics import Topic

DEPTH = 10
EVENTS_KEPT = 100


def frames_of(node, settings):
    """Return the names of the frames: prefix (by default the namespace), then name."""
    prefix = settings.frame_prefix
    if prefix == 'auto':
        namespace = node.get_namespace().strip('/')
        prefix = f'{namespace}/' if namespace else ''
    frames = state_topics.Frames(prefix + settings.world_frame, prefix + settings.body_frame, prefix)
    if frames.world == frames.body or not settings.world_frame or not settings.body_frame:
        raise BadInput('parameter body_frame', f'got the frames {frames.world!r} and {frames.body!r}', 'needs two names that differ')
    return frames


class Publishing:
    """All publishers of a node but /diagnostics. Messages are published by the tick thread only.

    Parameters
    ----------
    node : rclpy.node.Node
    outputs : list of state_topics.Output
    frames : state_topics.Frames
    messages : tick_messages.TickMessages
        Of these outputs, for the scene that runs first.

    Attributes
    ----------
    ticking : tick_messages.TickMessages
        Makes the messages of a tick for the present scene.
    """

    def __init__(self, node, outputs, frames, messages):
        self._node, self._frames, self._outputs = node, frames, outputs
        self._publishers = [self._create(output.type, output.name, QoSProfile(depth=DEPTH), output.absolute) for output in self._outputs]
        self._publish = [publisher.handle.publish_raw for publisher in self._publishers]
        self._events = self._create(DiagnosticStatus, 'events', _latched(EVENTS_KEPT))
        self._scene = self._create(String, 'scene', _latched(1))
        self.ticking = messages

    def _create(self, type_or_name, topic, profile, absolute=False):
        message_type = type_or_name if isinstance(type_or_name, type) else _import_type(type_or_name, topic)
        return self._node.create_publisher(
            message_type, f'/{topic}' if absolute else topic, profile, event_callbacks=qos.publisher_mismatch(self._node, topic),
            qos_overriding_options=QoSOverridingOptions(qos.POLICIES))

    def messages_for(self, scene):
        """Return the TickMessages for a scene; BadInput where a topic that is published has no meaning for it."""
        return TickMessages(self._outputs, scene, self._frames)

    def tick(self, messages):
        """Publish the messages of a tick, as `ticking` made them."""
        for publish, message in zip(self._publish, messages):
            publish(message)

    def event(self, level, name, message, values):
        """Publish an event; return the topic's complete name and its bytes. `values` maps names to texts or numbers."""
        data = about.event_message(self._node.get_name(), level, name, message, values)
        self._events.handle.publish_raw(data)
        return self._events.topic_name, data

    def scene(self, scene):
        """Publish the scene as it runs; return the topic's complete name and its bytes."""
        data = about.scene_message(scene)
        self._scene.handle.publish_raw(data)
        return self._scene.topic_name, data

    def every_tick(self):
        """Return the topics of every tick, as recording.topics.Topic."""
        return [_offer(publisher, output.type) for publisher, output in zip(self._publishers, self._outputs, strict=True)]

    def others(self):
        """Return events and scene, as recording.topics.Topic."""
        return [_offer(self._events, about.STATUS_TYPE), _offer(self._scene, about.STRING_TYPE)]


def _latched(depth):
    return QoSProfile(depth=depth, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def _offer(publisher, type_name):
    profile = publisher.qos_profile
    return Topic(publisher.topic_name, type_name, profile.depth, profile.reliability.name.lower(), profile.durability.name.lower())


def _import_type(name, topic):
    package, _, message = name.split('/')
    try:
        return getattr(importlib.import_module(f'{package}.msg'), message)
    except ImportError:
        raise BadInput('parameter publish', f'got {topic}, but {package} is not installed here',
                       f'install {package}, or leave {topic} out') from None
