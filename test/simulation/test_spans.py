# SPDX-License-Identifier: Apache-2.0
"""Spans: which one holds at a time, and its events.

Each event is reported once, by the call that reaches it, even if it was found early.
"""

import numpy as np
import pytest

from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.simulation.spans import Span, events_between, states_at, wrenches_at


class Solver:
    """It has events at whole seconds, and remembers what it was asked."""

    def __init__(self):
        self.asked = []

    def events(self, after, until, tick):
        self.asked.append((after, until, tick))
        return [(float(k), 'tick', {}) for k in range(20) if after < k <= until]


def span():
    solver = Solver()
    return Span(2.0, solver, None, (), None, None), solver


def times(found):
    return [time for time, _, _ in found]


def test_a_solver_looks_once_and_goes_forward():
    one, solver = span()
    assert times(one.events(2.0, 4.5, 0.1)) == [3.0, 4.0]
    assert times(one.events(4.5, 5.0, 0.1)) == [5.0]
    assert times(one.events(5.0, 7.0, 0.1)) == [6.0, 7.0]
    assert solver.asked == [(2.0, 4.5, 0.1), (4.5, 5.0, 0.1), (5.0, 7.0, 0.1)]


def test_what_was_found_early_is_kept_for_the_look_that_reaches_it():
    one, solver = span()
    assert times(one.events(2.0, 9.0, 0.1)) == [3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]
    # asked again up to an earlier time: nothing is looked for anew
    assert times(one.events(3.0, 6.0, 0.1)) == [4.0, 5.0, 6.0]
    assert times(one.events(6.0, 9.0, 0.1)) == [7.0, 8.0, 9.0]
    assert len(solver.asked) == 1
    assert times(one.events(9.0, 9.0, 0.1)) == []


def test_events_of_a_motion_come_from_the_span_that_holds_then():
    first, second = span()[0], Span(4.5, Solver(), None, (), None, None)
    found = list(events_between([first, second], 2.0, 6.0, 0.1))
    assert times(found) == [3.0, 4.0, 5.0, 6.0]
    assert first.solver.asked == [(2.0, 4.5, 0.1)] and second.solver.asked == [(4.5, 6.0, 0.1)]


class Steady:
    """Its states have the time and its own number."""

    def __init__(self, number):
        self.number = number

    def state(self, time, out):
        out[:], out[0] = self.number, time

    def states(self, times, out):
        out[:] = self.number
        out[:, 0] = times


@pytest.mark.parametrize('whole', [
    [0.0, 1.9, 2.0, 3.0, 4.5, 9.0], [9.0, 2.0, 0.5, 4.5, 2.0], [4.5, 2.0], [2.0], [4.4], [4.5],
    [], [1.0]])
def test_a_state_is_that_of_the_last_span_that_has_begun(whole):
    """A span begins at its very time, and two may begin at one: then the later one holds."""
    spans = [Span(time, Steady(number), f'held {number}', (), None, None)
             for number, time in enumerate([0.0, 2.0, 2.0, 4.5])]
    expected = [0 if time < 2.0 else 2 if time < 4.5 else 3 for time in whole]
    found = states_at(spans, np.array(whole))
    assert found[:, 0].tolist() == whole and found[:, 1].tolist() == expected
    assert wrenches_at(spans, np.array(whole)) == [f'held {number}' for number in expected]
    assert states_at(spans[:1], np.array(whole))[:, 1].tolist() == [0.0] * len(whole)
    assert states_at(spans[::3], np.array(whole))[:, 1].tolist() == [
        0.0 if time < 4.5 else 3.0 for time in whole]


def test_only_the_spans_that_reach_beyond_a_time_are_asked_for_events():
    first, second, third = (Span(time, Solver(), None, (), None, None) for time in (0.0, 3.0, 6.0))
    assert times(events_between([first, second, third], 3.0, 8.0, 0.1)) == [
        4.0, 5.0, 6.0, 7.0, 8.0]
    assert first.solver.asked == []    # it ends at that time
    # the last one that a look reaches is looked at up to there
    assert times(events_between([Span(0.0, Solver(), None, (), None, None), second], 0.0, 2.0,
                                0.1)) == [1.0, 2.0]


SLIDES = """
scene: slides
body: {mass: 1.0, shape: {solid_sphere: {radius: 0.05}}}
constraint: table
effects: [sliding_friction: {mu: 0.2, g: 9.81}]
initial: {velocity: [1.0, 0.2, 0], angular_velocity: [0, 0, 3]}
"""
BOUNCES = """
scene: bounces
body: {mass: 1.0, inertia: [0.001, 0.001, 0.001], surface: {sphere: {radius: 0.05}}}
constraint: {table: {restitution: 0.5}}
effects: [gravity: {g: 9.81}]
initial: {position: [0, 0, 1.05]}
"""


@pytest.mark.without_numba
@pytest.mark.parametrize(('text', 'ticks'), [(SLIDES, [16]), (BOUNCES, [136])])
def test_an_event_at_the_very_end_of_a_look_is_not_lost(text, ticks):
    """The time of an event is that since the span began, and rounds where that is not 0."""
    def later(tick):
        one = Simulation(parse_scene(text), 'dop8', 1e-6)
        one.advance(tick)
        one.hold(force=[0.1, 0.05, 0.01])
        return one._spans[-1]

    for tick in ticks:
        for time in times(later(tick).solver.events(0.001 * tick, 1.3)):
            one = later(tick)
            found = one.events(one.time, time, 1e-3) + one.events(time, time + 0.01, 1e-3)
            assert times(found).count(time) == 1
