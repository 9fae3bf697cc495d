# SPDX-License-Identifier: Apache-2.0
"""A course with kinks on made-up marches: how often it looks, where it finds one, what follows."""

import math
import types

import numpy as np
import pytest

from rigid_body_sim.errors import NotConverged
from rigid_body_sim.integrators.marching import switched
from rigid_body_sim.integrators.marching.course import FOR_EVER
from rigid_body_sim.integrators.marching.points import FIXED, ORIGIN, SCALES, STEP, TIME, VALUES
from rigid_body_sim.integrators.marching.switched import (
    KEPT,
    STALLS,
    Resting,
    Switched,
    Within,
)
from rigid_body_sim.scene.state import STATE_SIZE


@pytest.mark.parametrize(('winds', 'rates', 'looks'), [
    (True, ((1.0, -2.0, 0.5), (0.0, 0.0, 0.0)), 7), (True, ((0.0, 0.0, 0.0), (0.0, 0.0, -3.1)), 7),
    (True, ((0.0, 0.0, 3.0), (0.0, 1.0, 0.0)), 6), (True, ((0.0, 0.0, 1.9), (0.0, 0.0, 1.0)), 4),
    (True, ((0.0, 0.0, math.inf), (0.0, 0.0, 1.0)), 4),
    (True, ((0.0, 0.0, 1.0), (0.0, 0.0, math.nan)), 4),
    (False, ((0.0, 0.0, 9.0), (0.0, 0.0, 9.0)), 4)])
def test_a_body_on_a_hinge_that_winds_turns_by_a_radian_at_most_between_two_looks(
        winds, rates, looks):
    """In the 2 s until 5 s, at the rate of the faster end; there are four looks at least."""
    def states(times, out):
        assert times.tolist() == [3.0, 5.0]
        out[:, 5:8] = rates
    course = types.SimpleNamespace(states=states)
    of = types.SimpleNamespace(_winds=winds, _seen=3.0)
    assert Switched._looks(of, course, 5.0) == looks


@pytest.mark.parametrize(('slope', 'begin', 'spacings'), [
    (0.0, -20, [*range(-20, -3), -4]), (4.0, -4, [-5, -5, -5]), (-4.0, -4, [-5, -5]),
    (8.0, -4, [-6, -6]), (1.0, -7, [-7, -6, -5, -5]),
    (1e9, -4, [-20, -20])], ids=['nothing', 'up', 'down', 'steep', 'calm', 'too steep'])
def test_a_body_at_rest_is_looked_at_as_often_as_the_torque_changes(slope, begin, spacings):
    """By a tenth of the grip, 2 N m, at most; by less than a hundredth, and the next is later.

    They are from 2^-20 to 2^-4 s apart; `spacings` are powers of 2. A torque of 4 N m/s changes
    by 0.25 N m in 2^-4 s and by 0.125 in half that; one of 1 N m/s by 0.016 in 2^-6 s. What it
    was before does not count.
    """
    of = types.SimpleNamespace(
        _seen=1.0, _spacing=2.0 ** begin, _pull=lambda out: slope * max(float(out[0]), of._seen),
        _bound=types.SimpleNamespace(equations=types.SimpleNamespace(in_field=True, grip=2.0)))
    stretch = types.SimpleNamespace(vector=np.zeros(STATE_SIZE), end=9.0)
    for spacing in spacings:
        found = Switched._end_at_rest(of, stretch)
        assert found - of._seen == pytest.approx(2.0 ** spacing, abs=1e-15)
        of._seen = found
    of._bound.equations.in_field = False
    assert Switched._end_at_rest(of, stretch) == 9.0


def test_time_goes_on_for_a_body_at_rest_however_late_it_is():
    """At 2^40 s the clock resolves 2^-12 s."""
    of = types.SimpleNamespace(
        _seen=2.0 ** 40, _spacing=2.0 ** -20, _pull=lambda out: 0.0,
        _bound=types.SimpleNamespace(equations=types.SimpleNamespace(in_field=True, grip=2.0)))
    stretch = types.SimpleNamespace(vector=np.zeros(STATE_SIZE), end=math.inf)
    assert Switched._end_at_rest(of, stretch) == 2.0 ** 40 + 2.0 ** -12


def test_what_rests_is_where_it_was_at_any_time():
    vector, out, one = np.arange(14.0), np.zeros((2, 14)), np.zeros(14)
    Resting(vector).states(np.array([5.0, 3.0]), out)
    Resting(vector).state(7.0, one)
    assert [*out[:, 0], one[0]] == [5.0, 3.0, 7.0]
    assert (np.array([*out, one])[:, 1:] == vector[1:]).all()


