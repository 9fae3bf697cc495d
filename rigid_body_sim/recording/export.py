"""The command `export`: a recording to CSV, Parquet or NumPy, one file a topic; read a chunk at a time, so its length does not matter.

Topics whose messages keep their form (numbers, times, frames) become tables: one column a number (``pose.orientation.x``), times in ns. All
others (diagnostics, events, scene, journal) become ``.jsonl``: one decoded message a line.
"""

import csv
import json
import pathlib
import re
import sys

import numpy as np
from tqdm import tqdm

from rigid_body_sim import command_line
from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording.reader import Recording

try:
    import pyarrow
    import pyarrow.parquet
except ImportError:
    pyarrow = None

_TEXTS = ('std_msgs/msg/String', 'diagnostic_msgs/msg/DiagnosticStatus', 'diagnostic_msgs/msg/DiagnosticArray')


class CsvTable:
    """Rows of comma-separated values; numbers keep all their digits."""

    SUFFIX = '.csv'

    def __init__(self, path):
        self._stream = open(path, 'w', newline='', encoding='utf-8')    # noqa: SIM115, closed by close
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
    """A Parquet file, compressed by zstd, a row group a hundred thousand rows."""

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
        self._writer = self._writer or pyarrow.parquet.ParquetWriter(self._path, table.schema, compression='zstd')
        self._writer.write_table(table)
        self._waiting, self._rows = [], 0

    def close(self):
        """Finish the file."""
        if self._waiting:
            self._write()
        if self._writer:
            self._writer.close()


class NumpyTable:
    """A ``.npy`` file: one structured array, a field a column; ``numpy.load(..., mmap_mode='r')`` opens it without reading it all."""

    SUFFIX = '.npy'
    _HEADER, _LONGEST_TEXT = 4096, 64

    def __init__(self, path):
        self._stream = open(path, 'wb')     # noqa: SIM115, closed by close
        self._stream.write(bytes(self._HEADER))
        self._dtype, self._rows = np.dtype([]), 0

    def add(self, columns):
        """Append rows: name -> (n,)."""
        if not self._rows:
            self._dtype = np.dtype([(name, f'U{self._LONGEST_TEXT}' if column.dtype.kind == 'U' else column.dtype)
                                    for name, column in columns.items()])
        rows = np.empty(len(next(iter(columns.values()))), self._dtype)
        for name, column in columns.items():
            if column.dtype.kind == 'U' and column.dtype.itemsize > rows.dtype[name].itemsize:
                raise BadInput(f'--format numpy: {name}', f'a text of more than {self._LONGEST_TEXT} letters', 'another format')
            rows[name] = column
        self._stream.write(rows.tobytes())
        self._rows += len(rows)

    def close(self):
        """Write the header, whose place was kept, and finish the file."""
        text = repr({'descr': np.lib.format.dtype_to_descr(self._dtype), 'fortran_order': False, 'shape': (self._rows,)})
        text = text.encode('latin1').ljust(self._HEADER - 11) + b'\n'
        if len(text) != self._HEADER - 10:
            raise BadInput('--format numpy', f'{len(self._dtype.names)} columns', 'a topic with fewer, or another format')
        self._stream.seek(0)
        self._stream.write(b'\x93NUMPY\x01\x00' + (self._HEADER - 10).to_bytes(2, 'little') + text)
        self._stream.close()


TABLES = {'csv': CsvTable, 'parquet': ParquetTable, 'numpy': NumpyTable}


def export(path, folder, form, topics=None, progress=None):
    """Write the topics of a recording (all, or those named) into a new folder; return the paths written.

    `form` is ``csv``, ``parquet`` or ``numpy``; `progress` is called with the number of messages done. BadInput where the recording or
    the folder will not do, or the messages of a table change their form.
    """
    if form == 'parquet' and pyarrow is None:
        raise BadInput('--format parquet', 'pyarrow is not installed', 'pip install pyarrow, or --format csv or numpy')
    with Recording(path) as recording:
        chosen = [recording.topic(name) for name in topics] if topics else list(recording.topics.values())
        folder = pathlib.Path(folder)
        try:
            folder.mkdir(parents=True)
        except OSError as error:
            raise BadInput(str(folder), f'cannot be made ({error.strerror})', 'a folder that does not exist yet') from error
        written = [_export_texts(recording, topic, folder) for topic in chosen if topic.type in _TEXTS]
        tables = {topic.name: TABLES[form](folder / f'{_file_name(topic.name)}{TABLES[form].SUFFIX}')
                  for topic in chosen if topic.type not in _TEXTS and topic.count}
        try:
            for name, columns in recording.blocks(list(tables), progress=progress) if tables else ():
                tables[name].add(_flat(columns, recording.decoder(name).components))
        except KeyError as error:
            raise BadInput(str(path), f'messages lack {error} that others before them have', 'other topics') from error
        finally:
            for table in tables.values():
                table.close()
        return written + [folder / f'{_file_name(name)}{TABLES[form].SUFFIX}' for name in tables]


def _file_name(topic):
    return re.sub(r'[^\w.-]', '.', topic.strip('/'))


def _export_texts(recording, topic, folder):
    path = folder / f'{_file_name(topic.name)}.jsonl'
    with open(path, 'w', encoding='utf-8') as stream:
        for log_time, message in recording.decoded(topic.name):
            stream.write(json.dumps({'log_time': log_time, **message}, ensure_ascii=False) + '\n')
    return path


def _flat(columns, components):
    """Return one array a number: ``x.0``, ``x.1`` or, for a struct, ``pose.position.x``; texts as such."""
    flat = {}
    for name, column in columns.items():
        if column.dtype.kind == 'S':
            flat[name] = np.char.decode(column, errors='replace')
        elif column.ndim == 1:
            flat[name] = column
        else:
            parts = components.get(name, range(column.shape[1]))
            flat.update({f'{name}.{part}': np.ascontiguousarray(column[:, index]) for index, part in enumerate(parts)})
    return flat


def main(arguments=None):
    """Run the command; return the exit status."""
    parser = command_line.parser('export', 'Write a recording to CSV, Parquet or NumPy, one file a topic.',
                                 'python -m rigid_body_sim export recordings/racket --output racket_csv --format csv')
    parser.add_argument('recording', help='folder of a recording, or an .mcap file')
    parser.add_argument('--output', required=True, metavar='FOLDER', help='folder to make')
    parser.add_argument('--format', choices=sorted(TABLES), default='csv', help='csv (default), numpy or parquet')
    parser.add_argument('--topics', nargs='+', metavar='TOPIC', help='only these topics')
    parser.add_argument('--json', action='store_true', help='print the paths as JSON')
    return command_line.run(_run, parser.parse_args(arguments))


def _run(options):
    try:
        with tqdm(unit=' messages', unit_scale=True, disable=None, leave=False) as bar:
            paths = export(options.recording, options.output, options.format, options.topics, bar.update)
    except OSError as error:
        print(f'{options.output}: the disk refuses ({error.strerror}); make room and run it again into a new folder', file=sys.stderr)
        return command_line.CHECK_FAILED
    if options.json:
        command_line.print_json([str(path) for path in paths])
    else:
        print(*paths, sep='\n')
    return command_line.GOOD


if __name__ == '__main__':
    sys.exit(main())
