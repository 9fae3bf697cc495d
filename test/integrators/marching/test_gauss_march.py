# SPDX-License-Identifier: Apache-2.0
"""The parts of gauss16's march on two oscillators, beside what is known of them.

The first one has the length 1 and turns by 2 rad/s, the second one 1000 and 0.5 rad/s; errors of
the second one are relative.
"""

import math

import mpmath
import numpy as np
import pytest
from near import near
from numpy.polynomial import legendre

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.integrators.families import collocation
from rigid_body_sim.integrators.marching import gauss_march, gauss_nodes
from rigid_body_sim.integrators.marching.gauss_march import (
    COMFORTABLE,
    FIXED,
    GROWTH,
    LONGEST,
    NOISE,
    ORIGIN,
    SAFETY,
    SCALES,
    SHRINK,
    STAGES,
    STEP,
    TIME,
    TOLERANCE,
    TURNING,
    UNMOVED,
    VALUES,
    WORK,
)

pytestmark = pytest.mark.without_numba

FLOOR = 2.0 ** -50
FAST, SLOW, LARGE = 2.0, 0.5, 1000.0
OSCILLATORS = ('def rate(p, y):\n'
               '    return p[0] * y[1], -p[0] * y[0], p[1] * y[3], -p[1] * y[2]\n')
# y0' is a sum of P_14 and P_15 of the time, which is y1
ROUGH = ('from numpy.polynomial.legendre import legval\n'
         'def rate(p, y):\n'
         '    return legval(2.0 * y[1] - 1.0, [1.0, *[0.0] * 13, p[0], p[1]]), 1.0\n')


def bound(rate, groups, clock=0.0, relax='def relax(S, y, h, fresh):\n    pass\n'):
    return specialise(
        gauss_march, rate=rate, settled='def settled(y, lost):\n    return y, lost\n',
        relax=relax,
        hidden='def hidden(p, S, y, h, mean, pull, scales, time):\n    return 0.0\n',
        FLOOR=f'FLOOR = {FLOOR!r}\n', CLOCK=f'CLOCK = {clock!r}\n', SETTLED='SETTLED = 0.0\n',
        **collocation._of_unknowns(groups[-1][1], groups, 2))


MARCH = bound(OSCILLATORS, ((0, 2, True), (2, 4, False)), 2.0 ** -50)
P = np.array([FAST, SLOW])
START = 1.0, 0.0, 0.0, LARGE


def room(march=MARCH, **settings):
    """Return (control, point, following) of a march from the start at 0 s."""
    control = np.zeros(WORK + collocation._end(collocation._places(march.SIZE)))
    control[FIXED], control[TOLERANCE] = settings.get('step', 0.0), settings.get('tolerance', 0.0)
    point = np.zeros(march.KEPT + STAGES * march.SIZE)
    if march is MARCH:
        point[VALUES:VALUES + 4] = START
        march.begin(P, control, point)
    return control, point, point.copy()


def true(time, fast=FAST):
    return [math.cos(fast * time), -math.sin(fast * time), LARGE * math.sin(SLOW * time),
            LARGE * math.cos(SLOW * time)]


def solved(h, fast=FAST, slow=SLOW):
    """Return (the working numbers, mean rates) of a step from the start."""
    control, *_ = room()
    S = control[WORK:]
    mean, _, _, good = MARCH.solve(
        np.array([fast, slow]), S, START, h, 0.0, 40, 1e-17, 0.0, (LARGE ** 2,))
    assert good
    return S, mean


@pytest.mark.parametrize('x', [1.5, 2.5, 3.5])
def test_a_step_tells_its_error_and_its_length(x):
    """By x rad of an oscillator it errs by (8!)^2/(16! 17!) x^17, by 0.06 rad by nothing.

    The second one beside its scale. Measured: the error to 9 %, the length to 1.5 %.
    """
    h = 0.25
    with mpmath.workdps(40):
        errs = float(mpmath.factorial(8) ** 2 / mpmath.factorial(16) / mpmath.factorial(17)
                     * mpmath.mpf(x) ** 17)
    for fast, slow, scale, share in ((x / h, SLOW, LARGE, 1.0), (SLOW, x / h, LARGE, 1.0),
                                     (SLOW, x / h, 0.1 * LARGE, 10.0),
                                     (x / h, x / h, 0.5 * LARGE, 3.0)):
        S, mean = solved(h, fast, slow)
        error, length = MARCH._judged(S, h, mean, 0.0, (scale ** 2,), 0.0)
        assert error == near(share * errs, rel=0.15)
        assert length == near(x, rel=0.05)


