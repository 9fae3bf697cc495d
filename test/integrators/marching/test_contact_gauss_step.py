# SPDX-License-Identifier: Apache-2.0
"""The parts of a collocation step on a plane, beside their formulas and a known oscillation."""

import math

import numpy as np
import pytest
from near import near

from rigid_body_sim.integrators.equations.contact_lanes import Coupled
from rigid_body_sim.integrators.marching import contact_gauss_step, contact_step, gauss_nodes
from rigid_body_sim.integrators.marching.contact_gauss_step import (
    COMFORTABLE,
    COUPLED,
    ENOUGH,
    FEWEST,
    GROWTH,
    LANES,
    LARGE,
    MOST,
    NODES,
    NOISE,
    OMEGA,
    PACE,
    RATES,
    ROUNDING,
    SAFETY,
    SIZE,
    STALE,
    SWEEPS,
    TAILS,
    WIDTH,
    B,
    U,
)

pytestmark = pytest.mark.without_numba

H = 0.25


def room():
    return np.zeros((contact_gauss_step.WORK_ROWS, WIDTH))


def swinging(w, first, x, size=1.0):
    """Let two unknowns from `first` on turn by x rad in a step, along a circle of that radius."""
    angles = x * gauss_nodes.C
    for n, values in enumerate((-np.sin(angles), np.cos(angles))):
        begin = RATES + NODES * (first + n)
        w[LANES, begin:begin + NODES] = size * x / H * values


def errs(x):
    """Return by how much a step of x rad errs on a circle of radius 1."""
    return math.factorial(8) ** 2 / math.factorial(16) / math.factorial(17) * x ** 17


@pytest.mark.parametrize('x', [1.5, 2.5])
@pytest.mark.parametrize(('first', 'weight'), [(0, 1.0), (2, 1.0), (OMEGA, 0.25), (U, 0.2)])
def test_a_step_tells_its_error_beside_the_scale_of_the_unknown_with_a_margin(first, weight, x):
    """Of q as it is, of omega beside 4 rad/s, of the slip beside 5 m/s. Measured: 9 % more."""
    w = room()
    swinging(w, first, x, 3.0)
    found = contact_gauss_step.error_of(w, H, (4.0, 5.0, 8.0))
    assert found == near(SAFETY * 3.0 * weight * errs(x), rel=0.15)
    before = found
    swinging(w, OMEGA if first < OMEGA else 0, x, 0.5)    # another group adds its own
    found = contact_gauss_step.error_of(w, H, (4.0, 5.0, 8.0))
    added = 0.5 * (0.25 if first < OMEGA else 1.0)
    assert found - before == near(SAFETY * added * errs(x), rel=0.15)


@pytest.mark.parametrize(('size', 'pace', 'told'), [
    (1.1, 0.0, True), (0.9, 0.0, False), (4.4, 4.0, True), (3.6, 4.0, False)])
def test_coefficients_that_are_rounding_tell_no_error(size, pace, told):
    """2^-50 of the mean rates, of length 1, or of the pace times 4 rad/s: here 4 times as many."""
    w = room()
    w[LANES, RATES:RATES + NODES] = 1.0
    w[0, PACE] = pace / 4.0
    # the fourth of the last coefficients alone
    nodes = np.polynomial.legendre.legval(2.0 * gauss_nodes.C - 1.0, [0, 0, 0, 0, 1.0])
    w[LANES, RATES + NODES:RATES + 2 * NODES] = size * ROUNDING * nodes
    w[LANES, RATES + 2 * NODES:RATES + 3 * NODES] = 1e-30 * np.cos(7.0 * gauss_nodes.C)
    assert bool(contact_gauss_step.error_of(w, H, (4.0, 5.0, 8.0)) > 0.0) is told


def test_sums_over_the_stages_are_those_of_the_tables():
    w, draw = room(), np.random.default_rng(5)
    S = w[LANES]
    S[RATES:RATES + NODES * COUPLED] = draw.normal(size=NODES * COUPLED)
    for n in range(COUPLED):
        rates = S[RATES + NODES * n:RATES + NODES * (n + 1)]
        for row in (B, *TAILS):
            # measured: 1e-16 and 3e-16
            assert contact_gauss_step._combined(row, S, n) == pytest.approx(row @ rates, abs=2e-15)
        for i in range(NODES):
            assert contact_gauss_step._ahead(tuple(rates), i) == pytest.approx(
                gauss_nodes.A[i] @ rates, abs=2e-15)


def test_the_differences_of_unknowns_are_those_of_each_kind():
    a = Coupled((1.0, 2.0, 3.0, 4.0), (5.0, 6.0, 7.0), (8.0, 9.0))
    b = Coupled((3.0, 5.0, -1.0, 9.0), (4.0, 8.0, 10.0), (12.0, 6.0))
    assert contact_gauss_step._squares(a, b) == (4.0 + 9.0 + 16.0 + 25.0, 1.0 + 4.0 + 9.0,
                                                 16.0 + 9.0)


@pytest.mark.parametrize(('sweeps', 'longer'), [
    (5, GROWTH), (16, GROWTH), (25, COMFORTABLE / 25.0), (40, 0.5)])
def test_a_step_that_takes_many_sweeps_is_followed_by_a_shorter_one(sweeps, longer):
    w = room()
    w[LANES, SWEEPS] = sweeps
    assert contact_gauss_step.longest(w, H) == near(longer * H, rel=1e-15)


