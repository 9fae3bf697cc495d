# SPDX-License-Identifier: Apache-2.0
"""Stores of results that are chosen: what is written in blocks is read as a whole."""

import os

import numpy as np
import pytest

pytest.importorskip('xarray')
pytest.importorskip('zarr', minversion='3.1')
pytest.importorskip('pyarrow')

from rigid_body_sim.errors import BadInput
from rigid_body_sim.sweeps import spec as specs
from rigid_body_sim.sweeps import stores
from rigid_body_sim.sweeps.plan import Plan
from rigid_body_sim.sweeps.results import Block

KINDS = pytest.mark.parametrize('kind', ['zarr', 'parquet'])


def plan(**changes):
    return Plan(specs.read({
        'scene': 'tennis_racket', 'vary': {'body.mass': [1.0, 2.0, 3.0]},
        'sample': {'runs': 7, 'initial.orientation': 'rotation',
                   'initial.angular_velocity.0': {'uniform': [0, 1]}},
        'keep': ['final', {'all': 'flip', 'most': 2}], **changes}))


def numbered(one):
    """Return arrays of all runs whose numbers differ, and texts of runs 4 and 20."""
    arrays, begin = {}, 1
    for each in one.variables:
        shape = one.spec.size, *each.shape
        size = np.prod(shape)
        arrays[each.name] = np.arange(begin, begin + size).reshape(shape).astype(each.dtype)
        begin += size
    return arrays, {4: 'too fast', 20: 'too heavy'}


@KINDS
def test_blocks_that_are_written_one_by_one_are_read_as_a_whole(tmp_path, kind):
    one = plan()
    arrays, texts = numbered(one)
    store = stores.store_at(tmp_path / f'a.{kind}')
    layout = store.make(one, 4)
    assert layout.blocks > 3
    for number in reversed(range(layout.blocks)):
        assert store.done(layout).tolist() == [k > number for k in range(layout.blocks)]
        first, stop = layout.runs(number)
        store.write(layout, Block(
            first, stop, {name: array[first:stop] for name, array in arrays.items()},
            one.values(first, stop) if store.ROWS else {},
            {run: text for run, text in texts.items() if first <= run < stop}), number)
        store.mark(number)
    assert store.done(layout).all()
    # another process that goes on with it sees the same
    again = stores.store_at(tmp_path / f'a.{kind}')
    assert again.make(one, 1000) == layout and again.done(layout).all()
    found, expected = again.dataset(one), stores.in_memory(one, arrays, texts)
    assert set(found.variables) == set(expected.variables)
    assert found.sizes == expected.sizes
    for name, variable in expected.variables.items():
        assert found[name].dims == variable.dims, name
        assert found[name].dtype == variable.dtype or variable.dtype.kind in 'OU', name
        assert (found[name].values == variable.values).all(), name
        assert {key: value for key, value in found[name].attrs.items() if key != 'coordinates'} \
            == variable.attrs, name
    assert found['status_text'].values.ravel().tolist() == [texts.get(k, '') for k in range(21)]
    # nothing is told that is not known
    assert 'units' not in found['status'].attrs
    assert set(expected.attrs) <= set(found.attrs)


@KINDS
def test_unfinished_files_are_removed_and_no_others(tmp_path, kind):
    store = stores.store_at(tmp_path / f'a.{kind}')
    store.make(plan(), 5)
    before = sorted(path for path in store.path.rglob('*') if path.is_file())
    (store.path / '.block-00000001.77.partial').write_text('half')
    store.finish()
    assert sorted(path for path in store.path.rglob('*') if path.is_file()) == before


@KINDS
def test_a_store_that_cannot_be_made_leaves_nothing(tmp_path, monkeypatch, kind):
    store = stores.store_at(tmp_path / f'a.{kind}')
    left_behind = tmp_path / f'a.{kind}.{os.getpid()}.making'    # by a process of this number
    left_behind.mkdir()
    (left_behind / 'half').write_text('')

    def fails(part, plan, block_runs):
        assert not part.exists()
        if block_runs > 1:
            part.mkdir()
        raise OSError('no room')
    monkeypatch.setattr(store, '_create', fails)
    for runs in (1, 2):
        with pytest.raises(OSError, match='no room'):
            store.make(plan(), runs)
        assert list(tmp_path.iterdir()) == []


def test_the_lock_has_the_number_of_its_process(tmp_path):
    store = stores.store_at(tmp_path / 'a.parquet')
    store.make(plan(), 5)
    (store.path / store.LOCK).write_text('123456789012345')    # of one that was killed
    for _ in range(2):
        with store.alone():
            assert (store.path / store.LOCK).read_text() == str(os.getpid())
            with pytest.raises(BadInput, match=f': process {os.getpid()} is sweeping it'), \
                    stores.store_at(store.path).alone():
                pass


def test_what_has_a_value_for_each_time_is_not_for_parquet(tmp_path):
    with pytest.raises(BadInput, match='orientation has a value for each time'):
        stores.store_at(tmp_path / 'a.parquet').make(plan(keep=['states']), 5)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(('shape', 'names'), [
    ((5,), ['a']), ((5, 3), ['a.x', 'a.y', 'a.z']), ((5, 4), ['a.x', 'a.y', 'a.z', 'a.w']),
    ((5, 2), ['a.0', 'a.1']), ((3, 5), [f'a.{k}' for k in range(5)]), ((5, 1), ['a.0'])])
def test_columns_have_the_names_of_axes(shape, names):
    values = np.arange(np.prod(shape)).reshape(shape)
    found = stores._columns('a', values)
    assert [name for name, _ in found] == names
    assert (np.stack([column for _, column in found], axis=-1).reshape(shape) == values).all()


def test_what_is_read_at_once_has_about_the_size_that_is_asked(tmp_path, monkeypatch):
    """The largest variable has 4 x 3 doubles a run, 96 bytes: five runs a chunk, and no fewer."""
    monkeypatch.setattr(stores, 'CHUNK_BYTES', 5 * 96 + 95)
    monkeypatch.setattr(stores, 'PIECE', 16)
    one = plan(vary={}, sample={'runs': 100, 'initial.orientation': 'rotation'},
               times=[1.0, 2.0, 3.0], keep=['states'])
    store = stores.store_at(tmp_path / 'a.zarr')
    layout = store.make(one, 20)
    assert (layout.chunk, layout.wide, layout.blocks) == (5, 20, 5)
    group = store._group
    assert group['orientation'].chunks == (5, 3, 4) and group['orientation'].shards == (20, 3, 4)
    # samples are written a piece at a time
    assert group['initial.orientation'].chunks == (2, 4)
    assert group['initial.orientation'][:].tobytes() == \
        one.spec.sample['initial.orientation'].of_runs(0, 100).tobytes()
    assert group['progress/done'].chunks == (5,)
    assert np.isnan(group['orientation'][:]).all() and (group['status'][:] == -1).all()
    # a chunk is a run at least
    monkeypatch.setattr(stores, 'CHUNK_BYTES', 10)
    assert stores.store_at(tmp_path / 'b.zarr').make(one, 20).chunk == 1
