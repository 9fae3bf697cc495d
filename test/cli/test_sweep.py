# SPDX-License-Identifier: Apache-2.0
"""The command `sweep` in this process: what it passes on, and every word that it prints."""

import json
import logging
import sys
import types

import numpy as np
import pytest

pytest.importorskip('xarray')

import xarray

from rigid_body_sim.cli import sweep as command
from rigid_body_sim.sweeps.engine import Stopped
from rigid_body_sim.sweeps.plan import DONE
from rigid_body_sim.sweeps.sweep import Forecast

WRONG = DONE + 1


def outcome(status, texts):
    """Return what a sweep over a grid of two keys returns."""
    dims = 'a.b', 'c'
    return xarray.Dataset({'final': ((*dims, 'state'), np.zeros((*np.shape(status), 13))),
                           'status': (dims, np.array(status)),
                           'status_text': (dims, np.array(texts, dtype=object))},
                          attrs={'title': 'racket'})


@pytest.fixture
def asked(monkeypatch):
    """Note what the command asks of the sweep, which returns or raises `asked.gives`."""
    seen = types.SimpleNamespace(calls=[], gives=outcome([[DONE] * 3] * 2, [[''] * 3] * 2))

    def sweep(*arguments, **options):
        seen.calls.append((arguments, options))
        if isinstance(seen.gives, BaseException):
            raise seen.gives
        return seen.gives
    monkeypatch.setattr(command, 'sweep', sweep)
    monkeypatch.setattr(command, 'forecast', sweep)
    clock = iter((100.0, 102.5))
    monkeypatch.setattr(command, 'time', types.SimpleNamespace(perf_counter=lambda: next(clock)))
    return seen


def test_a_sweep_goes_to_the_store_and_is_told(asked, capsys):
    assert command.main(['spec.yaml', '--output', 'maps.zarr']) == 0
    assert asked.calls == [(('spec.yaml', None, 'maps.zarr'), {'progress': False})]
    assert capsys.readouterr().out.splitlines() == [
        'racket: 6 runs (a.b 2 x c 3) in 2.5 s', '  final, status, status_text: maps.zarr']


def test_the_outcome_as_json(asked, capsys):
    asked.gives = outcome([[DONE, WRONG, DONE], [WRONG, DONE, WRONG]], [['', 'x', ''],
                                                                       ['y', '', 'x']])
    assert command.main(['spec.yaml', '--output', 'maps.zarr', '--json']) == 0
    assert json.loads(capsys.readouterr().out) == {
        'runs': 6, 'failed': 3, 'seconds': 2.5, 'store': 'maps.zarr',
        'dimensions': {'a.b': 2, 'c': 3, 'state': 13},
        'variables': ['final', 'status', 'status_text']}


@pytest.mark.parametrize('part', [1, 3, 4, 6, 2**22])
def test_a_few_of_the_errors_are_told_each_once(asked, monkeypatch, capsys, part):
    """Read a row at a time or more."""
    monkeypatch.setattr(command, 'PART', part)
    asked.gives = outcome([[DONE, WRONG, WRONG], [WRONG, WRONG, WRONG]], [['', 'p', 'q'],
                                                                         ['p', 'r', 's']])
    assert command.main(['spec.yaml', '--output', 'maps.zarr']) == 0
    assert capsys.readouterr().out.splitlines()[1:-1] == [
        '  5 failed (status, status_text), for example:', '    p', '    q', '    r']


def test_parts_have_as_many_runs_as_are_read_at_once(monkeypatch):
    class Watched:
        def __init__(self, found, slices):
            self.found, self.slices, self.sizes = found, slices, found.sizes

        def __getitem__(self, names):
            return self.found[names] if isinstance(names, str) else self

        def isel(self, indexers):
            self.slices.append(indexers['a.b'])
            return self.found.isel(indexers)
    found = outcome([[DONE] * 3] * 5, [[''] * 3] * 5)
    for part, rows in ((1, 1), (6, 2), (8, 2), (9, 3), (100, 5)):
        monkeypatch.setattr(command, 'PART', part)
        watched = Watched(found, [])
        assert command._failed(watched) == (0, [])
        assert len(range(5)[watched.slices[0]]) == rows
        assert [k for one in watched.slices for k in range(5)[one]] == list(range(5))


