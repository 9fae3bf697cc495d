# SPDX-License-Identifier: Apache-2.0
"""Which phase follows what, for a made-up body on a plane whose laws are given one by one."""

import math
import types

import numpy as np
import pytest
from near import near

from rigid_body_sim.errors import NotConverged
from rigid_body_sim.integrators.equations.contact_views import (
    CREEPING,
    FLIGHT,
    GLIDING,
    PIVOTING,
    RESTING,
    ROLLING,
    ROW,
    SLIDING,
)
from rigid_body_sim.integrators.marching import contact_march
from rigid_body_sim.integrators.marching import contact_succession as module
from rigid_body_sim.integrators.marching.contact_succession import (
    AT_ONCE,
    CANCELS,
    CHATTER,
    CREEP,
    DRY,
    FILM,
    FIRMNESS,
    GAP,
    GRIP,
    HOLDS,
    IDEAL,
    LAG,
    LEVEL,
    LIFTS,
    MASS,
    MODE,
    MOTION,
    MU,
    NARROWEST,
    NARROWS,
    NORMAL,
    OMEGA,
    ONSET,
    ORIGIN,
    PATCH,
    PULLS,
    RIM,
    ROUNDING,
    SIDE,
    SIZE,
    SIZES,
    SLIDES,
    SLIP,
    SLIP_ROUNDS,
    SOON,
    STARTED,
    SWIFT,
    TIME,
    TIMED,
    UNTIL,
    VELOCITY,
    VISCOUS,
    WAY,
    WIDE,
    WIDEST,
    Succession,
    U,
)
from rigid_body_sim.mechanics.contact.parameters import CONTACT, HELD

pytestmark = pytest.mark.without_numba

SPEED, LENGTH, HEAVY, CREEPS, BEGIN = 4.0, 0.5, 8.0, 1e-3, 100.0
STEPS = ('_open', '_land', '_lie', '_give_way', '_creep_off', '_fly', '_rest', '_stop', '_impact',
         '_end', '_topple', '_tell')
"""What a course may do next: a test takes down which of them are done, but for one."""


class Body(Succession):
    """A course whose next steps are taken down, on a body with these numbers in its row of rates.

    A number may be a function of the parameters.
    """

    def __init__(self, monkeypatch, own, row=None, spin=0.0, stays=False, slides_on=False,
                 load=None, rolling=None, **laws):
        self.row = {NORMAL: 2.0, GRIP: 1.0, FIRMNESS: 1.0, MOTION: 1.0} | (row or {})
        self.done = []
        said = {'lies': False, 'lies_level': False, 'lies_low': False, 'comes_down': False,
                'is_held': False, 'rise': 0.0, 'hastens': 0.0, 'spins': spin} | laws
        for name, value in said.items():
            if hasattr(module, name):
                monkeypatch.setattr(module, name, lambda *of, value=value: value)
        for name in ('halt', 'grip_patch', 'lay', 'topple'):
            monkeypatch.setattr(module, name, lambda p, *of, name=name: self.done.append(
                (name, *(one for one in of if isinstance(one, float)))))
        for name in STEPS:
            if name != own:
                setattr(self, name, self.taken_down(name))
        self.rates = types.SimpleNamespace(
            rate=self.rate, stays=lambda p, y: stays, slides_on=lambda p, y: slides_on,
            load_of=lambda p, y: types.SimpleNamespace(**({
                'normal': 2.0, 'tilting': (0.0, 0.0, 0.0), 'spinning': 0.0} | (load or {}))))
        self._bound = types.SimpleNamespace(
            rates=self.rates, is_timed=laws.get('is_timed', False), breakpoints=(101.0, 103.0),
            is_disk=laws.get('is_disk', False), scene=types.SimpleNamespace(name='up'),
            parameters=self.parameters, kernels='usual')
        self._scales = types.SimpleNamespace(
            speed=lambda y: SPEED, rounding=lambda y: 0.01, length=LENGTH, creep=CREEPS,
            heaviness=HEAVY)
        self._rolling = types.SimpleNamespace(
            begin=lambda p, y, *how: self.done.append(('friction', *how)),
            goes_on_tipping=lambda p, y: rolling == 'tips', jams=lambda p, y: rolling == 'jams',
            has_ended=lambda p, y: rolling == 'ended', allowed=(0.0, math.inf))
        self.phases, self.begins, self.events, self.over = [], [], [], None
        self.begin, self._place, self._tolerance = BEGIN, (1.0, 2.0), 1e-9
        self._wide, self.why, self._work = WIDEST, '', 'work'
        self.p, self.y = np.zeros(CONTACT.size), np.zeros(SIZE)
        self.p[MU], self.p[MASS], self.p[SWIFT], self.p[SIZES] = (
            0.5, 3.0, SPEED, (0.25, 0.5, 0.125))
        self.y[3], self.y[TIME] = 1.0, 2.5

    def taken_down(self, name):
        def step(*of, **how):
            self.done.append((name, *(
                int(one) if name == '_open' and k == 0 else one for k, one in enumerate(of)
                if not isinstance(one, np.ndarray)), *([how] if how else [])))
        return step

    def rate(self, p, y, row):
        row[:] = 0.0
        for place, number in self.row.items():
            row[place] = number(p) if callable(number) else number

    def parameters(self, time):
        self.done.append(('parameters', time))
        return self.p.copy()

    def does(self, name, *how):
        getattr(Succession, name)(self, self.p, self.y, *how)
        return self.done


STOP, AWAY = (0.0, 0.0), (0.3, -0.4)
FRICTION, FREE = ('friction', False), ('friction', True)


