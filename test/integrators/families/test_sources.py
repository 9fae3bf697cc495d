# SPDX-License-Identifier: Apache-2.0
"""The kernels that families write for a number of unknowns, beside NumPy."""

import math
import types
from fractions import Fraction

import numpy as np
import pytest
from near import near

from rigid_body_sim.integrators import METHODS
from rigid_body_sim.integrators.equations import flying, hinged, turning
from rigid_body_sim.integrators.equations.relaxation import Relaxation
from rigid_body_sim.integrators.families import (
    collocation,
    composition,
    engine_step,
    one_step,
    power_series,
    runge_kutta,
    scipy_methods,
)
from rigid_body_sim.integrators.marching import relaxing, unroll
from rigid_body_sim.integrators.marching.points import CONTROL, SCALES, VALUES, Control
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import parse_scene

GROUPS = ((0, 2, True), (2, 4, False), (4, 5, False))
RELATIVE = [group for group in GROUPS if not group[2]]
DRAW = np.random.default_rng(1).normal(size=400)
A, B, C = DRAW[:5], DRAW[5:10], 1e-17 * DRAW[10:15]


def made(source, **names):
    """Return the kernel of a source."""
    names['compiled'] = lambda function: function
    exec(source, names)
    return list(names.values())[-1]


def test_stages_have_their_rates_and_their_sums():
    """Eight stages of two unknowns: unknown by unknown in S, with the rates behind them."""
    S, p = DRAW.copy(), DRAW[:3]
    stages = S[:16].reshape(2, 8)

    def rate(numbers, y):
        return numbers[0] * y[0] + numbers[1] * y[1], numbers[2] * y[0] * y[1]
    made(collocation._stage_rates(2, 3), rate=rate)(p, S)
    expected = np.array([p[0] * stages[0] + p[1] * stages[1], p[2] * stages[0] * stages[1]])
    assert S[16:32].reshape(2, 8) == near(expected, rel=1e-14)
    assert np.array_equal(np.delete(S, range(16, 32)), np.delete(DRAW, range(16, 32)))
    before, rates, matrix = S.copy(), S[16:32].reshape(2, 8).copy(), S[40:104].copy()
    y = 3.0, 4.0
    made(collocation._spread(2))(S, y, 40)
    # the matrix stands column by column
    assert S[:16].reshape(2, 8) == pytest.approx(
        np.array(y)[:, np.newaxis] + rates @ matrix.reshape(8, 8), abs=1e-14)    # 4e-16
    assert np.array_equal(S[16:], before[16:])
    row = DRAW[50:58]
    found = made(collocation._combined(2, 16))(S, tuple(row))
    assert found == pytest.approx(rates @ row, abs=1e-14)    # 0


def test_a_curve_is_a_sum_of_legendres_polynomials():
    curve, y = 7, (3.0, 4.0)
    of = DRAW[curve:curve + 2 * 17].reshape(2, 17)
    for x in (-1.0, -0.3, 0.0, 0.6, 1.0):
        expected = y + np.polynomial.legendre.legval(x, of.T)
        assert made(collocation._along(2, curve))(DRAW, y, x) == near(expected, rel=1e-13)
    assert made(collocation._end_of_curve(2, curve))(DRAW) == tuple(of[:, -1])


def test_a_step_keeps_what_its_sums_lose():
    """Y + c + h mean, but for the rounding of the increment; a norm tells what is not finite."""
    s, lost = made(collocation._advanced(5))(A, B, C, 1e-3)
    for n in range(5):
        exact = Fraction(A[n]) + Fraction(C[n]) + Fraction(1e-3) * Fraction(B[n])
        assert abs(Fraction(s[n]) + Fraction(lost[n]) - exact) < 1e-18    # 6e-20
        assert abs(lost[n]) <= np.spacing(abs(s[n]))
    s, lost, square = made(power_series._added(5))(A, C, 1e-3 * B)
    for n in range(5):
        exact = Fraction(A[n]) + Fraction(C[n]) + Fraction(1e-3 * B[n])
        assert abs(Fraction(s[n]) + Fraction(lost[n]) - exact) < 1e-18
    assert square == near(np.dot(s, s), rel=1e-14)


