"""Recordings read: our own and those of ``ros2 bag record``, as columns of numbers or message by message.

::

    recording = Recording('recordings/run')             # a folder, or an .mcap file
    pose = recording.read('/pose', ['header.stamp', 'pose.orientation'])         # {'log_time': (n,), ..., 'pose.orientation': (n, 4)}
    for topic, block in recording.blocks(['/energy']):  # streaming: some thousand messages at a time
        block['data']
    for message in recording.messages():                # in the order of time, for replay
        message.topic, message.log_time, message.data
    recording.journal()                                 # what happened: commands, resets, gaps, full states

Memory stays bounded by the largest chunk, also for files from strangers: what such a file claims is checked before it is believed.
"""

import json
import os
import pathlib
import typing

import numpy as np
import yaml

from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording import metadata
from rigid_body_sim.recording.columns import Decoder
from rigid_body_sim.recording.file_reader import FileReader


class Message(typing.NamedTuple):
    """One recorded message: times in ns, `data` as it went over the wire."""

    log_time: int
    topic: str
    publish_time: int
    sequence: int
    data: bytes


class RecordedTopic:
    """A topic of a recording: `name`, `type`, `hash` of the type, `qos` (YAML text of the offered profiles), `count` of messages."""

    def __init__(self, name, channel, schema):
        self.name, self.type, self.count = name, schema.name, 0
        self.hash, self.qos = channel.metadata.get('topic_type_hash', ''), channel.metadata.get('offered_qos_profiles', '')
        self._encodings = (channel.encoding, schema.encoding)
        self._text = schema.text

    def decoder(self):
        """Return the Decoder of its messages; BadInput where they are not CDR of a ros2msg type."""
        message_encoding, schema_encoding = self._encodings
        if message_encoding != 'cdr':
            raise BadInput(self.name, f'messages are encoded as {message_encoding!r}', 'a recording of ROS 2 messages (cdr)')
        return Decoder(self.type, self._text if schema_encoding == 'ros2msg' else '')