@pytest.mark.parametrize(('mu', 'slip', 'what', 'mode', 'done'), [
    (0.0, AWAY, {}, GLIDING, [FRICTION, ('_open', GLIDING)]),
    (0.0, STOP, {}, GLIDING, [FRICTION, ('_open', GLIDING)]),
    (0.5, AWAY, {}, SLIDING, [FRICTION, ('_open', SLIDING)]),
    (0.5, (0.0, 1e-30), {}, SLIDING, [FRICTION, ('_open', SLIDING)]),
    (0.5, (1e-30, 0.0), {}, SLIDING, [FRICTION, ('_open', SLIDING)]),
    (0.5, STOP, {}, ROLLING, [FRICTION, ('_open', ROLLING)]),
    (0.5, STOP, {'spin': 0.011}, SLIDING, [FRICTION, ('_open', SLIDING)]),
    (0.5, STOP, {'spin': -0.011}, SLIDING, [FRICTION, ('_open', SLIDING)]),
    (0.5, STOP, {'spin': -0.009}, ROLLING, [FRICTION, ('_open', ROLLING)]),
    (IDEAL, AWAY, {}, ROLLING, [FRICTION, ('_open', ROLLING)]),
    (0.5, STOP, {'is_held': True}, ROLLING, [FREE, ('_open', ROLLING)]),
    # no law of contact holds, or the plane would have to pull
    (0.5, AWAY, {'row': {FIRMNESS: 0.0}}, SLIDING, [FRICTION, ('_end',)]),
    (0.5, AWAY, {'row': {NORMAL: 0.0}}, SLIDING, [FRICTION, ('_fly',)]),
    (0.5, STOP, {'row': {NORMAL: lambda p: p[MODE] - 2.5}}, ROLLING,
     [FRICTION, ('_creep_off',)]),                                    # a load without friction
    (0.5, STOP, {'row': {NORMAL: -1.0}}, ROLLING, [FRICTION, ('_fly',)]),
    (IDEAL, STOP, {'row': {NORMAL: lambda p: p[MODE] - 2.5}}, ROLLING, [FRICTION, ('_fly',)]),
    # a ring that lies
    (0.5, STOP, {'lies_level': True}, ROLLING, [FRICTION, ('_lie', 0.02)]),
    (0.5, STOP, {'lies_level': True, 'load': {'normal': 0.0}}, ROLLING,
     [FRICTION, ('_open', ROLLING)]),
    (0.5, STOP, {'comes_down': True}, SLIDING, [FRICTION, ('_rest', 102.5)]),
    # what friction holds
    (0.5, STOP, {'row': {MOTION: 0.0}, 'stays': True}, ROLLING,
     [FRICTION, ('halt',), ('_open', RESTING)]),
    (0.5, STOP, {'row': {MOTION: 0.0}}, ROLLING, [FRICTION, ('_open', ROLLING)]),
    (0.5, STOP, {'stays': True}, ROLLING, [FRICTION, ('_open', ROLLING)]),
    (0.5, STOP, {'stays': True, 'is_held': True}, ROLLING,
     [FREE, ('halt',), ('_open', RESTING)]),
    (0.5, STOP, {'stays': True, 'is_held': True, 'is_disk': True}, ROLLING,
     [FREE, ('_open', ROLLING)]),
    (0.5, AWAY, {'row': {MOTION: 0.0}, 'stays': True}, SLIDING, [FRICTION, ('_open', SLIDING)]),
    (0.5, STOP, {'row': {GRIP: -0.9 * HOLDS}}, ROLLING, [FRICTION, ('_open', ROLLING)]),
    (0.5, STOP, {'row': {GRIP: -1.1 * HOLDS}}, ROLLING, [FRICTION, ('_creep_off',)]),
    (0.5, AWAY, {'row': {GRIP: -1.0}}, SLIDING, [FRICTION, ('_open', SLIDING)])])
def test_a_body_lands_with_its_slip_in_the_phase_that_friction_says(
        mu, slip, what, mode, done, monkeypatch):
    """Its load is 2 N, so that friction holds 1 N, and a share of 1e-12 more by rounding."""
    body = Body(monkeypatch, '_land', **what)
    body.p[MU], body.y[GAP] = mu, 7.0
    assert body.does('_land', slip) == done
    assert body.p[MODE] == mode
    assert body.y[U].tolist() == [*slip, 0.0]
    assert body.y[GAP] == 0.0
    assert not body.y[OMEGA].any()


def test_a_body_that_turns_does_not_rest_by_standing_still(monkeypatch):
    body = Body(monkeypatch, '_land', {MOTION: 0.0}, stays=True)
    body.y[OMEGA.start + 1] = 1e-9
    assert body.does('_land', STOP) == [FRICTION, ('_open', ROLLING)]


@pytest.mark.parametrize(('mu', 'mode', 'slip', 'spin', 'what', 'done'), [
    (0.5, ROLLING, STOP, 0.03, {}, [('_rest', 102.5)]), (0.5, ROLLING, STOP, -0.03, {},
                                                         [('_rest', 102.5)]),
    (0.5, ROLLING, STOP, 0.01, {}, [('_give_way',)]),
    (0.5, ROLLING, STOP, 0.01, {'stays': True}, [('halt',), ('_open', RESTING)]),
    (0.5, SLIDING, AWAY, 0.0, {}, [('_rest', 102.5)]),
    (0.5, SLIDING, (0.3, 0.0), 0.0, {}, [('_rest', 102.5)]),
    (0.5, SLIDING, AWAY, 0.0, {'is_disk': True, 'stays': True}, [('_give_way',)]),
    (0.5, ROLLING, AWAY, 0.0, {'is_disk': True}, [('_rest', 102.5)]),
    (0.0, GLIDING, STOP, 0.03, {'stays': True}, [('_give_way',)]),
    (0.0, GLIDING, AWAY, 0.0, {'stays': True}, [('_give_way',)]),
    (0.0, GLIDING, STOP, 0.0, {'stays': True}, [('halt',), ('_open', RESTING)])])
