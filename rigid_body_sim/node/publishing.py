# SPDX-License-Identifier: Apache-2.0
"""Publishers: the state at every tick, events and the scene for late joiners.

Each message is made once, as bytes, for the wire and for the recording.
"""

from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.qos_overriding_options import QoSOverridingOptions
from std_msgs.msg import String

from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages import robot_description, state_topics
from rigid_body_sim.messages.state_topics import Frames, Outputs, SceneMessages
from rigid_body_sim.node import qos
from rigid_body_sim.node.display import Display
from rigid_body_sim.node.message_types import import_type
from rigid_body_sim.recording import about
from rigid_body_sim.recording.topics import Topic

DEPTH = 10
EVENTS_KEPT = 100


def frames_of(node, settings) -> Frames:
    """Return the names of the frames: prefix (by default the namespace), then name."""
    prefix = settings.frame_prefix
    if prefix == 'auto':
        namespace = node.get_namespace().strip('/')
        prefix = f'{namespace}/' if namespace else ''
    frames = Frames(prefix + settings.world_frame, prefix + settings.body_frame, prefix)
    if frames.world == frames.body or not settings.world_frame or not settings.body_frame:
        raise BadInput(
            'parameter body_frame',
            f'got the frames {frames.world!r} and {frames.body!r}',
            'needs two names that differ',
        )
    return frames


class Publishing:
    """All publishers of a node but /diagnostics; only the tick thread publishes.

    Parameters
    ----------
    node : rclpy.node.Node
    outputs : state_topics.Outputs
    frames : state_topics.Frames
    messages : state_topics.SceneMessages
        The makers of these outputs for the scene that runs first.
    described : bool
        Whether to publish ``robot_description``.

    Attributes
    ----------
    messages : state_topics.SceneMessages
        Those of the present scene.
    """

    def __init__(
        self, node, outputs: Outputs, frames: Frames, messages: SceneMessages, described: bool
    ):
        self._node, self._frames, self._outputs = node, frames, outputs
        self._ticking = [self._output(output) for output in outputs.ticking]
        self._paced = [self._output(output) for output in outputs.paced]
        self._display = Display(node, outputs.ticking)
        self._publish = [publisher.handle.publish_raw for publisher in self._ticking]
        self._publish_paced = [
            (publisher.topic_name, publisher.handle.publish_raw) for publisher in self._paced
        ]
        self._events = self._create(DiagnosticStatus, 'events', _latched(EVENTS_KEPT))
        self._latched = [(self._create(String, 'scene', _latched(1)), about.scene_message)]
        if described:
            publisher = self._create(String, robot_description.TOPIC, _latched(1))
            self._latched.append(
                (publisher, lambda scene: robot_description.message(scene, frames))
            )
        self.messages = messages

    def _output(self, output):
        return self._create(
            import_type(output),
            output.name,
            QoSProfile(depth=DEPTH),
            output.absolute,
        )

    def _create(self, message_type, topic, profile, absolute=False):
        return self._node.create_publisher(
            message_type,
            f'/{topic}' if absolute else topic,
            profile,
            event_callbacks=qos.publisher_mismatch(self._node, topic),
            qos_overriding_options=QoSOverridingOptions(qos.POLICIES),
        )

    def messages_for(self, scene) -> SceneMessages:
        """Return the SceneMessages of a scene; BadInput where a topic has no meaning for it."""
        return state_topics.scene_messages(self._outputs, scene, self._frames)

    def tick(self, messages: list[bytes]):
        """Publish the messages of a tick."""
        for publish, message in zip(self._publish, messages):
            publish(message)
        self._display.tick(messages)

    def paced(self, messages: list[bytes]) -> list[tuple[str, bytes]]:
        """Publish the messages of outputs that have a rate of their own; return them by topic."""
        for (_, publish), message in zip(self._publish_paced, messages):
            publish(message)
        return [(topic, message) for (topic, _), message in zip(self._publish_paced, messages)]

    def event(self, level: int, name: str, message: str, values: dict) -> tuple[str, bytes]:
        """Publish an event; return its topic and bytes. `values` are texts or numbers by name."""
        data = about.event_message(self._node.get_name(), level, name, message, values)
        self._events.handle.publish_raw(data)
        return self._events.topic_name, data

    def scene(self, scene) -> list[tuple[str, bytes]]:
        """Publish the scene as it runs, and the robot it describes; return the bytes by topic."""
        found = []
        for publisher, make in self._latched:
            data = make(scene)
            publisher.handle.publish_raw(data)
            found.append((publisher.topic_name, data))
        return found

    def every_tick(self) -> list[Topic]:
        """Return the topics of every tick."""
        return [
            _offer(publisher, output.type)
            for publisher, output in zip(self._ticking, self._outputs.ticking, strict=True)
        ]

    def names(self) -> dict[str, str]:
        """Return the complete name of each topic of every tick; it may be remapped."""
        return {
            output.name: publisher.topic_name
            for publisher, output in zip(self._ticking, self._outputs.ticking, strict=True)
        }

    def others(self) -> list[Topic]:
        """Return all other topics."""
        return [
            _offer(self._events, about.STATUS_TYPE),
            *(_offer(publisher, about.STRING_TYPE) for publisher, _ in self._latched),
            *(
                _offer(publisher, output.type)
                for publisher, output in zip(self._paced, self._outputs.paced, strict=True)
            ),
        ]


def _latched(depth):
    return QoSProfile(depth=depth, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def _offer(publisher, type_name):
    profile = publisher.qos_profile
    return Topic(
        publisher.topic_name,
        type_name,
        profile.depth,
        profile.reliability.name.lower(),
        profile.durability.name.lower(),
    )
