# SPDX-License-Identifier: Apache-2.0
"""What a scan takes each record for, and what it notes of it."""

import tempfile
import types

import pytest
from mcap.exceptions import InvalidMagic
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    Chunk,
    DataEnd,
    Header,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
)
from mcap.writer import MCAP0_MAGIC as MAGIC

from rigid_body_sim.recording.mcap.chunks import message
from rigid_body_sim.recording.mcap.contents import Contents
from rigid_body_sim.recording.mcap.damaged import DamagedRecords
from rigid_body_sim.recording.mcap.found import Damage, Loose, Unindexed, Whole
from rigid_body_sim.recording.mcap.records import HEAD, to_bytes
from rigid_body_sim.recording.mcap.scan import Scan, check_magic

SCHEMA, CHANNEL = Schema(1, b'float64 data', 'ros2msg', 'a/B'), Channel(1, '/a', 'cdr', {}, 1)
HEADER = to_bytes(Header('theirs', 'ros2'))
MESSAGE = message(1, 5, 10, 11, b'data')    # 35 bytes
LIKE_INDEX = message(1, 16, 10, 11, b'')    # 22 bytes: an index of one entry says 16 there
PRIVATE = HEAD.pack(0x80, 3) + b'own'
JUNK = 20 * b'\xff'
END = to_bytes(DataEnd(0))
AT = len(JUNK)


def told(*records, checked=True, data_end=10**6):
    contents = Contents()
    for record in records:
        contents.note(record)
    return types.SimpleNamespace(contents=contents, checked=checked, data_end=data_end)


def begun(content, of_summary=None, hints=()):
    """Return the Scan of a file before it has begun; of its channels it knows number 1."""
    stream = tempfile.TemporaryFile()    # noqa: SIM115, it is read later on
    stream.write(content)
    stream.flush()
    one = Scan.__new__(Scan)
    DamagedRecords.__init__(one, stream)
    one._tail, one.told, one._hints = 0, of_summary, dict.fromkeys(hints)
    one.contents.note(CHANNEL)
    return one


def scanned(content):
    with tempfile.TemporaryFile() as stream:
        stream.write(content)
        stream.flush()
        return Scan(stream)


def chunk(*records, times=(5, 9), compression=''):
    data = b''.join(records)
    return to_bytes(Chunk(compression, data, times[1], times[0], 0, len(data)))


TIMED = [message(1, k, time, 0, b'four') for k, time in enumerate((7, 5, 9))]
INDEX = HEAD.pack(Opcode.MESSAGE_INDEX, 54) + b'\1\0' + (48).to_bytes(4, 'little') + b''.join(
    number.to_bytes(8, 'little') for number in (7, 0, 5, 35, 9, 70))


@pytest.mark.parametrize(('content', 'good'), [
    (MAGIC, True), (MAGIC + b'more', True), (MAGIC[:3], True), (b'', True),
    (b'\x88' + MAGIC[1:], False), (MAGIC[:3] + b'X', False)])
def test_a_file_begins_with_the_magic_or_is_cut_in_it(content, good):
    with tempfile.TemporaryFile() as stream:
        stream.write(content)
        stream.seek(0)
        if good:
            check_magic(stream)
        else:
            with pytest.raises(InvalidMagic):
                check_magic(stream)


BEGIN = len(MAGIC)
FIRST = BEGIN + len(HEADER)
REST = to_bytes(SCHEMA) + 3 * MESSAGE
WRONG, LONGER = b'\x88' + MAGIC[1:], HEADER[:1] + b'\xff' + HEADER[2:]
HEADLESS = b'\x7f' + HEADER[1:]
HEADS = {
    # content, summary, chunks that it names; where the next record is, what is damaged, the header
    'whole': (MAGIC + HEADER + REST, None, (), FIRST, [], b''),
    'the magic is wrong': (WRONG + HEADER + REST, None, (), FIRST, [Damage(0, lost=0)], HEADER),
    'the opcode is wrong': (MAGIC + HEADLESS + REST, None, (), FIRST, [Damage(0, lost=0)], b''),
    'the length is wrong': (MAGIC + LONGER + REST, None, (), FIRST, [Damage(len(HEADER))], b''),
    'but chunks are known': (MAGIC + LONGER + REST, told(), (400, 500), FIRST,
                             [Damage(0, lost=0)], b''),
    'up to the first chunk': (MAGIC + LONGER + JUNK + REST, told(), (FIRST + 3, FIRST + 9),
                              FIRST + 3, [Damage(0, lost=0)], b''),
    'nothing but a sure summary': (WRONG + JUNK + REST, told(), (), BEGIN + AT, [Damage(AT)], b''),
    'nothing at all but a summary': (MAGIC + JUNK, told(checked=False), (), BEGIN + AT,
                                     [Damage(AT)], b'')}


