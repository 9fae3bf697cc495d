# SPDX-License-Identifier: Apache-2.0
"""Exports read back by the tools they are for: csv, numpy, pyarrow."""

import csv
import io
import json
import os
import pathlib
import shutil

import numpy as np
import pytest
from recording.conftest import JOURNAL, START, Ticks, write
from tqdm import tqdm

from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages import cdr
from rigid_body_sim.recording import export as module
from rigid_body_sim.recording.export import export, main
from rigid_body_sim.recording.folders import newest_recording
from rigid_body_sim.recording.tables import Joined
from rigid_body_sim.recording.topics import Topic
from rigid_body_sim.recording.writer import Writer

NAMES = ['seconds', 'log_time', 'publish_time', 'sequence', 'header.stamp', 'header.frame_id',
         'pose.position.x', 'pose.position.y', 'pose.position.z', 'pose.orientation.x',
         'pose.orientation.y', 'pose.orientation.z', 'pose.orientation.w']


def test_csv_keeps_every_digit(tmp_path, recording):
    paths = export(recording, tmp_path / 'out', 'csv')
    assert sorted(path.name for path in paths) == [
        'angular_momentum_squared.csv', 'angular_velocity.csv', 'energy.csv', 'journal.jsonl',
        'pose.csv', 'scene.jsonl', 'ticks.csv']
    assert sorted(path.name for path in (tmp_path / 'out').iterdir()) == sorted(
        path.name for path in paths)
    with open(tmp_path / 'out' / 'pose.csv', newline='') as stream:
        names, *rows = csv.reader(stream)
    assert names == NAMES
    ticks = Ticks(0, 1000)
    assert [[float(number) for number in row[9:]] for row in rows] == ticks.orientation.tolist()
    assert [int(row[1]) for row in rows] == ticks.stamps.tolist()
    assert {row[5] for row in rows} == {'world'}
    assert [float(row[0]) for row in rows] == [k / 1000 for k in range(1000)]


def test_one_table_joins_all_that_was_recorded_at_every_tick(tmp_path, recording):
    export(recording, tmp_path / 'out', 'numpy')
    table = np.load(tmp_path / 'out' / 'ticks.npy')
    ticks = Ticks(0, 1000)
    np.testing.assert_array_equal(table['seconds'], np.arange(1000) / 1000)
    np.testing.assert_array_equal(table['pose.pose.orientation.w'], ticks.orientation[:, 3])
    np.testing.assert_array_equal(table['angular_velocity.vector.y'], ticks.angular_velocity[:, 1])
    np.testing.assert_array_equal(table['energy.data'], ticks.energy)
    np.testing.assert_array_equal(table['angular_momentum_squared.data'], ticks.momentum)


def test_topics_whose_blocks_end_at_different_times_are_joined():
    """As in recordings of others, whose chunks cut a tick in two; one message of b is missing."""
    def block(*times):
        return {'log_time': np.array(times), 'data': np.array(times) * 10.0}
    joined, rows = Joined({'/a': 'a', '/b': 'b'}), []
    for topic, times in (('/a', (1, 2, 3)), ('/b', (1,)), ('/a', (4,)), ('/b', (3, 4)),
                         ('/b', (5,)), ('/a', (5,))):
        made = joined.add(topic, block(*times))
        rows += list(zip(*made.values(), strict=True)) if made else []
    assert rows == [(k, 10.0 * k, 10.0 * k) for k in (1, 3, 4, 5)]


@pytest.mark.parametrize('how', [KeyboardInterrupt, OSError])
def test_an_interrupted_export_leaves_nothing_and_can_be_repeated(tmp_path, recording, monkeypatch,
                                                                 how):
    add, left = module.CsvTable.add, [3]

    def interrupted(table, columns):
        left[0] -= 1
        if not left[0]:
            raise how
        add(table, columns)
    monkeypatch.setattr(module.CsvTable, 'add', interrupted)
    with pytest.raises(how):
        export(recording, tmp_path / 'out', 'csv')
    assert list(tmp_path.iterdir()) == []
    (tmp_path / '.out.part').mkdir()        # as a kill -9 leaves it
    (tmp_path / '.out.part' / 'pose.csv').write_text('half')
    export(recording, tmp_path / 'out', 'csv')
    assert [path.name for path in tmp_path.iterdir()] == ['out']


def test_the_bar_has_a_total_and_reaches_it(tmp_path, recording):
    with tqdm(disable=False, file=io.StringIO()) as bar:
        export(recording, tmp_path / 'out', 'numpy', bar=bar)
        assert (bar.n, bar.total) == (4002, 4002)


def test_a_folder_of_recordings_stands_for_the_newest(tmp_path, recording, capsys):
    for number, name in enumerate(('b', 'c', 'a')):
        shutil.copytree(recording, tmp_path / 'recordings' / name)
        for file in (tmp_path / 'recordings' / name).iterdir():
            os.utime(file, (number, number))
    (tmp_path / 'recordings' / 'a_report').mkdir()
    assert main([str(tmp_path / 'recordings'), '--output', str(tmp_path / 'out'), '--topics',
                 '/scene']) == 0
    newest = tmp_path / 'recordings' / 'a'
    assert capsys.readouterr().err == f'{newest}: the newest of 3 recordings\n'
    with pytest.raises(BadInput, match='holds no recording; a recording, or a folder of'):
        newest_recording(tmp_path / 'out')


