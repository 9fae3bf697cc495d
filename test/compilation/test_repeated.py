# SPDX-License-Identifier: Apache-2.0
"""A loop that hands a kernel the same arrays: it is called past the search for its version."""

import numpy as np
import pytest

from rigid_body_sim.compilation import repeated as module
from rigid_body_sim.compilation.jit import HAVE_NUMBA, compiled
from rigid_body_sim.compilation.repeated import repeated

ROOM = np.array([100.0])


@compiled
def added(room, start, time, out):
    """Fill out with a sum; return whether the time is not negative."""
    out[0] = room[0] + start[0] + time
    return time >= 0.0


@compiled
def summed(room, start, time, out):
    """Fill out with sums."""
    for k in range(len(out)):
        out[k] = room[0] + start[k] + time


def refused(start, time, out):
    """Raise what tells all of a call."""
    raise ValueError(f'{start.tolist()} {time} {out.tolist()}')


def test_what_comes_again_is_handed_on_as_it_is_then():
    run = repeated(added, ROOM, True, refused)
    start, out, other = np.array([1.0, 7.0]), np.zeros(2), np.zeros(2)
    for value in (1.0, 2.0, 3.0):
        start[0] = value
        for time in (0.5, np.float64(0.5), 2):
            run(start, time, out)
            assert out[0] == 100.0 + value + time
    run(start, 0.5, other)
    assert (other[0], out[0]) == (103.5, 105.0)
    for row in np.array([[4.0], [5.0]]):
        for _ in range(2):
            run(row, 0.0, out)
            assert out[0] == 100.0 + row[0]


@pytest.mark.parametrize('calls', [1, 2, 3])
def test_a_call_that_does_not_go_well_is_told_whether_or_not_it_comes_again(calls):
    run, start, out = repeated(added, ROOM, True, refused), np.array([1.0]), np.zeros(1)
    for _ in range(calls - 1):
        run(start, 0.0, out)
    with pytest.raises(ValueError, match=r'^\[1.0\] -1.0 \[100.0\]$'):
        run(start, -1.0, out)


@pytest.mark.filterwarnings('ignore::DeprecationWarning')
def test_an_array_whose_shape_is_set_in_place_remains_what_it_was():
    run, start, out = repeated(added, ROOM, True, refused), np.array([1.0]), np.zeros(4)
    for _ in range(2):
        run(start, 0.0, out)
    out.shape = (2, 2)
    run(start, 0.5, out)
    assert out.ravel().tolist() == [101.5, 0.0, 0.0, 0.0]


@pytest.mark.skipif(not HAVE_NUMBA, reason='plain Python has no versions of a kernel')
def test_numba_looks_once_for_the_version_that_fits(monkeypatch):
    run, start, out, asked = repeated(added, ROOM, True, refused), np.ones(1), np.zeros(1), []
    found = module._version
    monkeypatch.setattr(module, '_version', lambda *call: asked.append(call) or found(*call))
    for _ in range(4):
        run(start, 0.0, out)
    (kernel, *arrays), = asked
    assert kernel is added
    assert [array.base for array in arrays[1:]] == [start, out]
    assert found(added, ROOM, start, out) in {
        each.entry_point for each in added.overloads.values()}
    # for these none was compiled
    assert found(added, ROOM, start[::1].astype(np.float32), out) is added


@pytest.mark.skipif(not HAVE_NUMBA, reason='plain Python takes any numbers')
def test_arrays_of_other_numbers_are_taken_for_what_they_are():
    run, start, out = repeated(added, ROOM, True, refused), np.array([3]), np.zeros(1)
    for _ in range(3):
        run(start, 0.5, out)
        assert out[0] == 103.5


def test_what_is_filled_may_be_every_other_number_of_an_array():
    run, start, out = repeated(summed, ROOM, None, refused), np.array([1.0, 2.0]), np.zeros((2, 2))
    for column in (out.ravel()[:2], out[:, 1]):
        for _ in range(2):
            run(start, 0.5, column)
    assert out.tolist() == [[101.5, 101.5], [0.0, 102.5]]
