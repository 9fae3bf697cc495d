# SPDX-License-Identifier: Apache-2.0
"""The tick thread on a clock that the test moves: deadlines, overruns, pauses and /clock.

No test waits for real time.
"""

import itertools

import pytest

from rigid_body_sim.realtime.lateness import Lateness
from rigid_body_sim.realtime.ticking import BACKLOG, CLOCK_JUMP, LONGEST_SLEEP, Steady, Ticker

MILLISECOND = 1_000_000
START = 5_000_000_000
TAKE_PRIORITY = Ticker._take_priority


@pytest.fixture(autouse=True)
def plain_scheduling(monkeypatch):
    """Keep the scheduling of the test process, as the ticker runs in its main thread."""
    monkeypatch.setattr(Ticker, '_take_priority', lambda self: None)


class Clock:
    """A clock that moves only when somebody waits for it or works."""

    follows_clock_topic = False

    def __init__(self, wake_latency=0):
        self.time, self._latency = START, wake_latency

    def now(self):
        return self.time

    def wait(self, nanoseconds):
        sleep = min(nanoseconds, int(LONGEST_SLEEP * 1e9))
        self.time += sleep + (self._latency if sleep == nanoseconds else 0)


class ClockTopic:
    """A script of instants in place of /clock, one for each wait."""

    follows_clock_topic = True

    def __init__(self, instants):
        self._instants, self.time = iter(instants), 0

    def now(self):
        return self.time

    def wait(self, _):
        self.time = next(self._instants)


class Work:
    """A work that notes the time of each tick; `costs` maps ticks to their durations, ns."""

    def __init__(self, clock, ticks, costs=None, between=lambda work: None):
        self._clock, self._ticks, self._costs, self._between = clock, ticks, costs or {}, between
        self.next_tick = self.begun = 0
        self.runs = []
        self.finished = False

    def begin(self):
        assert not self.runs
        self.begun += 1

    def run_tick(self, publish):
        self.runs.append((self.next_tick, self._clock.now(), publish))
        if callable(self._costs.get(self.next_tick)):
            self._costs[self.next_tick]()
        else:
            self._clock.time += self._costs.get(self.next_tick, 0)
        self.next_tick += 1
        self.finished = self.next_tick == self._ticks

    def between_ticks(self):
        self._between(self)

    @property
    def times(self):
        return [time - START for _, time, _ in self.runs]


def run(work, clock, rate=1000.0, factor=1.0, skip_publish=False):
    """Run a ticker to its end in this thread."""
    ticker = Ticker(work, clock, rate, factor, skip_publish, lambda: None)
    ticker.run()
    if ticker.failure and not isinstance(ticker.failure, StopIteration):
        raise ticker.failure
    assert [tick for tick, _, _ in work.runs] == list(range(len(work.runs)))
    assert work.begun == 1
    return ticker


def test_ticks_come_at_the_exact_rate_however_late_each_is():
    clock = Clock(wake_latency=70_000)
    work = Work(clock, 1001)
    ticker = run(work, clock, rate=3000.0)
    assert work.times[1000] == 333_333_333 + 70_000
    assert ticker.overruns == 0
    assert ticker.lateness.summary()['max'] == pytest.approx(70e-6)
    assert ticker.latest == (1001, 333_333_333 + 70_000)


def test_late_tick_is_caught_up_with_and_counted():
    clock = Clock()
    work = Work(clock, 20, {5: 3_500_000})
    ticker = run(work, clock)
    assert work.times == [k * MILLISECOND if not 6 <= k <= 8 else 8_500_000 for k in range(20)]
    # ticks 6 and 7 came 2.5 and 1.5 ms late, tick 8 only half a period
    assert (ticker.overruns, ticker.slipped, ticker.skipped) == (2, 0, 0)
    assert all(publish for _, _, publish in work.runs)


def test_skip_publish_leaves_out_the_messages_of_late_ticks():
    clock = Clock()
    work = Work(clock, 20, {5: 3_500_000})
    ticker = run(work, clock, skip_publish=True)
    assert [tick for tick, _, publish in work.runs if not publish] == [6, 7]
    assert (ticker.overruns, ticker.skipped) == (2, 2)


@pytest.mark.parametrize('skip_publish', [False, True])
def test_rate_that_cannot_be_held_slips_and_recovers(skip_publish):
    """400 ticks take 2 ms each where 1 ms is allowed: they stay consecutive.

    Time is lost in steps of the backlog, and then no more.
    """
    clock = Clock()
    work = Work(clock, 800, dict.fromkeys(range(400), 2 * MILLISECOND))
    ticker = run(work, clock, skip_publish=skip_publish)
    lost = work.times[799] - 799 * MILLISECOND
    assert lost == ticker.slipped
    assert 3 * BACKLOG < lost <= 400 * MILLISECOND
    assert ([after - before for before, after in itertools.pairwise(work.times[700:])]
            == [MILLISECOND] * 99)


def test_real_time_factor_stretches_time():
    clock = Clock()
    work = Work(clock, 11)
    run(work, clock, rate=100.0, factor=0.5)
    assert work.times == [k * 20 * MILLISECOND for k in range(11)]


