# SPDX-License-Identifier: Apache-2.0
"""Chunks composed from arrays: the messages of many ticks become one chunk without a loop.

Why not `mcap.writer.Writer`: it takes one message a call and makes Python objects of each and of
its index entry, which takes nine times as long (bench/recordings.py). So the two parts of the
format that repeat with every message are laid out here as NumPy dtypes: the head of a message's
record (walk.py) and the entry of a message index. All other records are the library's.
"""

import struct
import typing
import zlib

import numpy as np
from mcap.opcode import Opcode
from mcap.records import Chunk, ChunkIndex

from rigid_body_sim.recording.mcap.records import HEAD, to_bytes
from rigid_body_sim.recording.mcap.walk import HEADS, MESSAGE, MESSAGE_FIXED, MESSAGE_HEAD

ENTRY = np.dtype([('channel', '<u2'), ('time', '<u8'), ('offset', '<u8')])
"""A message of a chunk: channel number, log time (ns), and the offset of its record."""
ENTRY_BYTES = struct.Struct('<HQQ').pack
_INDEX_HEAD = struct.Struct('<BQHI')


def message(channel, sequence, log_time, publish_time, data):
    """Return the record of one message."""
    return MESSAGE_HEAD.pack(MESSAGE, MESSAGE_FIXED + len(data), channel, sequence, log_time,
                             publish_time) + data


def tick_records(sizes):
    """Return the dtype of one tick's message records end to end; `sizes` in bytes of their data.

    Field ``'k'`` is the record of the k-th message, on channel k + 1.
    """
    return np.dtype([(str(position), np.dtype([*HEADS.descr, ('data', 'u1', (size,))]))
                     for position, size in enumerate(sizes)])


def ticks(dtype, sequence, log_times, publish_times, messages, offset):
    """Return the records of n ticks as bytes, and their entries as bytes.

    Parameters
    ----------
    dtype : numpy.dtype
        See :func:`tick_records`.
    sequence : int
        Number of the first tick.
    log_times, publish_times : array (n,)
        ns.
    messages : sequence of uint8 arrays (n, size)
        For each channel its messages.
    offset : int
        Where the records will begin in their chunk.
    """
    count = len(log_times)
    records, entries = np.empty(count, dtype), np.empty((count, len(messages)), ENTRY)
    sequences = (sequence + np.arange(count)) & 0xffffffff
    begins = offset + dtype.itemsize * np.arange(count, dtype=np.uint64)
    for position, rows in enumerate(messages):
        record, column = records[str(position)], entries[:, position]
        record['opcode'], record['length'] = MESSAGE, MESSAGE_FIXED + rows.shape[1]
        record['channel'] = column['channel'] = position + 1
        record['sequence'], record['publish_time'] = sequences, publish_times
        record['log_time'] = column['time'] = log_times
        record['data'] = rows
        column['offset'] = begins + dtype.fields[str(position)][1]
    return records.tobytes(), entries.tobytes()


class PackedChunk(typing.NamedTuple):
    """A chunk ready to be written.

    `data` is the chunk's record with its message indexes, `index` its ChunkIndex, `counts` maps
    channel numbers to messages.
    """

    data: bytes
    index: ChunkIndex
    counts: dict


def pack(position, compression, compressed, records, channels, times, offsets, sure=True):
    """Return the PackedChunk of message records that are to be written at `position` of a file.

    Parameters
    ----------
    position : int
    compression : str
        Name in the format; ``''`` for none.
    compressed : bytes
        The records, compressed.
    records : bytes
        Message records end to end.
    channels, times, offsets : arrays
        One element per message: its channel number, log time (ns) and offset in `records`.
    sure : bool
        Whether to write a checksum over the records.
    """
    start, end = int(times.min()), int(times.max())
    checksum = zlib.crc32(records) if sure else 0
    chunk = to_bytes(Chunk(compression, compressed, end, start, checksum, len(records)))
    indexes, places, counts = index_messages(position + len(chunk), channels, times, offsets)
    index = ChunkIndex(len(chunk), position, compression, len(compressed), end, len(indexes),
                       places, start, len(records))
    return PackedChunk(chunk + indexes, index, counts)


def index_messages(position, channels, times, offsets):
    """Return the message indexes of a chunk that are to be written at `position`.

    Returns
    -------
    indexes : bytes
    places : dict
        Channel number -> position of its index.
    counts : dict
        Channel number -> messages.
    """
    indexes, places, counts = bytearray(), {}, {}
    for number in np.unique(channels).tolist():
        mine = channels == number
        entries = np.stack((times[mine], offsets[mine]), axis=1).astype('<u8', copy=False)
        places[number], counts[number] = position + len(indexes), len(entries)
        indexes += _INDEX_HEAD.pack(Opcode.MESSAGE_INDEX,
                                    _INDEX_HEAD.size - HEAD.size + entries.nbytes, number,
                                    entries.nbytes)
        indexes += entries.tobytes()
    return bytes(indexes), places, counts
