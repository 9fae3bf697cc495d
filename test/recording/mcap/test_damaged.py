# SPDX-License-Identifier: Apache-2.0
"""What is made of one damaged record, and what is noted of it."""

import tempfile
import types

import pytest
from mcap.exceptions import UnsupportedCompressionError
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Metadata, Schema

from rigid_body_sim.recording.mcap import damaged
from rigid_body_sim.recording.mcap.chunks import message
from rigid_body_sim.recording.mcap.compression import LARGEST_CHUNK
from rigid_body_sim.recording.mcap.contents import Contents
from rigid_body_sim.recording.mcap.damaged import DamagedRecords
from rigid_body_sim.recording.mcap.found import Broken, Damage, Replaced, Unindexed, Whole
from rigid_body_sim.recording.mcap.records import HEAD, to_bytes
from rigid_body_sim.recording.mcap.rescue import Rescued
from rigid_body_sim.recording.mcap.walk import walk

SCHEMA, CHANNEL = Schema(1, 5000 * b'#', 'ros2msg', 'a/B'), Channel(1, '/a', 'cdr', {}, 1)
MESSAGE = message(1, 5, 10, 11, b'data')
JUNK = 20 * b'\xff'
FAR = 10 ** 12    # ns


def found(content=b''):
    """Return the DamagedRecords of a file of these bytes, with a channel 1 that it knows."""
    stream = tempfile.TemporaryFile()    # noqa: SIM115, it is read later on
    stream.write(content)
    stream.flush()
    one = DamagedRecords(stream)
    one.contents.note(CHANNEL)
    return one


def rescued(records=b'', expected=None, claimed=0, sure=False):
    offsets, others = walk(records)
    return Rescued(77, '', None, records, offsets, others, sure, expected, claimed, (2, 900))


TIMES = b''.join(message(1 + k % 2, k, time, 0, b'four') for k, time in enumerate((7, 3, 5)))


@pytest.mark.parametrize(('of', 'cut', 'expected'), [
    ({'sure': True}, False, {'lost': 0}),
    ({'sure': True, 'expected': {1: 9}, 'claimed': 500}, False, {'lost': 0}),
    ({'expected': {1: 4, 2: 1}, 'claimed': 500}, False, {'lost': 2, 'doubtful': 3}),
    ({'claimed': 500}, False, {'claimed': 500 - len(TIMES), 'doubtful': 3}),
    ({'claimed': LARGEST_CHUNK}, True, {'claimed': LARGEST_CHUNK - len(TIMES)}),
    ({'claimed': LARGEST_CHUNK + 1}, True, {}), ({'claimed': 5}, True, {})])
def test_of_a_rescued_chunk_messages_and_what_is_missing_are_counted(of, cut, expected):
    one = found()
    one._rescued(30, 'a hint', rescued(TIMES, **of), cut)
    assert one.contents.counts == {1: 2, 2: 1}
    assert (one.contents.start_time, one.contents.end_time) == (3, 7)
    assert one.mean_message == len(TIMES) / 3 and one.end == 77
    assert one.damages == [Damage(0, kept=3, until=900, **expected)]
    assert one.parts == [Broken(30, 'a hint', cut)] and one._indexes_follow


@pytest.mark.parametrize(('more', 'noted'), [(b'', True), (b'1', False)])
@pytest.mark.parametrize('sure', [True, False])
def test_of_a_rescued_chunk_whole_descriptions_are_noted(more, noted, sure):
    content = to_bytes(SCHEMA)[HEAD.size:] + more
    one, records = found(), HEAD.pack(Opcode.SCHEMA, len(content)) + content
    one._rescued(30, None, rescued(records, sure=sure))
    assert one.contents.schemas == ({1: SCHEMA} if noted else {})
    assert one._bad_descriptions == (not sure) and one.parts == [Broken(30, None, False)]
    assert (one.contents.counts, one.mean_message, one.damages[0].kept) == ({}, 0.0, 0)


@pytest.mark.parametrize(('is_index', 'of', 'expected'), [
    (True, {}, {'lost_bytes': 0, 'lost': 0}), (False, None, {}), (False, {}, {'until': 900}),
    (False, {'claimed': LARGEST_CHUNK}, {'until': 900, 'claimed': LARGEST_CHUNK}),
    (False, {'claimed': LARGEST_CHUNK + 1}, {'until': 900}),
    (False, {'expected': {1: 2, 2: 3}}, {'until': 900, 'lost': 5})])
