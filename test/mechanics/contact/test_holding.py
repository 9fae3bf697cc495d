# SPDX-License-Identifier: Apache-2.0
"""Dry rolling friction that holds a body, and where a rolling ends."""

import types

import numpy as np
import pytest
from mechanics.contact.test_touch import SURFACES, axes, parameters
from near import near

from rigid_body_sim.mechanics.contact.holding import (
    Burden,
    against,
    along_way,
    bears,
    burden,
    gripped,
    gripping,
    growing,
    holds_still,
    rolling_couples,
    tips,
    way_at,
    way_out,
)
from rigid_body_sim.mechanics.contact.parameters import HELD
from rigid_body_sim.mechanics.contact.touch import lever, tangent, tilting
from rigid_body_sim.scene.surfaces import shifted

ROLLS = ', sliding_friction: {mu: 0.3}, rolling_friction: {dry: 0.01}'


def wrung(share):
    """Return the couple for each newton of N at a share of the least speed that counts, m."""
    c, rows = parameters('sphere', ROLLS)._replace(swift=2.0, way=(0.0, 1.0)), axes(3)
    moved = tuple((share * 1e-13 * c.swift * np.array(rows[0])).tolist())
    return np.array(rolling_couples(c, types.SimpleNamespace(axes=rows, moved=moved), c.way)[1])


@pytest.mark.parametrize('share', [1e-3, 0.25, 0.5])
def test_friction_goes_to_zero_with_the_rolling_against_which_it_acts(share):
    """It is against s', whichever way the phase began, and continuous where s' counts again."""
    full = wrung(1.0)
    assert np.linalg.norm(full) > 0.0
    assert wrung(share) == near(share * full, rel=1e-12)
    assert wrung(-share) == near(-share * full, rel=1e-12)
    assert wrung(3.0) == near(full, rel=1e-12)
    assert (wrung(0.0) == 0.0).all()


def posture(c, rows, omega=(0.0, 0.0, 0.0), moved=(0.1, -0.2, 0.3), drawn=(1.0, 2.0, -3.0)):
    r = lever(c, rows[2])
    return types.SimpleNamespace(q=(0.0, 0.0, 0.0, 1.0), axes=rows, omega=omega, r=r,
                                 tilting=tilting(c, rows[2]), carried=tuple(np.cross(omega, r)),
                                 moved=moved, drawn=drawn)


@pytest.mark.parametrize('surface', SURFACES)
@pytest.mark.parametrize('seed', range(2))
def test_the_couple_of_friction_tells_the_force_that_it_is_of(surface, seed):
    """The couple is -(S h) x n, for h along the rim of a disk; a couple about n tells nothing."""
    c, rows = parameters(surface, ROLLS), axes(seed)
    e1, e2, n = map(np.array, rows)
    expected = (0.7, 0.0) if surface == 'disk' else (0.7, -0.4)
    h = 0.7 * np.array(tangent(rows[2])) if surface == 'disk' else 0.7 * e1 - 0.4 * e2
    couple = 0.3 * n - np.cross(shifted(c.kind, c.size, rows[2], tuple(h)), n)
    assert against(c, posture(c, rows), tuple(couple)) == near(expected, rel=1e-12)


@pytest.mark.parametrize('surface', SURFACES)
def test_a_body_that_is_held_turns_about_the_normal_only_and_a_disk_falls(surface):
    """What friction adds is a couple that keeps s' 0: along b of a disk, else across n."""
    c, rows, omega = parameters(surface, ROLLS), axes(5), (0.4, -1.1, 0.8)
    at, couple, n = posture(c, rows, omega), np.array([0.3, 0.5, -0.2]), np.array(rows[2])
    found = gripped(c, at)
    grown, shift = np.array(found.inverse) @ couple, np.array(found.shift)
    added, inertia = np.array(c.inertia) @ grown - couple, np.array(c.inertia)
    if surface == 'disk':
        e = np.array(tangent(rows[2]))
        b = np.cross(e, n)
        assert b @ (grown + shift) == near(-(e @ omega) * (n @ omega), rel=1e-12)
        assert np.abs(np.cross(added, b)).max() < 1e-14
        assert np.abs(np.cross(inertia @ shift, b)).max() < 1e-14
    else:
        assert np.abs(np.cross(grown, n)).max() < 1e-14
        assert abs(added @ n) < 1e-15
        assert not shift.any()
    np.testing.assert_allclose(found.drawn, at.drawn + np.cross(shift, at.r), rtol=1e-13)
    assert found.moved == at.moved


