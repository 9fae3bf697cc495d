# SPDX-License-Identifier: Apache-2.0
"""A cut or damaged file made whole.

Where only the end is missing, the missing indexes of the last chunk and the tail are appended:
nothing else moves, and a full disk needs room for an index only. Where more is wrong, the file is
rewritten beside the old one: whole parts byte by byte, damaged ones as far as they can be read
(rescue.py). Why not reading all of it by `mcap.stream_reader` and writing it anew by
`mcap.writer`: that takes 15 times as long (bench/recordings.py), and it ends at the first record
that is damaged.
"""

import os
import typing

import numpy as np
from mcap.exceptions import InvalidMagic
from mcap.opcode import Opcode
from mcap.records import Chunk, Metadata
from mcap.writer import MCAP0_MAGIC

from rigid_body_sim.recording.mcap import chunks
from rigid_body_sim.recording.mcap.bytes import FileBytes
from rigid_body_sim.recording.mcap.compression import compressor, records_of
from rigid_body_sim.recording.mcap.contents import DESCRIPTIONS, Contents
from rigid_body_sim.recording.mcap.found import Broken, FoundChunk, Loose, Unindexed, Whole
from rigid_body_sim.recording.mcap.records import HEAD, Damaged, of_bytes, to_bytes
from rigid_body_sim.recording.mcap.rescue import rescue
from rigid_body_sim.recording.mcap.scan import Scan
from rigid_body_sim.recording.mcap.summary import read_metadata, read_told
from rigid_body_sim.recording.mcap.walk import HEADS, MESSAGE, heads, walk
from rigid_body_sim.recording.mcap.writing import HEADER

_BLOCK = 2**22


class Losses(typing.NamedTuple):
    """What was lost from a file.

    Attributes
    ----------
    messages : int
    certainty : str
        How `messages` is known: ``counted`` by statistics, indexes or sequence numbers,
        ``estimated`` by sizes, or ``unknown``: at least so many, and nothing tells how many more.
    seconds : float
        Of log time between the messages around what is lost.
    bytes : int
    doubtful : int
        Messages that were kept, though the checksum over them is wrong.
    """

    messages: int = 0
    certainty: str = 'counted'
    seconds: float = 0.0
    bytes: int = 0
    doubtful: int = 0


class Mended(typing.NamedTuple):
    """The result of mending a file: its Contents, and the Losses (None if it was whole)."""

    contents: Contents
    losses: Losses


def mend(stream, texts, beside, expected=None):
    """Make a file whole; return Mended.

    Parameters
    ----------
    stream : binary file
        Open for reading and writing.
    texts : callable
        Called with a stream and the Contents, if the file lacks a metadata record ``rosbag2``;
        returns its texts.
    beside : callable
        Returns a binary file, open for reading and writing and empty, for a file that has to be
        written anew. The old one is not touched then.
    expected : int, optional
        Messages that the file should hold, where something else tells.

    Raises
    ------
    OSError
        If the disk refuses. The file may be mended again afterwards.
    Damaged
        Where the mended file does not read back.
    mcap.exceptions.InvalidMagic, mcap.exceptions.UnsupportedCompressionError
        See :class:`rigid_body_sim.recording.mcap.scan.Scan`.
    """
    scan = Scan(stream)
    if scan.whole:
        return Mended(scan.contents, None)
    found = losses(scan, expected)
    if scan.in_place:
        kept, behind = scan.parts[:1], scan.parts[1:]
        begin = kept[0].end if kept else 0
        target, end = stream, _Composer(stream.fileno(), begin)
        for part in kept:
            end.contents.merge(part.contents)
        os.ftruncate(stream.fileno(), begin)
    else:
        target, behind = beside(), scan.parts
        end = _Composer(target.fileno(), 0)
    if end.position == 0 and not any(isinstance(part, Whole) and part.begin == 0
                                     for part in behind):
        end.append(MCAP0_MAGIC + (scan.header or to_bytes(HEADER)) + to_bytes(*scan.descriptions))
        scan.descriptions.clear()
    for part in behind:
        end.part(FileBytes(stream.fileno()), part, scan)
    contents = end.contents
    contents.schemas, contents.channels = scan.contents.schemas, scan.contents.channels
    if read_metadata(target, contents, 'rosbag2') is None:
        end.metadata('rosbag2', texts(target, contents))
    end.append(contents.tail(end.position))
    os.fsync(target.fileno())
    _verify(target, contents, scan)
    return Mended(contents, found)


