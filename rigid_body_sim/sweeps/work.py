# SPDX-License-Identifier: Apache-2.0
"""The task of a worker; it is sent as text and numbers, without objects of the package."""

import json
import pathlib
import time
from dataclasses import dataclass

from rigid_body_sim.errors import BadInput
from rigid_body_sim.sweeps import spec as specs
from rigid_body_sim.sweeps import stores
from rigid_body_sim.sweeps.layout import Layout
from rigid_body_sim.sweeps.plan import DONE, Plan
from rigid_body_sim.sweeps.results import Block
from rigid_body_sim.sweeps.runs import compute

_PLANS = {}
_STORES = {}


@dataclass(frozen=True)
class Task:
    """The data that all blocks of a sweep share.

    Attributes
    ----------
    spec : str
        Spec.text.
    outputs : str
        JSON of Plan.outputs.
    carried : dict of str to callable
        Spec.carried.
    versions : dict of str to str
        Those of the process that leads the sweep.
    store : str
        Path, '' where the results are returned.
    layout : Layout or None
        Layout of the store.
    """

    spec: str
    outputs: str
    carried: dict
    versions: dict
    store: str
    layout: Layout | None


@dataclass(frozen=True)
class Outcome:
    """The outcome of some runs.

    Attributes
    ----------
    first, stop, number : int
        The runs, and the number of their block.
    seconds : float
        Their computing time.
    failed : int
        How many of them failed.
    block : Block or None
        The results, where no store has them.
    """

    first: int
    stop: int
    number: int
    seconds: float
    failed: int
    block: Block | None


def work(task, first, stop, number):
    """Compute the runs from `first` up to `stop` in another process; return the Outcome.

    Raises
    ------
    BadInput
        This process has other versions, or does not see the store.
    OSError
        The disk refuses.
    """
    mine = stores.versions()
    for name, version in task.versions.items():
        if mine.get(name) != version:
            raise BadInput('worker', f'has version {mine.get(name)} of {name}, and the sweep was '
                           f'started by {version}', 'start workers of the same version')
    key = task.spec, task.outputs
    if key not in _PLANS:
        _PLANS[key] = Plan(specs.again(task.spec, task.carried), json.loads(task.outputs))
    plan = _PLANS[key]
    plan.spec.functions.update(task.carried)
    store = None
    if task.store:
        if not pathlib.Path(task.store).is_dir():
            raise BadInput('worker', f'does not see the store {task.store}',
                           'a path on a disk that all workers share')
        if task.store not in _STORES:
            _STORES[task.store] = stores.store_at(task.store)
        store = _STORES[task.store]
    return do(plan, first, stop, number, store, task.layout)


def do(plan, first, stop, number, store=None, layout=None, into=None):
    """Compute the runs from `first` up to `stop` here, and write them where there is a store."""
    begin = time.perf_counter()
    block = compute(plan, first, stop, into, store is not None and store.ROWS)
    if store is not None:
        store.write(layout, block, number)
    failed = int((block.arrays['status'] != DONE).sum())
    return Outcome(first, stop, number, time.perf_counter() - begin, failed,
                   None if store is not None else block)