class Course:
    """A march by steps of 1 s, on which x, at place 8, and omega_z, at 7, are given in time.

    At place 9 is the number of the march.
    """

    def __init__(self, x, omega=lambda time: 1.0, number=0):
        self.x, self.omega, self.number = x, omega, number

    def state(self, time, out):
        out[:], out[0], out[7], out[8] = 0.0, time, self.omega(time), self.x(time)
        out[9], out[13] = self.number, 5.0

    def states(self, times, out):
        for time, row in zip(times, out, strict=True):
            self.state(time, row)

    def step_at(self, time):
        return math.floor(time), math.floor(time) + 1.0

    def head(self, time):
        return np.array([time, 1e-9, 4.0, 5.0])


class Made(Switched):
    """A made-up scene: its switches, and the torque that friction is to bear, are functions."""

    def __init__(self, course, sides, pull=lambda vector: 0.0, horizon=10.0, **equations):
        self._method = types.SimpleNamespace(NAME='made')
        self._scene, self._most = types.SimpleNamespace(name='up'), None
        self._slowest, self._step, self._winds = 1.0 / horizon, None, False
        self._stop = math.inf
        self._made, self._sides_of, self._pull_of = course, sides, pull
        self._bound = types.SimpleNamespace(equations=types.SimpleNamespace(**{
            'breakpoints': (), 'grip': 0.0, 'gripping': (), 'in_field': False} | equations),
            first_head=lambda step: np.array([step, 0.0, *[0.25] * (VALUES - SCALES - 1)]))
        self._stretches, self._begins, self._stalls, self._steps = [], [], 0, 0
        self._courses = {}
        start = np.zeros(STATE_SIZE)
        course.state(0.0, start)
        self._enter(start, None)

    def _sides(self, vector, modes=None):
        return [side(vector) for side in self._sides_of]

    def _pull(self, vector):
        return self._pull_of(vector)

    def _course(self, place):
        if self._stretches[place].rests:
            return Resting(self._stretches[place].vector)
        return Course(self._made.x, self._made.omega, place)


def test_a_new_march_begins_at_each_kink_and_at_each_breakpoint():
    """At the zeros of x - 0.3, x - 2.6 and 3 - x with x = t; a kink is the first double beyond."""
    def made():
        return Made(Course(lambda time: time), [lambda v: v[8] - 0.3, lambda v: v[8] - 2.6,
                                                lambda v: 3.0 - v[8]], breakpoints=(2.0,))
    of = made()
    begins = [math.nextafter(0.3, 1.0), 2.0, math.nextafter(2.6, 3.0), math.nextafter(3.0, 4.0)]
    assert of.kinks(5.0) == begins
    assert of.kinks(2.0) == begins[:1]
    assert of.kinks(begins[2]) == begins[:2]
    assert [(one.modes, one.rests, one.end) for one in of._stretches] == [
        ((-1.0, -1.0, 1.0), False, 2.0), ((1.0, -1.0, 1.0), False, 2.0),
        ((1.0, -1.0, 1.0), False, math.inf), ((1.0, 1.0, 1.0), False, math.inf),
        ((1.0, 1.0, -1.0), False, math.inf)]
    for one, begin in zip(of._stretches[1:], begins, strict=True):
        assert one.begin == one.vector[0] == one.vector[8] == begin
        # the march goes on with its step and scales, of omega at least (1/horizon)^2
        assert one.head.tolist() == [begin, 1.0 / 10.0 * (1.0 / 10.0), 4.0, 5.0]
    times, out = np.array([2.7, 0.1, 2.0, 0.3]), np.empty((4, STATE_SIZE))
    of = made()
    of.states(times, out)
    assert out[:, 0].tolist() == out[:, 8].tolist() == times.tolist()
    assert out[:, 9].tolist() == [3, 0, 2, 0]
    of = made()
    of.state(4.0, out[0])
    assert (out[0, 8], out[0, 9]) == (4.0, 4)
    assert [of._place(time) for time in (0.0, 0.3, begins[0], 1.9, 2.0, 9.0)] == [
        0, 0, 1, 1, 2, 4]


