# SPDX-License-Identifier: Apache-2.0
"""Reading of recordings: those of this package and those of ``ros2 bag record``.

::

    from rigid_body_sim import Recording
    recording = Recording('recordings/racket')      # a folder, or an .mcap file
    recording.topics                                # name -> type, count, quality of service
    recording.states().orientation                  # arrays (n, 4), ...; so .angular_velocity, ...
    recording.events(), recording.commands()        # what happened, and what was sent to the body
    recording.scene().body.mass

    recording.read('/pose', ['header.stamp', 'pose.orientation'])   # columns of any topic
    for topic, block in recording.blocks(['/energy']):              # some thousand messages a time
        block['data']
    for message in recording.messages():                            # in the order of time
        message.topic, message.log_time, message.data
    recording.journal()                             # commands, resets, gaps, full states

Memory stays bounded by the largest chunk (and by what a method returns), also for files from
strangers: the sizes that such a file claims are checked first.
"""

import json
import pathlib
import typing

import numpy as np

from rigid_body_sim.errors import BadInput, optional
from rigid_body_sim.recording import tables
from rigid_body_sim.recording.folders import files_of
from rigid_body_sim.recording.needed import need_mcap
from rigid_body_sim.recording.topics import JOURNAL_TYPE


class Message(typing.NamedTuple):
    """One recorded message: times in ns, `data` as it went over the wire."""

    log_time: int
    topic: str
    publish_time: int
    sequence: int
    data: bytes


class RecordedTopic:
    """A topic of a recording.

    Attributes
    ----------
    name, type : str
    hash : str
        Hash of the type.
    qos : str
        YAML text of the offered profiles.
    count : int
        Messages.
    """

    def __init__(self, name, channel, schema):
        self.name, self.type, self.count = name, schema.name, 0
        self.hash = channel.metadata.get('topic_type_hash', '')
        self.qos = channel.metadata.get('offered_qos_profiles', '')
        self._message_encoding, self._schema = channel.message_encoding, schema

    def __repr__(self):
        return f'<{self.count} messages {self.type}>'

    def decoder(self):
        """Return the Decoder of its messages; BadInput where they are not CDR."""
        from rigid_body_sim.recording.columns import Decoder
        if self._message_encoding != 'cdr':
            raise BadInput(self.name, f'messages are encoded as {self._message_encoding!r}',
                           'a recording of ROS 2 messages (cdr)')
        text = self._schema.data.decode(errors='replace')
        return Decoder(self.type, text if self._schema.encoding == 'ros2msg' else '')


