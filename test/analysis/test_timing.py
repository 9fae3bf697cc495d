# SPDX-License-Identifier: Apache-2.0
"""Lateness of made-up runs: prompt, late, paused, slipping, slewed clock, other paces, gaps."""

import numpy as np
import pytest
from near import near

from rigid_body_sim.analysis.history import History, Segment
from rigid_body_sim.analysis.timing import Punctuality

START = 1_795_000_000_000_000_000
MS = 1_000_000


def measured(stamps, publish_times, segments=None, blocks=(230,)):
    punctuality = Punctuality(History((), tuple(segments or [Segment(START, None, 1000.0, 1.0)])))
    begin, k = 0, 0
    while begin < len(stamps):
        end = begin + blocks[k % len(blocks)]
        punctuality.add(stamps[begin:end], publish_times[begin:end])
        begin, k = end, k + 1
    return punctuality.summary(), punctuality


def run(ticks=20_000, seed=1):
    """Return stamps at 1 kHz and lateness of each tick: 30 to 60 us, some of 5 ms."""
    random = np.random.default_rng(seed)
    late = random.integers(30_000, 60_000, ticks)
    late[::50] = 5 * MS
    late[0] = late[7] = 30_000
    return START + np.arange(ticks) * MS, late


@pytest.mark.parametrize('blocks', [(230,), (1,), (20_000,), (999, 2)])
def test_lateness_is_counted_from_the_promptest_tick(blocks):
    stamps, late = run()
    summary, _ = measured(stamps, stamps + 17 * MS + late, blocks=blocks)
    # the schedule of each second is that of its promptest tick, within the 1 us that 1000 draws
    # leave open, less 30 us
    assert summary['lateness']['p50'] == pytest.approx(15e-6, abs=1.5e-6)
    assert summary['lateness']['p99'] == pytest.approx(5e-3 - 30e-6, abs=2e-6)
    assert summary['lateness']['max'] == pytest.approx(5e-3 - 30e-6, abs=2e-6)
    assert summary['achieved_rate'] == near(1000.0, rel=1e-6)
    assert (summary['ticks'], summary['missing'], summary['standstills']) == (20_000, 0, 0)


def test_a_pause_is_no_lateness():
    stamps, late = run()
    times = stamps + late
    times[7300:] += 3_000 * MS
    summary, _ = measured(stamps, times)
    assert summary['lateness']['max'] < 5.1e-3
    assert summary['standstills'] == 1
    assert summary['achieved_rate'] == near(1000.0, rel=1e-3)


def test_being_late_for_long_is_lateness():
    stamps, late = run()
    times = stamps + late
    times[5000:15000] += 40 * MS
    summary, punctuality = measured(stamps, times)
    # less what a slewed clock may have moved in 10 s
    assert 0.035 < summary['lateness']['p99'] < 0.0401
    assert summary['standstills'] == 0
    curve = punctuality.curve()
    assert (curve[:, 0] - START).tolist() == [k * 1000.0 * MS for k in range(20)]
    assert np.all(curve[5:15, 2] > 34.9 * MS) and np.all(curve[16:, 2] < MS)


def test_a_clock_that_is_slewed_is_no_lateness():
    stamps, late = run()
    times = stamps + late + (stamps - START) // 5000     # 200 ppm
    summary, _ = measured(stamps, times)
    # within a second the schedule stands: 200 us of drift are seen at most
    assert summary['lateness']['p50'] < 0.25e-3 and summary['lateness']['max'] < 5.3e-3
    assert summary['achieved_rate'] == near(1000.0 / 1.0002, rel=1e-5)


def test_another_pace_is_followed_and_no_pace_has_no_lateness():
    stamps, late = run()
    places = np.arange(20_000)
    times = stamps + late
    # twice as fast from tick 5000 on, as fast as it goes from tick 10,000 on
    times[5000:] = START + 5000 * MS + (places[5000:] - 5000) * MS // 2 + late[5000:]
    times[10_000:] = times[9999] + (places[10_000:] - 9999) * 3000
    segments = [Segment(START + begin * MS, None, 1000.0, pace)
                for begin, pace in ((0, 1.0), (5000, 2.0), (10_000, 0.0))]
    summary, punctuality = measured(stamps, times, segments)
    assert summary['lateness']['max'] == pytest.approx(5e-3, abs=40e-6)
    assert summary['achieved_rate'] == near(10_000 / 7.5, rel=1e-3)
    assert punctuality.curve()[-1, 0] < START + 10_000 * MS
    summary, _ = measured(stamps, stamps, [Segment(START, None, 1000.0, 0.0)])
    assert summary['lateness'] is None and summary['achieved_rate'] is None


def test_missing_ticks_are_counted_at_the_rate_of_their_time():
    stamps, late = run(6000)
    kept = np.ones(6000, bool)
    kept[[5, 6, 229, 230, 231, 4000]] = False
    summary, _ = measured(stamps[kept], (stamps + late)[kept])
    assert (summary['ticks'], summary['missing']) == (5994, 6)
    assert summary['achieved_rate'] == near(1000.0, rel=1e-5)     # they were run
    slow = np.concatenate([stamps[:3000], stamps[3000] + np.arange(100) * 10 * MS])
    segments = [Segment(START, None, 1000.0, 1.0), Segment(int(stamps[3000]), None, 100.0, 1.0)]
    assert measured(slow, slow, segments)[0]['missing'] == 0
    assert measured(
        np.delete(slow, [20, 3050]), np.delete(slow, [20, 3050]), segments)[0]['missing'] == 2


