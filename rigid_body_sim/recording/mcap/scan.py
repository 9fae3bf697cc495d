# SPDX-License-Identifier: Apache-2.0
"""What an MCAP file really holds, from its first byte on, whoever wrote it.

For files that are cut, damaged or without a summary. Why not `mcap.stream_reader.StreamReader`: it
does not say where a record begins, and it ends at the first one that is cut or damaged. Here what
is damaged is read by what else tells of it (rescue.py), or left out, and the next whole record
behind it is found (forms.py).
"""

import dataclasses
import zlib

import numpy as np
from mcap.exceptions import InvalidMagic, UnsupportedCompressionError
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Metadata, Schema
from mcap.writer import MCAP0_MAGIC

from rigid_body_sim.recording.mcap.bytes import FileBytes
from rigid_body_sim.recording.mcap.compression import LARGEST_CHUNK, records_of
from rigid_body_sim.recording.mcap.contents import DESCRIPTIONS, Contents
from rigid_body_sim.recording.mcap.forms import (
    SELF_DELIMITING,
    SUMMARY,
    chunk_end,
    follows,
    index_end,
    is_message_index,
    next_record,
    parsed,
    record_end,
)
from rigid_body_sim.recording.mcap.found import (
    Broken,
    Damage,
    FoundChunk,
    Loose,
    Replaced,
    Unindexed,
    Whole,
)
from rigid_body_sim.recording.mcap.records import (
    HEAD,
    Damaged,
    attachment_index,
    of_bytes,
    to_bytes,
)
from rigid_body_sim.recording.mcap.rescue import rescue
from rigid_body_sim.recording.mcap.summary import chunk_indexes, place_of, read_told, tail_is_whole
from rigid_body_sim.recording.mcap.walk import HEADS, MESSAGE, MESSAGE_FIXED, heads

LARGEST_RECORD = LARGEST_CHUNK + 2**16
_ATTACHMENT_START = 2**16       # bytes of an attachment that are read: its data is not needed
_LONGEST_DESCRIPTION = 2**20    # bytes of a damaged schema, channel, header or metadata record
_BLOCK = 2**22
_DATA_END_SIZE = 4     # bytes of its content
_FAR = 10**12                   # ns of log time to a message that is not believed
_UNKNOWN = Schema(data=b'', encoding='', id=0, name='unknown')


def check_magic(stream):
    """Read what an MCAP file begins with; InvalidMagic if another one does.

    A file that is cut in there counts as one.
    """
    magic = stream.read(len(MCAP0_MAGIC))
    if magic != MCAP0_MAGIC[:len(magic)]:
        raise InvalidMagic(magic)


