# SPDX-License-Identifier: Apache-2.0
"""What is found in a file, put together: parts, descriptions, whether nothing needs mending."""

import dataclasses
import tempfile
import types
import zlib

import pytest
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Schema

from rigid_body_sim.recording.mcap import findings
from rigid_body_sim.recording.mcap.chunks import message
from rigid_body_sim.recording.mcap.contents import Contents
from rigid_body_sim.recording.mcap.findings import Findings
from rigid_body_sim.recording.mcap.found import Damage, FoundChunk, Loose, Unindexed, Whole
from rigid_body_sim.recording.mcap.records import HEAD

SCHEMA, CHANNEL = Schema(1, b'', 'ros2msg', 'a/B'), Channel(2, '/a', 'cdr', {}, 1)
CHUNK = FoundChunk(Chunk('', b'', 9, 5, 0, 62), 100, 40,
                   message(2, 1, 5, 0, b'') + message(2, 2, 9, 0, b''))


def found(content=b''):
    stream = tempfile.TemporaryFile()    # noqa: SIM115, it is read later on
    stream.write(content)
    stream.flush()
    return Findings(stream)


def contents(*records, counts=(), times=(0, 0)):
    one = Contents()
    for record in records:
        one.note(record)
    if counts:
        one.add_messages(dict(counts), *times)
    return one


def told(of, checked=True, places=(), data_end=70):
    return types.SimpleNamespace(contents=of, checked=checked, places=[*places],
                                 data_end=data_end)


WHOLE, BARE = Whole(0, 9), Unindexed(5)
IN_PLACE = {
    'nothing': ([], {}, True), 'one part': ([WHOLE], {}, True),
    'a chunk without an index': ([WHOLE, BARE], {}, True),
    'two of them': ([WHOLE, BARE, BARE], {}, False),
    'two parts': ([WHOLE, WHOLE], {}, False), 'no whole part': ([BARE], {}, False),
    'loose messages': ([WHOLE, Loose(1, 2)], {}, False),
    'damage': ([WHOLE], {'damages': [Damage(1)]}, False),
    'descriptions': ([WHOLE], {'descriptions': [SCHEMA]}, False)}


@pytest.mark.parametrize('case', IN_PLACE)
def test_only_what_follows_the_data_is_missing_where_one_part_is_whole(case):
    parts, more, good = IN_PLACE[case]
    one = found()
    one.parts = parts
    for name, value in more.items():
        setattr(one, name, value)
    assert one.in_place == good


@pytest.mark.parametrize('wrong', ['nothing', 'counts', 'places', 'channels', 'schemas', 'start',
                                   'end', 'chunks'])
@pytest.mark.parametrize('checked', [True, False])
def test_a_summary_without_a_checksum_has_to_agree_in_all_that_it_says(wrong, checked):
    """Of one with a checksum, what is counted tells whether it is that of these messages."""
    one = found()
    one.contents = contents(SCHEMA, CHANNEL, counts={2: 5}, times=(3, 9))
    one.places = ['a place']
    theirs = contents(SCHEMA, CHANNEL, counts={2: 5}, times=(3, 9))
    one.told = told(theirs, checked, ['a place'])
    if wrong == 'counts':
        theirs.counts = {2: 6}
    if wrong == 'places':
        one.told.places = []
    if wrong == 'channels':
        theirs.channels = {}
    if wrong == 'schemas':
        theirs.schemas = {}
    if wrong == 'start':
        theirs.start_time = 2
    if wrong == 'end':
        theirs.end_time = 8
    if wrong == 'chunks':
        one._hints = {5: 'an index'}
    assert one._as_told() == (
        wrong == 'nothing' or (checked and wrong not in ('counts', 'places')))
    one.told = None
    assert one._as_told()


@pytest.mark.parametrize('block', [4, 12, 2 ** 22])
@pytest.mark.parametrize(('checksum', 'length', 'good'), [
    (zlib.crc32(b'some bytes of data!!'), 4, True), (0, 4, True), (1, 4, False),
    (zlib.crc32(b'some bytes of data!!'), 5, False)])
def test_the_record_that_ends_the_data_may_have_a_checksum_over_all_before_it(
        block, checksum, length, good, monkeypatch):
    monkeypatch.setattr(findings, 'BLOCK', block)
    one = found(b'some bytes of data!!' + HEAD.pack(Opcode.DATA_END, length) +
                checksum.to_bytes(4, 'little') + b'\xff')
    one.end = 20
    assert one._data_end_is_right() == good


def test_the_data_ends_where_the_summary_says_or_with_the_file_and_channels_are_of_all():
    one = found(50 * b'1')
    assert one._limit == 50 and one._channels() == set()
    one.told = told(contents(CHANNEL))
    one.contents = contents(dataclasses.replace(CHANNEL, id=3))
    one.parts = [BARE, Whole(0, 9, contents(dataclasses.replace(CHANNEL, id=4)))]
    assert one._limit == 70 and one._channels() == {2, 3, 4}


def test_bytes_that_are_kept_belong_to_one_part_until_some_are_dropped():
    one = found()
    first = one._keep(8, 20)
    assert one._keep(20, 30) is first
    one._drop()
    assert one._keep(40, 50) is not first
    assert [(part.begin, part.end) for part in one.parts] == [(8, 30), (40, 50)]


@pytest.mark.parametrize(('second', 'together'), [
    ((20, 29), True), ((20, 30), False), ((21, 25), False), ((19, 25), False)])
