# SPDX-License-Identifier: Apache-2.0
"""The end of a process: by a signal or by itself, once, and soon even if it is busy."""

import io
import os
import signal
import sys
import threading
import types

import pytest

from rigid_body_sim.realtime import shutdown
from rigid_body_sim.realtime.shutdown import Stop

pytestmark = pytest.mark.without_numba


@pytest.fixture
def later(monkeypatch):
    """Return what is to be called later: (seconds, function, its arguments)."""
    calls = []
    monkeypatch.setattr(shutdown, '_later', lambda *call: calls.append(call))
    return calls


def test_a_program_that_ends_by_itself_has_the_time_that_it_takes(later):
    stop, woken = Stop(), []
    assert (stop.wanted, stop.by_signal) == (False, False)
    stop.on_request(lambda: woken.append(1))
    assert woken == []
    stop.request()
    assert (stop.wanted, stop.by_signal, woken, later) == (True, False, [1], [])
    stop.on_request(lambda: woken.append(2))    # it is wanted already
    assert woken == [1, 2]


def test_after_a_signal_it_ends_within_a_second_and_further_ones_change_nothing(
        later, monkeypatch):
    stop, woken, done = Stop(), [], []
    stop.on_request(lambda: woken.append(1))
    for _ in range(3):
        stop.signalled()
    assert (stop.wanted, stop.by_signal, len(woken)) == (True, True, 3)
    [(seconds, end)] = later
    monkeypatch.setattr(os, '_exit', done.append)
    stop.last_resort = lambda: done.append('files are closed')
    end()
    [_, (more, leave, status)] = later    # if closing hangs as well
    assert 0.0 < seconds + more < 1.0
    assert done == ['files are closed', 0]
    leave(status)
    assert done[-1] == 0


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_signals_ask_for_the_end_and_are_as_before_after_it(later, number):
    handlers = {one: signal.getsignal(one) for one in (
        signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
    with shutdown.signals() as stop:
        assert not stop.wanted
        os.kill(os.getpid(), number)
        assert stop._event.wait(60.0)
        assert stop.by_signal
    assert {one: signal.getsignal(one) for one in handlers} == handlers
    assert signal.set_wakeup_fd(-1) == -1


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_that_comes_as_its_handler_is_set_is_heard(later, monkeypatch, number):
    """It was lost: the pipe was there after the handlers only."""
    set_handler, sent = signal.signal, []

    def and_send(handled, handler):
        replaced = set_handler(handled, handler)
        if handled == number and not sent:
            sent.append(handled)
            signal.raise_signal(handled)
        return replaced
    monkeypatch.setattr(signal, 'signal', and_send)
    with shutdown.signals() as stop:
        assert stop._event.wait(60.0)
        assert stop.by_signal


def test_a_signal_that_something_else_handles_does_not_end_it():
    before, heard = signal.signal(signal.SIGALRM, lambda *_: None), []
    with shutdown.signals() as stop:
        stop.signalled = lambda: heard.append(1)
        signal.raise_signal(signal.SIGALRM)
        signal.raise_signal(signal.SIGTERM)
    signal.signal(signal.SIGALRM, before)
    assert heard == [1]


def test_a_signal_at_the_very_end_does_not_hide_that_it_is_the_end(later, monkeypatch):
    """Both are in the pipe at once, since the thread that reads it was busy with another one."""
    busy, ended, write = threading.Event(), threading.Event(), os.write

    def writes(*told):
        write(*told)
        ended.set()
    monkeypatch.setattr(os, 'write', writes)
    heard = []

    def signalled():
        busy.set()
        assert ended.wait(60.0)
        heard.append(1)
    with shutdown.signals() as stop:
        stop.signalled = signalled
        signal.raise_signal(signal.SIGTERM)
        assert busy.wait(60.0)
        signal.raise_signal(signal.SIGTERM)
    assert heard == [1, 1]


def test_under_nohup_the_end_of_the_terminal_is_not_heard(later):
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with shutdown.signals():
            assert signal.getsignal(signal.SIGHUP) == signal.SIG_IGN
            assert signal.getsignal(signal.SIGTERM) not in (signal.SIG_IGN, signal.SIG_DFL)
    finally:
        signal.signal(signal.SIGHUP, before)


@pytest.mark.parametrize(('name', 'write'), [('stdout', shutdown.tell), ('stderr', shutdown.say)])
def test_a_line_is_there_at_once_if_anybody_reads_it(monkeypatch, name, write):
    read = io.BytesIO()
    stream = io.TextIOWrapper(read)
    monkeypatch.setattr(sys, name, stream)
    write('a line')
    assert read.getvalue() == b'a line\n'
    stream.close()
    write('another one')


def test_what_is_to_come_later_keeps_no_process_alive(monkeypatch):
    begun = []

    def timer(*told):
        made = types.SimpleNamespace(daemon=False)
        made.start = lambda: begun.append((made.daemon, told))
        return made
    monkeypatch.setattr(threading, 'Timer', timer)
    shutdown._later(0.5, print, 'a', 'b')
    assert begun == [(True, (0.5, print, ('a', 'b')))]