class Recording:
    """A recording, opened for reading.

    Parameters
    ----------
    path : path-like
        The folder of a recording, or an .mcap file.

    Attributes
    ----------
    path : pathlib.Path
    topics : dict
        Name -> RecordedTopic.
    start_time, end_time : int
        Log times of the first and the last message, ns.
    message_count : int
    about : dict of str to str
        What the recorder wrote about the run (scene, parameters, version, machine); may be empty.

    Raises
    ------
    BadInput
        Where there is none, it is cut (then recover makes it whole), or it makes no sense; also by
        the methods, for topics and columns that were not recorded.
    """

    def __init__(self, path):
        need_mcap()
        from rigid_body_sim.recording.file_reader import FileReader
        self.path = pathlib.Path(path)
        names, custom = ([self.path], {}) if self.path.is_file() else files_of(self.path)
        self._files = [FileReader(name) for name in names]
        self.topics = {}
        for file in self._files:
            for number, channel in file.channels.items():
                topic = RecordedTopic(channel.topic, channel, file.schema(channel))
                topic = self.topics.setdefault(channel.topic, topic)
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

    def __repr__(self):
        seconds = (self.end_time - self.start_time) / 1e9
        return f'Recording({str(self.path)!r}: {self.message_count} messages, {seconds:g} s)'

    def close(self):
        """Close the files."""
        for file in self._files:
            file.close()

    def _about(self, custom):
        """Return the texts that the recorder left about the run.

        It is in the files, in metadata.yaml, or in the journal (which survives a conversion).
        """
        told = (file.metadata('rigid_body_sim') for file in self._files)
        found = next(filter(None, told), custom)
        if not found:
            begin = next((entry for entry in self.journal() if entry['kind'] == 'begin'), {})
            found = {key: value for key, value in begin.items()
                     if isinstance(value, str) and key not in ('kind', 'topic')}
        return found

    def topic(self, name):
        """Return a RecordedTopic; BadInput for an unknown name."""
        if name not in self.topics:
            raise BadInput(str(self.path), f'no topic {name!r} was recorded',
                           f'one of {", ".join(sorted(self.topics))}')
        return self.topics[name]

    def decoder(self, name):
        """Return the Decoder of a topic's messages (the same each time)."""
        if name not in self._decoders:
            self._decoders[name] = self.topic(name).decoder()
        return self._decoders[name]

    # -- the simulated body -----------------------------------------------------------------------

    def scene(self, namespace=None):
        """Return the Scene that was simulated, as it was at the start.

        Parameters
        ----------
        namespace : str, optional
            Of the body, where the recording has several: ``/left``.

        Raises
        ------
        BadInput
            The recording has no scene, or several bodies and no `namespace` is given.
        """
        bodies = _bodies()
        return bodies.scene(self, bodies.namespace_of(self, namespace))

    def states(self, namespace=None, start=0, end=2**63, progress=None):
        """Return the recorded States.

        Times are seconds of stamps since the recording's first tick. The velocity was recorded
        only if ``odom`` was; otherwise it is NaN.

        Parameters
        ----------
        namespace : str, optional
            As for :meth:`scene`.
        start, end, progress
            As for :meth:`blocks`.

        Raises
        ------
        BadInput
            The topics ``pose`` and ``angular_velocity`` were not both recorded.
        """
        bodies = _bodies()
        return bodies.states(self, bodies.namespace_of(self, namespace), start, end, progress)

    def events(self, namespace=None):
        """Return what was published on ``events``, as a list of bodies.Event.

        Each has ``time`` (s since the start), ``log_time`` (ns), ``name``, ``message`` and
        ``values`` (a dict of texts). `namespace` is that of :meth:`scene`.
        """
        bodies = _bodies()
        return bodies.events(self, bodies.namespace_of(self, namespace))

    def commands(self, namespace=None):
        """Return the commands that were sent to the body, as columns.

        `namespace` is that of :meth:`scene`.

        Returns
        -------
        dict of str to array
            ``log_time`` (n,) in ns, ``tick`` (n,) at which each took effect (-1 where no journal
            tells), ``topic`` (``cmd_impulse``, ``cmd_wrench``, ``release``) and ``frame`` as
            texts, ``force`` and ``torque`` (n, 3) in N and N m, or N s and N m s of an impulse.
        """
        bodies = _bodies()
        return bodies.commands(self, bodies.namespace_of(self, namespace))

    # -- any topic --------------------------------------------------------------------------------

    def _pieces(self, topics, start, end):
        """Yield (topic names by channel, Piece, place) with messages of the topics.

        They lie in [start, end] ns and come in the order of the pieces' times.
        """
        for name in topics or ():
            self.topic(name)
        start, end = int(start), int(end)       # exact beside the file's unsigned times
        pieces = []
        for file in self._files:
            channels = {number: channel.topic for number, channel in file.channels.items()
                        if topics is None or channel.topic in topics}
            pieces += [(place.start_time, len(pieces) + index, file, channels, place)
                       for index, place in enumerate(file.places())
                       if place.end_time >= start and place.start_time <= end
                       and (not place.channels or place.channels & channels.keys())]
        for _, _, file, channels, place in sorted(pieces, key=lambda piece: piece[:2]):
            yield channels, file.piece(place, channels, start, end), place

    def blocks(self, topics=None, names=None, start=0, end=2**63, progress=None):
        """Yield (topic, columns) for each topic in each chunk.

        Columns are those of :mod:`rigid_body_sim.messages.layout` plus ``log_time`` and
        ``publish_time`` (int64, ns) and ``sequence``.

        Parameters
        ----------
        topics : sequence of str, optional
            All, without it.
        names : sequence of str, optional
            Chooses columns.
        start, end : int
            Log times in ns, inclusive, that choose messages.
        progress : callable, optional
            Called with the number of messages done.
        """
        for channels, piece, _ in self._pieces(topics, start, end):
            for number, topic in channels.items():
                mine = piece.heads['channel'] == number
                if not mine.any():
                    continue
                heads = piece.heads[mine]
                columns = {'log_time': heads['log_time'].astype(np.int64),
                           'publish_time': heads['publish_time'].astype(np.int64),
                           'sequence': heads['sequence'].copy()}
                lengths = heads['length'].astype(np.int64)
                columns.update(self.decoder(topic).columns(piece.records, piece.offsets[mine],
                                                           lengths, names))
                yield topic, columns
            if progress:
                progress(len(piece.heads))

    def read(self, topic, names=None, start=0, end=2**63, progress=None):
        """Return the columns of one topic in the order of log time.

        Parameters are those of :meth:`blocks`.

        Returns
        -------
        dict of str to array (n, ...)
            The columns in `names`; without it all columns that every message has.
        """
        blocks = [columns for _, columns in self.blocks([topic], names, start, end, progress)]
        if not blocks:
            return {'log_time': np.empty(0, np.int64), 'publish_time': np.empty(0, np.int64),
                    'sequence': np.empty(0, np.uint32)}
        common = [name for name, column in blocks[0].items()
                  if all(name in block and block[name].shape[1:] == column.shape[1:]
                         for block in blocks)]
        joined = {}
        for name in common:
            joined[name] = np.concatenate([block.pop(name) for block in blocks])
        if (np.diff(joined['log_time']) < 0).any():
            order = np.argsort(joined['log_time'], kind='stable')
            joined = {name: column[order] for name, column in joined.items()}
        return joined

    def to_pandas(self, topic, start=0, end=2**63):
        """Return one topic as a pandas.DataFrame: a column per number, seconds as the index.

        Seconds count from the start of the recording. BadInput where pandas is not installed.
        """
        pandas = optional('pandas')
        flat = tables.flat(self.read(topic, None, start, end), self.decoder(topic).components)
        seconds = tables.seconds(flat['log_time'], self.start_time)
        return pandas.DataFrame(flat, index=pandas.Index(seconds, name='seconds'))

    def to_xarray(self, topic, start=0, end=2**63):
        """Return one topic as an xarray.Dataset along ``time``, seconds since the start.

        Its variables are the columns of :meth:`read`; those with several numbers have a dimension
        more, with their names (x, y, z) as coordinates. BadInput where xarray is not installed.
        """
        return tables.dataset(optional('xarray'), self.read(topic, None, start, end),
                              self.decoder(topic).components, self.start_time)

    def messages(self, topics=None, start=0, end=2**63):
        """Yield the Messages of all topics, or those named, in the order of log time.

        Messages of equal times come as recorded. `start` and `end` are log times in ns, inclusive.
        """
        pending, pieces = [], self._pieces(topics, start, end)
        for channels, piece, place in pieces:
            ready = next((index for index, entry in enumerate(pending)
                          if entry[0] >= place.start_time), len(pending))
            yield from pending[:ready]
            pending = pending[ready:] + piece.messages(channels, Message)
            pending.sort(key=lambda message: message.log_time)
        yield from pending

    def decoded(self, topic, start=0, end=2**63):
        """Yield (log_time, nested dict) for each message of a topic.

        This reads any type, also those whose sequences vary in length, like diagnostics. Times
        are in ns; `start` and `end` are inclusive.
        """
        decoder = self.decoder(topic)
        for message in self.messages([topic], start, end):
            yield message.log_time, decoder.decode(message.data)

    def journal(self):
        """Return the entries of the journals in order.

        They are dicts with ``kind``, what the recorder wrote, ``log_time`` (ns) and ``topic``;
        [] in recordings of other programs.
        """
        entries = []
        for name, topic in self.topics.items():
            if name.rpartition('/')[2] == 'journal' and topic.type == JOURNAL_TYPE:
                for log_time, message in self.decoded(name):
                    try:
                        entry = json.loads(message['data'])
                    except (ValueError, KeyError, TypeError, RecursionError):
                        continue
                    if isinstance(entry, dict) and isinstance(entry.get('kind'), str):
                        entries.append({**entry, 'log_time': log_time, 'topic': name})
        return entries


def _bodies():
    """Return the module `bodies`; reading topics alone does not wait for numba."""
    from rigid_body_sim.recording import bodies
    return bodies
