# SPDX-License-Identifier: Apache-2.0
"""A step of taylor's march by itself: what its sums carry, where it ends, how long it is."""

import math
from fractions import Fraction

import numpy as np
import pytest
from data import smooth_cases
from near import near

from rigid_body_sim.integrators.families import power_series
from rigid_body_sim.integrators.marching import taylor_march
from rigid_body_sim.integrators.marching.points import (
    LOST,
    ORIGIN,
    PAUSED,
    REACHED,
    SCALES,
    STEP,
    TIME,
    VALUES,
)
from rigid_body_sim.integrators.marching.taylor_series import ORDER, Turning
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.scene.scene import parse_scene

Q = np.array([0.1, -0.5, 0.7, 0.5])      # its norm is 1 to the last bit
OMEGA = [1.0, -2.0, 0.5]


def marching(step=None, accuracy=None):
    """Return (march module, parameters, control, point, following) of a body under a torque."""
    scene = parse_scene(smooth_cases.text('driven_body'))
    stepped = Stepped(scene, 'taylor', step=step, accuracy=accuracy, horizon=1.0)
    equations = power_series.equations_of(scene, None)
    march = power_series.march(stepped.method, equations, True)
    control, point = power_series.begin(stepped, march)
    parameters = equations.held(0.0)
    point[VALUES:VALUES + 7] = [*Q, *OMEGA]
    march.begin(parameters, control, point)
    return march, parameters, control, point, point.copy()


def one_step(lost, **how):
    """Return the sum of value and loss of each unknown after one step, exactly."""
    march, p, control, point, following = marching(**how)
    point[VALUES + 7:VALUES + 14] = lost
    moved, good = march.march(p, control, point, following, 0.05, 10.0, 1)
    assert good
    end = point if moved else following
    return [Fraction(float(value)) + Fraction(float(rest))
            for value, rest in zip(end[VALUES:VALUES + 7], end[VALUES + 7:VALUES + 14],
                                   strict=True)]


@pytest.mark.parametrize('unknown', range(7))
def test_what_a_sum_has_lost_is_carried_on_in_each_unknown(unknown):
    """It is added to the end of the step; of q the part along q is taken by the norm.

    2^-50 is 64 ulps of the change of a step, a tenth.
    """
    lost = np.zeros(7)
    lost[unknown] = 2.0 ** -50
    before, after = one_step(np.zeros(7), step=0.1), one_step(lost, step=0.1)
    change = [float((b - a) * 2 ** 50) for a, b in zip(before, after, strict=True)]
    expected = np.eye(7)[unknown]
    if unknown < 4:
        q = np.array([float(value) for value in before[:4]])
        expected[:4] -= Q[unknown] * q
    assert change == pytest.approx(expected, abs=0.05)


def test_the_norm_of_the_quaternion_comes_back_to_one():
    """It lacks 2^-50 of it at the start of the step."""
    march, p, control, point, following = marching(step=0.1)
    point[VALUES:VALUES + 4] *= 1.0 - 2.0 ** -50
    march.march(p, control, point, following, 0.05, 10.0, 1)
    norm = math.fsum([*(x * x for x in following[VALUES:VALUES + 4]),
                      *(2.0 * x * c for x, c in zip(following[VALUES:VALUES + 4],
                                                    following[VALUES + 7:VALUES + 11],
                                                    strict=True)), -1.0])
    assert abs(norm) < 2.0 ** -54


def test_fixed_steps_are_counted_from_the_start_and_the_last_one_ends_at_the_end():
    march, p, control, point, following = marching(step=0.1)
    times = []
    for target in (0.05, 0.15, 0.22):
        march.march(p, control, point, following, target, 0.25, 100)
        times.append((float(point[TIME]), float(following[TIME])))
    assert times == [(0.0, 0.1), (0.1, 0.2), (0.2, 0.25)]
    assert march.march(p, control, point, following, 0.24, 0.25, 100) == (0, True)
    assert march.march(p, control, point, following, 0.25, 0.25, 100) == (1, True)
    assert point[TIME] == 0.25
    # an end that close to a point is that point
    march, p, control, point, following = marching(step=0.1)
    march.march(p, control, point, following, 0.15, 0.2 + 1e-12, 100)
    assert following[TIME] == 0.2 + 1e-12


def test_a_march_pauses_after_as_many_steps_as_it_may_take():
    march, p, control, point, following = marching(step=0.1)
    assert march.march(p, control, point, following, 0.55, 10.0, 2) == (2, True)
    assert (point[TIME], following[TIME]) == (0.2, near(0.3, rel=1e-15))
    assert march.march(p, control, point, following, 0.55, 10.0, 9) == (3, True)    # one is known


@pytest.mark.parametrize(('time', 'rate'), [(1e17, 1.0), (0.0, 1e200)])
def test_a_step_that_does_not_move_time_or_gives_no_number_is_not_good(time, rate):
    """A tenth of a second is nothing beside 1e17 s; 1e200 rad/s have no square."""
    march, p, control, point, following = marching(step=0.1)
    point[TIME] = control[ORIGIN] = time
    point[VALUES + 4:VALUES + 7] = rate, 0.0, 0.0
    with np.errstate(all='ignore'):
        assert march.march(p, control, point, following, 1e18, 1e19, 10) == (0, False)
    assert following[TIME] == point[TIME] == time


