# SPDX-License-Identifier: Apache-2.0
"""States, events and ledger of a course whose phases are made up."""

import math
import types

import numpy as np
import pytest

from rigid_body_sim.errors import Ended
from rigid_body_sim.integrators.marching import contact_course
from rigid_body_sim.integrators.marching.contact_course import EVENT, TIME, PlaneCourse
from rigid_body_sim.mechanics.ledger import ENTRIES_SIZE, HEATS
from rigid_body_sim.scene.state import STATE_SIZE

pytestmark = pytest.mark.without_numba

BEGIN = 100.0


class Phases:
    """Phases that end at 1, 2 and never."""

    def __init__(self, begin=BEGIN):
        self.begin, self.phases, self.begins, self.events = begin, [], [], []
        self.over, self.why, self.last, self.allowed = None, 'it ends', 102.0, (0.0, math.inf)
        self.written = []
        self.add(0.0)

    def add(self, begin):
        end = begin + 1.0 if begin < 2.0 else math.inf
        self.phases.append(types.SimpleNamespace(
            end=end, reach=lambda elapsed, steps: elapsed >= end,
            front=np.full(TIME + 1, end)))
        self.begins.append(begin)

    def follow(self, phase):
        self.events.append((BEGIN + phase.end, 'end of phase', {}))
        self.add(phase.end)

    def write(self, place, times, rows, out):
        for k in rows:
            out[k, :2] = self.begins[place], times[k]
        self.written.append(len(rows))


def made(monkeypatch):
    """Return (a course, its phases, what its work is told)."""
    phases, told = Phases(), []

    def work(name, most, **how):
        told.append((name, most, how))
        return types.SimpleNamespace(count=lambda *what: told.append(what))
    monkeypatch.setattr(contact_course, 'Succession', lambda *of: told.append(of) or phases)
    monkeypatch.setattr(contact_course, 'Work', work)
    stepped = types.SimpleNamespace(vector='start', accuracy=2e-9, horizon=4.0, most=7,
                                    method=types.SimpleNamespace(NAME='made'))
    bound = types.SimpleNamespace(scene=types.SimpleNamespace(name='up'))
    course = PlaneCourse(stepped, bound)
    assert told == [(bound, 'start', 2e-9, 4.0),
                    ('made on up', 7, {'comes_to_rest': True, 'origin': BEGIN})]
    told.clear()
    return course, phases, told


def test_states_are_those_of_their_phases(monkeypatch):
    monkeypatch.setattr(contact_course, 'ROWS', 2)
    times, out = np.array([102.5, 100.0, 101.0, 102.0, 101.5, 104.0, 100.9]), np.zeros((7, 2))
    begins = [2.0, 0.0, 1.0, 2.0, 1.0, 2.0, 0.0]
    course, phases, told = made(monkeypatch)
    course.states(times, out)
    assert out.tolist() == [[*row] for row in zip(begins, times, strict=True)]
    assert phases.written == [2, 2, 2, 1]
    assert told == [(EVENT, 1.0, 4.0), (EVENT, 2.0, 4.0)]
    for time, begin in zip(times, begins, strict=True):
        one = np.zeros(2)
        course, phases, _ = made(monkeypatch)
        course.state(time, one)
        assert one.tolist() == [begin, time]
        assert len(phases.phases) == 1 + begin


def test_the_ledger_stands_behind_the_state(monkeypatch):
    course, phases, _ = made(monkeypatch)
    phases.write = lambda place, times, rows, out: np.copyto(out, np.arange(out.shape[1]))
    size = ENTRIES_SIZE + len(HEATS)
    assert course.entries(100.5).tolist() == [*map(float, range(STATE_SIZE, STATE_SIZE + size))]


def test_a_course_that_has_ended_says_why_beyond_its_end(monkeypatch):
    course, phases, _ = made(monkeypatch)
    phases.over = 2.5
    course.reach(2.5)
    with pytest.raises(Ended, match=r'^up: it ends$') as ended:
        course.reach(2.6)
    assert ended.value.time == 102.0
    phases.phases = []    # it ends where it begins
    with pytest.raises(Ended):
        course.reach(2.0)


def test_events_are_told_after_one_time_and_up_to_another(monkeypatch):
    course, phases, _ = made(monkeypatch)
    first, second = (101.0, 'end of phase', {}), (102.0, 'end of phase', {})
    assert course.events(100.0, 101.0) == [first]
    assert course.events(101.0, 102.0) == [second]
    assert course.events(100.5, 109.0) == [first, second]
    assert course.events(101.0, 101.5) == []
    phases.phases, phases.over, phases.events = [], 0.0, ['impact', (100.0, 'end', {})]
    assert course.events(100.0, 101.0) == [(100.0, 'end', {})]


def test_the_error_that_a_ring_allows_itself_counts_from_its_time_on(monkeypatch):
    course, phases, _ = made(monkeypatch)
    assert course.allowance(1e9) is None
    phases.allowed = 1e-5, 2.5
    assert course.allowance(102.5) == (1e-5, 102.5)
    assert course.allowance(102.4) is None
