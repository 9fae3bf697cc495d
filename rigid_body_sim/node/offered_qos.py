# SPDX-License-Identifier: Apache-2.0
"""The recorded quality of service of a topic, as an rclpy profile."""

import yaml
from rclpy.duration import Duration
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
)

DEPTH = 10
NANOSECONDS = 10**9
_FOREVER = 2**63 // NANOSECONDS  # s, from here on a duration is none
_POLICIES = {
    'history': HistoryPolicy,
    'reliability': ReliabilityPolicy,
    'durability': DurabilityPolicy,
    'liveliness': LivelinessPolicy,
}
_STRONGEST = {
    'reliability': ReliabilityPolicy.RELIABLE,
    'durability': DurabilityPolicy.TRANSIENT_LOCAL,
}


def offered_qos(text):
    """Return the QoSProfile that serves every subscriber that a recorded publisher served.

    Parameters
    ----------
    text : str
        The channel's ``offered_qos_profiles``, as any rosbag2 wrote it: a YAML list, policies as
        words or as numbers; '' or what cannot be understood: reliable, volatile, the last 10
        messages.
    """
    try:
        offers = [_profile(offer) for offer in yaml.safe_load(text) or ()]
    except (yaml.YAMLError, TypeError, ValueError, KeyError, AttributeError, RecursionError):
        offers = []
    chosen = {'depth': DEPTH, 'reliability': ReliabilityPolicy.RELIABLE}
    if offers:
        chosen = offers[0]
        chosen['depth'] = max(offer['depth'] for offer in offers)
        for policy, strongest in _STRONGEST.items():
            if any(offer[policy] == strongest for offer in offers):
                chosen[policy] = strongest
    return QoSProfile(**chosen)


def _profile(offer):
    """Return the arguments of a QoSProfile for one offer."""
    profile = {name: _policy(enumeration, offer[name]) for name, enumeration in _POLICIES.items()}
    profile['depth'] = int(offer['depth']) or DEPTH
    profile |= {
        name: _duration(offer[name])
        for name in ('deadline', 'lifespan', 'liveliness_lease_duration')
    }
    profile['avoid_ros_namespace_conventions'] = bool(offer['avoid_ros_namespace_conventions'])
    return profile


def _policy(enumeration, value):
    """Return a policy from its word or number.

    A policy that the publisher left to the system, or that is unknown, is left to the system.
    """
    known = [
        policy
        for policy in enumeration
        if policy.name.lower() == str(value).lower() or policy.value == value
    ]
    return known[0] if known else enumeration.SYSTEM_DEFAULT


def _duration(value):
    seconds, nanoseconds = int(value['sec']), int(value['nsec'])
    return (
        Duration(seconds=seconds, nanoseconds=nanoseconds)
        if 0 <= seconds < _FOREVER
        else Duration()
    )
