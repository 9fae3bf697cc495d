# SPDX-License-Identifier: Apache-2.0
"""The hidden topics of browser pages: which states they have, how often, and for whom."""

import types

import pytest
from rclpy.qos import ReliabilityPolicy

from rigid_body_sim.node import display
from rigid_body_sim.node.display import Display


@pytest.fixture
def shown(monkeypatch):
    """Return (Display of four outputs, clock, subscriptions by topic, what was sent)."""
    clock, listening, sent, profiles = [0.0], {}, [], []    # the machine has just started
    monkeypatch.setattr(display, 'import_type', lambda output: None)
    monkeypatch.setattr(display, 'time', types.SimpleNamespace(monotonic=lambda: clock[0]))

    def create_publisher(_, topic, profile):
        listening[topic] = 1
        profiles.append((profile.depth, profile.reliability))
        return types.SimpleNamespace(
            get_subscription_count=lambda: listening[topic],
            handle=types.SimpleNamespace(publish_raw=lambda data: sent.append((topic, data))))
    outputs = [types.SimpleNamespace(name=name)
               for name in ('twist', 'pose', 'odom', 'angular_velocity')]
    one = Display(types.SimpleNamespace(create_publisher=create_publisher), outputs)
    assert set(profiles) == {(1, ReliabilityPolicy.BEST_EFFORT)}
    return one, clock, listening, sent


def test_what_a_page_draws_is_sent_to_those_who_listen(shown):
    one, clock, listening, sent = shown
    assert set(listening) == {'~/_display/pose', '~/_display/angular_velocity'}
    one.tick([b'0', b'1', b'2', b'3'])
    assert sent == [('~/_display/pose', b'1'), ('~/_display/angular_velocity', b'3')]
    listening['~/_display/pose'] = 0
    clock[0] += 1.0
    one.tick([b'4', b'5', b'6', b'7'])
    assert sent[2:] == [('~/_display/angular_velocity', b'7')]


def test_of_a_thousand_ticks_a_second_at_most_120_are_sent(shown):
    """Each is sent that comes 1/120 s after the one before, or later: every ninth tick of 1 ms."""
    one, clock, _, sent = shown
    for tick in range(100):
        clock[0] = 1e-3 * tick
        one.tick([str(tick)] * 4)
    assert [int(data) for topic, data in sent if topic.endswith('pose')] == list(range(0, 100, 9))
