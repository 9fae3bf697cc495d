# SPDX-License-Identifier: Apache-2.0
"""metadata.yaml of recordings in several files: times and counts of each, and of all."""

import os

from rigid_body_sim.recording import metadata
from rigid_body_sim.recording.metadata import FileRecord, TopicRecord

POSE, ENERGY = (TopicRecord(name, 'a/msg/B', [], 'RIHS01_0') for name in ('/pose', '/energy'))
FILES = [FileRecord('r_0.mcap', 100, 250, {'/pose': 3, '/energy': 2}),
         FileRecord('r_1.mcap', 260, 900, {'/pose': 5}),
         FileRecord('r_2.mcap', 0, 0, {})]    # opened, nothing came: its times mean nothing


def test_times_of_split_files_reach_from_the_first_message_to_the_last():
    for files in (FILES, FILES[::-1]):
        bag = metadata.bag_metadata([POSE, ENERGY], files, None)
        assert bag['starting_time'] == {'nanoseconds_since_epoch': 100}
        assert bag['duration'] == {'nanoseconds': 800}


def test_each_file_has_its_own_time_and_count():
    bag = metadata.bag_metadata([POSE, ENERGY], FILES, None)
    assert bag['relative_file_paths'] == ['r_0.mcap', 'r_1.mcap', 'r_2.mcap']
    assert [(file['path'], file['starting_time']['nanoseconds_since_epoch'],
             file['duration']['nanoseconds'], file['message_count']) for file in bag['files']] == [
        ('r_0.mcap', 100, 150, 5), ('r_1.mcap', 260, 640, 5), ('r_2.mcap', 0, 0, 0)]


def test_counts_are_sums_over_the_files():
    bag = metadata.bag_metadata([POSE, ENERGY], FILES, {'scene': 'x'})
    assert bag['message_count'] == 10
    assert [topic['message_count'] for topic in bag['topics_with_message_count']] == [8, 2]
    assert bag['custom_data'] == {'scene': 'x'}


def test_a_bag_without_a_message_starts_and_ends_at_zero():
    bag = metadata.bag_metadata([POSE], FILES[2:], None)
    assert (bag['starting_time']['nanoseconds_since_epoch'], bag['duration']['nanoseconds'],
            bag['message_count']) == (0, 0, 0)


def test_it_is_written_whole_and_read_as_it_was(tmp_path):
    bag = metadata.bag_metadata([POSE, ENERGY], FILES, {'about': 'größer: ja\n' * 300})
    folder, before = os.open(tmp_path, os.O_RDONLY), os.umask(0)
    try:
        metadata.write(folder, bag)
    finally:
        os.umask(before)
        os.close(folder)
    assert [path.name for path in tmp_path.iterdir()] == ['metadata.yaml']
    # all may read it, and whoever records may write it
    assert (tmp_path / 'metadata.yaml').stat().st_mode & 0o777 == 0o644
    text = (tmp_path / 'metadata.yaml').read_text()
    assert 'größer' in text    # for people too
    assert metadata.load(text) == {metadata.ROOT: bag}
    assert list(metadata.load(text)[metadata.ROOT])[:2] == ['version', 'storage_identifier']


def test_it_has_the_version_that_jazzy_writes():
    """Newer ones are refused by its rosbag2, and older ones have no hashes of types."""
    assert metadata.bag_metadata([POSE], FILES, None)['version'] == 9