def test_loose_messages_are_kept_together_where_they_touch_up_to_a_block(
        second, together, monkeypatch):
    monkeypatch.setattr(findings, 'BLOCK', 20)
    one = found()
    one._keep(0, 10)
    one._keep_loose(10, 20)
    one._keep_loose(*second)
    loose = [Loose(10, second[1])] if together else [Loose(10, 20), Loose(*second)]
    assert one.parts[1:] == loose and one._part is None


HINT = types.SimpleNamespace(message_index_offsets={2: 150})
NO_INDEX = types.SimpleNamespace(message_index_offsets={})
SETTLED = {
    # whether it has its index, a wrong one; whether the summary is there, what it says; remake
    'its index': (True, False, False, {}, True, True), 'a wrong one': (True, True, False, {},
                                                                     False, False),
    'none, and nobody says so': (False, False, False, {}, False, True),
    'none, and the file is cut': (False, False, False, {}, True, False),
    'none, as told': (False, False, True, {100: NO_INDEX}, False, True),
    'none, and not told': (False, False, True, {}, False, True),
    'one is told': (False, False, True, {100: HINT}, False, False)}


@pytest.mark.parametrize('case', SETTLED)
def test_a_chunk_is_whole_with_its_index_or_where_writers_leave_it_out(case):
    has, wrong, is_told, hints, remake, good = SETTLED[case]
    one = found()
    one.told, one._hints = told(Contents()) if is_told else None, hints
    kept = one._keep(0, 200)
    CHUNK.index_places, CHUNK.index_length = ({2: 145}, 30) if has else ({}, 0)
    CHUNK.index_wrong = wrong
    one._last = CHUNK
    one._settle(remake)
    assert one._before is CHUNK and one._last is None
    assert kept.chunk_count == len(one.places) == good
    assert one.parts[0].end == (200 if good else 140)
    assert one.parts[1:] == ([] if good else [Unindexed(100)])
    one._settle(remake)    # once
    assert kept.chunk_count == good


OTHER = dataclasses.replace(CHANNEL, topic='/b')
SPARE = dataclasses.replace(CHANNEL, id=7)
UNKNOWN = Schema(1, b'', '', 'unknown')
DESCRIBED = {
    # what the file says, what the summary says, whether a checksum is over that; what is known
    'all is there': ([SCHEMA, CHANNEL], [], True, [SCHEMA, CHANNEL], False),
    'the summary agrees': ([SCHEMA, CHANNEL], [SCHEMA, CHANNEL], True, [SCHEMA, CHANNEL], False),
    'the summary is right': ([SCHEMA, OTHER], [SCHEMA, CHANNEL], True, [SCHEMA, CHANNEL], True),
    'and may be wrong': ([SCHEMA, OTHER], [SCHEMA, CHANNEL], False, [SCHEMA, OTHER], False),
    'only the summary says': ([SCHEMA], [CHANNEL], False, [SCHEMA, CHANNEL], True),
    'a number is wrong': ([SCHEMA, SPARE], [], True, [SCHEMA, SPARE, CHANNEL], True),
    'two may be it': ([SCHEMA, SPARE, dataclasses.replace(SPARE, id=8)], [], True, None, True),
    'that of the schema': ([dataclasses.replace(SCHEMA, id=5), CHANNEL], [], True,
                           [dataclasses.replace(SCHEMA, id=5), SCHEMA, CHANNEL], True),
    'no schema': ([CHANNEL], [], True, [UNKNOWN, CHANNEL], True),
    'nothing': ([], [], True, [UNKNOWN, Channel(2, '/unknown_2', '', {}, 1)], True),
    'no channel': ([SCHEMA], [], True, [SCHEMA, dataclasses.replace(UNKNOWN, id=2),
                                        Channel(2, '/unknown_2', '', {}, 2)], True),
    'without schema': ([dataclasses.replace(CHANNEL, schema_id=0)], [], True,
                       [dataclasses.replace(CHANNEL, schema_id=0)], False),
    'a schema that nobody needs': ([SCHEMA, dataclasses.replace(CHANNEL, schema_id=0)], [], True,
                                   [SCHEMA, dataclasses.replace(CHANNEL, schema_id=0)], False),
    'two schemas': ([SCHEMA, dataclasses.replace(SCHEMA, id=5)], [], True, [
        SCHEMA, dataclasses.replace(SCHEMA, id=5), dataclasses.replace(UNKNOWN, id=6),
        Channel(2, '/unknown_2', '', {}, 6)], True)}


@pytest.mark.parametrize('case', DESCRIBED)
def test_descriptions_are_completed_by_the_summary_or_by_elimination(case):
    of_file, of_summary, checked, known, bad = DESCRIBED[case]
    one = found()
    one.contents = contents(*of_file, counts={2: 5})
    one.told = told(contents(*of_summary), checked) if of_summary else None
    one._describe()
    if known is not None:
        assert [*one.contents.schemas.values(), *one.contents.channels.values()] == known
    else:
        assert one.contents.channels[2].topic == '/unknown_2'
    assert one.descriptions == ([*one.contents.schemas.values(), *one.contents.channels.values()]
                                if bad else [])


def test_before_anything_is_found_nothing_is_whole():
    one = found()
    assert (one.end, one.header_end, one.cut, one.mean_message) == (0, 0, True, 0.0)
    assert not one.whole and one.in_place
