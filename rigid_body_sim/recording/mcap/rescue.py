# SPDX-License-Identifier: Apache-2.0
"""Reading a damaged chunk by what is left of it.

A chunk says most things about itself twice: its length in the record's head, before its data and
in the file's index; its compression by name and by the first bytes of its data; its checksum over
all; where its messages begin and when they were logged in the message indexes after it. So one
wrong byte in any of these costs no message. Why not `mcap.stream_reader.breakup_chunk`: it
believes each of these alone.
"""

import dataclasses
import zlib

import lz4.frame
import numpy as np
import zstandard
from mcap.opcode import Opcode

from rigid_body_sim.recording.mcap.bytes import MemoryBytes
from rigid_body_sim.recording.mcap.compression import LARGEST_CHUNK, zstd_length
from rigid_body_sim.recording.mcap.contents import DESCRIPTIONS
from rigid_body_sim.recording.mcap.forms import (
    CHUNK_FIXED,
    CHUNK_HEAD,
    consumed,
    follows,
    is_message_index,
    next_record,
    record_end,
)
from rigid_body_sim.recording.mcap.records import HEAD
from rigid_body_sim.recording.mcap.walk import (
    HEADS,
    MESSAGE,
    Cut,
    heads,
    walk,
)

_MAGIC = {'zstd': (0xFD2FB528).to_bytes(4, 'little'), 'lz4': (0x184D2204).to_bytes(4, 'little')}
_STEP = 2**16           # bytes decompressed at a time
_INDEX_HEAD = 15        # bytes of a message index before its entries


@dataclasses.dataclass
class Rescued:
    """The readable part of a damaged chunk.

    Attributes
    ----------
    end : int
        Where the chunk ends in the file.
    compression : str
    compressed : bytes or None
        The data as it stands in the file, where it holds exactly the records; else None.
    records : bytes
        Records end to end, all of them whole.
    offsets : array (n,) int64
        Where in them messages begin.
    others : list
        See :func:`rigid_body_sim.recording.mcap.walk.walk`.
    sure : bool
        Whether the checksum vouches for the records.
    expected : dict or None
        Channel number -> messages that the chunk held, where its message indexes tell; None where
        they do not.
    claimed : int
        Bytes of records that the chunk claims to hold.
    span : (int, int)
        Log times of the first and the last message it claims to hold, ns.
    """

    end: int
    compression: str
    compressed: bytes
    records: bytes
    offsets: np.ndarray
    others: list
    sure: bool
    expected: dict
    claimed: int
    span: tuple


def decompress(name, data, limit):
    """Return what can be decompressed of some data, `limit` bytes at most, and whether all was.

    Returns
    -------
    records : bytes
    length : int
        Bytes of the compressed data, 0 where its end was not found.
    """
    records, pieces = 0, []
    try:
        if name == 'zstd':
            length = zstd_length(data)
            stream = zstandard.ZstdDecompressor(max_window_size=2**28).stream_reader(
                data[:length] if length else data)
            while records <= limit and (piece := stream.read(_STEP)):
                pieces.append(piece)
                records += len(piece)
        else:
            length, decompressor = 0, lz4.frame.LZ4FrameDecompressor()
            fed = data
            while records <= limit and not decompressor.eof:
                piece = decompressor.decompress(fed, max_length=_STEP)
                fed = b''
                if not piece and decompressor.needs_input:
                    break
                pieces.append(piece)
                records += len(piece)
            if decompressor.eof:
                length = len(data) - len(decompressor.unused_data or b'')
    except (zstandard.ZstdError, RuntimeError):
        return b''.join(pieces), 0
    return b''.join(pieces), length if records <= limit else 0