def test_coefficients_that_are_rounding_tell_nothing():
    S, mean = solved(1e-3)
    assert MARCH._judged(S, 1e-3, mean, 0.0, (LARGE ** 2,), 0.0) == (0.0, 0.0)
    S, mean = solved(0.75)
    assert MARCH._judged(S, 0.75, mean, 0.0, (LARGE ** 2,), 0.0)[1] > 0.0
    # beside forces that may cancel, or late in time
    assert MARCH._judged(S, 0.75, mean, 1e12, (LARGE ** 2,), 0.0) == (0.0, 0.0)
    assert MARCH._judged(S, 0.75, mean, 0.0, (LARGE ** 2,), 1e15) == (0.0, 0.0)


@pytest.mark.parametrize(('pull', 'time', 'share', 'more'), [
    (0.0, 0.0, NOISE, 0.0), (3.0, 0.0, NOISE, 3.0), (0.0, 5.0, NOISE, 0.0),
    (0.0, 1e4, 2.0 ** -50 * 1e4 * LONGEST / 0.5, 0.0)])
def test_what_may_be_rounding_is_a_share_of_the_rates_or_the_floor(pull, time, share, more):
    """Rates are (3, 4) of the group that is absolute and 12 of scale 1; h is 0.5 s."""
    mean = 3.0, 4.0, 12.0, 0.0
    found = MARCH._noise(0.5, mean, pull, (1.0,), time)
    assert found == near(share ** 2 * (13.0 ** 2 + (more / 0.5) ** 2), rel=1e-12)
    assert MARCH._noise(0.5, (0.0,) * 4, 0.0, (1.0,), time) == near((FLOOR / 0.5) ** 2, rel=1e-12)


@pytest.mark.parametrize('x', [0.5, 2.0])
def test_the_length_of_a_step_follows_from_either_pair_of_coefficients(x):
    """Those of y' = i nu y: c_(n + 1)/c_n = x/(4 n + 2)."""
    c4 = 1e-3
    c5, c6, c7 = c4 * x / 18.0, c4 * x * x / 18.0 / 22.0, c4 * x ** 3 / 18.0 / 22.0 / 26.0
    for even, odd in ((1.0, 1.0), (1.0, 1e-6), (1e-6, 1.0)):    # a motion may hide one pair
        found = MARCH._fastest_square(
            (odd * c7) ** 2, (even * c6) ** 2, (odd * c5) ** 2, (even * c4) ** 2, 0.0)
        assert found == near(x * x, rel=1e-12)
    assert MARCH._fastest_square(c7 ** 2, 0.0, c5 ** 2, 0.0, 3.0 * c5 ** 2) == near(
        0.5 * x * x, rel=1e-12)
    assert MARCH._fastest_square(0.0, c6 ** 2, 0.0, c4 ** 2, 3.0 * c4 ** 2) == near(
        0.5 * x * x, rel=1e-12)


def straight(unknowns, by_order):
    """Return the rates of a step at its stages: of each of these the sum of c_n P_n."""
    S = np.zeros(collocation._end(collocation._places(4)))
    rates = S[MARCH.RATES:][:4 * STAGES].reshape(4, STAGES)
    for unknown in unknowns:
        rates[unknown] = legendre.legval(2.0 * gauss_nodes.C - 1.0, [
            by_order.get(n, 0.0) for n in range(STAGES)])
    return S


