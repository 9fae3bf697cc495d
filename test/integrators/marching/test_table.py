# SPDX-License-Identifier: Apache-2.0
"""The phases of a pushed ball on made-up kernels, whose motion is known, and what follows them.

A slip of the made-up ball goes by s, with dt = u ds and u = e^-s: u falls by 1 m/s in a second.
In the other phases its place is the square of the time.
"""

import math
import types

import numpy as np
import pytest
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.errors import NotConverged
from rigid_body_sim.integrators.equations.table_rates import (
    CREEPING,
    GLIDING,
    MODE,
    PLACE,
    PUSHED,
    ROLLING,
    SLIDING,
    SPIN,
    UNKNOWNS,
    P,
    Pushed,
    Q,
    U,
)
from rigid_body_sim.integrators.marching import table
from rigid_body_sim.integrators.marching.table import (
    CLOCK,
    CREEP,
    DEAD,
    TRIALS,
    Point,
    TableCourse,
)
from rigid_body_sim.mechanics.ledger import ENTRIES_SIZE
from rigid_body_sim.motions.sliding_sphere import Parameters
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import parse_scene

pytestmark = pytest.mark.without_numba

a, k = 0.5, 0.4
NONE, PUSH = (0.0, 0.0, 0.0), (3.0, 4.0, 0.0)    # the latter drives by G = 2.5 m/s^2
ORDER, TOLERANCE = 8, 2.0 ** -40


def parameters(mode, push=PUSH, mu=0.2, g=10.0):
    """Return the parameters of a ball of 2 kg: friction stops a slip by c = 7 m/s^2."""
    return PUSHED.array(Pushed(Parameters(a, k, 2.0, mu, g), float(mode), push, *[NONE] * 3))


def unknowns(u=(0.0, 0.0), p=(0.0, 0.0), spin=0.0, time=0.0):
    y = [0.0] * (UNKNOWNS + ENTRIES_SIZE)
    y[3], y[U:P], y[P:SPIN], y[SPIN], y[CLOCK] = 1.0, u, p, spin, time
    return tuple(y)


class Kernels:
    """The motion of the made-up ball; a step errs by its size to the ninth power."""

    def rate(self, p, y):
        return 'rate'

    def step(self, p, y, lost, first, h):
        assert first == 'rate'
        after = list(y)
        if p[MODE] == SLIDING:
            after[U] *= math.exp(-h)
            after[CLOCK] += y[U] - after[U]
        else:
            after[CLOCK] += h
            after[PLACE] = after[CLOCK] ** 2
        return tuple(after), lost

    def trial(self, p, weights, y, lost, first, h, scales):
        return *self.step(p, y, lost, first, h), scales, h ** 9


def bound(p, turns=False):
    return types.SimpleNamespace(
        order=ORDER, weights=None, kernels=Kernels(), parameters=p, turns_with_body=turns)


def phase(mode, y=None, **what):
    p = parameters(mode, **what)
    return table._Phase(bound(p), p, y or unknowns(), TOLERANCE, 100.0)


@pytest.mark.parametrize(('mode', 'what', 'y', 'h'), [
    (SLIDING, {}, unknowns((0.3, 0.4), (0.3, 0.4), 6.0), 2.0 ** -5 / (7.0 + 2.5 + 0.5 * 6.0)),
    (ROLLING, {}, unknowns(spin=6.0), 2.0 ** -5 / (7.0 + 2.5 + 6.0)),
    (GLIDING, {'mu': 0.0}, unknowns(p=(0.7, 0.0)), 2.0 ** -5 / (2.5 + 1.0)),
    (GLIDING, {'mu': 0.0, 'push': NONE}, unknowns(), 2.0 ** -5),
    (CREEPING, {}, unknowns(spin=8.0), CREEP / 8.0), (CREEPING, {}, unknowns(spin=0.5), CREEP)])
def test_the_first_step_is_what_drive_friction_and_turn_allow(mode, what, y, h):
    """The eighth root of what is allowed, 2^-5; of a slip the turn goes with its speed."""
    made = phase(mode, y, **what)
    assert made._front.planned == near(h, rel=1e-14)
    assert (made.mode, made.begin, made.last, made.reached) == (mode, 0.0, None, 0.0)
    assert made._kept == [made._front]