def test_errors_count_by_groups_over_what_they_have_met():
    """Absolute groups count as they are; a group that has not moved yet does not count."""
    scales = (0.3, 2.0)
    off = A - 0.7 * B
    shares = [off[:2] @ off[:2], off[2:4] @ off[2:4] / 0.3, off[4] ** 2 / 2.0]
    measure = made(collocation._measure(GROUPS))
    assert measure(A, B, 0.7, scales) == near(sum(shares), rel=1e-14)
    assert measure(A, B, 0.7, (0.0, 2.0)) == near(shares[0] + shares[2], rel=1e-14)
    assert made(collocation._by_group(GROUPS))(off, scales) == near(shares, rel=1e-14)
    measured = made(power_series._measured(GROUPS), PLACES=8)
    S = np.concatenate((DRAW[:24], off))
    assert measured(S, 3, scales) == near(sum(shares), rel=1e-14)
    assert measured(S, 3, (0.3, 0.0)) == near(shares[0] + shares[1], rel=1e-14)


@pytest.mark.parametrize('scales', [(1e-9, 1e9), (1e9, 1e-9)])
@pytest.mark.parametrize('h', [1e-3, 1e3])
def test_scales_are_the_largest_squares_that_were_met(scales, h):
    y, moved = ([part[2:4] @ part[2:4], part[4] ** 2] for part in (A, h * B))
    assert made(collocation._grown(GROUPS))(scales, A) == near(np.maximum(scales, y), rel=1e-14)
    first = made(collocation._first_scales(GROUPS))
    found = first((0.0, 0.0), A, B, h)
    assert found == near(np.maximum(y, moved), rel=1e-14)
    assert first(scales, A, B, h) == near(np.max([scales, y, moved], axis=0), rel=1e-14)
    found = made(power_series._grown(RELATIVE))(scales, A, B, h)
    assert found == near(np.max([scales, y, moved], axis=0), rel=1e-14)


def test_what_a_march_keeps_does_not_overlap():
    """Stages and rates of all unknowns, three matrices, five numbers, a curve, stages aside."""
    n = 7
    places = collocation._places(n)
    lengths = [('RATES', 8 * n), ('MATRIX', 8 * n), ('PREDICTOR', 64), ('BETWEEN', 64),
               ('FOR', 64), ('FOR_STEP', 1), ('FOR_BEFORE', 1), ('FOR_POINT', 1), ('TAIL', 1),
               ('CURVE', 1), ('ASIDE', 17 * n)]
    at = 0
    for name, length in lengths:    # each begins where the one before it ends
        at += length
        assert places[name] == at
    assert collocation._end(places) == at + 8 * n
    assert [places[name] for name in ('SIZE', 'LAST', 'SWEEPS', 'KEPT')] == [
        n, VALUES + 2 * n, VALUES + 2 * n + 1, VALUES + 2 * n + 2]


def test_a_march_begins_with_its_tolerance_or_its_step():
    """The tolerance is what a second may err; a series is planned a point earlier, to a fourth."""
    adapts = types.SimpleNamespace(accuracy=1e-9, horizon=50.0, step=None)
    fixed = types.SimpleNamespace(accuracy=None, horizon=50.0, step=0.02)
    march = types.SimpleNamespace(WORK=9, ROOM=20, VALUES=VALUES, SIZE=7)
    for stepped, control in ((adapts, Control(5e-12, 0.0, 0.0)), (fixed, Control(0.0, 0.02, 0.0))):
        found, point = power_series.begin(stepped, march)
        assert CONTROL.load(found.tolist()) == near(control, rel=1e-14)
        assert (len(found), len(point)) == (29, VALUES + 14)
        assert not found[CONTROL.size:].any()
    found, point = one_step.begin(fixed, march)
    assert tuple(found) == Control(0.0, 0.02, 0.0)
    assert len(point) == VALUES + 14