def test_numpy_opens_mapped_with_named_columns(tmp_path, recording):
    export(recording, tmp_path / 'out', 'numpy', ['/pose'])
    table = np.load(tmp_path / 'out' / 'pose.npy', mmap_mode='r')
    assert list(table.dtype.names) == NAMES
    np.testing.assert_array_equal(table['pose.orientation.w'], Ticks(0, 1000).orientation[:, 3])
    assert set(table['header.frame_id']) == {'world'}


@pytest.mark.parametrize('group', [201, 300])
def test_parquet_is_read_by_pyarrow(tmp_path, recording, monkeypatch, group):
    parquet = pytest.importorskip('pyarrow.parquet')
    monkeypatch.setattr(module.ParquetTable, '_GROUP', group)
    export(recording, tmp_path / 'out', 'parquet', ['/pose', '/energy'])
    table = parquet.read_table(tmp_path / 'out' / 'pose.parquet')
    assert table.column_names == NAMES
    np.testing.assert_array_equal(
        table['pose.orientation.x'].to_numpy(), Ticks(0, 1000).orientation[:, 0]
    )
    # a chunk of the recording has 100 rows; three are the first to reach the size of a group
    file = parquet.ParquetFile(tmp_path / 'out' / 'pose.parquet').metadata
    assert [file.row_group(k).num_rows for k in range(file.num_row_groups)] == [300] * 3 + [100]


def test_numpy_takes_texts_of_64_letters_and_headers_that_fit(tmp_path):
    """The format wants the data at a multiple of 64 bytes (numpy.lib.format)."""
    texts = np.array(['a' * 64, 'b'])
    table = module.NumpyTable(tmp_path / 'a.npy')
    table.add({'text': texts, 'x': np.array([1.0, 2.0])})
    table.add({'text': np.array(['c']), 'x': np.array([3.0])})
    table.close()
    found = np.load(tmp_path / 'a.npy')
    assert found['text'].tolist() == [*texts, 'c'] and found['x'].tolist() == [1.0, 2.0, 3.0]
    assert ((tmp_path / 'a.npy').stat().st_size - found.nbytes) % 64 == 0
    table = module.NumpyTable(tmp_path / 'b.npy')
    with pytest.raises(BadInput, match='numpy: text: a text of more than 64 letters'):
        table.add({'text': np.array(['a' * 65])})
    table.close()
    table = module.NumpyTable(tmp_path / 'c.npy')
    table.add({f'{k:040d}': np.array([1.0]) for k in range(100)})
    with pytest.raises(BadInput, match='numpy: 100 columns; a topic with fewer'):
        table.close()


def test_only_what_was_recorded_at_every_tick_is_joined(tmp_path):
    energy = 'std_msgs/msg/Float64'
    for name, topics, written in (
            ('a', {'/a': 3, '/b': 3, '/c': 2, '/d': 0}, {'a', 'b', 'c', 'ticks'}),
            ('b', {'/a': 3, '/ticks': 3}, {'a', 'ticks'}), ('c', {'/a': 3, '/b': 2}, {'a', 'b'})):
        with Writer(tmp_path / name, [], [Topic(topic, energy) for topic in topics], JOURNAL,
                    {}) as writer:
            for k in range(3):
                for topic, count in topics.items():
                    if k < count:
                        writer.message(topic, START + k, START, cdr.encode(
                            energy, {'data': float(k)}))
        paths = export(tmp_path / name, tmp_path / f'{name}_out', 'numpy')
        assert {path.stem for path in paths} == written | {'journal'}
        assert {path.name for path in paths} == {
            path.name for path in (tmp_path / f'{name}_out').iterdir()}
    joined = np.load(tmp_path / 'a_out' / 'ticks.npy')
    assert [name for name in joined.dtype.names if name.endswith('data')] == ['a.data', 'b.data']
    # a topic of that name is what it is
    assert 'data' in np.load(tmp_path / 'b_out' / 'ticks.npy').dtype.names


def test_parquet_without_pyarrow_says_what_to_do(tmp_path, recording, monkeypatch, capsys):
    monkeypatch.setattr(module, 'pyarrow', None)
    assert main([str(recording), '--output', str(tmp_path / 'out'), '--format', 'parquet']) == 2
    assert (
        capsys.readouterr().err
        == '--format parquet: pyarrow is not installed; pip install pyarrow, '
        'or --format csv or numpy\n'
    )
    assert not (tmp_path / 'out').exists()


def test_texts_become_json_lines(tmp_path, recording, capsys):
    assert (
        main([str(recording), '--output', str(tmp_path / 'out'), '--topics', '/scene', '--json'])
        == 0
    )
    path, = json.loads(capsys.readouterr().out)
    line, = pathlib.Path(path).read_text(encoding='utf-8').splitlines()
    assert json.loads(line) == {
        'log_time': START,
        'data': 'scene: tennis_racket\nbody: {mass: 1.0}\n',
    }


def test_recording_of_several_files_becomes_one_table(tmp_path):
    export(write(tmp_path / 'bag', split_seconds=0.2), tmp_path / 'out', 'numpy', ['/energy'])
    np.testing.assert_array_equal(
        np.load(tmp_path / 'out' / 'energy.npy')['data'], Ticks(0, 1000).energy
    )


def test_folder_that_exists_and_unknown_topics_are_refused(tmp_path, recording):
    with pytest.raises(BadInput, match='cannot be made'):
        export(recording, tmp_path, 'csv')
    with pytest.raises(BadInput, match="no topic '/x'"):
        export(recording, tmp_path / 'out', 'csv', ['/x'])
    assert not (tmp_path / 'out').exists()