def test_a_step_is_tried_until_its_error_is_what_is_allowed():
    """2^8 times as much halves it, and leaves nine tenths of that; infinite or nan leave a tenth.

    So does what asks for less than that; what hardly errs grows by 4.
    """
    tried, q = [], np.array([0.1, -0.5, 0.7, 0.5])
    errors = iter((math.inf, math.nan, 2.0 ** 8, 1e30, 2.0 ** -8, 0.0))

    def trial(p, weights, y, lost, first, h, scales):
        tried.append(h)
        after = [*(q * (1.0 + 2.0 ** -30)), *y[U:]]
        after[CLOCK] += h
        return tuple(after), (2.0 ** -60,) * len(y), 'scales', next(errors) * (1e-9 * h + 1e-17)
    of = types.SimpleNamespace(
        _bound=types.SimpleNamespace(kernels=types.SimpleNamespace(rate=Kernels().rate,
                                                                   trial=trial),
                                     weights=None, order=ORDER),
        _p=None, _tolerance=1e-9, _origin=100.0)
    start = Point(unknowns(time=3.0), (0.0,) * len(unknowns()), None, 1.0, 0.0)
    found = table._Phase._next(of, start)
    assert tried == [near(h, rel=1e-12) for h in (1.0, 0.1, 0.01, 0.0045, 0.00045)]
    assert found.last == tried[-1]
    assert found.planned == near(1.8 * tried[-1], rel=1e-12)
    assert found.scales == 'scales'
    assert found.y[CLOCK] == 3.0 + tried[-1]
    assert np.array(found.y[:U]) == near(q, rel=4e-16)    # it has the norm 1
    assert found.lost[U:] == (2.0 ** -60,) * (len(start.y) - U)
    assert max(map(abs, found.lost[:U])) < 2.0 ** -52
    assert table._Phase._next(of, start).planned == 4.0


def test_a_phase_in_which_no_step_is_small_enough_is_said_to_be():
    made = phase(ROLLING, unknowns(time=3.0))
    tried = []

    def trial(p, weights, y, *rest):
        tried.append(rest)
        return y, rest[0], None, math.inf
    made._bound.kernels.trial = trial
    with pytest.raises(NotConverged, match=r'no step is small enough at t = 103\.0 s'):
        made.go_on()
    assert len(tried) == TRIALS


@pytest.mark.parametrize('mode', [SLIDING, ROLLING])
def test_few_points_are_kept_and_give_the_states_at_any_time(mode, monkeypatch):
    monkeypatch.setattr(table, 'KEPT', 4)
    made = phase(mode, unknowns((1.0, 0.0)))
    last = 0.999 if mode == SLIDING else 3.0
    steps = [made._front]
    while not made.passes(last):
        made.go_on()
        steps.append(made._front)
    assert made._count == len(steps) - 1 > 16
    assert made._stride >= 8
    assert made._kept == steps[::made._stride] and 2 <= len(made._kept) < 4
    assert made.reached == steps[-1].y[CLOCK] > last
    for time in (*np.linspace(0.0, last, 11), *(one.y[CLOCK] for one in steps[:4])):
        y = made.at(time)
        assert y[CLOCK] == near(time, rel=4e-16)
        if mode == SLIDING:
            assert y[U] == near(1.0 - time, rel=1e-12)    # 2e-13, near the end
        else:
            assert y[PLACE] == near(time * time, rel=4e-16)


def test_a_phase_passes_a_time_until_it_ends_there():
    made = phase(ROLLING, unknowns(time=2.0))
    assert [made.passes(time) for time in (1.9, 2.0)] == [True, False]
    made.last = unknowns(time=1.5)
    assert [made.passes(time) for time in (1.4, 1.5)] == [True, False]


V = 32.0
SPEED = 2.0 * V    # m/s, of the centre and of the lowest point about it
ALMOST = 0.9 * DEAD


@pytest.mark.parametrize(('before', 'after', 'v', 'dead'), [
    (1.0, ALMOST * SPEED, V, True), (1.0, 1.2 * ALMOST * SPEED, V, False),
    (0.5 * ALMOST * SPEED, ALMOST * SPEED, V, False),           # it grows
    (1.0, ALMOST * 7.0 * 3.0, 0.0, True), (1.0, 1.2 * ALMOST * 7.0 * 3.0, 0.0, False)])
def test_a_slip_is_dead_beside_the_speeds_or_what_friction_has_taken(before, after, v, dead):
    """The ball has slid since 2 s, for 3 s, and c = 7 m/s^2."""
    made = phase(SLIDING, unknowns((1.0, 0.0), time=2.0))
    ends = [Point(unknowns((0.0, slip), (1.4 * v, 0.0), time=time), None, None, 1.0, 0.5)
            for slip, time in ((before, 4.0), (after, 5.0))]
    found = made._end(*ends)
    assert found == (unknowns((0.0, 0.0), (1.4 * v, 0.0), time=5.0) if dead else None)


