# SPDX-License-Identifier: Apache-2.0
"""What the recorder of a node sends, keeps, drops and says; the process at the other end is here.

The test reads the packets, writes the reports, and moves the clock.
"""

import contextlib
import fcntl
import json
import os
import resource
import types

import numpy as np
import pytest
from recording.conftest import ABOUT, JOURNAL, SCENE, TICKING

from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording import packets
from rigid_body_sim.recording import recorder as module
from rigid_body_sim.recording.packets import Report
from rigid_body_sim.recording.recorder import Recorder
from rigid_body_sim.simulation.command_rows import WIDTH

pytestmark = pytest.mark.without_numba
DATA = [bytes([k]) * size for k, (_, size) in enumerate(TICKING)]
TICK = packets.TICK_HEAD.size + sum(size for _, size in TICKING)
PIPE = resource.getpagesize()    # the smallest one that there is
FULL = PIPE // TICK
"""So many ticks are in a pipe that nobody reads: a small packet is written as a whole."""


class Fed(Recorder):
    """A Recorder whose processes are the test's."""

    def __init__(self, *arguments, first=None):
        self.now, self.made, self._first = 100.0, [], first or Report(resend=1, state_wanted=1)
        super().__init__(*arguments, TICKING, [SCENE], JOURNAL, ABOUT)

    def _start(self, resume):
        self.packets, into = os.pipe()
        out, self.reports = os.pipe()
        fcntl.fcntl(into, fcntl.F_SETPIPE_SZ, PIPE)
        for one in (self.packets, into, out):
            os.set_blocking(one, False)
        self._packets_in, self._reports_out = into, out
        self._lines, self._begun, self._started_at = b'', 0, self.now
        self._process = types.SimpleNamespace(pid=7, poll=lambda: self.code, kill=self.kill)
        self.code, self.killed = None, False
        self.made.append(resume)
        self.report(self._first)

    def kill(self):
        self.killed = True

    def sleep(self, seconds):
        self.now += seconds

    def report(self, report):
        os.write(self.reports, report.line())

    def tell(self, **values):
        """Report something, and let it be read."""
        self.report(Report(**{'resend': 1, 'state_wanted': 1, **values}))
        self._look_now()

    def ticks(self, count):
        for _ in range(count):
            self.tick(self._ticks, 0, DATA)

    def read(self):
        """Return what is in the pipe."""
        with contextlib.suppress(BlockingIOError):
            return os.read(self.packets, 2**20)
        return b''

    def take(self):
        """Take all that waits, as a recorder does; return (tag, number) of each packet."""
        data = self.read()
        while self.status().waiting or data == b'':
            more = self.read()
            if not more and not self.status().waiting:
                break
            data += more
        data += self.read()
        found = []
        while data:
            tag, length = packets.HEAD.unpack_from(data)
            number = (None if tag in (packets.SETUP, packets.END)
                      else int.from_bytes(data[packets.HEAD.size:packets.HEAD.size + 8],
                                          'little'))
            body, data = data[:packets.HEAD.size + length], data[packets.HEAD.size + length:]
            if tag == packets.TICK:
                assert body[packets.TICK_HEAD.size:] == b''.join(DATA)
            found.append((tag, number))
        return found


@pytest.fixture
def begin(monkeypatch):
    """Return a function that begins a recording."""
    def begin(**options):
        fed = Fed.__new__(Fed)
        monkeypatch.setattr(module, 'time', types.SimpleNamespace(
            monotonic=lambda: fed.now, sleep=fed.sleep))
        fed.__init__('bag', **options)
        return fed
    return begin


def told(fed):
    status = fed.status()
    return status.dropped, status.lost, status.waiting, status.error


def numbers(first, count):
    return [(packets.TICK, number) for number in range(first, first + count)]


