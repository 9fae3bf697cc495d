# SPDX-License-Identifier: Apache-2.0
"""What the command `sweep` says of an outcome that is made up: numbers, texts, exit statuses."""

import json
import logging

import numpy as np
import pytest

pytest.importorskip('xarray')

import xarray

from rigid_body_sim.cli import sweep as command
from rigid_body_sim.sweeps.engine import Stopped
from rigid_body_sim.sweeps.plan import DONE
from rigid_body_sim.sweeps.sweep import Forecast


@pytest.mark.parametrize(('seconds', 'text'), [
    (0.01234, '0.012 s'), (59.6, '60 s'), (119.9, '1.2e+02 s'), (120.0, '2 min'),
    (7199.0, '120 min'), (7200.0, '2.0 h'), (9900.0, '2.8 h')])
def test_a_duration_has_a_unit_that_is_read_easily(seconds, text):
    assert command._duration(seconds) == text


@pytest.mark.parametrize(('count', 'text'), [
    (0, '0 bytes'), (999, '999 bytes'), (1000, '1 kB'), (123_456, '123 kB'), (2_500_000, '2.5 MB'),
    (7e9, '7 GB'), (999e9, '999 GB'), (1e12, '1 TB'), (2.5e15, '2.5e+03 TB')])
def test_a_size_has_a_unit_that_is_read_easily(count, text):
    assert command._size(count) == text


def outcome(failed):
    """Return a Dataset of 4 x 3 runs of which some failed, by place, each with a text."""
    status, texts = np.full((4, 3), DONE), np.full((4, 3), '', dtype=object)
    for place, text in failed.items():
        status[place], texts[place] = DONE + 1, text
    return xarray.Dataset(
        {'status': (('mass', 'run'), status), 'status_text': (('mass', 'run'), texts),
         'energy': (('mass', 'run'), np.zeros((4, 3)))}, attrs={'title': 'a sweep'})


FAILED = {(0, 1): 'first', (1, 0): 'second', (1, 2): 'first', (2, 2): 'third', (3, 0): 'fourth'}


# a part may be a row, two, or all
@pytest.mark.parametrize('part', [1, 3, 5, 6, 8, 100])
@pytest.mark.parametrize(('failed', 'texts'), [
    (FAILED, ['first', 'second', 'third']), ({}, []), ({(3, 2): 'last'}, ['last'])])
def test_failed_runs_are_counted_and_three_of_their_texts_are_shown(
        monkeypatch, part, failed, texts):
    monkeypatch.setattr(command, 'PART', part)
    assert command._failed(outcome(failed)) == (len(failed), texts)


@pytest.mark.parametrize(('part', 'rows'), [(1, [1, 1, 1, 1]), (6, [2, 2]), (8, [2, 2]),
                                            (9, [3, 1]), (100, [4])])
def test_the_status_of_so_many_runs_is_read_at_once(monkeypatch, part, rows):
    monkeypatch.setattr(command, 'PART', part)
    found, read = outcome(FAILED), []
    isel = xarray.Dataset.isel

    def watched(self, places):
        chosen = isel(self, places)
        read.append(chosen.sizes['mass'])
        return chosen
    monkeypatch.setattr(xarray.Dataset, 'isel', watched)
    assert command._failed(found)[0] == 5
    assert read == rows


def told(monkeypatch, capsys, answer, *arguments):
    """Return the exit status and what is printed when a sweep returns or raises the answer."""
    def sweep(*_, **__):
        if isinstance(answer, BaseException):
            raise answer
        return answer
    monkeypatch.setattr(command, 'sweep', sweep)
    monkeypatch.setattr(command, 'forecast', sweep)
    status = command.main(['spec.yaml', *arguments])
    return status, *capsys.readouterr()


