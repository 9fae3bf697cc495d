# SPDX-License-Identifier: Apache-2.0
"""The quadrature's rules, panel by panel: what it adds, and what it says of the next length."""

import itertools
import math

import numpy as np
import pytest
from near import near

from rigid_body_sim.mechanics import panels
from rigid_body_sim.mechanics.panels import (
    AT_ENDS,
    COLUMNS,
    ENERGY,
    KEPT,
    LONGER,
    LOST,
    MOMENTUM,
    NODES,
    NOISE,
    OMEGA,
    PLACES,
    POINTS,
    SHORTER,
    SUMS,
    TAILS,
    TURNED,
    WEIGHTS,
    add_panels,
)


def rates_of(functions, edges, speed=0.0, noise=0.0):
    """Return the rates of panels: one function of time for each of the five entries, |omega|."""
    rates = np.zeros((POINTS * (len(edges) - 1), COLUMNS))
    for k, (begin, end) in enumerate(itertools.pairwise(edges)):
        times = begin + (end - begin) * PLACES
        rows = slice(POINTS * k, POINTS * (k + 1))
        for column, function in functions.items():
            rates[rows, column] = [function(time) for time in times]
        rates[rows, OMEGA], rates[rows, NOISE] = speed, noise
    return rates


def added(functions, edges, longest=math.inf, shortest=0.0, slack=0.0, speed=0.0, size=0.0,
          noise=(0.0, 0.0), gained=(), rates=(0.0, 0.0)):
    """Return (panels added, advice, sums)."""
    sums = np.zeros(SUMS)
    sums[[ENERGY, MOMENTUM]] = size
    edges = np.array(edges, dtype=float)
    table = rates_of(functions, edges, speed, noise[0])
    gained = np.array(gained, dtype=float)
    found = add_panels(table, edges, gained, *rates, longest, shortest, slack, noise[1], sums)
    return (*found, sums)


def test_the_rule_is_exact_for_polynomials_up_to_order_31():
    for power in range(32):
        assert WEIGHTS @ NODES ** power == near(1.0 / (power + 1), rel=1e-14)


def test_the_rows_give_legendre_coefficients_and_the_values_at_both_ends():
    legendre = np.polynomial.legendre.Legendre
    draw = np.random.default_rng(1).normal(size=16)
    values = legendre(draw)(2.0 * NODES - 1.0)
    assert pytest.approx(draw[panels.FIRST_TAIL:], abs=1e-12) == TAILS @ values
    assert AT_ENDS @ values == pytest.approx(
        legendre(draw)(np.array([-1.0, 2.0 * panels.LATE - 1.0])), abs=1e-12)


@pytest.mark.parametrize('column', range(5))
def test_each_entry_is_integrated_for_itself(column):
    count, advice, sums = added({column: math.exp}, [0.0, 0.5, 1.0], longest=0.5)
    assert (count, advice) == (2, KEPT)
    expected = np.zeros(5)
    expected[column] = math.e - 1.0
    assert sums[:5] == near(expected, rel=1e-15)
    sizes = np.zeros(2)
    sizes[0 if column < 2 else 1] = math.e - 1.0
    assert sums[[ENERGY, MOMENTUM]] == near(sizes, rel=1e-14)


def test_sizes_are_those_of_what_came_and_went():
    """A sine over a whole turn adds nothing to the sum, and 4 to the size."""
    _, _, sums = added({0: math.sin, 3: lambda t: -1.0}, np.linspace(0.0, 2.0 * math.pi, 9),
                       longest=1.0)
    assert sums[0] == pytest.approx(0.0, abs=1e-15)
    assert sums[[ENERGY, MOMENTUM]] == near([4.0, 2.0 * math.pi], rel=1e-6)