def _verify(stream, contents, scan):
    """Raise Damaged where a mended file does not hold what was found in the old one.

    Where only the tail was written, it alone is read back.
    """
    try:
        if scan.in_place:
            told = read_told(stream)
            good = told is None or told.contents.counts == contents.counts
        else:
            stream.seek(0)
            again = Scan(stream)
            good = again.whole and again.contents.counts == scan.contents.counts
    except InvalidMagic:
        good = False
    if not good or contents.counts != scan.contents.counts:
        raise Damaged('damaged in a way that cannot be mended here')


def losses(scan, expected=None):
    """Return the Losses of a file by its Scan; `expected` as for :func:`mend`."""
    kept, damages = scan.contents.message_count, [*scan.damages]
    if scan.cut_damage:
        damages.append(scan.cut_damage)
    if expected is None and scan.told:
        expected = scan.told.contents.message_count
    if expected is not None and expected >= kept:
        messages, certainty = expected - kept, 'counted'
    else:
        messages, certainty = 0, 'counted'
        for damage in damages:
            count, how = _count(damage, scan)
            messages += count
            certainty = how if certainty != 'unknown' and how != 'counted' else certainty
        if scan.cut:
            certainty = 'unknown'
    last = scan.told.contents.end_time if scan.told else 0
    nanoseconds = sum(_hole(damage, scan, last) for damage in damages if damage.lost != 0)
    return Losses(messages, certainty, nanoseconds / 1e9,
                  sum(damage.lost_bytes for damage in damages),
                  sum(damage.doubtful for damage in damages))


def _count(damage, scan):
    """Return how many messages a Damage cost, and how that is known."""
    if damage.lost is not None:
        return damage.lost, 'counted'
    if damage.before and damage.after and not damage.kept:
        counts = [_missing_between(damage.before.heads, damage.after.heads, number)
                  for number in damage.before.counts.keys() & damage.after.counts.keys()]
        known = [count for count in counts if count is not None]
        if known and len(known) == len(counts):
            return sum(known), 'counted'
    if damage.claimed and scan.mean_message:
        return round(damage.claimed / scan.mean_message), 'estimated'
    return 0, 'unknown' if damage.lost_bytes else 'counted'


def _missing_between(before, after, number):
    """Return how many messages of a channel are missing between two chunks, by their sequence.

    None where its sequence numbers do not count by one.
    """
    sequences = [found['sequence'][found['channel'] == number] for found in (before, after)]
    if any(len(one) < 2 or (np.diff(one) != 1).any() for one in sequences):
        return None
    return (int(sequences[1][0]) - int(sequences[0][-1]) - 1) & 0xffffffff


def _hole(damage, scan, last):
    """Return the ns of log time without messages around a Damage; `last` ends the file, or 0."""
    if not damage.lost_bytes and not damage.claimed and not damage.lost:
        return 0
    begin = int(damage.before.times.max()) if damage.before else scan.contents.start_time
    if damage.kept:
        begin = max(begin, scan.contents.end_time if damage is scan.damages[-1] else begin)
    end = int(damage.after.times.min()) if damage.after else last or damage.until
    return max(0, end - begin) if begin and end - begin < 10**14 else 0


