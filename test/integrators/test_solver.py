# SPDX-License-Identifier: Apache-2.0
"""What Stepped does around a march, on made-up ones: its limits, its checks, what it passes on."""

import math
import types

import numpy as np
import pytest
from near import near

from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.integrators import solver
from rigid_body_sim.integrators.marching.points import LOST, PAUSED, REACHED
from rigid_body_sim.integrators.solver import Stepped, _check_control, _latest, _naming
from rigid_body_sim.scene.scene import load_scene, parse_scene

pytestmark = pytest.mark.without_numba

METHOD = types.SimpleNamespace(NAME='dop8')
SPRUNG = ('{scene: s, body: {mass: 1, inertia: [1, 1, 1]}, constraint: {hinge: {axis: [0, 0, 1], '
          'through: [0, 0, 0]}}, effects: [spring: {stiffness: 9}], initial: {}}')
"""A body that a torsion spring holds far from the ends of its angle."""


@pytest.mark.parametrize(('begin', 'rate', 'latest'), [
    (0.0, 2.0, 2.0 ** 51), (3.0, 2.0 ** 50, 7.0), (3.0, 0.0, 1e300)])
def test_a_body_turns_until_its_radians_are_more_than_doubles_count(begin, rate, latest):
    """They are 2^52; of one that does not turn no time is too late that is a double."""
    assert _latest(begin, rate) == near(latest, rel=1e-15)    # 0


@pytest.mark.parametrize('axis', range(3))
@pytest.mark.parametrize(('scene', 'winds', 'carried'), [
    ('free_body', False, False), ('kapitza_pendulum', False, True), (SPRUNG, True, False)])
def test_it_knows_its_start_and_what_a_march_does_not_do(scene, winds, carried, axis):
    """It turns with 2 rad/s, about any axis: 2^51 s of it are what doubles count."""
    found = Stepped(parse_scene(scene) if scene is SPRUNG else load_scene(scene), 'dop8', 1e-9)
    assert (found._may_wind, found._carried, found._may_leave_doubles) == (
        winds, carried, carried)
    vector = found.scene.initial.vector.copy()
    vector[0], vector[5:8] = 3.0, 0.0
    vector[5 + axis] = -2.0
    started = found.start(vector)
    assert (started.begin, started._latest) == (3.0, 3.0 + 2.0 ** 51)
    other = found.at(1e-6, 500, 0.1)
    assert (other.accuracy, other.most, other.wanted) == (1e-6, 500, 0.1)
    assert (other.scene, other.method, other.horizon) == (
        found.scene, found.method, found.horizon)
    assert (found.accuracy, found.most, found.wanted) == (1e-9, None, math.inf)


@pytest.mark.parametrize(('first', 'last', 'error'), [
    (2.0, 2.0, None), (2.0, 6.0, None), (2.5, 6.5, NotConverged), (1.9, 3.0, BadInput),
    (2.0, math.inf, BadInput), (math.nan, 3.0, BadInput), (3.0, math.nan, BadInput)])
def test_times_are_asked_for_from_the_start_to_where_turns_count(first, last, error):
    """It turns with 13 rad/s."""
    vector = np.zeros(14)
    vector[5:8] = 3.0, -4.0, 12.0
    of = types.SimpleNamespace(begin=2.0, _latest=6.0, vector=vector, method=METHOD,
                               scene=types.SimpleNamespace(name='a'))
    if error is None:
        Stepped._within(of, first, last)
        return
    with pytest.raises(error) as found:
        Stepped._within(of, first, last)
    if error is NotConverged:
        assert found.value.time == 6.0
        assert 'turns with 13.0 rad/s; until 6.5 s' in str(found.value)


def test_of_many_times_the_earliest_and_the_latest_are_looked_at():
    seen = []
    of = types.SimpleNamespace(
        _within=lambda *ends: seen.append(ends), _check=lambda rows: None,
        _course=types.SimpleNamespace(states=lambda times, out: seen.append(times.tolist())))
    for times in ([3.0, 1.0, 2.0], []):
        Stepped.states(of, times, np.empty((len(times), 14)))
    assert seen == [(1.0, 3.0), [3.0, 1.0, 2.0]]


@pytest.mark.parametrize(('status', 'step', 'value', 'again'), [
    (REACHED, None, 1.0, False), (REACHED, None, 1e60, False), (REACHED, 0.1, 1e49, False),
    (REACHED, 0.1, 1e51, True), (REACHED, 0.1, -1e51, True), (REACHED, 0.1, math.nan, True),
    (LOST, None, 1.0, True), (PAUSED, 0.1, 1.0, True)])