@pytest.mark.parametrize(('pulls', 'grip', 'stretches'), [
    (3.0, 4.0, [(0.0, False, 1.0), (1.5, True, 0.0), (4.0, True, 0.0)]),
    (-3.0, 3.0, [(0.0, False, 1.0), (1.5, True, 0.0), (4.0, True, 0.0)]),
    (0.3, 0.4, [(0.0, False, 1.0), (1.5, True, 0.0), (4.0, True, 0.0)]),
    (-3.0, 2.9, [(0.0, False, 1.0), (1.5, False, -1.0), (4.0, False, -1.0)])])
def test_friction_holds_a_body_on_a_hinge_whose_rate_passes_zero(pulls, grip, stretches):
    """The rate is 1.5 - t, until it rests or goes on the other way."""
    of = Made(Course(lambda time: 0.0, lambda time: 1.5 - time),
              [lambda v: v[7], lambda v: 1.5 - v[0]],
              lambda v: pulls, breakpoints=(4.0,), grip=grip, gripping=(0,))
    of.kinks(6.0)
    assert [(pytest.approx(one.begin, abs=3e-16), one.rests, one.modes[0])
            for one in of._stretches] == stretches
    vector = of._stretches[1].vector
    assert not vector[5:8].any() and not vector[11:14].any()
    assert vector[0] == math.nextafter(1.5, 2.0)
    out = np.empty(STATE_SIZE)
    of.state(3.5, out)
    assert out[0] == 3.5
    assert out[7] == (0.0 if of._stretches[1].rests else -2.0)


@pytest.mark.parametrize('sign', [1.0, -1.0])
def test_a_body_at_rest_breaks_loose_where_the_torque_outgrows_friction(sign):
    """The torque 2 + t N m outgrows 2.75 N m at 0.75 s."""
    of = Made(Course(lambda time: 0.0, lambda time: sign * max(0.0, time - 0.75)),
              [lambda v: v[7], lambda v: 1.0], lambda v: sign * (2.0 + v[0]), grip=2.75,
              gripping=(0,), in_field=True)
    kink, = of.kinks(1.0)
    assert 0.75 < kink < 0.75 + 2.0 ** -51    # measured: an ulp of the torque
    rest, moves = of._stretches
    assert (rest.rests, rest.modes, rest.head) == (True, (0.0, 1.0), None)
    assert (moves.rests, moves.modes) == (False, (sign, 1.0))
    assert moves.head.tolist() == [2.0 ** -7, 0.1 * 0.1, *[0.25] * (VALUES - SCALES - 1)]


@pytest.mark.parametrize(('drives', 'mode'), [
    ((1.0, 1.0), 1.0), ((-1.0, -1.0), -1.0), ((1.0, -1.0), 1.0), ((-1.0, 1.0), 0.0),
    ((0.0, 0.0), 0.0)])
def test_a_switch_that_begins_on_its_kink_goes_where_the_march_drives_it(
        drives, mode, monkeypatch):
    """Each side is tried, the upper one first, for 2^-10 of its first step; 0 where it stays."""
    tried = []

    class Trial(Course):
        def __init__(self, start, bound, modes, head):
            drive = drives[0] if modes[1] > 0.0 else drives[1]
            super().__init__(lambda time: drive * (time - 3.0))
            tried.append((start.begin, modes, head))

        def step_at(self, time):
            return time, time + 1.0

        def state(self, time, out):
            assert time == 3.0 + 2.0 ** -10
            super().state(time, out)
    monkeypatch.setattr(switched, 'Within', Trial)
    of = Made(Course(lambda time: 7.0), [lambda v: -1.0, lambda v: v[8], lambda v: 1.0])
    vector = np.zeros(STATE_SIZE)
    vector[0] = 3.0
    of._enter(vector, 'head')
    assert of._stretches[-1].modes == (-1.0, mode, 1.0)
    both = [(3.0, [-1.0, 1.0, 1.0], 'head'), (3.0, [-1.0, -1.0, 1.0], 'head')]
    assert tried == both[:1 if mode > 0.0 else 2]


@pytest.mark.parametrize(('modes', 'sides', 'left'), [
    ((1.0, -1.0, 0.0), (0.5, -0.5, 0.0), []), ((1.0, -1.0, 0.0), (-0.5, 0.5, 0.1), [0, 1, 2]),
    ((1.0, -1.0, 0.0), (0.0, 0.0, -0.1), [2])])
def test_a_switch_has_left_its_side_where_its_sign_is_the_other_one(modes, sides, left):
    """A zero is on both sides, and one that stays on its kink leaves it either way."""
    of = types.SimpleNamespace(_sides=lambda out, given: sides if given == modes else None)
    of._margins = types.MethodType(Switched._margins, of)
    stretch = types.SimpleNamespace(rests=False, modes=modes)
    course = Course(lambda time: 0.0)
    assert Switched._changed(of, course, stretch, 1.0, np.empty(STATE_SIZE)) == left


