# SPDX-License-Identifier: Apache-2.0
"""The doorbell: no message waits long, no look is wasted, no busy executor is in the way."""

import time
import types

import pytest
import rclpy
from rclpy.executors import SingleThreadedExecutor
from std_msgs.msg import Float64

from rigid_body_sim.node.commands import TakenElsewhere
from rigid_body_sim.node.doorbell import GLANCE, LOOKS, Doorbell


class House:
    """A node with two subscriptions behind a doorbell, a publisher and an executor."""

    def __init__(self, context):
        self.node = rclpy.create_node('house', context=context)
        group = TakenElsewhere()
        self.subscriptions = [self.node.create_subscription(Float64, name, lambda _: None, 10,
                                                            callback_group=group, raw=True)
                              for name in ('nobody', 'knocks')]
        self.publisher = self.node.create_publisher(Float64, 'knocks', 10)
        self.bell = Doorbell(self.node, self.subscriptions)
        self.executor = SingleThreadedExecutor(context=context)
        self.executor.add_node(self.node)

    def look(self):
        """Take all that waits, as a tick does when the bell rings; return the number taken."""
        found = 0
        for subscription in self.subscriptions:
            while subscription.handle.take_message(Float64, True) is not None:
                found += 1
        self.bell.answer(found)
        return found

    def rings(self):
        """Serve the executor for a while; return whether the bell has rung."""
        self.executor.spin_once(timeout_sec=0.05)
        return not self.bell.silent()

    def spin_until(self, condition):
        deadline = time.monotonic() + 10.0
        while not condition():
            assert time.monotonic() < deadline
            self.executor.spin_once(timeout_sec=0.05)


@pytest.fixture
def house(ros_domain):
    context = rclpy.Context()
    rclpy.init(args=[], context=context, domain_id=ros_domain.id)
    house = House(context)
    yield house
    house.bell.remove()
    house.node.destroy_node()
    rclpy.shutdown(context=context)


def fall_silent(house):
    house.executor.spin_once(timeout_sec=0.0)
    for _ in range(LOOKS + 1):
        assert not house.bell.silent()
        house.look()
    assert house.bell.silent()


@pytest.mark.timeout(60.0)
def test_bell_rings_for_a_message_and_leaves_it_to_the_tick_thread(house):
    house.spin_until(lambda: house.publisher.get_subscription_count() == 1)
    for _ in range(2):
        fall_silent(house)
        house.publisher.publish(Float64(data=1.0))
        house.publisher.publish(Float64(data=2.0))
        # sooner than the tick thread would look by itself
        assert any(house.rings() for _ in range(GLANCE - 2))
        # the executor has taken nothing
        assert house.look() == 2


@pytest.mark.timeout(60.0)
def test_messages_are_found_while_the_executor_is_busy(house):
    house.spin_until(lambda: house.publisher.get_subscription_count() == 1)
    fall_silent(house)
    house.publisher.publish(Float64(data=1.0))
    time.sleep(0.2)
    found = [house.look() for _ in range(2 * GLANCE) if not house.bell.silent()]
    assert found == [1, 0]


def test_the_tick_thread_glances_now_and_then_though_the_bell_is_silent():
    """After a hundred looks in vain, and one, it looks every 32 ticks until something comes."""
    woken, handles = [], ['one', 'two']
    bell = Doorbell(types.SimpleNamespace(
        add_waitable=lambda bell: None,
        executor=types.SimpleNamespace(wake=lambda: woken.append(1))),
        [types.SimpleNamespace(handle=handle) for handle in handles])

    def listens():
        """Return how many subscriptions the executor waits for, and which."""
        count, added = bell.get_num_entities().num_subscriptions, []
        bell.add_to_wait_set(types.SimpleNamespace(
            add_subscription=lambda handle: added.append(handle) or len(added) - 1))
        return count, added

    def quiet(looks):
        for _ in range(looks):
            assert not bell.silent()
            bell.answer(0)
    assert listens() == (0, [])
    quiet(LOOKS)
    assert not bell.silent() and woken == []
    bell.answer(1)    # it begins anew
    quiet(LOOKS)
    assert not bell.silent() and woken == []
    bell.answer(0)
    assert woken == [1] and listens() == (2, handles)
    for _ in range(3):
        assert [bell.silent() for _ in range(GLANCE)] == [True] * (GLANCE - 1) + [False]
        bell.answer(0)    # it was not the bell
    assert bell.silent() and woken == [1]
    assert not bell.is_ready(types.SimpleNamespace(is_ready=lambda kind, place: False))
    assert bell.silent()
    # one of them has a message; there is nothing for the executor to do
    assert not bell.is_ready(types.SimpleNamespace(is_ready=lambda kind, place: place == 1))
    assert listens() == (0, [])
    quiet(LOOKS + 1)
    assert bell.silent()
    new = Doorbell(bell._node, [])
    for _ in range(LOOKS + 1):
        new.answer(0)
    assert new.silent()
