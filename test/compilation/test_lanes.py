# SPDX-License-Identifier: Apache-2.0
"""Recurrences on lanes: the same in plain Python and by registers of four or eight numbers."""

import numpy as np
import pytest

from rigid_body_sim.compilation import lanes
from rigid_body_sim.compilation.jit import HAVE_NUMBA, numba
from rigid_body_sim.integrators.marching import batch_turning, taylor_series
from rigid_body_sim.integrators.marching.batch_lane import INVERSES, ORDER, ROWS
from rigid_body_sim.integrators.marching.batch_step import Rows, fill

ROW = lanes.LANES


@pytest.fixture(params=['four', 'eight'])
def compiled(request, monkeypatch):
    """Return what compiles a recurrence for registers of that size: act(array, *numbers)."""
    if not HAVE_NUMBA:
        pytest.skip('registers are chosen where kernels are compiled')
    monkeypatch.setattr(lanes, '_is_narrow', lambda context: request.param == 'four')

    def compiled(recurrence, results, narrow):
        kernel = lanes.compiled_lanes(recurrence, results, narrow)
        act = numba.njit(lambda array, numbers: kernel(array, numbers))
        return lambda array, *numbers: act(array, numbers)
    return compiled


def _numbers(rows, seed=1):
    return np.random.default_rng(seed).uniform(0.5, 2.0, rows * ROW)


def _shifted(o, array, x, y):
    """Return what comes of all operations that vectors as two halves have."""
    one, other, few = o.load(array, 0), o.load(array, ROW), o.none()
    for lane in range(6):
        few = o.with_lane(few, lane, x)
        if lane in (1, 5):    # with an upper half that is absent, and with one that is not
            one = o.gather(o.everywhere(y), few, one)
            other = o.plus(o.times(few, other), o.minus(o.next(one)))
            one, few = o.next(one), o.plus(few, o.next(few))
    kept = o.keep(o.gather(few, other, o.times(one, few)), 3)
    found = [o.first(kept), o.first(o.next(o.next(kept)))]
    for _ in range(ROW):
        found.append(o.first(other))
        other = o.next(other)
    o.store(o.gather(x, y, o.number(0.25)), array, 2 * ROW)
    return found


def test_vectors_that_move_from_lane_to_lane_are_the_same_as_two_halves(compiled):
    """Upper halves that are absent leave zeros of another sign."""
    plain, other = _numbers(3), _numbers(3)
    expected = _shifted(lanes.Plain(), plain, 1.1, 0.7)
    found = compiled(_shifted, len(expected), lanes.IN_HALVES)(other, 1.1, 0.7)
    np.testing.assert_array_equal(found, expected)
    assert other.tobytes() == plain.tobytes()


def _apart(o, array, x):
    """Change each lane by all operations that lanes apart have."""
    one, other = o.load(array, 0), o.load(array, ROW)
    quotient = o.divided(o.root(one), o.plus(other, o.everywhere(x)))
    small = o.where_less(one, other, quotient, o.minus(o.power(one, 0.25)))

    def grown(i, values):
        row = o.load(array, o.place(0, ROW, i))
        return [o.gather(row, value, value) for value in values]
    sums = []
    for group in o.groups([[small], [quotient, o.times(one, other)]]):
        sums += o.repeat(0, 2, group, grown)
    for k, value in enumerate(sums):
        o.put(value, array, ROW * (2 + k))
    return []


def test_lanes_apart_are_the_same_in_turn(compiled):
    plain, other = _numbers(5), _numbers(5)
    _apart(lanes.Plain(), plain, 0.3)
    compiled(_apart, 0, lanes.IN_TURN)(other, 0.3)
    assert other.tobytes() == plain.tobytes()
    assert (plain[2 * ROW:] != _numbers(5)[2 * ROW:]).all()


def test_sums_in_portions_are_the_sums_in_one_loop(compiled):
    """A batch's series: 15 sums at once, or nine and six of them."""
    assert [len(portion) for portion in batch_turning.PORTIONS] == [9, 6]

    def filled(o, array):
        fill(o, Rows(o, array, ORDER), batch_turning.FORM)
        return []
    plain = _numbers(ROWS)
    plain[ROW * INVERSES:ROW * (INVERSES + ORDER)] = np.repeat(1.0 / np.arange(1, ORDER + 1), ROW)
    other = plain.copy()
    filled(lanes.Plain(), plain)
    compiled(filled, 0, lanes.IN_TURN)(other)
    assert other.tobytes() == plain.tobytes()


def test_the_series_of_a_body_are_the_same_as_two_halves(compiled, monkeypatch):
    """Where a coefficient is zero its sign may differ; no change of an unknown shows it."""
    made = []
    monkeypatch.setattr(taylor_series, 'compiled_lanes',
                        lambda *recurrence, **narrow: made.append((recurrence, narrow)))
    taylor_series.expansion(False, False, False, False)
    [((recurrence, _), settings)] = made
    expand = compiled(recurrence, 0, settings['narrow'])
    along = compiled(taylor_series._along, taylor_series.UNKNOWNS, None)
    for omega in ((0.3, -1.2, 0.7), (0.0, -0.0, 0.9), (0.0, 0.0, -0.0)):
        numbers = (0.1, -0.2, 0.3, 0.9, *omega), (0.0, 0.3, -0.3), (0.0, 0.2, -0.0), (), (), ()
        plain, other = (np.zeros(ROW * (taylor_series.ORDER + 1)) for _ in range(2))
        recurrence(lanes.Plain(), plain, *numbers)
        expand(other, *numbers)
        np.testing.assert_array_equal(other, plain)
        changes = np.array(taylor_series._along(lanes.Plain(), plain, 0.1))
        assert np.array(along(other, 0.1)).tobytes() == changes.tobytes()
    nowhere = np.full(ROW * (taylor_series.ORDER + 1), -0.0)
    assert not np.signbit(taylor_series._along(lanes.Plain(), nowhere, 0.1)).any()
    assert not np.signbit(along(nowhere, 0.1)).any()
