# SPDX-License-Identifier: Apache-2.0
"""A small recording that every test knows to the bit: 4 topics at 1 kHz, varying numbers."""

import dataclasses

import numpy as np
import pytest
from packing import Packed

from rigid_body_sim.messages import cdr
from rigid_body_sim.recording.topics import Topic, journal_topic
from rigid_body_sim.recording.writer import Writer

START = 1_700_000_000_000_000_000
LATE = 41_234
"""By how many ns, times the number of the tick modulo 7, the wall clock is behind the stamp."""
PACKERS = {
    '/pose': Packed('geometry_msgs/msg/PoseStamped', {'header': {'frame_id': 'world'}}),
    '/angular_velocity': Packed(
        'geometry_msgs/msg/Vector3Stamped', {'header': {'frame_id': 'body'}}),
    '/energy': Packed('std_msgs/msg/Float64', {}),
    '/angular_momentum_squared': Packed('std_msgs/msg/Float64', {}),
}
TICKING = [(Topic(name, packer.type_name), packer.size) for name, packer in PACKERS.items()]
SCENE = Topic('/scene', 'std_msgs/msg/String', depth=1, durability='transient_local')
JOURNAL = journal_topic()
ABOUT = {
    'scene': 'scene: tennis_racket\nbody: {mass: 1.0}\n',
    'version': '0.1.0',
    'machine': 'x86 ⟳',
}


@dataclasses.dataclass
class Ticks:
    """Ticks `first` to `first + count - 1`.

    They have stamps and wall clock (count,) in ns, columns of numbers, and packed messages by
    topic.
    """

    first: int
    count: int

    def __post_init__(self):
        k = np.arange(self.first, self.first + self.count)
        self.stamps, self.wall_clock = START + k * 10**6, START + k * 10**6 + (1 + k % 7) * LATE
        self.orientation = np.stack([np.sin(k * a) for a in (0.1, 0.2, 0.3, 0.4)], axis=1)
        self.angular_velocity = np.stack([np.cos(k * a) for a in (1.1, 1.2, 1.3)], axis=1)
        self.energy, self.momentum = 25.0 + 1e-15 * np.sin(k), 100.0 / (k + 1.0)
        self.rows = {
            '/pose': PACKERS['/pose'].pack_many(
                {'header.stamp': self.stamps, 'pose.orientation': self.orientation}
            ),
            '/angular_velocity': PACKERS['/angular_velocity'].pack_many(
                {'header.stamp': self.stamps, 'vector': self.angular_velocity}
            ),
            '/energy': PACKERS['/energy'].pack_many({'data': self.energy}),
            '/angular_momentum_squared': PACKERS['/angular_momentum_squared'].pack_many(
                {'data': self.momentum}
            ),
        }

    def messages(self, index):
        """Return the messages of one tick, as the node has them."""
        return [rows[index].tobytes() for rows in self.rows.values()]


def scene_text(text):
    """Return a message of the topic /scene."""
    return cdr.encode('std_msgs/msg/String', {'data': text})


def write(path, count=1000, block=100, **options):
    """Make a recording of `count` ticks, the scene first; return its path.

    A chunk ends every `block` ticks.
    """
    with Writer(path, TICKING, [SCENE], JOURNAL, ABOUT, **options) as writer:
        writer.message('/scene', START, START + 5, scene_text(ABOUT['scene']))
        for first in range(0, count, block):
            ticks = Ticks(first, min(block, count - first))
            assert (
                writer.ticks(first, ticks.stamps, ticks.wall_clock, list(ticks.rows.values()))
                == ticks.count
            )
            writer.flush()
    return path


@pytest.fixture(scope='session')
def recording(tmp_path_factory):
    """Return the path of a recording of 1000 ticks; not to be changed."""
    return write(tmp_path_factory.mktemp('shared') / 'racket')