def test_what_the_pipe_does_not_take_waits_and_comes_whole_and_in_order(begin):
    fed = begin()
    fed.ticks(FULL)
    assert fed._waiting_size == 0
    assert told(fed) == (0, 0, 0, '')
    fed.ticks(1)
    assert told(fed) == (0, 0, TICK, '')
    fed.ticks(300)    # several times what is written at once
    assert told(fed) == (0, 0, 301 * TICK, '')
    fed.important('/scene', 0, 0, bytes(3 * PIPE))    # more than the pipe takes at once
    fed.message('/scene', 0, 0, b'y')
    fed.ticks(2)
    assert fed.take() == [*numbers(0, FULL + 301), (packets.MESSAGE, 1), (packets.MESSAGE, 0),
                          *numbers(FULL + 301, 2)]
    assert told(fed) == (0, 0, 0, '')
    fed.ticks(1)    # written at once again
    assert fed.read()[-len(DATA[-1]):] == DATA[-1]


@pytest.mark.skipif(PIPE != 4096, reason='by numbers of ticks for pages of 4 KiB')
@pytest.mark.parametrize('spare', [0, 1, TICK - 1])
def test_beyond_the_limit_ticks_are_dropped_until_half_of_what_waits_has_gone(
        begin, monkeypatch, spare):
    """As many wait as reach the limit, and one more where they do not go beyond it."""
    monkeypatch.setattr(module, 'BACKLOG', 69 * TICK + spare)
    fed = begin()
    fed.ticks(FULL + 70)
    assert told(fed) == (0, 0, 70 * TICK, '')
    fed.message('/scene', 0, 0, b'y')    # this may be lost, too, but is no tick
    fed.ticks(3)
    assert told(fed) == (3, 0, 70 * TICK, '')
    fed.important('/scene', 0, 0, b'')    # this may not
    waiting = 70 * TICK + packets.MESSAGE_HEAD.size
    assert told(fed) == (3, 0, waiting, '')
    # two thirds of them wait when the pipe has been emptied once, and a third the next time
    for taken, dropped in ((PIPE, 4), (2 * PIPE, 0)):
        fed.read()
        fed._pump()
        assert fed._waiting_size == pytest.approx(waiting - taken, abs=TICK)
        fed.ticks(1)
        assert fed._dropped_now == dropped
    assert told(fed)[0] == 0    # the gap is the recorder's to count now
    fed.tell(dropped=4)
    assert told(fed)[0] == 4


def test_a_recorder_that_hangs_costs_a_fraction_of_the_memory_of_a_small_machine():
    """There is room for seconds of ticks at 1 kHz, and not for a gigabyte."""
    assert 10_000 * TICK < module.BACKLOG < module.UNCONFIRMED < 2**30 - module.BACKLOG


def test_important_messages_are_kept_until_they_are_in_the_file_up_to_a_limit(begin, monkeypatch):
    size = packets.MESSAGE_HEAD.size + 100
    monkeypatch.setattr(module, 'UNCONFIRMED', 3 * size)
    fed = begin()
    for _ in range(5):
        fed.important('/scene', 0, 0, bytes(100))
    assert told(fed)[1] == 2
    assert fed.take() == [(packets.MESSAGE, number) for number in (1, 2, 3)]
    fed.commands(0, 0, 0, np.zeros((4, WIDTH)))    # four messages, and what the journal has
    assert told(fed)[1] == 7
    fed.tell(acknowledged=2)
    assert (fed._unconfirmed[0][0], fed._unconfirmed_size) == (3, size)
    fed.important('/scene', 0, 0, bytes(100))
    assert told(fed)[1] == 7
    assert fed.take() == [(packets.MESSAGE, 4)]


def test_commands_have_a_number_for_each_message_that_they_become(begin):
    fed = begin()
    fed.important('/scene', 0, 0, b'')
    fed.commands(3, 0, 0, np.zeros((2, WIDTH)))
    fed.journal('reset', 0, 0, tick=3)
    assert fed.take() == [(packets.MESSAGE, 1), (packets.COMMANDS, 2), (packets.MESSAGE, 5)]
    fed.tell(acknowledged=3)    # half of the commands: they come again as a whole
    assert [number for number, _ in fed._unconfirmed] == [4, 5]