@pytest.mark.parametrize('seed', range(2))
def test_the_point_of_contact_moves_as_the_normal_turns_in_the_body(seed):
    """It is s' = S n', n' = n x omega; about the tube of a torus its part along b."""
    c, rows, omega = parameters('torus', ROLLS)._replace(rim=1.0), axes(seed), (0.4, -1.1, 0.8)
    e1, e2, n = map(np.array, rows)
    moved = np.array(shifted(c.kind, c.size, rows[2], tuple(np.cross(n, omega))))
    at, b = posture(c, rows, omega), np.cross(tangent(rows[2]), n)
    assert growing(c, at, omega) == near((e1 @ moved, e2 @ moved), rel=1e-12)
    assert tips(c, at) == near(b @ moved, rel=1e-12)
    held = gripped(c, at)
    assert held.moved == near(tuple((b @ moved) * b), rel=1e-12)
    drawn = np.cross(omega, np.add(at.carried, held.moved)) + np.cross(held.shift, at.r)
    assert held.drawn == near(tuple(drawn), rel=1e-12)
    # a torus that tips rolls on one circle: a couple across it asks for nothing
    couple = np.array([0.3, -0.2, 0.5])
    sine = np.hypot(n[0], n[1])
    assert against(c, at, tuple(couple)) == near((b @ couple * sine / c.size[0], 0.0), rel=1e-12)


@pytest.mark.parametrize('matrix', [np.eye(2), np.array([[2.0, 0.5], [0.5, 1.0]])])
@pytest.mark.parametrize('guess', [(1.0, 0.4), (1.0, -0.3), (0.1, 3.0), (0.0, 2.0)])
def test_a_body_that_begins_to_roll_goes_where_friction_against_its_way_lets_it(matrix, guess):
    force, friction, asked = np.array([1.0, 0.4]), 0.3, []

    def growth(x, z):
        asked.append((x, z))
        return matrix @ (force - friction * np.array([x, z]))
    x, z = way_out(growth, *guess)
    assert asked[0] == near(tuple(guess / np.linalg.norm(guess)), rel=1e-15)
    a, b = growth(x, z)
    assert x * x + z * z == near(1.0, rel=1e-15)
    # measured: 2e-16
    assert abs(x * b - z * a) < 1e-14
    assert x * a + z * b > 0.0


def test_a_body_that_nothing_holds_has_a_way_too():
    assert way_out(None, 0.0, 0.0) == (1.0, 0.0)


@pytest.mark.without_numba
@pytest.mark.parametrize(('changes', 'held'), [
    ({}, True), ({'slope': 1.01}, False), ({'mu': 0.005}, False), ({'mu': 0.0098}, False),
    ({'spin': 2e-8}, False), ({'spin': 8e-9}, True), ({'about': 1e-3}, False),
    ({'normal': -1.0}, False)])
def test_a_ball_rests_on_a_slope_no_steeper_than_rolling_friction_and_mu(changes, held):
    """The weight's lever about the point of contact is the slope times the radius, 0.2 m."""
    case = {'slope': 0.99, 'mu': 0.3, 'spin': 0.0, 'about': 0.0, 'normal': 1.0} | changes
    c, rows = parameters('sphere', ROLLS), axes(2)
    assert c.rolling == 0.01
    c = c._replace(middle=(0.0, 0.0, 0.0), mu=case['mu'], swift=2.0)
    n, weight = np.array(rows[2]), 20.0 * case['normal']
    at = posture(c, rows, tuple(case['spin'] * n))
    force = 0.6 * case['slope'] * 0.01 * weight, -0.8 * case['slope'] * 0.01 * weight, -weight
    assert bool(holds_still(c, at, force, tuple(case['about'] * n))) is held


@pytest.mark.without_numba
@pytest.mark.parametrize(('surface', 'along', 'couple', 'held'), [
    ('disk', 0.0, (2.4, 3.1, 0.0), True), ('disk', 0.0, (2.4, 3.3, 0.0), False),
    ('torus', 5.0, (-2.96, 2.22, 0.0), True), ('torus', 5.0, (-3.04, 2.28, 0.0), False),
    ('torus', 5.0, (3.36, -2.52, 0.0), True), ('torus', 5.0, (3.44, -2.58, 0.0), False),
    ('disk', 5.9, (0.0, 0.0, 0.0), True), ('disk', 6.1, (0.0, 0.0, 0.0), False),
    ('disk', 3.0, (0.0, 0.0, 0.59), True), ('disk', 3.0, (0.0, 0.0, -0.61), False)])
