# SPDX-License-Identifier: Apache-2.0
"""One file of a recording mended, and what metadata.yaml needs to know of it."""

import dataclasses
import fcntl
import pathlib

import yaml

from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording import metadata
from rigid_body_sim.recording.file_reader import readable
from rigid_body_sim.recording.mcap.mending import mend
from rigid_body_sim.recording.mcap.summary import read_metadata
from rigid_body_sim.recording.writer import ABOUT


@dataclasses.dataclass
class Recovered:
    """What became of one file.

    `messages` it holds now; `lost_messages` estimated from the size of what could not be kept,
    `lost_seconds` of stamps between the last message kept and the last in the cut chunk,
    `lost_bytes` dropped; `changed` is False where the file was whole.
    """

    path: pathlib.Path
    messages: int
    lost_messages: int
    lost_seconds: float
    lost_bytes: int
    changed: bool

    def __str__(self):
        if not self.changed:
            return f'{self.path}: whole, {self.messages} messages'
        lost = 'nothing'
        if self.lost_bytes:
            lost = (f'about {self.lost_messages} messages, {self.lost_seconds:.3f} s '
                    f'({self.lost_bytes} bytes)')
        return f'{self.path}: made whole, {self.messages} messages kept, lost {lost}'


class Found:
    """What metadata.yaml tells of a file.

    Attributes: `topics` (TopicRecords), `channels` (of `mcap.records`), `file` (FileRecord),
    `about` (texts or None).
    """

    def __init__(self, stream, contents, name):
        schemas = {number: schema.name for number, schema in contents.schemas.items()}
        self.channels = list(contents.channels.values())
        self.topics = [metadata.TopicRecord(
            channel.topic, schemas.get(channel.schema_id, ''), _profiles(channel),
            channel.metadata.get('topic_type_hash', '')) for channel in self.channels]
        names = {channel.id: channel.topic for channel in self.channels}
        counts = {}
        for number, count in contents.counts.items():
            topic = names.get(number, '')
            counts[topic] = counts.get(topic, 0) + count
        self.file = metadata.FileRecord(name, contents.start_time, contents.end_time, counts)
        self.about = read_metadata(stream, contents, ABOUT)


def _profiles(channel):
    try:
        profiles = metadata.load(channel.metadata.get('offered_qos_profiles', ''))
    except yaml.YAMLError:
        profiles = None
    return profiles if isinstance(profiles, list) else []


def recover_file(path):
    """Make one file whole; return (Recovered, Found): what was done, and what the file holds.

    Raises
    ------
    BadInput
        Where the file is no MCAP file, or is still being recorded.
    OSError
        Where the disk refuses.
    """
    try:
        with open(path, 'r+b') as stream:
            try:
                fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError as error:
                raise BadInput(str(path), 'is still being recorded',
                               'a recording whose recorder has ended') from error

            def texts(contents):
                found = Found(stream, contents, path.name)
                bag = metadata.bag_metadata(found.topics, [found.file], found.about)
                return {'serialized_metadata': metadata.dump(bag)}
            with readable(path):
                mended = mend(stream, texts)
                found = Found(stream, mended.contents, path.name)
    except (FileNotFoundError, PermissionError, IsADirectoryError) as error:
        raise BadInput(str(path), f'cannot be opened for repair ({error.strerror})',
                       'an .mcap file that may be written') from error
    return Recovered(path, mended.contents.message_count, *mended[1:]), found
