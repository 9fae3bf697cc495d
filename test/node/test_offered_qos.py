# SPDX-License-Identifier: Apache-2.0
"""The quality of service of a recorded topic, as recordings have it: durations and leases."""

import pytest
from rclpy.qos import LivelinessPolicy

from rigid_body_sim.node.offered_qos import offered_qos

OFFER = """- history: 1
  depth: {depth}
  reliability: 1
  durability: 2
  deadline: {{sec: {sec}, nsec: {nsec}}}
  lifespan: {{sec: 7, nsec: 0}}
  liveliness: {liveliness}
  liveliness_lease_duration: {{sec: 0, nsec: 250000000}}
  avoid_ros_namespace_conventions: {avoid}
"""


def offered(sec=0, nsec=0, depth=5, liveliness=1, avoid='false'):
    return offered_qos(OFFER.format(
        sec=sec, nsec=nsec, depth=depth, liveliness=liveliness, avoid=avoid))


@pytest.mark.parametrize(('sec', 'nsec', 'nanoseconds'), [
    (0, 5, 5), (2, 7, 2_000_000_007), (9223372035, 999999999, 9223372035999999999),
    # 2^63 ns are more than a duration holds, and rosbag2 writes about that for none; so do others
    (9223372036, 854775807, 0), (-1, 0, 0), (0, 0, 0)])
def test_a_duration_beyond_what_one_holds_is_none(sec, nsec, nanoseconds):
    found = offered(sec, nsec)
    assert found.deadline.nanoseconds == nanoseconds
    assert found.lifespan.nanoseconds == 7_000_000_000
    assert found.liveliness_lease_duration.nanoseconds == 250_000_000


@pytest.mark.parametrize(('depth', 'kept'), [(5, 5), (1, 1), (0, 10)])
def test_a_depth_of_none_is_ten(depth, kept):
    assert offered(depth=depth).depth == kept


@pytest.mark.parametrize(('value', 'policy'), [
    (1, LivelinessPolicy.AUTOMATIC), (3, LivelinessPolicy.MANUAL_BY_TOPIC),
    ('manual_by_topic', LivelinessPolicy.MANUAL_BY_TOPIC),
    (0, LivelinessPolicy.SYSTEM_DEFAULT), (99, LivelinessPolicy.SYSTEM_DEFAULT)])
def test_a_policy_is_a_word_or_a_number_and_an_unknown_one_is_left_to_the_system(value, policy):
    assert offered(liveliness=value).liveliness == policy


@pytest.mark.parametrize('avoid', ['true', 'false'])
def test_names_without_the_conventions_of_ros_stay(avoid):
    assert offered(avoid=avoid).avoid_ros_namespace_conventions == (avoid == 'true')