def test_a_ring_that_lies_rests_where_friction_stops_it_and_gives_way_elsewhere(
        mu, mode, slip, spin, what, done, monkeypatch):
    """Friction brings it to rest at once, except for a disk that slides without a spin."""
    body = Body(monkeypatch, '_lie', **what)
    body.p[MU], body.p[MODE], body.y[SLIP], body.y[OMEGA] = mu, mode, slip, (0.0, 0.0, spin)
    assert body.does('_lie', 0.02) == done
    assert body.p[MODE] == (SLIDING if ('_rest', 102.5) in done else mode)


@pytest.mark.parametrize(('mode', 'mu', 'what', 'done'), [
    (ROLLING, 0.5, {'load': {'tilting': (0.48, 0.15, 0.0)}},
     [('_topple', (-0.48, -0.15)), FREE, ('_open', ROLLING)]),
    (ROLLING, 0.5, {'load': {'tilting': (0.48, 0.15, 0.0)}, 'row': {NORMAL: 0.0}},
     [('_topple', (-0.48, -0.15)), FREE, ('_fly',)]),
    (ROLLING, 0.5, {'load': {'tilting': (0.48, 0.15, 0.0)}, 'row': {GRIP: -1.1 * HOLDS}},
     [('_topple', (-0.48, -0.15)), FREE, ('_creep_off',)]),
    (ROLLING, 0.5, {'load': {'tilting': (0.48, 0.15, 0.0)}, 'row': {GRIP: -0.9 * HOLDS}},
     [('_topple', (-0.48, -0.15)), FREE, ('_open', ROLLING)]),
    (ROLLING, 0.5, {'load': {'tilting': (0.48, 0.15, 0.0)}, 'row': {NORMAL: 1e-9}},
     [('_topple', (-0.48, -0.15)), FREE, ('_open', ROLLING)]),
    (SLIDING, 0.5, {'load': {'tilting': (0.48, 0.15, 0.0)}, 'row': {GRIP: -1.0}},
     [('_topple', (-0.48, -0.15)), FREE, ('_open', SLIDING)]),
    (ROLLING, 0.5, {'load': {'tilting': (0.48, 0.13, 0.0)}}, [('_end', SLIDES)]),
    (GLIDING, 0.0, {}, [('lay', 2.0), FREE, ('_open', GLIDING)]),
    (GLIDING, 0.0, {'load': {'tilting': (0.3 * ROUNDING, 0.39 * ROUNDING, 0.0)}},
     [('lay', 2.0), FREE, ('_open', GLIDING)]),
    (GLIDING, 0.0, {'load': {'tilting': (0.3 * ROUNDING, 0.41 * ROUNDING, 0.0)}},
     [('_end', SLIDES)]),
    (SLIDING, 0.5, {'is_disk': True, 'load': {'spinning': -0.49 * ROUNDING}},
     [('lay', 2.0), FREE, ('_open', SLIDING)]),
    (SLIDING, 0.5, {'is_disk': True, 'load': {'spinning': -0.51 * ROUNDING}},
     [('_end', SLIDES)]),
    (SLIDING, 0.5, {}, [('_end', SLIDES)])])
def test_a_ring_that_lies_tips_about_its_rim_where_the_couple_is_more_than_its_load_bears(
        mode, mu, what, done, monkeypatch):
    """Its radius is 1/4 m and its load 2 N: 0.5 N m; a share of 2^-47 of that is rounding."""
    body = Body(monkeypatch, '_give_way', **what)
    body.p[MODE], body.p[MU] = mode, mu
    assert body.does('_give_way') == done


@pytest.mark.parametrize(('row', 'done'), [
    ({}, [('_open', CREEPING)]), ({FIRMNESS: 0.0}, [('_end',)]), ({NORMAL: 0.0}, [('_fly',)]),
    # the slip would go the other way by more than rounding: of 32 m/s^2, or of m A times that
    ({SLIP.start: -31.0 * HOLDS, GRIP: -1.0}, [('_open', CREEPING)]),
    ({SLIP.start: -33.0 * HOLDS, GRIP: -1.0}, [('_end',)]),
    ({SLIP.start: -63.0 * HOLDS, GRIP: -1.0, FIRMNESS: 2.0}, [('_open', CREEPING)]),
    ({SLIP.start: -65.0 * HOLDS, GRIP: -1.0, FIRMNESS: 2.0}, [('_end',)]),
    ({SLIP.start: -31.0 * HOLDS, GRIP: -1.0, FIRMNESS: 0.5}, [('_open', CREEPING)]),
    # unless friction holds it
    ({SLIP.start: -1.0, GRIP: -0.9 * HOLDS}, [('_open', CREEPING)]),
    ({SLIP.start: -1.0, GRIP: -1.1 * HOLDS}, [('_end',)]),
    ({SLIP.start: 1.0, GRIP: -1.0}, [('_open', CREEPING)])])
def test_a_slip_begins_unless_what_drives_it_drives_it_back(row, done, monkeypatch):
    body = Body(monkeypatch, '_creep_off', row)
    body.y[SLIP], body.p[MODE], body.p[SWIFT] = AWAY, SLIDING, 0.0
    assert body.does('_creep_off') == [FRICTION, *done]
    assert body.y[SLIP].tolist() == [0.0, 0.0]
    assert body.p[[MODE, SWIFT, CREEP]].tolist() == [CREEPING, SPEED, CREEPS * SPEED]


