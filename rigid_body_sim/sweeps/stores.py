# SPDX-License-Identifier: Apache-2.0
"""Stores of a sweep: Zarr 3 for grids and trajectories, Parquet for one row per run.

The worker that computed a block writes it, into files that belong to that block alone. A block
counts once it is marked as done, by the one process that leads the sweep. Every file appears
whole, by a rename, so a sweep may be killed at any moment.
"""

import contextlib
import fcntl
import functools
import json
import math
import os
import pathlib
import shutil

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording import about
from rigid_body_sim.simulation import arithmetic
from rigid_body_sim.sweeps import plan as plans
from rigid_body_sim.sweeps import spec as specs
from rigid_body_sim.sweeps.layout import Layout
from rigid_body_sim.sweeps.needed import need

CHUNK_BYTES = 2**20
"""Approximate size of what is read at once from a variable of numbers."""
MARKS = 4096
"""Blocks whose marks stand in one file."""
PIECE = 2**20
"""Runs whose samples are written at once."""
DONE_ARRAY = 'progress/done'


def versions():
    """Return the versions that programs must share to make the same bits of a sweep."""
    return {'rigid_body_sim': about.version(), 'arithmetic': arithmetic.version()}


def attributes(plan):
    """Return what the result says about how it was made, as a dict of texts and numbers."""
    spec = plan.spec
    return {'title': f'sweep of {plan.template.name}', 'scene': spec.scene,
            'spec': spec.text, 'integrator': spec.integrator, 'accuracy': spec.accuracy,
            'horizon': plan.horizon, **{f'version of {name}': value
                                        for name, value in versions().items()},
            'machine': json.dumps(about.machine())}


def store_at(path):
    """Return the store of a path by its suffix: ``.zarr`` or ``.parquet``."""
    path = pathlib.Path(os.fspath(path))
    kinds = {'.zarr': ZarrStore, '.parquet': ParquetStore}
    if path.suffix not in kinds:
        raise BadInput('store', f'got {str(path)!r}',
                       'a path that ends in .zarr (grids, trajectories) or .parquet (one row a '
                       'run)')
    return kinds[path.suffix](path)


class Store:
    """The common part of both kinds of store: created once, whole, and checked against its spec.

    Parameters
    ----------
    path : pathlib.Path

    Attributes
    ----------
    LOCK : str
        Place of the lock in the store.
    ROWS : bool
        Whether the values of the keys stand beside the results of each run.
    """

    def __init__(self, path):
        self.path = path

    def make(self, plan, block_runs):
        """Make the store of a plan, or raise BadInput where another sweep has it.

        Returns
        -------
        Layout
            Of the store, which may have been made earlier.
        """
        if self.path.exists():
            return self._check(plan)
        part = self.path.with_name(f'{self.path.name}.{os.getpid()}.making')
        shutil.rmtree(part, ignore_errors=True)
        try:
            self._create(part, plan, block_runs)
            part.rename(self.path)
        except BaseException:
            shutil.rmtree(part, ignore_errors=True)
            raise
        return self._check(plan)

    def _check(self, plan):
        """Return the Layout of the store; BadInput unless it is of this plan."""
        try:
            kept = self._kept()
        except (OSError, ValueError, KeyError, TypeError):
            raise BadInput(str(self.path), 'is not a store of a sweep',
                           'give a path where nothing exists yet') from None
        ours = specs.fingerprint(plan.spec)
        theirs = kept['words']
        other = sorted(word for word in {*ours, *theirs} if ours.get(word) != theirs.get(word))
        if other:
            raise BadInput(str(self.path), f'holds the sweep of another spec: {", ".join(other)} '
                           f'{"differs" if len(other) == 1 else "differ"}',
                           'give another path, or the spec that it was made with')
        mine = versions()
        for name, version in kept['versions'].items():
            if version != mine.get(name):
                raise BadInput(str(self.path), f'was made by version {version} of {name}, and '
                               f'this is {mine.get(name)}',
                               'finish it with that version, or give another path')
        return Layout(tuple(kept['shape']), *kept['layout'])

    @contextlib.contextmanager
    def alone(self):
        """Hold the lock of the store; the system releases it however the process ends."""
        with open(self.path / self.LOCK, 'a+', encoding='ascii') as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                lock.seek(0)
                raise BadInput(str(self.path), f'process {lock.read() or "?"} is sweeping it',
                               'wait for it, or end it') from None
            lock.truncate(0)
            lock.write(str(os.getpid()))
            lock.flush()
            yield

    def _words(self, plan, layout):
        return {'words': specs.fingerprint(plan.spec), 'versions': versions(),
                'shape': list(layout.shape),
                'layout': [layout.along, layout.chunk, layout.chunks]}