class Driven(Made):
    """A march whose x is driven back at 1 m/s from either side of 0, where its switch is."""

    def _course(self, place):
        stretch = self._stretches[place]
        return Course(lambda time: stretch.vector[8] - stretch.modes[0] * (time - stretch.begin))


def test_marches_that_end_where_they_begin_are_said_to_slide_along_a_kink():
    """From 0.25 m on it is at the kink after 0.25 s; so many more marches are tried."""
    of = Driven(Course(lambda time: 0.25), [lambda v: v[8]])
    with pytest.raises(NotConverged, match=r'made on up: at t = 0\.25\d* s the body slides along'):
        of.kinks(1.0)
    assert [one.modes[0] for one in of._stretches] == [1.0, *[-1.0, 1.0] * STALLS][:STALLS + 2]
    # those before do not count if one has gone on since
    of = Driven(Course(lambda time: 0.25), [lambda v: v[8]])
    of._stalls = STALLS
    of._look_on()
    assert of._stalls == 0


@pytest.mark.parametrize(('following', 'end'), [(3.5, 3.5), (2.0, 1.0 + 8.0 * 0.25)])
def test_the_end_of_a_step_is_that_of_its_point_or_of_a_fixed_step(following, end):
    """The 7th point, at 2 s, of steps of 0.25 s from 1 s on, where none follows yet."""
    parts = control, point, after = np.zeros(4), np.zeros(VALUES), np.zeros(VALUES)
    control[FIXED], control[ORIGIN], point[STEP], point[TIME], after[TIME] = (
        0.25, 1.0, 7.0, 2.0, following)
    asked = []
    of = types.SimpleNamespace(_pieces=['piece'], state=lambda time, out: asked.append(time),
                               _bound=types.SimpleNamespace(parts_of=lambda piece: parts))
    of._ends = FOR_EVER
    assert Within.step_at(of, 2.2) == (2.0, end)
    point[STEP:] = 7.0, 1.0, 2.0, 3.0
    head = Within.head(of, 2.1)
    assert head.tolist() == [7.0, 1.0, 2.0, 3.0]
    assert not np.shares_memory(head, point)
    assert asked == [2.2, 2.1]


def test_few_marches_stay_in_memory(monkeypatch):
    monkeypatch.setattr(switched, 'Within', lambda start, bound, modes, head: (start, modes, head))
    stretches = [switched.Stretch(float(n), math.inf, n, (n,), n == 1, -n)
                 for n in range(KEPT + 2)]
    of = types.SimpleNamespace(_courses={}, _stretches=stretches, _bound=None,
                               _start=lambda begin, vector: (begin, vector))
    for n in [*range(KEPT), 0, 3]:
        course = Switched._course(of, n)
        assert isinstance(course, Resting) if n == 1 else course == ((float(n), n), (n,), -n)
    assert [*of._courses] == [*range(KEPT)]
    Switched._course(of, KEPT)
    assert [*of._courses] == [*range(1, KEPT + 1)]


@pytest.mark.parametrize(('step', 'head', 'given'), [
    (None, 'head', ['head']), (None, None, []), (0.1, 'head', [])])
def test_a_march_between_kinks_is_given_its_sides_and_begins_as_the_one_before(step, head, given):
    """It has the sides in its parameters; fixed steps take no step from the march before."""
    filled, heads, prototype = [], [], np.arange(5.0)
    bound = types.SimpleNamespace(
        equations=types.SimpleNamespace(breakpoints=(), modes=[1, 3]), piece_size=7,
        prototype=lambda time: prototype, set_head=lambda piece, head: heads.append(head),
        track=types.SimpleNamespace(
            first_piece=lambda *what: filled.append([one.tolist() for one in what[:2]])))
    start = switched.Start(None, None, None, step, 2.0, np.ones(3), math.inf)
    Within(start, bound, (-1.0, 0.0), head)
    assert filled == [[[0.0, -1.0, 2.0, 0.0, 4.0], [1.0, 1.0, 1.0]]]
    assert prototype.tolist() == [0.0, 1.0, 2.0, 3.0, 4.0]    # others share it
    assert heads == given


