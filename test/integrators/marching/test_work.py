# SPDX-License-Identifier: Apache-2.0
"""The bound on the work of a march, step by step, as its documentation counts it.

The times of the marches are made up. A march looks ahead after FIRST_LOOK = 131072 steps, and may
take PATIENCE over the steps done, at least MOST; one under a bound of its own after EARLY = 512.
"""

import math

import pytest

from rigid_body_sim.integrators.marching import track, work
from rigid_body_sim.integrators.marching.work import Doublings, TooMuchWork, Work

FIRST = 131072


@pytest.fixture(autouse=True)
def compiled(monkeypatch):
    """Let steps cost what compiled ones cost, with numba and without."""
    monkeypatch.setattr(work, 'SLOWER', 1)


def begun(target, at=0.0, **settings):
    """Return the Work of a march that has made no step towards a target yet."""
    settings.setdefault('most', None)
    march = Work('a march', **settings)
    march.go(lambda limit: True, lambda: at, target)
    return march


def gives_up(march, steps, time, target):
    """Return whether a march gives up after so many steps more that led to a time."""
    try:
        march.count(steps, time, target)
    except TooMuchWork:
        return True
    return False


# ---------------------------------------------------------------------------- doublings

def seen(times, last, many=1, most=1000):
    """Return what is said of a march that has reached each time after twice as many steps."""
    doublings, found = Doublings(last, many), []
    for k, time in enumerate(times):
        assert doublings.next == 64 << k
        found.append(doublings.see(64 << k, time, most))
    return found


@pytest.mark.parametrize(('most', 'many', 'end'), [
    (1000, 3, math.log(100 * 3 * 1000 / 64)), (64, 1, math.log(100)),
    (0.5, 1, math.log(32))])    # so many are done at the sixth look
def test_steps_that_double_in_even_times_are_hopeless_where_too_many_would_be_made(
        most, many, end):
    """At t = 3 log(n/64) s after n steps; 100 times as many are allowed for each of the times.

    The first look has no doubling, the second none before it; then come four that are no slower.
    """
    times = [3.0 * math.log(2.0) * k for k in range(6)]
    assert seen(times, 3.0 * end - 0.01, many, most) == [False] * 6
    assert seen(times, 3.0 * end + 0.01, many, most) == [False] * 5 + [True]


@pytest.mark.parametrize(('slower', 'hopeless'), [(1.0, True), (1.045, True), (1.055, False)])
def test_doublings_that_take_longer_and_longer_lead_on(slower, hopeless):
    times = [sum(slower ** n for n in range(k)) for k in range(7)]
    assert seen(times, 1e9)[-1] == hopeless


def test_one_slow_doubling_begins_the_count_anew():
    """It is the fourth; the four after it that are no slower end with the eighth."""
    times = [0.0, 1.0, 2.0, 3.0, 5.0, 7.0, 9.0, 11.0, 13.0]
    assert seen(times, 1e9) == [False] * 8 + [True]


def test_no_call_from_python_makes_more_steps_than_doublings_see():
    assert 0 < track.AT_ONCE <= work.DOUBLED == Doublings(1.0, 1).next


def test_a_march_is_given_up_at_the_doubling_that_is_hopeless():
    """Of its 2048 steps, 1000 were made before; each of the times is then due at n log 2."""
    march = begun(1e9, made=63, doublings=Doublings(1e9, 1))
    made, done = 0, []
    for k in range(6):
        steps = (64 << k) - 63 - made
        assert not gives_up(march, steps - 1, k - 1.0, 1e9)    # a step before: nothing is seen
        done.append(gives_up(march, 1, float(k), 1e9))
        made += steps
    assert done == [False] * 5 + [True]


# ---------------------------------------------------------------------------- the steps ahead

def test_nobody_looks_ahead_before_enough_steps():
    march = begun(1.0)
    assert not gives_up(march, FIRST - 1, 0.0, 1.0)
    assert gives_up(march, 1, 0.0, 1.0)


@pytest.mark.parametrize(('steps', 'dear', 'ahead'), [
    (FIRST, 1, 1e15 / FIRST), (FIRST, 2, 1e15 / (2 * FIRST) / 2),
    (1 << 22, 1, 3e8), (1 << 22, 3, 1e8)])
@pytest.mark.parametrize('rests', [False, True])
def test_a_march_gives_up_where_too_many_steps_lie_ahead(steps, dear, ahead, rests):
    """Those done led from 2 to 3 s, and `ahead` is allowed: PATIENCE over those done, or MOST."""
    for share, expected in ((0.9999, False), (1.0001, True)):
        target = 3.0 + share * ahead / steps
        march = begun(target, at=2.0, dear=dear, comes_to_rest=rests)
        assert gives_up(march, steps, 3.0, target) == expected


@pytest.mark.parametrize('factor', [2, 16])
def test_the_next_look_is_at_twice_the_steps_or_at_the_next(factor):
    """It judges the pace since the look before: the march stands still since."""
    march, steps = begun(1.0), FIRST * factor // 2
    assert not gives_up(march, steps, 0.99, 1.0)
    if factor == 2:
        assert not gives_up(march, FIRST - 1, 0.99, 1.0)
    assert gives_up(march, 1, 0.99, 1.0)


