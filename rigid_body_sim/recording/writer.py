# SPDX-License-Identifier: Apache-2.0
"""Recordings as rosbag2 in Jazzy writes them: a folder of ``<bag>_0.mcap``, ... and metadata.yaml.

::

    made = TickMessages([OUTPUTS['pose']], scene, Frames())
    pose = Topic('/pose', 'geometry_msgs/msg/PoseStamped')
    with Writer('run', ticking=[(pose, made.sizes[0])],
                others=[Topic('/scene', 'std_msgs/msg/String')], journal=journal_topic(),
                about={'scene': text}) as writer:
        writer.message('/scene', stamp, wall_clock, cdr.encode(...))
        writer.ticks(0, stamps, wall_clocks, made.columns(vectors, energies, squares, stamps))

log_time is the stamp (it never falls: an older one is raised to the last), publish_time the wall
clock, both in ns; ``sequence`` counts ticks. metadata.yaml is written last, so its counts match
the files.
"""

import errno
import fcntl
import os
import pathlib
import re

import numpy as np
from mcap.records import Channel, Schema

from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages.definitions import definition
from rigid_body_sim.recording import compression, metadata
from rigid_body_sim.recording.mcap import chunks
from rigid_body_sim.recording.mcap.writing import McapFile
from rigid_body_sim.recording.topics import journal_message

# Larger chunks compress no better (64 KiB: 230 ticks of the four topics); flush() makes smaller.
CHUNK_SIZE = 64 * 1024
# Keeps the index of a file, which stays in memory until it closes, below 40 MB.
LARGEST_FILE = 4 * 10**9
# fewer ticks are added faster one by one
FEW = 8
ABOUT = 'rigid_body_sim'
"""Name of the metadata record that says what the run is about."""