def test_a_flat_ring_rests_under_what_its_circle_and_friction_can_bear(
        surface, along, couple, held):
    """Of a radius of 0.2 m, under 20 N and mu = 0.3: 4 N m of pressure, 6 N of friction.

    A force along the plane through the middle of a torus tilts it by 0.05 m.
    """
    c = parameters(surface, ROLLS)
    at = posture(c, ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))
    assert bool(holds_still(c, at, (0.6 * along, 0.8 * along, -20.0), couple)) is held
    assert not holds_still(c, at, (0.6 * along, 0.8 * along, 20.0), couple)


@pytest.mark.parametrize(('share', 'held'), [(0.99, True), (1.01, False)])
@pytest.mark.without_numba
@pytest.mark.parametrize('surface', ['disk', 'torus'])
def test_a_wheel_that_stands_rests_on_a_slope_along_its_rim_as_a_ball_does(surface, share, held):
    c = parameters(surface, ROLLS)._replace(swift=2.0)
    at = posture(c, ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)))
    assert bool(holds_still(c, at, (share * 0.01 * 20.0, 0.0, -20.0), (0.0, 0.0, 0.0))) is held


@pytest.mark.parametrize(('onset', 'angle'), [(1.0, 0.6), (0.0, 0.0)])
def test_the_way_of_a_rolling_that_has_just_begun_turns_with_time(onset, angle):
    """By atan(turn (t - since)): it turns at the rate `turn` as the body begins to roll."""
    c = parameters('sphere', ROLLS)._replace(
        way=(0.6, 0.8), onset=onset, turn=2.0, since=1.0)
    x, z = np.array([[1.0, -angle], [angle, 1.0]]) @ c.way / np.hypot(1.0, angle)
    assert way_at(c, 1.3) == pytest.approx((x, z), abs=1e-15)    # 1.1e-16


@pytest.mark.parametrize(('surface', 'changes', 'ahead'), [
    ('sphere', {'way': (0.6, 0.8), 'onset': 1.0}, lambda e1, e2, e, b: 0.6 * e1 + 0.8 * e2),
    ('torus', {'way': (-0.8, 0.6), 'onset': 1.0}, lambda e1, e2, e, b: 0.6 * e2 - 0.8 * e1),
    ('disk', {'way': (1.0, 0.0)}, lambda e1, e2, e, b: e),
    ('disk', {'way': (-1.0, 0.0)}, lambda e1, e2, e, b: -e),
    ('torus', {'way': (1.0, 0.0), 'rim': 1.0}, lambda e1, e2, e, b: b),
    ('torus', {'way': (-1.0, 0.0), 'rim': 1.0}, lambda e1, e2, e, b: -b),
    ('torus', {'way': (0.0, 0.0)}, lambda e1, e2, e, b: 0.0 * e)])
def test_the_power_of_rolling_friction_is_against_the_way_of_its_phase(surface, changes, ahead):
    """C N against the velocity along the way, and what is viscous against the velocity itself.

    That is for any omega, so the couples are the right ones. What is held takes no power.
    """
    c, rows = parameters(surface, ROLLS)._replace(rolling_viscous=0.02, **changes), axes(4)
    e1, e2, n = map(np.array, rows)
    e = np.array(tangent(rows[2]))
    way = ahead(e1, e2, e, np.cross(e, n))
    for omega in np.random.default_rng(2).normal(size=(3, 3)):
        moved = np.array(shifted(c.kind, c.size, rows[2], tuple(np.cross(n, omega))))
        at = posture(c, rows, tuple(omega), tuple(moved))
        viscous, wrung, speed, film = rolling_couples(c, at, c.way)
        assert film == 0.0
        assert np.dot(wrung, omega) == pytest.approx(-0.01 * (way @ moved), abs=1e-16)
        counts = moved @ np.cross(e, n) if c.rim > 0.0 else np.linalg.norm(moved)
        assert np.dot(viscous, omega) == near(-0.02 * counts ** 2, rel=1e-12)
        assert speed == (near(abs(counts), rel=1e-14) if np.any(way) else 0.0)


