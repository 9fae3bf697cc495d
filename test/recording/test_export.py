"""Exports read back by the tools they are for: csv, numpy, pyarrow."""

import csv
import json
import pathlib

import numpy as np
import pytest
from recording.conftest import START, Ticks, write

from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording import export as module
from rigid_body_sim.recording.export import export, main

NAMES = ['log_time', 'publish_time', 'sequence', 'header.stamp', 'header.frame_id', 'pose.position.x', 'pose.position.y', 'pose.position.z',
         'pose.orientation.x', 'pose.orientation.y', 'pose.orientation.z', 'pose.orientation.w']


def test_csv_keeps_every_digit(tmp_path, recording):
    paths = export(recording, tmp_path / 'out', 'csv')
    assert sorted(path.name for path in paths) == ['angular_momentum_squared.csv', 'angular_velocity.csv', 'energy.csv', 'journal.jsonl',
                                                   'pose.csv', 'scene.jsonl']
    with open(tmp_path / 'out' / 'pose.csv', newline='') as stream:
        names, *rows = csv.reader(stream)
    assert names == NAMES
    ticks = Ticks(0, 1000)
    assert [[float(number) for number in row[8:]] for row in rows] == ticks.orientation.tolist()
    assert [int(row[0]) for row in rows] == ticks.stamps.tolist()
    assert {row[4] for row in rows} == {'world'}


def test_numpy_opens_mapped_with_named_columns(tmp_path, recording):
    export(recording, tmp_path / 'out', 'numpy', ['/pose'])
    table = np.load(tmp_path / 'out' / 'pose.npy', mmap_mode='r')
    assert list(table.dtype.names) == NAMES
    np.testing.assert_array_equal(table['pose.orientation.w'], Ticks(0, 1000).orientation[:, 3])
    assert set(table['header.frame_id']) == {'world'}


def test_parquet_is_read_by_pyarrow(tmp_path, recording, monkeypatch):
    parquet = pytest.importorskip('pyarrow.parquet')
    monkeypatch.setattr(module.ParquetTable, '_GROUP', 300)
    export(recording, tmp_path / 'out', 'parquet', ['/pose', '/energy'])
    table = parquet.read_table(tmp_path / 'out' / 'pose.parquet')
    assert table.column_names == NAMES
    np.testing.assert_array_equal(table['pose.orientation.x'].to_numpy(), Ticks(0, 1000).orientation[:, 0])


def test_parquet_without_pyarrow_says_what_to_do(tmp_path, recording, monkeypatch, capsys):
    monkeypatch.setattr(module, 'pyarrow', None)
    assert main([str(recording), '--output', str(tmp_path / 'out'), '--format', 'parquet']) == 2
    assert capsys.readouterr().err == '--format parquet: pyarrow is not installed; pip install pyarrow, or --format csv or numpy\n'
    assert not (tmp_path / 'out').exists()


def test_texts_become_json_lines(tmp_path, recording, capsys):
    assert main([str(recording), '--output', str(tmp_path / 'out'), '--topics', '/scene', '--json']) == 0
    path, = json.loads(capsys.readouterr().out)
    line, = pathlib.Path(path).read_text(encoding='utf-8').splitlines()
    assert json.loads(line) == {'log_time': START, 'data': 'scene: tennis_racket\nbody: {mass: 1.0}\n'}


def test_recording_of_several_files_becomes_one_table(tmp_path):
    export(write(tmp_path / 'bag', split_seconds=0.2), tmp_path / 'out', 'numpy', ['/energy'])
    np.testing.assert_array_equal(np.load(tmp_path / 'out' / 'energy.npy')['data'], Ticks(0, 1000).energy)


def test_folder_that_exists_and_unknown_topics_are_refused(tmp_path, recording):
    with pytest.raises(BadInput, match='cannot be made'):
        export(recording, tmp_path, 'csv')
    with pytest.raises(BadInput, match="no topic '/x'"):
        export(recording, tmp_path / 'out', 'csv', ['/x'])
    assert not (tmp_path / 'out').exists()