def test_what_the_recorder_lacks_comes_again_before_what_waits_and_once(begin):
    fed = begin()
    for _ in range(3):
        fed.important('/scene', 0, 0, b'')
    fed.take()
    fed.ticks(FULL + 2)
    fed.important('/scene', 0, 0, b'')    # waits behind two ticks
    waiting = told(fed)[2]
    fed.tell(acknowledged=1, resend=2)
    assert told(fed)[2] == waiting + 2 * packets.MESSAGE_HEAD.size
    fed.tell(acknowledged=1, resend=2)    # asked once
    assert fed.take() == [*numbers(0, FULL), (packets.MESSAGE, 2), (packets.MESSAGE, 3),
                          *numbers(FULL, 2), (packets.MESSAGE, 4)]


def test_a_packet_that_is_half_in_the_pipe_is_ended_before_what_comes_again(begin):
    fed = begin()
    fed.important('/scene', 0, 0, b'')
    fed.message('/scene', 0, 0, bytes(3 * PIPE))
    assert 0 < fed._begun < 3 * PIPE
    fed.tell(resend=2)
    assert fed.take() == [(packets.MESSAGE, 1), (packets.MESSAGE, 0), (packets.MESSAGE, 1)]


def test_reports_are_read_twenty_times_a_second_and_the_newest_counts(begin):
    fed = begin()
    fed.ticks(1)
    for recorded, later, known in ((4, 0.0, 0), (8, 0.046875, 0), (12, 0.015625, 12)):
        fed.report(Report(recorded=recorded, resend=1))
        fed.now += later
        fed.ticks(1)
        assert fed._report.recorded == known
    # half of a line waits for its other half
    line = Report(recorded=16, resend=1).line()
    for part, known in ((line[:9], 12), (line[9:], 16)):
        os.write(fed.reports, part)
        assert fed.status().recorded == known


def test_a_full_state_is_wanted_once_for_each_request(begin):
    fed = begin()
    assert fed.state_wanted and fed.tick(0, 0, DATA) is True
    fed.state_wanted = False
    fed.tell(state_wanted=1)
    assert not fed.state_wanted and fed.tick(0, 0, DATA) is False
    fed.tell(state_wanted=2)
    assert fed.state_wanted


def test_a_recorder_that_died_is_followed_by_another_a_second_after_it_began(begin):
    fed = begin()
    fed.code = -9
    for later, restarts in ((0.5, 0), (0.25, 0), (0.25, 1), (0.75, 1)):
        fed.now += later
        assert fed.status().restarts == restarts
    assert fed.made == [False, True]
    fed.ticks(1)    # it waits until that one is ready, though nothing else does
    assert told(fed)[2] == TICK
    fed.report(Report(resend=2))
    assert told(fed) == (0, 0, 0, '')
    assert fed.take() == numbers(0, 1)


def test_files_are_not_split_and_no_commands_come_unless_that_is_said(begin):
    setup = begin()._setup
    assert (setup['split_bytes'], setup['split_seconds'], setup['commands']) == (0, 0.0, None)


def test_until_the_next_recorder_is_ready_that_is_said_and_everything_waits(begin):
    fed = begin()
    fed._first, fed.code = Report(resend=1), 1
    os.close(fed.packets)
    fed.ticks(1)
    assert fed._begun == 0    # nobody has taken a part of it
    fed.important('/scene', 0, 0, b'')
    fed.ticks(1)
    assert fed._begun == 0
    waiting = packets.MESSAGE_HEAD.size + 2 * TICK
    assert told(fed) == (0, 0, waiting, 'the recorder died; a new one is starting')
    fed.now += 1.0
    assert told(fed) == (0, 0, waiting, 'the recorder died; a new one is starting')
    fed.tell(resend=2)
    assert told(fed) == (0, 0, 0, '')
    assert fed.take() == [(packets.TICK, 0), (packets.MESSAGE, 1), (packets.TICK, 1)]


