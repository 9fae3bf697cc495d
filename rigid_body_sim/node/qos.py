# SPDX-License-Identifier: Apache-2.0
"""Quality of service: which policies parameters may change, and mismatches told in plain words."""

import functools

from rclpy.event_handler import PublisherEventCallbacks
from rclpy.qos import DurabilityPolicy, QoSPolicyKind, ReliabilityPolicy

POLICIES = (
    QoSPolicyKind.HISTORY,
    QoSPolicyKind.DEPTH,
    QoSPolicyKind.RELIABILITY,
    QoSPolicyKind.DURABILITY,
)
WEAKEST = {'RELIABILITY': 'best_effort', 'DURABILITY': 'volatile'}
STRONGEST = {'RELIABILITY': 'reliable', 'DURABILITY': 'transient_local'}


def publishers_of(node, topic):
    """Return the identities of a topic's present publishers, a set."""
    return {
        bytes(publisher.endpoint_gid)
        for publisher in node.get_publishers_info_by_topic(node.resolve_topic_name(topic))
    }


def publisher_mismatch(node, topic):
    """Return event callbacks that report, once for each policy, subscribers that ask for more."""
    return PublisherEventCallbacks(
        incompatible_qos=_Mismatch(
            node,
            topic,
            'publisher',
            'a subscriber asks for more {policy} than this node offers and gets no messages',
            STRONGEST,
            'ask for {weakest} there',
        )
    )


class SubscriptionMismatch:
    """Warns, once for each policy, of a publisher that offers less than this node asks for.

    It inspects the present publishers: an event of the subscription would wake the executor for
    every message.

    Parameters
    ----------
    node : rclpy.node.Node
    topic : str
    profile : rclpy.qos.QoSProfile
        The profile of the subscription.
    """

    def __init__(self, node, topic, profile):
        self._publishers = functools.partial(
            node.get_publishers_info_by_topic, node.resolve_topic_name(topic)
        )
        self._profile = profile
        self._mismatch = _Mismatch(
            node,
            topic,
            'subscription',
            'a publisher offers less {policy} than this node asks for '
            'and its messages do not arrive',
            WEAKEST,
            'offer {strongest} there',
        )

    def look(self):
        """Inspect the present publishers."""
        for offered in (publisher.qos_profile for publisher in self._publishers()):
            for policy, weak, strong in (
                (
                    'RELIABILITY',
                    offered.reliability == ReliabilityPolicy.BEST_EFFORT,
                    ReliabilityPolicy.RELIABLE,
                ),
                (
                    'DURABILITY',
                    offered.durability == DurabilityPolicy.VOLATILE,
                    DurabilityPolicy.TRANSIENT_LOCAL,
                ),
            ):
                if weak and getattr(self._profile, policy.lower()) == strong:
                    self._mismatch.say(policy)


class _Mismatch:
    def __init__(self, node, topic, side, problem, wanted_here, remedy):
        self._node, self._topic, self._side = node, topic, side
        self._problem, self._wanted_here, self._remedy = problem, wanted_here, remedy
        self._said = set()

    def __call__(self, event):
        self.say(QoSPolicyKind(event.last_policy_kind).name)

    def say(self, policy):
        """Warn of a mismatch in a policy (name), the first time."""
        if policy in self._said:
            return
        self._said.add(policy)
        name, topic = policy.lower(), self._node.resolve_topic_name(self._topic)
        line = f'{topic}: {self._problem.format(policy=name)}'
        if policy in WEAKEST:
            remedy = self._remedy.format(weakest=WEAKEST[policy], strongest=STRONGEST[policy])
            override = f'qos_overrides.{topic}.{self._side}.{name}:={self._wanted_here[policy]}'
            line += f'; {remedy}, or start this node with -p {override}'
        self._node.get_logger().warning(line)
