# SPDX-License-Identifier: Apache-2.0
"""A patch of contact that pivots: the slip of its balance, and how that slip changes with time."""

import types

import numpy as np
import pytest
from mechanics.contact.test_touch import axes, parameters
from near import near

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.integrators.equations import contact_pivoting
from rigid_body_sim.mechanics.contact.forces import Push, patch_of, standing
from rigid_body_sim.mechanics.contact.patch import patch_pivoting
from rigid_body_sim.mechanics.contact.touch import lever

pytestmark = pytest.mark.without_numba

PATCH = ', sliding_friction: {mu: 0.6}, spinning_friction: {radius: 0.01}'


def posture_after(p, c, now, at, f, touch, slip, since, short):
    """Return the time of a posture: the stand-in of a Posture is its time."""
    assert (f, touch, slip, since) == ('force', 'couple', 'slip', 5.0)
    return at + short


@pytest.fixture
def bound(monkeypatch):
    """Return a function that returns the template with stand-ins for functions of its own."""
    def with_functions(**functions):
        found = specialise(
            contact_pivoting, posture_after=f'{__name__}:posture_after',
            push_on='def push_on(p, c, now, at, slip, since):\n    return at, since\n')
        for name, function in functions.items():
            monkeypatch.setattr(found, name, function)
        return found
    return with_functions


@pytest.mark.parametrize('spin', [3.0, -3.0])
@pytest.mark.parametrize(('seed', 'force', 'held'), [
    (1, (0.5, -0.7, -30.0), True), (2, (2.0, 1.0, -25.0), True), (1, (90.0, 0.0, -1.0), False)])
def test_a_balance_slips_along_its_friction_at_the_ratio_of_the_spin(seed, force, held, spin):
    """(u, rho w) is against (F_t, f_3), and the couple about the normal is rho f_3.

    There is no slip, and no such couple, where friction cannot hold u'.
    """
    rows = axes(seed)
    c = parameters('sphere', PATCH)._replace(side=float(np.sign(spin)))
    omega = tuple((spin * np.array(rows[2]) + 0.1 * np.array(rows[0])).tolist())
    at = standing(c, (0.0, 0.0, 0.0, 1.0), omega, rows, lever(c, rows[2]))
    push = Push(force, (0.01, -0.02, 0.03), (0.1, 0.2, -0.3), (1e-4, 2e-4, -3e-4))
    growth = (0.3, -0.2, 0.0)
    found = contact_pivoting._balance(c, at, push, growth)
    friction, N = patch_pivoting(patch_of(c, at, push), 0.6, c.side, growth)
    assert (found.growth, found.friction) == (growth, friction)
    assert found.f == (*friction[:2], N)
    assert (friction[2] != 0.0) is held
    couple = np.array(push.viscous) + N * np.array(push.wrung) + 0.01 * friction[2] * np.array(
        rows[2])
    assert found.touch == near(couple, rel=1e-14)
    if held:
        way = np.array([*found.slip[:2], 0.01 * (np.array(rows[2]) @ omega)])
        against = -np.array(friction) / np.linalg.norm(friction)
        assert way / np.linalg.norm(way) == near(against, rel=1e-13)
    else:
        assert found.slip == (0.0, 0.0, 0.0)
    assert found.slip[2] == 0.0


def balance_at(slip_at, pushes):
    """Return a stand-in for the Balance of a patch at a time, whose slip is given."""
    def balance(c, at, push, growth):
        pushes.append((at, push))
        return contact_pivoting.Balance(slip_at(at), growth, 'friction', 'force', 'couple')
    return balance


def test_the_growth_of_a_slip_is_its_slope_to_both_sides(bound):
    """A slip that grows as a square of time has the slope in the middle."""
    pushes, c = [], types.SimpleNamespace(wide=0.25)
    kernels = bound(_balance=balance_at(lambda t: (7.0 + 2.0 * t + 3.0 * t * t, -t, 0.0), pushes))
    found = kernels._settled(None, c, None, 1.0, 'push', 'slip', 5.0)
    assert found.growth == near((8.0, -1.0, 0.0), rel=1e-15)
    assert found.slip == (12.0, -1.0, 0.0)
    assert pushes == [(1.0, 'push'), (1.25, (1.25, 5.25)), (0.75, (0.75, 4.75)), (1.0, 'push')]


def test_a_moment_later_a_slip_has_grown_by_its_growth(bound):
    """The Balance there is that of the Posture, the slip and the time that it has then."""
    asked = []

    def settled(p, c, now, at, push, slip, since):
        asked.append((at, push, slip, since))
        return types.SimpleNamespace(slip='later')

    def after(p, c, now, at, f, touch, slip, since, short):
        assert (f, touch, slip, since) == ('force', 'couple', (1.0, 2.0, 0.0), 0.0)
        return at + short
    kernels = bound(_settled=settled, posture_after=after)
    one = contact_pivoting.Balance(None, (4.0, -6.0, 0.0), None, 'force', 'couple')
    assert kernels._beside(None, None, None, 1.0, (1.0, 2.0, 0.0), one, 0.5) == 'later'
    assert asked == [(1.5, (1.5, 0.5), (3.0, -1.0, 0.0), 0.5)]


@pytest.mark.parametrize(('third', 'follows', 'low', 'off'), [
    (-2.0, True, False, True), (0.0, True, False, False), (-2.0, False, False, False),
    (-2.0, True, True, False)])
def test_a_pivot_goes_by_the_slope_of_its_slips_and_is_drawn_to_them(
        bound, third, follows, low, off):
    """The difference of the fourth order is the slope of a polynomial up to that order."""
    slips = np.polynomial.Polynomial([0.3, 2.0, -1.0, 0.7, 1.9])
    after = np.polynomial.Polynomial([-0.1, 0.5, 0.3, -2.0, 0.8])

    def balance(c, at, push, growth):
        return contact_pivoting.Balance((0.7, 0.8, 0.0), growth, (0.3, 0.4, third),
                                        (0.0, 0.0, 9.0), None)

    def following(patch, mu, d):
        assert d == near(np.array([0.3, 0.4, third]) / (-0.5 * 9.0), rel=1e-15)
        return follows
    kernels = bound(
        _balance=balance, patch_of=lambda *_: 'patch', patch_following=following,
        _settled=lambda *_: contact_pivoting.Balance((0.3, -0.1, 0.0), None, None, None, None),
        _beside=lambda p, c, now, at, slip, settled, short: (slips(short), after(short), 0.0))
    tilt = 1e-4 if low else 0.5
    at = types.SimpleNamespace(axes=(None, None, (np.sin(tilt), 0.0, np.cos(tilt))))
    c = types.SimpleNamespace(wide=0.25, swift=6.0, size=(2.0, 0.1, 0.0), mu=0.5,
                              kind=contact_pivoting.TORUS)
    found, error = kernels.pivot(None, c, types.SimpleNamespace(u=(1.0, 2.0, 0.0)), at, 'push')
    assert found.growth == near((2.0 - 3.0 * 0.7, 0.5 - 3.0 * 2.1, 0.0), rel=1e-14)
    assert error == (near(np.hypot(0.3, 1.2), rel=1e-14) if off else 6.0)