def test_one_that_has_closed_the_recording_did_not_die(begin):
    fed = begin()
    fed.tell(closed=True)
    fed.code, fed.now = 0, fed.now + 5.0
    assert told(fed) == (0, 0, 0, '') and fed.made == [False]


def test_while_the_disk_refuses_all_ticks_since_the_last_one_in_the_file_are_missing(begin):
    fed = begin()
    fed.ticks(9)
    fed.tell(ticks=4, dropped=2, error='full')
    assert told(fed) == (7, 0, 0, 'full')
    fed.tell(ticks=12, dropped=2, error='full')    # those of its predecessor
    assert told(fed) == (2, 0, 0, 'full')
    fed.tell(ticks=4, dropped=2, refused=('bag', 'is gone', 'a new one'))
    assert told(fed) == (2, 0, 0, 'bag; is gone; a new one')


@pytest.mark.parametrize(('code', 'first', 'said', 'waited'), [
    (None, Report(), 'recording: the recorder did not start', 30.0),
    (2, Report(refused=('there', 'exists already', 'another')), 'there: exists already', 0.0)])
def test_where_no_recorder_gets_ready_it_is_ended_and_that_is_told(
        monkeypatch, code, first, said, waited):
    fed = Fed.__new__(Fed)
    start = Fed._start

    def starts(self, resume):
        start(self, resume)
        self.code = code
    monkeypatch.setattr(Fed, '_start', starts)
    monkeypatch.setattr(module, 'time', types.SimpleNamespace(
        monotonic=lambda: fed.now, sleep=fed.sleep))
    with pytest.raises(BadInput, match=said):
        fed.__init__('bag', first=first)
    assert fed.killed
    assert fed.now == pytest.approx(100.0 + waited, abs=0.015)    # it looks every 10 ms


@pytest.mark.parametrize('backlog', [0, 100])
def test_at_the_end_all_that_waits_is_sent_and_how_many_ticks_there_were(
        begin, monkeypatch, backlog):
    fed = begin()
    fed.ticks(3 + backlog)
    got, read = [], fed.read

    def sleep(seconds):
        fed.now += seconds
        got.append(read())
        if got[-1].endswith(b'}'):
            fed.report(Report(resend=1, recorded=40, closed=True))
            fed.code = 0
    monkeypatch.setattr(module, 'time', types.SimpleNamespace(
        monotonic=lambda: fed.now, sleep=sleep))
    status = fed.close()
    assert (status.closed, status.recorded, status.waiting, status.error) == (True, 40, 0, '')
    sent, end = b''.join(got), packets.json_packet(packets.END, {'ticks': 3 + backlog})
    assert sent.endswith(end) and sent.count(end) == 1
    assert len(sent) == (3 + backlog) * TICK + len(end)
    assert json.loads(sent[-len(end) + packets.HEAD.size:]) == {'ticks': 3 + backlog}
    assert fed.now < 100.5


@pytest.mark.parametrize('timeout', [2.0, None])
def test_a_recorder_that_takes_nothing_is_left_when_the_time_is_up(begin, timeout):
    fed = begin()
    fed.ticks(FULL + 2)
    began = fed.now
    status = fed.close() if timeout is None else fed.close(timeout)
    assert fed.now == pytest.approx(began + (timeout or 30.0), abs=0.0075)    # it looks every 5 ms
    assert not status.closed
    assert status.error == f'the recorder was too slow to take the last {2 * TICK} bytes'


def test_a_recorder_that_ends_with_an_error_is_not_started_again(begin, monkeypatch):
    fed = begin()
    fed.ticks(1)

    def sleep(seconds):
        fed.now += seconds
        if fed.read().endswith(b'}'):
            fed.report(Report(resend=1, ticks=1, error='full; not closed'))
            fed.code = 1
    monkeypatch.setattr(module, 'time', types.SimpleNamespace(
        monotonic=lambda: fed.now, sleep=sleep))
    status = fed.close()
    assert (status.error, status.closed, status.restarts) == ('full; not closed', False, 0)
    assert fed.now < 100.5
