# SPDX-License-Identifier: Apache-2.0
"""Commands from topics: the tick thread takes them itself and applies them at the next tick.

``cmd_wrench`` is held until it is replaced or times out, ``cmd_impulse`` (N s and N m s) acts
once. Both are geometry_msgs/WrenchStamped. The frame_id is the name of the body's frame or of the
world's; an empty one means the world. The stamp is ignored. Messages become rows
(simulation/command_rows.py) as soon as they are taken; the simulation decides at the tick whether
the body can take the numbers.
"""

import collections
import functools
import itertools
import struct

import numpy as np
from geometry_msgs.msg import WrenchStamped
from rclpy.callback_groups import CallbackGroup
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.qos import QoSProfile
from rclpy.qos_overriding_options import QoSOverridingOptions

from rigid_body_sim.messages.cdr import ENCAPSULATION
from rigid_body_sim.node import qos
from rigid_body_sim.node.doorbell import Doorbell
from rigid_body_sim.node.gaps import NUMBER, Gaps
from rigid_body_sim.simulation.command_rows import BODY, HOLD, IMPULSE, TOPICS, WIDTH, WORLD

DEPTH = 10_000
"""Messages that may wait in a subscription: one second at 10,000 a second."""
MOST_QUEUED = 100_000
"""Commands that may wait for a tick, while paused or at a low rate."""
_LENGTH = struct.Struct('<I').unpack_from
# a message: encapsulation and stamp (4 and 8 bytes), length and text of the frame_id, the numbers
_LITTLE_ENDIAN, _FRAME_FROM, _FRAME_AT, _NUMBERS_SIZE = ENCAPSULATION[:2], 12, 16, 48
MOST_HEADS = 64
"""Number of message heads that are remembered; padding may hold anything."""


class TakenElsewhere(CallbackGroup):
    """A group of subscriptions whose messages the tick thread takes, not the executor."""

    def can_execute(self, entity):
        """Return False: the executor serves none of these entities."""
        return False

    beginning_execution = can_execute

    def ending_execution(self, entity):
        """Do nothing."""


def decode(data: bytes) -> tuple[bytes, int]:
    """Return the frame_id of a serialised WrenchStamped, and where its six numbers end.

    Raises
    ------
    ValueError
        If these bytes are no such message.
    """
    if data[:2] != _LITTLE_ENDIAN:
        raise ValueError('not little-endian CDR')
    if len(data) < _FRAME_AT:
        raise ValueError('cut short')
    frame_end = _FRAME_AT + _LENGTH(data, _FRAME_FROM)[0]
    # numbers of eight bytes are aligned, counted after the encapsulation
    end = frame_end + (4 - frame_end) % 8 + _NUMBERS_SIZE
    if len(data) < end:
        raise ValueError('cut short')
    return data[_FRAME_AT : max(frame_end - 1, _FRAME_AT)], end


