# SPDX-License-Identifier: Apache-2.0
"""What is said of a mended file, and where the file goes that was there before."""

import errno
import fcntl
import os
import pathlib
import types

import pytest

from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages import cdr
from rigid_body_sim.recording import repair
from rigid_body_sim.recording.repair import Recovered, _Beside, recover_file
from rigid_body_sim.recording.topics import Topic, journal_topic
from rigid_body_sim.recording.writer import Writer

X = pathlib.Path('x.mcap')


@pytest.mark.parametrize(('result', 'said'), [
    (Recovered(X, 5), 'whole, 5 messages'),
    (Recovered(X, 5, changed=True), 'made whole, 5 messages kept, lost nothing'),
    (Recovered(X, 5, 2, 'counted', 0.5, 90, changed=True),
     'made whole, 5 messages kept, lost 2 messages, 0.500 s (90 bytes)'),
    (Recovered(X, 5, 2, 'estimated', 0.0004, 90, changed=True),
     'made whole, 5 messages kept, lost about 2 messages, 0.000 s (90 bytes)'),
    (Recovered(X, 5, 2, 'unknown', 0.5, 90, changed=True),
     'made whole, 5 messages kept, lost about 2 messages, 0.500 s (90 bytes), and perhaps more: '
     'the file does not tell how many messages it held'),
    (Recovered(X, 5, 0, 'unknown', 0.0, 90, changed=True),
     'made whole, 5 messages kept, what is lost is not known (90 bytes could not be read): the '
     'file does not tell how many messages it held'),
    (Recovered(X, 5, 0, 'unknown', 0.0, 0, changed=True),
     'made whole, 5 messages kept, what is lost is not known: the file does not tell how many '
     'messages it held'),
    (Recovered(X, 5, 0, 'estimated', 0.0, 0, 3, True, pathlib.Path('a/x.mcap.orig')),
     'made whole, 5 messages kept, lost nothing; 3 of them are doubtful: the checksum over them '
     'is wrong; the file as it was: x.mcap.orig')])
def test_what_was_lost_is_said_as_far_as_it_is_known(result, said):
    assert str(result) == f'x.mcap: {said}'


@pytest.mark.parametrize('links', [True, False], ids=['', 'without hard links'])
def test_each_file_that_was_there_before_is_kept(tmp_path, monkeypatch, links):
    """Mended three times, it leaves .orig, .orig2 and .orig3, with the rights that it had."""
    def refuses(*_):
        raise OSError(errno.EPERM, 'Operation not permitted')
    if not links:
        monkeypatch.setattr(os, 'link', refuses)
    path = tmp_path / 'x.mcap'
    path.write_text('as it was')
    path.chmod(0o640)
    for number in (1, 2, 3):
        with _Beside(path) as beside:
            beside.open().write(str(number).encode())
            beside.stream.flush()
            original = beside.take_its_place()
        assert original.name == f'x.mcap.orig{number if number > 1 else ""}'
    assert {one.name: one.read_text() for one in tmp_path.iterdir()} == {
        'x.mcap': '3', 'x.mcap.orig': 'as it was', 'x.mcap.orig2': '1', 'x.mcap.orig3': '2'}
    assert {one.stat().st_mode & 0o777 for one in tmp_path.iterdir()} == {0o640}


def test_what_was_written_beside_a_file_goes_if_it_did_not_take_its_place(tmp_path):
    path = tmp_path / 'x.mcap'
    path.write_text('as it was')
    with _Beside(path) as beside:
        assert beside.take_its_place() is None    # nothing had to be written
    with _Beside(path) as beside:
        beside.open().write(b'half')
    assert {one.name: one.read_text() for one in tmp_path.iterdir()} == {'x.mcap': 'as it was'}


TEXT = 'std_msgs/msg/String'


@pytest.fixture
def file(tmp_path):
    """Return the path of a file with three messages and the journal's first entry."""
    with Writer(tmp_path / 'run', [], [Topic('/text', TEXT)], journal_topic(),
                {'scene': 'none'}) as writer:
        for time in (5, 7, 9):
            writer.message('/text', time, time, cdr.encode(TEXT, {'data': 'abc'}))
    [path] = (tmp_path / 'run').glob('*.mcap')
    return path


def test_a_whole_file_stays_as_it_is(file):
    before = file.read_bytes()
    recovered, found = recover_file(file)
    assert recovered == Recovered(file, 4)
    assert (recovered.lost_messages, recovered.lost_seconds, recovered.lost_bytes,
            recovered.doubtful_messages, recovered.original) == (0, 0.0, 0, 0, None)
    assert file.read_bytes() == before
    assert found.file == (file.name, 5, 9, {'/text': 3, '/journal': 1})
    assert [(topic.name, topic.type) for topic in found.topics if topic.name == '/text'] == [
        ('/text', TEXT)]
    assert found.about == {'scene': 'none'}


def test_a_file_without_its_end_gets_one_in_its_place(file):
    whole = file.read_bytes()
    file.write_bytes(whole[:-60])
    recovered, found = recover_file(file, 4)
    assert (recovered.messages, recovered.lost_messages, recovered.changed) == (4, 0, True)
    assert recovered.original is None and found.file.name == file.name
    assert recover_file(file)[0] == Recovered(file, 4)


def test_a_file_that_is_being_recorded_is_left_alone(file):
    with open(file, 'rb') as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        with pytest.raises(BadInput, match='is still being recorded'):
            recover_file(file)
    assert recover_file(file)[0].messages == 4
    with pytest.raises(BadInput, match=r'cannot be opened for repair \(No such file'):
        recover_file(file.with_name('none.mcap'))


@pytest.mark.parametrize('anew', [True, False])
def test_what_is_told_of_a_file_is_read_from_the_one_that_takes_its_place(
        file, anew, monkeypatch):
    def mend(stream, texts, begin, expected):
        assert expected == 7
        if anew:
            begin().write(b'new')
        return types.SimpleNamespace(message_count=3), (1, 'estimated', 0.5, 9, 2)
    monkeypatch.setattr(repair, 'mend', mend)
    monkeypatch.setattr(repair, 'Found', lambda stream, contents, name: (stream.name, name))
    recovered, (read, name) = recover_file(file, 7)
    beside = file.with_name(f'.{file.name}.part')
    assert (pathlib.Path(read), name) == (beside if anew else file, file.name)
    original = file.with_name(f'{file.name}.orig') if anew else None
    assert recovered == Recovered(file, 3, 1, 'estimated', 0.5, 9, 2, True, original)
