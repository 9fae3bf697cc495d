# SPDX-License-Identifier: Apache-2.0
"""Which bytes are a record by its opcode and its lengths, on records of the library's."""

import pytest
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    Channel,
    Chunk,
    DataEnd,
    Footer,
    Message,
    MessageIndex,
    Metadata,
    Schema,
)
from mcap.writer import MCAP0_MAGIC

from rigid_body_sim.recording.mcap import forms
from rigid_body_sim.recording.mcap.bytes import MemoryBytes
from rigid_body_sim.recording.mcap.records import HEAD, to_bytes

BEFORE = b'\xff\0\xff'    # no record begins with these


def chunk(data=b'', name=''):
    return to_bytes(Chunk(name, data, 9, 1, 5, 700))


def message(channel=1, data=b''):
    return to_bytes(Message(channel, 4, data, 5, 0x01010101))


def index(*entries):
    return to_bytes(MessageIndex(0x0203, list(entries)))


SCHEMA = to_bytes(Schema(1, b'float64 data', 'ros2msg', 'a/B'))
ATTACHMENT = to_bytes(Attachment(1, 2, 'a name', 'text/plain', bytes(9)))
GOOD = {
    'chunk': chunk(b'data', 'zstd'), 'empty chunk': chunk(), 'longest name': chunk(b'', 16 * 'n'),
    'index': index((7, 8), (9, 10)), 'empty index': index(), 'message': message(0x0201, b'data'),
    'empty message': message(), 'schema': SCHEMA, 'metadata': to_bytes(Metadata('a', {'b': 'c'})),
    'long schema': to_bytes(Schema(1, 5000 * b'#', 'ros2msg', 'a/B')),
    'channel': to_bytes(Channel(1, '/a', 'cdr', {'b': 'c'}, 1)), 'attachment': ATTACHMENT,
    'data end': to_bytes(DataEnd(0)), 'private': HEAD.pack(0x80, 5) + b'12345',
    'private and empty': HEAD.pack(0x80, 0),
    'footer': to_bytes(Footer(1, 2, 3)) + MCAP0_MAGIC}
BAD = {
    'opcode 0': HEAD.pack(0, 5) + b'12345', 'message of 21': HEAD.pack(5, 21) + bytes(21),
    'data end of 3': HEAD.pack(15, 3) + bytes(3), 'data end of 5': HEAD.pack(15, 5) + bytes(5),
    'footer of 19': HEAD.pack(2, 19) + bytes(19) + MCAP0_MAGIC,
    'footer and no more': to_bytes(Footer(1, 2, 3)), 'footer and more': GOOD['footer'] + b'1',
    'empty schema': HEAD.pack(3, 0), 'long schema': HEAD.pack(3, len(SCHEMA) - 8) + SCHEMA[9:] +
    b'1', 'chunk with another opcode': b'\x80' + chunk(b'data', 'zstd')[1:],
    'long name': chunk(b'', 17 * 'n'), 'index of 5': HEAD.pack(7, 5) + bytes(5),
    'index with a part of an entry': HEAD.pack(7, 7) + b'\0\0' + b'\1\0\0\0' + b'1',
    'index with another number': HEAD.pack(7, 22) + b'\0\0' + b'\0\0\0\0' + bytes(16),
    'index with a long array': HEAD.pack(7, 22) + b'\0\0' + b'\x10\0\0\1' + bytes(16),
    'half an attachment': HEAD.pack(9, 20) + ATTACHMENT[9:29], 'head': HEAD.pack(5, 0)[:8]}


@pytest.mark.parametrize('case', GOOD)
def test_a_whole_record_ends_where_its_lengths_say(case):
    content = BEFORE + GOOD[case]
    end = len(content) - 8 * (case == 'footer')
    assert forms.record_end(MemoryBytes(content), 3) == end
    if case != 'footer':
        assert forms.record_end(MemoryBytes(content + b'\xff'), 3) == end
        assert forms.record_end(MemoryBytes(content[:-1]), 3) == 0


@pytest.mark.parametrize('case', BAD)
def test_a_record_of_which_the_lengths_do_not_agree_is_none(case):
    assert forms.record_end(MemoryBytes(BEFORE + BAD[case]), 3) == 0


@pytest.mark.parametrize(('channels', 'good'), [
    (None, True), ((0x0201,), True), ((0x0202, 1, 2), False), ((), False)])
def test_a_message_is_one_on_the_channels_that_there_are(channels, good):
    found = forms.record_end(MemoryBytes(GOOD['message']), 0, channels)
    assert found == (len(GOOD['message']) if good else 0)


@pytest.mark.parametrize(('longest', 'good'), [(0, True), (-1, False)])
def test_the_longest_record_that_is_read_as_an_object(longest, good, monkeypatch):
    monkeypatch.setattr(forms, 'LONGEST_PARSED', len(SCHEMA) - HEAD.size + longest)
    assert bool(forms.record_end(MemoryBytes(SCHEMA), 0)) == good


@pytest.mark.parametrize('size', [0, 10 ** 5])
def test_of_an_attachment_its_data_is_not_read(size):
    class Source(MemoryBytes):
        def read(self, offset, length):
            assert length <= 2 ** 16
            return super().read(offset, length)
    content = to_bytes(Attachment(1, 2, 300 * 'n', 'text/plain', bytes(size)))
    assert forms.record_end(Source(content), 0) == len(content)