class ZarrStore(Store):
    """A Zarr 3 folder. xarray.open_zarr(path, consolidated=False) opens it."""

    LOCK, ROWS = 'progress/sweep.lock', False

    def __init__(self, path):
        need('xarray', 'zarr')
        super().__init__(path)

    def _create(self, part, plan, block_runs):
        import xarray
        import zarr
        largest = max(one.bytes for one in plan.variables)
        layout = Layout.of(plan.spec.shape, block_runs, max(1, CHUNK_BYTES // largest))
        xarray.Dataset(coords=plans.coordinates(plan)).to_zarr(
            part, mode='w-', zarr_format=3, consolidated=False)
        group = zarr.open_group(part, mode='r+')
        for one in plan.variables:
            group.create_array(
                one.name, shape=(*layout.shape, *one.shape), dtype=one.dtype,
                shards=(*layout.shard_shape, *one.shape),
                chunks=(*layout.chunk_shape, *one.shape), fill_value=one.fill,
                compressors=zarr.codecs.BloscCodec(cname='lz4', clevel=1, shuffle='shuffle'),
                dimension_names=(*plan.dims, *one.dims), attributes=_fitting(one.attrs))
        group.create_array(plans.TEXT, shape=layout.shape, dtype=str, fill_value='',
                           chunks=layout.shard_shape, dimension_names=tuple(plan.dims),
                           attributes={'long_name': 'why the run failed'})
        self._create_samples(group, plan)
        group.create_array(DONE_ARRAY, shape=(layout.blocks,), dtype=np.uint8, fill_value=0,
                           chunks=(min(layout.blocks, MARKS),), dimension_names=('block',))
        group.attrs.update({**attributes(plan), 'sweep': self._words(plan, layout),
                            'coordinates': ' '.join(plan.spec.sample)})

    def _create_samples(self, group, plan):
        """Write the coordinates of the sampled keys, a piece at a time."""
        for key, sampled in plan.spec.sample.items():
            dims, runs = plans.sample_dims(sampled), plan.spec.runs
            array = group.create_array(
                key, shape=(runs, sampled.width)[:len(dims)], dtype=float,
                chunks=(min(runs, PIECE // 8), sampled.width)[:len(dims)], fill_value=math.nan,
                dimension_names=dims, attributes=_fitting(plans.sample_attrs(key)))
            for first in range(0, runs, PIECE):
                stop = min(first + PIECE, runs)
                array[first:stop] = sampled.of_runs(first, stop)

    def _kept(self):
        return self._group.attrs['sweep']

    @functools.cached_property
    def _group(self):
        import zarr
        return zarr.open_group(self.path, mode='r+')

    @functools.cache    # noqa: B019 (a store lives as long as its sweep)
    def _array(self, name):
        return self._group[name]

    def write(self, layout, block, number):
        """Write a Block that was computed; it has the runs of a block of the layout."""
        box = layout.box(number)
        shape = tuple(part.stop - part.start for part in box)
        for name, values in block.arrays.items():
            self._array(name)[box] = values.reshape(*shape, *values.shape[1:])
        if block.texts:
            texts = np.full(block.stop - block.first, '', dtype=object)
            for run, text in block.texts.items():
                texts[run - block.first] = text
            self._array(plans.TEXT)[box] = texts.reshape(shape)

    def done(self, layout):
        """Return whether each block is done, array (blocks,) of bool."""
        return self._array(DONE_ARRAY)[:].astype(bool)

    def mark(self, number):
        """Mark a block as done."""
        self._array(DONE_ARRAY)[number] = 1

    def finish(self):
        """Remove the unfinished files of writers that were killed."""
        for path in self.path.rglob('*.partial'):
            path.unlink(missing_ok=True)

    def dataset(self, plan):
        """Return the result as an xarray.Dataset that is read when it is used."""
        import xarray
        found = xarray.open_zarr(self.path, consolidated=False, chunks=None)
        found.attrs.pop('sweep', None)
        return found


class ParquetStore(Store):
    """A folder of Parquet files, one for each block, with a row for each run."""

    ABOUT, LOCK, ROWS = '_sweep.json', '_sweep.lock', True

    def __init__(self, path):
        need('xarray', 'pyarrow')
        super().__init__(path)

    def _create(self, part, plan, block_runs):
        for one in plan.variables:
            if len(one.shape) > 1:
                raise BadInput('store', f'{one.name} has a value for each time',
                               'a path that ends in .zarr; Parquet has one row per run')
        size = plan.spec.size
        layout = Layout.of((size,), block_runs, block_runs)
        part.mkdir(parents=True)
        (part / self.ABOUT).write_text(json.dumps(
            {**self._words(plan, layout), 'attributes': attributes(plan)}), encoding='utf-8')

    def _kept(self):
        return json.loads((self.path / self.ABOUT).read_text(encoding='utf-8'))

    def _file(self, number):
        return self.path / f'block-{number:08d}.parquet'

    def write(self, layout, block, number):
        """Write a Block that was computed; it has the runs of a block of the layout."""
        import pyarrow
        import pyarrow.parquet
        columns = {'run_number': np.arange(block.first, block.stop)}
        for key, values in {**block.values, **block.arrays}.items():
            values = values if isinstance(values, np.ndarray) else np.array(
                [value if isinstance(value, str) else json.dumps(value) for value in values])
            columns.update(_columns(key, values))
        texts = np.full(block.stop - block.first, '', dtype=object)
        for run, text in block.texts.items():
            texts[run - block.first] = text
        columns[plans.TEXT] = texts
        part = self.path / f'.block-{number:08d}.{os.getpid()}.partial'
        try:
            pyarrow.parquet.write_table(pyarrow.table(columns), part, compression='zstd')
            part.replace(self._file(number))
        except OSError:
            part.unlink(missing_ok=True)
            raise

    def done(self, layout):
        """Return whether each block is done, array (blocks,) of bool."""
        there = {path.name for path in self.path.glob('block-*.parquet')}
        return np.array([self._file(number).name in there for number in range(layout.blocks)])

    def mark(self, number):
        """Do nothing: a block is done when its file is there."""

    def finish(self):
        """Remove the unfinished files of writers that were killed."""
        for path in self.path.glob('.*.partial'):
            path.unlink(missing_ok=True)

    def dataset(self, plan):
        """Return the result as an xarray.Dataset in memory."""
        import pyarrow.dataset
        table = pyarrow.dataset.dataset(
            sorted(map(str, self.path.glob('block-*.parquet'))), format='parquet').to_table()
        arrays = {}
        for one in plan.variables:
            names = [name for name, _ in _columns(one.name, np.empty((0, *one.shape)))]
            parts = [table[name].to_numpy() for name in names]
            arrays[one.name] = np.stack(parts, axis=1) if one.shape else parts[0]
        texts = {run: text for run, text in zip(
            table['run_number'].to_pylist(), table[plans.TEXT].to_pylist()) if text}
        return in_memory(plan, arrays, texts)


def _columns(name, values):
    """Return (name of a column, its values) of an array of one or two dimensions."""
    if values.ndim == 1:
        return [(name, values)]
    axes = 'xyzw' if values.shape[1] in (3, 4) else None
    return [(f'{name}.{axes[k] if axes else k}', values[:, k]) for k in range(values.shape[1])]


def _fitting(attrs):
    """Return attributes without the empty ones."""
    return {name: value for name, value in attrs.items() if value != ''}


def in_memory(plan, arrays, texts):
    """Return the result of a plan as an xarray.Dataset.

    Parameters
    ----------
    plan : Plan
    arrays : dict of str to array (runs, ...)
    texts : dict of int to str
        Number of a run that failed -> why.
    """
    import xarray
    shape, dims = plan.spec.shape, tuple(plan.dims)
    variables = {one.name: ((*dims, *one.dims), arrays[one.name].reshape(*shape, *one.shape),
                            _fitting(one.attrs)) for one in plan.variables}
    told = np.broadcast_to('', shape)    # takes no memory
    if texts:
        told = np.full(plan.spec.size, '', dtype=object)
        for run, text in texts.items():
            told[run] = text
        told = told.reshape(shape)
    variables[plans.TEXT] = dims, told, {'long_name': 'why the run failed'}
    coords = {name: (where, values, _fitting(attrs))
              for name, (where, values, attrs) in plans.coordinates(plan).items()}
    for key, values in plan.drawn().items():
        coords[key] = (plans.sample_dims(plan.spec.sample[key]), values,
                       _fitting(plans.sample_attrs(key)))
    return xarray.Dataset(variables, coords, attributes(plan))
