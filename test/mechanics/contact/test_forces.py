# SPDX-License-Identifier: Apache-2.0
"""The force of the contact beside Newton's and Euler's laws, and the way in which slip leaves."""

import numpy as np
import pytest
from mechanics.contact.test_touch import SURFACES, parameters
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.mechanics.contact import forces
from rigid_body_sim.mechanics.contact.forces import (
    Push,
    held,
    leaving,
    posture,
    rolling_force,
    slipping_force,
    system_of,
    wrung_by,
)
from rigid_body_sim.mechanics.contact.laws import System, slipping, sticking
from rigid_body_sim.mechanics.contact.parameters import HELD
from rigid_body_sim.mechanics.contact.touch import lever

pytestmark = pytest.mark.without_numba


@pytest.mark.parametrize('seed', range(6))
def test_slip_leaves_along_the_way_in_which_it_grows(seed):
    """U' under the friction against d is along d, which the force that would hold does not say."""
    draw = np.random.default_rng(seed)
    root = draw.normal(size=(3, 3))
    G = root @ root.T + 0.3 * np.eye(3)
    system = System(tuple(map(tuple, G.tolist())), (*draw.normal(size=2).tolist(), -2.0))
    fx, fy, N = sticking(system)
    mu = 0.3 * np.hypot(fx, fy) / abs(N)
    d = leaving(system, mu)
    u1, u2, _, A = slipping(system, mu, *d)
    assert np.hypot(*d) == pytest.approx(1.0, abs=1e-15)
    assert A > 0.0
    assert u1 * d[0] + u2 * d[1] > 0.0
    # measured: 9e-16
    assert abs(u1 * d[1] - u2 * d[0]) < 1e-14 * np.hypot(u1, u2)


def test_a_contact_that_nothing_draws_has_a_direction_too():
    system = System(((2.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), (0.0, 0.0, -3.0))
    assert np.hypot(*leaving(system, 0.4)) == pytest.approx(1.0, abs=1e-15)


def test_newtons_method_for_a_slip_begins_against_the_force_that_would_hold(monkeypatch):
    """Of several directions it is then the one that the force tells; without a force it is e1."""
    asked = []

    def told(system, mu, *guess):
        asked.append((mu, *guess))
        return 0.8, 0.6, 1.0
    monkeypatch.setattr(forces, 'departure', told)
    unit = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    # with G = 1 the force that holds is -b
    for drawn in ((0.3, 0.4), (-0.05, 0.12), (0.0, 0.0)):
        assert leaving(System(unit, (*drawn, -2.0)), 0.1) == (0.8, 0.6)
    assert asked == [(0.1, 0.6, 0.8), (0.1, near(-5.0 / 13.0, rel=1e-15), near(
        12.0 / 13.0, rel=1e-15)), (0.1, 1.0, 0.0)]


def moving(surface, seed, effects=''):
    """Return (c, Posture, Push) of a body that turns, a couple that goes with N among its push."""
    c, draw = parameters(surface, effects), np.random.default_rng(seed)
    q = tuple(Rotation.random(random_state=seed).as_quat().tolist())
    a, b, viscous, wrung = (tuple(row) for row in draw.normal(size=(4, 3)).tolist())
    return c, posture(c, q, a), Push((b[0], b[1], -20.0), a, viscous, (
        0.01 * wrung[0], 0.01 * wrung[1], 0.01 * wrung[2]))


@pytest.mark.parametrize('surface', SURFACES)
def test_a_posture_tells_how_the_lowest_point_moves(surface):
    """R' = S n' by a difference along n' = n x omega, and u' = omega x (omega x r + r')."""
    c, at, _ = moving(surface, 3)
    omega, gamma = np.array(at.omega), np.array(at.axes[2])
    assert np.array(at.axes) == pytest.approx(Rotation.from_quat(at.q).as_matrix(), abs=1e-15)
    ahead, back = (np.array(lever(c, tuple((n / np.linalg.norm(n)).tolist())))
                   for n in (gamma + sign * 1e-5 * np.cross(gamma, omega) for sign in (1, -1)))
    assert at.moved == pytest.approx((ahead - back) / 2e-5, abs=1e-9)    # 2e-11
    assert at.r == pytest.approx((ahead + back) / 2.0, abs=1e-9)    # 1.6e-11
    assert at.carried == near(np.cross(omega, at.r), rel=1e-13)
    assert at.drawn == near(np.cross(omega, np.add(at.carried, at.moved)), rel=1e-13)
    assert at.inverse == c.inverse
    assert at.shift == (0.0, 0.0, 0.0)


def changes(c, at, push, f, twist=0.0):
    """Return (u', w'): of the lowest point along the plane's axes, and of the spin, by Newton."""
    R = np.array(at.axes)    # body -> plane
    couple = push.torque + np.cross(at.r, R.T @ f) + f[2] * np.array(push.wrung) + twist * R[2]
    grown = np.array(at.inverse) @ couple + at.shift
    return R @ (np.cross(np.array(at.inverse) @ couple, at.r) + at.drawn) + np.add(
        push.force, f) / c.mass, R[2] @ grown


@pytest.mark.parametrize('surface', SURFACES)
@pytest.mark.parametrize('angle', [0.4, 2.0])
def test_a_body_that_slips_stays_on_the_plane_under_a_force_on_the_cone(surface, angle):
    c, at, push = moving(surface, 4)
    dx, dy, mu = np.cos(angle), np.sin(angle), 0.15
    f, growth, A = slipping_force(c, at, push, mu, dx, dy)
    assert f[:2] == near((-mu * f[2] * dx, -mu * f[2] * dy), rel=1e-14)
    grown, free = (changes(c, at, push, force)[0] for force in (np.array(f), np.zeros(3)))
    assert grown == pytest.approx(growth, abs=1e-13)    # 3e-15
    assert f[2] * A == near(-free[2], rel=1e-13)


@pytest.mark.parametrize('surface', SURFACES)
def test_a_body_that_rolls_is_held_at_its_lowest_point(surface):
    c, at, push = moving(surface, 5)
    still = wrung_by(push, (0.0, 0.0, 0.0))
    assert still == push._replace(wrung=(0.0, 0.0, 0.0))
    f = np.array(rolling_force(c, at, still))
    assert changes(c, at, still, f)[0] == pytest.approx(np.zeros(3), abs=1e-13)    # 6e-15
    # with the couple of rolling friction it is the solution of the System
    f = np.array(sticking(system_of(c, at, push)))
    assert changes(c, at, push, f)[0] == pytest.approx(np.zeros(3), abs=1e-13)


@pytest.mark.parametrize('way', [HELD, (1.0, 0.0)])
def test_a_patch_that_holds_keeps_its_place_and_does_not_spin(way):
    """Where friction holds the rolling omega grows by the shift, too."""
    c, at, push = moving('ellipsoid', 6, ', sliding_friction: {mu: 0.7}, '
                         'spinning_friction: {radius: 0.03}')
    c, shift = c._replace(way=way), (0.3, -0.7, 0.4) if way == HELD else (0.0, 0.0, 0.0)
    at = at._replace(shift=shift)
    f, twist, grip = held(c, at, push)
    grown, spun = changes(c, at, push, np.array(f), twist)
    assert grown == pytest.approx(np.zeros(3), abs=1e-12)    # 1.3e-14
    assert spun == pytest.approx(0.0, abs=1e-12)
    assert grip == near(0.7 * f[2] - np.linalg.norm([f[0], f[1], twist / 0.03]), rel=1e-13)