def test_a_creep_ends_with_its_slip_and_a_glide_never():
    ends = [Point(unknowns((0.0, slip)), None, None, 1.0, 0.5) for slip in (0.0, 1e-9)]
    assert phase(CREEPING)._end(ends[0], ends[1]) == ends[1].y
    assert phase(CREEPING)._end(ends[1], ends[0]) is None
    assert phase(GLIDING)._end(ends[0], ends[1]) is None
    assert phase(ROLLING, push=(99.0, 0.0, 0.0))._end(ends[0], ends[0]) is None    # as it was


@pytest.mark.parametrize(('force', 'ends'), [(13.9, False), (14.0, False), (14.1, True)])
def test_a_rolling_ends_where_a_push_that_turns_with_the_ball_outgrows_the_grip(force, ends):
    """G = F/M is c = 7 m/s^2 at 14 N; the part of the step is found to round-off."""
    p = parameters(ROLLING, push=NONE)

    class Growing(Kernels):
        def step(self, p, y, lost, first, h):
            after = list(Kernels.step(self, p, y, lost, first, h)[0])
            after[PLACE] = 13.0 + (force - 13.0) * after[CLOCK]
            return tuple(after), lost
    made = table._Phase(bound(p, turns=True), p, unknowns(), TOLERANCE, 0.0)
    made._bound.kernels = Growing()

    def grips(y):
        p[PUSHED.part('world_force').first] = y[PLACE]
        return table._Phase._grips(types.SimpleNamespace(_p=p), y)
    made._grips = grips
    begin = Point(unknowns(), (0.0,) * len(unknowns()), None, 1.0, 0.0)
    following = begin._replace(y=made._part(begin, 1.0), last=1.0)
    found = made._end(begin, following)
    if ends:
        assert found[CLOCK] == near(1.0 / 1.1, rel=1e-14)    # the rounding of 13 N
        assert found[PLACE] > 14.0
    else:
        assert found is None


@pytest.mark.parametrize(('what', 'u', 'mode'), [
    ({}, (0.0, 0.0), ROLLING), ({}, (0.0, 1e-30), SLIDING), ({}, (-1.0, 0.0), SLIDING),
    ({'mu': 0.0}, (1.0, 0.0), GLIDING), ({'g': 0.0}, (1.0, 0.0), GLIDING),
    ({'push': (14.0, 0.0, 0.0)}, (0.0, 0.0), ROLLING),
    ({'push': (0.0, -14.1, 0.0)}, (0.0, 0.0), CREEPING)])
def test_the_phase_that_begins_is_that_of_slip_friction_and_drive(what, u, mode):
    """Friction holds a drive of 7 m/s^2, that of 14 N."""
    p = parameters(7, **what)
    of = types.SimpleNamespace(_bound=bound(p), _tolerance=TOLERANCE, _begin=2.0)
    made = TableCourse._phase_from(of, unknowns(u))
    assert (made.mode, made._p[MODE], made._origin) == (mode, mode, 2.0)
    assert p[MODE] == 7    # others share these


def course(vector, **what):
    stepped = types.SimpleNamespace(
        vector=vector, method=types.SimpleNamespace(NAME='made'), most=None, accuracy=2e-9,
        scene=types.SimpleNamespace(name='ball'), horizon=4.0)
    return TableCourse(stepped, bound(parameters(0, **what)))


@pytest.mark.parametrize('slip', [1.0, 2.0 ** -30, 0.9 * 2.0 ** -49 * 5.0, 1.1 * 2.0 ** -49 * 5.0])
def test_a_course_begins_with_the_slip_and_what_friction_does_not_change(slip):
    """With e = a omega x z the slip is u = v - e and p = v + k e; rounding is no slip.

    |v| + a |omega| = 2 + 3 m/s.
    """
    turn = Rotation.random(random_state=8)
    omega = np.array([0.0, 4.0, math.sqrt(20.0)])
    v, vector = np.array([2.0, slip, 0.0]), np.zeros(14)
    vector[0], vector[1:5], vector[8:11] = 7.0, turn.as_quat(), (1.0, 2.0, a)
    vector[5:8], vector[11:14] = turn.inv().apply(omega), v
    made = course(vector)
    y, e = made._phases[0]._front.y, a * np.cross(omega, [0.0, 0.0, 1.0])
    still = slip < 2.0 ** -40 and slip < 2.0 ** -49 * 5.0
    u, p = (v - e)[:2], (v + k * e)[:2]
    assert y[Q:U] == pytest.approx(turn.as_quat(), abs=4e-16)
    # measured: 9e-16, the rounding of omega in body axes
    assert y[U:P] == pytest.approx([0.0, 0.0] if still else u, abs=2e-15)
    assert any(y[U:P]) is not still
    assert y[P:SPIN] == pytest.approx(1.4 * v[:2] if still else p, abs=2e-15)
    assert y[SPIN] == near(omega[2], rel=1e-15)
    assert y[PLACE:] == (0.0,) * (len(y) - PLACE)
    assert (made._tolerance, made._begin) == (5e-10, 7.0)
    assert made.TELLS_EVENTS and table.OnTable.KEEPS_ENTRIES
    out = np.empty(14)
    made._write(9.0, (*y[:PLACE], 0.25, -0.5, *y[CLOCK:]), out)
    vector[0], vector[8:10] = 9.0, (1.25, 1.5)
    assert out == pytest.approx(vector, abs=4e-14)    # 1.6e-14: a slip that counts as none


