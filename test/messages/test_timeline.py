# SPDX-License-Identifier: Apache-2.0
"""Instants of ticks: exact for any rate."""

from fractions import Fraction

import pytest

from rigid_body_sim.messages.timeline import NANOSECONDS, Pace, Timeline

EPOCH = 1_795_263_252_907_662_526


@pytest.mark.parametrize('rate', [1000.0, 59.94, 1.0 / 3.0, 8000.0, 1e-3, 0.1, 99999.999])
@pytest.mark.parametrize('tick', [0, 1, 2, 999_999_937, 10**12 + 1])
def test_an_instant_is_the_exact_quotient_to_the_nearest_nanosecond(rate, tick):
    exact = EPOCH + Fraction(tick * NANOSECONDS) / Fraction(rate)
    assert abs(Timeline(EPOCH, rate).instant(tick) - exact) <= Fraction(1, 2)


def test_a_new_rate_goes_on_from_its_tick_without_a_jump():
    slow = Timeline(EPOCH, 1000.0)
    fast = slow.from_tick(1500, 8000.0)
    assert fast.instant(1500) == slow.instant(1500) == EPOCH + 1_500_000_000
    assert fast.instant(1508) == EPOCH + 1_501_000_000


@pytest.mark.parametrize('rate', [1000.0, 59.94, 1.0 / 3.0])
def test_many_instants_are_those_of_their_ticks(rate):
    timeline = Timeline(EPOCH, rate, tick=40)
    assert timeline.instants(37, 5) == [timeline.instant(tick) for tick in range(37, 42)]
    assert timeline.instant(40) == EPOCH < timeline.instant(41)


def test_a_span_is_a_whole_number_of_ticks_up_to_two_ulps():
    """The ulp of 4 s is 2^-50 s."""
    assert Timeline(0, 1.0).ticks_in(4.0 + 2.0**-49) == 4
    assert Timeline(0, 1.0).ticks_in(4.0 + 2.0**-49 + 2.0**-50) == 5


def test_ticks_in_a_span_never_fall_short():
    assert Timeline(0, 1000.0).ticks_in(0.5) == 500
    assert Timeline(0, 3.0).ticks_in(0.5) == 2
    assert Timeline(0, 0.1).ticks_in(0.0) == 0
    assert Timeline(0, 1000.0).ticks_in(0.5000000001) == 501


@pytest.mark.parametrize(
    ('seconds', 'rate', 'ticks'),
    [(0.1, 1000.0, 100), (0.07, 100.0, 7), (0.3, 10.0, 3), (1e-3, 1e5, 100), (20.0, 0.1, 2)])
def test_decimal_spans_are_whole_numbers_of_ticks(seconds, rate, ticks):
    assert Timeline(0, rate).ticks_in(seconds) == ticks


@pytest.mark.parametrize(('rate', 'ticks', 'expected'),
                         [(30.0, 90.0, [0, 3, 6, 9]), (30.0, 100.0, [0, 4, 7, 10]),
                          (30.0, 20.0, list(range(11))), (2.5, 10.0, [0, 4, 8])])
def test_what_is_paced_is_due_at_the_first_tick_at_or_after_each_instant(rate, ticks, expected):
    pace = Pace(rate, ticks)
    assert pace.due(0, 11) == expected
    assert [tick for k in range(11) for tick in pace.due(k, 1)] == expected