@pytest.mark.parametrize(('content', 'end'), [
    (chunk(b'data', 'zstd'), 57), (chunk(), 49), (chunk(b'', 16 * 'n'), 65),
    (chunk(b'', 17 * 'n'), 0), (chunk(b'1', 'zstd'), 54)])
@pytest.mark.parametrize('opcode', [Opcode.CHUNK, 0x7f])
def test_a_chunk_is_one_by_its_lengths_whatever_its_opcode(content, end, opcode):
    """Its content has 40 bytes besides a name, at most 16 bytes long, and its data."""
    content = bytes([opcode]) + content[1:]
    at = len(BEFORE)
    for more in (b'', b'more'):
        found = forms.chunk_end(MemoryBytes(BEFORE + content + more), at)
        assert found == (at + end if end else 0)
    for place in (1, 8, len(content) - 1 if end in (49, 65) else 41 + 4):    # of its lengths
        wrong = bytearray(content)
        wrong[place] ^= 1
        assert forms.chunk_end(MemoryBytes(BEFORE + wrong), at, True) == 0


def test_of_a_chunk_that_is_cut_the_lengths_may_be_there():
    content = chunk(b'data', 'zstd')
    for size in range(len(content)):
        cut = MemoryBytes(content[:size])
        assert forms.chunk_end(cut, 0) == 0
        # 41 bytes, the name and the length of the data
        assert forms.chunk_end(cut, 0, may_be_cut=True) == (57 if size >= 53 else 0)


@pytest.mark.parametrize(('length', 'array', 'good'), [
    (6, 0, True), (22, 16, True), (38, 32, True), (5, 2 ** 32 - 1, False), (7, 1, False),
    (22, 15, False), (22, 22, False),
    (22, 16 + 2 ** 24, False), (38, 16, False), (6 + 2 ** 16, 2 ** 16, True)])
def test_a_message_index_has_entries_of_16_bytes_behind_a_number_and_their_length(
        length, array, good):
    head = HEAD.pack(0x7f, length) + b'\xff\xff' + array.to_bytes(4, 'little') + b'\xff'
    assert forms.is_message_index(head, length) == good


@pytest.mark.parametrize('array', [0, 16, 300])
def test_a_message_index_ends_by_its_array(array):
    content = BEFORE + HEAD.pack(7, 1) + b'\xff\xff' + array.to_bytes(4, 'little') + b'\xff'
    assert forms.index_end(MemoryBytes(content), 3) == 3 + 9 + 2 + 4 + array


@pytest.mark.parametrize(('records', 'enough'), [({}, 3), ({'records': 1}, 1),
                                                 ({'records': 2}, 2)])
def test_some_records_or_the_end_of_the_file_follow(records, enough):
    for count in range(5):
        content = count * message() + 9 * b'\0'
        assert forms.follows(MemoryBytes(content), 0, None, **records) == (count >= enough)
    for content in (message(), message() + MCAP0_MAGIC):    # the end, or the magic there
        assert forms.follows(MemoryBytes(content), 0, None, **records)
    for more in (7, 9):
        source = MemoryBytes(message() + more * b'\xff')
        assert not forms.follows(source, len(message()), None, **records)
    assert not forms.follows(MemoryBytes(3 * message() + 9 * b'\0'), 0, (2,), **records)


@pytest.mark.parametrize('window', [5, 16, 2 ** 20])
@pytest.mark.parametrize(('tail', 'shift'), [
    (b'', 0), (4 * message() + 20 * b'\xff', 0), (to_bytes(DataEnd(0)), 0),
    (message() + to_bytes(DataEnd(0)), 0), (SCHEMA, 0), (index((1, 2)) + chunk(b'data'), 0),
    # three records and no more are passed over
    (3 * message() + 20 * b'\xff' + 3 * message(), 3 * len(message()) + 20)])
def test_the_next_record_is_the_first_one_that_others_follow(window, tail, shift, monkeypatch):
    monkeypatch.setattr(forms, '_WINDOW', window)
    junk = bytes([0, 5, 1, 255, 3]) * 8
    content = junk + tail
    place = len(junk) + shift
    source = MemoryBytes(content)
    assert forms.next_record(source, 0, len(content), None) == place
    assert forms.next_record(source, 2, place - 1, None) == place - 1
    if tail:
        assert forms.next_record(source, place, len(content), {1}) == place
        assert forms.next_record(source, place + 1, place + 4, None) == place + 4
    if tail.startswith(message()):
        following = forms.next_record(source, 0, len(content), {2})
        assert following >= min(len(content), len(junk) + len(message()))


def test_what_a_record_takes_and_what_it_says():
    content = SCHEMA[HEAD.size:]
    assert forms.consumed(Schema, content + b'more') == len(content)
    assert forms.consumed(Schema, content[:-1]) == 0
    assert forms.parsed(Schema, content + b'more') == (
        Schema(1, b'float64 data', 'ros2msg', 'a/B'), len(content))
    assert forms.parsed(Schema, content[:-1]) == (None, 0)
    wrong = content.replace(b'a/B', b'a/\xff')
    assert forms.consumed(Schema, wrong) == 0
    assert forms.parsed(Schema, wrong)[0].name == 'a/\ufffd'