class Scan:
    """Everything found in a file.

    Attributes
    ----------
    contents : Contents
        All that is whole or could be rescued; its indexes are those of the whole parts only.
    places : list of ChunkPlace
        Of the chunks that are whole.
    parts : list of Whole, Unindexed, Broken, Loose, Replaced
        What a mended file consists of.
    told : Told or None
        What a whole summary tells.
    end : int
        Where the data section ends: at its end record, or at the first byte that belongs to
        nothing whole. 0 if not even the head is whole.
    cut : bool
        True if no end record was found.
    damages : list of Damage
    descriptions : list of mcap.records.Schema and Channel
        To be written behind the head, because those in the file are damaged or missing.
    header : bytes
        The record at the head, where what is before or behind it is damaged; else empty.
    header_end : int
        Where it ends in a file with a whole head.
    cut_damage : Damage or None
        The record in which the file is cut, if it was more than a message index.
    mean_message : float
        Mean size of a message in the chunks, record head included; 0.0 without chunks.

    Raises
    ------
    mcap.exceptions.InvalidMagic
        Where the file is no MCAP file.
    mcap.exceptions.UnsupportedCompressionError
        Where its chunks cannot be read here.
    """

    def __init__(self, stream):
        self._stream = stream
        self._bytes = FileBytes(stream.fileno())
        self.told = read_told(stream)
        self.contents, self.places, self.parts, self.damages = Contents(), [], [], []
        self.end, self.cut, self.descriptions, self.header_end = 0, True, [], 0
        self.header = b''
        self._last = self._before = self._part = self.cut_damage = None
        self._tail, self._indexes_follow = 0, False
        self._bad_descriptions = False
        self._chunk_bytes = self._chunk_messages = 0
        self._channel_sets, self._hints = {}, None
        position = self._head()
        while position is not None:
            position = self._record(position)
        self._settle(remake=self.cut)
        for part in self.parts:
            if isinstance(part, Whole):
                self.contents.merge(part.contents)
        self._describe()

    # -- what was found ---------------------------------------------------------------------------

    @property
    def mean_message(self):
        """See the class."""
        return self._chunk_bytes / self._chunk_messages if self._chunk_messages else 0.0

    @property
    def whole(self):
        """Whether nothing is to be mended."""
        return bool(self.in_place and not self.cut and len(self.parts) == 1
                    and tail_is_whole(self._stream, self.end) and self._data_end_is_right()
                    and self._as_told())

    @property
    def in_place(self):
        """Whether nothing of the data section has to move, only what follows it is missing."""
        return (not self.damages and not self.descriptions
                and all(isinstance(part, Whole) for part in self.parts[:1])
                and all(isinstance(part, Unindexed) for part in self.parts[1:2])
                and len(self.parts) <= 2)

    def _as_told(self):
        """Return whether the summary tells what was found, as far as there is one."""
        told = self.told
        if told is None:
            return True
        mine, theirs = self.contents, told.contents
        same = mine.counts == theirs.counts and self.places == told.places
        if not told.checked:
            same = (same and mine.channels == theirs.channels and mine.schemas == theirs.schemas
                    and (mine.start_time, mine.end_time) == (theirs.start_time, theirs.end_time)
                    and {index.chunk_start_offset: index for index in mine.each_chunk()}
                    == self._hint_table())
        return same

    def _data_end_is_right(self):
        content, found = self._bytes.read(self.end, HEAD.size + 4), 0
        if content[:HEAD.size] != HEAD.pack(Opcode.DATA_END, 4):
            return False
        checksum = int.from_bytes(content[HEAD.size:], 'little')
        for begin in range(0, self.end if checksum else 0, _BLOCK):
            found = zlib.crc32(self._bytes.read(begin, min(_BLOCK, self.end - begin)), found)
        return found == checksum

    def _hint_table(self):
        if self._hints is None:
            self._hints = chunk_indexes(self._stream) if self.told else {}
        return self._hints

    @property
    def _limit(self):
        """Where the data section ends at the latest."""
        return self.told.data_end if self.told else self._bytes.size

    def _channels(self):
        """Return the numbers of the channels known so far."""
        known = set(self.told.contents.channels) if self.told else set()
        for part in self.parts:
            if isinstance(part, Whole):
                known |= part.contents.channels.keys()
        return known | self.contents.channels.keys()

    # -- record by record -------------------------------------------------------------------------

    def _head(self):
        """Read magic and header; return where the next record is, None where there is none."""
        magic, size = self._bytes.read(0, len(MCAP0_MAGIC)), self._bytes.size
        begin = len(MCAP0_MAGIC)
        good = magic == MCAP0_MAGIC[:len(magic)]
        end = record_end(self._bytes, begin)
        has_header = end and self._bytes.read(begin, 1)[0] == Opcode.HEADER
        if not good and not has_header and not (self.told and self.told.checked):
            raise InvalidMagic(magic)
        if good and has_header:
            self._keep(0, end)
            self.end = self.header_end = end
            return end
        following = end or next_record(self._bytes, begin, size, None)
        if following == size and not self.told:
            return None                     # cut in its very head: an empty one
        self.damages.append(Damage(0, lost=0))
        if has_header:
            self.header = self._bytes.read(begin, end - begin)
        self._bad_descriptions, self.end = True, following
        return following

    def _record(self, offset):
        """Take the next record; return where the one behind it is, None where the data ends."""
        told = self.told
        if told and offset == told.data_end:
            self.end, self.cut = offset, False
            return None
        head = self._bytes.read(offset, HEAD.size + 6)
        if len(head) < HEAD.size:
            self._cut_at(offset, 0)
            return None
        opcode = head[0]
        end = record_end(self._bytes, offset)
        if self._tail or (end and opcode in SUMMARY):
            return self._behind_data(offset, end, opcode)
        if not end:
            return self._damaged(offset)
        if opcode == Opcode.CHUNK:
            return self._chunk(offset, end)
        if opcode == Opcode.MESSAGE_INDEX:
            return self._index(offset, end)
        if opcode == MESSAGE:
            return self._message(offset, end)
        if not (opcode in SELF_DELIMITING or follows(self._bytes, end, None, 1)):
            return self._damaged(offset)
        self._settle()
        self._indexes_follow = False
        content = self._bytes.read(offset + HEAD.size,
                                   min(end - offset - HEAD.size, _ATTACHMENT_START
                                       if opcode == Opcode.ATTACHMENT else LARGEST_RECORD))
        try:
            if not self._other(opcode, content, offset, end):
                return end
        except Damaged:
            return self._damaged(offset)
        self.end = end
        return end

    def _other(self, opcode, content, offset, end):
        """Keep a record that is no chunk, message or index; return whether it is one to keep."""
        told = self.told
        if opcode in DESCRIPTIONS and told and told.checked:
            record = of_bytes(DESCRIPTIONS[opcode], content)
            if _among(told.contents, record) != record:
                self._drop()
                self._bad_descriptions = True
                self.damages.append(Damage(0, lost=0))
                return False
        contents = self._keep(offset, end)
        if opcode == Opcode.METADATA:
            contents.add_metadata(offset, end - offset, of_bytes(Metadata, content).name)
        elif opcode == Opcode.ATTACHMENT:
            contents.attachment_indexes.append(attachment_index(offset, end - offset, content))
        elif opcode in DESCRIPTIONS:
            contents.describe(opcode, content)
        return True

    def _chunk(self, offset, end):
        self._settle()
        try:
            chunk = of_bytes(Chunk, self._bytes.read(offset + HEAD.size,
                                                     end - offset - HEAD.size))
            records = records_of(chunk)
            found = FoundChunk(chunk, offset, end - offset, records)
            for opcode, begin, stop in found.others:
                self.contents.describe(opcode, records[begin:stop])
        except (Damaged, UnsupportedCompressionError) as error:
            return self._damaged(offset, error)
        times = found.times
        if found.counts and (chunk.message_start_time, chunk.message_end_time) != (
                int(times.min()), int(times.max())):
            return self._damaged(offset)
        contents = self._keep(offset, end)
        for opcode, begin, stop in found.others:
            contents.describe(opcode, records[begin:stop])
        if found.counts:
            contents.add_messages(found.counts, int(times.min()), int(times.max()))
            self._last = found
            self._chunk_bytes += len(records)
            self._chunk_messages += len(found.offsets)
            for damage in self.damages[-1:]:
                damage.after = damage.after or found
        self._indexes_follow, self.end = True, end
        return end

    def _index(self, offset, end):
        if self._last is None:          # of a damaged chunk, whose index is made anew
            self._drop()
        else:
            self._last.takes_index(offset, self._bytes.read(offset + HEAD.size,
                                                            end - offset - HEAD.size))
            self._keep(offset, end)
        self.end = end
        return end

    def _message(self, offset, end):
        """Take a message outside of the chunks."""
        record = self._bytes.read(offset, end - offset)
        if self._indexes_follow and is_message_index(record, end - offset - HEAD.size):
            return self._damaged(offset)        # an index with a wrong opcode
        if not follows(self._bytes, end, None, 1) and not self._damage_begins(offset, end):
            return self._damaged(offset)
        head = heads(record[:HEADS.itemsize], np.zeros(1, int))[0]
        if int(head['channel']) not in self._known_channels():
            return self._damaged(offset)
        self._settle()
        time = int(head['log_time'])
        contents = self.contents
        if self.damages and self._chunk_messages:
            self._keep_loose(offset, end)
        else:
            contents = self._keep(offset, end)
        contents.add_messages({int(head['channel']): 1}, time, time)
        self.end = end
        return end

    def _damage_begins(self, offset, end):
        """Return whether it is the record at `end` that is damaged, not the message before it."""
        if self._bytes.size - end < HEAD.size:
            return True                 # the file is cut there
        following = next_record(self._bytes, offset + 1, self._limit, self._known_channels())
        opcode, length = HEAD.unpack(self._bytes.read(end, HEAD.size))
        return following > end and (
            opcode == MESSAGE or following == end + HEAD.size + length
            or (opcode, length) == (Opcode.DATA_END, _DATA_END_SIZE))     # the file is cut in it

    def _known_channels(self):
        part = self._part.contents.channels if self._part else ()
        return part or self._channels()

    def _behind_data(self, offset, end, opcode):
        """Take a record of the summary; what follows may still be of the data section."""
        if not self._tail:
            self._settle()
            self._tail = self.end = offset
            self.cut = opcode != Opcode.DATA_END
        size = self._bytes.size
        if end and (opcode == Opcode.CHUNK or (
                opcode == MESSAGE and record_end(self._bytes, offset, self._channels()))):
            self.damages.append(Damage(0, lost=0))
            self._drop()
            self._tail, self.cut = 0, True
            return offset
        if end >= size - len(MCAP0_MAGIC):
            return None
        if not end:
            end = next_record(self._bytes, offset + 1, size, self._channels())
        return end if end < size else None

    # -- damage -----------------------------------------------------------------------------------

    def _damaged(self, offset, error=None):
        """Take what can be read of a damaged record; return where the next one is."""
        source, limit = self._bytes, self._limit
        opcode, length = HEAD.unpack(source.read(offset, HEAD.size))
        hint = self._hint_table().get(offset)
        is_index = self._indexes_follow and (
            opcode == Opcode.MESSAGE_INDEX
            or is_message_index(source.read(offset, HEAD.size + 6), length))
        self._indexes_follow = False
        self._settle(remake=True)
        rescued = rescue(source, offset, hint)
        if rescued is not None and (len(rescued.offsets) or rescued.others):
            self._rescued(offset, hint, rescued)
            return rescued.end
        if isinstance(error, UnsupportedCompressionError):
            raise error
        if opcode == Opcode.CHUNK and chunk_end(source, offset, may_be_cut=True) > source.size:
            self._cut_at(offset, opcode)
            return None
        replaced = not is_index and self._replaced(offset, opcode, length)
        if replaced:
            return replaced
        known = self._channels() or None
        following = offset + HEAD.size + length
        if is_index:
            # its array has a length of its own: the wrong one of the two may swallow a chunk
            entries = index_end(source, offset)
            if follows(source, entries, known) and not (
                    entries > following and follows(source, following, known)):
                following = entries
        if hint is not None:
            following = offset + hint.chunk_length
        if not (offset < following <= limit and follows(source, following, known)):
            stop = min((place for place in self._hint_table() if place > offset), default=limit)
            following = next_record(source, offset + 1, min(stop, limit), known)
        if following >= source.size:
            self._cut_at(offset, opcode)
            return None
        if opcode == MESSAGE and self._with_length(offset, following):
            return following
        damage = Damage(following - offset)
        if is_index:
            damage.lost_bytes = damage.lost = 0
            self._indexes_follow = True
        elif rescued is not None:
            damage.claimed = rescued.claimed if rescued.claimed <= LARGEST_CHUNK else 0
            damage.until = rescued.span[1]
            if rescued.expected is not None:
                damage.lost = sum(rescued.expected.values())
        damage.before = self._before
        self.damages.append(damage)
        self._drop()
        self.end = following
        return following

    def _rescued(self, offset, hint, rescued, cut=False):
        found = heads(rescued.records, rescued.offsets)
        numbers, counts = np.unique(found['channel'], return_counts=True)
        kept = dict(zip(numbers.tolist(), counts.tolist(), strict=True))
        for opcode, begin, end in rescued.others:
            if opcode in DESCRIPTIONS:
                record, size = parsed(DESCRIPTIONS[opcode], rescued.records[begin:end])
                # the chunk is written without those of which bytes may be wrong
                self._bad_descriptions |= not rescued.sure
                if record and size == end - begin:
                    self.contents.note(record)
        if kept:
            self.contents.add_messages(kept, int(found['log_time'].min()),
                                       int(found['log_time'].max()))
            self._chunk_bytes += len(rescued.records)
            self._chunk_messages += len(found)
        damage = Damage(0, kept=len(found), before=self._before)
        if rescued.sure:
            damage.lost = 0
        elif rescued.expected is not None:
            damage.lost = sum(rescued.expected.values()) - len(found)
        elif rescued.claimed <= LARGEST_CHUNK:
            damage.claimed = max(0, rescued.claimed - len(rescued.records))
        if not rescued.sure and not cut:
            damage.doubtful = len(found)
        damage.until = rescued.span[1]
        self.damages.append(damage)
        self.parts.append(Broken(offset, hint, cut))
        self._drop()
        self._indexes_follow = True
        self.end = rescued.end

    def _replaced(self, offset, opcode, length):
        """Put a record with another head in place of one whose head alone is wrong, if it is so.

        Returns where the next record is, 0 if it is not so.
        """
        source = self._bytes
        content = source.read(offset + HEAD.size,
                              min(_LONGEST_DESCRIPTION, source.size - offset - HEAD.size))
        for kind, kind_of_record in SELF_DELIMITING.items():
            record, size = parsed(kind_of_record, content)
            end = offset + HEAD.size + size
            if record and kind != Opcode.HEADER and (size == length or kind == opcode) and (
                    follows(source, end, None, 2)):
                break
        else:
            end = offset + HEAD.size + length
            return end if (MESSAGE_FIXED <= length <= len(content)
                           and follows(source, end, None, 2)
                           and self._with_length(offset, end)) else 0
        self.damages.append(Damage(0, lost=0))
        self._drop()
        if kind in DESCRIPTIONS:
            self.contents.note(record)
            self._bad_descriptions = True
        else:
            self.parts.append(Replaced(to_bytes(record)))
        self.end = end
        return end

    def _with_length(self, offset, end):
        """Put a message that ends at `end` in place of a record; return if it can be one."""
        record = self._bytes.read(offset, min(end - offset, LARGEST_RECORD))
        length, channel = len(record) - HEAD.size, int.from_bytes(record[9:11], 'little')
        if length < MESSAGE_FIXED or channel not in self._channels():
            return False
        data = HEAD.pack(MESSAGE, length) + record[HEAD.size:]
        time = int(heads(data[:HEADS.itemsize], np.zeros(1, int))[0]['log_time'])
        known = [one for one in (self._part, self.told) if one] or [self]
        if any(one.contents.counts and abs(time - one.contents.end_time) > _FAR for one in known):
            return False
        self.contents.add_messages({channel: 1}, time, time)
        self.damages.append(Damage(0, lost=0))
        self._drop()
        self.parts.append(Replaced(data))
        self.end = end
        return True

    def _cut_at(self, offset, opcode):
        """Take what there is of the record in which the file is cut."""
        self._settle(remake=True)
        rest = self._bytes.size - offset
        self.end = offset
        if opcode == Opcode.MESSAGE_INDEX or rest == 0:
            return
        rescued = rescue(self._bytes, offset, cut=True)
        if rescued is not None:
            if len(rescued.offsets):
                self._rescued(offset, None, rescued, cut=True)
                self.damages[-1].lost_bytes = 0 if rescued.sure else rest
                return
            damage = Damage(rest, before=self._before, until=rescued.span[1])
            if rescued.claimed <= LARGEST_CHUNK:
                damage.claimed = rescued.claimed
        else:
            damage = Damage(rest, before=self._before)
        self.cut_damage = damage

    # -- parts ------------------------------------------------------------------------------------

    def _keep(self, begin, end):
        """Keep bytes as they are; return the Contents of the part they belong to."""
        if self._part is None:
            self._part = Whole(begin, end)
            self.parts.append(self._part)
        self._part.end = end
        return self._part.contents

    def _keep_loose(self, begin, end):
        last = self.parts[-1] if self.parts else None
        if isinstance(last, Loose) and last.end == begin and end - last.begin < _BLOCK:
            last.end = end
        else:
            self._drop()
            self.parts.append(Loose(begin, end))

    def _drop(self):
        """Begin another part behind bytes that are not kept."""
        self._part = None

    def _settle(self, remake=False):
        """Note the last chunk, whose message indexes are all read.

        They are made anew if they are not those of its messages; with `remake`, also if there are
        none, as some writers leave them out.
        """
        found, self._last = self._last, None
        if found is None:
            return
        self._before = found
        complete = set(found.index_places) == set(found.counts) and not found.index_wrong
        if not found.index_length and not remake:
            hint = self._hint_table().get(found.offset) if self.told else None
            complete = hint is None or not hint.message_index_offsets
        if complete:
            index = found.index()
            self._part.contents.add_chunk(index)
            self.places.append(place_of(index, self._channel_sets))
            return
        self._part.end = found.end
        self.parts.append(Unindexed(found.offset))
        self._drop()

    def _describe(self):
        """Complete the schemas and channels by what the summary tells, or by elimination."""
        contents, told = self.contents, self.told
        if told:
            for record in (*told.contents.schemas.values(), *told.contents.channels.values()):
                if told.checked or _among(contents, record) is None:
                    self._bad_descriptions |= _among(contents, record) != record
                    contents.note(record)
        channels, schemas = contents.channels, contents.schemas
        self._bad_descriptions |= _pair(channels, set(contents.counts))
        self._bad_descriptions |= _pair(schemas, {channel.schema_id for channel
                                                  in channels.values()} - {0})
        for number in {channel.schema_id for channel in channels.values()} - {0, *schemas}:
            self._bad_descriptions = True
            schemas[number] = dataclasses.replace(_UNKNOWN, id=number)
        for number in sorted(set(contents.counts) - set(channels)):
            self._bad_descriptions = True
            schema = dataclasses.replace(_UNKNOWN, id=max(schemas, default=0) + 1)
            schemas[schema.id] = schema
            channels[number] = Channel(id=number, message_encoding='', metadata={},
                                       schema_id=schema.id, topic=f'/unknown_{number}')
        if self._bad_descriptions:
            self.descriptions = [*schemas.values(), *channels.values()]


def _among(contents, record):
    """Return the schema or channel with the same number, or None."""
    found = contents.schemas if isinstance(record, Schema) else contents.channels
    return found.get(record.id)


def _pair(records, needed):
    """Copy the only record that nobody needs to the only number that is missing; return if so."""
    missing, spare = needed - set(records), set(records) - needed
    if not (len(missing) == len(spare) == 1):
        return False
    number = missing.pop()
    records[number] = dataclasses.replace(records[spare.pop()], id=number)
    return True