@pytest.mark.parametrize('case', HEADS)
def test_the_data_begins_behind_the_header_or_where_the_next_record_is(case):
    content, of_summary, hints, first, damages, header = HEADS[case]
    one = begun(content, of_summary, hints)
    assert (one._head(), one.end, one.damages, one.header) == (first, first, damages, header)
    assert one.header_end == (0 if damages else first)
    assert one._bad_descriptions == bool(damages)
    assert [(part.begin, part.end) for part in one.parts] == ([] if damages else [(0, first)])


@pytest.mark.parametrize('content', [b'', MAGIC[:4], MAGIC, MAGIC + HEADER[:-1]])
def test_a_file_that_is_cut_in_its_head_is_an_empty_one(content):
    one = scanned(content)
    assert (one.end, one.header_end, one.parts, one.damages, one.cut) == (0, 0, [], [], True)


@pytest.mark.parametrize('of_summary', [None, told(checked=False)])
def test_without_magic_and_header_only_a_sure_summary_tells_that_it_is_a_file(of_summary):
    with pytest.raises(InvalidMagic):
        begun(WRONG + JUNK + REST, of_summary)._head()


def test_the_data_ends_where_the_summary_says():
    one = begun(JUNK + 3 * MESSAGE, told(data_end=AT + 35))
    assert one._record(AT) == AT + 35 and one.cut
    assert one._record(AT + 35) is None
    assert (one.end, one.cut) == (AT + 35, False)


@pytest.mark.parametrize('rest', [0, 1, 8])
def test_a_file_is_cut_in_the_head_of_a_record(rest):
    one = begun(JUNK + PRIVATE[:rest])
    assert one._record(AT) is None
    assert (one.end, one.cut) == (AT, True)
    assert one.cut_damage == (Damage(rest) if rest else None)


@pytest.mark.parametrize(('behind', 'good'), [
    (b'', True), (END + JUNK, True), (HEAD.pack(0x80, 0), True), (JUNK, False)])
def test_a_private_record_is_one_if_another_follows_or_the_file_ends(behind, good):
    one = begun(JUNK + PRIVATE + behind)
    assert one._record(AT) == (AT + len(PRIVATE) if good else None)
    assert len(one.parts) == good
    if good:
        assert one.end == one.parts[0].end == AT + len(PRIVATE)


def test_behind_another_record_no_message_is_taken_for_an_index():
    one = begun(JUNK + PRIVATE + LIKE_INDEX)
    one._indexes_follow = True
    assert one._record(one._record(AT)) == AT + len(PRIVATE + LIKE_INDEX)
    assert one.contents.counts == {} and one._part.contents.counts == {1: 1}


@pytest.mark.parametrize(('name', 'size'), [('a' * 40_000, 9), ('a', 9), ('a', 100_000)])
def test_an_attachment_is_noted_without_reading_its_data(name, size, monkeypatch):
    record = to_bytes(Attachment(
        create_time=6, log_time=7, name=name, media_type='text/plain', data=bytes(size)))
    one, asked = begun(JUNK + record + END), []
    read = one._bytes.read

    def noted(offset, length):
        asked.append(length)
        return read(offset, length)
    monkeypatch.setattr(one._bytes, 'read', noted)
    assert one._record(AT) == one.end == AT + len(record)
    [index] = one._part.contents.attachment_indexes
    assert index == AttachmentIndex(AT, len(record), 7, 6, size, name, 'text/plain')
    assert max(asked) == min(len(record) - HEAD.size, 2**16)


def test_metadata_is_noted():
    record = to_bytes(Metadata('name', {'a': 'b'}))
    one = begun(JUNK + record + JUNK)
    assert one._record(AT) == one.end == AT + len(record)
    assert one._part.contents.metadata_indexes == [MetadataIndex(AT, len(record), 'name')]
    assert not one._part.contents.attachment_indexes


@pytest.mark.parametrize(('of_summary', 'kept'), [
    (None, True), (told(SCHEMA), True), (told(Schema(1, b'', '', 'other'), checked=False), True),
    (told(Schema(1, b'', '', 'other')), False), (told(), False)])
def test_a_description_is_kept_unless_a_sure_summary_says_otherwise(of_summary, kept):
    record = to_bytes(SCHEMA)
    one = begun(JUNK + record + JUNK, of_summary)
    assert one._record(AT) == AT + len(record)
    assert one._bad_descriptions != kept
    assert one.damages == ([] if kept else [Damage(0, lost=0)])
    assert [part.contents.schemas for part in one.parts] == ([{1: SCHEMA}] if kept else [])
    assert one.end == (AT + len(record) if kept else 0)


