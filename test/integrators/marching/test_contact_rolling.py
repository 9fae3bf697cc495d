# SPDX-License-Identifier: Apache-2.0
"""What dry rolling friction does with a made-up body whose motion and friction are given."""

import math
import types

import numpy as np
import pytest
from near import near

from rigid_body_sim.integrators.equations.contact_views import (
    CREEPING,
    FLIGHT,
    RESTING,
    ROLLING,
    SLIDING,
    UNKNOWNS,
)
from rigid_body_sim.integrators.marching import contact_rolling
from rigid_body_sim.integrators.marching.contact_rolling import (
    DRY,
    ENDED,
    MODE,
    NORMAL,
    ONSET,
    PACE,
    RIM,
    ROLLS,
    ROUNDING,
    SHORT,
    SINCE,
    SLACK,
    SWIFT,
    TIE,
    TIME,
    TURN,
    WAY,
    DryRolling,
    Q,
    is_held,
)
from rigid_body_sim.mechanics.contact.parameters import CONTACT, HELD, SLOW, TIPS

pytestmark = pytest.mark.without_numba

SPEED, LENGTH, ERROR, LOAD = 4.0, 0.5, 1e-6, 3.0    # m/s, m, rad, N
AHEAD, BACK = (1.0, 0.0), (-1.0, 0.0)
SPIN = 2.0    # rad/s, by which the made-up body turns the way in which it would roll
PLACE = UNKNOWNS.part('place').first


class Body:
    """A body that rolls at a speed, tips at some rates, and is held by a share of its friction.

    `left` is what friction could hold less what it holds, N, by the way that is given.
    """

    def __init__(self, monkeypatch, kind='ellipsoid', speed=1.0, tips=(0.0, 1.0), flat=False,
                 left=lambda way: 1.0, force=(0.6, 0.8), jams=False):
        self.left, self.paused, self.asked = left, 0, []
        for name, does in (
                ('rolls', lambda p, y: speed), ('tipping', lambda p, y: tips),
                ('lies', lambda p, y: flat), ('pause', self.pause), ('jams', lambda p, y: jams),
                ('withheld', lambda p, y, row: force),
                ('about_tube', lambda p, y, *force: force[0]),
                ('grows', self.grows), ('way_out', self.way_out)):
            monkeypatch.setattr(contact_rolling, name, does)
        scales = types.SimpleNamespace(speed=lambda y: SPEED, length=LENGTH, creep=1e-3)
        bound = types.SimpleNamespace(
            rates=self, is_disk=kind == 'disk', is_torus=kind == 'torus')
        self.friction, self.y = DryRolling(bound, scales, ERROR), np.zeros(UNKNOWNS.size)
        self.y[3] = 1.0
        self.p = np.full(CONTACT.size, 7.0)
        self.p[MODE], self.p[DRY] = ROLLING, 0.1

    def pause(self, p, y):
        self.paused += 1

    def rate(self, p, y, row):
        assert y.shape == self.y.shape
        row[:] = 0.0
        row[ROLLS], row[NORMAL], row[PACE] = self.left(tuple(p[WAY])), LOAD, 0.5
        row[PLACE], row[Q] = 0.5 * SPIN, (0.0, 0.0, 0.0, 9.0)

    def way_out(self, grows, x, z):
        """Return the way: by the angle at place, beside that of the force or of the way before."""
        self.asked.append((grows(0.3, -0.4), x, z))
        angle = self.now[PLACE]
        return math.cos(angle), math.sin(angle)

    def grows(self, p, y, row):
        self.now = y
        return row[ROLLS]

    def begin(self, *how):
        self.friction.begin(self.p, self.y, *how)
        return tuple(self.p[WAY].tolist())


def test_where_it_has_no_say_nothing_of_it_is_left(monkeypatch):
    for mode, dry in ((ROLLING, 0.0), (FLIGHT, 0.1), (RESTING, 0.1)):
        body = Body(monkeypatch, speed=0.0)
        body.p[MODE], body.p[DRY] = mode, dry
        assert body.begin(True) == AHEAD
        assert body.p[[ONSET, TURN, SLACK, RIM]].tolist() == [0.0] * 4
        assert body.p[SWIFT] == 7.0
        assert (body.paused, body.asked) == (0, [])


@pytest.mark.parametrize('mode', [ROLLING, SLIDING, CREEPING])
@pytest.mark.parametrize(('kind', 'share', 'way'), [
    ('ellipsoid', 2.1 * SLOW, AHEAD), ('ellipsoid', 1.9 * SLOW, HELD),
    ('disk', 1.1 * ROUNDING, AHEAD), ('disk', 0.9 * ROUNDING, HELD),
    ('disk', -1.1 * ROUNDING, BACK), ('disk', -0.9 * ROUNDING, HELD),
    ('torus', 2.1 * SLOW, AHEAD), ('torus', 1.9 * SLOW, HELD)])
