# SPDX-License-Identifier: Apache-2.0
"""The end of a node's process: within a second of a signal, and without loss.

A thread of its own receives signals through a pipe, because Python runs signal handlers only
between two bytecodes of the main thread, which waits in the executor. The first signal asks for
the end; later ones change nothing. This module imports nothing slow, so that signals are handled
before the rest is loaded.
"""

import contextlib
import os
import signal
import sys
import threading

GRACE, LAST_GRACE = 0.7, 0.2
"""Longest time from a signal to the last resort, and from there to the end, s.

The recorder is a process of its own and finishes its file in any case.
"""


class Stop:
    """A request to end, by a signal or by the program itself."""

    def __init__(self):
        self._event = threading.Event()
        self._wake = lambda: None
        self.by_signal = False
        self.last_resort = lambda: None
        """Function that closes files in another thread, if the process is still busy after
        the longest time."""

    @property
    def wanted(self):
        """Whether the process should end."""
        return self._event.is_set()

    def on_request(self, wake):
        """Register a function that wakes the main thread."""
        self._wake = wake
        if self.wanted:
            wake()

    def request(self):
        """Ask for the end, from any thread."""
        self._event.set()
        self._wake()

    def signalled(self):
        """Ask for the end because of a signal; it comes soon even if the process is busy."""
        if not self.by_signal:
            self.by_signal = True
            _later(GRACE, self._end)
        self.request()

    def _end(self):
        _later(LAST_GRACE, os._exit, 0)
        self.last_resort()
        os._exit(0)


def _later(seconds, function, *arguments):
    timer = threading.Timer(seconds, function, arguments)
    timer.daemon = True
    timer.start()


@contextlib.contextmanager
def signals():
    """Yield a Stop that SIGINT, SIGTERM and SIGHUP ask to end (SIGHUP not under ``nohup``)."""
    stop = Stop()
    ours = [
        number
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
        if number != signal.SIGHUP or signal.getsignal(number) != signal.SIG_IGN
    ]
    reading, writing = os.pipe()
    os.set_blocking(writing, False)

    def listen():
        # the interpreter writes the number of each signal that anybody handles; a zero ends this
        while number := os.read(reading, 1)[0]:
            if number in ours:
                stop.signalled()

    listener = threading.Thread(target=listen, name='signals', daemon=True)
    # the pipe is there before the first handler and until the last one has gone, since a signal
    # that is handled but not written to it is lost
    pipe_before = signal.set_wakeup_fd(writing, warn_on_full_buffer=False)
    listener.start()
    before = {number: signal.signal(number, lambda *_: None) for number in ours}
    try:
        yield stop
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        signal.set_wakeup_fd(pipe_before)
        os.write(writing, b'\0')
        listener.join()
        os.close(reading)
        os.close(writing)


def say(line):
    """Print one line to stderr, if anybody is there to read it."""
    with contextlib.suppress(OSError, ValueError):
        print(line, file=sys.stderr, flush=True)


def tell(line):
    """Print one line to stdout, if anybody is there to read it."""
    with contextlib.suppress(OSError, ValueError):
        print(line, flush=True)


def leave(status):
    """End the process at once, when everything is closed.

    With numba loaded, the usual way out of Python takes up to a second.
    """
    for stream in (sys.stdout, sys.stderr):
        # a closed terminal must not turn the end into a failure
        with contextlib.suppress(OSError, ValueError):
            stream.flush()
    os._exit(status)