def test_a_dear_march_is_looked_at_earlier():
    for dear, first in ((1, FIRST), (4, FIRST // 4), (10 * FIRST, 1)):
        march = begun(1.0, dear=dear)
        assert first == 1 or not gives_up(march, first - 1, 0.0, 1.0)
        assert gives_up(march, 1, 0.0, 1.0)


@pytest.mark.parametrize(('settings', 'first'), [
    ({}, FIRST // 64), ({'dear': 128}, FIRST // 128), ({'dear': 2}, FIRST // 64),
    ({'comes_to_rest': True}, FIRST), ({'most': 10 ** 6}, 512)])
def test_steps_that_are_not_compiled_count_as_many(settings, first, monkeypatch):
    """But not where a body may rest, nor under a bound of its own, which is looked at early.

    The march stands still, so it is given up at the first look.
    """
    monkeypatch.setattr(work, 'SLOWER', 64)
    march = begun(1e9, **settings)
    assert not gives_up(march, first - 1, 0.0, 1e9)
    assert gives_up(march, 1, 0.0, 1e9)


# ---------------------------------------------------------------------------- a bound of its own

@pytest.mark.parametrize('rests', [False, True])
def test_a_march_gives_up_at_its_bound(rests):
    march = begun(1.0, most=100, comes_to_rest=rests)
    assert not gives_up(march, 99, 0.0, 1.0)
    assert gives_up(march, 1, 0.999, 1.0)


@pytest.mark.parametrize('dear', [1, 7])
def test_a_bounded_march_gives_up_where_a_hundred_times_its_bound_lies_ahead(dear):
    """512 steps lead to 1 s, 512 more to 2 s: at the second look no step is longer."""
    for share, expected in ((0.999, False), (1.001, True)):
        target = 2.0 + share * 100.0 * 5000 / 512
        march = begun(target, most=5000, dear=dear)
        assert not gives_up(march, 512, 1.0, target)
        assert gives_up(march, 512, 2.0, target) == expected


@pytest.mark.parametrize(('longer', 'expected'), [(1.0, True), (1.99, True), (2.01, False)])
def test_a_bounded_march_goes_on_while_its_steps_grow(longer, expected):
    march = begun(1e9, most=10 ** 6)
    assert not gives_up(march, 512, 1.0, 1e9)
    assert gives_up(march, 512, 1.0 + longer, 1e9) == expected


def test_steps_that_grow_are_no_excuse_after_as_many_as_others_may_take():
    """The looks are at 512, 1024, ... 65536, 131072 steps: each time the steps are four times."""
    march, steps, time = begun(1e30, most=10 ** 6), 512, 1.0
    assert not gives_up(march, steps, time, 1e30)
    for look in range(1, 9):
        time *= 8.0
        assert gives_up(march, steps, time, 1e30) == (look == 8)
        steps *= 2


def test_a_body_that_may_rest_is_not_looked_at_early():
    march = begun(1e9, most=10 ** 6, comes_to_rest=True)
    assert not gives_up(march, FIRST - 1, 0.0, 1e9)
    assert gives_up(march, 1, 0.0, 1e9)


def test_another_target_begins_the_count_of_the_pace_anew():
    march = begun(1e9, most=10 ** 6)
    assert not gives_up(march, 512, 1.0, 1e9)
    march.go(lambda limit: True, lambda: 1.0, 2e9)
    assert not gives_up(march, 512, 2.0, 2e9)    # nothing is known of steps that grow or not
    assert gives_up(march, 1024, 4.0, 2e9)


# ---------------------------------------------------------------------------- slices, and words

@pytest.mark.parametrize(('settings', 'counted', 'slices'), [
    ({}, 0, [64]), ({'most': 10}, 0, [10]), ({'most': 100}, 0, [64]), ({'most': 100}, 50, [50]),
    ({'dear': FIRST // 5}, 0, [5]), ({'dear': 10 * FIRST}, 0, [1]), ({}, FIRST - 9, [9]),
    ({}, 8 * FIRST, [1]), ({'made': 60, 'doublings': 1}, 0, [4, 64]),
    ({'made': 1000, 'doublings': 1}, 0, [1, 64]), ({'doublings': 1}, 40, [24, 64]),
    ({'made': 32, 'doublings': 1, 'most': 10}, 0, [10])])
def test_a_slice_ends_at_what_comes_next(settings, counted, slices):
    """The bound, the look ahead, the next doubling; one step where that is past already.

    The first slice is of 64 steps; the clock has no say in it, nor in what is less.
    """
    if 'doublings' in settings:
        settings = settings | {'doublings': Doublings(1e9, 1)}
    march, found = begun(1.0, **settings), []
    if counted:
        march.count(counted, 0.5, 1.0)

    def follow(limit):
        found.append(limit)
        return len(found) == len(slices)
    march.go(follow, lambda: 0.0, 1.0)
    assert found[0] == slices[0]
    assert found[1:] >= slices[1:]    # whatever the clock says: the next doubling is far
    assert march.done == counted + sum(found[:-1])


def test_what_is_said_counts_from_the_last_target_on_and_from_the_origin():
    march = begun(1.0, most=100, origin=10.0)
    march.count(40, 1.0, 1.0)
    march.go(lambda limit: True, lambda: 1.0, 4.0)
    with pytest.raises(TooMuchWork) as given_up:
        march.count(60, 2.5, 4.0)
    assert str(given_up.value).startswith(
        'a march: 60 steps from t = 11.0 s led to t = 12.5 s; to reach 14.0 s asks for too many.')
    assert given_up.value.time == 12.5