def test_a_forecast_runs_nothing_and_needs_no_store(asked, capsys):
    asked.gives = Forecast(runs=7, workers=2, seconds=90.0, bytes=1234)
    assert command.main(['spec.yaml', '--dry-run']) == 0
    assert asked.calls == [(('spec.yaml', None), {})]
    assert capsys.readouterr().out == (
        '7 runs, about 90 s on 2 workers, 1.23 kB before compression\n')
    assert command.main(['spec.yaml', '--dry-run', '--json', '--output', 'maps.zarr']) == 0
    assert asked.calls[1] == (('spec.yaml', None), {})
    assert json.loads(capsys.readouterr().out) == {
        'runs': 7, 'workers': 2, 'seconds': 90.0, 'bytes': 1234}


def test_a_sweep_needs_a_store(asked, capsys):
    assert command.main(['spec.yaml']) == 2
    assert capsys.readouterr().err.startswith('--output: is missing; NAME.zarr')
    assert asked.calls == []


@pytest.mark.parametrize(('error', 'status', 'said'), [
    (Stopped('the workers are gone'), 1, 'sweep: the workers are gone'),
    (KeyboardInterrupt('3 of 7 blocks are in maps.zarr'), 130,
     'interrupted: 3 of 7 blocks are in maps.zarr'), (KeyboardInterrupt(), 130, 'interrupted')])
def test_what_ends_a_sweep_is_one_line(asked, capsys, error, status, said):
    asked.gives = error
    assert command.main(['spec.yaml', '--output', 'maps.zarr']) == status
    assert capsys.readouterr().err.splitlines()[-1] == said


@pytest.mark.parametrize(('seconds', 'said'), [
    (0.0123, '0.012 s'), (119.9, '1.2e+02 s'), (120.0, '2 min'), (7170.0, '120 min'),
    (7200.0, '2.0 h'), (9000.0, '2.5 h')])
def test_durations(seconds, said):
    assert command._duration(seconds) == said


@pytest.mark.parametrize(('count', 'said'), [
    (0, '0 bytes'), (999, '999 bytes'), (1000, '1 kB'), (123456, '123 kB'), (2.5e6, '2.5 MB'),
    (3e9, '3 GB'), (1e12, '1 TB'), (1e15, '1e+03 TB')])
def test_sizes(count, said):
    assert command._size(count) == said


class Client:
    """A client of Dask as the command uses it."""

    def __init__(self, address, **options):
        if address == 'tcp://nobody:1':
            raise OSError('Timed  out\nconnecting')
        self.said = [(address, options)]

    def close(self, **options):
        self.said.append(options)
        raise RuntimeError('the scheduler is gone')


@pytest.fixture
def dask(monkeypatch):
    """Stand in for Dask; its loggers are as before afterwards."""
    monkeypatch.setattr(command, 'need', lambda name: None)
    monkeypatch.setitem(sys.modules, 'distributed', types.SimpleNamespace(Client=Client))
    loggers = [logging.getLogger(name) for name in (
        'distributed', 'distributed.client', 'asyncio', 'tornado.application')]
    levels = [one.level for one in loggers]
    yield loggers
    for one, level in zip(loggers, levels, strict=True):
        one.setLevel(level)


def test_a_cluster_computes_and_is_left(asked, dask):
    assert command.main(['spec.yaml', '--output', 'maps.zarr', '--dask', 'tcp://host:8786']) == 0
    [((_, client, _), _)] = asked.calls
    assert client.said == [('tcp://host:8786', {'timeout': 10.0, 'set_as_default': False}),
                           {'timeout': 1.0}]
    # one line of the command reports what is lost
    assert not any(one.isEnabledFor(logging.CRITICAL) for one in dask)


def test_a_cluster_that_does_not_answer_is_one_line(asked, dask, capsys):
    assert command.main(['spec.yaml', '--output', 'maps.zarr', '--dask', 'tcp://nobody:1']) == 2
    assert capsys.readouterr().err.startswith(
        "--dask: no scheduler answers at 'tcp://nobody:1' (Timed out connecting); start one: ")
    assert asked.calls == []