@pytest.mark.parametrize('surface', ['ellipsoid', 'torus'])
@pytest.mark.parametrize('onset', [0.0, 1.0])
def test_friction_that_holds_gives_what_the_turning_of_the_body_lacks(surface, onset):
    """The couple is I omega' less all others; the part of s' that counts is along the way."""
    c, rows = parameters(surface, ROLLS)._replace(onset=onset), axes(6)
    e1, e2 = map(np.array, rows[:2])
    at, torque, grown = posture(c, rows), (0.3, -0.2, 0.1), (0.5, 0.7, -1.1)
    couple, force = gripping(c, at, torque, grown)
    assert couple == near(np.array(c.inertia) @ grown - torque, rel=1e-14)
    assert force == near(against(c, at, couple), rel=1e-14)
    expected = 0.6 * e1 @ at.moved - 0.8 * e2 @ at.moved if onset else 0.25
    assert along_way(c, at, (0.6, -0.8), 0.25) == near(expected, rel=1e-14)


@pytest.mark.parametrize('mu', [0.3, 0.0])
@pytest.mark.parametrize('surface', ['disk', 'torus'])
def test_a_flat_ring_bears_what_balances_force_and_couple_at_its_circle(surface, mu):
    """The couple of the plane about the middle of the circle; without friction N alone acts."""
    c, rows = parameters(surface, ROLLS)._replace(mu=mu, middle=(0.02, -0.01, 0.03)), axes(7)
    F, T, R = np.array([3.0, -4.0, -20.0]), np.array([0.3, -0.5, 0.2]), np.array(rows)
    found = burden(c, posture(c, rows), tuple(F), tuple(T))
    foot = np.array(c.middle) - c.size[1] * R[2]
    held = R.T @ -(F if mu else F * [0.0, 0.0, 1.0])
    couple = -(T + np.cross(foot, held))
    assert found.spinning == near(R[2] @ couple, rel=1e-12)
    assert found.tilting == pytest.approx(couple - (R[2] @ couple) * R[2], abs=1e-15)    # 6e-17
    assert (found.along, found.normal) == near((5.0, 20.0), rel=1e-15)


@pytest.mark.parametrize(('changes', 'borne'), [
    ({}, True), ({'tilting': (2.4, 3.2, 0.0)}, True), ({'tilting': (0.0, 0.0, 4.01)}, False),
    ({'along': 4.0, 'spinning': -0.41}, False), ({'along': 4.0, 'spinning': -0.39}, True),
    ({'along': 6.01}, False), ({'spinning': 1.19}, True), ({'spinning': 1.21}, False),
    ({'normal': 0.0}, False), ({'normal': -20.0}, False)])
def test_pressure_bears_a_couple_up_to_n_r_and_friction_the_shares_of_mu_n(changes, borne):
    """R is 0.2 m, N 20 N and mu 0.3; 4 N along and 0.4 N m about the normal are two shares."""
    c = parameters('disk', ROLLS)
    assert (c.size[0], c.mu) == (0.2, 0.3)
    load = Burden((0.0, 0.0, 0.0), 0.0, 0.0, 20.0)._replace(**changes)
    assert bears(c, load) is borne


@pytest.mark.parametrize('rim', [0.0, 1.0])
def test_a_film_of_air_rubs_on_a_ring_by_its_inclination(rim):
    """C_film/sin a adds to the viscous coefficient; of a torus that tips it rubs on s_b alone."""
    c, rows, omega = parameters('torus', ROLLS)._replace(
        rolling_viscous=0.02, film=0.003, rim=rim, way=(1.0, 0.0)), axes(4), (0.4, -1.1, 0.8)
    n = np.array(rows[2])
    moved = np.array(shifted(c.kind, c.size, rows[2], tuple(np.cross(n, omega))))
    at = posture(c, rows, omega, tuple(moved))
    viscous, _, speed, film = rolling_couples(c, at, c.way)
    assert film == near(0.003 / np.hypot(n[0], n[1]), rel=1e-14)
    b = np.cross(tangent(rows[2]), n)
    counts = b @ moved if rim else np.linalg.norm(moved)
    assert speed == near(abs(counts), rel=1e-13)
    assert np.dot(viscous, omega) == near(-(0.02 + film) * counts ** 2, rel=1e-12)
    held = rolling_couples(c._replace(way=HELD), at, HELD)
    assert held[1:] == ((0.0, 0.0, 0.0), 0.0, film)