class Recording:
    """A recording, opened. BadInput where there is none, it is cut (then recover makes it whole), or it makes no sense.

    Attributes: `path`; `topics`, dict of name to RecordedTopic; `start_time` and `end_time` in ns, `message_count`; `about`, dict of texts
    that the recorder left (of ours: scene, parameters, version, machine), empty if it left none.
    """

    def __init__(self, path):
        self.path = pathlib.Path(path)
        names, custom = ([self.path], {}) if self.path.is_file() else _files_of(self.path)
        self._files = [FileReader(name) for name in names]
        self.topics = {}
        for file in self._files:
            for number, channel in file.channels.items():
                topic = self.topics.setdefault(channel.topic, RecordedTopic(channel.topic, channel, file.schema(channel)))
                topic.count += file.counts.get(number, 0)
        used = [file for file in self._files if file.counts]
        self.start_time = min((file.start_time for file in used), default=0)
        self.end_time = max((file.end_time for file in used), default=0)
        self.message_count = sum(topic.count for topic in self.topics.values())
        self._decoders = {}
        self.about = self._about(custom)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        """Close the files."""
        for file in self._files:
            file.close()

    def _about(self, custom):
        """Return what the recorder left: in the files, in metadata.yaml, or in the journal (which survives a conversion)."""
        found = next(filter(None, (file.metadata('rigid_body_sim') for file in self._files)), custom)
        if not found:
            begin = next((entry for entry in self.journal() if entry['kind'] == 'begin'), {})
            found = {key: value for key, value in begin.items() if isinstance(value, str) and key not in ('kind', 'topic')}
        return found

    def topic(self, name):
        """Return a RecordedTopic; BadInput for an unknown name."""
        if name not in self.topics:
            raise BadInput(str(self.path), f'no topic {name!r} was recorded', f'one of {", ".join(sorted(self.topics))}')
        return self.topics[name]

    def decoder(self, name):
        """Return the Decoder of a topic's messages (the same each time)."""
        if name not in self._decoders:
            self._decoders[name] = self.topic(name).decoder()
        return self._decoders[name]

    def _pieces(self, topics, start, end):
        """Yield (file, topic names by channel, Piece) with messages of the topics in [start, end], in the order of the pieces' times."""
        for name in topics or ():
            self.topic(name)
        start, end = int(start), int(end)       # exact beside the file's unsigned times
        pieces = []
        for file in self._files:
            channels = {number: channel.topic for number, channel in file.channels.items() if topics is None or channel.topic in topics}
            pieces += [(place.start_time, len(pieces) + index, file, channels, place) for index, place in enumerate(file.places())
                       if place.end_time >= start and place.start_time <= end and (not place.channels or place.channels & channels.keys())]
        for _, _, file, channels, place in sorted(pieces, key=lambda piece: piece[:2]):
            yield channels, file.piece(place, channels, start, end), place

    def blocks(self, topics=None, names=None, start=0, end=2**63, progress=None):
        """Yield (topic, columns) for each topic in each chunk.

        Columns are those of :mod:`rigid_body_sim.messages.layout` plus ``log_time`` and ``publish_time`` (int64, ns) and ``sequence``.
        `names` chooses columns; `start` and `end` (ns of log time, inclusive) choose messages; `progress` is called with the number of
        messages done.
        """
        for channels, piece, _ in self._pieces(topics, start, end):
            for number, topic in channels.items():
                mine = piece.heads['channel'] == number
                if not mine.any():
                    continue
                heads = piece.heads[mine]
                columns = {'log_time': heads['log_time'].astype(np.int64), 'publish_time': heads['publish_time'].astype(np.int64),
                           'sequence': heads['sequence'].copy()}
                columns.update(self.decoder(topic).columns(piece.records, piece.offsets[mine], heads['length'].astype(np.int64), names))
                yield topic, columns
            if progress:
                progress(len(piece.heads))

    def read(self, topic, names=None, start=0, end=2**63, progress=None):
        """Return the columns of one topic (all that every message has, or those in `names`) in the order of log time."""
        blocks = [columns for _, columns in self.blocks([topic], names, start, end, progress)]
        if not blocks:
            return {'log_time': np.empty(0, np.int64), 'publish_time': np.empty(0, np.int64), 'sequence': np.empty(0, np.uint32)}
        common = [name for name, column in blocks[0].items()
                  if all(name in block and block[name].shape[1:] == column.shape[1:] for block in blocks)]
        joined = {}
        for name in common:
            joined[name] = np.concatenate([block.pop(name) for block in blocks])
        if (np.diff(joined['log_time']) < 0).any():
            order = np.argsort(joined['log_time'], kind='stable')
            joined = {name: column[order] for name, column in joined.items()}
        return joined

    def messages(self, topics=None, start=0, end=2**63):
        """Yield the Messages of all topics, or those named, in the order of log time (equal times: as recorded)."""
        pending, pieces = [], self._pieces(topics, start, end)
        for channels, piece, place in pieces:
            ready = next((index for index, entry in enumerate(pending) if entry[0] >= place.start_time), len(pending))
            yield from pending[:ready]
            pending = pending[ready:] + piece.messages(channels, Message)
            pending.sort(key=lambda message: message.log_time)
        yield from pending

    def decoded(self, topic, start=0, end=2**63):
        """Yield (log_time, nested dict) for each message of a topic: for types whose sequences vary, like diagnostics."""
        decoder = self.decoder(topic)
        for message in self.messages([topic], start, end):
            yield message.log_time, decoder.decode(message.data)

    def journal(self):
        """Return the entries of the journals in order: dicts with ``kind``, what the recorder wrote, ``log_time`` and ``topic``.

        [] in foreign recordings.
        """
        entries = []
        for name, topic in self.topics.items():
            if name.rpartition('/')[2] == 'journal' and topic.type == 'std_msgs/msg/String':
                for log_time, message in self.decoded(name):
                    try:
                        entry = json.loads(message['data'])
                    except (ValueError, KeyError, TypeError, RecursionError):
                        continue
                    if isinstance(entry, dict) and isinstance(entry.get('kind'), str):
                        entries.append({**entry, 'log_time': log_time, 'topic': name})
        return entries


def _files_of(path):
    """Return the paths of a recording folder's files and its custom_data, as metadata.yaml tells."""
    where = path / metadata.FILE_NAME
    remedy = 'the folder of a recording; "recover" makes one whole whose recorder was killed'
    try:
        if os.path.getsize(where) > 2**26:
            raise BadInput(str(where), 'is larger than 64 MB', 'a metadata.yaml as rosbag2 writes it')
        bag = metadata.load(where.read_text(encoding='utf-8'))[metadata.ROOT]
        storage, mode = bag['storage_identifier'], bag.get('compression_mode') or ''
        names = [pathlib.PurePath(name).name for name in bag['relative_file_paths']]
        custom = bag.get('custom_data') or {}
        custom = {str(key): str(value) for key, value in custom.items()}
    except OSError as error:
        raise BadInput(str(path), f'holds no {metadata.FILE_NAME} that can be read ({error.strerror})', remedy) from error
    except (UnicodeDecodeError, yaml.YAMLError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise BadInput(str(where), 'is not the metadata of a recording', remedy) from error
    if storage != 'mcap':
        raise BadInput(str(path), f'is stored as {storage!r}', 'an mcap recording ("ros2 bag convert" makes one)')
    if mode.lower() in ('file', 'message'):
        raise BadInput(str(path), f'whole {mode.lower()}s of it are compressed', 'compressed chunks ("ros2 bag convert" makes them)')
    return [path / name for name in names], custom
