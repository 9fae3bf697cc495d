# SPDX-License-Identifier: Apache-2.0
"""metadata.yaml, version 9: what rosbag2 in Jazzy reads about a recording before it opens it."""

import os
import typing

import yaml

FILE_NAME = 'metadata.yaml'
ROOT = 'rosbag2_bagfile_information'
# libyaml's writer and reader are ten times faster; PyYAML may be built without.
_Dumper = getattr(yaml, 'CSafeDumper', yaml.SafeDumper)
_Loader = getattr(yaml, 'CSafeLoader', yaml.SafeLoader)


class TopicRecord(typing.NamedTuple):
    """A topic in metadata.yaml; `qos` is the list of offered profiles, each a dict."""

    name: str
    type: str
    qos: list
    hash: str


class FileRecord(typing.NamedTuple):
    """A file in metadata.yaml: times in ns (0 without messages), `counts` by topic name."""

    name: str
    start_time: int
    end_time: int
    counts: dict


def bag_metadata(topics, files, about):
    """Return the map under the root key.

    `topics` are TopicRecords, `files` FileRecords, `about` a dict of texts (custom_data) or None.
    """
    used = [file for file in files if file.counts]
    start = min((file.start_time for file in used), default=0)
    end = max((file.end_time for file in used), default=0)
    counts = {topic.name: sum(file.counts.get(topic.name, 0) for file in files)
              for topic in topics}
    return {
        'version': 9,
        'storage_identifier': 'mcap',
        'duration': {'nanoseconds': end - start},
        'starting_time': {'nanoseconds_since_epoch': start},
        'message_count': sum(counts.values()),
        'topics_with_message_count': [
            {'topic_metadata': {
                'name': topic.name, 'type': topic.type, 'serialization_format': 'cdr',
                'offered_qos_profiles': topic.qos, 'type_description_hash': topic.hash},
             'message_count': counts[topic.name]} for topic in topics],
        'compression_format': '',
        'compression_mode': '',
        'relative_file_paths': [file.name for file in files],
        'files': [
            {'path': file.name, 'starting_time': {'nanoseconds_since_epoch': file.start_time},
             'duration': {'nanoseconds': file.end_time - file.start_time},
             'message_count': sum(file.counts.values())} for file in files],
        'custom_data': about,
        'ros_distro': 'jazzy',
    }


def dump(value):
    """Return the YAML text of maps, sequences, texts and numbers, in their order."""
    return yaml.dump(value, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=2**20)


def load(text):
    """Return the value of a YAML text; yaml.YAMLError where it is none."""
    return yaml.load(text, Loader=_Loader)      # a safe one


def write(folder, bag):
    """Write metadata.yaml into the folder (an open descriptor), all of it or nothing."""
    temporary = f'.{FILE_NAME}.part'
    descriptor = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644, dir_fd=folder)
    try:
        with open(descriptor, 'w', encoding='utf-8') as stream:
            stream.write(dump({ROOT: bag}))
            stream.flush()
            os.fsync(descriptor)
        os.rename(temporary, FILE_NAME, src_dir_fd=folder, dst_dir_fd=folder)
    except OSError:
        os.unlink(temporary, dir_fd=folder)
        raise
