"""Commands from topics: taken by the tick thread itself, checked, and applied at the next tick, each exactly once and in order.

``cmd_wrench`` is held until it is replaced or times out, ``cmd_impulse`` (N s and N m s) acts once. Both are geometry_msgs/WrenchStamped;
the frame_id is the body's or the world's name, empty means the world, and the stamp is ignored. What cannot be right is refused as a whole.
"""

import collections
import functools
import itertools
import math
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
from rigid_body_sim.simulation.command_rows import BODY, FORCE, HOLD, IMPULSE, TOPICS, WIDTH, WORLD

DEPTH = 10_000
"""Messages that may wait in a subscription: a second of 10,000 a second."""
MOST_QUEUED = 100_000
"""Commands that may wait for a tick, while paused or at a low rate."""
LARGEST = 1e100
"""A number beyond this would overflow in the energies."""
_LENGTH = struct.Struct('<I').unpack_from
# encapsulation and stamp (4 and 8 bytes), length and text of the frame_id, the numbers
_LITTLE_ENDIAN, _FRAME_FROM, _FRAME_AT, _NUMBERS_SIZE = ENCAPSULATION[:2], 12, 16, 48
MOST_HEADS = 64
"""Forms of messages that are known again: padding may hold anything."""
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
    """Return the frame_id (bytes) of a serialised WrenchStamped, and where its six numbers end.

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
    return data[_FRAME_AT:max(frame_end - 1, _FRAME_AT)], end


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
    received, accepted, applied, waiting : int
        Messages so far, and those that wait for the next tick.
    refusals : collections.Counter
        Refused messages by reason.
    """

    def __init__(self, node, frames):
        self.report = None
        self._axes = {b'': WORLD, frames.world.encode(): WORLD, frames.body.encode(): BODY}
        self._frames = frames
        self.received = self.accepted = self.applied = self.waiting = 0
        self.refusals = collections.Counter()
        self._rows = []
        group = TakenElsewhere()
        self._subscriptions = {kind: self._subscribe(node, TOPICS[kind], group) for kind in (HOLD, IMPULSE)}
        self._mismatches = [qos.SubscriptionMismatch(node, TOPICS[kind], subscription.qos_profile)
                            for kind, subscription in self._subscriptions.items()]
        self._bell = Doorbell(node, list(self._subscriptions.values()))
        self._takers = [(kind, functools.partial(subscription.handle.take_message, WrenchStamped, True))
                        for kind, subscription in self._subscriptions.items()]
        self._gaps = {kind: Gaps(functools.partial(qos.publishers_of, node, TOPICS[kind])) for kind in (HOLD, IMPULSE)}
        # what rows begin with, by what messages have between stamp and numbers: senders hardly ever change it
        self._heads = {HOLD: {}, IMPULSE: {}}

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
        found = 0
        for kind, take in self._takers:
            taken = list(itertools.islice(iter(take, None), DEPTH))
            if taken:
                found += len(taken)
                self._gaps[kind].look([about[NUMBER] for _, about in taken])
                self._receive(kind, [data for data, _ in taken], scene_accepts)
        self._bell.answer(found)

    @property
    def lost(self):
        """Messages that never came, since more than DEPTH waited or for another reason."""
        return sum(gaps.lost for gaps in self._gaps.values())

    def collect(self):
        """Return the commands that wait, in their order (command_rows.py); they wait no more."""
        rows = self._rows[0] if len(self._rows) == 1 else np.concatenate(self._rows)
        self._rows, self.waiting = [], 0
        return rows

    def look_for_mismatches(self):
        """Warn of publishers whose commands do not arrive; from another thread, now and then."""
        for mismatch in self._mismatches:
            mismatch.look()

    def remove(self):
        """Take away what the node would not find by itself."""
        self._bell.remove()

    def _receive(self, kind, messages, scene_accepts):
        """Put into the queue what may be right among some messages of a topic, refuse the rest."""
        self.received += len(messages)
        heads, pieces, topic = self._heads[kind], [], TOPICS[kind]
        for data in messages:
            head = heads.get(data[_FRAME_FROM:-_NUMBERS_SIZE])
            if head is None or data[:2] != _LITTLE_ENDIAN:
                head, data = self._examine(kind, data)
            if head is not None:
                pieces += head, data[-_NUMBERS_SIZE:]
        if not pieces:
            return
        rows = np.frombuffer(bytearray().join(pieces)).reshape(-1, WIDTH)
        # so written, it is false for what is not a number too
        if not (scene_accepts and self.waiting + len(rows) <= MOST_QUEUED and rows.min() >= -LARGEST and rows.max() <= LARGEST):
            rows = self._sift(topic, rows, scene_accepts)
        self._rows.append(rows)
        self.waiting += len(rows)
        self.accepted += len(rows)

    def _examine(self, kind, data):
        """Return what the row of a message begins with, None if it is refused, and the message without what may follow its numbers."""
        topic = TOPICS[kind]
        try:
            frame, end = decode(data)
        except ValueError as error:
            self.refuse(topic, 'malformed', f'{len(data)} bytes, {error}')
            return None, data
        axes = self._axes.get(frame)
        if axes is None:
            self.refuse(topic, 'frame_id', f'frame_id {frame.decode(errors="replace")!r}')
            return None, data
        head = np.array([kind, axes], float).tobytes()
        if end == len(data) and len(self._heads[kind]) < MOST_HEADS:
            self._heads[kind][data[_FRAME_FROM:-_NUMBERS_SIZE]] = head
        return head, data[:end]

    def _sift(self, topic, rows, scene_accepts):
        """Refuse what cannot be right, and what is beyond what may wait; return the other rows."""
        kept = []
        for row in rows:
            numbers = row[FORCE.start:].tolist()
            got = f'force {tuple(numbers[:3])}, torque {tuple(numbers[3:])}'
            if not all(map(math.isfinite, numbers)):
                self.refuse(topic, 'not finite', got)
            elif max(map(abs, numbers)) > LARGEST:
                self.refuse(topic, 'too large', got)
            elif not scene_accepts:
                self.refuse(topic, 'the scene refuses commands', 'a command')
            elif self.waiting + len(kept) >= MOST_QUEUED:
                self.refuse(topic, 'too many wait for the next tick', f'one more than {MOST_QUEUED}')
            else:
                kept.append(row)
        return np.array(kept).reshape(-1, WIDTH)

    def refuse(self, topic, reason, got, remedy=None):
        """Count a command that is not applied, and report it with the line that would be right."""
        self.refusals[reason] += 1
        self.report(topic, reason, got, remedy or _REMEDIES.get(reason) or self._example(topic))

    def _example(self, topic):
        full_name = self._subscriptions[TOPICS.index(topic)].topic_name
        return (f'ros2 topic pub --once {full_name} geometry_msgs/msg/WrenchStamped '
                f'"{{header: {{frame_id: {self._frames.body}}}, wrench: {{torque: {{x: 0.1}}}}}}"')
