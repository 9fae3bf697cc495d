# SPDX-License-Identifier: Apache-2.0
"""Where a watched number falls below zero, on made-up ones that are functions of the step."""

import math

import numpy as np
import pytest
from near import near

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.integrators.equations.contact_views import FLIGHT, ROLLING, ROW, UNKNOWNS
from rigid_body_sim.integrators.marching import contact_step, contact_zero
from rigid_body_sim.integrators.marching.contact_zero import END, FRESH, MODE, NORMAL, WATCHED
from rigid_body_sim.mechanics.contact.parameters import CONTACT

pytestmark = pytest.mark.without_numba

TIME = UNKNOWNS.part('time').first
GRIP = NORMAL + 1
ZERO = specialise(
    contact_zero,
    rate=f'def rate(p, y, row):\n    for k in range({ROW.part("watched").size}):\n'
         f'        row[{WATCHED} + k] = p[{CONTACT.size}][k](y[{TIME}])\n',
    step_from=f'def step_from(p, w, y, lost, h):\n    w[{FRESH}, {TIME}] = y[{TIME}] + h\n'
              f'    p[{CONTACT.size + 1}].append(h)\n')


def first_zero(function, h=1.0, mode=ROLLING, k=NORMAL):
    """Return what first_zero finds of a function of time in a step from 2 s on, and its looks."""
    looks, start = [], np.zeros(UNKNOWNS.size)
    start[TIME] = 2.0
    watched = [lambda time: math.nan] * ROW.part('watched').size
    watched[k] = function
    p = [0.0] * CONTACT.size + [watched, looks]
    p[MODE] = mode
    w = np.zeros((contact_step.WORK_ROWS, ROW.size))
    found = ZERO.first_zero(p, w, start, start, h, k, function(2.0))
    assert looks[:1] == [h / 16.0]
    return found, looks


@pytest.mark.parametrize('h', [1.0, 0.1])
@pytest.mark.parametrize(('place', 'power'), [
    (0.5, 1), (1e-3, 1), (0.999, 1), (0.3, 3), (0.7, 9), (1.0 / 3.0, 1)])
def test_a_zero_is_the_first_double_at_which_the_number_is_below_it(place, power, h):
    def function(time):
        x = place * h - (time - 2.0)
        return math.copysign(abs(x) ** power, x)
    found, looks = first_zero(function, h)
    assert function(2.0 + found) < 0.0
    assert found == near(place * h, rel=1e-15) or function(2.0 + math.nextafter(found, 0.0)) >= 0.0
    # measured: 25 of a straight one, 58 if a look falls on its zero, 90 of the ninth power
    assert len(looks) < (40 if power == 1 and place != 0.5 else 16 + contact_zero.BISECTIONS)


@pytest.mark.parametrize('begin', [0.0, 1e-3, -0.1])
def test_what_begins_at_zero_has_to_rise_before_it_falls(begin):
    """4 x (0.8 - x) falls below it at the later root."""
    def function(time):
        x = time - 2.0
        return begin if x == 0.0 else 4.0 * x * (0.8 - x)
    where, _ = first_zero(function)
    assert where == pytest.approx(0.8, abs=4e-16)


def test_what_only_rises_has_no_zero():
    found, looks = first_zero(lambda time: (time - 2.0) ** 2)
    assert found == -1.0
    assert looks == [n / 16.0 for n in range(1, 17)]


@pytest.mark.parametrize('place', [0.03, 0.2, 0.53, 0.97])
@pytest.mark.parametrize('side', [0.01, 1e-3])
def test_a_dip_between_two_looks_is_searched_through_to_its_first_zero(place, side):
    """A parabola about `place` that is below zero by `side` on either side of it."""
    found, _ = first_zero(lambda time: (time - 2.0 - place) ** 2 - side ** 2)
    assert found == near(place - side, rel=1e-12)    # the rounding of time, 4e-16/place
    found, looks = first_zero(lambda time: (time - 2.0 - place) ** 2 + side ** 2)
    assert found == -1.0
    assert len(looks) == 16 + 2 * 24
    last = looks[-1]
    assert last == pytest.approx(place, abs=2e-6)    # golden: 0.125 0.618^24 = 1.2e-6


def test_a_dip_is_searched_for_around_the_least_of_the_looks():
    """Another one before it, that is wider, stays above zero."""
    found, _ = first_zero(lambda time: min(
        (time - 2.2) ** 2 + 0.01, (time - 2.8) ** 2 - 1e-4))
    assert found == near(0.79, rel=1e-12)


@pytest.mark.parametrize('until', [0.4, 0.9])
def test_a_gap_that_is_watched_as_zero_below_zero_fell_before(until):
    """Of a flight: the gap 0.3 - x is below zero from 0.3 on, 0 from where it grows again, 0.31.

    Of what else is watched a zero is not below zero.
    """
    def gap(time):
        x = time - 2.0
        return 0.0 if 0.31 < x < until else 0.3 - x
    found, looks = first_zero(gap, mode=FLIGHT)
    assert found == pytest.approx(0.3, abs=4e-16)
    assert len(looks) < 20    # measured: 12
    for mode, k in ((ROLLING, NORMAL), (FLIGHT, GRIP)):
        found, _ = first_zero(gap, mode=mode, k=k)
        assert found == pytest.approx(until, abs=4e-16)


@pytest.mark.parametrize('since', [0.515, 0.511])
def test_a_gap_that_is_watched_as_zero_is_searched_before_it_in_a_dip(since):
    """Between two looks it falls below zero at 0.51, soon is 0, and 0.2 from 0.56 on."""
    def gap(time):
        x = time - 2.0
        if since < x < 0.56:
            return 0.0
        return 0.51 - x if x <= since else 0.2
    found, _ = first_zero(gap, mode=FLIGHT)
    assert found == pytest.approx(0.51, abs=4e-16)


def test_a_gap_that_touches_the_plane_in_one_look_and_is_above_it_elsewhere_has_no_zero():
    found, looks = first_zero(lambda time: abs(time - 2.25), mode=FLIGHT)
    assert found == -1.0
    assert len(looks) < 16 + 60 + 2 * 24    # a double has 53 digits; measured: 115


def test_the_number_is_looked_at_where_the_step_ends():
    looks, w = [], np.zeros((contact_step.WORK_ROWS, ROW.size))
    p = [0.0] * CONTACT.size + [[lambda time: time * time, lambda time: -time] * 3, looks]
    y = np.full(UNKNOWNS.size, 3.0)
    assert ZERO.look(p, w, y, y, 0.5, 0) == 3.5 ** 2
    assert ZERO.look(p, w, y, y, 0.25, 1) == -3.25
    assert looks == [0.5, 0.25]
    assert w[END, WATCHED:WATCHED + 2].tolist() == [3.25 ** 2, -3.25]
