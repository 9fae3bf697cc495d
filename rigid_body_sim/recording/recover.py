"""A cut recording made whole: what a kill -9, a full disk or a power cut left gets the tail and metadata.yaml that every reader asks for.

Everything that was completely written is kept. Of the chunk in which a file is cut (at most 0.1 s of a node's recording) the messages are
kept if it is not compressed; half a compressed chunk cannot be decompressed. Nothing is ever invented: a chunk with a wrong checksum is
hidden, not guessed at. The file is repaired in place, so that a full disk needs room for the index only, and a second run changes nothing.
"""

import dataclasses
import fcntl
import os
import pathlib
import re
import sys

import numpy as np
import yaml

from rigid_body_sim import command_line
from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording import mcap_format, metadata
from rigid_body_sim.recording.mcap_file import PackedChunk, index_messages
from rigid_body_sim.recording.scan import Scan
from rigid_body_sim.recording.summary import read_metadata_record, tail_is_whole
from rigid_body_sim.recording.walk import Cut, heads, walk


@dataclasses.dataclass
class Recovered:
    """What became of one file.

    `messages` it holds now; `lost_messages` estimated from the size of what could not be kept, `lost_seconds` of stamps between the last
    message kept and the last in the cut chunk, `lost_bytes` dropped; `changed` is False where the file was whole.
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
        lost = f'about {self.lost_messages} messages, {self.lost_seconds:.3f} s ({self.lost_bytes} bytes)' if self.lost_bytes else 'nothing'
        return f'{self.path}: made whole, {self.messages} messages kept, lost {lost}'


def recover(path):
    """Make a recording whole: a folder, or a single .mcap file. Returns a list of Recovered, one a file.

    BadInput where there is nothing to recover, the file is no MCAP, or it is still being recorded; OSError where the disk refuses.
    """
    path = pathlib.Path(path)
    if path.is_file():
        return [recover_file(path)[0]]
    names = recording_files(path)
    if not names:
        raise BadInput(str(path), 'holds no .mcap file', 'the folder of a recording, or one of its .mcap files')
    results = [recover_file(path / name) for name in names]
    _write_metadata(path, names, [bag for _, bag in results])
    return [result for result, _ in results]


def recording_files(path):
    """Return the names of the .mcap files of a recording's folder in the order of their numbers."""
    def number(name):
        match = re.search(r'_(\d+)\.mcap$', name)
        return (int(match[1]) if match else -1, name)
    try:
        return sorted((name for name in os.listdir(path) if name.endswith('.mcap')), key=number)
    except OSError as error:
        raise BadInput(str(path), f'cannot be read ({error.strerror})', 'the folder of a recording, or an .mcap file') from error


def recover_file(path):
    """Make one file whole. Returns (Recovered, Found): what was done, and what metadata.yaml needs to know of the file."""
    try:
        with open(path, 'r+b') as stream:
            try:
                fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError as error:
                raise BadInput(str(path), 'is still being recorded', 'a recording whose recorder has ended') from error
            scan = Scan(stream)
            if not scan.cut and not scan.damaged and tail_is_whole(stream, scan.end):
                result = Recovered(path, scan.contents.message_count, 0, 0.0, 0, changed=False)
            else:
                result = _repair(path, stream, scan)
            return result, Found(stream, scan.contents, path.name)
    except (FileNotFoundError, PermissionError, IsADirectoryError) as error:
        raise BadInput(str(path), f'cannot be opened for repair ({error.strerror})', 'an .mcap file that may be written') from error


class Found:
    """What metadata.yaml tells of a file: `topics` (TopicRecords), `channels` (Channels), `file` (FileRecord), `about` (texts or None)."""

    def __init__(self, stream, contents, name):
        schemas = {number: mcap_format.read_schema(data[mcap_format.HEAD.size:])[1] for number, data in contents.schemas.items()}
        channels = [mcap_format.read_channel(data[mcap_format.HEAD.size:]) for data in contents.channels.values()]
        self.channels = channels
        self.topics = [metadata.TopicRecord(channel.topic, schemas.get(channel.schema, ''), _profiles(channel),
                                            channel.metadata.get('topic_type_hash', '')) for channel in channels]
        names = {channel.id: channel.topic for channel in channels}
        counts = {}
        for number, count in contents.counts.items():
            counts[names.get(number, '')] = counts.get(names.get(number, ''), 0) + count
        self.file = metadata.FileRecord(name, contents.start_time, contents.end_time, counts)
        self.about = read_metadata_record(stream, contents, 'rigid_body_sim')


def _profiles(channel):
    try:
        profiles = metadata.load(channel.metadata.get('offered_qos_profiles', ''))
    except yaml.YAMLError:
        profiles = None
    return profiles if isinstance(profiles, list) else []


