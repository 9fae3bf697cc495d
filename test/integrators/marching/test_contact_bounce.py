# SPDX-License-Identifier: Apache-2.0
"""The impacts of one instant, on made-up ones: when they end, and what they sum up to."""

import types

import numpy as np
import pytest

from rigid_body_sim.integrators.equations.contact_views import UNKNOWNS
from rigid_body_sim.integrators.marching import contact_bounce
from rigid_body_sim.integrators.marching.contact_bounce import (
    CHATTER,
    GAP,
    IMPACT,
    MU,
    collision,
)
from rigid_body_sim.mechanics.contact.parameters import CONTACT

pytestmark = pytest.mark.without_numba

SCALES = types.SimpleNamespace(speed=lambda y: 4.0, rounding=lambda y: 0.01, length=2.0)


@pytest.mark.parametrize(('after', 'rebounds'), [
    (4.1 * CHATTER, True), (4.0 * CHATTER, False), (3.9 * CHATTER, False), (0.5, True)])
def test_a_body_rebounds_unless_it_would_chatter(after, rebounds, monkeypatch):
    """Then the impact is one without restitution, from the same state."""
    given = []

    def collide(p, y, restitution, out):
        given.append((restitution, y.copy()))
        y[:] += 1.0 + restitution
        impact = IMPACT.load(np.zeros(IMPACT.size).tolist())
        IMPACT.store(out, impact._replace(after=after if restitution else 0.0))
    monkeypatch.setattr(contact_bounce, 'collide', collide)
    y = np.arange(float(UNKNOWNS.size))
    start = y.copy()
    impact, found = collision(None, y, 0.5, SCALES)
    assert found == rebounds
    assert impact.after == (after if rebounds else 0.0)
    assert [one for one, _ in given] == [0.5, 0.0][:1 + (not rebounds)]
    assert all((before == start).all() for _, before in given)
    assert y[GAP] == 0.0
    assert np.delete(y - start, GAP) == pytest.approx(1.5 if rebounds else 1.0, abs=0.0)


STOP, SLIP, DEAD = (0.0, 0.0), (0.3, -0.4), (0.003, 0.004)
# (lies, mu), impacts (impulse, slip, rebounds), (tips, velocity of the lowest point) after each;
# the sum of the impulses, whether it rebounds, its slip
CASES = {
    'no ring that lies': ((False, 1.0), [(2.0, SLIP, True)], [], 2.0, True, SLIP),
    'a plane that would pull': ((True, 1.0), [(-2.0, SLIP, True)], [], -2.0, True, SLIP),
    'no tipping, away': (
        (True, 1.0), [(2.0, STOP, True)], [(False, (*SLIP, 0.02))], 2.0, True, SLIP),
    'no tipping, along x': (
        (True, 1.0), [(0.0, STOP, True)], [(False, (0.02, 0.0, 0.02))], 0.0, True, (0.02, 0.0)),
    'no tipping, along y': (
        (True, 1.0), [(0.0, STOP, True)], [(False, (0.0, 0.02, 0.02))], 0.0, True, (0.0, 0.02)),
    'no tipping, along': (
        (True, 1.0), [(2.0, SLIP, True)], [(False, (*DEAD, 0.005))], 2.0, False, STOP),
    'no tipping, down': (
        (True, 1.0), [(2.0, STOP, False)], [(False, (*DEAD, -1.0))], 2.0, False, STOP),
    'tips upwards': ((True, 1.0), [(2.0, SLIP, True)], [(True, (*SLIP, 1.0))], 2.0, True, SLIP),
    'stays where it was': (
        (True, 1.0), [(2.0, SLIP, False)], [(True, (*SLIP, 1.0))], 2.0, False, SLIP),
    'tips as fast as rounding': (
        (True, 1.0), [(2.0, SLIP, True)], [(True, (*SLIP, -0.01))], 2.0, False, SLIP),
    'tips downwards, then up': (
        (True, 1.0), [(2.0, SLIP, True), (0.5, STOP, False)],
        [(True, (*SLIP, -0.02)), (True, (*DEAD, 1.0))], 2.5, False, STOP),
    'tips downwards twice': (
        (True, 1.0), [(2.0, SLIP, False), (0.5, SLIP, True), (0.25, SLIP, True)],
        [(True, (*SLIP, -0.02))] * 2 + [(True, (*SLIP, 0.02))], 2.75, True, SLIP),
    'sticks, and would slip': (
        (True, 1.0), [(2.0, STOP, False), (0.5, SLIP, False)],
        [(True, (*SLIP, 0.0)), (True, (*SLIP, 0.0))], 2.5, False, SLIP),
    'sticks': ((True, 1.0), [(2.0, STOP, False)], [(True, (*DEAD, 0.0))], 2.0, False, STOP),
    'slips without friction': (
        (True, 0.0), [(2.0, STOP, False)], [(True, (*SLIP, 0.0))], 2.0, False, SLIP),
    'stops and rebounds': (
        (True, 1.0), [(2.0, STOP, True)], [(True, (*SLIP, 1.0))], 2.0, True, SLIP)}


@pytest.mark.parametrize(('ring', 'impacts', 'lowest', 'impulse', 'rebounds', 'slip'),
                         CASES.values(), ids=CASES)
def test_impacts_follow_each_other_until_no_point_goes_down(
        ring, impacts, lowest, impulse, rebounds, slip, monkeypatch):
    """Rounding is 0.01 m/s, of a body of 2 m: it tips where it turns by 0.005 rad/s."""
    hit, moves, given = iter(impacts), iter(lowest), []

    def collide(p, y, restitution, scales):
        given.append(restitution)
        gives, along, away = next(hit)
        return types.SimpleNamespace(before=-3.0 - len(given), impulse=gives, slip=along), away

    def tip(p, y, slow):
        assert slow == 0.005
        tips, moving[:] = next(moves)
        return tips
    moving = [0.0, 0.0, 0.0]
    monkeypatch.setattr(contact_bounce, 'collision', collide)
    monkeypatch.setattr(contact_bounce, 'lies', lambda p, y: ring[0])
    monkeypatch.setattr(contact_bounce, 'tip', tip)
    monkeypatch.setattr(contact_bounce, 'velocity_of_lowest', lambda p, y: tuple(moving))
    p = np.zeros(CONTACT.size)
    p[MU], p[contact_bounce.RESTITUTION] = ring[1], 0.75
    found = contact_bounce.bounce(p, np.zeros(UNKNOWNS.size), SCALES)
    assert found == (-4.0, impulse, rebounds, slip)
    assert given == [0.75] + [0.0] * (len(impacts) - 1)
    assert next(hit, None) is next(moves, None) is None
