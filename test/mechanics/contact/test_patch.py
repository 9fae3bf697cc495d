# SPDX-License-Identifier: Apache-2.0
"""The laws of a patch of contact beside linear algebra: how it begins to slip, and pivots."""

import math

import numpy as np
import pytest
from near import near
from soak import SOAK

from rigid_body_sim.mechanics.contact.laws import System
from rigid_body_sim.mechanics.contact.patch import (
    Patch,
    _turn,
    patch_departure,
    patch_following,
    patch_pivoting,
    patch_slipping,
    patch_sticking,
    patch_system,
)


@pytest.mark.without_numba
@pytest.mark.parametrize('seed', range(3))
def test_a_patch_has_a_third_friction_that_is_the_couple_over_its_radius(seed):
    """The velocities (u_1, u_2, rho w) and u_n follow the forces (f_1, f_2, T/rho) and N."""
    draw, rho = np.random.default_rng(seed), 0.3
    K, b, f = draw.normal(size=(4, 4)), draw.normal(size=4), draw.normal(size=4)
    system = System(tuple(map(tuple, K[:3, :3].tolist())), tuple(b[:3].tolist()))
    M, c, n, nn, b_slip, bn = patch_system(system, K[3, :3].tolist(), K[:3, 3].tolist(),
                                           (b[3], K[3, 3]), rho)
    f1, f2, N, couple = f
    friction = np.array([f1, f2, couple / rho])
    u1, u2, un, w = K @ f + b
    # measured: 2e-16
    assert np.array(M) @ friction + N * np.array(c) + b_slip == pytest.approx(
        [u1, u2, rho * w], abs=1e-14)
    assert np.dot(n, friction) + nn * N + bn == pytest.approx(un, abs=1e-14)
    friction, N = patch_sticking(Patch(M, c, n, nn, b_slip, bn))    # which keeps it at rest
    assert np.array(M) @ friction + N * np.array(c) + b_slip == pytest.approx(
        np.zeros(3), abs=1e-12)
    assert np.dot(n, friction) + nn * N + bn == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize('seed', range(4))
def test_a_direction_is_turned_by_what_its_slopes_ask_for_up_to_the_most(seed):
    """Newton's step across d solves the two by two slopes; a longer one keeps its direction."""
    draw = np.random.default_rng(seed)
    first, second, d = np.linalg.qr(draw.normal(size=(3, 3)))[0]
    slopes, wanted = draw.normal(size=(2, 2)), draw.normal(size=2)
    step = np.linalg.solve(slopes, wanted)
    for most in (1e9, 0.3 * np.hypot(*step)):
        found, size = _turn(tuple(d), tuple(first), tuple(second), tuple(slopes.ravel()),
                                  *wanted, most)
        assert size == near(np.hypot(*step), rel=1e-12)
        kept = step * min(1.0, most / np.hypot(*step))
        turned = np.array(found) / np.dot(found, d)
        assert [np.dot(turned, first), np.dot(turned, second)] == near(kept, rel=1e-11)
        assert np.dot(found, found) == pytest.approx(1.0, abs=1e-15)


def patch_with(M, c, n, nn, b, bn):
    """Return the Patch of arrays."""
    return Patch(tuple(map(tuple, np.array(M, dtype=float).tolist())), tuple(map(float, c)),
                 tuple(map(float, n)), float(nn), tuple(map(float, b)), float(bn))


def slipping_patches(seed, count, rolling):
    """Return (patch, mu, guess) of random bodies that are pressed on the plane and do not stick.

    `rolling` is the size of a couple of rolling friction, which changes what goes with N.
    """
    draw, found = np.random.default_rng(seed), []
    while len(found) < count:
        rho, mu = 10.0 ** draw.uniform(-3.0, 0.0), 10.0 ** draw.uniform(-1.0, 1.0)
        root = draw.normal(size=(4, 6)) * 10.0 ** draw.uniform(-1.5, 0.5, size=6)
        root[2] *= rho
        G = root @ root.T
        pressed = G[:, 3] + rolling * draw.normal(size=4) * [1.0, 1.0, rho, 1.0]
        b = draw.normal(size=4) * draw.choice([0.3, 1.0, 5.0], 4) * [1.0, 1.0, rho, 1.0]
        patch = patch_with(G[:3, :3], pressed[:3], G[3, :3], pressed[3], b[:3], -abs(b[3]))
        friction, N = patch_sticking(patch)
        size = np.linalg.norm(friction)
        if size > mu * N:
            found.append((patch, mu, tuple((-np.array(friction) / size).tolist())))
    return found


