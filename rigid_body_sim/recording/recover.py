# SPDX-License-Identifier: Apache-2.0
"""The subcommand `recover`: make a cut or damaged recording whole.

What a kill -9, a full disk or a power cut left behind gets the tail and metadata.yaml that every
reader needs. Everything that was completely written is kept, and of the chunk in which a file is
cut (at most 0.1 s of a node's recording) what can be decompressed. Then only what lies after the
last whole record is replaced, so that a full disk needs room for the index only. Where bytes are
wrong, each chunk is read by redundant information, and the file is rewritten beside the old one,
which stays as NAME.mcap.orig. What is lost is counted by the statistics, the message indexes, the
sequence numbers or metadata.yaml; where none of them tells, it is reported as unknown. A second
run changes nothing.
"""

import dataclasses
import os
import pathlib
import re
import sys

import yaml

from rigid_body_sim import command_line
from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording import metadata
from rigid_body_sim.recording.needed import need_mcap


def recover(path):
    """Make a recording whole: a folder, or a single .mcap file.

    Returns
    -------
    list of Recovered
        One a file, see :mod:`rigid_body_sim.recording.repair`.

    Raises
    ------
    BadInput
        Where there is nothing to recover, the file is no MCAP, or it is still being recorded.
    OSError
        Where the disk refuses.
    """
    need_mcap()
    from rigid_body_sim.recording.repair import recover_file
    path = pathlib.Path(path)
    if path.is_file():
        return [recover_file(path)[0]]
    names = recording_files(path)
    if not names:
        raise BadInput(str(path), 'holds no .mcap file',
                       'the folder of a recording, or one of its .mcap files')
    bag = _told(path)
    counts = {file.get('path'): file.get('message_count') for file in bag.get('files', ())}
    results = [recover_file(path / name, counts.get(name)) for name in names]
    _write_metadata(path, names, [found for _, found in results], bag)
    return [result for result, _ in results]


def recording_files(path):
    """Return the names of a folder's .mcap files in the order of their numbers."""
    def number(name):
        match = re.search(r'_(\d+)\.mcap$', name)
        return (int(match[1]) if match else -1, name)
    try:
        return sorted((name for name in os.listdir(path) if name.endswith('.mcap')), key=number)
    except OSError as error:
        raise BadInput(str(path), f'cannot be read ({error.strerror})',
                       'the folder of a recording, or an .mcap file') from error


def _told(path):
    """Return the map in a folder's metadata.yaml, {} where it makes no sense."""
    try:
        bag = metadata.load((path / metadata.FILE_NAME).read_text(encoding='utf-8'))[metadata.ROOT]
        good = all(isinstance(file['path'], str) and isinstance(file['message_count'], int)
                   for file in bag['files']) and isinstance(bag['message_count'], int)
    except (OSError, UnicodeDecodeError, yaml.YAMLError, LookupError, TypeError):
        return {}
    return bag if good else {}


def _write_metadata(path, names, found, bag):
    """Write metadata.yaml if `bag`, what it told, is not what the files hold."""
    topics = {topic.name: topic for one in found for topic in one.topics}
    about = next((one.about for one in found if one.about), bag.get('custom_data'))
    now = metadata.bag_metadata(list(topics.values()), [one.file for one in found], about)
    told = [(file['path'], file['message_count']) for file in bag.get('files', ())]
    counts = [(name, sum(one.file.counts.values()))
              for name, one in zip(names, found, strict=True)]
    if not bag or told != counts or bag['message_count'] != now['message_count']:
        folder = os.open(path, os.O_RDONLY | os.O_DIRECTORY)
        try:
            metadata.write(folder, now)
        finally:
            os.close(folder)


def main(arguments=None):
    """Run the subcommand; return the exit status."""
    parser = command_line.parser(
        'recover', 'Make a recording whole that a kill, a full disk or a power cut left cut.',
        'python -m rigid_body_sim recover recordings/racket')
    parser.add_argument('recording', nargs='+',
                        help='folder of a recording, or one of its .mcap files')
    parser.add_argument('--json', action='store_true', help='machine-readable')
    return command_line.run(_run, parser.parse_args(arguments))


def _run(options):
    try:
        results = [result for path in options.recording for result in recover(path)]
    except OSError as error:
        print(f'{error.filename or "recover"}: the disk refuses ({error.strerror}); make room and '
              f'run it again', file=sys.stderr)
        return command_line.CHECK_FAILED
    if options.json:
        command_line.print_json([
            {name: str(value) if isinstance(value, pathlib.Path) else value
             for name, value in dataclasses.asdict(result).items()} for result in results])
    else:
        print(*results, sep='\n')
    return command_line.GOOD


if __name__ == '__main__':
    sys.exit(main())