class Writer:
    """Writes a recording. Not thread-safe.

    More than eight arguments: all is settled at the start, and most have a default.

    Parameters
    ----------
    path : path-like
        The folder to make; its name is the bag's. With `resume` it exists, and the recording goes
        on with the next file.
    ticking : sequence of (Topic, int)
        What is recorded at every tick, in this order: the topic and the size of its messages,
        which never changes.
    others : sequence of Topic
        All other topics.
    journal : Topic
        See :func:`rigid_body_sim.recording.topics.journal_topic`.
    about : dict of str to str
        All about the run; kept in metadata.yaml, in a metadata record of each file, and in the
        journal.
    compression_name : str
        ``zstd``, ``lz4`` or ``none``.
    split_bytes, split_seconds : float
        A new file begins after so many bytes or seconds of stamps; 0 means never (but a file never
        grows beyond 4 GB).
    resume : list of FileRecord, optional
        The whole files that are there.

    Attributes
    ----------
    state_wanted : bool
        True where the caller should write the full state into the journal (start, new file) and
        then set it False.
    bytes_written : int

    Raises
    ------
    BadInput
        Where nothing can be recorded.
    OSError
        By every method when the disk refuses. Nothing recorded before is lost then, and the call
        may be repeated.
    """

    def __init__(self, path, ticking, others, journal, about,
                 compression_name=compression.DEFAULT, split_bytes=0, split_seconds=0.0,
                 resume=()):
        self._compression = compression.in_format(compression_name)
        self.path = pathlib.Path(path)
        self._topics = [topic for topic, _ in ticking] + [*others, journal]
        self._numbers = {topic.name: number for number, topic in enumerate(self._topics, 1)}
        if len(self._numbers) < len(self._topics):
            raise BadInput('topics', 'two have the same name', 'names that differ')
        self._journal = journal.name
        self._about = {key: str(value) for key, value in about.items()}
        self._split_bytes = min(split_bytes or LARGEST_FILE, LARGEST_FILE)
        self._split_nanoseconds = round(split_seconds * 1e9)
        self._tick = chunks.tick_records([size for _, size in ticking])
        self._files = list(resume)
        self._records, self._entries, self._pending = [], [], 0
        self.last_time = max((file.end_time for file in self._files), default=0)
        self.bytes_written = self.messages_written = 0
        self.state_wanted = True
        self._file = None
        self._folder = _open_folder(self.path, exists=bool(resume))
        self._open_file()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def _file_name(self, number):
        return f'{self.path.name}_{number}.mcap'

    def _open_file(self):
        name = self._file_name(_next_number(self._files))
        descriptor = os.open(name, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o644, dir_fd=self._folder)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)     # keeps recover away
            # a file that is cut later than this is complete but for its messages
            self._file = McapFile(descriptor, self._compression, self._descriptions(),
                                  (ABOUT, self._about))
        except OSError:
            os.close(descriptor)
            os.unlink(name, dir_fd=self._folder)
            raise
        self._first_time = None
        self.bytes_written += self._file.size
        self.state_wanted = True

    def _descriptions(self):
        """Return the records of the message types and of the topics."""
        types = list(dict.fromkeys(topic.type for topic in self._topics))
        schemas = [Schema(number, definition(name).text.encode(), 'ros2msg', name)
                   for number, name in enumerate(types, 1)]
        channels = [Channel(self._numbers[topic.name], topic.name, 'cdr',
                            {'offered_qos_profiles': topic.qos_text(),
                             'topic_type_hash': definition(topic.type).hash},
                            types.index(topic.type) + 1) for topic in self._topics]
        return [*schemas, *channels]

    def message(self, topic_name, log_time, publish_time, data, sequence=0):
        """Record one message of any topic."""
        self._begin(log_time, publish_time)
        self._add_message(topic_name, log_time, publish_time, data, sequence)

    def _begin(self, log_time, publish_time):
        """Make room, open the next file if there is none, and begin its journal.

        Raises OSError before anything is taken.
        """
        if self._pending >= CHUNK_SIZE:
            self.flush()
        if self._file is None:
            self._open_file()
        if self._first_time is None:
            self._first_time = max(self.last_time, log_time)
            self._add_message(self._journal, log_time, publish_time,
                              journal_message('begin', **self._about), 0)

    def _add_message(self, topic_name, log_time, publish_time, data, sequence):
        self.last_time = max(self.last_time, log_time)
        number = self._numbers[topic_name]
        record = chunks.message(number, sequence & 0xffffffff, self.last_time, publish_time, data)
        self._add(record, chunks.ENTRY_BYTES(number, self.last_time, self._pending))

    def _add(self, records, entries):
        self._records.append(records)
        self._entries.append(entries)
        self._pending += len(records)

    def ticks(self, sequence, log_times, publish_times, messages):
        """Record n ticks in a row, numbered from `sequence`.

        Parameters
        ----------
        sequence : int
        log_times, publish_times : array (n,)
            ns.
        messages : sequence of uint8 arrays (n, size)
            For each ticking topic its messages.

        Returns
        -------
        int
            How many were taken: all, or fewer where the disk refused after the first (then the
            next call raises OSError).
        """
        log_times = np.maximum(np.asarray(log_times, np.int64), self.last_time)
        log_times = np.maximum.accumulate(log_times).astype(np.uint64)
        count, done = len(log_times), 0
        while done < count:
            try:
                self._begin(int(log_times[done]), int(publish_times[done]))
            except OSError:
                if done == 0:
                    raise
                break
            room = -(-(CHUNK_SIZE - self._pending) // self._tick.itemsize)
            end = min(count, done + max(1, room))
            add = self._add_few_ticks if end - done < FEW else self._add_ticks
            add(sequence + done, log_times[done:end], publish_times[done:end],
                [rows[done:end] for rows in messages])
            done = end
        return done

    def _add_few_ticks(self, sequence, log_times, publish_times, messages):
        for k, log_time in enumerate(log_times.tolist()):
            for topic, rows in zip(self._topics, messages):
                self._add_message(topic.name, log_time, int(publish_times[k]), rows[k].tobytes(),
                                  sequence + k)

    def _add_ticks(self, sequence, log_times, publish_times, messages):
        self._add(*chunks.ticks(self._tick, sequence, log_times, publish_times, messages,
                                self._pending))
        self.last_time = int(log_times[-1])

    def flush(self):
        """Write what is pending as a chunk; after that a kill of this process loses none of it."""
        if not self._pending:
            return
        if self._file.deleted:
            raise OSError(errno.ENOENT, 'the recording was deleted', str(self.path))
        entries = np.frombuffer(b''.join(self._entries), chunks.ENTRY)
        before = self._file.size
        self._file.chunk(b''.join(self._records), entries['channel'], entries['time'],
                         entries['offset'])
        self.bytes_written += self._file.size - before
        self.messages_written += len(entries)
        self._records, self._entries, self._pending = [], [], 0
        passed = self.last_time - self._first_time
        seconds_up = self._split_nanoseconds and passed >= self._split_nanoseconds
        if self._file.size >= self._split_bytes or seconds_up:
            self._finish_file()

    def _bag(self, *files):
        topics = [metadata.TopicRecord(topic.name, topic.type, [topic.qos()],
                                       definition(topic.type).hash) for topic in self._topics]
        return metadata.bag_metadata(topics, files, self._about)

    def _finish_file(self):
        """Close the current file, with what rosbag2 wants to find in it."""
        contents = self._file.contents
        names = {number: name for name, number in self._numbers.items()}
        counts = {names[number]: count for number, count in contents.counts.items()}
        file = metadata.FileRecord(self._file_name(_next_number(self._files)),
                                   contents.start_time, contents.end_time, counts)
        before = self._file.size
        told = {'serialized_metadata': metadata.dump(self._bag(*self._files, file))}
        self._file.metadata('rosbag2', told)
        self._file.finish()
        self.bytes_written += self._file.size - before
        self._files.append(file)
        self._file = None

    def close(self):
        """Write what is pending, close the file, write metadata.yaml.

        After an OSError the files are left cut but recoverable.
        """
        if self._folder is None:
            return
        try:
            self.flush()
            if self._file is not None:
                self._finish_file()
            metadata.write(self._folder, self._bag(*self._files))
        finally:
            if self._file is not None:
                self._file.close()
            os.close(self._folder)
            self._folder = self._file = None


def _next_number(files):
    """Return the number of the file after these FileRecords."""
    numbers = [int(match[1]) for file in files
               if (match := re.search(r'_(\d+)\.mcap$', file.name))]
    return max(numbers, default=-1) + 1


def _open_folder(path, exists):
    """Make the folder of a recording and return a descriptor for it.

    It stays good when the folder is renamed.
    """
    try:
        path.mkdir(parents=True, exist_ok=exists)
        return os.open(path, os.O_RDONLY | os.O_DIRECTORY)
    except FileExistsError as error:
        raise BadInput(str(path), 'exists already',
                       'the name of a recording that does not exist yet') from error
    except OSError as error:
        raise BadInput(str(path), f'no recording can be made here ({error.strerror})',
                       'a folder that can be written') from error