class Commands:
    """The two subscriptions, and the queue between them and the next tick.

    Parameters
    ----------
    node : rclpy.node.Node
    frames : state_topics.Frames

    Attributes
    ----------
    report : callable
        To be set: called with (topic, reason, what was got, what would be right) for each refused
        command.
    received, accepted, applied, waiting : int
        Messages so far: all, those that became a row, those that the body took; rows that wait for
        the next tick.
    refusals : collections.Counter
        Refused commands by reason.
    """

    def __init__(self, node, frames):
        self.report = None
        self._axes = {b'': WORLD, frames.world.encode(): WORLD, frames.body.encode(): BODY}
        self._frames = frames
        self.received = self.accepted = self.applied = self.waiting = 0
        self.refusals = collections.Counter()
        self._rows = []
        group = TakenElsewhere()
        self._subscriptions = {
            kind: self._subscribe(node, TOPICS[kind], group) for kind in (HOLD, IMPULSE)
        }
        self._mismatches = [
            qos.SubscriptionMismatch(node, TOPICS[kind], subscription.qos_profile)
            for kind, subscription in self._subscriptions.items()
        ]
        self._bell = Doorbell(node, list(self._subscriptions.values()))
        self._takers = [
            (kind, functools.partial(subscription.handle.take_message, WrenchStamped, True))
            for kind, subscription in self._subscriptions.items()
        ]
        self._gaps = {
            kind: Gaps(functools.partial(qos.publishers_of, node, TOPICS[kind]))
            for kind in (HOLD, IMPULSE)
        }
        # the beginning of a row, by the bytes that a message has between its stamp and its
        # numbers: senders hardly ever change them
        self._heads = {HOLD: {}, IMPULSE: {}}

    @staticmethod
    def _subscribe(node, topic, group):
        return node.create_subscription(
            WrenchStamped,
            topic,
            lambda _: None,
            QoSProfile(depth=DEPTH),
            callback_group=group,
            raw=True,
            event_callbacks=SubscriptionEventCallbacks(use_default_callbacks=False),
            qos_overriding_options=QoSOverridingOptions(qos.POLICIES),
        )

    def take(self):
        """Take new messages if the bell rang; only the tick thread calls this and `look`."""
        if not self._bell.silent():
            self.look()

    def look(self):
        """Take all new messages."""
        found = 0
        for kind, take in self._takers:
            taken = list(itertools.islice(iter(take, None), DEPTH))
            if taken:
                found += len(taken)
                self._gaps[kind].look([about[NUMBER] for _, about in taken])
                self._receive(kind, [data for data, _ in taken])
        self._bell.answer(found)

    @property
    def lost(self) -> int:
        """Number of messages that never arrived, because more than DEPTH waited or otherwise."""
        return sum(gaps.lost for gaps in self._gaps.values())

    def collect(self) -> np.ndarray:
        """Return the waiting rows in order, and empty the queue."""
        rows = self._rows[0] if len(self._rows) == 1 else np.concatenate(self._rows)
        self._rows, self.waiting = [], 0
        return rows

    def look_for_mismatches(self):
        """Warn of publishers whose commands do not arrive; called in another thread."""
        for mismatch in self._mismatches:
            mismatch.look()

    def remove(self):
        """Remove from the node what rclpy does not remove itself."""
        self._bell.remove()

    def _receive(self, kind, messages):
        """Queue the rows of some messages of a topic; refuse messages that are no command."""
        self.received += len(messages)
        heads, pieces = self._heads[kind], []
        for data in messages:
            head = heads.get(data[_FRAME_FROM:-_NUMBERS_SIZE])
            if head is None or data[:2] != _LITTLE_ENDIAN:
                head, data = self._examine(kind, data)
            if head is not None:
                pieces += head, data[-_NUMBERS_SIZE:]
        rows = np.frombuffer(bytearray().join(pieces)).reshape(-1, WIDTH)
        room = MOST_QUEUED - self.waiting
        for _ in range(room, len(rows)):
            self.refuse(
                TOPICS[kind],
                'too many wait for the next tick',
                f'one more than {MOST_QUEUED}',
                'resume the node, or send fewer',
            )
        rows = rows[:room]
        if len(rows):
            self._rows.append(rows)
            self.waiting += len(rows)
            self.accepted += len(rows)

    def _examine(self, kind, data):
        """Return the beginning of a message's row, and the message up to the end of its numbers.

        The beginning is None if the message is refused.
        """
        topic = TOPICS[kind]
        try:
            frame, end = decode(data)
        except ValueError as error:
            self.refuse(
                topic,
                'malformed',
                f'{len(data)} bytes, {error}',
                'a geometry_msgs/msg/WrenchStamped',
            )
            return None, data
        axes = self._axes.get(frame)
        if axes is None:
            self.refuse(topic, 'frame_id', f'frame_id {frame.decode(errors="replace")!r}')
            return None, data
        head = np.array([kind, axes], float).tobytes()
        if end == len(data) and len(self._heads[kind]) < MOST_HEADS:
            self._heads[kind][data[_FRAME_FROM:-_NUMBERS_SIZE]] = head
        return head, data[:end]

    def refuse(self, topic: str, reason: str, got: str, remedy: str = ''):
        """Count a command that is not applied, and report it with what would be right.

        Without a remedy the report shows a shell command that sends a valid one.
        """
        self.refusals[reason] += 1
        self.report(topic, reason, got, remedy or self._example(topic))

    def _example(self, topic):
        full_name = self._subscriptions[TOPICS.index(topic)].topic_name
        return (
            f'ros2 topic pub --once {full_name} geometry_msgs/msg/WrenchStamped "{{header: '
            f'{{frame_id: {self._frames.body}}}, wrench: {{torque: {{x: 0.1}}}}}}"'
        )