def test_a_march_of_gauss_begins_with_what_drag_relaxes(monkeypatch):
    """Each Relaxation stands in a part of its own behind what the march keeps."""
    draw = np.random.default_rng(4)
    found = [Relaxation(4, *draw.normal(size=(2, 3, 3)), [1.0, 2.0, 3.0]),
             Relaxation(10, *draw.normal(size=(2, 2, 2)), [4.0, 5.0])]
    monkeypatch.setattr(collocation, 'stiff_relaxations', lambda scene, size: found)
    monkeypatch.setattr(collocation, 'cancelling', lambda scene, horizon: (9.0, 7.0))
    march = types.SimpleNamespace(WORK=9, SIZE=13, TURNING=5, MOVING=6, KEPT=40, FLIGHT=(1, 2))
    stepped = types.SimpleNamespace(scene=None, accuracy=1e-9, horizon=50.0, step=None)
    control, point = collocation.begin(stepped, march)
    assert CONTROL.load(control.tolist()) == near(Control(2e-11, 0.0, 0.0), rel=1e-14)
    assert (*control[5:7], len(point)) == (9.0, 7.0, 40 + 8 * 13)
    assert point[SCALES + 1:SCALES + 3].tolist() == least_scales(7.0)
    point[SCALES + 1:SCALES + 3] = 0.0
    assert not point.any()
    parts = control[9 + collocation._end(collocation._places(13)):].reshape(2, relaxing.PART)
    for part, one in zip(parts, found, strict=True):
        size = len(one.rates) ** 2
        assert np.array_equal(part[relaxing.INTO:relaxing.INTO + size], one.into.ravel())
        assert np.array_equal(part[relaxing.BACK:relaxing.BACK + size], one.back.ravel())
        first = relaxing.DECAY
        assert part[first:first + len(one.rates)].tolist() == one.rates
    fixed = types.SimpleNamespace(scene=None, accuracy=None, horizon=50.0, step=0.02)
    control, point = collocation.begin(fixed, march)
    assert not point.any()
    assert CONTROL.load(control.tolist()) == Control(0.0, 0.02, 0.0)


def test_a_march_of_steps_with_an_error_knows_what_rounding_leaves_of_the_acceleration(
        monkeypatch):
    """2^-51 of its largest: that of terms that may cancel, and that of what is borne."""
    monkeypatch.setattr(one_step, 'cancelling', lambda scene, horizon: (0.18 * horizon, 7.0))
    monkeypatch.setattr(one_step, 'borne', lambda scene: 5.0)
    stepped = types.SimpleNamespace(scene=None, accuracy=1e-9, horizon=50.0, step=None,
                                    method=METHODS['dop8'])
    march = types.SimpleNamespace(SIZE=7, FLIGHT=())
    control, point = one_step.begin(stepped, march)
    assert CONTROL.load(control[:CONTROL.size].tolist()) == near(
        Control(2e-11, 0.0, 0.0), rel=1e-15)
    assert control[CONTROL.size] == 14.0 * 2.0 ** -51
    assert control[CONTROL.size + 1] == 7.0
    assert control[CONTROL.size + 2:].tolist() == list(unroll.weights(METHODS['dop8']))
    assert (len(point), any(point)) == (VALUES + 14, False)
    march.FLIGHT = 2, 1
    _, point = one_step.begin(stepped, march)
    assert point[SCALES + 1:SCALES + 3].tolist()[::-1] == least_scales(7.0)


def least_scales(acceleration):
    """Return those of place and velocity, squared, of 1e-9 within 50 s."""
    speed = 2.0 ** -50 * acceleration * 50.0 / 1e-9
    return near([(50.0 * speed)**2, speed**2], rel=1e-14)


@pytest.mark.parametrize(('groups', 'expected'), [
    (turning.GROUPS, ()), (turning.APART, ()), (flying.GROUPS, (1, 2)), (hinged.GROUPS, ())])
def test_place_and_velocity_have_scales_where_a_body_flies(groups, expected):
    assert unroll.flight(groups) == expected


