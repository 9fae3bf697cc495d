# SPDX-License-Identifier: Apache-2.0
"""The state for pages that show it: the latest tick's messages at the pace of a picture.

A page that subscribed to the topics of every tick would have each of a thousand messages a second
sent once more, of which it draws sixty. So the bytes of the last tick are sent again on hidden
topics, ``~/_display/pose`` and so on, while somebody listens there: best effort, the last message
only, never recorded.
"""

import time

from rclpy.qos import QoSProfile, ReliabilityPolicy

from rigid_body_sim.node.message_types import import_type

NAMES = ('pose', 'angular_velocity', 'energy')
PERIOD = 1.0 / 120.0
"""Shortest time between two messages of a topic, s of the clock: twice the pace of a page."""
PROFILE = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)


def topic_of(name):
    """Return the topic of one of NAMES, relative to the node's name."""
    return f'~/_display/{name}'


class Display:
    """The publishers of the hidden topics; only the tick thread publishes.

    Parameters
    ----------
    node : rclpy.node.Node
    outputs : sequence of state_topics.Output
        The outputs of every tick, in the order of their messages.
    """

    def __init__(self, node, outputs):
        self._due = 0.0
        self._publishers = [
            (place, node.create_publisher(import_type(output), topic_of(output.name), PROFILE))
            for place, output in enumerate(outputs)
            if output.name in NAMES
        ]

    def tick(self, messages):
        """Send the messages of a tick if it is time and somebody listens."""
        now = time.monotonic()
        if now < self._due:
            return
        self._due = now + PERIOD
        for place, publisher in self._publishers:
            if publisher.get_subscription_count():
                publisher.handle.publish_raw(messages[place])