def test_a_run_is_left_to_a_course_where_one_call_does_not_do(status, step, value, again):
    """So is what steps of one size have made large: its energy may be no double."""
    asked, room = [], object()

    def final(given, start, time, out):
        assert given is room
        out[:] = [start, time, value]
        return status
    of = types.SimpleNamespace(
        _departs=False, _may_wind=False, _carried=False, step=step,
        _run=lambda *them: asked.append(them[:2]),
        _bound=types.SimpleNamespace(runner=lambda of, slow: (final, room)), _slow=0.5)
    out = np.zeros(3)
    Stepped.runner(of)(1.0, 2.0, out)
    assert asked == [(1.0, 2.0)] * again
    assert out[:2].tolist() == [1.0, 2.0]


@pytest.mark.parametrize('what', ['_departs', '_may_wind', '_carried', '_slow', 'none'])
def test_what_is_more_than_a_march_runs_as_a_course(what):
    of = types.SimpleNamespace(_departs=False, _may_wind=False, _carried=False, _run=object(),
                               _bound=types.SimpleNamespace(runner=lambda of, slow: None),
                               _slow=0.5)
    if what != 'none':
        setattr(of, what, math.inf if what == '_slow' else True)
        of._bound = None    # it is not asked
    assert Stepped.runner(of) is of._run


@pytest.mark.parametrize(('step', 'may', 'entry', 'time'), [
    (None, True, math.inf, 4.0), (None, True, 1e300, None), (None, False, math.inf, None),
    (0.1, True, 1e200, 4.0), (0.1, True, 1e40, None), (None, True, -math.inf, 4.0)])
def test_states_that_doubles_do_not_hold_are_told(step, may, entry, time):
    """Of steps of one size the energy counts too: that of 1e200 rad/s is no double."""
    scene = load_scene('free_body')
    of = types.SimpleNamespace(_may_leave_doubles=may, step=step, method=METHOD, scene=scene,
                               _mechanics=solver.parameters(scene))
    rows = np.tile(scene.initial.vector, (3, 1))
    rows[:, 0] = 3.0, 5.0, 4.0
    rows[1:, 6] = entry
    if time is None:
        Stepped._check(of, rows)
        return
    with pytest.raises(NotConverged) as found, np.errstate(all='ignore'):
        Stepped._check(of, rows)
    assert found.value.time == time


@pytest.mark.parametrize(('step', 'wanted', 'departs', 'slack', 'until'), [
    (None, math.inf, False, 1e-8, 7.0), (None, 1e-9, True, 1e-9, 3.5),
    (0.1, 1.0, False, 0.0, 7.0)])
def test_jumps_below_a_hundredth_of_the_accuracy_are_no_matter_to_the_ledger(
        step, wanted, departs, slack, until, monkeypatch):
    """Nor does it sum beyond the time in which dissipation takes energy."""
    given = []

    class Quadrature:
        def __init__(self, actors, states, vector, slack, kinks):
            given.append(slack)

        def until(self, time):
            return time
    monkeypatch.setattr(solver, 'Quadrature', Quadrature)
    course = types.SimpleNamespace(states=None, kinks=None, entries_until=lambda time: 0.5 * time)
    of = types.SimpleNamespace(
        _within=lambda *times: None, _bound=types.SimpleNamespace(KEEPS_ENTRIES=False),
        _ledger=types.SimpleNamespace(actors=types.SimpleNamespace(acts=True)), step=step,
        accuracy=1e-6, wanted=wanted, vector=None, _course=course, _departs=departs,
        _quadrature=None)
    assert [Stepped.entries(of, 7) for _ in range(2)] == [until] * 2
    assert given == [slack]


def test_events_are_those_after_a_time():
    """A watcher of many tells those of a tick again."""
    watcher = types.SimpleNamespace(    # no tick is passed over unless it is given
        events=lambda until, tick: [(1.0, 'a'), (2.0, 'b'), (3.0 + tick, 'c')])
    of = types.SimpleNamespace(_course=types.SimpleNamespace(TELLS_EVENTS=False), _watcher=watcher)
    assert Stepped.events(of, 2.0, 3.0) == [(3.0, 'c')]
    assert Stepped.events(of, 2.0, 3.0, 0.25) == [(3.25, 'c')]


@pytest.mark.parametrize(('kinks', 'until', 'most', 'found'), [
    ([], 5.5, 3, [3.0, 4.0, 5.0]), ([], 5.0, 2, [3.0, 4.0]), ([], 5.5, 2, None),
    ([2.5, 4.0], 4.5, 9, [2.5, 3.0, 4.0])])
