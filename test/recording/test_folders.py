# SPDX-License-Identifier: Apache-2.0
"""Which files a recording has, in which order, and which of several recordings is the newest."""

import os

import pytest

from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording.folders import files_of, newest_recording
from rigid_body_sim.recording.recover import recording_files


def made(folder, files):
    """Make a folder with files: name -> time of its last change."""
    folder.mkdir(parents=True)
    for name, time in files.items():
        (folder / name).write_text('')
        os.utime(folder / name, (time, time))


def test_the_newest_recording_is_that_of_the_file_written_last(tmp_path):
    made(tmp_path / 'a', {'a_0.mcap': 10, 'a_1.mcap': 40, 'metadata.yaml': 90})
    made(tmp_path / 'b', {'b_0.mcap': 20, 'b_1.mcap': 30})    # killed: no metadata
    made(tmp_path / 'c', {'c_0.db3': 99, 'metadata.yaml': 99})    # in another format
    made(tmp_path / 'd', {'notes.txt': 99})
    made(tmp_path / 'e', {})
    (tmp_path / 'notes.txt').write_text('')
    assert newest_recording(tmp_path) == (tmp_path / 'a', 2)


@pytest.mark.parametrize('name', ['a', 'b', 'a/a_0.mcap'])
def test_a_recording_stands_for_itself(tmp_path, name):
    made(tmp_path / 'a', {'a_0.mcap': 1})
    made(tmp_path / 'b', {'metadata.yaml': 2})
    assert newest_recording(tmp_path / name) == (tmp_path / name, 0)


def test_where_there_is_none_that_is_said(tmp_path):
    with pytest.raises(BadInput, match='holds no recording'):
        newest_recording(tmp_path)
    with pytest.raises(BadInput, match=r'cannot be read \(No such file'):
        newest_recording(tmp_path / 'nowhere')


def test_files_come_in_the_order_of_their_numbers(tmp_path):
    names = ['z.mcap', 'a_0.mcap', 'b_2.mcap', 'a_10.mcap', 'b_10.mcap']
    made(tmp_path / 'a', dict.fromkeys([*reversed(names), 'a_1.mcap.orig', 'x_3.db3'], 1))
    assert recording_files(tmp_path / 'a') == names


def test_metadata_of_more_than_64_megabytes_is_not_read(tmp_path, monkeypatch):
    (tmp_path / 'metadata.yaml').write_text('')
    for size, problem in ((2 ** 26 + 1, 'is larger than 64 MB'),
                          (2 ** 26, 'is not the metadata of a recording')):
        monkeypatch.setattr(os.path, 'getsize', lambda _, size=size: size)
        with pytest.raises(BadInput, match=problem):
            files_of(tmp_path)


@pytest.mark.parametrize(('mode', 'said'), [
    ('', None), ('NONE', None), ('storage', None), ('FILE', 'whole files of it are compressed'),
    ('message', 'whole messages of it are compressed')])
def test_chunks_may_be_compressed_but_no_whole_files_or_messages(tmp_path, mode, said):
    (tmp_path / 'metadata.yaml').write_text(
        f'rosbag2_bagfile_information: {{storage_identifier: mcap, compression_mode: "{mode}", '
        'relative_file_paths: [b_0.mcap, a/c_1.mcap], custom_data: {a: 1}}\n')
    if said is None:
        assert files_of(tmp_path) == ([tmp_path / 'b_0.mcap', tmp_path / 'c_1.mcap'], {'a': '1'})
        return
    with pytest.raises(BadInput, match=said):
        files_of(tmp_path)
