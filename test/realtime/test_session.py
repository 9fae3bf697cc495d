# SPDX-License-Identifier: Apache-2.0
"""The work of the tick thread: what is prefetched and when, commands that time out, the end."""

import types

import numpy as np
import pytest

from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages.state_topics import Frames, chosen, scene_messages
from rigid_body_sim.node.journal import NoJournal
from rigid_body_sim.node.rehearsal import _Nowhere, _Queue
from rigid_body_sim.realtime import session as module
from rigid_body_sim.realtime.session import Session
from rigid_body_sim.simulation.admission import Refusal
from rigid_body_sim.simulation.command_rows import HOLD, IMPULSE, ZERO, row_of
from rigid_body_sim.simulation.simulation import Simulation

pytestmark = pytest.mark.without_numba


class Publishers(_Nowhere):
    """Publishers that keep the messages of each tick, and the events with their ticks."""

    def __init__(self, messages):
        super().__init__(messages)
        self.ticks, self.display, self.events, self.scenes = [], [], [], []

    def tick(self, messages):
        self.ticks.append(b''.join(messages))

    def paced(self, messages):
        self.display.append(len(self.ticks) - 1)
        return super().paced(messages)

    def event(self, level, name, message, values):
        self.events.append((name, values['tick'], values))
        return super().event(level, name, message, values)

    def scene(self, scene):
        self.scenes.append(len(self.ticks))
        return super().scene(scene)


def begun(rate=100.0, duration=0.0, timeout=0.0, publish=(), display=30.0):
    """Return a Session that has begun, its publishers, and its ticks that looked ahead."""
    one = Simulation('tennis_racket', rate=rate)
    publishing = Publishers(scene_messages(chosen(publish), one.scene, Frames()))
    settings = types.SimpleNamespace(
        command_timeout=timeout, duration=duration, display_rate=display)
    session = Session(one, _Queue(), publishing, NoJournal(), settings, lambda: 7)
    session.begin()
    looked, foresee = [], one.foresee

    def foresees(count):
        looked.append((session.next_tick - 1, count))
        return foresee(count)
    one.foresee = foresees
    return session, publishing, looked


def run(session, until):
    while session.next_tick <= until:
        session.run_tick(True)


@pytest.mark.parametrize(('rate', 'count'), [(1000.0, 64), (100.0, 64), (2000.0, 32),
                                             (3000.0, 22), (1e5, 1)])
def test_64_milliseconds_are_prefetched_but_not_more_than_64_ticks(rate, count):
    """That begins 16 ticks after the start, and again when the last of them is sent."""
    session, publishing, looked = begun(rate)
    run(session, 16 + 2 * count)
    assert looked == [(16 + k * count, count) for k in range(3)]
    alone, others, _ = begun(rate)
    alone.simulation.foresee = lambda count: ()
    run(alone, 16 + 2 * count)
    assert publishing.ticks == others.ticks


def test_where_nothing_can_be_foreseen_it_is_tried_again_after_16_ticks():
    session, _, looked = begun()
    session.simulation.foresee = lambda count: looked.append(session.next_tick - 1) or ()
    run(session, 60)
    assert looked == [16, 32, 48]


@pytest.mark.parametrize('how', ['command', 'reset'])
def test_what_disturbs_the_body_drops_what_was_prefetched(how):
    session, publishing, looked = begun()
    run(session, 29)
    if how == 'command':
        session._commands.put(row_of(IMPULSE, ZERO, [0.1, 0.0, 0.0], 'body'))
    else:
        session.request(Session.reset)
    run(session, 50)
    assert [tick for tick, _ in looked] == [16, 46]    # it was disturbed at tick 30
    same, others, _ = begun()
    run(same, 50)
    assert publishing.ticks[:30] == others.ticks[:30]
    assert publishing.ticks[31] != others.ticks[31]


@pytest.mark.parametrize(('duration', 'last'), [(0.0625, 4), (0.03125, 2), (0.07, 5), (0.0, None)])
def test_the_last_tick_is_the_first_one_by_which_the_duration_has_passed(duration, last):
    session, _, _ = begun(rate=64.0, duration=duration)
    for tick in range(6):
        assert session.finished == (last is not None and tick > last)
        session.run_tick(True)


def test_a_held_wrench_ends_so_many_ticks_after_its_last_command():
    session, publishing, _ = begun(timeout=0.05)
    hold = row_of(HOLD, ZERO, [0.1, 0.0, 0.0], 'body')
    for tick, rows in ((3, np.concatenate([row_of(IMPULSE, ZERO, [0.1, 0, 0], 'body'), hold])),
                       (6, hold)):
        run(session, tick - 1)
        session._commands.put(rows)
    held = []
    while session.next_tick < 14:
        session.run_tick(True)
        held.append(bool(session.simulation.wrench))
    assert held == [True] * 5 + [False] * 3    # of the ticks from 6 on
    assert [event[:2] for event in publishing.events] == [('command timed out', 11)]
    assert session._commands.applied == 3    # that it ended is no command


