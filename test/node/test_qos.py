# SPDX-License-Identifier: Apache-2.0
"""Mismatches of quality of service are told in plain words, each once."""

import types

import pytest
from rclpy.qos import DurabilityPolicy, QoSPolicyKind, QoSProfile, ReliabilityPolicy

from rigid_body_sim.node import qos

RELIABLE, BEST = ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT
LATCHED, VOLATILE = DurabilityPolicy.TRANSIENT_LOCAL, DurabilityPolicy.VOLATILE


@pytest.fixture
def node():
    """Return what a mismatch needs of a node: the offers of publishers, and what it warns of."""
    node = types.SimpleNamespace(warned=[], offers=[], resolve_topic_name=lambda name: f'/{name}')
    node.get_logger = lambda: types.SimpleNamespace(warning=node.warned.append)
    node.get_publishers_info_by_topic = lambda topic: [
        types.SimpleNamespace(qos_profile=offer, endpoint_gid=[len(topic), place])
        for place, offer in enumerate(node.offers)]
    return node


def profile(reliability, durability):
    return QoSProfile(depth=1, reliability=reliability, durability=durability)


@pytest.mark.parametrize(('wanted', 'offers', 'told'), [
    ((RELIABLE, VOLATILE), [(RELIABLE, VOLATILE), (RELIABLE, LATCHED)], []),
    ((BEST, VOLATILE), [(BEST, VOLATILE)], []),
    ((RELIABLE, VOLATILE), [(RELIABLE, VOLATILE), (BEST, VOLATILE), (BEST, VOLATILE)],
     ['reliability']),
    ((BEST, LATCHED), [(BEST, VOLATILE)], ['durability']),
    ((RELIABLE, LATCHED), [(BEST, VOLATILE)], ['reliability', 'durability'])])
def test_a_publisher_that_offers_less_than_is_asked_for_is_told_once(node, wanted, offers, told):
    mismatch = qos.SubscriptionMismatch(node, 'cmd', profile(*wanted))
    node.offers = [profile(*offer) for offer in offers]
    for _ in range(2):
        mismatch.look()
    assert [line.split(' than')[0] for line in node.warned] == [
        f'/cmd: a publisher offers less {policy}' for policy in told]


def test_the_remedies_are_to_offer_more_there_or_to_ask_for_less_here(node):
    mismatch = qos.SubscriptionMismatch(node, 'cmd', profile(RELIABLE, VOLATILE))
    node.offers = [profile(BEST, VOLATILE)]
    mismatch.look()
    assert node.warned == [
        '/cmd: a publisher offers less reliability than this node asks for and its messages do '
        'not arrive; offer reliable there, or start this node with -p '
        'qos_overrides./cmd.subscription.reliability:=best_effort']


def test_a_subscriber_that_asks_for_more_is_told_once_for_each_policy(node):
    said = qos.publisher_mismatch(node, 'pose').incompatible_qos
    for policy in (QoSPolicyKind.DURABILITY, QoSPolicyKind.DEADLINE, QoSPolicyKind.DURABILITY):
        said(types.SimpleNamespace(last_policy_kind=int(policy)))
    assert node.warned == [
        '/pose: a subscriber asks for more durability than this node offers and gets no messages; '
        'ask for volatile there, or start this node with -p '
        'qos_overrides./pose.publisher.durability:=transient_local',
        '/pose: a subscriber asks for more deadline than this node offers and gets no messages']


def test_publishers_are_told_apart(node):
    node.offers = [None, None]
    assert qos.publishers_of(node, 'cmd') == {b'\4\0', b'\4\1'}