@pytest.mark.parametrize('unknown', [0, 3])
@pytest.mark.parametrize('x', [0.5, 2.0])
@pytest.mark.parametrize('seen', [(4, 6), (5, 7), (4, 5, 6, 7)])
def test_a_step_that_has_only_even_or_odd_coefficients_tells_as_much(seen, x, unknown):
    """The 7th, by which it errs, is x/26 of the 6th where it is not seen itself.

    The last unknown is one of a group of scale 1000. Measured: 2e-8, what may be rounding.
    """
    h, scale = 0.25, {0: 1.0, 3: LARGE}[unknown]
    sizes = {4: 1e-3, 5: 1e-3 * x / 18.0, 6: 1e-3 * x ** 2 / 18.0 / 22.0,
             7: 1e-3 * x ** 3 / 18.0 / 22.0 / 26.0}
    S = straight([unknown], {n: scale * sizes[n] for n in seen})
    error, length = MARCH._judged(S, h, (0.0,) * 4, 0.0, (LARGE ** 2,), 0.0)
    assert length == near(x, rel=1e-6)
    assert error == near(3.8e-12 * h * x ** 9 * sizes[7], rel=1e-6)


def test_groups_err_by_their_own_fastest_motion_and_the_step_by_the_sum():
    """The length is that of all together: sums of squares are 1.25 times those of the first."""
    sizes = {4: 1e-3, 6: 1e-3 / 18.0 / 22.0}
    S = straight([0, 3], {})
    S += straight([0], sizes) + straight([3], {n: 0.5 * LARGE * c for n, c in sizes.items()})
    one, length = MARCH._judged(straight([0], sizes), 0.25, (0.0,) * 4, 0.0, (LARGE ** 2,), 0.0)
    both, together = MARCH._judged(S, 0.25, (0.0,) * 4, 0.0, (LARGE ** 2,), 0.0)
    assert both == near(1.5 * one, rel=1e-6)
    assert together == near(length, rel=1e-6)


@pytest.mark.parametrize(('jitter', 'pull', 'converges'), [
    (1e-6, 0.0, False), (1e-6, 1e7, False), (1e-6, 4e7, True), (1e-14, 0.0, True)])
def test_changes_that_no_longer_fall_are_rounding_up_to_a_share_of_what_acts(
        jitter, pull, converges):
    """The rate is 1 in one sweep and 1 + jitter in the next; the share is 2^-44."""
    march = bound('CALLS = []\ndef rate(p, y):\n    CALLS.append(0)\n'
                  '    return 1.0 + p[0] * (len(CALLS) // 8 % 2), 0.0\n',
                  ((0, 1, True), (1, 2, False)))
    control, *_ = room(march)
    *_, used, _, good = march.solve(np.array([jitter, 0.0]), control[WORK:], (0.0, 0.0), 1.0, 1.0,
                                    1, 0.0, pull, (1.0,))
    assert good == converges
    assert used < 5 if good else used == gauss_march.MOST_SWEEPS


@pytest.mark.parametrize(('sweeps', 'used', 'fewer'), [
    (1, 8, False), (7, 8, False), (8, 8, False), (9, 9, True), (10, 10, True)])
def test_one_sweep_less_would_do_where_the_first_look_finds_nearly_no_change(
        sweeps, used, fewer):
    """After n sweeps a step of x = 0.5 rad changes by x^(n + 2)/(n + 2)!.

    That is 5.4e-9, 2.7e-10 and 1.2e-11 after 7, 8 and 9 of them; 1e-9 is allowed, 3e-11 small.
    """
    control, *_ = room()
    _, *found = MARCH.solve(P, control[WORK:], START, 0.25, 0.0, sweeps, 1e-9, 0.0, (LARGE ** 2,))
    assert found == [used, fewer, True]


@pytest.mark.parametrize(('sweeps', 'told'), [(1, 'fl'), (3, 'flll')])
def test_only_the_first_sweep_of_a_step_has_predicted_stages(sweeps, told):
    """The stiff parts are told f of the first one, l of a later one."""
    march = bound('def rate(p, y):\n    return 1.0, 2.0\n', ((0, 1, True), (1, 2, False)),
                  relax='def relax(S, y, h, first):\n'
                        '    S[-1] = 10.0 * S[-1] + (1.0 if first else 2.0)\n')
    control, *_ = room(march)
    march.solve(P, control[WORK:], (0.0, 0.0), 1.0, 1.0, sweeps, 1e-9, 0.0, (1.0,))
    assert f'{control[-1]:.0f}' == told.replace('f', '1').replace('l', '2')


def test_potentials_pull_beside_the_first_relative_group():
    control, *_ = room()
    control[TURNING] = 36.0
    assert MARCH._pull(control, 0.5, (16.0, 25.0)) == 36.0 * 0.5 / 4.0
    assert MARCH._pull(control, 0.5, (0.0,)) == 0.0


