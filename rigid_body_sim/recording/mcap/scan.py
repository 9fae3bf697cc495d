# SPDX-License-Identifier: Apache-2.0
"""The true contents of an MCAP file, from its first byte on, whichever program wrote it.

For files that are cut, damaged or without a summary. Why not `mcap.stream_reader.StreamReader`: it
does not say where a record begins, and it ends at the first one that is cut or damaged. Here what
is damaged is read by what else tells of it (damaged.py, rescue.py), or left out, and the next
whole record after it is found (forms.py).
"""

import numpy as np
from mcap.exceptions import InvalidMagic, UnsupportedCompressionError
from mcap.opcode import Opcode
from mcap.records import Chunk, Metadata
from mcap.writer import MCAP0_MAGIC

from rigid_body_sim.recording.mcap.compression import records_of
from rigid_body_sim.recording.mcap.contents import DESCRIPTIONS
from rigid_body_sim.recording.mcap.damaged import LARGEST_RECORD, DamagedRecords
from rigid_body_sim.recording.mcap.findings import among
from rigid_body_sim.recording.mcap.forms import (
    SELF_DELIMITING,
    SUMMARY,
    follows,
    is_message_index,
    next_record,
    record_end,
)
from rigid_body_sim.recording.mcap.found import Damage, FoundChunk, Whole
from rigid_body_sim.recording.mcap.records import HEAD, Damaged, attachment_index, of_bytes
from rigid_body_sim.recording.mcap.walk import HEADS, MESSAGE, heads

_ATTACHMENT_START = 2**16       # bytes of an attachment that are read: its data is not needed
_DATA_END_SIZE = 4     # bytes of its content


def check_magic(stream):
    """Read what an MCAP file begins with; InvalidMagic if another one does.

    A file that is cut in there counts as one.
    """
    magic = stream.read(len(MCAP0_MAGIC))
    if magic != MCAP0_MAGIC[:len(magic)]:
        raise InvalidMagic(magic)


class Scan(DamagedRecords):
    """Everything found in a file (findings.py), from its first record to its last.

    Raises
    ------
    mcap.exceptions.InvalidMagic
        Where the file is no MCAP file.
    mcap.exceptions.UnsupportedCompressionError
        Where its chunks cannot be read here.
    """

    def __init__(self, stream):
        super().__init__(stream)
        self._tail = 0    # where records of the summary begin that are no longer of the data
        position = self._head()
        while position is not None:
            position = self._record(position)
        self._settle(remake=self.cut)
        for part in self.parts:
            if isinstance(part, Whole):
                self.contents.merge(part.contents)
        self._describe()

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
        first = min(self._hint_table(), default=size)    # a chunk begins there, whole or not
        following = end or next_record(self._bytes, begin, first, None)
        if following == size and not self.told:
            return None                     # cut in its very head: an empty one
        sure = bool(end or self._hint_table())    # no chunk is left out
        self.damages.append(Damage(0 if sure else following - begin, lost=0 if sure else None))
        if has_header:
            self.header = self._bytes.read(begin, end - begin)
        self._bad_descriptions, self.end = True, following
        return following

    def _record(self, offset):
        """Take the next record; return where the one after it is, None where the data ends."""
        told = self.told
        if told and offset == told.data_end:
            self.end, self.cut = offset, False
            return None
        head = self._bytes.read(offset, HEAD.size)
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
            if among(told.contents, record) != record:
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
        if self._last is None:          # the chunk is damaged, and its index is made anew
            self._drop()
        else:
            self._last.takes_index(offset, self._bytes.read(offset + HEAD.size,
                                                            end - offset - HEAD.size))
            self._keep(offset, end)
        self.end = end
        return end

    def _message(self, offset, end):
        """Take a message outside of the chunks."""
        record = self._bytes.read(offset, HEADS.itemsize)
        if self._indexes_follow and is_message_index(record, end - offset - HEAD.size):
            return self._damaged(offset)        # an index with a wrong opcode
        if not follows(self._bytes, end, None, 1) and not self._damage_begins(offset, end):
            return self._damaged(offset)
        head = heads(record, np.zeros(1, int))[0]
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
