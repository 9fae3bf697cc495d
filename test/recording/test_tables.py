# SPDX-License-Identifier: Apache-2.0
"""Columns of a topic as tables: names of their numbers, texts, and several topics joined."""

import numpy as np
import pytest

from rigid_body_sim.recording import tables

COLUMNS = {'log_time': np.array([5, 10**9 + 5]), 'label': np.array([b'left', b'gr\xc3\xb6\xff']),
           'position': np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]),
           'ranges': np.array([[1, 2, 3, 4], [5, 6, 7, 8]]), 'size': np.array([0.5, 0.25])}
COMPONENTS = {'position': ['x', 'y', 'z']}
LABELS = ['left', 'gr\xf6\ufffd']


def test_seconds_count_from_the_start():
    assert tables.seconds(COLUMNS['log_time'], 5).tolist() == [0.0, 1.0]


def test_flat_columns_have_a_name_for_each_number():
    found = {name: column.tolist() for name, column in tables.flat(COLUMNS, COMPONENTS).items()}
    assert found == {
        'log_time': [5, 10**9 + 5], 'label': LABELS, 'position.x': [1.0, 4.0],
        'position.y': [2.0, 5.0], 'position.z': [3.0, 6.0], 'ranges.0': [1, 5],
        'ranges.1': [2, 6], 'ranges.2': [3, 7], 'ranges.3': [4, 8], 'size': [0.5, 0.25]}


def test_a_dataset_has_a_dimension_for_several_numbers():
    found = tables.dataset(pytest.importorskip('xarray'), COLUMNS, COMPONENTS, 5)
    assert found['time'].values.tolist() == [0.0, 1.0]
    assert found['label'].values.tolist() == LABELS
    assert found['size'].dims == found['label'].dims == ('time',)
    assert found['position.component'].values.tolist() == ['x', 'y', 'z']
    assert found['ranges.component'].values.tolist() == [0, 1, 2, 3]
    for name in ('position', 'ranges'):
        assert found[name].dims == ('time', f'{name}.component')
        assert (found[name].values == COLUMNS[name]).all()


def block(*times, **more):
    return {'log_time': np.array(times), 'sequence': np.array(times), 'seconds': np.array(times),
            'data': 10.0 * np.array(times), **more}


def test_rows_come_as_soon_as_all_topics_have_got_beyond_them():
    joined = tables.Joined({'/a': 'a', '/b': 'b'})
    assert joined.add('/a', block(1, 2, 3, 4)) is None
    assert joined.add('/b', block(1, 2))['log_time'].tolist() == [1, 2]
    assert joined.add('/b', block(3))['a.data'].tolist() == [30.0]
    assert joined.add('/b', block(5)) is None    # the two have no time in common yet
    found = joined.add('/a', block(5, 6))
    assert {name: column.tolist() for name, column in found.items()} == {
        'log_time': [5], 'a.data': [50.0], 'b.data': [50.0]}
    assert joined.add('/b', block(6, 7))['b.data'].tolist() == [60.0]


def test_a_block_that_lacks_a_column_is_an_error():
    joined = tables.Joined({'/a': 'a', '/b': 'b'})
    for one in (block(1, more=np.array([1.0])), block(2)):
        joined.add('/a', one)
    with pytest.raises(KeyError, match='more'):
        joined.add('/b', block(1, 2))