@pytest.mark.parametrize(('step', 'number', 'h', 'end', 'expected'), [
    (0.0, 0.5, 0.5, 9.0, (2.5, 0.5)), (0.0, 0.5, 0.5, 2.54, (2.54, 0.54)),
    (0.0, 0.5, 0.5, 2.56, (2.5, 0.5)), (0.0, 0.5, 0.5, 2.25, (2.25, 0.25)),
    (0.25, 4.0, 9.0, 9.0, (2.25, 0.25)), (0.25, 4.0, 9.0, 2.2, (2.2, 0.2)),
    (0.25, 4.0, 9.0, 2.25 + 2e-10, (2.25 + 2e-10, 0.25 + 2e-10)),
    (0.25, 4.0, 9.0, 2.25 + 4e-10, (2.25, 0.25))])
def test_the_last_step_ends_at_the_end_and_fixed_ones_are_counted_from_the_start(
        step, number, h, end, expected):
    """From 2 s on; the start is 1 s, and one fixed step ends less than a billionth before it."""
    control, point, _ = room()
    control[FIXED], control[ORIGIN] = step, 1.0
    point[TIME], point[STEP] = 2.0, number
    found = MARCH._span(control, MARCH._load_point(point), h, end)
    assert found == (near(expected[0], rel=1e-15), near(expected[1], rel=1e-14))


@pytest.mark.parametrize(('error', 'x', 'used', 'converged', 'good', 'factor'), [
    (1.0, 1.0, 5, True, True, SAFETY), (2.0 ** 15, 1.0, 5, True, False, 0.5 * SAFETY),
    (1.3 ** -15, 1.0, 5, True, True, 1.3 * SAFETY), (0.0, 1.0, 5, True, True, GROWTH),
    (1e30, 1.0, 5, True, False, SHRINK), (math.inf, 1.0, 5, True, False, SHRINK),
    (0.0, 0.0, 5, False, False, SHRINK), (0.0, 7.0, 5, True, False, 0.5 * SAFETY),
    (0.0, 0.0, COMFORTABLE, True, True, GROWTH), (0.0, 0.0, COMFORTABLE + 1, True, True, 1.0),
    (0.0, 0.0, COMFORTABLE + 3, True, True, 1.0), (0.0, 0.0, COMFORTABLE + 4, True, True, SAFETY),
    (0.0, 0.0, COMFORTABLE + 4, True, False, GROWTH), (2.0 ** 15, 1.0, 40, True, True, 0.45)])
def test_the_next_step_is_what_error_length_and_sweeps_allow(
        error, x, used, converged, good, factor):
    """Over time errors go with the 15th power of a step; by half an angle of 3.5 rad at most."""
    found = MARCH._factor(error * 1e-9, x, 1e-9, used, converged, good)
    assert found == near(factor, rel=1e-13)


def test_the_stages_of_a_step_are_predicted_by_the_polynomial_through_those_before():
    """Rates of the 7th degree in time are continued without an error, whatever the two steps."""
    control, *_ = room()
    S, h, last = control[WORK:], 0.1, 0.2
    MARCH._prepare(S, h, last)
    places = collocation._places(4)
    matrix = S[places['MATRIX']:][:64].reshape(8, 8).T
    assert matrix == near(h * gauss_nodes.A, rel=1e-15)
    assert near(
        h * gauss_nodes.BETWEEN, rel=1e-15) == S[places['BETWEEN']:][:64].reshape(8, 8).T
    curve = np.polynomial.Polynomial(np.random.default_rng(3).normal(size=8))
    S[places['RATES']:][:8] = curve(-last + last * gauss_nodes.C)
    MARCH._predict(P, S, (5.0, 0.0, 0.0, 0.0), last)
    # measured: 2e-15; 6e-12 where steps are longer, by the rounding of what is continued
    assert S[:8] == pytest.approx(5.0 + curve.integ()(h * gauss_nodes.C), abs=4e-14)
    # without a step before: by the rates at the start
    MARCH._predict(P, S, START, 0.0)
    assert S[8:16] == near(-FAST * h * gauss_nodes.C, rel=1e-14)
    # another step has its own numbers, also where only one of the two is another
    for h, last in ((0.1, 0.15), (0.15, 0.15)):
        MARCH._prepare(S, h, last)
        S[places['RATES']:][:8] = curve(-last + last * gauss_nodes.C)
        MARCH._predict(P, S, (0.0,) * 4, last)
        assert S[:8] == pytest.approx(curve.integ()(h * gauss_nodes.C), abs=2e-11)


