# SPDX-License-Identifier: Apache-2.0
"""The parts of states, by rows that count up: number k of row n is 14 n + k."""

import numpy as np
import pytest

from rigid_body_sim.scene.state import PLACES, SHOWN, STATE_SIZE, State, States

PARTS = {'orientation': (1, 5), 'angular_velocity': (5, 8), 'position': (8, 11),
         'velocity': (11, 14)}
COLUMNS = [f'{part}_{axis}' for part, (begin, end) in PARTS.items()
           for axis in ('xyzw' if end - begin == 4 else 'xyz')]


def counting(rows):
    return States(np.arange(14.0 * rows).reshape(rows, 14))


def test_each_part_has_its_numbers_of_the_vector():
    state, states = State(np.arange(14.0)), counting(3)
    assert state.time == 0.0
    assert states.time.tolist() == [0.0, 14.0, 28.0]
    for part, (begin, end) in PARTS.items():
        expected = list(range(begin, end))
        assert getattr(state, part).tolist() == expected
        assert getattr(states, part).tolist() == [
            [14 * row + k for k in expected] for row in range(3)]


def test_the_places_of_the_parts_fill_a_state():
    assert STATE_SIZE == 14
    assert {part: (place.start, place.stop) for part, place in PLACES.items()} == {
        'time': (0, 1), **PARTS}


def test_a_state_of_parts_has_them_in_order_and_zeros_elsewhere():
    assert State.of().vector.tolist() == [0, 0, 0, 0, 1, *[0] * 9]
    assert State.of(7, [1, 2, 3, 4], [5, 6, 8], [9, 10, 11], [12, 13, 14]).vector.tolist() == [
        7, 1, 2, 3, 4, 5, 6, 8, 9, 10, 11, 12, 13, 14]


def test_a_state_is_an_array_of_its_own_numbers_or_a_copy():
    state = State(np.arange(14.0))
    assert np.asarray(state) is state.vector
    assert not np.shares_memory(np.array(state, copy=True), state.vector)


def test_an_index_gives_a_state_and_a_slice_gives_states():
    states = counting(4)
    assert type(states[2]) is State
    assert states[2].vector.tolist() == list(range(28, 42))
    assert type(states[1:3]) is States
    assert states[[3, 0]].time.tolist() == [42.0, 0.0]
    assert [state.time for state in states] == [0.0, 14.0, 28.0, 42.0]
    assert len(states) == 4
    with pytest.raises(TypeError, match='one index'):
        states[1, 2]


def test_states_are_shown_with_all_their_numbers_and_no_more_than_ten_of_them():
    assert repr(counting(3)) == 'States(3 states from 0.0 s to 28.0 s)'
    assert repr(counting(0)) == 'States(none)'
    assert repr(State(np.arange(14.0))) == (
        'State(time=0.0, orientation=[1.0, 2.0, 3.0, 4.0], angular_velocity=[5.0, 6.0, 7.0], '
        'position=[8.0, 9.0, 10.0], velocity=[11.0, 12.0, 13.0])')
    row = ''.join(f'<td>{k}</td>' for k in range(14))
    assert State(np.arange(14.0))._repr_html_().endswith(f'<tbody><tr>{row}</tr></tbody></table>')
    assert SHOWN == 10
    for rows in (SHOWN, SHOWN + 1):
        shown = counting(rows)._repr_html_()
        assert shown.count('<td>') == 14 * SHOWN
        assert ('<p>States(' in shown) == (rows > SHOWN)
    heads = shown[:shown.index('<tbody>')]
    assert heads.count('<th>') + heads.count('<th ') == 1 + 4 + 13
    assert '<th rowspan="2">time (s)</th><th colspan="4">orientation (1)</th>' in heads


def test_tables_have_a_named_column_for_each_number_but_the_time():
    pytest.importorskip('pandas')
    table = counting(3).to_pandas()
    assert table.columns.tolist() == COLUMNS
    assert table.index.tolist() == [0.0, 14.0, 28.0]
    assert table.to_numpy().tolist() == [
        list(range(14 * row + 1, 14 * row + 14)) for row in range(3)]


def test_a_dataset_has_the_quaternion_and_the_axes_named():
    pytest.importorskip('xarray')
    states = counting(3)
    data = states.to_xarray()
    for part in PARTS:
        assert data[part].dims == ('time', 'quaternion' if part == 'orientation' else 'axis')
        assert data[part].values.tolist() == getattr(states, part).tolist()


def test_parts_are_drawn_over_one_time():
    pytest.importorskip('matplotlib').use('Agg')
    from matplotlib import pyplot
    states = counting(3)
    for parts in ((), ('velocity',)):
        rows = states.plot(*parts)
        for axes, part in zip(rows, parts or ('orientation', 'angular_velocity'), strict=True):
            assert [line.get_ydata().tolist() for line in axes.lines] == getattr(
                states, part).T.tolist()
            assert [line.get_label() for line in axes.lines] == list(
                'xyzw' if part == 'orientation' else 'xyz')
            assert axes.lines[0].get_xdata().tolist() == [0.0, 14.0, 28.0]
        rows[0].set_xlim(5.0, 6.0)
        assert rows[-1].get_xlim() == (5.0, 6.0)
        assert rows[-1].get_xlabel() == 'time (s)'
    pyplot.close('all')
    with pytest.raises(ValueError, match='no part'):
        states.plot('speed')
