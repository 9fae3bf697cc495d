# SPDX-License-Identifier: Apache-2.0
"""The packets that the node and its recorder process send each other over two pipes.

To the recorder: packets. Each has a tag and the length of what follows, then

======== ======================================================================================
SETUP    JSON: all arguments of the Writer, and where to go on after a restart (first packet)
TICK     number of the tick, log time, publish time (ns), and the messages of all ticking topics
         end to end: always the same length
MESSAGE  number (from 1 on; 0: may be lost), position of the topic among all, log time, publish
         time, the message
COMMANDS number of the first message made of them, the tick, log time, publish time, n rows
         (command_rows.py): n + 1 messages
END      JSON: ``ticks`` sent or dropped (last packet)
======== ======================================================================================

Back: lines of JSON, each a complete Report, so that one that is lost does not matter. A numbered
message counts as recorded when a report's `acknowledged` has reached its number; the recorder
takes them in order only, and asks for the missing ones by counting `resend` up.
"""

import dataclasses
import json
import struct

SETUP, TICK, MESSAGE, COMMANDS, END = range(1, 6)
HEAD = struct.Struct('<BI')
TICK_HEAD = struct.Struct('<BIQqq')
MESSAGE_HEAD = struct.Struct('<BIQHqq')
COMMANDS_HEAD = struct.Struct('<BIQQqq')
# A pipe takes this much at once or not at all (Linux; see pipe(7)).
ATOMIC = 4096


def json_packet(tag, values):
    """Return a SETUP or END packet."""
    data = json.dumps(values).encode()
    return HEAD.pack(tag, len(data)) + data


def message_packet(number, topic, log_time, publish_time, data):
    """Return a MESSAGE packet."""
    length = MESSAGE_HEAD.size - HEAD.size + len(data)
    return MESSAGE_HEAD.pack(MESSAGE, length, number, topic, log_time, publish_time) + data


def commands_packet(number, tick, log_time, publish_time, rows):
    """Return a COMMANDS packet."""
    data = rows.tobytes()
    length = COMMANDS_HEAD.size - HEAD.size + len(data)
    return COMMANDS_HEAD.pack(COMMANDS, length, number, tick, log_time, publish_time) + data


def tick_fields(sizes):
    """Return the numpy fields of a TICK packet whose messages have the given sizes."""
    return [('tag', 'u1'), ('length', '<u4'), ('number', '<u8'), ('log_time', '<i8'),
            ('publish_time', '<i8'),
            *((f'message{position}', 'u1', (size,)) for position, size in enumerate(sizes))]


@dataclasses.dataclass
class Report:
    """The state of the recorder.

    Attributes
    ----------
    recorded, written : int
        Messages and bytes that are safe from a kill of the recorder.
    dropped : int
        Ticks that are missing between recorded ones.
    ticks : int
        Number of the tick that follows the last one in the file.
    last_tick : int
        Stamp of the last tick in the file, ns.
    acknowledged : int
        Number of the last numbered message in the file.
    resend, state_wanted : int
        Count requests.
    error : str
        The problem right now, or ''.
    refused : tuple of str
        Why nothing can be recorded at all (where, problem, remedy).
    closed : bool
        True once the recording is complete.
    """

    recorded: int = 0
    written: int = 0
    dropped: int = 0
    ticks: int = 0
    last_tick: int = 0
    acknowledged: int = 0
    resend: int = 0
    state_wanted: int = 0
    error: str = ''
    refused: tuple = ()
    closed: bool = False

    def line(self):
        """Return the report as sent."""
        return json.dumps(dataclasses.asdict(self)).encode() + b'\n'

    @classmethod
    def of(cls, line):
        """Return the report of a line."""
        return cls(**json.loads(line))
