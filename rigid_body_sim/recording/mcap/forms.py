# SPDX-License-Identifier: Apache-2.0
"""Whether a record begins at a place of a damaged file: its opcode and its lengths must agree.

A record says more than once how long it is: its own length, the lengths of what it holds, and the
record that follows. So one wrong byte in a head is found out, and the next whole record after it
is found again. Why not `mcap.stream_reader.StreamReader`: it believes the first length it reads.
"""

import struct

import numpy as np
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.reader import FOOTER_SIZE
from mcap.records import (
    AttachmentIndex,
    Channel,
    ChunkIndex,
    Header,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)
from mcap.writer import MCAP0_MAGIC

from rigid_body_sim.recording.mcap.records import HEAD, Damaged, LenientStream, WholeStream
from rigid_body_sim.recording.mcap.walk import MESSAGE, MESSAGE_FIXED

SUMMARY = frozenset(map(int, (
    Opcode.FOOTER, Opcode.CHUNK_INDEX, Opcode.ATTACHMENT_INDEX, Opcode.STATISTICS,
    Opcode.METADATA_INDEX, Opcode.SUMMARY_OFFSET, Opcode.DATA_END)))
"""Opcodes of the records after the data section."""
SELF_DELIMITING = {
    int(Opcode.SCHEMA): Schema, int(Opcode.CHANNEL): Channel, int(Opcode.METADATA): Metadata,
    int(Opcode.HEADER): Header}
_PARSED = {
    **SELF_DELIMITING, int(Opcode.CHUNK_INDEX): ChunkIndex, int(Opcode.STATISTICS): Statistics,
    int(Opcode.ATTACHMENT_INDEX): AttachmentIndex, int(Opcode.METADATA_INDEX): MetadataIndex,
    int(Opcode.SUMMARY_OFFSET): SummaryOffset}
CHUNK_FIXED = 40
"""Bytes of a chunk's content besides the name of its compression and its data."""
CHUNK_HEAD = struct.Struct('<BQQQQII')      # up to the length of the compression's name
LONGEST_PARSED = 2**24                      # bytes of a record that is read as an object
_LONGEST_NAME = 16                          # bytes of a compression's name
_INDEX_FIXED = 6
_ATTACHMENT_START = 2**16
_WINDOW, _CHAIN = 2**20, 3
_MESSAGE_INDEX = int(Opcode.MESSAGE_INDEX)
_CANDIDATES = np.zeros(256, bool)
_CANDIDATES[[Opcode.SCHEMA, Opcode.CHANNEL, Opcode.MESSAGE, Opcode.CHUNK, Opcode.MESSAGE_INDEX,
             Opcode.METADATA, Opcode.ATTACHMENT, Opcode.DATA_END]] = True


def consumed(kind, content):
    """Return how many bytes the record of a class of `mcap.records` takes; 0 where it is none."""
    stream = WholeStream(content)
    try:
        kind.read(stream)
    except (Damaged, McapError, UnicodeDecodeError, struct.error, OverflowError):
        return 0
    return stream.count


def parsed(kind, content):
    """Return the record that begins some bytes, and how many it takes; (None, 0) if it is none.

    Bytes of its texts may be wrong.
    """
    stream = LenientStream(content)
    try:
        return kind.read(stream), stream.count
    except (Damaged, McapError, struct.error, OverflowError):
        return None, 0


def chunk_end(source, offset, may_be_cut=False):
    """Return the end of the chunk at `offset`, whatever its opcode, if its lengths agree.

    Returns 0 otherwise, and where that is beyond the end of the file, unless it `may_be_cut`.
    """
    head = source.read(offset, CHUNK_HEAD.size + _LONGEST_NAME + 8)
    if len(head) < CHUNK_HEAD.size + 8:
        return 0
    length, name = int.from_bytes(head[1:9], 'little'), CHUNK_HEAD.unpack_from(head)[-1]
    end = offset + HEAD.size + length
    if name > _LONGEST_NAME or len(head) < CHUNK_HEAD.size + name + 8 or (
            end > source.size and not may_be_cut):
        return 0
    data = int.from_bytes(head[CHUNK_HEAD.size + name:][:8], 'little')
    return end if length == CHUNK_FIXED + name + data else 0