def test_a_sweep_ends_with_its_numbers(monkeypatch, capsys):
    status, out, err = told(monkeypatch, capsys, outcome(FAILED), '--output', 'a.zarr')
    assert (status, err) == (0, '')
    first, *others = out.splitlines()
    assert first.startswith('a sweep: 12 runs (mass 4 x run 3) in ')
    assert others == ['  5 failed (status, status_text), for example:', '    first', '    second',
                      '    third', '  status, status_text, energy: a.zarr']
    _, out, _ = told(monkeypatch, capsys, outcome({}), '--output', 'a.zarr')
    assert out.splitlines()[1:] == ['  status, status_text, energy: a.zarr']


def test_the_numbers_of_a_sweep_are_json(monkeypatch, capsys):
    status, out, _ = told(monkeypatch, capsys, outcome(FAILED), '--output', 'a.zarr', '--json')
    found = json.loads(out)
    assert status == 0 and 0.0 <= found.pop('seconds') < 60.0
    assert found == {'runs': 12, 'failed': 5, 'store': 'a.zarr',
                     'dimensions': {'mass': 4, 'run': 3},
                     'variables': ['status', 'status_text', 'energy']}


def test_a_forecast_is_a_line_or_json(monkeypatch, capsys):
    cost = Forecast(12, 2, 90.0, 5000)
    assert told(monkeypatch, capsys, cost, '--dry-run') == (
        0, '12 runs, about 90 s on 2 workers, 5 kB before compression\n', '')
    status, out, _ = told(monkeypatch, capsys, cost, '--dry-run', '--json', '--output', 'a.zarr')
    assert (status, json.loads(out)) == (
        0, {'runs': 12, 'workers': 2, 'seconds': 90.0, 'bytes': 5000})


@pytest.mark.parametrize(('answer', 'status', 'line'), [
    (Stopped('the disk is full'), 1, 'sweep: the disk is full\n'),
    (KeyboardInterrupt('2 of 3 runs are kept'), 130, 'interrupted: 2 of 3 runs are kept\n'),
    (KeyboardInterrupt(), 130, 'interrupted\n')])
def test_a_sweep_that_stops_says_so_in_one_line(monkeypatch, capsys, answer, status, line):
    assert told(monkeypatch, capsys, answer, '--output', 'a.zarr') == (status, '', line)


def test_a_store_is_named_unless_nothing_runs(monkeypatch, capsys):
    status, out, err = told(monkeypatch, capsys, outcome({}))
    assert (status, out) == (2, '') and err.startswith('--output: is missing; NAME.zarr')


def test_a_scheduler_that_does_not_answer_is_one_line(monkeypatch, capsys):
    distributed = pytest.importorskip('distributed')

    def client(address, **_):
        raise OSError(f'nobody\nat   {address}')
    monkeypatch.setattr(distributed, 'Client', client)
    status, _, err = told(monkeypatch, capsys, outcome({}), '--output', 'a.zarr',
                          '--dask', 'tcp://nowhere:1')
    assert status == 2 and err.count('\n') == 1
    assert "no scheduler answers at 'tcp://nowhere:1' (nobody at tcp://nowhere:1)" in err


def test_a_client_works_in_silence_for_this_sweep_alone_and_is_closed(monkeypatch, capsys):
    """What fails while it is closed is not told: the sweep has ended well."""
    distributed = pytest.importorskip('distributed')
    names = ('distributed', 'distributed.client', 'asyncio', 'tornado.application')
    before = [logging.getLogger(name).level for name in names]
    told_to = []

    class Client:
        def __init__(self, address, timeout, set_as_default):
            assert (address, set_as_default) == ('tcp://here:1', False) and timeout > 1.0

        def close(self, timeout):
            told_to.append('close')
            raise OSError('the scheduler is gone')
    monkeypatch.setattr(distributed, 'Client', Client)
    try:
        status, _, err = told(monkeypatch, capsys, outcome({}), '--output', 'a.zarr',
                              '--dask', 'tcp://here:1')
        assert (status, err, told_to) == (0, '', ['close'])
        for name in names:
            assert not logging.getLogger(name).isEnabledFor(logging.CRITICAL)
    finally:
        for name, level in zip(names, before, strict=True):
            logging.getLogger(name).setLevel(level)
