# SPDX-License-Identifier: Apache-2.0
"""Playback by a clock that only sleep moves: instants, /clock, loops, and how it ends."""

import types

import pytest
from near import near

from rigid_body_sim.realtime import playing
from rigid_body_sim.realtime.playing import Player, Reading

pytestmark = pytest.mark.without_numba
MS = 10**6


def message(log_time, size=8):
    return types.SimpleNamespace(topic='/a', log_time=log_time, data=bytes(size))


class Read:
    """Stands for a Reading of messages (position, log time)."""

    def __init__(self, *messages, start=0):
        self._messages, self.start_time, self.end_time = messages, start, start + 100 * MS

    def start(self):
        pass

    def __iter__(self):
        return ((position, message(time)) for position, time in self._messages)


@pytest.fixture
def play(monkeypatch):
    """Return a function that plays: (Player, when each message was sent, what /clock told)."""
    def play(reading, rate=1.0, paused=False, stop_at=None, cost=0, resume_at=None):
        clock, sent, told = types.SimpleNamespace(now=MS), [], []
        asked = []

        def sleep(seconds):
            clock.now += max(1, round(seconds * 1e9))
            assert seconds <= 0.01
            if stop_at is not None and clock.now >= stop_at:
                player.stop()
            if resume_at is not None and clock.now >= resume_at:
                player.resume()

        def publish(data):
            sent.append(clock.now - MS)
            clock.now += cost
        monkeypatch.setattr(playing, 'time', types.SimpleNamespace(
            monotonic_ns=lambda: clock.now, sleep=sleep))
        monkeypatch.setattr(playing, 'ask_for_priority', asked.append)
        ended = []
        player = Player(reading, {'/a': publish},
                        lambda time: told.append((clock.now - MS, time)), rate, paused is True,
                        lambda: ended.append(1))
        if paused == 'later':
            player.pause()
        player.run()
        assert player.failure is None and ended == [1]
        return player, sent, told, asked
    return play


def test_messages_are_sent_at_their_instants_and_the_clock_goes_on_between_them(play):
    player, sent, told, asked = play(Read((0, 50 * MS), (3 * MS, 53 * MS), (25 * MS, 75 * MS)))
    assert sent == [0, 3 * MS, 25 * MS]
    # every 10 ms, the time of the recording; at the end that of its end
    assert told == [(0, 50 * MS), (10 * MS, 60 * MS), (20 * MS, 70 * MS), (25 * MS, 100 * MS)]
    assert (player.published, player.loops, player.now) == (3, 1, 75 * MS)
    assert player.seconds == 0.025 and asked == [True]
    assert player.lateness.summary()['max'] == 0.0


def test_a_message_that_is_due_while_another_one_is_sent_is_late(play):
    player, sent, _, _ = play(Read((0, 0), (3 * MS, 3 * MS), (25 * MS, 25 * MS)), cost=5 * MS)
    assert sent == [0, 5 * MS, 25 * MS]
    assert player.lateness.summary()['max'] == near(0.002, rel=1e-12)


@pytest.mark.parametrize(('rate', 'sent', 'told', 'real_time'), [
    (2.0, [0, 10 * MS], [0, 20 * MS, 100 * MS], True),
    (0.5, [0, 40 * MS], [0, 5 * MS, 10 * MS, 15 * MS, 20 * MS, 100 * MS], True),
    (20.0, [0, MS], [0, 100 * MS], True), (25.0, [0, 800_000], [0, 100 * MS], False)])
def test_at_another_rate_instants_and_clock_are_stretched(play, rate, sent, told, real_time):
    player, at, clock, asked = play(Read((0, 0), (20 * MS, 20 * MS)), rate)
    assert at == sent and [time for _, time in clock] == told
    assert player.seconds == sent[-1] * 1e-9 and asked == [real_time]


def test_a_loop_begins_where_time_goes_back(play):
    player, sent, _, _ = play(Read(*((k * MS, k % 3 * MS) for k in range(8))))
    assert (player.loops, player.published, sent) == (3, 8, [k * MS for k in range(8)])


