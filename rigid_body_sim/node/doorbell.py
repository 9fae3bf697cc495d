# SPDX-License-Identifier: Apache-2.0
"""A doorbell: it tells the tick thread that messages wait in its subscriptions.

Checking the subscriptions costs the tick thread as much as publishing a message, so it does not
check them at every tick. While nothing arrives, the executor, which sleeps anyhow, waits for the
first message and rings; the messages stay in the subscriptions. From then on the tick thread
checks at every tick, until nothing has arrived for a while.
"""

import contextlib

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.waitable import NumberOfEntities, Waitable

LOOKS = 100
"""Number of empty checks after which the tick thread relies on the bell again."""
GLANCE = 32
"""Ticks after which the tick thread checks anyway: a service may keep the executor busy."""


class Doorbell(Waitable):
    """Waits, in the node's executor, for a message in any of some subscriptions.

    Parameters
    ----------
    node : rclpy.node.Node
    subscriptions : list of rclpy.subscription.Subscription
        The executor must not serve them itself.
    """

    def __init__(self, node, subscriptions):
        super().__init__(ReentrantCallbackGroup())
        self._node, self._handles = node, [subscription.handle for subscription in subscriptions]
        self._rung, self._in_vain, self._unheard = True, 0, 0
        self._listening, self._places = False, []
        node.add_waitable(self)

    # -- the tick thread

    def silent(self):
        """Return whether the subscriptions need not be checked at this tick."""
        if self._rung:
            return False
        self._unheard += 1
        return self._unheard % GLANCE != 0

    def answer(self, found):
        """Note how many messages a check has found."""
        if found:
            self._in_vain = 0
        elif self._rung:
            self._in_vain += 1
            if self._in_vain > LOOKS:
                self._rung, self._in_vain, self._unheard = False, 0, 0
                executor = self._node.executor
                if executor is not None:
                    executor.wake()

    def remove(self):
        """Remove the doorbell from the node."""
        self._node.remove_waitable(self)

    # -- the executor: see rclpy.waitable.Waitable

    def __enter__(self):
        """Keep the subscriptions while they are waited for."""
        with contextlib.ExitStack() as stack:
            for handle in self._handles:
                stack.enter_context(handle)
            self._kept = stack.pop_all()

    def __exit__(self, *error):
        """Let go of them."""
        self._kept.close()

    def get_num_entities(self):
        """Return the number of entities to wait for: none once it has rung."""
        self._listening = not self._rung
        return NumberOfEntities(num_subs=len(self._handles) if self._listening else 0)

    def add_to_wait_set(self, wait_set):
        """Add the subscriptions."""
        self._places = (
            [wait_set.add_subscription(handle) for handle in self._handles]
            if self._listening
            else []
        )

    def is_ready(self, wait_set):
        """Ring if there is a message; there is nothing for the executor to do."""
        if any(wait_set.is_ready('subscription', place) for place in self._places):
            self._rung = True
        return False