def _repair(path, stream, scan):
    """Cut away what is not whole, hide what is damaged, write what is missing of the last chunk's indexes, then the tail."""
    contents, descriptor = scan.contents, stream.fileno()
    lost_bytes, lost_messages, lost_until = scan.lost_bytes, 0, 0
    for offset, head in scan.damaged:
        os.pwrite(descriptor, bytes([mcap_format.PRIVATE]), offset)
        lost_bytes += head.data_size
        lost_messages += _messages_in(head.size, scan)
    end = _Appender(descriptor, scan.end)
    if scan.last:
        end.index(scan.last, contents)
    if scan.cut_chunk:
        head, data = scan.cut_chunk
        kept = end.salvage(head, data, contents)
        lost_bytes -= kept
        lost_messages += _messages_in(head.size - kept, scan)
        lost_until = head.end_time
    found = Found(stream, contents, path.name)
    if read_metadata_record(stream, contents, 'rosbag2') is None:
        end.metadata('rosbag2', metadata.dump(metadata.bag_metadata(found.topics, [found.file], found.about)), contents)
    end.append(contents.tail(end.position))
    os.fsync(descriptor)
    lost_seconds = max(0, lost_until - contents.end_time) / 1e9
    return Recovered(path, contents.message_count, lost_messages, lost_seconds, lost_bytes, changed=True)


def _messages_in(size, scan):
    return max(0, round(size / scan.mean_message)) if scan.mean_message else 0


class _Appender:
    """Writes at the end of a file that is cut off at `position`."""

    def __init__(self, descriptor, position):
        self._descriptor, self.position = descriptor, position
        os.ftruncate(descriptor, position)
        if position == 0:
            self.append(mcap_format.MAGIC + mcap_format.header('ros2', 'rigid_body_sim'))

    def append(self, data):
        done = 0
        while done < len(data):
            done += os.pwrite(self._descriptor, data[done:], self.position + done)
        self.position += len(data)

    def index(self, chunk, contents):
        """Write all message indexes of a whole chunk at the end (again: some may have been there, unknown to the tail)."""
        indexes, chunk.index_places, _ = index_messages(self.position, chunk.channels, chunk.times, chunk.offsets)
        chunk.index_length = len(indexes)
        self.append(indexes)
        contents.add_chunk(chunk.index_record())

    def salvage(self, head, data, contents):
        """Write what is whole in the data of a cut chunk as a chunk, if it is not compressed. Returns the size of the records kept."""
        if head.compression:
            return 0
        try:
            offsets, others = walk(data)
        except Cut as cut:
            data, (offsets, others) = data[:cut.whole], cut.found
        if not len(offsets):
            return 0
        for opcode, begin, stop in others:
            contents.describe(opcode, data[begin:stop])
        message_heads = heads(data, offsets)
        chunk = PackedChunk(self.position, '', data, data, message_heads['channel'], message_heads['log_time'], offsets.astype(np.uint64))
        self.append(chunk.data)
        contents.add_chunk(chunk.index)
        contents.add_messages(chunk.counts, chunk.start_time, chunk.end_time)
        return len(data)

    def metadata(self, name, text, contents):
        """Write a metadata record."""
        data = mcap_format.metadata(name, {'serialized_metadata': text})
        contents.add_metadata(self.position, len(data), name)
        self.append(data)


def _write_metadata(path, names, found):
    """Write metadata.yaml if it does not tell what the files hold."""
    topics = {topic.name: topic for one in found for topic in one.topics}
    about = next((one.about for one in found if one.about), None)
    bag = metadata.bag_metadata(list(topics.values()), [one.file for one in found], about)
    try:
        there = metadata.load((path / metadata.FILE_NAME).read_text(encoding='utf-8'))[metadata.ROOT]
        told = ([file['path'] for file in there['files']], [file['message_count'] for file in there['files']], there['message_count'])
    except (OSError, UnicodeDecodeError, yaml.YAMLError, KeyError, TypeError):
        told = None
    if told != (names, [sum(one.file.counts.values()) for one in found], bag['message_count']):
        folder = os.open(path, os.O_RDONLY | os.O_DIRECTORY)
        try:
            metadata.write(folder, bag)
        finally:
            os.close(folder)


def main(arguments=None):
    """Run the command; return the exit status."""
    parser = command_line.parser('recover', 'Make a recording whole that a kill, a full disk or a power cut left cut.',
                                 'python -m rigid_body_sim recover recordings/racket')
    parser.add_argument('recording', nargs='+', help='folder of a recording, or one of its .mcap files')
    parser.add_argument('--json', action='store_true', help='machine-readable')
    return command_line.run(_run, parser.parse_args(arguments))


def _run(options):
    try:
        results = [result for path in options.recording for result in recover(path)]
    except OSError as error:
        print(f'{error.filename or "recover"}: the disk refuses ({error.strerror}); make room and run it again', file=sys.stderr)
        return command_line.CHECK_FAILED
    if options.json:
        command_line.print_json([{**dataclasses.asdict(result), 'path': str(result.path)} for result in results])
    else:
        print(*results, sep='\n')
    return command_line.GOOD


if __name__ == '__main__':
    sys.exit(main())