def test_what_is_lost_of_a_record_is_told_by_what_it_claims(is_index, of, expected):
    damage = found()._lost(100, is_index, None if of is None else rescued(**of))
    assert damage == Damage(**{'lost_bytes': 100, **expected})


@pytest.mark.parametrize(('size', 'channel', 'time', 'good'), [
    (4, 1, 10, True), (0, 1, 10, True), (-1, 1, 10, False), (4, 2, 10, False),
    (4, 257, 10, False), (4, 1, 50 + FAR, True), (4, 1, 51 + FAR, False)])
def test_what_ends_at_a_place_may_be_a_message(size, channel, time, good):
    """It has 22 bytes and its data, a channel of the file, and a time near the others."""
    whole = message(channel, 6, time, 0, bytes(max(0, size)))[:31 + size]
    wrong = b'\x7f' + bytes(8) + whole[HEAD.size:]
    one = found(JUNK + wrong + MESSAGE)
    one.contents.add_messages({1: 3}, 40, 50)
    assert one._with_length(len(JUNK), len(JUNK + wrong)) == good
    assert one.parts == ([Replaced(whole)] if good else [])
    assert one.damages == ([Damage(0, lost=0)] if good else [])
    assert one.contents.counts == {1: 4 if good else 3}
    if good:
        assert one.end == len(JUNK + wrong)
        assert (one.contents.start_time, one.contents.end_time) == (min(time, 40), max(time, 50))


def test_where_no_time_is_known_that_of_a_message_may_be_any():
    one = found(message(1, 6, 5 * FAR, 0, b''))
    assert one._with_length(0, 31) and one.contents.start_time == 5 * FAR


def test_a_time_is_far_that_is_far_from_the_part_before_or_from_all_that_is_told():
    for far in (0, 1, None):
        ends = [5 * FAR if far == k else 50 for k in range(2)]
        near_it, all_of_it = (Contents() for _ in ends)
        for of, end in zip((near_it, all_of_it), ends, strict=True):
            of.note(CHANNEL)
            of.add_messages({1: 3}, 5, end)
        one = found(MESSAGE)
        one._part, one.told = Whole(0, 9, near_it), types.SimpleNamespace(contents=all_of_it)
        assert one._with_length(0, len(MESSAGE)) == (far is None)


@pytest.mark.parametrize(('opcode', 'off', 'behind', 'good'), [
    (Opcode.SCHEMA, 1, 2, True), (0x7f, 0, 2, True), (0x7f, 1, 2, False),
    (Opcode.SCHEMA, 1, 1, False), (0x7f, 0, 1, False)])
def test_a_record_whose_head_is_wrong_is_replaced_if_two_records_follow(opcode, off, behind, good):
    """One of its opcode and its length is right."""
    content = to_bytes(SCHEMA)[HEAD.size:]
    wrong = HEAD.pack(opcode, len(content) + off) + content
    one = found(JUNK + wrong + behind * MESSAGE + JUNK)
    end = one._replaced(len(JUNK), opcode, len(content) + off)
    assert end == (len(JUNK + wrong) if good else 0)
    assert one.contents.schemas == ({1: SCHEMA} if good else {})
    assert one.damages == ([Damage(0, lost=0)] if good else [])
    assert one._bad_descriptions == good and one.end == end


def test_metadata_and_messages_whose_opcode_is_wrong_are_written_as_they_should_be():
    for record in (to_bytes(Metadata('name', {'a': 'b'})), MESSAGE, message(1, 6, 10, 0, b'')):
        wrong = b'\x7f' + record[1:]
        for behind in (2 * MESSAGE + JUNK, b''):
            one = found(JUNK + wrong + behind)
            end = one._replaced(len(JUNK), 0x7f, len(record) - HEAD.size)
            assert end == one.end == len(JUNK + wrong)
            assert one.parts == [Replaced(record)] and one.damages == [Damage(0, lost=0)]
            assert not one._bad_descriptions


@pytest.mark.parametrize(('length', 'chunk_length', 'expected'), [
    (10, None, 19), (9, None, 19), (60, None, 19), (11, 19, 19), (10, 20, 19), (10 ** 6, None, 19),
    (19 + 35 - 9, None, 19 + 35), (10, 19 + 35, 19 + 35)])
