# SPDX-License-Identifier: Apache-2.0
"""The exact solver beside a motion that is easily counted: its events, and what it asks for."""

import math
import types

import numpy as np
import pytest

from rigid_body_sim.choice.choose import choose
from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.errors import BadInput
from rigid_body_sim.motions import driven_body, fixed_axis, loops, solver
from rigid_body_sim.motions.free_body import free_body
from rigid_body_sim.motions.pendulum import pendulum
from rigid_body_sim.motions.solver import CROWD, NONE_YET, Exact
from rigid_body_sim.scene.scene import load_scene


def counting(times):
    """Return an Exact whose motion has events at these times, of two names in turn."""
    asked = []

    def next_event(anchor, after):
        asked.append(after)
        later = [(time, k % 2) for k, time in enumerate(times) if time > after]
        return later[0] if later else (math.inf, 0)
    one = object.__new__(Exact)
    one.motion = types.SimpleNamespace(next_event=next_event, EVENTS=('even', 'odd'))
    one._asked = types.SimpleNamespace(tells=True)
    one.anchor, one._next_event, one._last_events = None, None, NONE_YET
    return one, asked


def test_an_event_on_a_tick_belongs_to_the_tick_that_it_ends():
    one, _ = counting([1.0, 2.0, 2.5])
    assert one.events(0.0, math.nextafter(1.0, 0.0)) == []
    assert one.events(0.5, 1.0) == [(1.0, 'even', {})]
    assert one.events(1.0, 2.0) == [(2.0, 'odd', {})]
    assert one.events(2.0, 9.0) == [(2.5, 'even', {})]
    assert one.events(9.0, 99.0) == []


def test_more_events_than_a_crowd_within_a_tick_are_passed_over():
    one, _ = counting(np.linspace(0.1, 10.0, 100).tolist())
    found = [time for time, _, _ in one.events(0.0, 10.0, 1.0)]
    for time in found:
        assert sum(time <= other < time + 1.0 - 1e-9 for other in found) <= CROWD
    assert found[:CROWD + 1] == pytest.approx([0.1, 0.2, 0.3, 0.4, 1.2])
    every, _ = counting(np.linspace(0.1, 10.0, 100).tolist())
    assert len(every.events(0.0, 10.0)) == 100


@pytest.mark.parametrize('name', ['kater_pendulum', 'tennis_racket', 'heavy_top'])
def test_a_tick_that_ends_on_an_event_of_a_scene_tells_it_and_the_next_tick_does_not(name):
    scene = load_scene(name)

    def started():
        return choose(scene, 'exact').solver(scene.initial.vector, None)
    time, told, _ = started().events(0.0, 20.0)[0]
    again = started()
    assert again.events(0.0, math.nextafter(time, 0.0)) == []
    assert again.events(math.nextafter(time, 0.0), time) == [(time, told, {})]
    assert [event[0] for event in again.events(time, time + 1e-9)] == []


def test_states_at_once_are_those_one_by_one_in_pieces_too(monkeypatch):
    scene = load_scene('tennis_racket')
    one = choose(scene, 'exact').solver(scene.initial.vector, None)
    times = np.linspace(3.0, 0.0, 23)
    alone, at_once, pieces = (np.empty((23, 14)) for _ in range(3))
    for time, row in zip(times, alone, strict=True):
        one.state(time, row)
    one.states(times, at_once)
    monkeypatch.setattr(solver, 'AT_ONCE', 5)
    one.states(times, pieces)
    assert (alone == at_once).all()
    assert (alone == pieces).all()
    together = np.empty((2, 23, 14))
    one.many(np.array([scene.initial.vector] * 2), times, together)
    assert (together == alone).all()