def test_a_chunk_is_kept_with_its_messages_and_descriptions_and_ends_the_last_damage():
    whole = chunk(to_bytes(SCHEMA), *TIMED)
    one = begun(JUNK + whole + INDEX + JUNK)
    one.damages = [Damage(1), Damage(2), Damage(3)]
    end = AT + len(whole)
    assert one._record(AT) == one.end == end and one._indexes_follow
    contents = one._part.contents
    assert (contents.counts, contents.start_time, contents.end_time) == ({1: 3}, 5, 9)
    assert contents.schemas == one.contents.schemas == {1: SCHEMA}
    assert one.mean_message == (len(to_bytes(SCHEMA)) + 3 * 35) / 3
    assert [damage.after for damage in one.damages] == [None, None, one._last]
    earlier = one._last
    assert (earlier.offset, earlier.end) == (AT, end)
    assert one._chunk(AT, end) == end
    assert one.damages[-1].after is earlier is not one._last


@pytest.mark.parametrize('times', [(5, 9), (4, 9), (5, 10), (9, 9), (5, 5)])
def test_a_chunk_without_checksum_is_whole_if_its_times_are_those_of_its_messages(times):
    one = begun(JUNK + chunk(*TIMED, times=times) + INDEX)
    one._record(AT)
    assert [type(part) is Whole for part in one.parts] == [times == (5, 9)]


def test_a_chunk_without_messages_may_say_any_times():
    one = begun(JUNK + chunk(to_bytes(SCHEMA)))
    assert one._record(AT) == one.end
    assert one._part.contents.counts == {} and one._last is None and not one.damages


def test_the_index_of_a_chunk_is_kept_and_that_of_a_damaged_one_is_not():
    one = begun(JUNK + chunk(*TIMED) + INDEX)
    place = one._record(AT)
    assert one._record(place) == one.end == one._part.end == place + len(INDEX)
    assert one._last.index_places == {1: place} and not one._last.index_wrong
    one._last = None
    assert one._record(place) == place + len(INDEX)
    assert one._part is None and len(one.parts) == 1


@pytest.mark.parametrize(('follow', 'record', 'good'), [
    (True, LIKE_INDEX, False), (False, LIKE_INDEX, True), (True, MESSAGE, True)])
def test_where_indexes_may_stand_a_message_in_the_form_of_one_is_one(follow, record, good):
    one = begun(JUNK + record + END)
    one._indexes_follow = follow
    assert one._record(AT) == one.end == AT + len(record)
    assert one.damages == ([] if good else [Damage(0, lost=0)])
    assert [part.contents.counts for part in one.parts] == ([{1: 1}] if good else [])


@pytest.mark.parametrize(('behind', 'good'), [
    (b'', True), (PRIVATE + JUNK, True), (JUNK, False)])
def test_a_message_is_one_if_a_record_follows_or_the_file_ends(behind, good):
    one = begun(JUNK + MESSAGE + behind)
    assert one._record(AT) == (AT + 35 if good else None)
    assert [part.contents.counts for part in one.parts] == ([{1: 1}] if good else [])


@pytest.mark.parametrize('of_damages', [0, 1])
@pytest.mark.parametrize('in_chunks', [0, 3])
def test_messages_behind_a_damage_are_loose_ones_where_others_are_in_chunks(of_damages, in_chunks):
    one = begun(JUNK + MESSAGE + JUNK[:5])
    one.damages, one._chunk_messages = of_damages * [Damage(1)], in_chunks
    assert one._record(AT) == one.end == AT + 35
    loose = bool(of_damages and in_chunks)
    contents = one.contents if loose else one._part.contents
    assert (contents.counts, contents.start_time, contents.end_time) == ({1: 1}, 10, 10)
    assert [type(part) for part in one.parts] == [Loose if loose else Whole]


@pytest.mark.parametrize(('of_part', 'number', 'good'), [
    ((), 1, True), ((), 2, True), ((), 3, False), ((4,), 4, True), ((4,), 1, False)])
def test_a_message_is_on_a_channel_of_its_part_or_of_what_is_known(of_part, number, good):
    record = message(number, 5, 10, 11, b'data')
    one = begun(JUNK + record + 3 * MESSAGE, told(Channel(2, '/b', 'cdr', {}, 1)))
    contents = one._keep(0, AT)
    for known in of_part:
        contents.note(Channel(known, '/c', 'cdr', {}, 1))
    assert one._record(AT) == AT + 35
    assert contents.counts == ({number: 1} if good else {})


