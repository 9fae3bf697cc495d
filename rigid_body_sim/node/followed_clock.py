# SPDX-License-Identifier: Apache-2.0
"""The time of /clock, for the tick thread."""

import threading

from rclpy.clock import JumpThreshold
from rclpy.duration import Duration

from rigid_body_sim.realtime.ticking import LONGEST_SLEEP


class Followed:
    """The node's clock while it follows /clock: it moves when a message says so."""

    follows_clock_topic = True

    def __init__(self, clock):
        self._clock = clock
        self._moved = threading.Event()
        forward, backward = Duration(nanoseconds=1), Duration(nanoseconds=-1)
        threshold = JumpThreshold(min_forward=forward, min_backward=backward, on_clock_change=True)
        self._handle = clock.create_jump_callback(
            threshold, post_callback=lambda _: self._moved.set()
        )

    def now(self):
        """Return the latest time on /clock, ns; 0 before its first message."""
        return self._clock.now().nanoseconds

    def close(self):
        """Stop following the clock."""
        self._handle.unregister()

    def wait(self, _):
        """Wait until /clock moves, at most LONGEST_SLEEP."""
        self._moved.wait(LONGEST_SLEEP)
        self._moved.clear()
