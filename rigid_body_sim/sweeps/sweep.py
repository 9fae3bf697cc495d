# SPDX-License-Identifier: Apache-2.0
"""Sweeps: a scene over grids or samples of its keys, as one data set.

::

    from rigid_body_sim import sweep
    found = sweep({'scene': 'tennis_racket',
                   'vary': {'initial.angular_velocity.0': {'logspace': [-4, 0, 61]}},
                   'times': {'linspace': [0, 60, 601]}, 'keep': [{'first': 'flip'}, 'final']})
    found.first_flip.plot(xscale='log')
"""

import contextlib
import json
import os
import pathlib
import typing
from dataclasses import dataclass

import numpy as np
from tqdm import tqdm

from rigid_body_sim.errors import BadInput
from rigid_body_sim.simulation.ensemble import SHARE, free_memory
from rigid_body_sim.sweeps import engine, stores
from rigid_body_sim.sweeps import spec as specs
from rigid_body_sim.sweeps.functions import outputs_of
from rigid_body_sim.sweeps.needed import need
from rigid_body_sim.sweeps.plan import Plan
from rigid_body_sim.sweeps.results import room
from rigid_body_sim.sweeps.work import Task, do, work

if typing.TYPE_CHECKING:
    import xarray


@dataclass(frozen=True)
class Forecast:
    """The expected cost of a sweep.

    Attributes
    ----------
    runs, workers : int
    seconds : float
    bytes : int
        Size of the result, before compression.
    """

    runs: int
    workers: int
    seconds: float
    bytes: int


def sweep(spec, executor=None, store=None, *, progress: bool = False) -> 'xarray.Dataset':
    """Return the results of many runs of a scene.

    Parameters
    ----------
    spec : mapping, path or str
        The words ``scene, vary, sample, times, keep`` (and ``integrator``, ``accuracy``): a
        mapping, the path of a YAML file, or its text. docs/sweeps.md explains them.
    executor : concurrent.futures.Executor or distributed.Client, optional
        Where the runs are computed; by default threads of this process.
    store : path, optional
        A folder to make, or to go on with: ``.zarr``, or ``.parquet`` for one row per run. Without
        it the result is in memory.
    progress : bool
        Whether to show a bar on stderr: runs done, rate, time left.

    Returns
    -------
    xarray.Dataset
        The varied keys are its dimensions, and ``run`` is that of the samples. A run that failed
        is NaN; its ``status`` and ``status_text`` say why. From a Zarr store it is read when it
        is used.

    Raises
    ------
    BadInput
        One line: a wrong spec, a store of another spec or version, a worker of another version, a
        result that memory cannot hold.
    Stopped
        The workers are gone or the disk is full. The same call goes on with what the store has.
    """
    need('xarray')
    plan = prepared(spec)
    workers = engine.Workers(executor)
    with tqdm(total=plan.spec.size, unit=' runs', unit_scale=True, disable=not progress,
              desc=plan.template.name) as bar:
        if store is None:
            return _to_memory(plan, workers, bar)
        return _to_store(plan, workers, stores.store_at(store), bar)


def prepared(spec):
    """Return the Plan of a spec, with the results of its functions."""
    read = specs.read(spec)
    plan = Plan(read)
    return Plan(read, outputs_of(plan)) if read.functions else plan


def forecast(spec, executor=None) -> Forecast:
    """Return the expected cost of a sweep: some runs are tried, for less than a second.

    Parameters and errors are those of :func:`sweep`.
    """
    plan = prepared(spec)
    workers = engine.Workers(executor)
    seconds = engine.seconds_a_run(plan, patience=0.5) * plan.spec.size / workers.count
    return Forecast(plan.spec.size, workers.count, seconds, plan.bytes * plan.spec.size)


def _to_memory(plan, workers, bar):
    """Run a plan whose result is in memory; return the Dataset."""
    spec = plan.spec
    needed, limit = plan.bytes * spec.size, SHARE * free_memory()
    if needed > limit:
        raise BadInput('sweep', f'the results of {spec.size} runs need {needed / 1e9:.3g} GB, and '
                       f'{limit / 1e9:.3g} GB may be taken', 'fewer runs or times, less in keep, '
                       'or a store')
    arrays, states = room(plan, spec.size)
    plan.drawn()    # the result has all samples anyhow
    texts, rates = {}, []

    def submit(workers, piece):
        first, stop, number = piece
        if workers.local:
            parts = {name: array[first:stop] for name, array in arrays.items()}
            into = parts, None if states is None else states[first:stop]
            return workers.submit(do, plan, first, stop, number, None, None, into)
        return workers.submit(work, task, *piece)

    def take(outcome):
        rates[:] = [(outcome.stop - outcome.first) / max(outcome.seconds, 1e-9)]
        for name, values in outcome.block.arrays.items():
            if not workers.local:
                arrays[name][outcome.first:outcome.stop] = values
        texts.update(outcome.block.texts)
        _advance(bar, outcome)

    if not workers.local:
        engine.seconds_a_run(plan, patience=0.0)
        task = _task(plan)
    pieces = engine.pieces_in_memory(plan, workers, lambda: rates[0] if rates else None)
    engine.run(workers, pieces, submit, take, lambda: workers.count + (not workers.local))
    return stores.in_memory(plan, arrays, texts)


def _to_store(plan, workers, store, bar):
    """Run the blocks that a store lacks; return the Dataset."""
    runs = 1
    if not store.path.exists():
        runs = engine.block_runs(plan, engine.seconds_a_run(plan), workers.count)
    try:
        layout = store.make(plan, runs)
        with store.alone():
            done = store.done(layout)
            numbers = np.flatnonzero(~done)
            bar.update(plan.spec.size - sum(
                stop - first for first, stop in map(layout.runs, numbers.tolist())))
            _fill(plan, workers, store, layout, numbers.tolist(), bar)
            store.finish()
    except OSError as error:
        raise engine.Stopped(f'{store.path}: the disk refuses ({error.strerror}); '
                             'make room, and the same sweep goes on') from error
    return store.dataset(plan)


def _fill(plan, workers, store, layout, numbers, bar):
    """Compute and write the blocks of some numbers."""
    task = None if workers.local else _task(plan, store, layout)
    written = 0

    def submit(workers, number):
        first, stop = layout.runs(number)
        if workers.local:
            return workers.submit(do, plan, first, stop, number, store, layout)
        return workers.submit(work, task, first, stop, number)

    def take(outcome):
        nonlocal written
        store.mark(outcome.number)
        written += 1
        _advance(bar, outcome)

    try:
        engine.run(workers, iter(numbers), submit, take, lambda: 2 * workers.count)
    except (engine.Stopped, KeyboardInterrupt) as error:
        there = layout.blocks - len(numbers) + written
        line = (f'{there} of {layout.blocks} blocks are in {store.path}; the same sweep goes on '
                'from there')
        if isinstance(error, KeyboardInterrupt):
            raise KeyboardInterrupt(line) from None
        raise engine.Stopped(f'{error}: {line}') from error


def _task(plan, store=None, layout=None):
    path = '' if store is None else str(pathlib.Path(os.path.abspath(store.path)))
    return Task(plan.spec.text, json.dumps(plan.outputs), plan.spec.carried, stores.versions(),
                path, layout)


def _advance(bar, outcome):
    """Advance the progress bar; show how many runs failed."""
    bar.failed = getattr(bar, 'failed', 0) + outcome.failed
    if bar.failed:
        bar.set_postfix_str(f'{bar.failed} failed', refresh=False)
    with contextlib.suppress(ValueError):
        bar.update(outcome.stop - outcome.first)