def test_without_a_time_limit_a_wrench_is_held():
    session, publishing, _ = begun()
    session._commands.put(row_of(HOLD, ZERO, [0.1, 0.0, 0.0], 'body'))
    run(session, 30)
    assert session.simulation.wrench and publishing.events == []


@pytest.mark.parametrize(('keep', 'held', 'events', 'scenes'), [
    (True, 3, [('command timed out', 13)], [0]), (False, 0, [], [0, 10])])
def test_at_another_rate_time_goes_on_from_the_instant_of_its_tick(keep, held, events, scenes):
    """Here at tick 10, 0.1 s after the start; with another scene what was held ends."""
    session, publishing, _ = begun(duration=0.3, timeout=0.05, publish=['tf'])
    run(session, 7)
    session._commands.put(row_of(HOLD, ZERO, [0.1, 0.0, 0.0], 'body'))
    run(session, 9)
    other, wrenches = Simulation('tennis_racket', rate=50.0), []
    session.request(lambda session: session.switch(other, publishing.messages, keep))
    while not session.finished:
        session.run_tick(True)
        wrenches.append(bool(session.simulation.wrench))
    assert (session.next_tick, session.stamp - 7) == (21, 320_000_000)
    # the display, at 30 Hz, of ticks at 50 Hz
    assert publishing.display == [0, 4, 7, 10, 12, 14, 15, 17, 19, 20]
    assert wrenches == [True] * held + [False] * (11 - held)
    assert [event[:2] for event in publishing.events] == events
    assert publishing.scenes == scenes


def test_what_is_refused_is_told_and_the_rest_takes_effect():
    session, _, _ = begun(timeout=0.05)
    refused, noted = [], []
    session._commands.refuse = lambda *told: refused.append(told)
    session._journal.commands = lambda tick, stamp, rows: noted.append((tick, rows.tolist()))
    good = row_of(IMPULSE, ZERO, [0.1, 0.0, 0.0], 'body')
    run(session, 2)
    session._commands.put(np.concatenate([row_of(kind, ZERO, [np.nan, 0.0, 0.0], 'body')
                                          for kind in (IMPULSE, HOLD)] + [good]))
    run(session, 3)
    assert noted == [(3, good.tolist())] and session._commands.applied == 1
    # a valid command is shown beside the numbers
    assert [(topic, reason, remedy) for topic, reason, _, remedy in refused] == [
        ('cmd_impulse', 'not finite', ''), ('cmd_wrench', 'not finite', '')]
    assert refused[0][2].startswith('force [0.0, 0.0, 0.0], torque [nan')
    session.simulation.command = lambda rows: [Refusal(0, 'no', BadInput('x', 'got 1', '2'))]
    session._commands.put(good)
    run(session, 20)
    assert refused[2:] == [('cmd_impulse', 'no', '1', '2')]
    assert len(noted) == 1


def test_a_release_that_is_refused_is_tried_again_at_the_next_tick():
    session, publishing, _ = begun(timeout=0.05)
    session._commands.put(row_of(HOLD, ZERO, [0.1, 0.0, 0.0], 'body'))
    run(session, 4)
    command, tries = session.simulation.command, []

    def refuses_twice(rows):
        tries.append(session.next_tick)
        return [Refusal(0, 'no', BadInput('x', 'got 1', '2'))] if len(tries) < 3 else command(rows)
    session.simulation.command = refuses_twice
    run(session, 9)
    assert tries == [5, 6, 7]
    assert [event[:2] for event in publishing.events] == [('command timed out', 7)]


def test_what_has_a_rate_of_its_own_is_published_at_the_first_tick_at_or_after_its_time():
    session, publishing, looked = begun(publish=['tf'])
    run(session, 40)
    assert looked    # some of it is prefetched
    assert publishing.display == [-(-k * 100 // 30) for k in range(13)]


def test_a_balance_is_of_the_tick_at_which_it_was_asked_for():
    session, _, _ = begun()
    assert session.balance['tick'] == 0
    run(session, 25)
    assert session.balance['tick'] == 0
    session.want_balance()
    run(session, 26)
    assert (session.balance['tick'], session.balance['time']) == (26, 0.26)
    looked = []
    session._commands.look = lambda: looked.append(1)
    session.want_balance()
    session.between_ticks()
    run(session, 30)
    assert (session.balance['tick'], looked) == (26, [1])


def test_of_one_reason_a_refusal_is_told_once_a_second_with_how_many_were_not(monkeypatch):
    session, publishing, _ = begun()
    for now, reason in ((0, 'a'), (5, 'a'), (7, 'b'), (10**9 - 1, 'a'), (10**9, 'a'),
                        (2 * 10**9 - 1, 'a'), (3 * 10**9, 'a'), (4 * 10**9, 'a')):
        monkeypatch.setattr(module, 'time', types.SimpleNamespace(
            monotonic_ns=lambda now=now: now))
        session._report_refusal('cmd_wrench', reason, 'nan', 'numbers')
    assert [(values['reason'], values['not_told_since']) for _, _, values in publishing.events] \
        == [('a', 0), ('b', 0), ('a', 2), ('a', 1), ('a', 0)]
    assert session.event_counts == {'command refused': 5}