def _best(source, offset, hint, cut):
    """Return how a chunk is best read: (compression, data, records, sure, end), or None."""
    opcode, length, _, _, claimed, checksum, name_length = CHUNK_HEAD.unpack(
        source.read(offset, CHUNK_HEAD.size))
    best = None
    for name in ('zstd', 'lz4', ''):
        begin = offset + CHUNK_HEAD.size + len(name) + 8
        lengths = [int.from_bytes(source.read(begin - 8, 8), 'little'),
                   length - CHUNK_FIXED - len(name)]
        if hint is not None:
            lengths.append(hint.compressed_size)
        # signs that this is a chunk; at least two have to be present
        votes = ((opcode == Opcode.CHUNK) + (name_length == len(name)) * bool(name)
                 + 2 * (hint is not None and hint.compression == name)
                 + (lengths[0] == lengths[1]))
        found = (_packed if name else _plain)(
            source, begin, name, lengths, (claimed, checksum), cut)
        if found is None or not (found[2] or votes >= 2):
            continue
        data, records, sure, end = found
        if best is None or (sure, len(records)) > (best[3], len(best[2])):
            best = name, data, records, sure, end
            if sure:
                break
    return best


def rescue(source, offset, hint=None, cut=False):
    """Return what can be read of a damaged chunk, as Rescued; None where there is no chunk.

    Parameters
    ----------
    source : FileBytes
    offset : int
    hint : mcap.records.ChunkIndex, optional
        What the summary says of it.
    cut : bool
        Whether the file may end within the chunk.
    """
    head = source.read(offset, CHUNK_HEAD.size)
    if len(head) < CHUNK_HEAD.size:
        return None
    _, _, start, stop, claimed, checksum, _ = CHUNK_HEAD.unpack(head)
    best = _best(source, offset, hint, cut)
    if best is None:
        return None
    name, data, records, sure, end = best
    if hint is not None:
        start, stop = hint.message_start_time, hint.message_end_time
        claimed = hint.uncompressed_size
    entries = entries_behind(source, end)
    whole, offsets, others = _sift(records, None if sure else entries)
    if whole is not records:
        data = None
        sure = sure or bool(checksum and zlib.crc32(whole) == checksum)
    if entries is None:
        expected = None
    else:
        numbers, counts = np.unique(entries['channel'], return_counts=True)
        expected = dict(zip(numbers.tolist(), counts.tolist(), strict=True))
    return Rescued(end, name, data, whole, offsets, others, sure, expected, claimed,
                   (start, stop))


def _right(records, checksum):
    """Return whether a checksum, of which one byte may be wrong, is that of the records."""
    wrong = zlib.crc32(records) ^ checksum
    return any(wrong & ~(0xff << shift) == 0 for shift in (0, 8, 16, 24))


def _packed(source, begin, name, lengths, claims, cut):
    """Return (data, records, sure, end) of compressed data, or None."""
    if source.read(begin, 4) != _MAGIC[name]:
        return None
    claimed, checksum = claims
    room = min(LARGEST_CHUNK, source.size - begin)
    for length in dict.fromkeys([*sorted(lengths), room]):      # the shortest that suffices
        if not 0 < length <= room:
            continue
        data = source.read(begin, length)
        records, taken = decompress(name, data, LARGEST_CHUNK)
        if taken:
            data = data[:taken]
            sure = (_right(records, checksum) if checksum else len(records) == claimed)
            return data, records, sure, begin + taken
    # it does not end, or makes no sense from some byte on: where it ended, the next record begins
    sure = bool(checksum) and zlib.crc32(records) == checksum
    ends = [begin + length for length in lengths
            if 0 < length <= room and record_end(source, begin + length)]
    end = ends[-1] if ends else source.size if cut else 0
    return (None, records, sure, end) if end else None


def _plain(source, begin, _name, lengths, claims, cut):
    """Return (data, records, sure, end) of data that is not compressed, or None."""
    claimed, checksum = claims
    room = min(LARGEST_CHUNK, source.size - begin)
    lengths = [length for length in dict.fromkeys([*lengths, claimed]) if 0 < length <= room]
    found = []
    for length in lengths:
        records = source.read(begin, length)
        if checksum and _right(records, checksum):
            return records, records, True, begin + length
        if follows(source, begin + length, None, 1):
            found.append(records)
    if found:
        records = min(found, key=len)
        return None, records, False, begin + len(records)
    if cut and source.size - begin <= LARGEST_CHUNK:
        return None, source.read(begin, source.size - begin), False, source.size
    return None


