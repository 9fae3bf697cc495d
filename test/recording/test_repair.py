# SPDX-License-Identifier: Apache-2.0
"""What is said of a mended file, and where the file goes that was there before."""

import errno
import os
import pathlib

import pytest

from rigid_body_sim.recording.repair import Recovered, _Beside

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
