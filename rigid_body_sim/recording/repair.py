# SPDX-License-Identifier: Apache-2.0
"""One file of a recording mended, and what metadata.yaml needs to know of it."""

import dataclasses
import fcntl
import itertools
import os
import pathlib
import shutil

import yaml

from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording import metadata
from rigid_body_sim.recording.file_reader import readable
from rigid_body_sim.recording.mcap.mending import mend
from rigid_body_sim.recording.mcap.summary import read_metadata
from rigid_body_sim.recording.writer import ABOUT


@dataclasses.dataclass
class Recovered:
    """The result of recovering one file.

    Attributes
    ----------
    path : pathlib.Path
    messages : int
        In the file now.
    lost_messages : int
    certainty : str
        How `lost_messages` is known, see :class:`rigid_body_sim.recording.mcap.mending.Losses`.
    lost_seconds : float
        Difference of the stamps of the messages before and after what is lost.
    lost_bytes : int
        Bytes of which nothing was kept.
    doubtful_messages : int
        Messages that were kept, though the checksum over them is wrong: some bytes are wrong.
    changed : bool
        False where the file was whole.
    original : pathlib.Path or None
        Path of the file as it was, if it had to be written anew.
    """

    path: pathlib.Path
    messages: int
    lost_messages: int = 0
    certainty: str = 'counted'
    lost_seconds: float = 0.0
    lost_bytes: int = 0
    doubtful_messages: int = 0
    changed: bool = False
    original: pathlib.Path = None

    def __str__(self):
        if not self.changed:
            return f'{self.path}: whole, {self.messages} messages'
        text = f'{self.path}: made whole, {self.messages} messages kept, {self._lost()}'
        if self.doubtful_messages:
            text += (f'; {self.doubtful_messages} of them are doubtful: the checksum over them '
                     f'is wrong')
        if self.original:
            text += f'; the file as it was: {self.original.name}'
        return text

    def _lost(self):
        about = 'about ' if self.certainty != 'counted' else ''
        size = f'{self.lost_seconds:.3f} s ({self.lost_bytes} bytes)'
        if self.lost_messages:
            text = f'lost {about}{self.lost_messages} messages, {size}'
            more = ', and perhaps more'
        elif self.certainty == 'unknown':
            text, more = 'what is lost is not known', ''
            if self.lost_bytes:
                text += f' ({self.lost_bytes} bytes could not be read)'
        else:
            text = 'lost nothing'
        if self.certainty == 'unknown':
            text += f'{more}: the file does not tell how many messages it held'
        return text


class Found:
    """The data that metadata.yaml needs about a file.

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


def recover_file(path, expected=None):
    """Make one file whole; return (Recovered, Found): what was done, and what the file holds.

    Only what lies after the last whole record is replaced in place. Where more is wrong, the file
    is written anew beside the old one, read back, and put in its place; the old one stays, as
    ``NAME.mcap.orig``.

    Parameters
    ----------
    path : pathlib.Path
    expected : int, optional
        Messages that metadata.yaml tells.

    Raises
    ------
    BadInput
        Where the file is no MCAP file, or is still being recorded.
    OSError
        Where the disk refuses.
    """
    def texts(target, contents):
        found = Found(target, contents, path.name)
        bag = metadata.bag_metadata(found.topics, [found.file], found.about)
        return {'serialized_metadata': metadata.dump(bag)}
    try:
        with open(path, 'r+b') as stream, _Beside(path) as beside:
            try:
                fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError as error:
                raise BadInput(str(path), 'is still being recorded',
                               'a recording whose recorder has ended') from error
            with readable(path):
                contents, lost = mend(stream, texts, beside.open, expected)
                found = Found(beside.stream or stream, contents, path.name)
            original = beside.take_its_place()
    except (FileNotFoundError, PermissionError, IsADirectoryError) as error:
        raise BadInput(str(path), f'cannot be opened for repair ({error.strerror})',
                       'an .mcap file that may be written') from error
    if lost is None:
        return Recovered(path, contents.message_count), found
    return Recovered(path, contents.message_count, *lost, changed=True, original=original), found


class _Beside:
    """A file written beside a damaged one; deleted at the end unless it replaced it."""

    def __init__(self, path):
        self._path, self._part = path, path.with_name(f'.{path.name}.part')
        self.stream = None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.stream:
            self.stream.close()
            self._part.unlink(missing_ok=True)

    def open(self):
        """Return the new file, open for reading and writing."""
        self.stream = open(self._part, 'w+b')       # noqa: SIM115, closed at the end
        shutil.copymode(self._path, self._part)
        return self.stream

    def take_its_place(self):
        """Put the new file, if there is one, in the place of the old; return where that is now."""
        if self.stream is None:
            return None
        names = itertools.chain(('.orig',), (f'.orig{number}' for number in itertools.count(2)))
        for name in names:
            original = self._path.with_name(self._path.name + name)
            try:
                os.link(self._path, original)
            except FileExistsError:
                continue
            except OSError:     # a file system without hard links
                if original.exists():
                    continue
                os.rename(self._path, original)
            break
        os.replace(self._part, self._path)
        return original