def leaves(patch, mu, d, growth):
    """Return whether a slip leaves along d, up to the rounding of the forces."""
    v, N, A = patch_slipping(patch, mu, d)
    forces = np.linalg.norm(patch.b) + abs(N) * (mu + 1.0) * (
        np.linalg.norm(patch.M) + np.linalg.norm(patch.c))
    return A > 0.0 and growth > 0.0 and (
        np.linalg.norm(np.array(v) - growth * np.array(d)) < 1e-11 * forces)


def test_a_patch_that_is_pressed_and_does_not_stick_begins_to_slip():
    """Without a couple of rolling friction there always is a direction.

    With s = 1/N and d = (x + mu M)^-1 (c + s b), c = n, the numerator of s is n_n - mu n . (x + mu
    M)^-1 n > 0, as M with n and n_n is positive definite. Its denominator is -b_n > 0 at large x.
    From the largest x at which it vanishes on, or from x = 0, where |d| is the friction over mu N,
    |d| falls from more than 1 to 0, and s, and with it A, is above 0.
    """
    for patch, mu, guess in slipping_patches(1, 2000, 0.0):
        assert leaves(patch, mu, *patch_departure(patch, mu, guess))


def grown_from_everywhere(patch, mu, starts):
    """Return the largest growth to which Newton's method leads from many directions, or 0."""
    M, c, n, _, b, _ = map(np.array, patch)
    d = starts.copy()
    with np.errstate(all='ignore'):
        for _ in range(60):
            A = patch.nn - mu * d @ n
            N, push = -patch.bn / A, c - mu * d @ M.T
            v = b + N[:, None] * push
            growth = np.sum(v * d, axis=1)
            slopes = (mu * N / A)[:, None, None] * push[:, :, None] * n - mu * N[:, None, None] * M
            K = np.zeros((len(d), 4, 4))
            K[:, :3, :3] = slopes - growth[:, None, None] * np.eye(3)
            K[:, :3, 3], K[:, 3, :3] = -d, d
            off = np.concatenate([growth[:, None] * d - v, np.zeros((len(d), 1))], axis=1)
            fails = ~(np.abs(np.linalg.det(K)) > 0.0) | ~np.isfinite(off).all(axis=1)
            K[fails], off[fails] = np.eye(4), 0.0
            step = np.linalg.solve(K, off[:, :, None])[:, :3, 0]
            size = np.linalg.norm(step, axis=1)
            d = d + step * np.minimum(1.0, 0.3 / np.maximum(size, 1e-99))[:, None]
            d = d / np.linalg.norm(d, axis=1)[:, None]
    good = ~fails & (size < 1e-10) & (A > 0.0) & (growth > 0.0)
    return growth[good].max() if good.any() else 0.0


@pytest.mark.parametrize('rolling', [0.0, 0.3])
def test_a_search_from_everywhere_finds_no_slip_of_a_patch_that_is_missed(rolling):
    z = 1.0 - 2.0 * (np.arange(400) + 0.5) / 400
    angle, level = math.pi * (1.0 + math.sqrt(5.0)) * np.arange(400), np.sqrt(1.0 - z * z)
    starts = np.stack([level * np.cos(angle), level * np.sin(angle), z], axis=1)
    have, count = 0, 60 if SOAK else 20
    for patch, mu, guess in slipping_patches(2, count, rolling):
        if grown_from_everywhere(patch, mu, starts) > 0.0:
            have += 1
            assert leaves(patch, mu, *patch_departure(patch, mu, guess))
    assert have > 0.75 * count    # 57 and 49 of 60; 19 and 17 of 20


@pytest.mark.parametrize('guess', [(1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, -0.6, -0.8)])
def test_a_patch_leaves_along_the_direction_it_was_made_for(guess):
    """With N = 1 it is b = d + mu M d - c, and b_n = mu n . d - n_n."""
    d, c = np.array([0.6, 0.0, 0.8]), np.array([1.0, 0.0, 0.0])
    patch = patch_with(np.diag([2.0, 1.0, 0.5]), c, c, 2.0, (0.2, 0.0, 1.0), -1.7)
    found, growth = patch_departure(patch, 0.5, guess)
    assert found == pytest.approx(d, abs=1e-15)
    assert growth == pytest.approx(1.0, abs=1e-15)


def test_a_patch_that_no_force_keeps_out_of_the_plane_leaves_along_no_direction():
    """Rolling friction presses it down by more than N lifts it: A < 0 along all directions."""
    patch = patch_with(np.eye(3), (0.1, 0.0, 0.0), (0.1, 0.0, 0.0), -1.0, (1.0, 0.5, 0.1), -1.0)
    assert patch_departure(patch, 0.5, (1.0, 0.0, 0.0))[1] == -math.inf