def test_factor_zero_does_not_wait():
    clock = Clock()
    work = Work(clock, 1000)
    run(work, clock, factor=0.0)
    assert work.times == [0] * 1000
    assert all(publish for _, _, publish in work.runs)


def test_change_of_pace_holds_from_its_tick_on():
    clock = Clock(wake_latency=10_000)
    work = Work(clock, 11)
    ticker = Ticker(work, clock, 1000.0, 1.0, False, lambda: None)
    work._costs[5] = lambda: ticker.pace(200.0, 1.0)
    ticker.run()
    due = [k * MILLISECOND for k in range(6)] + [(5 + 5 * k) * MILLISECOND for k in range(1, 6)]
    assert [time - 10_000 for time in work.times[1:]] == due[1:]


def test_long_waits_look_after_commands():
    clock = Clock()
    looks = []
    work = Work(clock, 2, between=lambda work: looks.append(clock.time))
    run(work, clock, rate=1.0)
    assert 95 <= len(looks) <= 101


@pytest.mark.parametrize(('rate', 'looks'), [(1000.0, 0), (100.0, 0), (50.0, 2)])
def test_commands_are_looked_after_while_a_wait_is_longer_than_10_ms(rate, looks):
    clock, found = Clock(), []
    run(Work(clock, 3, between=found.append), clock, rate=rate)
    assert len(found) == looks


def test_a_pause_while_it_waits_holds_the_tick_back(monkeypatch):
    clock = Clock()
    monkeypatch.setattr('rigid_body_sim.realtime.ticking.time.sleep',
                        lambda seconds: setattr(clock, 'time', clock.time + int(seconds * 1e9)))

    def between(work):
        ticker.pause()
        if clock.time - START > 1500 * MILLISECOND:
            ticker.stop()
    work = Work(clock, 3, between=between)
    ticker = Ticker(work, clock, 1.0, 1.0, False, lambda: None)
    ticker.run()
    assert work.times == [0]


def test_pause_and_steps_leave_out_no_tick_and_no_time(monkeypatch):
    clock = Clock()
    monkeypatch.setattr('rigid_body_sim.realtime.ticking.time.sleep',
                        lambda seconds: setattr(clock, 'time', clock.time + int(seconds * 1e9)))
    steps = []

    def between(work):
        if clock.time - START > 300 * MILLISECOND and not steps:
            steps.append(ticker.step())
        elif clock.time - START > 500 * MILLISECOND:
            ticker.resume()
    work = Work(clock, 20, between=between)
    ticker = Ticker(work, clock, 1000.0, 1.0, False, lambda: None)
    work._costs[9] = ticker.pause
    ticker.run()
    assert [tick for tick, _, _ in work.runs] == list(range(20))
    assert work.times[9] == 9 * MILLISECOND
    assert 300 * MILLISECOND < work.times[10] < 320 * MILLISECOND
    assert 500 * MILLISECOND < work.times[11] < 520 * MILLISECOND
    assert steps[0].result() == 10
    assert all(publish for _, _, publish in work.runs)
    assert (ticker.overruns, ticker.slipped) == (0, 0)
    # 20 ticks at 1 kHz, the pause left out
    assert ticker.latest == (20, 19 * MILLISECOND)


@pytest.mark.parametrize(('factor', 'running'), [(1.0, 4 * MILLISECOND), (0.0, 0)])
def test_a_pause_before_the_first_tick_and_one_between_ticks_are_left_out(
        monkeypatch, factor, running):
    clock = Clock()
    monkeypatch.setattr('rigid_body_sim.realtime.ticking.time.sleep',
                        lambda seconds: setattr(clock, 'time', clock.time + int(seconds * 1e9)))
    work = Work(clock, 5, between=lambda work: ticker.resume())
    ticker = Ticker(work, clock, 1000.0, factor, False, lambda: None)
    work._costs[2] = ticker.pause
    ticker.pause()
    ticker.run()
    assert ticker.latest == (5, running)


def test_stopped_it_ends_after_its_tick_and_calls_nobody():
    clock, ended = Clock(), []
    work = Work(clock, 10)
    ticker = Ticker(work, clock, 1000.0, 1.0, False, lambda: ended.append(True))
    assert (ticker.latest, ticker.waiting_for_clock, ticker.daemon) == ((0, 0), True, True)
    work._costs[3] = ticker.stop
    ticker.run()
    assert (len(work.runs), ended, ticker.failure) == (4, [], None)


@pytest.mark.parametrize(('factor', 'sleeps'), [(1.0, True), (0.5, True), (0.0, False)])
def test_real_time_scheduling_is_asked_for_where_the_thread_sleeps(monkeypatch, factor, sleeps):
    monkeypatch.setattr(Ticker, '_take_priority', TAKE_PRIORITY)
    monkeypatch.setattr('rigid_body_sim.realtime.ticking.ask_for_priority',
                        lambda wanted: f'real time: {wanted}')
    clock = Clock()
    assert run(Work(clock, 2), clock, factor=factor).scheduling == f'real time: {sleeps}'