@pytest.mark.parametrize('place', [0.25, 1.0, 1.75])
def test_a_switch_is_looked_at_each_quarter_of_a_step_and_at_its_end(place):
    """It is below zero within 0.1 s of a look, and above it at the ones before and after."""
    of = Made(Course(lambda time: time), [lambda v: abs(v[8] - place) - 0.1])
    assert of.kinks(3.0) == [pytest.approx(place - 0.1, abs=4e-16),
                             pytest.approx(place + 0.1, abs=4e-16)]


@pytest.mark.parametrize('wide', [1e-2, 1e-5, 1e-8])
@pytest.mark.parametrize('place', [0.12, 0.62, 1.9, 2.26])
def test_a_switch_that_is_back_at_the_next_look_is_seen(place, wide):
    """It is below zero for a while between two looks. A double at the place has 2e-16."""
    of = Made(Course(lambda time: time), [
        lambda v: (v[8] - place - wide) * (v[8] - place + wide) * (1.0 + v[8])])
    assert of.kinks(3.0) == [pytest.approx(place - wide, abs=1e-15),
                             pytest.approx(place + wide, abs=1e-15)]


@pytest.mark.parametrize('place', [0.12, 0.62, 1.9, 2.26])
def test_a_switch_that_all_but_reaches_zero_between_two_looks_stays(place):
    of = Made(Course(lambda time: time), [lambda v: (v[8] - place) ** 2 + 1e-15])
    assert of.kinks(3.0) == []


@pytest.mark.parametrize('over', [1e-3, 1e-6, 1e-9])
def test_a_torque_that_outgrows_friction_between_two_looks_sets_a_body_free(over):
    """Looks at rest are 1/64 s apart at most; the torque is beyond for 4 sqrt(over) s."""
    of = Made(Course(lambda time: 0.0, lambda time: 0.0), [lambda v: v[7]],
              lambda v: 1.0 + over - 0.25 * (v[0] - 2.0203) ** 2, grip=1.0,
              gripping=(0,), in_field=True)
    assert of.kinks(3.0)[0] == pytest.approx(2.0203 - 2.0 * math.sqrt(over), abs=1e-9)


@pytest.mark.parametrize(('hinge', 'winds'), [
    (None, False), (types.SimpleNamespace(winds=True), True),
    (types.SimpleNamespace(winds=False), False)])
def test_a_course_with_kinks_begins_with_a_march_of_its_own(hinge, winds, monkeypatch):
    """It is given the sides of the switches at its start, in the parameters that hold then."""
    held, given = [], []

    def sides(p, vector, out):
        given.append(p.tolist())
        out[:] = 0.5, -0.5

    def equal(time):
        held.append(time)
        return np.zeros(4)
    monkeypatch.setattr(switched, 'specialise', lambda template, switching, COUNT: (
        types.SimpleNamespace(sides=sides) if (switching, COUNT) == ('source', 'COUNT = 2\n')
        else None))
    equations = types.SimpleNamespace(
        modes=[1, 3], switching_source=lambda: 'source', frame=types.SimpleNamespace(hinge=hinge),
        breakpoints=(1.0, 2.0, 9.0), grip=0.0, gripping=(), held=equal)
    start = np.zeros(STATE_SIZE)
    start[0] = 2.0
    of = Switched(types.SimpleNamespace(
        method=None, scene=None, most=None, step=None, horizon=4.0, vector=start,
        stop=math.inf),
        types.SimpleNamespace(equations=equations))
    assert (of._slowest, of._winds, of._stalls, of._steps) == (0.25, winds, 0, 0)
    stretch, = of._stretches
    assert (stretch.begin, stretch.end, stretch.modes) == (2.0, 9.0, (1.0, -1.0))
    assert stretch.vector is not start and not of.TELLS_EVENTS
    assert of._sides(start, (7.0, 8.0)) == [0.5, -0.5]
    assert given == [[0.0] * 4, [0.0, 7.0, 0.0, 8.0]]
    assert held == [2.0, 2.0]


def test_the_torque_that_friction_is_to_bear_is_the_moment_times_the_angular_acceleration():
    """The parameters hold 1/I."""
    p = np.zeros(switched.INVERSE + 1)
    p[switched.INVERSE] = 0.25
    equations = types.SimpleNamespace(
        start=lambda vector: (p, vector),
        kernels=types.SimpleNamespace(rate=lambda p, y: ('angle', 3.0 * y, 'more', 'more')))
    of = types.SimpleNamespace(_bound=types.SimpleNamespace(equations=equations))
    assert Switched._pull(of, 2.0) == 24.0