def test_a_body_is_held_where_it_rolls_no_faster_than_rounding(
        mode, kind, share, way, monkeypatch):
    """A disk beside the rounding of the speeds, others beside the speed that counts as slow."""
    body = Body(monkeypatch, kind, share * SPEED)
    body.p[MODE] = mode
    assert body.begin(False) == way
    assert is_held(body.p) is (way == HELD)
    assert body.paused == (way == HELD)
    assert body.p[[SWIFT, ONSET, TURN, SLACK, RIM]].tolist() == [SPEED, 0.0, 0.0, 0.0, 0.0]
    stopped = Body(monkeypatch, kind, speed=9.0)
    assert stopped.begin(True) == HELD


@pytest.mark.parametrize(('along', 'way'), [(0.9, HELD), (1.1, AHEAD), (-0.9, HELD),
                                            (-1.1, AHEAD)])
def test_a_disk_that_lies_is_held_where_it_does_not_tip(along, way, monkeypatch):
    """Its lowest point runs round at any speed; what counts is the tipping beside rounding."""
    body = Body(monkeypatch, 'disk', tips=(9.0, along * ROUNDING * SPEED / LENGTH), flat=True)
    assert body.begin(False) == way
    for kind, flat in (('torus', True), ('disk', False)):
        other = Body(monkeypatch, kind, tips=(9.0, 0.0), flat=flat, left=lambda way: -1.0)
        assert other.begin(False) == AHEAD


@pytest.mark.parametrize(('released', 'left', 'way', 'slack'), [
    (False, 0.9, HELD, 2.0), (False, -0.9, HELD, 2.0), (False, 1.1, HELD, 0.0),
    (False, -1.1, AHEAD, 0.0), (True, 0.9, HELD, 0.0), (True, 0.0, HELD, 0.0),
    (True, -0.9, AHEAD, 0.0)])
def test_a_tie_of_force_and_friction_is_held_unless_friction_has_just_let_go(
        released, left, way, slack, monkeypatch):
    """By 1e-12 of what it can hold; the slack is twice that."""
    tie = TIE * 0.1 * LOAD
    body = Body(monkeypatch, 'disk', left=lambda way: left * tie)
    assert body.begin(True, False, released) == way
    assert body.p[SLACK] == slack * TIE
    assert released or body.begin(True) == way    # it is not, if nothing is said
    back = Body(monkeypatch, 'disk', speed=3.0, left=lambda way: -1.0, force=(-0.6, 0.8))
    assert back.begin(True) == BACK


@pytest.mark.parametrize('kind', ['ellipsoid', 'torus'])
def test_a_body_that_begins_to_roll_does_so_along_the_way_out_and_turns_it(kind, monkeypatch):
    """How fast, a difference over 1e-6 of the time of a length tells; q has the norm 1."""
    body = Body(monkeypatch, kind, left=lambda way: -2.0 if way == (0.3, -0.4) else -1.0)
    body.y[PLACE], body.y[TIME] = 0.3, 2.5
    assert body.begin(True) == (math.cos(0.3), math.sin(0.3))
    assert body.p[ONSET] == 1e-3 * SPEED
    assert body.p[SINCE] == 2.5
    assert body.p[TURN] == near(SPIN, rel=1e-8)    # measured: 6e-10, rounding of the difference
    (grown, *force), (later, *way) = body.asked
    assert (grown, later, force) == (-2.0, -2.0, [0.6, 0.8])
    assert way == [math.cos(0.3), math.sin(0.3)]
    assert body.now[Q].tolist() == body.y[Q].tolist() == [0.0, 0.0, 0.0, 1.0]
    assert body.now[PLACE] - 0.3 == near(SHORT * LENGTH / SPEED * SPIN, rel=1e-8)


@pytest.mark.parametrize(('along', 'about', 'left', 'tips'), [
    (0.0, 2.0, 1.0, True), (0.0, -2.0, 1.0, True), (0.0, 2.0, -1.0, False),
    (0.0, 2.0, 0.0, False), (3.9e-6, 2.0, 1.0, True), (-3.9e-6, -2.0, 1.0, True),
    (4.1e-6, 2.0, 1.0, False), (-4.1e-6, 2.0, 1.0, False),
    (7.9 * ROUNDING, 0.0, 1.0, True), (8.1 * ROUNDING, 0.0, 1.0, False)])