@pytest.mark.parametrize(('before', 'rate', 'scale'), [(0.0, 3.0, 9.0), (30.0, 3.0, 30.0),
                                                       (0.0, 0.0, None)])
def test_the_scale_is_the_largest_square_of_a_rate_so_far_or_what_acts_on_a_body_at_rest(
        before, rate, scale):
    march, p, control, point, following = marching(step=0.01)
    point[SCALES], point[VALUES + 4:VALUES + 7] = before, (rate, 0.0, 0.0)
    march.march(p, control, point, following, 0.0, 10.0, 1)
    rates = control[march.WORK:][march.PLACES:][4:7]    # those of omega
    assert following[SCALES] == (scale or near(math.sqrt(rates @ rates), rel=1e-15))
    assert following[SCALES] > 0.0


@pytest.mark.parametrize(('room', 'ends'), [(1.05, True), (1.15, False)])
def test_a_step_that_leaves_less_than_a_tenth_of_itself_goes_to_the_end(room, ends):
    march, p, control, point, following = marching(accuracy=1e-9)
    march.march(p, control, point, following, 0.0, 100.0, 1)
    length = following[TIME]
    march, p, control, point, following = marching(accuracy=1e-9)
    march.march(p, control, point, following, 0.0, room * length, 1)
    assert following[TIME] == (room * length if ends else length)


def test_the_first_step_makes_the_last_term_what_the_tolerance_allows():
    """c_16 h^16 = tolerance h where the term before it is smaller."""
    march, p, control, point, following = marching(accuracy=1e-9)
    march.march(p, control, point, following, 0.0, 100.0, 1)
    h, S = float(following[TIME]), control[march.WORK:].reshape(-1, march.PLACES)
    scale = 5.25
    assert point[SCALES] == scale

    def size(order):
        q, omega = S[order, :4], S[order, 4:7]
        return math.sqrt(q @ q + omega @ omega / scale)
    larger = max(size(ORDER) * h ** ORDER, size(ORDER - 1) * h ** (ORDER - 1))
    assert 0.5 < larger / (power_series.SAFETY * 1e-9 * h) < 1.5
    assert following[STEP] > 0.0


def test_between_two_points_is_the_series_of_the_first():
    march, p, control, point, following = marching(step=0.1)
    march.march(p, control, point, following, 0.05, 10.0, 1)
    assert march.between(p, control, point, following, 0.0) == (*Q, *OMEGA)
    half = march.between(p, control, point, following, 0.05)
    other, q, c, begin, _ = marching(step=0.05)
    after = begin.copy()
    other.march(q, c, begin, after, 0.02, 10.0, 1)
    assert half == pytest.approx(after[VALUES:VALUES + 7], abs=1e-15)
    # another series stands in the working numbers: it is made anew
    control[march.FOR] = math.nan
    control[march.WORK:] = 7.0
    assert march.between(p, control, point, following, 0.05) == half


@pytest.mark.without_numba
@pytest.mark.parametrize('planned', [0.5, 2.0])
@pytest.mark.parametrize('counts', ['final', 'before'])
@pytest.mark.parametrize(('share', 'rel'), [
    (1.0, 1e-14), (1.1, 1e-8), (0.9, 1e-8), (2.0, 1e-4), (0.07, 0.01), (15.0, 0.01),
    (0.06, None), (17.0, None), (1e-9, None), (1e12, None), (1e-60, None)])
def test_a_step_is_as_planned_where_its_terms_are_nearly_what_is_allowed(
        planned, counts, share, rel):
    """Within a factor of 16 of their squares; then the plan follows six tenths of the way.

    That is by a rational function, near 1 the power. Else the step is chosen anew, 4 times the
    plan at most. The larger term counts, the last one by the plan.
    """
    tolerance = 1e-9
    square = share * tolerance ** 2 / planned ** (2 * (ORDER - 2))
    terms = {'final': (square / planned ** 2, 0.9 * square),
             'before': (0.9 * square / planned ** 2, square)}[counts]
    h, plan = taylor_march.chosen(*terms, tolerance, planned)
    asked = share ** (-0.5 / (ORDER - 2))
    if rel:
        assert h == planned
        # measured: 1e-16, 1.4e-9 and 1.6e-5; 7e-3 at the ends
        assert plan == near(planned * asked ** 0.6, rel=rel)
    else:
        assert h == plan == near(planned * min(4.0, asked), rel=1e-13)


@pytest.mark.without_numba
def test_the_first_step_is_what_the_last_term_allows_and_all_is_where_nothing_moves():
    final, tolerance = 1e-3, 1e-9
    first = (tolerance ** 2 / final) ** (0.5 / (ORDER - 1))
    assert taylor_march.chosen(final, 0.0, tolerance, 0.0) == (
        near(first, rel=1e-14), near(first, rel=1e-14))
    assert taylor_march.chosen(0.0, 0.0, tolerance, 0.0) == (1e-3, 1e-3)
    assert taylor_march.chosen(0.0, 0.0, tolerance, 0.25) == (1.0, 1.0)