def test_behind_a_damaged_record_the_next_one_is_where_its_length_or_the_index_of_the_file_says(
        length, chunk_length, expected):
    """Where none is there, it is the next one that others follow: all three messages of 35."""
    one = found(JUNK + HEAD.pack(0x7f, length) + 10 * b'\xff' + 3 * MESSAGE)
    hint = chunk_length and types.SimpleNamespace(chunk_length=chunk_length)
    assert len(MESSAGE) == 35
    assert one._following(len(JUNK), length, hint, False) == len(JUNK) + expected


@pytest.mark.parametrize(('length', 'array'), [(22, 16), (21, 16), (22, 15), (22, 51), (57, 16)])
def test_a_message_index_ends_where_one_of_its_lengths_leads_to_a_record_and_swallows_none(
        length, array):
    index = HEAD.pack(7, length) + b'\0\0' + array.to_bytes(4, 'little') + 16 * b'\xff'
    one = found(JUNK + index + 4 * MESSAGE)
    assert one._following(len(JUNK), length, None, True) == len(JUNK + index)


@pytest.mark.parametrize(('rest', 'opcode', 'lost'), [
    (0, Opcode.MESSAGE, None), (12, Opcode.MESSAGE_INDEX, None), (12, Opcode.MESSAGE, 12)])
def test_a_file_that_is_cut_in_a_record_loses_it_unless_it_is_an_index(rest, opcode, lost):
    one = found(JUNK + MESSAGE[:rest])
    one._cut_at(len(JUNK), opcode)
    assert one.end == len(JUNK) and one.damages == []
    assert one.cut_damage == (lost and Damage(lost))


@pytest.mark.parametrize(('hints', 'limit', 'expected'), [
    ((), None, 69), ((30, 50), None, 30), ((0, 50), None, 50), ((-5, 80), None, 69),
    ((30, 50), 20, 20), ((), 60, 60)])
def test_where_nothing_is_found_the_next_chunk_of_the_index_begins_or_the_data_ends(
        hints, limit, expected):
    """Places from the damaged record on."""
    one, at = found(JUNK + HEAD.pack(0x7f, 10 ** 6) + 60 * b'\xff' + 4 * MESSAGE), len(JUNK)
    one._hints = {at + place: 'an index' for place in hints}
    if limit:
        one.told = types.SimpleNamespace(contents=one.contents, data_end=at + limit)
    assert one._following(at, 10 ** 6, None, False) == at + expected


def test_the_record_behind_a_damaged_one_may_begin_anywhere_in_it_and_is_on_a_known_channel():
    for content, expected in ((b'\x7f' + 4 * MESSAGE, 1), (5 * MESSAGE, len(MESSAGE)),
                              (JUNK + 4 * message(9, 5, 1, 1, b'data') + 4 * MESSAGE, 160)):
        assert found(JUNK + content)._following(len(JUNK), 10 ** 6, None, False) == (
            len(JUNK) + expected)


def taken(monkeypatch, content, rescued=None, follow=False, error=None):
    """Return what is found where a record is damaged, and where the next one is.

    Of the chunk before it the index is missing.
    """
    monkeypatch.setattr(damaged, 'rescue', lambda *_, **__: rescued)
    one = found(JUNK + content)
    assert not one._indexes_follow
    one._indexes_follow = follow
    one._keep(0, 15)
    one._last = types.SimpleNamespace(index_places={}, counts={1: 1}, index_wrong=False,
                                      index_length=0, offset=3, end=12)
    following = one._damaged(len(JUNK), error)
    assert one.parts.pop(0).end == 12 and one.parts.pop(0) == Unindexed(3)
    for damage in one.damages:
        damage.before = None
    return one, following


@pytest.mark.parametrize(('follow', 'opcode', 'array', 'is_index'), [
    (True, 0x7f, 16 + 2 ** 24, False),
    (True, 7, 16, True), (True, 7, 15, True), (True, 0x7f, 16, True), (True, 0x7f, 15, False),
    (False, 7, 16, False), (False, 0x7f, 15, False)])
def test_a_damaged_message_index_behind_a_chunk_costs_nothing(follow, opcode, array, is_index,
                                                              monkeypatch):
    index = HEAD.pack(opcode, 22) + b'\xff\xff' + array.to_bytes(4, 'little') + 16 * b'\xff'
    one, following = taken(monkeypatch, index + 4 * MESSAGE, follow=follow)
    assert following == one.end == len(JUNK + index)
    assert one.damages == [Damage(0, lost=0) if is_index else Damage(len(index))]
    assert one._indexes_follow == is_index and one._part is None and one.parts == []