LONG = HEAD.pack(Opcode.MESSAGE, 10**9)
DAMAGED = {
    # what is behind a message; whether it is that which is damaged
    'the file is cut in a head': (JUNK[:8], True),
    'a head that says nothing': (HEAD.pack(0x7f, 7), False),
    'a message of another length': (LONG + 3 * MESSAGE, True),
    'a record whose opcode is wrong': (HEAD.pack(0, 4) + b'four' + 3 * MESSAGE, True),
    'and whose length is, too': (HEAD.pack(0, 5) + b'four' + 3 * MESSAGE, False),
    'the end of the data, cut': (END[:-2], True),
    'an end of a wrong length': (HEAD.pack(Opcode.DATA_END, 5) + b'12', False),
    'a whole message': (3 * MESSAGE, False)}


@pytest.mark.parametrize('case', DAMAGED)
def test_a_message_is_believed_where_it_is_the_record_behind_it_that_is_damaged(case):
    behind, expected = DAMAGED[case]
    one = begun(JUNK + MESSAGE + behind)
    assert one._damage_begins(AT, AT + 35) == expected


def test_a_message_that_swallows_others_is_not_believed():
    swallowing = message(1, 5, 10, 11, 4 * MESSAGE)
    one = begun(JUNK + swallowing + LONG)
    assert not one._damage_begins(AT, AT + len(swallowing))


STATISTICS = to_bytes(Statistics(0, 1, {}, 0, 0, 0, 0, 0, 1))
BEHIND = {
    # records from the end of the data on, and which opcode; what comes next, whether it is data
    'the end of the data': (END + STATISTICS + JUNK, Opcode.DATA_END, len(END), False),
    'the summary': (STATISTICS + JUNK, Opcode.STATISTICS, len(STATISTICS), False),
    'the magic': (STATISTICS + MAGIC, Opcode.STATISTICS, None, False),
    'a byte more': (STATISTICS + MAGIC + b'1', Opcode.STATISTICS, len(STATISTICS), False),
    'a chunk': (chunk(*TIMED) + JUNK, Opcode.CHUNK, 0, True),
    'a message': (MESSAGE + JUNK, Opcode.MESSAGE, 0, True),
    'one on no channel': (message(9, 5, 10, 11, b'data') + JUNK, Opcode.MESSAGE, 35, False),
    'what is no record': (b'\0' + 3 * MESSAGE, 0, 1, False),
    'and nothing behind': (JUNK, 0xff, None, False)}


@pytest.mark.parametrize('case', BEHIND)
def test_behind_the_data_a_chunk_or_a_message_begins_it_again(case):
    content, opcode, following, is_data = BEHIND[case]
    one = begun(JUNK + content)
    end = 0 if opcode in (0, 0xff) else AT + HEAD.size + HEAD.unpack_from(content)[1]
    one._keep(0, AT)
    assert one._behind_data(AT, end, opcode) == (None if following is None else AT + following)
    assert one.end == AT and one.cut == (opcode != Opcode.DATA_END)
    assert one._tail == (0 if is_data else AT)
    assert one.damages == ([Damage(0, lost=0)] if is_data else [])
    assert (one._part is None) == is_data
    if not is_data:    # the end is where the summary began
        one._behind_data(AT + 3, AT + 4, Opcode.STATISTICS)
        assert one.end == one._tail == AT and one.cut == (opcode != Opcode.DATA_END)


def test_behind_what_is_no_record_no_earlier_one_is_found():
    one = begun(JUNK + 5 * MESSAGE)
    assert one._behind_data(AT + 1, 0, Opcode.STATISTICS) == AT + 35


@pytest.mark.parametrize('cut', [False, True])
@pytest.mark.parametrize('indexed', [False, True])
def test_of_a_cut_file_the_last_chunk_gets_the_index_that_it_lacks(cut, indexed):
    body = MAGIC + HEADER + to_bytes(SCHEMA, CHANNEL) + chunk(*TIMED)
    content, begin = body + indexed * INDEX, len(body) - len(chunk(*TIMED))
    one = scanned(content if cut else content + END + JUNK)
    assert (one.end, one.cut) == (len(content), cut)
    assert (one.contents.counts, one.contents.start_time) == ({1: 3}, 5)
    assert one.contents.channels == {1: CHANNEL} and one.descriptions == []
    whole = indexed or not cut
    assert one.parts[1:] == ([] if whole else [Unindexed(begin)])
    assert len(one.places) == one.contents.chunk_count == whole