def test_a_course_goes_from_phase_to_phase_and_tells_where_sliding_begins_and_ends():
    """Its phases end at 1, 2 and 3 s after its start at 2 s."""
    made, begun = object.__new__(TableCourse), []

    class Made:
        def __init__(self, begin):
            self.begin, self.mode, self.last, self.reached = (
                begin, (SLIDING, ROLLING, CREEPING, SLIDING)[int(begin)], None, begin)

        def passes(self, elapsed):
            return (self.reached if self.last is None else self.last) > elapsed

        def go_on(self):
            self.reached += 0.6
            self.last = self.begin + 1.0 if self.reached > self.begin + 1.0 else None

        def at(self, elapsed):
            return (self.begin, elapsed, *range(2, UNKNOWNS + ENTRIES_SIZE))

    def following(last):
        begun.append(last)
        return Made(last)
    made._begin, made._name, made._most, made._phases = 2.0, 'made on ball', None, [Made(0.0)]
    made._phase_from = following
    assert made._at(0.5)[:2] == (0.0, 0.5)
    assert begun == []
    assert made.events(2.0, 4.0) == [(3.0, 'rolling began', {}), (4.0, 'sliding began', {})]
    assert made.events(3.0, 3.9) == []
    assert made.events(2.9, 3.0) == [(3.0, 'rolling began', {})]
    assert made.events(4.0, 5.5) == []    # no event says that a creep has become a slip
    assert begun == [1.0, 2.0, 3.0]
    assert [made._at(elapsed)[0] for elapsed in (0.0, 0.99, 1.0, 2.0, 3.3)] == [0, 0, 1, 2, 3]
    assert made.entries(3.5).tolist() == [*range(UNKNOWNS, UNKNOWNS + ENTRIES_SIZE)]
    written = []
    made._write = lambda time, y, out: written.append((time, *y[:2], out))
    made.states(np.array([3.5, 2.25]), ['a', 'b'])
    assert written == [(3.5, 1.0, 1.5, 'a'), (2.25, 0.0, 0.25, 'b')]


@pytest.mark.parametrize(('frame', 'turns'), [('body', True), ('world', False)])
def test_a_wrench_holds_along_its_own_axes(frame, turns, monkeypatch):
    monkeypatch.setattr(table, 'specialise', lambda template, **bindings: sorted(bindings))
    monkeypatch.setattr(table, 'unroll', types.SimpleNamespace(
        step_source=lambda *of: None, trial_source=lambda *of: None,
        weights=lambda of: [1.0, 2.0]))
    scene = parse_scene(
        'scene: ball\nbody: {mass: 2, shape: {solid_sphere: {radius: 0.5}}}\nconstraint: table\n'
        'effects: [sliding_friction: {mu: 0.2, g: 10}]\ninitial: {}\n')
    for wrench in (None, Wrench((1.0, 2.0, 3.0), (4.0, 5.0, 6.0), frame)):
        of = table.OnTable(scene, types.SimpleNamespace(ORDER=8), wrench, None)
        given = PUSHED.load(of.parameters.tolist())
        held = {'world_force': NONE, 'world_couple': NONE, 'body_force': NONE,
                'body_couple': NONE}
        if wrench:
            held |= {f'{frame}_force': (1.0, 2.0, 3.0), f'{frame}_couple': (4.0, 5.0, 6.0)}
        assert {name: getattr(given, name) for name in held} == held
        assert given.sphere == (0.5, near(0.4, rel=1e-15), 2.0, 0.2, 10.0)
        assert of.turns_with_body is (turns and wrench is not None)
        assert (of.order, of.weights.tolist()) == (8, [1.0, 2.0])
