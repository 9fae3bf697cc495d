# SPDX-License-Identifier: Apache-2.0
"""The subcommand `export`: a recording to CSV, Parquet or NumPy.

It is read a chunk at a time, so its length does not matter. Topics whose messages keep their form
(numbers, times, frames) become tables, one per topic: a column per number
(``pose.orientation.x``), a column ``seconds`` since the start of the recording, times in ns. What
was recorded at every tick is also joined into one table, `ticks`. All other topics (diagnostics,
events, scene, journal) become ``.jsonl``: one decoded message per line.
"""

import csv
import json
import os
import pathlib
import re
import shutil
import sys

import numpy as np
from tqdm import tqdm

from rigid_body_sim import command_line
from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording.folders import newest_recording
from rigid_body_sim.recording.reader import Recording
from rigid_body_sim.recording.tables import Joined, flat, seconds

try:
    import pyarrow
    import pyarrow.parquet
except ImportError:
    pyarrow = None

JOINED = 'ticks'
"""Name of the table of all that was recorded at every tick."""
_TEXTS = ('std_msgs/msg/String', 'diagnostic_msgs/msg/DiagnosticStatus',
          'diagnostic_msgs/msg/DiagnosticArray')


class CsvTable:
    """Rows of comma-separated values; numbers keep all their digits."""

    SUFFIX = '.csv'

    def __init__(self, path):
        # closed by close
        self._stream = open(path, 'w', newline='', encoding='utf-8')    # noqa: SIM115
        self._writer = csv.writer(self._stream)
        self._names = None

    def add(self, columns):
        """Append rows: name -> (n,)."""
        if self._names is None:
            self._names = list(columns)
            self._writer.writerow(self._names)
        self._writer.writerows(zip(*(columns[name].tolist() for name in self._names), strict=True))

    def close(self):
        """Finish the file."""
        self._stream.close()


class ParquetTable:
    """A Parquet file, compressed by zstd, a row group per hundred thousand rows."""

    SUFFIX = '.parquet'
    _GROUP = 100_000

    def __init__(self, path):
        self._path, self._writer, self._waiting, self._rows = path, None, [], 0

    def add(self, columns):
        """Append rows: name -> (n,)."""
        self._waiting.append(pyarrow.table(columns))
        self._rows += self._waiting[-1].num_rows
        if self._rows >= self._GROUP:
            self._write()

    def _write(self):
        table = pyarrow.concat_tables(self._waiting)
        self._writer = self._writer or pyarrow.parquet.ParquetWriter(self._path, table.schema,
                                                                     compression='zstd')
        self._writer.write_table(table)
        self._waiting, self._rows = [], 0

    def close(self):
        """Finish the file."""
        if self._waiting:
            self._write()
        if self._writer:
            self._writer.close()


class NumpyTable:
    """A ``.npy`` file: one structured array, a field per column.

    ``numpy.load(..., mmap_mode='r')`` opens it without reading it all.
    """

    SUFFIX = '.npy'
    _HEADER, _LONGEST_TEXT = 4096, 64

    def __init__(self, path):
        self._stream = open(path, 'wb')     # noqa: SIM115, closed by close
        self._stream.write(bytes(self._HEADER))
        self._dtype, self._rows = np.dtype([]), 0

    def add(self, columns):
        """Append rows: name -> (n,)."""
        if not self._rows:
            text = f'U{self._LONGEST_TEXT}'
            self._dtype = np.dtype([(name, text if column.dtype.kind == 'U' else column.dtype)
                                    for name, column in columns.items()])
        rows = np.empty(len(next(iter(columns.values()))), self._dtype)
        for name, column in columns.items():
            if column.dtype.kind == 'U' and column.dtype.itemsize > rows.dtype[name].itemsize:
                raise BadInput(f'--format numpy: {name}',
                               f'a text of more than {self._LONGEST_TEXT} letters',
                               'another format')
            rows[name] = column
        self._stream.write(rows.tobytes())
        self._rows += len(rows)

    def close(self):
        """Write the header, whose place was kept, and finish the file."""
        text = repr({'descr': np.lib.format.dtype_to_descr(self._dtype), 'fortran_order': False,
                     'shape': (self._rows,)})
        text = text.encode('latin1').ljust(self._HEADER - 11) + b'\n'
        if len(text) != self._HEADER - 10:
            raise BadInput('--format numpy', f'{len(self._dtype.names)} columns',
                           'a topic with fewer, or another format')
        self._stream.seek(0)
        self._stream.write(b'\x93NUMPY\x01\x00' + (self._HEADER - 10).to_bytes(2, 'little') + text)
        self._stream.close()


TABLES = {'csv': CsvTable, 'parquet': ParquetTable, 'numpy': NumpyTable}