def solve(monkeypatch, at, unknown='omega', size=1.0):
    """Return (what change is left, sweeps) where sweep n leaves an unknown at at(n)."""
    S, done = room()[LANES], []
    store = {'q': contact_gauss_step.store_q, 'omega': contact_gauss_step.store_omega,
             'slip': contact_gauss_step.store_slip}[unknown]
    others = {'q': (0.0,) * 3, 'omega': (0.0,) * 2, 'slip': (0.0,)}[unknown]

    def move(S, y, h):
        store(S, (size * at(sum(name == 'hasten' for name in done)), *others), NODES - 1)
        done.append('move')
    for name, does in (('_hasten', lambda p, S: done.append('hasten')), ('_move', move),
                       ('_turn', lambda p, S, y, h: done.append('turn'))):
        monkeypatch.setattr(contact_gauss_step, name, does)
    store(S, (size * at(0), *others), NODES - 1)
    S[SWEEPS] = MOST
    left = contact_gauss_step._solve(None, S, np.zeros(SIZE), H)
    sweeps = done.count('hasten')
    assert done == ['turn', *['hasten', 'move', 'turn'] * sweeps]
    return left, sweeps, int(S[SWEEPS])


@pytest.mark.parametrize(('unknown', 'size'), [
    ('q', 1.0), ('omega', 1.0), ('slip', 1.0), ('omega', 2.0 ** -30), ('slip', 2.0 ** -30),
    ('omega', 2.0 ** 30)])
@pytest.mark.parametrize('ratio', [0.3, 0.1, 1e-5, 0.0])
def test_stages_are_solved_where_a_sweep_changes_them_by_rounding_only(
        unknown, size, ratio, monkeypatch):
    """Of q by 2^-51, of omega and of the slip by that share; after four sweeps at least."""
    needed = next(n for n in range(FEWEST, MOST)
                  if (1.0 + ratio ** (n - 1)) - (1.0 + ratio ** n) <= ENOUGH)
    found = solve(monkeypatch, lambda n: 1.0 + ratio ** n, unknown, size)
    assert found == (0.0, needed, needed)


@pytest.mark.parametrize(('change', 'solved'), [(0.9, True), (1.1, False)])
def test_small_changes_that_no_longer_fall_are_rounding(change, solved, monkeypatch):
    """Three in a row, below 2^-40: the first one is small already, and has nothing before it."""
    step = change * NOISE
    found = solve(monkeypatch, lambda n: 1.0 + 0.5 * step * (n % 2))
    again = solve(monkeypatch, lambda n: 1.0 + step * (n % 2))
    assert found == (0.0, 1 + STALE, 1 + STALE)
    assert again == ((0.0, 1 + STALE, 1 + STALE) if solved else (near(step * step, rel=1e-2),
                                                                 MOST - 1, MOST))


def test_stages_that_run_away_or_do_not_settle_are_given_up(monkeypatch):
    for most in (2.0 * LARGE, math.inf, math.nan):
        with np.errstate(invalid='ignore'):
            assert solve(monkeypatch, lambda n, most=most: most if n == 3 else 1.0 + 0.1 ** n) == (
                math.inf, 3, MOST)
    left = (0.1 * 0.9 ** (MOST - 2)) ** 2    # in the last sweep
    assert solve(monkeypatch, lambda n: 1.0 + 0.9 ** n) == (
        near(left, rel=0.1), MOST - 1, MOST)


def test_a_step_ends_with_the_mean_of_the_rates_and_keeps_what_is_watched(monkeypatch):
    """The rates of the made-up stages are 1 ... 24; each stage watches numbers of its own."""
    w, lost = room(), np.zeros(SIZE)
    y, S = np.arange(1.0, SIZE + 1.0), w[LANES]
    w[0, :SIZE] = 3.0
    rates = np.arange(1.0, SIZE + 1.0)
    watched, first = contact_gauss_step.WATCHED_SIZE, contact_gauss_step.WATCHED
    w[0, contact_gauss_step.JUMP] = 77.0
    lost[9] = 0.5
    seen = {}

    def solved(p, S, y, h):
        seen['first'] = S[:NODES * COUPLED].copy()
        return seen['left']
    for name, does in (('parameters', lambda p: ('c', 'weight')), ('_solve', solved),
                       ('stage', lambda c, weight, line: (c, weight)),
                       ('store_stage', lambda S, value, at: S.__setitem__(
                           [*range(at, at + NODES * (SIZE + watched), NODES)],
                           [*rates, *(10.0 * (at - RATES) + np.arange(watched))]))):
        monkeypatch.setattr(contact_gauss_step, name, does)
    for left in (math.inf, math.nan, LARGE):
        seen['left'] = left
        assert contact_gauss_step.step_from(None, w, y, lost, H) == math.inf
        assert not w[contact_step.FRESH, :SIZE].any()
    assert S[SWEEPS] == MOST
    # the first guess goes along the rates at the start
    guess = y[:COUPLED, np.newaxis] + gauss_nodes.C * H * 3.0
    assert seen['first'] == near(guess.ravel(), rel=1e-15)
    ends = y + H * rates + lost
    ends[:4] /= np.linalg.norm(ends[:4])
    # the end is there where stages did not settle, too
    for left, error in ((1e-20, math.inf), (0.0, 0.0)):
        w[contact_step.FRESH], seen['left'] = 0.0, left
        assert contact_gauss_step.step_from(None, w, y, lost, H) == error
        assert w[contact_step.FRESH, :SIZE] == near(ends, rel=1e-14)
    for i in range(1, contact_step.STAGES):
        expected = 10.0 * (min(i, NODES) - 1) + np.arange(watched)
        expected[contact_gauss_step.JUMP - first] = 77.0
        assert w[i, first:first + watched].tolist() == expected.tolist()
    y[6] = 2.0 * LARGE
    assert contact_gauss_step.step_from(None, w, y, lost, H) == math.inf