def test_a_body_that_a_force_lets_go_needs_no_least_scales():
    """3 m/s^2 of terms of 3000 balance, but for their rounding; of fewer they do not."""
    balanced, scales = made(unroll.balanced_source(flying.GROUPS)), (1.0, 2.0, 3.0)
    rates = (*[9.0] * 10, 2.0, 1.0, 2.0)
    assert balanced(3.08e3, scales, rates) == (3.08e3, scales)
    assert balanced(3.06e3, scales, rates) == (0.0, (1.0, 0.0, 0.0))
    assert balanced(0.0, (1.0, 0.0, 0.0), (0.0,) * 13) == (0.0, (1.0, 0.0, 0.0))
    assert made(unroll.balanced_source(turning.APART))(7.0, scales, (9.0,) * 7) == (0.0, scales)


def test_what_cancels_pulls_each_group_by_a_share_of_its_scale():
    """Omega by a h, the velocity by b h and the place by b h^2; what has no scale yet by 0."""
    pulled = made(collocation._pulled(flying.GROUPS), math=math)
    assert pulled(3.0, 5.0, 0.5, (4.0, 25.0, 100.0)) == near(0.75 + 0.25 + 0.25, rel=1e-15)
    assert pulled(3.0, 5.0, 0.5, (4.0, 0.0, 1e-201)) == 0.75
    pulled = made(collocation._pulled(turning.APART), math=math)
    assert pulled(3.0, 5.0, 0.5, (4.0, 25.0, 100.0)) == 0.75


def test_each_relaxation_stands_behind_those_before_it(monkeypatch):
    found, places = [], collocation._places(13)
    monkeypatch.setattr(collocation, 'specialise', lambda template, **bindings: found.append(
        bindings) or types.SimpleNamespace(__name__='made'))
    two = [types.SimpleNamespace(first=4, rates=[1.0, 2.0, 3.0]),
           types.SimpleNamespace(first=10, rates=[4.0, 5.0])]
    assert collocation._relax(two, places) == 'made:relax'
    first = collocation._end(places)
    blocks = (4, 3, first), (10, 2, first + relaxing.PART)
    assert found == [{'BLOCKS': f'BLOCKS = {blocks!r}\n',
                      'RATES': f'RATES = {places["RATES"]}\n'}]
    assert made(collocation._relax([], places))(None, None, None, None) is None


@pytest.mark.parametrize(('step', 'mechanism', 'expanded', 'side_by_side'), [
    (None, Mechanism.POINT, False, True), (0.1, Mechanism.POINT, False, False),
    (None, Mechanism.PLANE, False, False), (None, Mechanism.POINT, True, False)])
def test_series_of_a_few_kinds_that_adapt_go_side_by_side(
        step, mechanism, expanded, side_by_side, monkeypatch):
    monkeypatch.setattr(power_series.batches, 'Batch', lambda *them: them)
    equations = object.__new__(power_series.Expanded) if expanded else object()
    stepped = types.SimpleNamespace(
        step=step, accuracy=1e-9, horizon=50.0,
        scene=types.SimpleNamespace(constraint=types.SimpleNamespace(mechanism=mechanism)))
    found = power_series.batch(types.SimpleNamespace(equations=equations), stepped, [1.0, 2.0])
    assert found == ((equations, near(2e-11, rel=1e-15), [1.0, 2.0]) if side_by_side else None)


FAMILIES = collocation, composition, engine_step, power_series, runge_kutta, scipy_methods


@pytest.mark.parametrize('family', FAMILIES)
def test_a_family_declares_what_it_can(family):
    """Series have no kinks, and SciPy's solvers step over them (docs/scenes.md)."""
    assert family.KINKS is (family not in (power_series, scipy_methods))
    assert family.LANES is hasattr(family, 'batch') is (family is power_series)
    assert family.TABLE is hasattr(family, 'table') is (family is runge_kutta)


@pytest.mark.parametrize('family', FAMILIES)
def test_a_family_takes_a_wrench_where_its_equations_have_its_numbers(family):
    scene = parse_scene('scene: a\nbody: {mass: 2, inertia: [0.2, 0.3, 0.4]}\nconstraint: pivot\n'
                        'effects: [gravity: {g: 9.81}]\ninitial: {}\n')
    of = family.Equations if family is scipy_methods else family.equations_of
    held, free = (of(scene, wrench).parameter_count
                  for wrench in (Wrench(torque=(0.1, 0.2, 0.3)), None))
    assert (held > free) is family.TAKES_WRENCH
