# SPDX-License-Identifier: Apache-2.0
"""Spans that strikes begin: when, from which state, and what a body cannot take."""

import types

import numpy as np
import pytest
from choice.known_bodies import Coasting, coasting_scene

from rigid_body_sim.errors import BadInput, Ended
from rigid_body_sim.mechanics.ledger import entries_size
from rigid_body_sim.mechanics.parameters import parameters
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation import strikes
from rigid_body_sim.simulation.spans import Span
from rigid_body_sim.simulation.strikes import Strikes

ROD = ('scene: rod\nbody: {{mass: 1, inertia: [1, 1, 0]}}\nconstraint: free\n'
       'effects: [strike: {{impulse: [0, 1, 0], point: [0.5, 0, 0], time: {}}}]\n'
       'initial: {{angular_velocity: [1, 0, 0]}}\n')


def spans_until(scene, time, begun=0.0, wrench=None):
    """Return the spans of a body that coasts, from a first one that begins at a time (s).

    They are followed up to a time, or to one after another.
    """
    def solver(start, wrench):
        found = Coasting().start(start)
        found.name, found.entries = 'coasting', lambda at: np.full(entries_size(scene), at)
        return found
    start = scene.initial.vector.copy()
    start[0] = begun
    wrench = wrench or Wrench()
    first = Span(begun, solver(start, wrench), wrench, 0, np.zeros(entries_size(scene)), start)
    spans, follow = [first], Strikes(scene, parameters(scene)).follow
    for until in np.atleast_1d(time).tolist():
        spans = follow(spans, until, types.SimpleNamespace(solver=solver))
    return spans


@pytest.mark.parametrize(('until', 'times', 'rates'), [
    (0.9, [0.0], [3.0]), (1.0, [0.0, 1.0], [3.0, 1.0]), (2.4, [0.0, 1.0], [3.0, 1.0]),
    (5.0, [0.0, 1.0, 2.5], [3.0, 1.0, 2.0]), ((2.4, 5.0), [0.0, 1.0, 2.5], [3.0, 1.0, 2.0])])
def test_a_strike_begins_a_span_at_its_very_time(until, times, rates):
    """J at y = 1 along x takes J/4 from the rate about z."""
    scene, held = coasting_scene((2.5, -4.0), (1.0, 8.0), (9.0, 1.0)), Wrench((1.0, 0.0, 0.0))
    found = spans_until(scene, until, wrench=held)
    assert [span.time for span in found] == [span.start[0] for span in found] == times
    assert [span.start[7] for span in found] == pytest.approx(rates)
    assert [span.strikes for span in found] == list(range(len(times)))
    assert all(span.wrench == held for span in found)    # what is held goes on


def test_entries_of_the_ledger_add_up_from_span_to_span():
    """Those of the body here are its time; strikes of 1e-12 N s add next to nothing."""
    found = spans_until(coasting_scene((2.5, 1e-12), (1.0, 1e-12)), 3.0)
    assert [span.given.tolist() for span in found] == [
        pytest.approx([total] * entries_size(coasting_scene()), abs=1e-9)
        for total in (0.0, 1.0, 3.5)]
    # the energy and the length of the impulse
    assert [span.passed for span in found] == [
        pytest.approx((total, total * 3.0 ** 0.5), abs=1e-9) for total in (0.0, 1.0, 3.5)]


def test_a_strike_that_is_late_acts_where_the_motion_goes_on():
    assert [span.time for span in spans_until(coasting_scene((1.0, 8.0)), 4.0, 3.0)] == [3.0, 3.0]


@pytest.mark.parametrize(('scene', 'later', 'words'), [
    (coasting_scene((0.0, -8.0)), coasting_scene((0.5, -8.0)), 'would do a work of'),
    (parse_scene(ROD.format(0.0)), parse_scene(ROD.format(0.5)), 'has a torque about an')])
def test_what_a_body_cannot_take_is_refused_at_the_start_and_ends_a_motion_later(
        scene, later, words, monkeypatch):
    monkeypatch.setattr(strikes, 'LARGEST_WORK', 10.0)    # J; it would be 16 + 32
    with pytest.raises(BadInput, match=f'at 0 s it {words}'):
        spans_until(scene, 1.0)
    first, last = spans_until(later, 2.0)
    assert last.time == 0.5 and first.solver.state
    assert last.start[5:8].tolist() == later.initial.vector[5:8].tolist()    # it is not struck
    out = np.empty((1, 14))
    for ask in (lambda: last.solver.state(2.0, out[0]), lambda: last.solver.entries(2.0),
                lambda: last.solver.states(np.array([2.0]), out)):
        with pytest.raises(Ended, match=f'at 0.5 s it {words}') as end:
            ask()
        assert end.value.time == 0.5
    last.solver.states(np.empty(0), out[:0])    # nothing is asked
    assert last.solver.events(0.0, 9.0) == [(0.5, 'end', {})]
    assert last.solver.allowance(9.0) is None
    assert last.solver.name == 'coasting'


def test_the_largest_work_itself_is_taken(monkeypatch):
    monkeypatch.setattr(strikes, 'LARGEST_WORK', 48.0)    # J: what it is
    scene = coasting_scene((0.5, -8.0))
    first, last = spans_until(scene, 1.0)
    assert last.start[5:8].tolist() != scene.initial.vector[5:8].tolist()
    assert type(last.solver) is type(first.solver)
    monkeypatch.setattr(strikes, 'LARGEST_WORK', 47.999)
    assert spans_until(coasting_scene((0.5, -8.0)), 1.0)[-1].solver.events(0.0, 9.0)
