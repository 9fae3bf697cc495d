# SPDX-License-Identifier: Apache-2.0
"""Playback of a recording: one thread reads ahead, one publishes each message when it is due.

The instant of a message is that of the first one plus the difference of their log times over the
rate, on the monotonic clock of the machine; it does not depend on when other messages were sent,
so nothing drifts, however many loops are played. A loop begins where the one before ended.
"""

import itertools
import queue
import threading
import time
from fractions import Fraction

from rigid_body_sim.messages.timeline import NANOSECONDS
from rigid_body_sim.realtime.lateness import Lateness
from rigid_body_sim.realtime.priority import ask_for_priority

CLOCK_PERIOD = 10_000_000
"""Time between two messages on /clock, ns of the steady clock."""
LONGEST_SLEEP = 10_000_000      # ns
MOST_REAL_TIME = 20.0
"""Largest rate with real-time scheduling: a faster thread may never sleep."""
BATCH, BATCH_BYTES, BATCHES = 256, 2**20, 32


class Reading(threading.Thread):
    """A thread that reads ahead, by a bounded number of messages.

    Parameters
    ----------
    recording : Recording
    topics : list of str
    start, end : int
        Log times of the first and the last instant to be played, ns.
    loop : bool
        Whether to begin anew at the end, for ever.
    """

    def __init__(self, recording, topics, start, end, loop):
        super().__init__(name='reading', daemon=True)
        self._recording, self._topics, self._loop = recording, topics, loop
        self.start_time, self.end_time = start, end
        self._batches = queue.Queue(BATCHES)

    def run(self):
        """Read until the end."""
        try:
            period = self.end_time - self.start_time
            for number in itertools.count() if self._loop else (0,):
                # offset of this loop from the start of the first one
                self._read(number * period - self.start_time)
        except Exception as failure:        # the other thread passes it on
            self._batches.put(failure)
        else:
            self._batches.put(None)

    def _read(self, shift):
        batch, size = [], 0
        for message in self._recording.messages(self._topics, self.start_time, self.end_time):
            batch.append((message.log_time + shift, message))
            size += len(message.data)
            if len(batch) >= BATCH or size >= BATCH_BYTES:
                self._batches.put(batch)
                batch, size = [], 0
        self._batches.put(batch)

    def __iter__(self):
        """Yield (position, Message); the position counts from the start of the first loop, ns.

        An error of the reading thread is raised here.
        """
        while (batch := self._batches.get()) is not None:
            if isinstance(batch, Exception):
                raise batch
            yield from batch


class Player(threading.Thread):
    """A thread that publishes messages as they become due.

    Parameters
    ----------
    reading : Reading
        Not started yet.
    publish : dict
        Name of a topic -> function that takes a message's bytes.
    tell_clock : callable
        Called with the time in the recording (ns), every CLOCK_PERIOD.
    rate : float
        Seconds of the recording per second.
    paused : bool
        Whether to wait for :meth:`resume` before the first message.
    at_end : callable
        Called in this thread when it ends by itself.

    Attributes
    ----------
    published : int
        Messages so far.
    now : int
        The time in the recording, ns.
    loops : int
        Loops that were begun.
    lateness : Lateness
        Of messages: from their instants until they are handed over.
    seconds : float
        From the first instant to the last message, without pauses.
    failure : Exception or None
    """

    def __init__(self, reading, publish, tell_clock, rate, paused, at_end):
        super().__init__(name='replay', daemon=True)
        self._reading, self._publish = reading, publish
        self._tell_clock, self._at_end = tell_clock, at_end
        self._rate, self._ratio = rate, Fraction(rate).as_integer_ratio()
        self._paused, self._stopping = paused, False
        self._origin = self._next_clock = 0
        self.published = self.loops = 0
        self.now, self.seconds = reading.start_time, 0.0
        self.lateness, self.failure = Lateness(), None

    def pause(self):
        """Publish nothing until :meth:`resume`."""
        self._paused = True

    def resume(self):
        """Go on as if no time had passed."""
        self._paused = False

    def stop(self):
        """Ask the thread to end."""
        self._stopping = True

    def run(self):
        """Publish until the end."""
        try:
            ask_for_priority(self._rate <= MOST_REAL_TIME)
            self._reading.start()
            self._play(iter(self._reading))
        except Exception as failure:
            self.failure = failure
        finally:
            self._at_end()

    def _play(self, messages):
        first = next(messages, None)        # the clock starts once the first messages are read
        self._origin = time.monotonic_ns()
        for position, message in itertools.chain([first] if first else (), messages):
            if message.log_time < self.now or not self.loops:
                self.loops += 1
            late = self._wait(position, message.log_time)
            if late is None:
                return
            self.now = message.log_time
            self._publish[message.topic](message.data)
            self.lateness.add(late)
            self.published += 1
        self.seconds = (time.monotonic_ns() - self._origin) / NANOSECONDS
        self._tell_clock(self._reading.end_time)

    def _wait(self, position, log_time):
        """Wait until a position is due; return how late it is (ns), None at the end."""
        numerator, denominator = self._ratio
        ahead = position * denominator // numerator
        while not self._stopping:
            if self._paused:
                self._idle()
                continue    # it may have been stopped meanwhile
            now = time.monotonic_ns()
            left = self._origin + ahead - now
            if now >= self._next_clock:
                self._next_clock = now + CLOCK_PERIOD
                self._tell_clock(max(self.now, log_time - max(0, left) * numerator // denominator))
            if left <= 0:
                return -left
            time.sleep(min(left, LONGEST_SLEEP, max(self._next_clock - now, 0)) / NANOSECONDS)
        self.seconds = (time.monotonic_ns() - self._origin) / NANOSECONDS
        return None

    def _idle(self):
        """Wait until resumed; /clock shows the same time meanwhile."""
        since = time.monotonic_ns()
        while self._paused and not self._stopping:
            self._tell_clock(self.now)
            time.sleep(CLOCK_PERIOD / NANOSECONDS)
        self._origin += time.monotonic_ns() - since
