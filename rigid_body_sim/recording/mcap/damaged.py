# SPDX-License-Identifier: Apache-2.0
"""The damaged records of an MCAP file: rescued, replaced, or left out.

Why not the library: it ends at a record that is damaged.
"""

import numpy as np
from mcap.exceptions import UnsupportedCompressionError
from mcap.opcode import Opcode

from rigid_body_sim.recording.mcap.compression import LARGEST_CHUNK
from rigid_body_sim.recording.mcap.contents import DESCRIPTIONS
from rigid_body_sim.recording.mcap.findings import Findings
from rigid_body_sim.recording.mcap.forms import (
    SELF_DELIMITING,
    chunk_end,
    follows,
    index_end,
    is_message_index,
    next_record,
    parsed,
)
from rigid_body_sim.recording.mcap.found import Broken, Damage, Replaced
from rigid_body_sim.recording.mcap.records import HEAD, to_bytes
from rigid_body_sim.recording.mcap.rescue import rescue
from rigid_body_sim.recording.mcap.walk import HEADS, MESSAGE, MESSAGE_FIXED, heads

LARGEST_RECORD = LARGEST_CHUNK + 2**16
_LONGEST_DESCRIPTION = 2**20    # bytes of a damaged schema, channel, header or metadata record
_FAR = 10**12                   # ns of log time beyond which a message is not believed


class DamagedRecords(Findings):
    """Findings that grow by what can be read of a damaged record."""

    def __init__(self, stream):
        super().__init__(stream)
        self._indexes_follow = False    # whether message indexes may stand here

    def _damaged(self, offset, error=None):
        """Take what can be read of a damaged record; return where the next one is."""
        source = self._bytes
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
        following = self._following(offset, length, hint, is_index)
        if following >= source.size:
            self._cut_at(offset, opcode)
            return None
        if opcode == MESSAGE and not is_index and self._with_length(offset, following):
            return following
        self.damages.append(self._lost(following - offset, is_index, rescued))
        self._indexes_follow = is_index
        self._drop()
        self.end = following
        return following

    def _lost(self, size, is_index, rescued):
        """Return the Damage of a record of which nothing is kept."""
        damage = Damage(size, before=self._before)
        if is_index:
            damage.lost_bytes = damage.lost = 0
        elif rescued is not None:
            damage.claimed = rescued.claimed if rescued.claimed <= LARGEST_CHUNK else 0
            damage.until = rescued.span[1]
            if rescued.expected is not None:
                damage.lost = sum(rescued.expected.values())
        return damage

    def _following(self, offset, length, hint, is_index):
        """Return where the record after a damaged one is; the file's size where there is none."""
        source, limit = self._bytes, self._limit
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
        """Replace a record if its head alone is wrong, by one with another head.

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