@pytest.mark.parametrize(('mu', 'pressed', 'lifted', 'done'), [
    (0.5, True, False, [('_open', FLIGHT)]), (IDEAL, True, False, [('_open', FLIGHT)]),
    (2.0 * IDEAL, False, False, [('_open', FLIGHT)]),
    (2.0 * IDEAL, True, False, [('_end', PULLS)]), (0.5, True, True, [('_end', LIFTS)])])
def test_a_body_flies_with_the_velocity_that_it_has_at_the_contact(
        mu, pressed, lifted, done, monkeypatch):
    body = Body(monkeypatch, '_fly', {VELOCITY.start + k: 1.0 + k for k in range(3)})
    body.p[MU], body.y[GAP] = mu, 3.0
    body._is_pressed, body._is_lifted = lambda p, y: pressed, lambda p, y: lifted
    assert body.does('_fly') == done
    if done[0][0] == '_open':
        assert body.y[U].tolist() == [1.0, 2.0, 3.0]
        assert body.y[GAP] == 0.0


def test_what_presses_a_body_down_and_what_its_firmness_is_beside_is_without_friction(
        monkeypatch):
    for normal, pressed in ((0.1, True), (0.0, False)):
        body = Body(monkeypatch, None, {NORMAL: lambda p, n=normal: n * (p[MODE] == GLIDING)})
        body.p[MODE] = ROLLING
        assert bool(body._is_pressed(body.p, body.y)) is pressed
        assert body.p[MODE] == ROLLING
    for mode, share, at in ((SLIDING, 0.9, True), (CREEPING, 0.9, True), (SLIDING, 1.1, False),
                            (ROLLING, 0.9, False), (PIVOTING, 0.9, False)):
        body = Body(monkeypatch, None, {
            FIRMNESS: lambda p, s=share: 5.0 if p[MODE] == GLIDING else 5.0 * ROUNDING * s})
        body.p[MODE] = mode
        assert bool(body._is_at_paradox(body.p, body.y)) is at


@pytest.mark.parametrize(('law', 'normal', 'fallen', 'lifts'), [
    (VISCOUS, 1.1, None, True), (FILM, 1.1, None, True), (VISCOUS, 0.9, None, False),
    (DRY, 1.1, None, False), (VISCOUS, 1e-9, 0.9, True), (VISCOUS, 0.0, 0.9, False),
    (VISCOUS, 0.9, 1.1, False), (VISCOUS, 1.1, 1.1, True)])
def test_friction_lifts_a_body_that_falls_back_without_it(law, normal, fallen, lifts, monkeypatch):
    """By more than rounding, 1e-12 of 24 N, or by anything in the 1.25e-7 s after a flight."""
    body = Body(monkeypatch, None, {NORMAL: lambda p: normal * HOLDS * 24.0 * (
        p[VISCOUS] == p[FILM] == 0.0)})
    body.p[law] = 0.1
    if fallen:
        flight = np.zeros(CONTACT.size)
        flight[MODE], flight[SWIFT] = FLIGHT, SPEED
        body.phases = [types.SimpleNamespace(
            p=flight, begin=body.y[TIME] - fallen * AT_ONCE * LENGTH / SPEED)]
    assert bool(body._is_lifted(body.p, body.y)) is lifts
    if fallen == 0.9 and lifts:
        flight[MODE] = ROLLING
        assert not body._is_lifted(body.p, body.y)


def test_a_course_ends_with_the_reason_and_the_last_time_that_it_knows(monkeypatch):
    body = Body(monkeypatch, '_end')
    Succession._end(body, body.y, 'it ends at {} s', ahead=0.25)
    assert (body.over, body.why) == (2.5, 'it ends at 102.75 s')
    assert body.events == [(102.75, 'end', {})]
    assert body.last == 102.5
    body.over = 0.1          # 100.1 s is 1e-14 s later
    assert body.last - BEGIN <= 0.1 < math.nextafter(body.last, 200.0) - BEGIN


def test_states_of_a_phase_are_written_at_the_place_of_the_course(monkeypatch):
    body, written = Body(monkeypatch, None), []
    body.phases = [types.SimpleNamespace(write=lambda *of: written.append(of)), 'another']
    body.write(0, 'times', 'rows', 'out')
    assert written == [((1.0, 2.0), BEGIN, 'times', 'rows', 'out')]
    body._rolling.allowed = 1e-5, 2.5
    assert body.allowed == (1e-5, 2.5)


@pytest.mark.parametrize(('what', 'mode', 'done'), [
    ({'lies': True}, SLIDING, [('_rest', 102.5)]),
    ({'stays': True}, ROLLING, [('_rest', 102.5)]),
    ({}, ROLLING, [('_open', ROLLING, {'stopped': True})]),
    ({'stays': True}, SLIDING, [('_open', SLIDING, {'stopped': True})])])
def test_a_body_that_stops_rests_if_it_lies_or_is_held(what, mode, done, monkeypatch):
    body = Body(monkeypatch, '_stop', **what)
    body.p[MODE], body.p[RIM] = mode, 1e-6
    assert body.does('_stop', 102.5) == done
    assert body.p[RIM] == 0.0


@pytest.mark.parametrize(('what', 'mu', 'done', 'mode'), [
    ({'slides_on': True}, 0.5, [('_end', SLIDES)], SLIDING),
    ({}, 0.5, [('halt',), ('_open', RESTING)], SLIDING),
    ({'lies': True, 'stays': True}, 0.5, [('halt',), ('_open', RESTING)], SLIDING),
    ({'lies': True}, 0.5, [('halt',), ('_give_way',)], ROLLING),
    ({'lies': True}, 0.0, [('halt',), ('_give_way',)], GLIDING)])