def test_steps_end_where_the_next_one_or_a_kink_is(kinks, until, most, found):
    """They are a second long, from 2 s on."""
    course = types.SimpleNamespace(
        TELLS_EVENTS=False, kinks=lambda until: [time for time in kinks if time < until],
        step_at=lambda time: (math.floor(time), math.floor(time) + 1.0))
    of = types.SimpleNamespace(_course=course, begin=2.0)
    assert Stepped.step_ends(of, until, most) == found
    course.step_at = lambda time: (-math.inf, math.inf)    # of a body that rests
    assert Stepped.step_ends(of, until, most) == [time for time in kinks if time < until]
    course.TELLS_EVENTS = True
    assert Stepped.step_ends(of, until, most) == []


def test_what_fails_in_a_body_of_many_names_it():
    with pytest.raises(NotConverged, match=r'^body 7: too far$') as found, _naming(7):
        raise NotConverged('too far', 2.5)
    assert found.value.time == 2.5


def side_by_side(monkeypatch, failed, carried=False):
    """Return what Stepped.many asks of bodies that are solved together, two at a time."""
    asked = []
    batch = types.SimpleNamespace(
        run=lambda starts, out: asked.append(starts[:, 1].tolist()) or failed(starts))
    of = types.SimpleNamespace(
        _may_wind=False, _bound=None, _carried=carried, scene='scene',
        _unclear=lambda starts, rates: [],
        method=types.SimpleNamespace(FAMILY=types.SimpleNamespace(
            LANES=True, batch=lambda bound, of, times: batch)),
        start=lambda vector: types.SimpleNamespace(
            _within=lambda *ends: asked.append((vector[1], *ends))),
        _check=lambda rows: asked.append(rows.shape))
    monkeypatch.setattr(solver, 'lost', lambda method, scene, where: NotConverged('stuck', where))
    monkeypatch.setattr(solver, 'on_all_cores', lambda work, count, least: [
        work(slice(first, first + 2)) for first in range(0, count, 2)])
    starts = np.zeros((4, 14))
    starts[:, 1] = range(4)
    starts[1, 0] = 1.5             # it begins after the first time
    starts[3, 5:8] = np.array([1.0, 2.0, -2.0]) / 3.0 * 2.0 ** 51    # two seconds of it
    return of, starts, asked


@pytest.mark.parametrize(('carried', 'checked'), [(False, []), (True, [(3, 14)] * 2)])
def test_of_many_bodies_those_are_looked_at_whose_times_may_be_out_of_reach(
        carried, checked, monkeypatch):
    of, starts, asked = side_by_side(monkeypatch, lambda starts: (), carried)
    Stepped.many(of, starts, np.array([3.0, 1.0, 2.0]), np.zeros((4, 3, 14)))
    assert asked == [(1.0, 1.0, 3.0), (3.0, 1.0, 3.0), [0.0, 1.0], *checked, [2.0, 3.0], *checked]
    of, starts, asked = side_by_side(monkeypatch, lambda starts: ())
    Stepped.many(of, starts, np.array([1.5, 2.0]), np.zeros((4, 2, 14)))
    assert asked == [[0.0, 1.0], [2.0, 3.0]]


def test_a_body_that_fails_beside_others_is_named_by_its_place_among_all(monkeypatch):
    of, starts, _ = side_by_side(monkeypatch, lambda starts: (1, 2.5) if starts[0, 1] else ())
    with pytest.raises(NotConverged, match=r'^body 3: stuck$') as found:
        Stepped.many(of, starts, np.array([2.0]), np.zeros((4, 1, 14)))
    assert found.value.time == 2.5


BOTH = 'accuracy', 'step'


@pytest.mark.parametrize(('takes', 'accuracy', 'step', 'where'), [
    (BOTH, None, None, 'method'), (BOTH, 1e-15, None, None), (BOTH, 9e-16, None, 'accuracy'),
    (BOTH, math.inf, None, 'accuracy'), (BOTH, math.nan, 0.1, 'accuracy'),
    (BOTH, None, 5e-324, None), (BOTH, None, 0.0, 'step'), (BOTH, 1e-9, -0.1, 'step'),
    (BOTH, None, math.inf, 'step'), (BOTH, None, math.nan, 'step'), (BOTH, 1e-9, 0.1, None),
    (('step',), 1e-9, 0.1, None), (('step',), 1e-9, None, 'step'),
    (('accuracy',), 1e-9, None, None), (('accuracy',), 1e-9, 0.1, 'step')])
def test_a_method_takes_what_controls_it_and_no_number_that_cannot_be(
        takes, accuracy, step, where):
    method = types.SimpleNamespace(NAME='dop8', TAKES=takes)
    if where is None:
        _check_control(method, accuracy, step)
        return
    with pytest.raises(BadInput, match=f'^{where}: '):
        _check_control(method, accuracy, step)