@pytest.mark.parametrize(('relaxation', 'falling'), [(0.6, 0.0), (0.0, 2.4), (0.3, 1.2)])
def test_a_panel_that_leaves_energy_unexplained_is_halved_where_heat_may_hide(relaxation, falling):
    """The power is 3 - 1 W, the body turns by 2 rad/s: it relaxes within 1/2.4 s."""
    power = {0: lambda t: 3.0, 1: lambda t: 1.0}

    def advice(length, gained, slack=0.0, noise=0.0):
        return added(power, [0.0, length], 9.0, 0.0, slack, 2.0, 8.0, (noise, 0.0), [gained],
                     (relaxation, falling))[1]
    assert advice(0.5, 1.0) == LONGER
    assert advice(0.5, 1.0 + 1e-9) == advice(0.5, 1.0 - 1e-9) == SHORTER
    assert advice(0.4, 7.0) == LONGER    # of such a burst a node would see something
    assert advice(0.5, 1.0 + 7e-9, slack=1e-9) == LONGER
    assert advice(0.5, 1.0 + 9e-9, slack=1e-9) == SHORTER
    assert advice(0.5, 1.0 + 4e-9, noise=1e-8) == LONGER


def test_what_a_sum_loses_is_carried_on():
    """A thousand panels of a constant 0.1 beside 1e6: without the rest 1e-10 would be lost."""
    sums = np.zeros(SUMS)
    sums[0] = 1e6
    edges = np.linspace(0.0, 1.0, 1001)
    rates = rates_of({0: lambda t: 1e-3}, edges)
    add_panels(rates, edges, np.zeros(0), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, sums)
    assert (sums[0] - 1e6) + sums[LOST] == near(1e-3, rel=1e-12)


@pytest.mark.parametrize('column', [0, 1, 2, 4])
@pytest.mark.parametrize(('width', 'advice'), [(0.01, SHORTER), (1.0, KEPT), (30.0, LONGER)])
def test_a_panel_is_shorter_kept_or_longer_as_its_integrand_is_sharp_or_flat(
        column, width, advice):
    """A pole at a distance of `width` from the middle of the panel."""
    count, found, sums = added(
        {column: lambda t: 1.0 / ((t - 0.5) ** 2 + width ** 2)}, [0.0, 1.0])
    assert found == advice
    assert count == (advice != SHORTER)
    if advice == SHORTER:
        assert not sums.any()
    else:
        exact = 2.0 / width * math.atan(0.5 / width)
        assert sums[column] == near(exact, rel=2e-16)


@pytest.mark.parametrize('width', np.geomspace(0.02, 3.0, 25))
def test_a_panel_that_is_taken_errs_by_rounding_only(width):
    count, _, sums = added({2: lambda t: 1.0 / ((t - 0.3) ** 2 + width ** 2)}, [0.0, 1.0])
    exact = (math.atan(0.7 / width) + math.atan(0.3 / width)) / width
    assert not count or sums[2] == near(exact, rel=4e-16)
    assert bool(count) == (width > 0.9)


def test_what_is_over_before_the_first_node_is_seen():
    """exp(-t/1e-4) is 1 at the beginning and nothing at the nodes, from 0.0053 on."""
    count, advice, _ = added({1: lambda t: math.exp(-1e4 * t)}, [0.0, 1.0])
    assert (count, advice) == (0, SHORTER)
    # beside a million times as much it does not fit either, beside 1e17 it is rounding
    assert added({1: lambda t: math.exp(-1e4 * t)}, [0.0, 1.0], size=1e10)[1] == SHORTER
    assert added({1: lambda t: math.exp(-1e4 * t)}, [0.0, 1.0], size=1e17)[1] == LONGER


@pytest.mark.parametrize('place', [0.004, 0.996])
@pytest.mark.parametrize(('column', 'power', 'share'), [(1, 1, 1e-4), (3, 2, 1e-2)])
def test_a_kink_beside_either_end_is_seen(place, column, power, share):
    """It lies between the end and the node next to it; errors of 4e-10 to 2e-9 were taken."""
    kinked = {column: lambda t: 1.0 + share * (t - place) ** (power - 1) * abs(t - place)}
    assert added(kinked, [0.0, 1.0])[:2] == (0, SHORTER)


def test_a_small_error_beside_a_large_integral_is_rounding():
    sharp = {0: lambda t: 1.0 / ((t - 0.5) ** 2 + 0.01)}
    assert added(sharp, [0.0, 1.0])[1] == SHORTER
    assert added(sharp, [0.0, 1.0], size=1e20)[1] == LONGER
    # energy and momentum are measured by their own sizes
    both = {**sharp, 3: sharp[0]}
    assert added(both, [0.0, 1.0], size=np.array([1e20, 0.0]))[1] == SHORTER
    assert added(both, [0.0, 1.0], size=np.array([0.0, 1e20]))[1] == SHORTER