def test_a_low_torus_tips_only_where_friction_holds_it_along_its_ring(
        along, about, left, tips, monkeypatch):
    """Along its ring it may turn by its error times the other rate, over its length of 1/2 m."""
    body = Body(monkeypatch, 'torus', speed=1.0, tips=(about, along), left=lambda way: left)
    way = math.copysign(1.0, about), 0.0
    assert body.begin(False) == (way if tips else AHEAD)
    assert body.p[RIM] == (ERROR if tips else 0.0)
    body = Body(monkeypatch, 'ellipsoid', tips=(about, along))
    assert body.begin(False) == AHEAD
    assert body.p[RIM] == 0.0


def test_a_torus_at_rest_tips_about_its_tube_unless_it_has_just_ended_a_tipping(monkeypatch):
    """Held along its ring by friction; else it begins to roll both ways."""
    for tipped, way in ((False, BACK), (True, AHEAD)):
        body = Body(monkeypatch, 'torus', tips=(2.0, 0.0), force=(-0.6, 0.8),
                    left=lambda way: -1.0 if way == HELD else 1.0)
        assert body.begin(True, tipped) == way
        assert body.p[RIM] == (0.0 if tipped else ERROR)
        assert len(body.asked) == 2 * tipped
    assert body.begin(True) == BACK


def test_a_torus_that_no_step_follows_along_its_ring_tips_on_with_the_error_that_it_may_have(
        monkeypatch):
    body = Body(monkeypatch, 'torus', tips=(-2.0, 1.9 * TIPS * 2.0))
    body.p[RIM], body.y[TIME] = 0.0, 4.0
    assert body.friction.allowed == (0.0, math.inf)
    assert body.friction.goes_on_tipping(body.p, body.y)
    assert tuple(body.p[WAY]) == BACK
    assert body.p[RIM] == TIPS
    assert body.friction.allowed == (TIPS, 4.0)
    assert body.friction.goes_on_tipping(body.p, body.y) is False    # it does so already
    for kind, dry in (('disk', 0.1), ('ellipsoid', 0.1), ('torus', 0.0)):
        body = Body(monkeypatch, kind, tips=(-2.0, 0.0))
        body.p[RIM], body.p[DRY] = 0.0, dry
        assert body.friction.goes_on_tipping(body.p, body.y) is False
        assert body.friction.allowed == (0.0, math.inf)
    body = Body(monkeypatch, 'torus', tips=(-2.0, 2.1 * TIPS * 2.0 + 8.1 * ROUNDING))
    body.p[RIM], body.p[SWIFT] = 0.0, SPEED
    assert not body.friction.goes_on_tipping(body.p, body.y)
    body = Body(monkeypatch, 'torus', tips=(-2.0, 0.0), left=lambda way: -1.0)
    body.p[RIM], body.friction._error = 0.0, TIPS
    assert not body.friction.goes_on_tipping(body.p, body.y)    # nothing holds it along the ring
    assert body.friction.allowed == (0.0, math.inf)    # it had that error anyway


@pytest.mark.parametrize(('kind', 'mode', 'dry', 'way', 'share', 'ended'), [
    ('ellipsoid', ROLLING, 0.1, AHEAD, 0.9, True), ('torus', SLIDING, 0.1, AHEAD, 0.9, True),
    ('ellipsoid', ROLLING, 0.1, AHEAD, 1.1, False), ('ellipsoid', ROLLING, 0.1, HELD, 0.9, False),
    ('disk', ROLLING, 0.1, AHEAD, 0.9, False), ('ellipsoid', FLIGHT, 0.1, AHEAD, 0.9, False),
    ('ellipsoid', RESTING, 0.1, AHEAD, 0.9, False),
    ('ellipsoid', ROLLING, 0.0, AHEAD, 0.9, False)])
def test_a_rolling_that_no_step_follows_has_ended_if_it_is_slow(
        kind, mode, dry, way, share, ended, monkeypatch):
    body = Body(monkeypatch, kind, speed=share * ENDED * SPEED)
    body.p[MODE], body.p[DRY], body.p[WAY], body.p[SWIFT] = mode, dry, way, SPEED
    assert bool(body.friction.has_ended(body.p, body.y)) is ended


def test_a_ring_that_jams_errs_by_its_inclination_from_the_first_time_on(monkeypatch):
    body = Body(monkeypatch, 'torus', jams=True)
    for time, angle, allowed in ((3.0, 1e-3, (math.sin(1e-3), 3.0)),
                                 (4.0, 2e-3, (math.sin(2e-3), 3.0)),
                                 (5.0, 1e-3, (math.sin(2e-3), 3.0))):
        body.y[Q], body.y[TIME] = (math.sin(0.5 * angle), 0.0, 0.0, math.cos(0.5 * angle)), time
        assert body.friction.jams(body.p, body.y)
        assert body.friction.allowed == (near(allowed[0], rel=1e-12), allowed[1])
    body = Body(monkeypatch, 'torus')
    assert not body.friction.jams(body.p, body.y)
    assert body.friction.allowed == (0.0, math.inf)
