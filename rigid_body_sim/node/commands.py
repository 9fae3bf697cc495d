"""Commands from topics: taken by the tick thread itself, checked, and applied at the next tick, each exactly once and in order.

``cmd_wrench`` is held until it is replaced or times out, ``cmd_impulse`` (N s and N m s) acts once. Both are geometry_msgs/WrenchStamped;
the frame_id is the body's or the world's name, empty means the world, and the stamp is ignored. What cannot be right is refused as a whole.
"""

import collections
import math
import struct
import typing

from geometry_msgs.msg import WrenchStamped
from rclpy.callback_groups import CallbackGroup
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.qos import QoSProfile
from rclpy.qos_overriding_options import QoSOverridingOptions

from rigid_body_sim.messages.cdr import ENCAPSULATION
from rigid_body_sim.node import qos
from rigid_body_sim.node.doorbell import Doorbell

WRENCH, IMPULSE = 'cmd_wrench', 'cmd_impulse'
DEPTH = 10_000
"""Messages that may wait in a subscription: a second of 10,000 a second."""
MOST_QUEUED = 100_000
"""Commands that may wait for a tick, while paused or at a low rate."""
LARGEST = 1e100
"""A number beyond this would overflow in the energies."""
_LENGTH, _NUMBERS = struct.Struct('<I').unpack_from, struct.Struct('<6d').unpack_from
_FRAME_AT = 16    # encapsulation, stamp (two numbers of four bytes), length of the frame_id


class Command(typing.NamedTuple):
    """A command that was accepted: its topic, the axes of its numbers, the force and torque (or their impulses)."""

    topic: str
    frame: str
    force: tuple
    torque: tuple


RELEASE = Command('release', 'world', (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
_REMEDIES = {
    'malformed': 'a geometry_msgs/msg/WrenchStamped',
    'the scene refuses commands': 'in the scene file: commands: accept',
    'too many wait for the next tick': 'resume the node, or send fewer',
}


class TakenElsewhere(CallbackGroup):
    """A group whose messages the executor leaves alone, for the tick thread takes them."""

    def can_execute(self, entity):
        """Return that the executor does not serve an entity."""
        return False

    beginning_execution = can_execute

    def ending_execution(self, entity):
        """Do nothing."""


def decode(data):
    """Return frame_id (bytes) and the six numbers of a serialised WrenchStamped.

    Raises
    ------
    ValueError
        If these bytes are no such message.
    """
    if data[:2] != ENCAPSULATION[:2]:
        raise ValueError('not little-endian CDR')
    try:
        length, = _LENGTH(data, _FRAME_AT - 4)
        end = _FRAME_AT + length
        # numbers of eight bytes are aligned, counted after the encapsulation
        numbers = _NUMBERS(data, end + (4 - end) % 8)
    except struct.error:
        raise ValueError('cut short') from None
    return data[_FRAME_AT:max(end - 1, _FRAME_AT)], numbers


class Commands:
    """The two subscriptions and the queue between them and the next tick.

    Parameters
    ----------
    node : rclpy.node.Node
    frames : topics.Frames

    Attributes
    ----------
    report : callable
        To be set: called by :meth:`look` with (topic, reason, what was got, the line that would be right) for each refused message.
    received, accepted, applied : int
    refusals : collections.Counter
        Refused messages by reason.
    """

    def __init__(self, node, frames):
        self.report = None
        self._axes = {b'': 'world', frames.world.encode(): 'world', frames.body.encode(): 'body'}
        self._frames = frames
        self.received = self.accepted = self.applied = 0
        self.refusals = collections.Counter()
        self.queue = collections.deque()
        group = TakenElsewhere()
        self._subscriptions = [(topic, self._subscribe(node, topic, group)) for topic in (WRENCH, IMPULSE)]
        self._mismatches = [qos.SubscriptionMismatch(node, topic, subscription.qos_profile) for topic, subscription in self._subscriptions]
        self._bell = Doorbell(node, [subscription for _, subscription in self._subscriptions])
        self._takers = [(topic, subscription.handle.take_message) for topic, subscription in self._subscriptions]

    @staticmethod
    def _subscribe(node, topic, group):
        return node.create_subscription(
            WrenchStamped, topic, lambda _: None, QoSProfile(depth=DEPTH), callback_group=group, raw=True,
            event_callbacks=SubscriptionEventCallbacks(use_default_callbacks=False), qos_overriding_options=QoSOverridingOptions(qos.POLICIES))

    def take(self, scene_accepts):
        """Take what has come, at a tick: the tick thread calls this and :meth:`look`, nobody else."""
        if not self._bell.silent():
            self.look(scene_accepts)

    def look(self, scene_accepts):
        """Take all that has come."""
        before = self.received
        for topic, take in self._takers:
            while (message := take(WrenchStamped, True)) is not None:
                self._receive(topic, message[0], scene_accepts)
        self._bell.answer(self.received - before)

    def look_for_mismatches(self):
        """Warn of publishers whose commands do not arrive; from another thread, now and then."""
        for mismatch in self._mismatches:
            mismatch.look()

    def remove(self):
        """Take away what the node would not find by itself."""
        self._bell.remove()

    def _receive(self, topic, data, scene_accepts):
        self.received += 1
        try:
            frame, numbers = decode(data)
        except ValueError as error:
            self.refuse(topic, 'malformed', f'{len(data)} bytes, {error}')
            return
        axes = self._axes.get(frame)
        if axes is None:
            self.refuse(topic, 'frame_id', f'frame_id {frame.decode(errors="replace")!r}')
        elif not all(map(math.isfinite, numbers)):
            self.refuse(topic, 'not finite', f'force {numbers[:3]}, torque {numbers[3:]}')
        elif max(map(abs, numbers)) > LARGEST:
            self.refuse(topic, 'too large', f'force {numbers[:3]}, torque {numbers[3:]}')
        elif not scene_accepts:
            self.refuse(topic, 'the scene refuses commands', 'a command')
        elif len(self.queue) >= MOST_QUEUED:
            self.refuse(topic, 'too many wait for the next tick', f'one more than {MOST_QUEUED}')
        else:
            self.accepted += 1
            self.queue.append(Command(topic, axes, numbers[:3], numbers[3:]))

    def refuse(self, topic, reason, got, remedy=None):
        """Count a command that is not applied, and report it with the line that would be right."""
        self.refusals[reason] += 1
        self.report(topic, reason, got, remedy or _REMEDIES.get(reason) or self._example(topic))

    def _example(self, topic):
        full_name = next(subscription.topic_name for name, subscription in self._subscriptions if name == topic)
        return (f'ros2 topic pub --once {full_name} geometry_msgs/msg/WrenchStamped '
                f'"{{header: {{frame_id: {self._frames.body}}}, wrench: {{torque: {{x: 0.1}}}}}}"')