@pytest.mark.parametrize('terms', [(3e-9, 4e-9), (-5e-9, 0.0), (0.0, 5e-9), (1e-14, 1e-14)])
def test_a_rough_term_errs_by_its_highest_coefficients(terms):
    """Those of P_14 and P_15, in a step of 1 s; rounding tells nothing, and rates stay."""
    march, p = bound(ROUGH, ((0, 1, True), (1, 2, False))), np.array(terms)
    control, *_ = room(march)
    S = control[WORK:]
    mean, *_ = march.solve(p, S, (0.0, 0.0), 1.0, 0.0, 4, 1e-17, 0.0, (1.0,))
    before = S[march.RATES:][:STAGES * 2].copy()
    found = march.rough(p, S, (0.0, 0.0), 1.0, mean, 0.0, (1.0,), 0.0)
    if abs(terms[0] + terms[1]) < 1e-12:
        assert found == 0.0
    else:
        assert found == near(math.hypot(*terms), rel=1e-6)    # rounding of the rates, 1
        assert march.rough(p, S, (0.0, 0.0), 1.0, mean, 1e12, (1.0,), 0.0) == 0.0
    assert S[march.RATES:][:STAGES * 2].tolist() == before.tolist()
    c = 2.0 * gauss_nodes.C - 1.0
    assert before[:8] == pytest.approx(
        legendre.legval(c, [1.0, *[0.0] * 13, *terms]), abs=1e-15)


def test_the_first_step_is_half_a_radian_of_the_fastest_unknown():
    control, point, _ = room()
    assert point[STEP] == 0.5 / FAST
    assert point[SCALES] == near(LARGE ** 2, rel=1e-15)
    point[VALUES:VALUES + 4] = 0.0
    MARCH.begin(P, control, point)
    assert point[STEP] == UNMOVED
    control[FIXED] = 0.1
    MARCH.begin(P, control, point)
    assert point[STEP] == 0.0
    assert math.isnan(control[WORK + MARCH.FOR_POINT])


