# SPDX-License-Identifier: Apache-2.0
"""What the anchor of a top is made of: lengths in imaginary time, phases, tops that stay."""

import cmath
import itertools
import math
import types

import numpy as np
import pytest
from mpmath import elliprf
from near import near
from tops import HEAVY, ROUND, anchored

from rigid_body_sim.motions.lagrange_top import lagrange_top as motion
from rigid_body_sim.motions.lagrange_top.anchor import (
    _angle,
    _lengths,
    _rf_or_never,
    _starting_phases,
    _stays,
    quotient,
)
from rigid_body_sim.motions.lagrange_top.theta import Klein

pytestmark = pytest.mark.without_numba

ONE, NONE = (0.6, 0.8), (0.0, 0.0)


@pytest.mark.parametrize('zeros', [*itertools.product((False, True), repeat=3)])
def test_the_integral_of_carlson_is_finite_where_no_two_arguments_vanish(zeros):
    """Else it takes others, which are all positive."""
    given = tuple(0.0 if zero else size for zero, size in zip(zeros, (0.3, 2.0, 5.0), strict=True))
    finite, taken = _rf_or_never(*given)
    assert finite == (sum(zeros) < 2)
    assert taken == given if finite else min(taken) > 0.0


@pytest.mark.parametrize(('first', 'second'), [
    ((0.3, 2.0, 5.0), (1.0, 0.0, 0.2)), ((0.0, 0.0, 5.0), (1.0, 4.0, 0.2)),
    ((0.3, 2.0, 5.0), (1.0, 0.0, 0.0)), ((0.0, 1.0, 0.0), (0.0, 0.0, 0.0))])
def test_a_length_is_infinite_where_its_integral_is_and_none_where_its_root_vanishes(
        first, second):
    lengths = [float(math.sqrt(root) * elliprf(*of)) if sum(x == 0.0 for x in of) < 2
               else math.inf for root, of in ((0.7, first), (3.0, second))]
    assert _lengths(0.7, first, 3.0, second) == near(lengths, rel=1e-15)    # 2e-16
    assert _lengths(0.0, first, 3.0, second) == near([0.0, lengths[1]], rel=1e-15)
    assert _lengths(0.7, first, 0.0, second) == near([lengths[0], 0.0], rel=1e-15)


@pytest.mark.parametrize(('a', 'b', 'omega', 'n', 'k', 'stays'), [
    (ONE, NONE, NONE, 0.0, 4.0, True), (NONE, ONE, NONE, 0.0, 4.0, True),
    (ONE, ONE, NONE, 0.0, 0.0, True), (ONE, ONE, NONE, 0.0, 4.0, False),
    (ONE, (1.0, 0.0), NONE, 0.0, 4.0, False), (ONE, (0.0, 1.0), NONE, 0.0, 4.0, False),
    ((1.0, 0.0), ONE, NONE, 0.0, 4.0, False), ((0.0, 1.0), ONE, NONE, 0.0, 4.0, False),
    (ONE, NONE, (1e-300, 0.0), 0.0, 4.0, False), (ONE, NONE, (0.0, 1e-300), 0.0, 4.0, False),
    (ONE, NONE, NONE, 1e-300, 4.0, False), (ONE, ONE, NONE, 1e-300, 0.0, False)])
def test_a_top_at_rest_stays_upright_hanging_or_without_weight(a, b, omega, n, k, stays):
    assert _stays(Klein(a, b, omega), (n, 0.0), (k, 0.0)) == stays


@pytest.mark.parametrize('sizes', [(1.0, 1.0), (1e-300, 1.0), (1e-300, 1e-320), (1e300, 1e300)])
@pytest.mark.parametrize('turns', [0.0, 0.1, -0.3, 0.5])
def test_the_angle_between_two_numbers_does_not_depend_on_their_size(sizes, turns):
    back = 0.6 - 0.8j
    to = back * cmath.exp(2j * math.pi * turns)
    found = _angle(*((size * z.real, size * z.imag) for size, z in zip(
        sizes, (to, back), strict=True)))
    # measured: 1e-17, and 1e-4 of the last digits that are left at 1e-320
    assert math.remainder(found - turns, 1.0) == pytest.approx(
        0.0, abs=1e-3 if 1e-320 in sizes else 1e-16)
    assert _angle(NONE, ONE) == _angle(ONE, NONE) == 0.0


@pytest.mark.parametrize(('a', 'b'), [(0.1, 0.3), (-0.4, 0.2), (0.45, -0.45), (0.0, 1.2)])
@pytest.mark.parametrize('hidden', ['a', 'b', 'omega'])
def test_the_phases_at_the_start_come_from_the_two_functions_that_are_not_near_zero(
        a, b, hidden):
    """That of omega_c is that of b less that of a, so that any two tell all."""
    periodic = {'a': 0.3 + 0.2j, 'b': -0.1 + 0.7j, 'omega': 2.0 - 1.0j}
    shares = {'a': 0.5, 'b': 0.6, 'omega': 0.7, hidden: 1e-3}
    start = {name: z * cmath.exp(2j * math.pi * turns) for (name, z), turns in zip(
        periodic.items(), (a, b, b - a), strict=True)}
    start[hidden] *= 1j    # by rounding
    roots = types.SimpleNamespace(
        x=(2.0 * shares['a'], 1e-17), x2=(2.0, 3e-16), y=(3.0 * shares['b'], 1e-17),
        y1=(3.0, 3e-16),
        w=5.0 * shares['omega'], w1=5.0)
    found = _starting_phases(*(Klein(*((z.real, z.imag) for z in of.values()))
                               for of in (start, periodic)), roots)
    assert [math.remainder(phase - turns, 1.0) for phase, turns in zip(
        found, (a, b), strict=True)] == pytest.approx([0.0, 0.0], abs=1e-15)    # 1e-16
    assert max(map(abs, found)) <= 0.5


def test_a_tiny_tilt_at_the_threshold_is_not_seen_to_nod():
    """Its u' stays near the square root of the cube of 1e-200, beside rates of 1/s."""
    _, anchor = anchored(ROUND, [1e-200, 0.0, 0.0, 1.0], (0.0, 0.0, 2.0))
    assert motion.next_event(anchor, 0.0) == (math.inf, 0)


@pytest.mark.parametrize(('body', 'orientation', 'omega'), [
    (HEAVY, (0.1, 0.5, -0.3, 0.8), (3.0, -7.0, 20.0)), (ROUND, (0.0, 0.6, 0.0, 0.8), (
        0.3, 0.1, 0.7))])
def test_no_turning_point_is_left_out_or_told_twice(body, orientation, omega):
    """Also where a time is the last one before it, or its own."""
    _, anchor = anchored(body, orientation, omega)
    times = [motion.turning_time(anchor, motion.turning_index(anchor, 0.0) + k)
             for k in range(1, 200)]
    assert np.diff(times).min() > 0.0
    for before, time in itertools.pairwise(times):
        assert [motion.next_event(anchor, after) for after in (
            before, math.nextafter(before, math.inf), 0.5 * (before + time),
            math.nextafter(time, 0.0))] == 4 * [(time, 0)]


@pytest.mark.parametrize(('a', 'b', 'found'), [
    (3.0, 1.0, 3.0), (3.0, -2.0, -1.5), (3.0, 0.0, 0.0)])
def test_a_share_of_nothing_is_none(a, b, found):
    assert quotient(a, b) == found
