# SPDX-License-Identifier: Apache-2.0
"""Events of a span: each is reported once, by the call that reaches it, even if found early."""

from rigid_body_sim.simulation.spans import Span, events_between


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
