# SPDX-License-Identifier: Apache-2.0
"""Pieces of a course between breakpoints, on the made-up march of test_track.py."""

import math
import types

import numpy as np
import pytest
from integrators.marching.test_track import LENGTH, POINT, SIZE, TRACK

from rigid_body_sim.errors import NotConverged
from rigid_body_sim.integrators.marching import course
from rigid_body_sim.scene.state import STATE_SIZE

pytestmark = pytest.mark.without_numba


class Bound:
    """Places and kernels of the made-up march; no step is good from a time on.

    That time is in the first piece only: what a start has changed in the parameters stays.
    """

    def __init__(self, breakpoints=(), good=math.inf):
        self.equations = types.SimpleNamespace(breakpoints=breakpoints, fixed_count=1)
        self.march, self.point, self.piece_size = types.SimpleNamespace(SIZE=1), POINT, SIZE
        self.track, self._good, self.asked = TRACK, good, []

    def prototype(self, time):
        self.asked.append(time)
        good = self._good if len(self.asked) == 1 else -math.inf
        return np.array([good, 0.0, *np.zeros(LENGTH)])

    def steps_of(self, piece):
        return int(piece[1])


def started(*how, begin=0.0, stop=math.inf):
    """Return a course, on which 3 and the number of its steps stand for an unknown."""
    vector = np.zeros(STATE_SIZE)
    vector[0], vector[8] = begin, 3.0
    stepped = types.SimpleNamespace(
        method=types.SimpleNamespace(NAME='made'), scene=types.SimpleNamespace(name='up'),
        most=None, begin=begin, vector=vector, stop=stop)
    bound = Bound(*how)
    return course.Course(stepped, bound), bound


def known(time, begin=0.0):
    return [time, 3.0 + math.floor(time - begin), math.fmod(time - begin, 1.0)]


def one(made, time):
    out = np.zeros(3)
    made.state(time, out)
    return out.tolist()


@pytest.mark.parametrize(('breakpoints', 'asked'), [
    ((), [0.0]), ((2.0, 5.0), [0.0, 2.0, 5.0]), ((-1.0, 0.0, 2.0), [0.0, 2.0]),
    ((2.0, 9.0, 20.0), [0.0, 2.0, 9.0]), ((2.0, 9.25, 20.0), [0.0, 2.0])])
def test_a_piece_begins_at_each_breakpoint_before_the_last_time(breakpoints, asked):
    """With the parameters that hold from there on, and the unknowns of the end of the one before.

    Asked for together or one by one, in any order, the states are the same.
    """
    times = np.array([9.0, 0.5, 2.0, 1.75, 5.0, 2.25, 0.0, 9.125])
    (made, bound), out = started(breakpoints), np.zeros((len(times), 3))
    made.states(times, out)
    assert out.tolist() == [known(time) for time in times]
    assert bound.asked == asked
    for order in (times, times[::-1], np.sort(times)):
        made, bound = started(breakpoints)
        assert [one(made, time) for time in order] == [known(time) for time in order]
        assert bound.asked == asked
    assert made.kinks(9.0) == []
    assert not made.TELLS_EVENTS


def test_a_last_time_at_a_breakpoint_is_the_start_of_a_piece():
    made, bound = started((2.0, 3.0))
    made.states(np.array([1.0, 2.0]), np.zeros((2, 3)))
    assert bound.asked == [0.0, 2.0]


@pytest.mark.parametrize('time', [700.5, 130.0])
def test_a_time_far_ahead_is_reached_in_slices(time):
    for breakpoints in ((), (40.0, 600.0)):
        made, _ = started(breakpoints)
        assert one(made, time) == known(time)
        assert one(made, 0.5) == known(0.5)
        made, _ = started(breakpoints)
        out = np.zeros((2, 3))
        made.states(np.array([time, 64.25]), out)
        assert out.tolist() == [known(time), known(64.25)]


def test_more_times_than_one_call_takes_are_all_filled(monkeypatch):
    monkeypatch.setattr(course, 'AT_ONCE', 3)
    times, out = np.arange(10.0) / 4.0, np.zeros((10, 3))
    for breakpoints in ((), (1.0,)):
        made, _ = started(breakpoints)
        out[:] = math.nan
        made.states(times[::-1], out)
        assert out.tolist() == [known(time) for time in times[::-1]]


def test_a_course_that_starts_late_counts_from_there():
    made, bound = started((6.0, 8.0), begin=7.0)
    assert one(made, 8.25) == known(8.25, 7.0)
    assert bound.asked == [7.0, 8.0]


@pytest.mark.parametrize('ask', ['state', 'states'])
def test_a_march_that_ends_is_said_to_with_the_time_it_reached(ask):
    made, _ = started((), 5.0)
    assert one(made, 4.5) == known(4.5)
    with pytest.raises(NotConverged, match=r'made on up: at t = 5\.0 s the state is no') as ended:
        made.state(9.0, np.zeros(3)) if ask == 'state' else made.states(
            np.array([1.0, 9.0]), np.zeros((2, 3)))
    assert ended.value.time == 5.0
    made, _ = started((6.0,), 5.0)
    with pytest.raises(NotConverged, match=r't = 5\.0 s'):
        one(made, 7.0)