@pytest.mark.parametrize('records', [TIMES, to_bytes(SCHEMA)])
def test_what_is_rescued_of_a_chunk_is_kept_also_where_it_is_only_descriptions(records,
                                                                               monkeypatch):
    one, following = taken(monkeypatch, 4 * MESSAGE, rescued(records), error=KeyError())
    assert following == one.end == 77 and one.parts == [Broken(len(JUNK), None, False)]


@pytest.mark.parametrize('of', [None, rescued()])
def test_a_chunk_that_cannot_be_read_here_is_no_damage_of_the_file(of, monkeypatch):
    with pytest.raises(UnsupportedCompressionError):
        taken(monkeypatch, 4 * MESSAGE, of, error=UnsupportedCompressionError('other'))


def test_a_chunk_ends_the_file_that_is_cut_in_it_whatever_is_in_its_data(monkeypatch):
    content = to_bytes(Chunk('', 5 * MESSAGE, 9, 1, 5, 175))
    one, following = taken(monkeypatch, content[:-3])
    assert following is None and one.damages == [] and one.end == len(JUNK)
    assert one.cut_damage.lost_bytes == len(content) - 3
    wrong = b'\x06\xff' + content[2:]    # of another length it is not cut
    one, following = taken(monkeypatch, wrong)
    assert following == len(JUNK) + 49 and one.damages == [Damage(49)]
    assert one.cut_damage is None


@pytest.mark.parametrize(('opcode', 'parts', 'damage'), [
    (5, [Replaced(MESSAGE)], Damage(0, lost=0)), (0x7f, [], Damage(35))])
def test_a_message_of_another_length_is_one_up_to_the_next_record(opcode, parts, damage,
                                                                  monkeypatch):
    content = HEAD.pack(opcode, 90) + MESSAGE[HEAD.size:] + 4 * MESSAGE
    one, following = taken(monkeypatch, content, follow=True)
    assert following == one.end == len(JUNK) + 35 and not one._indexes_follow
    assert one.parts == parts and one.damages == [damage]


def test_a_damaged_record_is_replaced_where_its_content_is_whole(monkeypatch):
    record = to_bytes(SCHEMA)
    one, following = taken(monkeypatch, b'\x7f' + record[1:] + 3 * MESSAGE)
    assert following == len(JUNK + record) and one.contents.schemas == {1: SCHEMA}
    assert one.damages == [Damage(0, lost=0)] and one.parts == []


def test_behind_a_damaged_record_that_nothing_follows_the_file_is_cut(monkeypatch):
    one, following = taken(monkeypatch, HEAD.pack(0x7f, 11) + 11 * b'\xff')
    assert following is None and one.damages == [] and one.cut_damage.lost_bytes == 20


@pytest.mark.parametrize('sure', [True, False])
def test_of_a_chunk_in_which_the_file_is_cut_the_messages_are_kept(sure, monkeypatch):
    asked, one = [], found(JUNK + MESSAGE)
    monkeypatch.setattr(damaged, 'rescue', lambda _, offset, **how: asked.append(
        (offset, how)) or rescued(TIMES, sure=sure, claimed=500))
    one.damages = [Damage(1), Damage(2)]
    one._cut_at(len(JUNK), Opcode.CHUNK)
    assert asked == [(len(JUNK), {'cut': True})] and one.cut_damage is None
    assert [damage.lost_bytes for damage in one.damages] == [1, 2, 0 if sure else len(MESSAGE)]
    assert one.parts == [Broken(len(JUNK), None, True)] and one.damages[2].doubtful == 0


@pytest.mark.parametrize(('claimed', 'told'), [
    (LARGEST_CHUNK, LARGEST_CHUNK), (LARGEST_CHUNK + 1, 0), (500, 500)])
def test_of_a_chunk_cut_before_its_first_message_is_what_it_claims_lost(claimed, told,
                                                                        monkeypatch):
    monkeypatch.setattr(damaged, 'rescue', lambda *_, **__: rescued(claimed=claimed))
    one = found(JUNK + MESSAGE)
    one._cut_at(len(JUNK), Opcode.CHUNK)
    assert one.cut_damage == Damage(len(MESSAGE), claimed=told, until=900)