@pytest.mark.parametrize(('column', 'place'), [(0, 0), (1, 0), (2, 1), (4, 1)])
def test_what_rounding_makes_of_terms_that_cancel_is_no_reason_for_short_panels(column, place):
    """A sawtooth of 1e-9 is noise beside 3e-8, where the panel begins too; of less it is not."""
    functions = {column: lambda t: 1e-9 * (2.0 * (1e3 * t % 1.0) - 1.0) + 1e-9 * (t == 0.0)}
    for noise, advice in ((3e-8, LONGER), (1e-11, SHORTER)):
        noises = [0.0, 0.0]
        noises[place] = noise
        assert added(functions, [0.0, 1.0], noise=noises)[1] == advice


@pytest.mark.parametrize('scale', [1e-10, 1e10])
def test_advice_does_not_depend_on_units(scale):
    sharp = {0: lambda t: scale / ((t - 0.5) ** 2 + 0.01)}
    over = {1: lambda t: scale * math.exp(-1e4 * t)}
    for one, least, most in ((sharp, 0.0, 1e20), (over, 1e10, 1e17)):
        assert added(one, [0.0, 1.0], size=least * scale)[:2] == (0, SHORTER)
        assert added(one, [0.0, 1.0], size=most * scale)[:2] == (1, LONGER)
    fair = {0: lambda t: scale / ((t - 0.5) ** 2 + 1.0)}
    assert added(fair, [0.0, 1.0])[:2] == (1, KEPT)


def test_an_integrand_is_measured_by_its_size_in_its_own_panel():
    """A millionth of what it was in the panel before, and jagged by 1e-7 of it."""
    def falls(time):
        return 1e6 if time < 1.0 else 1.0 + 1e-7 * math.cos(1e4 * time)
    assert added({0: falls}, [0.0, 1.0, 2.0], longest=1.0)[:2] == (1, SHORTER)
    assert added({0: lambda time: falls(3.0 - time)}, [1.0, 2.0, 3.0], longest=1.0)[:2] == (
        0, SHORTER)


def test_a_trajectory_that_is_uncertain_makes_no_panel_shorter():
    def jagged(time):
        return 1.0 + 1e-6 * math.cos(1e4 * time)
    assert added({0: jagged}, [0.0, 1.0])[1] == SHORTER
    assert added({0: jagged}, [0.0, 1.0], slack=1e-5)[1] == KEPT


def test_a_panel_as_short_as_can_be_is_taken_as_it_is():
    sharp = {0: lambda t: 1.0 / ((t - 0.5) ** 2 + 1e-4)}
    assert added(sharp, [0.0, 1.0], shortest=1.0)[:2] == (1, KEPT)
    assert added(sharp, [0.0, 1.0], shortest=0.99)[:2] == (0, SHORTER)


def test_in_a_panel_the_body_turns_by_a_bounded_angle():
    flat = {0: lambda t: 1.0}
    assert added(flat, [0.0, 1.0], speed=TURNED + 0.1)[:2] == (0, SHORTER)
    assert added(flat, [0.0, 1.0], speed=TURNED)[:2] == (1, KEPT)
    assert added(flat, [0.0, 1.0], speed=0.5 * TURNED)[:2] == (1, LONGER)
    assert added(flat, [0.0, 1.0], speed=0.51 * TURNED)[:2] == (1, KEPT)


def test_a_longer_panel_is_advised_up_to_the_longest_and_after_the_first_that_allows_it():
    flat, edges = {0: lambda t: 1.0}, [0.0, 1.0, 2.0, 3.0]
    assert added(flat, edges, longest=2.0)[:2] == (1, LONGER)
    assert added(flat, edges, longest=1.9)[:2] == (3, KEPT)


def test_panels_before_one_that_should_be_shorter_are_added():
    def steep(time):
        return 1.0 if time < 2.0 else 1.0 + 1.0 / ((time - 2.5) ** 2 + 1e-3)
    count, advice, sums = added({0: steep}, [0.0, 1.0, 2.0, 3.0], longest=1.0)
    assert (count, advice, sums[0]) == (2, SHORTER, pytest.approx(2.0))