@pytest.mark.without_numba
def test_unknowns_are_finite_where_their_squares_are():
    for value, finite in ((1e150, True), (1e200, False), (math.nan, False)):
        for turning in (Turning((0.0,) * 4, (0.0, value, 0.0)),
                        Turning((value, 0.0, 0.0, 0.0), (0.0,) * 3)):
            assert taylor_march._is_finite(turning) == finite


@pytest.mark.without_numba
def test_the_terms_of_omega_count_beside_their_scale():
    """Of q (1, 2, 3, 4) and of omega (5, 6, 7), whose squared scale is 4 or nothing yet."""
    S = np.zeros(taylor_march.ROOM)
    S[taylor_march.PLACES * 2:][:7] = np.arange(1.0, 8.0)
    assert taylor_march._square(S, 2, 0.25) == 30.0 + 0.25 * 110.0
    S[:] = 0.0
    S[taylor_march.PLACES * ORDER:][:7] = np.arange(1.0, 8.0) * 1e-6
    S[taylor_march.PLACES * (ORDER - 1):][:7] = np.arange(1.0, 8.0) * 2e-6
    for scale, weight in ((4.0, 0.25), (1e-301, 0.0)):
        square = 30.0 + weight * 110.0
        assert taylor_march._last_terms(S, scale) == near(
            (square * 1e-12, square * 4e-12), rel=1e-14)


@pytest.mark.without_numba
@pytest.mark.parametrize('planned', [0.0, 0.5, 2.0])
@pytest.mark.parametrize(('final', 'before'), [
    (1e-3, 0.0), (1e-3, 1e-3), (1e-8, 1e-1), (1e-290, 1e-1), (1e-17, 1e-17), (1e2, 1e5)])
def test_what_leads_beyond_a_time_is_longer_and_what_is_much_longer_leads_beyond(
        planned, final, before):
    tolerance = 1e-9
    h, _ = taylor_march.chosen(final, before, tolerance, planned)
    for share in (1e-3, 0.5, 0.85, 0.95, 0.97, 1.0, 1.5, 10.0):
        dt = share * h
        leads = taylor_march._leads_beyond(final, before, tolerance, planned, dt)
        assert not leads or h > taylor_march.BY * dt
        if share <= (0.85 if planned == 0.0 else 1.0 / taylor_march.GROWTH):
            assert leads
    for nothing in (0.0, 1e-301, math.nan):    # the first step is a fixed one
        assert not taylor_march._leads_beyond(nothing, 0.0, tolerance, planned, 1e-3 * h)


@pytest.mark.without_numba
@pytest.mark.parametrize('accuracy', [1e-3, 1e-9])
def test_a_march_without_points_has_the_bits_of_the_march_on_and_beside_its_points(accuracy):
    """At 2^50 s the digits of time are steps of 0.25 s: one of 0.33 s ends at the next digit."""
    for begin in (0.0, 1e6, 2.0 ** 50):
        march, p, control, point, following = marching(accuracy=accuracy)
        start, times = point.copy(), []
        start[TIME] = point[TIME] = control[ORIGIN] = begin
        for _ in range(3):
            march.march(p, control, point, following, point[TIME], math.inf, 1)
            length = following[TIME] - point[TIME]
            times += [point[TIME] + share * length for share in (0.0, 0.3, 0.97)]
            times += [math.nextafter(following[TIME], side) for side in (0.0, math.inf)]
            march.march(p, control, point, following, following[TIME], math.inf, 1)
        for time in times:
            point[:], following[TIME] = start, start[TIME]
            march.march(p, control, point, following, time, math.inf, 10)
            between = march.between(p, control, point, following, time - point[TIME])
            assert march.arrive(p, control, start.copy(), time, 10) == (REACHED, between)
    assert march.arrive(p, control, start.copy(), times[-1], 2)[0] == PAUSED


@pytest.mark.without_numba
@pytest.mark.parametrize(('begin', 'rate'), [(1e17, 1.0), (0.0, 1e160), (0.0, 1e200)])
def test_a_march_without_points_is_lost_where_no_step_is_good(begin, rate):
    march, p, control, point, _ = marching(accuracy=1e-9)
    point[TIME], point[VALUES + 4] = begin, rate
    with np.errstate(all='ignore'):
        assert march.arrive(p, control, point, begin + 64.0, 9)[0] == LOST


@pytest.mark.without_numba
@pytest.mark.parametrize(('how', 'final'), [
    ({'accuracy': 1e-9}, 'without_points'), ({'step': 0.1}, 'in_steps')])
def test_a_final_state_needs_no_points_unless_steps_are_fixed(how, final):
    scene = parse_scene(smooth_cases.text('driven_body'))
    track = Stepped(scene, 'taylor', **how).at(how.get('accuracy'))._bound.track
    assert track.final is getattr(track, final)
