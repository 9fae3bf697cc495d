"""Quality of service: which policies parameters may change, and mismatches told in plain words."""

from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.qos import QoSPolicyKind

POLICIES = (QoSPolicyKind.HISTORY, QoSPolicyKind.DEPTH, QoSPolicyKind.RELIABILITY, QoSPolicyKind.DURABILITY)
WEAKEST = {'RELIABILITY': 'best_effort', 'DURABILITY': 'volatile'}
STRONGEST = {'RELIABILITY': 'reliable', 'DURABILITY': 'transient_local'}


def publisher_mismatch(node, topic):
    """Return event callbacks that say once a policy that a subscriber of the topic asks for more than this node offers."""
    return PublisherEventCallbacks(incompatible_qos=_Mismatch(
        node, topic, 'publisher', 'a subscriber asks for more {policy} than this node offers and gets no messages', STRONGEST,
        'ask for {weakest} there'))


def subscription_mismatch(node, topic):
    """Return event callbacks that say once a policy of which a publisher to the topic offers less than this node asks for."""
    return SubscriptionEventCallbacks(incompatible_qos=_Mismatch(
        node, topic, 'subscription', 'a publisher offers less {policy} than this node asks for and its messages do not arrive', WEAKEST,
        'offer {strongest} there'))


class _Mismatch:
    def __init__(self, node, topic, side, problem, wanted_here, remedy):
        self._node, self._topic, self._side = node, topic, side
        self._problem, self._wanted_here, self._remedy = problem, wanted_here, remedy
        self._said = set()

    def __call__(self, event):
        policy = QoSPolicyKind(event.last_policy_kind).name
        if policy in self._said:
            return
        self._said.add(policy)
        name, topic = policy.lower(), self._node.resolve_topic_name(self._topic)
        line = f'{topic}: {self._problem.format(policy=name)}'
        if policy in WEAKEST:
            remedy = self._remedy.format(weakest=WEAKEST[policy], strongest=STRONGEST[policy])
            line += f'; {remedy}, or start this node with -p qos_overrides.{topic}.{self._side}.{name}:={self._wanted_here[policy]}'
        self._node.get_logger().warning(line)