def entries_behind(source, offset):
    """Return the entries of the message indexes at `offset`, by the places of their messages.

    Returns
    -------
    structured array (channel, time, offset), or None
        None where there are no indexes, or they make no sense.
    """
    found = []
    while True:
        head = source.read(offset, _INDEX_HEAD)
        if len(head) < _INDEX_HEAD or head[0] != Opcode.MESSAGE_INDEX:
            break
        length = HEAD.unpack_from(head)[1]
        if not is_message_index(head, length) or offset + HEAD.size + length > source.size:
            return None
        body = source.read(offset + _INDEX_HEAD, length + HEAD.size - _INDEX_HEAD)
        pairs = np.frombuffer(body, '<u8').reshape(-1, 2)
        entries = np.empty(len(pairs), [('channel', '<u2'), ('time', '<u8'), ('offset', '<u8')])
        entries['channel'] = int.from_bytes(head[9:11], 'little')
        entries['time'], entries['offset'] = pairs.T
        found.append(entries)
        offset += HEAD.size + length
    if not found:
        return None
    entries = np.concatenate(found)
    return entries[np.argsort(entries['offset'], kind='stable')]


def _sift(records, entries):
    """Return (records, offsets, others): of records of which some may be wrong, the whole ones.

    What the message indexes know of a message's head stands in for what is wrong there. The
    records are returned as they are if nothing is wrong with them.
    """
    try:
        offsets, others = walk(records)
        whole = len(records)
    except Cut as cut:
        (offsets, others), whole = cut.found, cut.whole
    if whole == len(records) and (entries is None or _agree(records, offsets, entries)):
        return records, offsets, others
    if entries is None:
        records = _by_search(records, whole)
        return records, *walk(records)
    return _by_entries(records, entries, others)


def _by_search(records, whole):
    """Return the records up to `whole`, and from the next one on that others follow; and so on."""
    kept, source = [records[:whole]], MemoryBytes(records)
    begin = next_record(source, whole + 1, len(records), None)
    while begin < len(records):
        try:
            walk(records[begin:])
            whole = len(records)
        except Cut as cut:
            whole = begin + cut.whole
        kept.append(records[begin:whole])
        begin = next_record(source, whole + 1, len(records), None)
    return b''.join(kept)


def _agree(records, offsets, entries):
    found = heads(records, offsets)
    return (len(offsets) == len(entries) and (entries['offset'] == offsets).all()
            and (entries['channel'] == found['channel']).all()
            and (entries['time'] == found['log_time']).all())


def _by_entries(records, entries, others):
    """Return (records, offsets, others), as `_sift` does, by the message indexes alone."""
    entries = entries[entries['offset'] + HEADS.itemsize <= len(records)]
    if not len(entries):
        return b'', np.empty(0, np.int64), []
    begins = entries['offset'].astype(np.int64)
    ends = np.append(begins[1:], len(records))
    messages = set(begins.tolist())
    others = [(opcode, begin, end) for opcode, begin, end in others
              if opcode in DESCRIPTIONS and begin - HEAD.size not in messages
              and consumed(DESCRIPTIONS[opcode], records[begin:end]) == end - begin]
    stops = [begin - HEAD.size for _, begin, _ in others]
    descriptions, kept, out = [], [], bytearray()
    for opcode, begin, end in others:
        descriptions.append((opcode, len(out) + HEAD.size, len(out) + HEAD.size + end - begin))
        out += records[begin - HEAD.size:end]
    for entry, begin, end in zip(entries, begins.tolist(), ends.tolist(), strict=True):
        end = min((stop for stop in stops if begin < stop < end), default=end)
        if end - begin < HEADS.itemsize:
            continue
        kept.append(len(out))
        out += HEAD.pack(MESSAGE, end - begin - HEAD.size) + entry['channel'].tobytes()
        out += records[begin + 11:begin + 15] + entry['time'].tobytes() + records[begin + 23:end]
    return bytes(out), np.array(kept, np.int64), descriptions
