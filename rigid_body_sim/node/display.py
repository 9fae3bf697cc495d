# SPDX-License-Identifier: Apache-2.0
"""The latest state for browser pages, at the rate of a display.

A page that subscribed to the topics of every tick would receive a thousand messages a second and
draw sixty. So the bytes of the latest tick are published again on hidden topics,
``~/_display/pose`` and so on, while somebody subscribes to them: best effort, depth 1, never
recorded.
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