def test_a_time_before_the_start_at_which_drag_makes_it_infinite_is_refused():
    scene = load_scene('free_body', ['effects=[drag: {linear: 1.0, angular: 0.0}]',
                                     'initial.velocity=[1, 0, 0]'])
    one, out = choose(scene, 'exact').solver(scene.initial.vector, None), np.empty((2, 14))
    one.states(np.array([-0.1, 0.0]), out)
    assert np.isfinite(out).all()
    with pytest.raises(BadInput, match='before the start'):
        one.states(np.array([0.0, -1e6]), out)
    starts, together = np.array([scene.initial.vector] * 2), np.empty((2, 2, 14))
    starts[1, 0] = 1e6    # it begins later
    one.states(np.array([-0.1, 0.0]), out)
    one.many(starts[:1], np.array([-0.1, 0.0]), together[:1])
    assert (together[0] == out).all()
    for bodies, times in ((2, [0.0, 1.0]), (1, [1.0, -1e6])):
        with pytest.raises(BadInput, match=f'at {min(times)!r} s, before the start'):
            one.many(starts[:bodies], np.array(times), together[:bodies])


def test_entries_are_those_of_the_motion_or_else_integrated_where_anything_acts(monkeypatch):
    """The integral is begun once, and goes on."""
    made = []

    def quadrature(actors, states, start, error):
        made.append((actors, start, error))
        return types.SimpleNamespace(until=lambda time: [time, 2.0, 3.0, 4.0, 5.0])

    def entries(anchor, time, out):
        out[:2] = anchor, time
    monkeypatch.setattr(solver, 'Quadrature', quadrature)
    one = object.__new__(Exact)
    one.motion, one.anchor = types.SimpleNamespace(entries=entries), 7.0
    assert one.entries(1.5).tolist() == [7.0, 1.5, 0.0, 0.0, 0.0]
    one.motion, one._quadrature, one._start = types.SimpleNamespace(entries=None), None, 'start'
    actors = types.SimpleNamespace(acts=False)
    one._asked = types.SimpleNamespace(actors=actors)
    assert one.entries(1.5).tolist() == [0.0] * 5
    actors.acts = True
    assert one.entries(1.5).tolist() == [1.5, 2.0, 3.0, 4.0, 5.0]
    assert one.entries(2.5).tolist() == [2.5, 2.0, 3.0, 4.0, 5.0]
    assert made == [(actors, 'start', 0.0)]


def test_an_event_found_on_the_states_is_told_once():
    """The one at the end of a tick belongs to that tick."""
    one, _ = counting([])
    one._asked.tells, found = False, [(1.0, 'a', {}), (1.5, 'b', {}), (2.0, 'c', {})]
    one._watcher = types.SimpleNamespace(events=lambda until, tick: found)
    assert one.events(1.0, 2.0) == found[1:]
    assert one.events(0.5, 2.0) == found


@pytest.mark.parametrize('motion', [driven_body, fixed_axis, free_body, pendulum])
def test_many_states_are_side_by_side_where_the_motion_has_a_kernel_for_it(motion):
    bound = solver.loops(motion)
    assert (bound.states is bound.one_by_one) == (motion.fill_columns is None)


@pytest.mark.without_numba
@pytest.mark.parametrize('parameters', [[5.0], [5.0, 6.0, 7.0]])
def test_each_of_many_bodies_has_its_own_parameters_or_those_of_all(parameters):
    """A made motion tells the time, the parameter and the start of the body."""
    made = specialise(
        loops, ANCHOR_SIZE='ANCHOR_SIZE = 2\n', **loops.ONE_BY_ONE,
        anchor='def anchor(parameters, start, out):\n    out[:] = parameters[0], start[0]\n',
        state='def state(anchored, time, out):\n    out[:3] = time, *anchored\n')
    starts, out = np.zeros((3, 14)), np.empty((3, 2, 14))
    starts[:, 0] = 1.0, 2.0, 3.0
    made.ensemble(np.array(parameters)[:, None], starts, np.array([8.0, 9.0]), out)
    assert out[:, :, :3].tolist() == [
        [[time, parameter, start] for time in (8.0, 9.0)]
        for parameter, start in zip(parameters * (3 // len(parameters)), (1.0, 2.0, 3.0),
                                    strict=True)]


@pytest.mark.parametrize('times', [(), (1.0,)])
def test_no_bodies_and_no_times_have_no_states(times):
    scene = load_scene('tennis_racket')
    one = choose(scene, 'exact').solver(scene.initial.vector, None)
    one.states(np.array(times), np.empty((len(times), 14)))
    for bodies in (0, 2):
        one.many(np.array([scene.initial.vector] * bodies).reshape(-1, 14), np.array(times),
                 np.empty((bodies, len(times), 14)))