def test_a_patch_that_is_not_pressed_leaves_as_far_as_a_plane_that_pulls_lets_it():
    """N < 0 says that it lifts off; Newton's method from the guess ends where A < 0."""
    c = np.array([1.0, 0.0, 0.0])
    patch = patch_with(np.diag([2.0, 1.0, 0.5]), c, c, 0.5, (3.0, 0.5, 1.0), 0.1)
    for guess in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0)):
        assert leaves(patch, 2.0, *patch_departure(patch, 2.0, guess))


def drawn_patch(seed, asymmetric=0.2):
    """Return a random Patch: M positive definite, pressed on the plane."""
    draw = np.random.default_rng(seed)
    root = draw.normal(size=(4, 4))
    whole = root @ root.T + 0.5 * np.eye(4)
    whole[:3, 3] += asymmetric * draw.normal(size=3)    # the couple that goes with N
    b = draw.normal(size=3)
    rows = tuple(map(tuple, whole[:3, :3].tolist()))
    return Patch(rows, tuple(whole[:3, 3].tolist()), tuple(whole[3, :3].tolist()),
                 float(whole[3, 3]), tuple(b.tolist()), -40.0)


@pytest.mark.parametrize('side', [1.0, -1.0])
@pytest.mark.parametrize('seed', [1, 2, 3, 4, 6, 7])    # friction holds these
def test_a_patch_that_pivots_slips_as_it_is_said_and_goes_on_the_cone(seed, side):
    """Friction of size mu N against the spin, and u' as it is asked for.

    Coulomb's law of a slip along its direction gives the same force and the same v'.
    """
    patch, mu, growth = drawn_patch(seed), 0.8, (0.3, -0.2)
    friction, N = patch_pivoting(patch, mu, side, growth)
    assert N > 0.0 > side * friction[2]
    assert math.hypot(*friction) == near(mu * N, rel=1e-13)
    moved = np.array(patch.M) @ friction + N * np.array(patch.c) + patch.b
    assert moved[:2] == pytest.approx(growth, abs=1e-12)
    assert np.dot(patch.n, friction) + N * patch.nn + patch.bn == pytest.approx(0.0, abs=1e-12)
    d = tuple((np.array(friction) / (-mu * N)).tolist())
    slipped, same, _ = patch_slipping(patch, mu, d)
    assert same == near(N, rel=1e-12)
    assert slipped == pytest.approx(moved, abs=1e-11)
    # u = F_t rho w/f_3 is along d
    assert d[0] / d[2] == near(friction[0] / friction[2], rel=1e-14)


def test_a_patch_that_friction_cannot_hold_does_not_pivot():
    patch = drawn_patch(3)._replace(b=(40.0, 0.0, 0.0), bn=-1.0)
    assert patch_pivoting(patch, 0.1, 1.0, (0.0, 0.0))[0] == (0.0, 0.0, 0.0)


@pytest.mark.parametrize('scale', [1.0, 1e-3])
@pytest.mark.parametrize('seed', [*range(8), 12, 18, 35, 37])
def test_a_slip_is_drawn_to_its_balance_where_the_matrix_of_its_rate_says(seed, scale):
    """The eigenvalues of du'/du by differences; some of these seeds are not drawn."""
    patch, W, h = drawn_patch(seed, 3.0), 1.0, 1e-6
    patch = patch._replace(b=tuple(scale * part for part in patch.b), bn=scale * patch.bn)
    draw = np.random.default_rng(seed)
    mu, u = draw.uniform(0.1, 1.5), draw.normal(size=2)

    def direction(x, y):
        return tuple((np.array([x, y, W]) / math.hypot(x, y, W)).tolist())

    def rate(x, y):
        return np.array(patch_slipping(patch, mu, direction(x, y))[0][:2])

    columns = [(rate(u[0] + h, u[1]) - rate(u[0] - h, u[1])) / (2.0 * h),
               (rate(u[0], u[1] + h) - rate(u[0], u[1] - h)) / (2.0 * h)]
    d = direction(*u)
    drawn_to = max(np.linalg.eigvals(np.array(columns)).real) < 0.0
    _, N, A = patch_slipping(patch, mu, d)
    assert patch_following(patch, mu, d) == (drawn_to and N > 0.0 and A > 0.0)


def test_the_slip_of_a_patch_that_nothing_presses_has_the_direction_asked():
    patch = drawn_patch(2)._replace(bn=0.0)
    d, growth = patch_departure(patch, 0.3, (0.6, 0.0, 0.8))
    assert np.linalg.norm(d) == near(1.0, rel=1e-15)
    assert growth == near(np.dot(d, patch.b), rel=1e-12)