def test_messages_of_one_instant_are_of_one_loop(play):
    player, sent, _, _ = play(Read((0, 0), (0, 0), (3 * MS, 3 * MS), (3 * MS, 3 * MS)))
    assert (player.loops, player.published, sent) == (1, 4, [0, 0, 3 * MS, 3 * MS])


@pytest.mark.parametrize('paused', [True, 'later'])
def test_after_a_pause_it_goes_on_as_if_no_time_had_passed(play, paused):
    """A pause is looked at every 10 ms: one that ends after 25 ms has ended after 30 ms."""
    player, sent, told, _ = play(Read((0, 50 * MS), (3 * MS, 53 * MS), start=50 * MS),
                                 paused=paused, resume_at=26 * MS, stop_at=200 * MS)
    assert sent == [30 * MS, 33 * MS] and player.seconds == 0.003
    assert told[:3] == [(10 * k * MS, 50 * MS) for k in range(3)]
    assert told[-1] == (33 * MS, 150 * MS)


def test_of_no_messages_there_is_no_loop(play):
    player, sent, told, _ = play(Read())
    assert (player.loops, player.seconds, sent, told) == (0, 0.0, [], [(0, 100 * MS)])


@pytest.mark.parametrize(('paused', 'seconds'), [(False, 0.04), (True, 0.0)])
def test_when_it_is_stopped_it_sends_no_more(play, paused, seconds):
    """A pause does not count: /clock shows the same time meanwhile."""
    player, sent, told, _ = play(Read((0, 50 * MS), (90 * MS, 140 * MS), start=50 * MS),
                                 paused=paused, stop_at=41 * MS)
    assert (player.published, len(sent)) == ((0, 0) if paused else (1, 1))
    assert player.seconds == pytest.approx(seconds, abs=1e-12)
    assert {time for _, time in told} == (
        {50 * MS} if paused else {(50 + 10 * k) * MS for k in range(4)})


@pytest.mark.parametrize(('count', 'size', 'batches'), [
    (3, 8, [3]), (256, 8, [256, 0]), (300, 8, [256, 44]), (5, 2**19, [2, 2, 1]),
    (3, 2**20, [1, 1, 1, 0]), (4, 2**20 - 1, [2, 2, 0])])
def test_messages_are_read_by_a_few_hundred_or_a_megabyte(count, size, batches):
    asked = []

    def messages(topics, start, end):
        asked.append((topics, start, end))
        return (message(5 + k, size) for k in range(count))
    reading = Reading(types.SimpleNamespace(messages=messages), ['/a'], 5, 500, loop=False)
    reading.run()
    read = [reading._batches.get() for _ in range(reading._batches.qsize())]
    assert read.pop() is None and asked == [(['/a'], 5, 500)]
    assert [len(batch) for batch in read] == batches
    assert [position for batch in read for position, _ in batch] == list(range(count))


def test_each_loop_begins_where_the_one_before_ended():
    """Three loops over 40 ns, with messages after 5 and 25 ns; then the disk fails."""
    left = [[10, 30], [10, 30], [10, 30]]

    def messages(topics, start, end):
        return map(message, left.pop())
    reading = Reading(types.SimpleNamespace(messages=messages), [], 5, 45, loop=True)
    reading.run()
    positions = []
    with pytest.raises(IndexError):    # noqa: PT012, it is raised between them
        for position, _ in reading:
            positions.append(position)
    assert positions == [5, 25, 45, 65, 85, 105]


def test_nobody_waits_for_threads_that_have_not_begun():
    reading = Reading(None, [], 5, 45, loop=False)
    player = Player(reading, {}, None, 1.0, False, None)
    assert reading.daemon and player.daemon
    assert (player.now, player.seconds, player.published, player.loops) == (5, 0.0, 0, 0)


def test_an_error_while_reading_is_raised_in_the_thread_that_plays():
    def messages(*_):
        raise ValueError('cut')
    reading = Reading(types.SimpleNamespace(messages=messages), [], 0, 1, loop=False)
    reading.run()
    with pytest.raises(ValueError, match='cut'):
        next(iter(reading))
