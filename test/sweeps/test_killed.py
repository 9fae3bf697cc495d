# SPDX-License-Identifier: Apache-2.0
"""A sweep that is killed (kill -9: worker, client, scheduler) ends with the same bits."""

import collections
import json
import os
import re
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from soak import IN_SOAK

pytest.importorskip('xarray')
zarr = pytest.importorskip('zarr', minversion='3.1')

from notices import without_notices  # noqa: E402

from rigid_body_sim import sweep  # noqa: E402
from rigid_body_sim.sweeps.layout import Layout  # noqa: E402

RUNS, LONGEST = 240, 120.0
MEASURED = 100
FUNCTION = """
import pathlib, time

def slow(run):
    with open(pathlib.Path(__file__).with_name('computed'), 'a') as log:
        log.write(f'{run.number}\\n')
    time.sleep(0.02)
    return float(run.states.angular_velocity[-1, 1])
"""
SPEC = f"""
scene: tennis_racket
vary:
  body.inertia.1: [2.1, 2.4]
  initial.angular_velocity.0: {{linspace: [0.01, 1.0, {RUNS // 2}]}}
times: [3.0, 20.0]
keep: [final, {{function: slow.py:slow}}]
"""


def python(log, *arguments):
    """Start Python; what it says on stderr goes to a file, since nobody reads a pipe."""
    with open(log, 'wb') as stream:
        return subprocess.Popen([sys.executable, *map(str, arguments)], stderr=stream,
                                stdout=subprocess.DEVNULL)


def wait_until(condition, process, log):
    deadline = time.monotonic() + LONGEST
    while not condition():
        assert time.monotonic() < deadline and process.poll() is None, log.read_text()
        time.sleep(0.05)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / 'slow.py').write_text(FUNCTION)
    (tmp_path / 'spec.yaml').write_text(SPEC)
    return tmp_path


def blocks_done(store):
    try:
        return int(zarr.open_array(store / 'progress' / 'done', mode='r')[:].sum())
    except FileNotFoundError:
        return 0


def block_runs(store):
    """Return the largest number of runs of a block."""
    words = zarr.open_group(store, mode='r').attrs['sweep']
    return Layout(tuple(words['shape']), *words['layout']).runs(0)[1]


def finish_and_compare(folder, blocks_in_flight, starts):
    """Finish the store by threads: the bits are those in memory, and little was computed twice.

    Before a process begins it measures the first runs, fewer than MEASURED.
    """
    store = folder / 'maps.zarr'
    resumed = sweep(folder / 'spec.yaml', store=store)
    counts = collections.Counter(map(int, (folder / 'computed').read_text().split()))
    assert set(counts) == set(range(RUNS))
    twice = sum(count - 1 for count in counts.values())
    assert twice <= blocks_in_flight * block_runs(store) + starts * MEASURED
    alone = sweep(folder / 'spec.yaml')
    for name in alone.data_vars:
        ours, theirs = alone[name].values, resumed[name].values
        assert (ours.tobytes() == theirs.tobytes() if ours.dtype.kind in 'fi' else
                (ours == theirs).all()), name
    assert np.isfinite(resumed.slow).all()
    assert not list(store.rglob('*.partial'))


@IN_SOAK
@pytest.mark.timeout(300)
def test_killed_worker_client_and_scheduler_of_dask(folder):
    pytest.importorskip('distributed')
    at, store, log = folder / 'scheduler.json', folder / 'maps.zarr', folder / 'client.log'
    processes = [python(
        folder / 'scheduler.log', '-m', 'dask', 'scheduler', '--host', '127.0.0.1', '--port', 0,
        '--no-dashboard', '--dashboard-address', '127.0.0.1:0', '--scheduler-file', at)]
    processes += [python(
        folder / f'worker{k}.log', '-m', 'dask', 'worker', '--scheduler-file', at, '--nthreads', 1,
        '--no-nanny', '--no-dashboard', '--death-timeout', 60, '--local-directory', folder)
        for k in range(2)]
    scheduler, worker, _ = processes

    def sweeping():
        address = json.loads(at.read_text())['address']
        client = python(log, '-m', 'rigid_body_sim', 'sweep', folder / 'spec.yaml', '--dask',
                        address, '--output', store)
        processes.append(client)
        return client

    def until_more(client, blocks):
        goal = blocks_done(store) + blocks
        wait_until(lambda: blocks_done(store) >= goal, client, log)
    try:
        wait_until(at.exists, scheduler, folder / 'scheduler.log')
        client = sweeping()
        until_more(client, 2)
        worker.send_signal(signal.SIGKILL)
        until_more(client, 2)
        client.send_signal(signal.SIGKILL)
        client.wait()
        client = sweeping()
        until_more(client, 1)
        scheduler.send_signal(signal.SIGKILL)
        assert client.wait(LONGEST) == 1
        said = without_notices(log.read_text())
        assert re.search(rf'of \d+ blocks are in {store}; the same sweep goes on from there', said)
        assert said.count('\n') == 1, said
    finally:
        for process in processes:
            process.kill()
            process.wait()
    # one block of the worker, one of each of the two that ran when the client and the scheduler
    # were killed
    finish_and_compare(folder, 1 + 1 + 1, 3)


@pytest.mark.timeout(300)
def test_killed_in_threads(folder):
    store, log = folder / 'maps.zarr', folder / 'log'
    for _ in range(2):
        client = python(log, '-m', 'rigid_body_sim', 'sweep', folder / 'spec.yaml', '--output',
                        store)
        try:
            goal = blocks_done(store) + 2
            wait_until(lambda goal=goal: blocks_done(store) >= goal, client, log)
        finally:
            client.kill()
            client.wait()
    finish_and_compare(folder, 2 * os.cpu_count(), 2)


def test_interrupted_keeps_what_runs(folder):
    store, log = folder / 'maps.zarr', folder / 'log'
    client = python(log, '-m', 'rigid_body_sim', 'sweep', folder / 'spec.yaml', '--output', store)
    try:
        wait_until(lambda: blocks_done(store) >= 1, client, log)
        client.send_signal(signal.SIGINT)
        assert client.wait(LONGEST) == 130
    finally:
        client.kill()
        client.wait()
    said = without_notices(log.read_text())
    assert 'blocks are in' in said and said.count('\n') == 1, said
    finish_and_compare(folder, 0, 1)