def test_a_body_rests_unless_it_lies_where_the_plane_does_not_hold_it(
        what, mu, done, mode, monkeypatch):
    body = Body(monkeypatch, '_rest', **what)
    body.p[MODE], body.p[MU] = SLIDING, mu
    assert body.does('_rest', 102.5) == done
    assert body.p[MODE] == mode
    assert body.events == ([] if done[0][0] == '_end' else [(102.5, 'rest', {})])


@pytest.mark.parametrize(('impulse', 'rebounds', 'done'), [
    (5.0, True, [('_open', FLIGHT)]), (5.0, False, [('_land', AWAY)]),
    (-0.9 * CHATTER * 12.0, False, [('_land', AWAY)]),
    (-1.1 * CHATTER * 12.0, True, [('_end', PULLS)])])
def test_a_body_lands_or_bounces_unless_the_plane_would_pull(
        impulse, rebounds, done, monkeypatch):
    """By more than chatters: of 3 kg at 4 m/s."""
    body = Body(monkeypatch, '_impact')
    monkeypatch.setattr(module, 'bounce', lambda p, y, scales: types.SimpleNamespace(
        before=-2.0, impulse=impulse, rebounds=rebounds, slip=AWAY))
    assert body.does('_impact') == done
    assert body.events == [(102.5, 'impact', {'normal_velocity': -2.0, 'impulse': impulse})]


@pytest.mark.parametrize(('mode', 'patch', 'died', 'over', 'name'), [
    (CREEPING, 0.0, False, None, 'sliding began'), (CREEPING, 0.0, True, None, 'sliding began'),
    (CREEPING, 0.1, True, None, None), (CREEPING, 0.1, False, None, 'sliding began'),
    (ROLLING, 0.1, True, None, 'rolling began'), (RESTING, 0.0, True, None, 'rolling began'),
    (FLIGHT, 0.0, True, None, 'lift-off'), (SLIDING, 0.0, True, None, None),
    (GLIDING, 0.0, True, None, None), (ROLLING, 0.0, True, 2.5, None)])
def test_an_event_has_the_name_of_the_phase_that_follows(
        mode, patch, died, over, name, monkeypatch):
    """It stands before what has happened since."""
    body = Body(monkeypatch, '_tell')
    body.p[MODE], body.p[PATCH], body.over = mode, patch, over
    body.events = ['before', 'since']
    body.phases = [types.SimpleNamespace(p=one) for one in (np.full(SIZE, math.nan), body.p)]
    Succession._tell(body, 102.5, 1, died)
    assert body.events == ['before', *([(102.5, name, {})] if name else []), 'since']


@pytest.mark.parametrize(('side', 'grows', 'on'), [(1.0, -1.0, True), (1.0, 1.0, False),
                                                   (-1.0, 1.0, True), (-1.0, 0.0, False)])
def test_a_patch_spins_on_through_zero_where_it_is_driven_on(side, grows, on, monkeypatch):
    """Its friction, which is against the spin that follows, is in the rates."""
    body, seen = Body(monkeypatch, None, hastens=grows), []
    body.row = {NORMAL: lambda p: seen.append((p[MODE], p[SIDE])) or 1.0}
    body.p[MODE], body.p[SIDE] = SLIDING, side
    assert bool(body._spins_on(body.p, body.y)) is on
    assert seen == [(PIVOTING, -side)]
    assert (body.p[MODE], body.p[SIDE]) == (SLIDING, side)


def test_a_slip_has_died_that_no_number_tells_from_none(monkeypatch):
    monkeypatch.setattr(module, 'spins', lambda p, y: 12.0)
    p, y = np.zeros(CONTACT.size), np.zeros(SIZE)
    y[SLIP] = 3.0, 4.0
    for mode, swift, died in ((SLIDING, 13.1 / contact_march.DEAD, True),
                              (SLIDING, 12.9 / contact_march.DEAD, False),
                              (ROLLING, 13.1 / contact_march.DEAD, False)):
        p[MODE], p[SWIFT] = mode, swift
        assert bool(module._died(p, y)) is died


# -- what follows a phase ------------------------------------------------------------------------

def ended(why, mode=ROLLING, steps=100, kernels='usual', ahead=0.0, **numbers):
    """Return a phase that has ended, and the body's parameters and unknowns there."""
    return types.SimpleNamespace(status=float(why), steps=steps, kernels=kernels, ahead=ahead), (
        {MODE: mode} | {getattr(module, name): number for name, number in numbers.items()})


M = contact_march


