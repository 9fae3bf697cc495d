# SPDX-License-Identifier: Apache-2.0
"""Topics of a recording: name, type, offered quality of service, as rosbag2 describes them."""

import dataclasses
import json

import yaml

from rigid_body_sim.messages import cdr

_FOREVER = {'sec': 9223372036, 'nsec': 854775807}
JOURNAL_TYPE = 'std_msgs/msg/String'
# entries are made of plain values; looking for circular references would take twice as long
_to_json = json.JSONEncoder(allow_nan=False, check_circular=False).encode


@dataclasses.dataclass(frozen=True)
class Topic:
    """A topic to be recorded.

    `name` is complete (``/racket/pose``), `type` a known message type; `depth`, `reliability`
    (``reliable``, ``best_effort``) and `durability` (``volatile``, ``transient_local``) are those
    that its publisher offers.
    """

    name: str
    type: str
    depth: int = 10
    reliability: str = 'reliable'
    durability: str = 'volatile'

    def qos(self):
        """Return the offered profile with the nine keys and words of rosbag2."""
        return {'history': 'keep_last', 'depth': self.depth, 'reliability': self.reliability,
                'durability': self.durability, 'deadline': dict(_FOREVER),
                'lifespan': dict(_FOREVER), 'liveliness': 'automatic',
                'liveliness_lease_duration': dict(_FOREVER),
                'avoid_ros_namespace_conventions': False}

    def qos_text(self):
        """Return the offered profiles as rosbag2 writes them into channel metadata."""
        return yaml.safe_dump([self.qos()], sort_keys=False)


def journal_topic(namespace=''):
    """Return the topic of the journal: what happened to the recording and to the simulation.

    It is recorded only, never published; each message is one JSON object. Each object has a
    ``kind``: ``begin`` (first of each file: all about the run), ``state`` (a full state), ``gap``
    (ticks that were not recorded: ``ticks``, and the stamps ``after`` and ``until`` in ns), and
    whatever the simulation adds (commands, resets, parameter changes, with the ``tick`` at which
    they took effect). Floats keep every bit.
    """
    name = f'{namespace.rstrip("/")}/journal'
    return Topic(name, JOURNAL_TYPE, depth=1000, durability='transient_local')


def journal_message(kind, **values):
    """Return the bytes of one entry; ValueError for numbers that are not finite."""
    return cdr.encode(JOURNAL_TYPE, {'data': _to_json({'kind': kind, **values})})