def is_message_index(head, length):
    """Return whether a record with this head and length says of itself that it is an index."""
    return (length >= _INDEX_FIXED and (length - _INDEX_FIXED) % 16 == 0
            and int.from_bytes(head[11:15], 'little') == length - _INDEX_FIXED)


def index_end(source, offset):
    """Return where the message index at `offset` ends by the length of its array of entries."""
    head = source.read(offset, HEAD.size + _INDEX_FIXED)
    return offset + len(head) + int.from_bytes(head[HEAD.size + 2:], 'little')


def record_end(source, offset, channels=None):
    """Return the end of the record at `offset` if its opcode and lengths agree, 0 otherwise.

    Parameters
    ----------
    source : FileBytes
    offset : int
    channels : container of int, optional
        Those that a message may be on.
    """
    head = source.read(offset, 15)
    if len(head) < HEAD.size:
        return 0
    opcode, length = HEAD.unpack_from(head)
    end = offset + HEAD.size + length
    if opcode == 0 or end > source.size:
        return 0
    if opcode == MESSAGE:
        channel = int.from_bytes(head[9:11], 'little')
        good = length >= MESSAGE_FIXED and (channels is None or channel in channels)
    elif opcode == Opcode.CHUNK:
        good = chunk_end(source, offset)
    elif opcode == _MESSAGE_INDEX:
        good = is_message_index(head, length)
    elif opcode == Opcode.DATA_END:
        good = length == 4
    elif opcode == Opcode.FOOTER:
        good = length == FOOTER_SIZE - HEAD.size and end + len(MCAP0_MAGIC) == source.size
    elif opcode == Opcode.ATTACHMENT:
        good = _attachment_fits(source.read(offset + HEAD.size, min(length, _ATTACHMENT_START)),
                                length)
    elif opcode in _PARSED:
        good = (0 < length <= LONGEST_PARSED and consumed(
            _PARSED[opcode], source.read(offset + HEAD.size, length)) == length)
    else:               # a record of the future, or a private one
        good = chunk_end(source, offset) == 0
    return end if good else 0


def _attachment_fits(content, length):
    stream = WholeStream(content)
    try:
        stream.read(16)
        stream.read_prefixed_string()
        stream.read_prefixed_string()
        data = stream.read8()
    except (Damaged, UnicodeDecodeError):
        return False
    return stream.count + data + 4 == length


def follows(source, offset, channels, records=_CHAIN):
    """Return whether `offset` is the end of the file or some records that fit follow there."""
    for _ in range(records):
        if offset in (source.size, source.size - len(MCAP0_MAGIC)):
            return True
        offset = record_end(source, offset, channels)
        if not offset:
            return False
    return True


def next_record(source, begin, end, channels):
    """Return where in [begin, end) the next record begins that others follow; `end` if nowhere.

    Found are the records of a data section. A message must be on one of the `channels`.
    """
    while begin < end:
        window = np.frombuffer(source.read(begin, min(_WINDOW, end - begin) + HEAD.size), np.uint8)
        places = np.flatnonzero(_CANDIDATES[window[:max(0, len(window) - HEAD.size)]])
        if len(places):
            lengths = window[places[:, None] + np.arange(1, HEAD.size)].view('<u8')[:, 0]
            room = source.size - HEAD.size - begin - places
            places = places[(lengths <= room) & (lengths >= 4)]
        for place in (begin + places).tolist():
            following = record_end(source, place, channels)
            if following and follows(source, following, channels):
                return place
        begin += _WINDOW
    return end