@pytest.mark.parametrize(('phase', 'what', 'done'), [
    (ended(M.SETTLED, SLIDING), {}, [('_open', PIVOTING)]),
    (ended(M.TOUCHED, FLIGHT), {}, [('_impact',)]),
    (ended(M.JUMP, SLIDING), {}, [('_open', SLIDING)]),
    (ended(M.STOPPED, FLIGHT), {}, [('_open', FLIGHT)]),
    (ended(M.STOPPED), {}, [('_stop', 102.5)]),
    (ended(M.LOST_CONTACT), {}, [('_fly',)]),
    (ended(M.PARADOX, SLIDING, ahead=0.25), {}, [('_end', {'ahead': 0.25})]),
    (ended(M.LET_GO), {}, [('_creep_off',), ('_tell', 102.5, 0, False)]),
    (ended(M.STUCK, SLIDING), {}, [('_land', STOP), ('_tell', 102.5, 0, True)]),
    (ended(M.HELD, ONSET=0.0, RIM=0.0), {}, [('_open', ROLLING, True, False, False)]),
    (ended(M.HELD, ONSET=1.0, RIM=0.0), {'is_held': True},
     [('_open', ROLLING, False, False, True)]),
    (ended(M.HELD, ONSET=0.0, RIM=1.0), {}, [('_open', ROLLING, False, True, False)]),
    (ended(M.FASTER, CREEPING), {'slip': (1.0, 0.0)}, [('_open', SLIDING)]),
    (ended(M.FASTER, CREEPING), {'slip': (0.0, 0.0)},
     [('grip_patch',), ('_land', STOP), ('_tell', 102.5, 0, True)]),
    # a slip that has died meets no event of a slip the other way
    (ended(M.LOST_CONTACT, SLIDING), {'_died': True},
     [('_land', STOP), ('_tell', 102.5, 0, True)]),
    (ended(M.PARADOX, SLIDING), {'_died': True}, [('_land', STOP), ('_tell', 102.5, 0, True)]),
    (ended(M.JUMP, SLIDING), {'_died': True}, [('_open', SLIDING)]),
    # where no step is small enough
    (ended(M.FAILED), {'rolling': 'tips'}, [('_open', ROLLING)]),
    (ended(M.FAILED, kernels='series'), {'lies_low': True}, [('_open', ROLLING)]),
    (ended(M.FAILED), {'lies_low': True, 'rolling': 'jams'}, [('_rest', 102.5)]),
    (ended(M.FAILED, kernels='series'), {'rolling': 'ended'}, [('_stop', 102.5)]),
    (ended(M.FAILED), {'paradox': True}, [('_end', {'ahead': 0.0})]),
    (ended(M.TOUCHED, FLIGHT), {'rolling': 'tips'}, [('_impact',)]),
    (ended(M.JUMP), {'rolling': 'jams'}, [('_open', ROLLING)]),
    (ended(M.JUMP), {'rolling': 'ended'}, [('_open', ROLLING)]),
    (ended(M.JUMP, SLIDING), {'paradox': True}, [('_open', SLIDING)]),
    # what pivots is a slip, whose events are these
    (ended(M.FASTER, PIVOTING, SIDE=1.0), {'spin': 0.5}, [('_open', SLIDING)]),
    (ended(M.FASTER, PIVOTING, SIDE=-1.0), {'spin': 0.5, 'on': True}, [('_open', PIVOTING)]),
    (ended(M.FASTER, PIVOTING, SIDE=-1.0), {'spin': 0.5},
     [('grip_patch',), ('_land', STOP), ('_tell', 102.5, 0, True)]),
    (ended(M.FAILED, PIVOTING, SIDE=1.0), {'spin': 0.5}, [('_open', SLIDING)]),
    (ended(M.JUMP, PIVOTING, SIDE=-1.0), {'spin': 0.5}, [('_open', SLIDING)])])
def test_each_way_in_which_a_phase_ends_has_its_sequel(phase, what, done, monkeypatch):
    of, numbers = phase
    what = dict(what)
    slip, on, paradox = (what.pop(name, value) for name, value in (
        ('slip', AWAY), ('on', False), ('paradox', False)))
    body = Body(monkeypatch, 'follow', {ROW.part('slip').first: 0.25},
                **({'_died': False} | what))
    body._spins_on, body._is_at_paradox = lambda p, y: on, lambda p, y: paradox
    for place, number in numbers.items():
        body.p[place] = number
    body.y[SLIP] = slip
    of.p, of.front = body.p, np.concatenate((body.y, np.ones(SIZE)))
    body.phases = [types.SimpleNamespace(p=body.p)]
    body.follow(of)
    assert body.done == done
    assert body.events == ([(102.5, 'lift-off', {})] if done == [('_fly',)] else [])


@pytest.mark.parametrize('told', [True, False])
def test_a_slip_that_ends_in_rest_is_told_to_once(told, monkeypatch):
    """The landing tells it of a body that lies, and not of one that is held."""
    body, of = Body(monkeypatch, 'follow', _died=False), ended(M.STUCK)[0]
    body._tell = types.MethodType(Succession._tell, body)

    def land(p, y, slip):
        body.phases.append(types.SimpleNamespace(p=p.copy()))
        body.phases[-1].p[MODE] = RESTING
        if told:
            body.events.append((102.5, 'rest', {}))
    body._land, body.p[MODE], of.p, of.front = land, SLIDING, body.p, body.y
    body.follow(of)
    assert body.events == [(102.5, 'rolling began', {}), (102.5, 'rest', {})]


def test_a_phase_in_which_no_step_is_small_enough_is_said_to_be(monkeypatch):
    for kernels, low in (('usual', True), ('series', False)):
        body = Body(monkeypatch, 'follow', lies_low=low, _died=False)
        of, _ = ended(M.FAILED, kernels=kernels)
        of.p, of.front = body.p, body.y
        with pytest.raises(NotConverged, match=r'up: no step is small enough at t = 102\.5 s'):
            body.follow(of)


@pytest.mark.parametrize(('before', 'steps', 'wide'), [
    (WIDEST, SOON, NARROWS * WIDEST), (WIDEST, SOON + 1, WIDEST), (1e-4, SOON + 1, WIDEST),
    (4.0 * NARROWEST, SOON, NARROWEST)])
def test_a_pivot_that_ends_soon_has_narrower_differences_next_time(
        before, steps, wide, monkeypatch):
    body = Body(monkeypatch, 'follow', spin=0.5, _died=False)
    of, _ = ended(M.FASTER, steps=steps)
    body.p[MODE], body.p[SIDE], body._wide = PIVOTING, 1.0, before
    of.p, of.front = body.p, body.y
    body.follow(of)
    assert body._wide == wide


