# SPDX-License-Identifier: Apache-2.0
"""The messages in which a recording keeps the commands of a tick.

Each is kept as the message that arrived, and all of them as one entry of the journal.
"""

import dataclasses
import struct

from rigid_body_sim.messages import cdr
from rigid_body_sim.messages.timeline import NANOSECONDS
from rigid_body_sim.recording.topics import journal_message
from rigid_body_sim.simulation.command_rows import FORCE, RELEASE, WIDTH, commands_of

WRENCH_TYPE = 'geometry_msgs/msg/WrenchStamped'
_STAMP, _NUMBERS_SIZE = slice(4, 12), 48


@dataclasses.dataclass(frozen=True)
class CommandTopics:
    """Where commands came from, in the order of the numbers of command_rows.py.

    `topics` are ordered by KIND, `frames` (names of frames) by AXES.
    """

    topics: tuple
    frames: tuple


class CommandMessages:
    """Makes the messages.

    Parameters
    ----------
    names : CommandTopics
    journal : str
        Name of the journal's topic.
    """

    def __init__(self, names, journal):
        self._topics, self._journal = names.topics, journal
        # all but the stamp and the six doubles at the end, for each frame
        blanks = [cdr.encode(WRENCH_TYPE, {'header': {'frame_id': name}})
                  for name in names.frames]
        self._around = [(blank[:_STAMP.start], blank[_STAMP.stop:-_NUMBERS_SIZE])
                        for blank in blanks]

    def messages(self, tick, stamp, rows):
        """Return (topic name, bytes) for each row (command_rows.py), and last for the journal.

        None stands for a RELEASE, which did not come as a message: the node did it by itself.
        """
        time = struct.pack('<iI', *divmod(stamp, NANOSECONDS))
        heads = [before + time + after for before, after in self._around]
        data, size, made = rows.tobytes(), rows.itemsize * WIDTH, []
        kinds = rows[:, :FORCE.start].astype(int).tolist()
        for end, (kind, axes) in zip(range(size, len(data) + size, size), kinds, strict=True):
            made.append(None if kind == RELEASE else
                        (self._topics[kind], heads[axes] + data[end - _NUMBERS_SIZE:end]))
        entry = journal_message('commands', tick=tick, commands=commands_of(rows))
        return [*made, (self._journal, entry)]
