# SPDX-License-Identifier: Apache-2.0
"""The findings of a scan of an MCAP file: parts, contents, damages, descriptions.

Why not the library: it keeps the places of what its index names, and no others.
"""

import dataclasses
import zlib

from mcap.opcode import Opcode
from mcap.records import Channel, Schema

from rigid_body_sim.recording.mcap.bytes import FileBytes
from rigid_body_sim.recording.mcap.contents import Contents
from rigid_body_sim.recording.mcap.found import Loose, Unindexed, Whole
from rigid_body_sim.recording.mcap.records import HEAD
from rigid_body_sim.recording.mcap.summary import chunk_indexes, place_of, read_told, tail_is_whole

BLOCK = 2**22    # bytes that are read or kept at a time
_UNKNOWN = Schema(data=b'', encoding='', id=0, name='unknown')


class Findings:
    """Everything found in a file so far.

    Attributes
    ----------
    contents : Contents
        All that is whole or could be rescued; its indexes are those of the whole parts only.
    places : list of ChunkPlace
        Places of the chunks that are whole.
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
        To be written after the head, because those in the file are damaged or missing.
    header : bytes
        The record at the head, where what is before or after it is damaged; else empty.
    header_end : int
        Where it ends in a file with a whole head.
    cut_damage : Damage or None
        The record in which the file is cut, if it was more than a message index.
    mean_message : float
        Mean size of a message in the chunks, record head included; 0.0 without chunks.
    """

    def __init__(self, stream):
        self._stream = stream
        self._bytes = FileBytes(stream.fileno())
        self.told = read_told(stream)
        self.contents, self.places, self.parts, self.damages = Contents(), [], [], []
        self.end, self.cut, self.descriptions, self.header_end = 0, True, [], 0
        self.header = b''
        self._last = self._before = self._part = self.cut_damage = None
        self._bad_descriptions = False
        self._chunk_bytes = self._chunk_messages = 0
        self._channel_sets, self._hints = {}, None

    @property
    def mean_message(self):
        """See the class."""
        return self._chunk_bytes / self._chunk_messages if self._chunk_messages else 0.0

    @property
    def whole(self):
        """Whether nothing needs mending."""
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
        for begin in range(0, self.end if checksum else 0, BLOCK):
            found = zlib.crc32(self._bytes.read(begin, min(BLOCK, self.end - begin)), found)
        return found == checksum

    def _hint_table(self):
        if self._hints is None:
            self._hints = chunk_indexes(self._stream)
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

    def _keep(self, begin, end):
        """Keep bytes as they are; return the Contents of the part they belong to."""
        if self._part is None:
            self._part = Whole(begin, end)
            self.parts.append(self._part)
        self._part.end = end
        return self._part.contents

    def _keep_loose(self, begin, end):
        last = self.parts[-1] if self.parts else None
        if isinstance(last, Loose) and last.end == begin and end - last.begin < BLOCK:
            last.end = end
        else:
            self._drop()
            self.parts.append(Loose(begin, end))

    def _drop(self):
        """Begin another part after bytes that are not kept."""
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
                if told.checked or among(contents, record) is None:
                    self._bad_descriptions |= among(contents, record) != record
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


def among(contents, record):
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