@pytest.mark.parametrize('how', [{'step': 0.25}, {'tolerance': 1e-13}])
def test_states_are_those_of_the_oscillators_at_points_and_between(how):
    """Measured: 2.4e-14, a quarter of what is allowed in a second."""
    control, point, following = room(**how)
    size = np.array([1.0, 1.0, LARGE, LARGE])
    for target in (0.1, 0.3, 0.6, 1.7, 1.9, 2.2):
        MARCH.march(P, control, point, following, target, 9.0, 100)
        assert point[TIME] <= target < following[TIME]
        if 'step' in how:
            assert (point[TIME], point[STEP]) == (0.25 * (target // 0.25), target // 0.25)
        for time, y in ((point[TIME], point[VALUES:VALUES + 4]),
                        (following[TIME], following[VALUES:VALUES + 4])):
            assert y / size == pytest.approx(true(time) / size, abs=1e-13)
        for dt in (0.0, target - point[TIME], 0.5 * (following[TIME] - point[TIME])):
            y = MARCH.between(P, control, point, following, dt)
            assert y / size == pytest.approx(true(point[TIME] + dt) / size, abs=1e-13)
    assert MARCH.march(P, control, point, following, 8.0, 4.1, 100)[1]
    assert control[TURNING] == 0.0    # what is given stays
    assert point[TIME] == 4.1
    assert point[VALUES:VALUES + 4] / size == pytest.approx(true(4.1) / size, abs=1e-13)


@pytest.mark.parametrize('share', [1e-3, 0.2, 0.5, 0.9, 1.0])
def test_where_a_shorter_step_does_not_converge_the_polynomial_of_the_step_tells(
        share, monkeypatch):
    """It errs by the ninth power of half a radian over 9 9!, about.

    Of a body at rest the rates are rounding: a step that is settled at once may be so long that
    substitution diverges, and 45 sweeps of a shorter one make radians of rounding.
    """
    control, point, following = room(step=0.25)
    MARCH.march(P, control, point, following, 0.1, 9.0, 100)
    assert (point[TIME], following[TIME]) == (0.0, 0.25)
    monkeypatch.setattr(MARCH, 'solve', lambda *_: ((1e3,) * 4, 45, False, False))
    size = np.array([1.0, 1.0, LARGE, LARGE])
    y = MARCH.between(P, control, point, following, 0.25 * share)
    assert y / size == pytest.approx(true(0.25 * share) / size, abs=1e-12)    # measured: 1.7e-13


def test_a_march_pauses_after_so_many_steps_and_goes_on_with_the_same_bits():
    whole, parts = room(tolerance=1e-13), room(tolerance=1e-13)
    assert MARCH.march(P, *whole, 3.0, 9.0, 100) == (sum(
        MARCH.march(P, *parts, 3.0, 9.0, 1)[0] for _ in range(40)), True)
    for one, other in zip(whole[1:], parts[1:], strict=True):
        assert one[:MARCH.KEPT].tobytes() == other[:MARCH.KEPT].tobytes()
    assert whole[1][MARCH.LAST] > 0.0 and whole[1][MARCH.SWEEPS] >= 1.0


def one_step(monkeypatch, solved, judged, factor, end=9.0, limits=(0.0, 1e-9), hides=0.0):
    """Return (what `_step` returned, (h, last, sweeps, allowed) of its attempts), with made parts.

    From 2 s on, after a step of 0.75 s; 0.5 s are planned, and 6 sweeps.
    """
    control, point, _ = room(tolerance=limits[1])
    control[TURNING], tried = limits[0], []
    point[TIME], point[STEP], point[MARCH.LAST], point[MARCH.SWEEPS] = 2.0, 0.5, 0.75, 6.0

    def solve(p, S, y, h, last, sweeps, allowed, pull, scales):
        tried.append((h, last, sweeps, allowed))
        return ((0.0,) * 4, *solved[len(tried) - 1])
    monkeypatch.setattr(MARCH, 'solve', solve)
    monkeypatch.setattr(MARCH, '_judged', lambda *_: judged[len(tried) - 1])
    monkeypatch.setattr(MARCH, '_factor', lambda *_: factor)
    monkeypatch.setattr(MARCH, 'hidden', lambda *_: hides if len(tried) == 1 else 0.0)
    return MARCH._step(P, control, MARCH._load_point(point), end), tried


@pytest.mark.parametrize(('factor', 'end', 'expected'), [
    (1.0, 9.0, 0.5), (1.04, 9.0, 0.5), (1.06, 9.0, 0.53), (0.9, 9.0, 0.45), (1.5, 9.0, 0.75),
    (1.04, 2.5, 0.52)])
def test_a_step_stays_where_another_one_would_hardly_be_longer(factor, end, expected, monkeypatch):
    """Up to 5 %; behind the end none follows, and what was planned is kept for what does."""
    (found, good), tried = one_step(monkeypatch, [(6, False, True)], [(1e-12, 1.0)], factor, end)
    assert good and (found.time, found.last) == (2.5, 0.5)
    assert found.step == near(expected, rel=1e-15)
    assert tried == [(0.5, 0.75, 6, 0.5e-9)]


@pytest.mark.parametrize(('used', 'fewer', 'sweeps'), [
    (6, False, 6), (6, True, 5), (1, True, 1), (2, True, 1)])
def test_the_next_step_has_a_sweep_less_where_one_less_would_do(
        used, fewer, sweeps, monkeypatch):
    (found, _), _ = one_step(monkeypatch, [(used, fewer, True)], [(1e-12, 1.0)], 1.5)
    assert found.sweeps == sweeps


@pytest.mark.parametrize('bad', [(0.6e-9, 0.0, 1.0, True), (1e-12, 0.6e-9, 1.0, True),
                                 (0.0, 0.0, 3.6, True), (0.0, 0.0, 1.0, False)])
def test_a_step_that_errs_or_turns_too_much_or_does_not_converge_is_tried_shorter(
        bad, monkeypatch):
    """The rates of the step before are gone then; 5e-10 is allowed, and half an angle of 3.5."""
    error, hides, x, converged = bad
    (found, good), tried = one_step(
        monkeypatch, [(6, True, converged), (6, False, True)], [(error, x), (1e-12, 1.0)], 0.5,
        hides=hides)
    assert good and (found.time, found.last, found.step, found.sweeps) == (2.25, 0.25, 0.125, 6)
    assert tried == [(0.5, 0.75, 6, 0.5e-9), (0.25, 0.0, 6, 0.25e-9)]


def test_terms_that_nearly_cancel_allow_a_step_their_rounding(monkeypatch):
    """2^-57 of what potentials can do, 1e12 * 0.5 beside 1000."""
    _, tried = one_step(
        monkeypatch, [(6, False, True)], [(0.0, 1.0)], 1.5, limits=(1e12, 1e-9))
    assert tried[0][3] == near(2.0 ** -57 * 5e8, rel=1e-14)


@pytest.mark.parametrize(('last', 'dt', 'sweeps'), [
    (1.0, 0.5, 4), (1.0, 0.99, 8), (1.0, 0.1, 1), (2.0, 0.5, 2), (0.0, 0.5, 1)])
def test_a_shorter_step_between_points_has_its_share_of_the_sweeps(last, dt, sweeps, monkeypatch):
    """Of the 9 of the step from the point, where one leads there; without any it has one.

    The last sweep may change a 1/128 of what a step of that length may err by.
    """
    given = []

    def solve(p, S, y, h, before, sweeps, allowed, pull, scales):
        given.append((h, before, sweeps, allowed))
        return (1.0, 2.0, 3.0, 4.0), 0, False, True
    monkeypatch.setattr(MARCH, 'solve', solve)
    control, point, following = room(tolerance=1e-9)
    point[MARCH.LAST], point[MARCH.SWEEPS], following[MARCH.LAST] = last, 9.0, 1.5
    found = MARCH.between(P, control, point, following, dt)
    assert given == [(dt, last, sweeps, 2.0 ** -7 * 1e-9 * dt)]
    assert found == near([y + dt * k for y, k in zip(START, (1, 2, 3, 4), strict=True)], rel=1e-15)


@pytest.mark.parametrize(('tail', 'tolerance', 'along'), [
    (3.8e-12, 1e-9, True), (1e-18, 0.0, False), (0.5e-18, 0.0, True), (4.0e-12, 1e-9, False)])
def test_the_curve_is_taken_where_its_last_coefficients_are_allowed_or_rounding(
        tail, tolerance, along, monkeypatch):
    """Allowed is 1/128 of the tolerance for the step of 0.5 s; rounding is 2^-60, 0.9e-18."""
    monkeypatch.setattr(MARCH, 'solve', lambda *_: ((0.0,) * 4, 0, False, True))
    monkeypatch.setattr(MARCH, 'along', lambda S, y, part: part)
    control, point, following = room(tolerance=tolerance)
    point[MARCH.LAST] = following[MARCH.LAST] = 0.5
    control[WORK + MARCH.FOR_POINT], control[WORK + MARCH.TAIL] = point[TIME], tail
    assert (MARCH.between(P, control, point, following, 0.2) == 0.4) == along


def test_the_curve_of_a_step_is_the_polynomial_through_the_rates_of_two_steps():
    """Rates of the 15th degree in time have their integrals, unknown by unknown."""
    _, point, following = room()
    S, h = np.zeros(collocation._end(collocation._places(4))), 0.5
    curves = [np.polynomial.Polynomial(row) for row in
              np.random.default_rng(5).normal(size=(4, 16))]
    for u, curve in enumerate(curves):
        point[MARCH.KEPT + STAGES * u:][:STAGES] = curve(gauss_nodes.C - 1.0)
        following[MARCH.KEPT + STAGES * u:][:STAGES] = curve(gauss_nodes.C)
    for _ in range(2):    # what stood there does not count
        MARCH._lay_curve(S, point, following, h)
    for part in (0.0, 0.3, 1.0):
        found = MARCH.along(S, START, part)
        # measured: 1.6e-15
        assert found == pytest.approx(
            [y + h * curve.integ()(part) for y, curve in zip(START, curves, strict=True)],
            abs=1e-14)