def export(path, folder, form, topics=None, bar=None):
    """Write the topics of a recording (all, or those named) into a new folder.

    The folder appears once it is complete: an export that was interrupted can be repeated.

    Parameters
    ----------
    path : path-like
        A recording's folder or an .mcap file.
    folder : path-like
        To be made.
    form : str
        ``csv``, ``parquet`` or ``numpy``.
    topics : sequence of str, optional
    bar : tqdm, optional
        Counts messages.

    Returns
    -------
    list of pathlib.Path
        What was written.

    Raises
    ------
    BadInput
        Where the recording or the folder will not do, or a table's messages change their form.
    OSError
        Where the disk refuses.
    """
    if form == 'parquet' and pyarrow is None:
        raise BadInput('--format parquet', 'pyarrow is not installed',
                       'pip install pyarrow, or --format csv or numpy')
    folder = pathlib.Path(folder)
    if folder.exists():
        raise BadInput(str(folder), 'cannot be made (File exists)',
                       'a folder that does not exist yet')
    with Recording(path) as recording:
        chosen = ([recording.topic(name) for name in topics] if topics
                  else list(recording.topics.values()))
        if bar is not None:
            bar.reset(sum(topic.count for topic in chosen))
        part = folder.with_name(f'.{folder.name}.part')
        try:
            shutil.rmtree(part, ignore_errors=True)     # the rest of an export that was killed
            part.mkdir(parents=True)
        except OSError as error:
            raise BadInput(str(folder), f'cannot be made ({error.strerror})',
                           'a folder that can be written') from error
        try:
            names = _write(recording, chosen, part, TABLES[form], bar)
            os.rename(part, folder)
        except BaseException:
            shutil.rmtree(part, ignore_errors=True)
            raise
    return [folder / name for name in names]


def _write(recording, chosen, folder, kind, bar):
    """Write all files; return their names."""
    done = bar.update if bar is not None else None
    written = [_export_texts(recording, topic, folder, done) for topic in chosen
               if topic.type in _TEXTS]
    topics = [topic for topic in chosen if topic.type not in _TEXTS and topic.count]
    tables = {topic.name: _file_name(topic.name) for topic in topics}
    most = max((topic.count for topic in topics), default=0)
    ticking = {topic.name: tables[topic.name] for topic in topics if topic.count == most}
    joined = None
    if len(ticking) > 1 and JOINED not in tables.values():
        joined, tables[None] = Joined(ticking), JOINED
    files = {name: kind(folder / f'{file}{kind.SUFFIX}') for name, file in tables.items()}
    try:
        for name, columns in _flat_blocks(recording, [topic.name for topic in topics], done):
            files[name].add(columns)
            rows = joined.add(name, columns) if joined and name in ticking else None
            if rows:
                rows = {'seconds': seconds(rows['log_time'], recording.start_time), **rows}
                files[None].add(rows)
    except KeyError as error:
        raise BadInput(str(recording.path),
                       f'messages lack {error} that others before them have',
                       'other topics') from error
    finally:
        for file in files.values():
            file.close()
    return written + [f'{file}{kind.SUFFIX}' for file in tables.values()]


def _flat_blocks(recording, topics, done):
    """Yield (topic, columns) of numbers and texts, each block with its seconds."""
    for name, columns in recording.blocks(topics, progress=done) if topics else ():
        columns = flat(columns, recording.decoder(name).components)
        yield name, {'seconds': seconds(columns['log_time'], recording.start_time), **columns}


def _file_name(topic):
    return re.sub(r'[^\w.-]', '.', topic.strip('/'))


def _export_texts(recording, topic, folder, done):
    """Write one decoded message per line; return the file's name."""
    name = f'{_file_name(topic.name)}.jsonl'
    with open(folder / name, 'w', encoding='utf-8') as stream:
        for log_time, message in recording.decoded(topic.name):
            text = json.dumps({'log_time': log_time, **message}, ensure_ascii=False)
            stream.write(text + '\n')
            if done:
                done(1)
    return name


def main(arguments=None):
    """Run the subcommand; return the exit status."""
    parser = command_line.parser(
        'export', 'Write a recording to CSV, Parquet or NumPy: one file per topic, and one table '
        'of all that was recorded at every tick.',
        'python -m rigid_body_sim export recordings/racket --output racket_csv --format csv')
    parser.add_argument('recording', help='folder of a recording, or an .mcap file; a folder of '
                        'recordings: the newest in it')
    parser.add_argument('--output', required=True, metavar='FOLDER', help='folder to make')
    parser.add_argument('--format', choices=sorted(TABLES), default='csv',
                        help='csv (default), numpy or parquet')
    parser.add_argument('--topics', nargs='+', metavar='TOPIC', help='only these topics')
    parser.add_argument('--json', action='store_true', help='print the paths as JSON')
    return command_line.run(_run, parser.parse_args(arguments))


def _run(options):
    path, others = newest_recording(options.recording)
    if others:
        print(f'{path}: the newest of {others + 1} recordings', file=sys.stderr)
    try:
        with tqdm(desc=str(path), unit=' messages', unit_scale=True, disable=None,
                  leave=False) as bar:
            paths = export(path, options.output, options.format, options.topics, bar)
    except OSError as error:
        print(f'{options.output}: the disk refuses ({error.strerror}); make room and run it again',
              file=sys.stderr)
        return command_line.CHECK_FAILED
    if options.json:
        command_line.print_json([str(path) for path in paths])
    else:
        print(*paths, sep='\n')
    return command_line.GOOD


if __name__ == '__main__':
    sys.exit(main())