def by_hand(shifts, rate=20.0, pace=1.0, changes=(), blocks=(1000,)):
    """Return (summary, groups) of ticks whose publish times are stamp over pace plus `shifts`.

    `changes`: tick -> pace from there on.
    """
    stamps = START + np.arange(len(shifts)) * round(1e9 / rate)
    ends = [*sorted(changes), len(stamps)] if changes else [len(stamps)]
    paces = [pace, *(changes[k] for k in sorted(changes))] if changes else [pace]
    segments = [Segment(int(stamps[begin]), None, rate, one)
                for begin, one in zip([0, *ends[:-1]], paces, strict=True)]
    times, begin, at = np.empty(len(stamps), np.int64), 0, START
    for end, one in zip(ends, paces, strict=True):
        steps = (stamps[begin:end] - stamps[begin]) / (one or 1.0)
        times[begin:end] = at + steps.astype(np.int64)
        at, begin = int(times[end - 1] + 1e9 / rate / (one or 1.0)), end
    summary, punctuality = measured(stamps, times + np.array(shifts, np.int64), segments, blocks)
    return summary, punctuality.curve()


def test_the_schedule_follows_by_its_slew_up_to_a_standstill():
    """Groups of a second, 20 ticks: each as late as its first tick, but for the last.

    The second is 10 ms late after 1.01 s, of which the schedule follows 5e-4; the third is 100 ms
    later than the schedule, no standstill; the fourth by a nanosecond more, one.
    """
    first = 505_000
    third = first + 100 * MS
    second = first + int(5e-4 * (1000 * MS + third - 10 * MS))
    fourth = second + 100 * MS + 1
    shifts = np.repeat([0, 10 * MS, third, fourth, fourth], 20)
    shifts[-2:] += 100 * MS, 100 * MS + 1    # the last is a pause
    summary, groups = by_hand(shifts)
    assert summary['standstills'] == 1 and summary['missing'] == 0 and summary['ticks'] == 100
    assert groups[:, 2].tolist() == [0, 10 * MS - first, third - second, 0, 0]
    assert groups[:, 4].tolist() == [0, 10 * MS - first, third - second, 0, 100 * MS]
    # of 99 ticks 59 are in time, 20 each 9.5 ms and 99.5 ms late, one 100 ms
    assert summary['lateness']['p50'] == pytest.approx(1e-6, abs=1e-12)
    assert summary['lateness']['p99'] == pytest.approx(0.1, abs=1e-12)
    assert summary['lateness']['max'] == pytest.approx(0.1, abs=1e-12)
    running = 99 * 50 * MS + shifts[-1] - (100 * MS + 1)
    assert summary['achieved_rate'] == near(99 * 50 * MS * 20.0 / running, rel=1e-14)


@pytest.mark.parametrize(('rate', 'size'), [(5.0, 20), (20.0, 20), (25.0, 25)])
def test_a_group_lasts_a_second_or_twenty_ticks(rate, size):
    step = round(1e3 / rate)
    _, groups = by_hand(np.zeros(2 * size + 3), rate)
    # as numbers in double precision, stamps of today have 256 ns
    assert np.rint((groups[:, :2] - START) / MS).astype(int).tolist() == [
        [0, (size - 1) * step], [size * step, (2 * size - 1) * step],
        [2 * size * step, (2 * size + 2) * step]]


def test_groups_are_taken_as_soon_as_they_are_whole():
    stamps = START + np.arange(20) * 50 * MS
    punctuality = Punctuality(History((), (Segment(START, None, 20.0, 1.0),)))
    punctuality.add(stamps[:19], stamps[:19])
    assert len(punctuality.curve()) == 0
    punctuality.add(stamps[19:], stamps[19:])
    assert len(punctuality.curve()) == 1


def test_another_pace_begins_another_group_and_schedule():
    """The first 25 ticks at half the pace, then none, then at twice the pace: all in time."""
    summary, groups = by_hand(np.zeros(70), pace=0.5, changes={25: 0.0, 45: 2.0})
    assert np.rint((groups[:, :2] - START) / MS).astype(int).tolist() == [
        [0, 950], [1000, 1200], [2250, 3200], [3250, 3450]]
    assert not groups[:, 2:].any() and summary['missing'] == 0
    # 24 steps in 2.4 s and as many in 0.6 s
    assert summary['achieved_rate'] == near(48 / 3.0, rel=1e-14)


def test_percentiles_of_a_group_lie_between_its_ticks():
    """20 ticks, late by 0, 100, .. 1900 us: half of the way is 950 us, 99 % of it 1881 us."""
    _, groups = by_hand(100_000 * np.arange(20))
    assert groups[0, 2:] == pytest.approx([950e3, 1881e3, 1900e3], abs=1e-6)
