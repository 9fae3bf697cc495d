# SPDX-License-Identifier: Apache-2.0
"""All messages of a chunk at once: where they are and what their heads say, as NumPy arrays.

Why not `mcap.stream_reader.breakup_chunk`: it makes a Python object of every message, which takes
nine times as long (bench/recordings.py).

A recording of a simulation repeats the same few messages tick after tick. So records are walked
one by one only until a tick (the messages between one and the next of the same form) repeats
itself; from there on whole runs are compared with it at once.
"""

import struct

import numpy as np
from mcap.opcode import Opcode

from rigid_body_sim.recording.mcap.records import HEAD, Damaged

MESSAGE = int(Opcode.MESSAGE)
HEADS = np.dtype([('opcode', 'u1'), ('length', '<u8'), ('channel', '<u2'), ('sequence', '<u4'),
                  ('log_time', '<u8'), ('publish_time', '<u8')])
"""A message's record up to its data, as an array of them and one by one (MESSAGE_HEAD)."""
MESSAGE_HEAD = struct.Struct('<BQHIQQ')
MESSAGE_FIXED = MESSAGE_HEAD.size - HEAD.size
"""Bytes of a message's content before its data."""
_FORM = 11                      # opcode, length, channel: the bytes of a message that repeat
_LONGEST_TICK = 64              # messages


class Cut(Damaged):
    """A record that does not end within the bytes there are.

    `whole`: the offset up to which all is complete; `found`: the result of walk until there.
    """

    def __init__(self, whole, found):
        super().__init__(f'a record at byte {whole} that is not complete')
        self.whole, self.found = whole, found


def walk(records):
    """Return (offsets, others) of records end to end.

    `offsets`, int64, says where messages begin; `others` lists (opcode, begin, end) of the
    contents of all other records. Raises Cut where a record makes no sense or does not end within
    them.
    """
    data, size = np.frombuffer(records, np.uint8), len(records)
    unpack, head_size = HEAD.unpack_from, HEAD.size
    found, others = [np.empty(0, np.int64)], []
    forms, begins, position = {}, [], 0
    while position < size:
        whole_head = position + head_size <= size
        opcode, length = unpack(records, position) if whole_head else (0, size)
        end = position + head_size + length
        if end > size or opcode == 0 or (opcode == MESSAGE and length < MESSAGE_FIXED):
            raise Cut(position, (np.concatenate([*found, np.array(begins, np.int64)]), others))
        if opcode != MESSAGE:
            others.append((opcode, position + head_size, end))
            position = end
            continue
        form = records[position:position + _FORM]
        first = forms.get(form)
        if first is None and len(begins) < _LONGEST_TICK:
            forms[form] = len(begins)
            begins.append(position)
            position = end
            continue
        broken = first is None or (others and others[-1][1] > begins[first])
        tick = [] if broken else begins[first:]
        found.append(np.array(begins[:len(begins) - len(tick)], np.int64))
        period = position - tick[0] if tick else 0
        if tick and all(records[at:at + _FORM] == records[at + k * period:at + k * period + _FORM]
                        for at in tick for k in (1, 2)):
            run = _run(data, np.array(tick), period)
            found.append(run.ravel())
            position = tick[0] + len(run) * period
        else:
            found.append(np.array(tick, np.int64))
        forms, begins = {}, []
    return np.concatenate([*found, np.array(begins, np.int64)]), others


def _run(data, tick, period):
    """Return the offsets of all messages that repeat a tick's forms each `period` bytes.

    The tick itself is included: shape (ticks, messages).
    """
    columns = (tick - tick[0])[:, None] + np.arange(_FORM)
    form = data[tick[0] + columns]
    longest = (len(data) - int(tick[0])) // period
    done, block = 0, 4
    while done < longest:
        begin, count = int(tick[0]) + done * period, min(block, longest - done)
        rows = data[begin:begin + count * period].reshape(count, period)
        same = (rows[:, columns] == form).all(axis=(1, 2))
        if not same.all():
            done += int(same.argmin())
            break
        done += count
        block *= 2
    return tick + period * np.arange(done)[:, None]


def heads(records, offsets):
    """Return the heads of messages as a structured array (dtype HEADS, without padding)."""
    data = np.frombuffer(records, np.uint8)
    return data[offsets[:, None] + np.arange(HEADS.itemsize)].view(HEADS)[:, 0]