def _messages(records, offsets):
    """Return the messages of some records alone."""
    ends = (offsets + HEAD.size + heads(records, offsets)['length'].astype(np.int64)).tolist()
    return b''.join(records[begin:end] for begin, end in zip(offsets.tolist(), ends, strict=True))


class _Composer:
    """Writes at the end of a file, and notes what in its Contents."""

    def __init__(self, descriptor, position):
        self._descriptor, self.position, self.contents = descriptor, position, Contents()

    def append(self, data):
        done, view = 0, memoryview(data)
        while done < len(data):
            done += os.pwrite(self._descriptor, view[done:], self.position + done)
        self.position += len(data)

    def part(self, source, part, scan):
        """Write a part of a Scan."""
        if isinstance(part, Whole):
            self._whole(source, part, scan)
        elif isinstance(part, Unindexed):
            self._index(source, part.offset)
        elif isinstance(part, Broken):
            found = rescue(source, part.offset, part.hint, part.cut)
            self._rescued(found, doubtful=not (found.sure or part.cut))
        elif isinstance(part, Loose):
            self._loose(source.read(part.begin, part.end - part.begin))
        else:
            self._replaced(part.data)

    def _replaced(self, data):
        """Write a record as it should have been."""
        opcode, content = data[0], data[HEAD.size:]
        if opcode == MESSAGE:
            head = heads(data[:HEADS.itemsize], np.zeros(1, int))[0]
            time = int(head['log_time'])
            self.contents.add_messages({int(head['channel']): 1}, time, time)
        elif opcode == Opcode.METADATA:
            self.contents.add_metadata(self.position, len(data), of_bytes(Metadata, content).name)
        self.append(data)

    def _whole(self, source, part, scan):
        begin = part.begin
        if begin == 0 and scan.descriptions:
            self._copy(source, 0, scan.header_end)
            self.append(to_bytes(*scan.descriptions))
            begin = scan.header_end
        self.contents.merge(part.contents, self.position - begin)
        self._copy(source, begin, part.end)

    def _copy(self, source, begin, end):
        for at in range(begin, end, _BLOCK):
            self.append(source.read(at, min(_BLOCK, end - at)))

    def _index(self, source, offset):
        """Write the message indexes of a whole chunk that ends here, and note the chunk."""
        length = HEAD.size + HEAD.unpack(source.read(offset, HEAD.size))[1]
        chunk = of_bytes(Chunk, source.read(offset + HEAD.size, length - HEAD.size))
        found = FoundChunk(chunk, self.position - length, length, records_of(chunk))
        indexes, found.index_places, _ = chunks.index_messages(
            self.position, found.heads['channel'], found.times, found.offsets)
        found.index_length = len(indexes)
        self.append(indexes)
        self.contents.add_chunk(found.index())

    def _rescued(self, found, doubtful):
        """Write the rescued part of a chunk as a chunk."""
        if len(found.offsets):
            data, records, offsets = found.compressed, found.records, found.offsets
            if not found.sure and any(opcode in DESCRIPTIONS for opcode, _, _ in found.others):
                data, records = None, _messages(records, offsets)
                offsets, _ = walk(records)
            if data is None:
                data = compressor(found.compression)(records)
            self._chunk(found.compression, data, records, offsets, not doubtful)

    def _loose(self, records):
        """Write messages without a chunk as one."""
        self._chunk('', records, records, walk(records)[0])

    def _chunk(self, compression, data, records, offsets, sure=True):
        message_heads = heads(records, offsets)
        packed = chunks.pack(self.position, compression, data, records, message_heads['channel'],
                             message_heads['log_time'], offsets.astype(np.uint64), sure)
        self.append(packed.data)
        self.contents.add_chunk(packed.index)
        self.contents.add_messages(packed.counts, packed.index.message_start_time,
                                   packed.index.message_end_time)

    def metadata(self, name, texts):
        """Write a metadata record."""
        data = to_bytes(Metadata(name, texts))
        self.contents.add_metadata(self.position, len(data), name)
        self.append(data)