def test_a_level_flight_ends_as_high_as_it_began(monkeypatch):
    for level in (0.0, 1.0):
        body = Body(monkeypatch, 'follow', rise=0.25, _died=False)
        fronts, of = [], ended(M.TOUCHED)[0]
        body._impact = lambda p, y, seen=fronts: seen.append((p[LEVEL], y[GAP]))
        body.p[MODE], body.p[LEVEL], body.y[GAP] = FLIGHT, level, 1.0
        of.p, of.front = body.p, body.y
        body.follow(of)
        assert fronts == [(0.0, 1.0 - 0.25 * level)]
        assert (body.p[LEVEL], body.y[GAP]) == (level, 1.0)    # those of the phase stay


def test_a_body_at_rest_is_held_or_not_by_what_acts_from_now_on(monkeypatch):
    body = Body(monkeypatch, 'follow', _died=False)
    of, _ = ended(M.JUMP)
    body.p[MODE] = RESTING
    of.p, of.front = body.p, body.y
    body.follow(of)
    assert body.done == [('parameters', 102.5), ('_land', STOP)]


# -- how a phase begins --------------------------------------------------------------------------

def opened(monkeypatch, mode, *how, time=2.5, tolerance=1e-9, wide=WIDEST, **what):
    """Return a body, and the phases that it begins: (parameters, unknowns, tolerance)."""
    body, phases = Body(monkeypatch, '_open', **what), []

    class Made:
        def __init__(self, bound, p, y, tolerance, work, length):
            assert (work, length) == ('work', LENGTH)
            self.p, self.y, self.tolerance, self.begin = p, y, tolerance, float(y[TIME])
            phases.append(self)
    monkeypatch.setattr(module, 'Phase', Made)
    body.y[TIME], body._tolerance, body._wide = time, tolerance, wide
    body._open(mode, body.p, body.y, *how)
    return body, phases


@pytest.mark.parametrize(('time', 'until'), [(0.5, 1.0), (1.0, 3.0), (2.5, 3.0), (3.0, math.inf)])
def test_a_phase_has_the_numbers_of_its_course_and_of_what_acts_until_it_changes(
        time, until, monkeypatch):
    """Breakpoints are at 101 and 103 s, the course began at 100 s."""
    body, (phase,) = opened(monkeypatch, ROLLING, time=time)
    assert body.done == [('parameters', BEGIN + time), ('friction', False, False, False)]
    p = phase.p
    assert p[[MODE, SWIFT, CREEP, UNTIL, STARTED]].tolist() == [
        ROLLING, SPEED, CREEPS * SPEED, until, BEGIN]
    assert p[ORIGIN].tolist() == [1.0, 2.0]
    assert p[SIDE] == 0.0
    assert phase.tolerance == 1e-9
    assert p[LAG] == 1e-9 * LENGTH
    assert p[WIDE] == WIDEST * LENGTH / SPEED
    assert body.begins == [time]


def test_a_phase_is_told_how_the_one_before_has_ended(monkeypatch):
    for how, held, said in (((), False, (False, False, False)), ((), True, (True, False, False)),
                            ((True, True, True), False, (True, True, True)),
                            ((False, True), True, (True, True, False))):
        body, _ = opened(monkeypatch, ROLLING, *how, is_held=held)
        assert body.done[-1] == ('friction', *said)


def test_the_rounding_of_forces_that_cancel_and_of_a_spin_is_not_resolved(monkeypatch):
    for tolerance in (2.0 ** -51, 2.0 ** -48):
        for spin, wide, most in ((-1e-6, 1e-6, WIDEST), (-1e-3, 1e-6, 0.0), (0.0, 1e-4, 1e-4)):
            body, (phase,) = opened(
                monkeypatch, PIVOTING, tolerance=tolerance, wide=wide, spin=spin)
            assert phase.tolerance == max(tolerance, CANCELS * HEAVY / SPEED)
            noise = -spin * SLIP_ROUNDS / (phase.tolerance * LENGTH)
            expected = noise if most == WIDEST else most or WIDEST
            assert phase.p[WIDE] == near(expected * LENGTH / SPEED, rel=1e-14)
            assert phase.p[SIDE] == math.copysign(1.0, spin)
            assert body._wide == wide


def test_a_ring_that_lies_flies_level_as_high_as_its_rim(monkeypatch):
    for mode, lies, level in ((FLIGHT, True, 1.0), (FLIGHT, False, 0.0), (ROLLING, True, 0.0)):
        _, (phase,) = opened(monkeypatch, mode, lies=lies, rise=0.25)
        assert (phase.p[LEVEL], phase.y[GAP]) == (level, 0.25 * level)


def test_rest_under_what_depends_on_time_ends_the_course(monkeypatch):
    body, phases = opened(monkeypatch, RESTING, is_timed=True)
    assert (body.done, phases) == ([('_end', TIMED)], [])
    _, phases = opened(monkeypatch, ROLLING, is_timed=True)
    assert len(phases) == 1


def test_phases_that_follow_each_other_without_end_are_a_fault(monkeypatch):
    """Three of them, within a millionth of the time of a length, 1.25e-7 s."""
    monkeypatch.setattr(module, 'MOST_PHASES', 3)
    for share, fault in ((0.9, True), (1.1, False)):
        body, _ = opened(monkeypatch, ROLLING)
        for part in (0.3, 0.6):
            body.y[TIME] = 2.5 + part * 1.25e-7
            body._open(ROLLING, body.p, body.y.copy())
        body.y[TIME] = 2.5 + share * 1.25e-7
        if fault:
            with pytest.raises(NotConverged, match=r'at t = 102\.5000001\d* s phases of contact'):
                body._open(ROLLING, body.p, body.y)
        else:
            body._open(ROLLING, body.p, body.y)
            assert len(body.phases) == 4
            assert body.begins == [one.begin for one in body.phases]