def test_the_clock_of_the_machine_sleeps_as_long_as_wanted_but_not_longer_than_commands_wait(
        monkeypatch):
    slept = []
    monkeypatch.setattr('rigid_body_sim.realtime.ticking.time.sleep', slept.append)
    for nanoseconds in (2 * MILLISECOND, 1000 * MILLISECOND):
        Steady.wait(nanoseconds)
    assert slept == [pytest.approx(0.002), 0.01]
    assert not Steady.follows_clock_topic


@pytest.mark.parametrize(('rate', 'factor', 'cost', 'overruns'), [
    # of tick 0; the next one is due after a period
    (1000.0, 1.0, 2 * MILLISECOND, 0), (1000.0, 1.0, 2 * MILLISECOND + 1, 1),
    (100.0, 0.5, 40 * MILLISECOND, 0), (100.0, 0.5, 40 * MILLISECOND + 1, 1),
    # a period of 333333.3 ns
    (3000.0, 1.0, 333_333 + 333_334, 0), (3000.0, 1.0, 333_333 + 333_335, 1)])
def test_a_tick_that_comes_more_than_a_period_late_is_an_overrun(rate, factor, cost, overruns):
    clock = Clock()
    assert run(Work(clock, 2, {0: cost}), clock, rate, factor).overruns == overruns


@pytest.mark.parametrize(('cost', 'slipped'), [
    (103 * MILLISECOND, 0), (103 * MILLISECOND + 1, 102 * MILLISECOND + 1)])
def test_the_schedule_slips_by_more_than_two_periods_and_a_tenth_of_a_second(cost, slipped):
    clock = Clock()
    work = Work(clock, 2, {0: cost})
    assert run(work, clock, skip_publish=True).slipped == slipped
    # a tick that is only late is left out
    assert [publish for _, _, publish in work.runs] == [True, slipped > 0]


@pytest.mark.parametrize(('step', 'jumps'), [
    # the tick after the first is due after 10 ms
    (10_030 * MILLISECOND, 0), (10_030 * MILLISECOND + 1, 1),
    (-10 * MILLISECOND, 0), (-10 * MILLISECOND - 1, 1)])
def test_clock_topic_jumps_by_two_periods_backward_and_ten_seconds_more_forward(step, jumps):
    clock = ClockTopic([10**10, 10**10 + step])
    assert run(Work(clock, None), clock, rate=100.0).clock_jumps == jumps


def test_failure_ends_the_thread_and_is_kept():
    clock = Clock()
    ended = []

    def fail():
        raise ArithmeticError('gave up')
    ticker = Ticker(
        Work(clock, 10, {3: fail}), clock, 1000.0, 1.0, False, lambda: ended.append(True))
    ticker.run()
    assert str(ticker.failure) == 'gave up'
    assert ended == [True]


def test_clock_topic_of_ten_hertz_runs_every_tick_in_bursts():
    clock = ClockTopic([
        0, 0, 7_000_000_000, *(7_000_000_000 + k * 100 * MILLISECOND for k in range(1, 11))])
    work = Work(clock, None)
    ticker = run(work, clock, rate=100.0)
    assert len(work.runs) == 101
    assert (ticker.clock_jumps, ticker.overruns) == (0, 0)
    assert not ticker.waiting_for_clock


def test_clock_topic_at_ten_times_the_speed_loses_no_tick():
    clock = ClockTopic([1_000_000_000 + k * 1_000_000_000 for k in range(6)])
    work = Work(clock, None)
    run(work, clock, rate=1000.0)
    assert len(work.runs) == 5001


def test_clock_topic_that_pauses_or_jumps_keeps_ticks_consecutive():
    instants = [
        10**10, 10**10 + 10**9, 10**10 + 10**9, 10**10 + 10**9, 2 * 10**9, 2 * 10**9 + 10**8,
        2 * 10**9 + 10**8 + 2 * CLOCK_JUMP, 2 * 10**9 + 2 * 10**8 + 2 * CLOCK_JUMP]
    clock = ClockTopic(instants)
    work = Work(clock, None)
    ticker = run(work, clock, rate=100.0)
    # 1 s, then back by 9 s and on by 0.1 s, then forward by 20 s and on by 0.1 s
    assert ticker.clock_jumps == 2
    assert len(work.runs) == 101 + 11 + 11


def test_lateness_of_a_second_and_of_the_whole_run():
    lateness = Lateness()
    for microseconds in range(100):
        lateness.add(microseconds * 1000)
    assert lateness.since_last() == pytest.approx({
        'count': 100, 'p50': 50e-6, 'p99': 99e-6, 'max': 99e-6})
    lateness.add(50_000_000)
    assert lateness.since_last() == pytest.approx({
        'count': 1, 'p50': 20e-3, 'p99': 20e-3, 'max': 50e-3})
    assert lateness.since_last()['count'] == 0
    assert lateness.summary() == pytest.approx({
        'count': 101, 'p50': 51e-6, 'p99': 100e-6, 'max': 50e-3})