def test_the_way_in_which_a_ring_topples_is_that_of_its_turn(monkeypatch):
    """Rates that turn a way by a tenth of what it lacks of 0.5 rad lead there."""
    body, ways = Body(monkeypatch, '_topple'), []
    monkeypatch.setattr(module, 'topple', lambda y, way: ways.append(way))

    def rate(p, y, row):
        assert p[[DRY, RIM, ONSET]].tolist() == [0.0] * 3 and p[WAY].tolist() == [1.0, 0.0]
        angle = math.atan2(ways[-1][1], ways[-1][0])
        angle += 0.9 * (0.5 - angle)
        row[OMEGA] = 3.0 * math.cos(angle), 3.0 * math.sin(angle), 7.0
    body.rates.rate = rate
    body.p[[DRY, RIM, ONSET]], body.p[WAY] = 1.0, HELD
    body._topple(body.p, body.y, (2.0, 0.0))
    assert math.atan2(ways[-1][1], ways[-1][0]) == pytest.approx(0.5, abs=1e-13)
    assert 13 <= len(ways) <= 16
    assert body.p[[DRY, RIM, ONSET]].tolist() == [1.0] * 3


# -- the start -----------------------------------------------------------------------------------

PLACE, HEIGHT, INCLINES = (30.0, -40.0), -2.0, 0.1    # 50 m along a plane that is inclined


@pytest.mark.parametrize(('gap', 'mu', 'velocity', 'clamped', 'done'), [
    (1.01, 0.5, (0.0, 0.0, 0.0), False, [('_open', FLIGHT)]),
    (1.01, 0.5, (0.0, 0.0, -9.0), True, [('_open', FLIGHT)]),
    (0.99, 0.5, (0.0, 0.0, 0.0), False, [('tip',), ('_land', STOP)]),
    (-5.0, 0.5, (*AWAY, 0.0), False, [('tip',), ('_land', AWAY)]),
    (0.0, 0.5, (0.006, 0.007, 0.009), False, [('tip',), ('_land', STOP)]),
    (0.0, 0.5, (0.006, 0.009, -0.009), False, [('tip',), ('_land', (0.006, 0.009))]),
    (0.0, 0.5, (0.006, 0.009, 0.011), False, [('tip',), ('_open', FLIGHT)]),
    (0.0, 0.5, (0.006, 0.009, -0.011), False, [('tip',), ('_impact',)]),
    (0.0, 0.5, (0.006, 0.007, -0.011), True, [('tip',), ('_land', (0.006, 0.007))]),
    (0.0, 2.0 * IDEAL, (0.006, 0.009, 0.0), False, [('tip',), ('_impact',)]),
    (0.0, 2.0 * IDEAL, (0.006, 0.007, 0.0), False, [('tip',), ('_land', STOP)]),
    (0.0, IDEAL, (0.006, 0.009, 0.0), False, [('tip',), ('_land', (0.006, 0.009))])])
def test_a_course_begins_in_flight_with_an_impact_or_on_the_plane(
        gap, mu, velocity, clamped, done, monkeypatch):
    """The gap is told in units of its rounding, 2^-47 of 1/2 m + 2 m + 0.1 of 50 m.

    The rounding of velocities is 0.01 m/s.
    """
    seen, taken = [], []

    def read(p, vector, y):
        y[:] = 0.0
        y[3], y[GAP] = 1.0, gap * ROUNDING * (LENGTH + 2.0 + 0.1 * 50.0)
        return *PLACE, HEIGHT

    def tip(p, y, slow):
        assert (len(y), slow) == (SIZE, 0.01 / LENGTH)
        seen.append(('tip',))
    scales = types.SimpleNamespace(rounding=lambda y: 0.01 * (len(y) == SIZE), length=LENGTH)
    for name, does in (
            ('read', read), ('tip', tip), ('length_of', lambda p, rates, y, row: LENGTH),
            ('Scales', lambda *of: taken.append(of) or scales),
            ('DryRolling', lambda bound, of, error: taken.append((of, error))),
            ('velocity_of_lowest', lambda p, y: velocity),
            ('is_clamped', lambda p, y, *of: clamped and (len(y), *of) == (SIZE, velocity, 0.01))):
        monkeypatch.setattr(module, name, does)

    class Made(Succession):
        def _open(self, mode, p, y):
            seen.append(('_open', mode))
            assert len(y) == SIZE
            assert p[ORIGIN].tolist() == [*PLACE] and p[STARTED] == BEGIN

        def _land(self, p, y, slip):
            seen.append(('_land', slip))
            assert y[GAP] == 0.0

        def _impact(self, p, y):
            seen.append(('_impact',))
            assert y[GAP] == 0.0
    vector, p = np.zeros(14), np.zeros(CONTACT.size)
    vector[0], p[MU], p[module.INCLINED] = BEGIN, mu, INCLINES
    bound = types.SimpleNamespace(
        work_shape=(2, ROW.size), heaviness=HEAVY,
        parameters=lambda time: p.copy(), rates=None)
    made = Made(bound, vector, 2e-9, 4.0)
    assert seen == done
    assert made._tolerance == 5e-10
    assert taken == [(LENGTH, HEAVY, 2e-9), (scales, 2e-9)]
