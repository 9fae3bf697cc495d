# SPDX-License-Identifier: Apache-2.0
"""The tick thread: it runs one tick after the other, each at an absolute deadline.

The mean rate is therefore exact, however late single ticks are.

Tick k is due at a fixed instant of the monotonic clock (or of /clock). After a late tick the next
ones follow at once. A tick that comes more than a whole period late is an overrun.
With the policy ``skip_publish`` messages are then left out until the thread has caught up. With
either policy the schedule slips when the backlog passes a tenth of a second: simulated time falls
behind, and this is counted.
"""

import collections
import concurrent.futures
import math
import threading
import time
from fractions import Fraction

from rigid_body_sim.messages.timeline import NANOSECONDS, Timeline
from rigid_body_sim.realtime.lateness import Lateness
from rigid_body_sim.realtime.priority import ask_for_priority

LONGEST_SLEEP = 0.01
"""While it waits longer than this, the thread looks after commands and requests, s."""
BACKLOG = 100_000_000
"""Backlog at which the schedule slips, ns; it is never less than two ticks."""
CLOCK_JUMP = 10 * NANOSECONDS
"""A step of /clock forward by more than this is a jump, not the passing of time, ns."""


class Steady:
    """The monotonic clock of the machine."""

    follows_clock_topic = False
    now = staticmethod(time.monotonic_ns)

    @staticmethod
    def close():
        """Do nothing."""

    @staticmethod
    def wait(nanoseconds):
        """Sleep for this time, at most for LONGEST_SLEEP."""
        time.sleep(min(nanoseconds * 1e-9, LONGEST_SLEEP))


class Ticker(threading.Thread):
    """The thread that runs the ticks.

    Parameters
    ----------
    work : object
        ``work.begin()`` is called once, just before the first tick; ``work.next_tick`` is the
        number of the tick to run, ``work.run_tick(publish)`` runs it, ``work.between_ticks()``
        looks after commands while there is time, ``work.finished`` says that there are no more
        ticks to run.
    time_source : Steady, or what stands for it
        With ``follows_clock_topic``, ``now()`` (ns), ``wait(nanoseconds)`` and ``close()``.
    rate, real_time_factor : float
        See the parameters of the node; a factor of 0 runs without waiting.
    skip_publish : bool
        The policy at an overrun, see above.
    at_end : callable
        Called in this thread when it ends by itself: finished or failed.

    Attributes
    ----------
    failure : BaseException or None
        What ended the thread.
    lateness : Lateness
    overruns, skipped : int
        Ticks that came more than a period late; ticks run without publishing.
    slipped : int
        How far simulated time has fallen behind by slipping, ns.
    clock_jumps : int
        How often /clock jumped.
    latest : tuple of int
        How many ticks were run, and for how long (ns) ticks have been running up to the last one,
        without pauses and jumps.
    scheduling : str
        How the system schedules the thread.
    waiting_for_clock : bool
        Whether no message on /clock has come yet.
    """

    def __init__(self, work, time_source, rate, real_time_factor, skip_publish, at_end):
        super().__init__(name='ticks', daemon=True)
        self._work, self._source, self._at_end = work, time_source, at_end
        self._stopping = self._begun = False
        self._pauses = frozenset()
        self._steps = collections.deque()
        self._rate, self._factor = rate, real_time_factor
        self._due = self._left_out = 0
        self.skip_publish = skip_publish
        self.failure = None
        self.lateness = Lateness()
        self.overruns = self.skipped = self.slipped = self.clock_jumps = 0
        self.latest = (0, 0)
        self.scheduling = 'not started'
        self.waiting_for_clock = True

    # -- from other threads

    @property
    def paused(self):
        """Whether ticks wait for ``resume`` or ``step``."""
        return bool(self._pauses)

    def pause(self, reason='pause'):
        """Run no ticks until :meth:`resume` for the same reason."""
        self._pauses |= {reason}

    def resume(self, reason='pause'):
        """Go on ticking, unless there is another reason to pause."""
        self._pauses -= {reason}

    def step(self):
        """Run one tick while paused; return a Future of its number.

        The number is None if the node is resumed before.
        """
        future = concurrent.futures.Future()
        self._steps.append(future)
        return future

    def stop(self):
        """End the thread after the tick it is in."""
        self._stopping = True

    # -- the thread

    def pace(self, rate, real_time_factor):
        """Change the rate or the real-time factor from this tick on; call it in ``run_tick``."""
        self._rate, self._factor = rate, real_time_factor
        self._take_priority()
        self._schedule(self._due)

    def run(self):
        """Run ticks until stopped, finished or failed."""
        try:
            self._take_priority()
            while not (self._source.now() or self._stopping):
                self._source.wait(NANOSECONDS)
            self.waiting_for_clock = False
            self._schedule(self._source.now())
            self._left_out = self._due
            while not (self._stopping or self._work.finished):
                if self._pauses:
                    self._idle()
                else:
                    self._next_tick()
        except BaseException as failure:
            self.failure = failure
        finally:
            if not self._stopping:
                self._at_end()

    def _take_priority(self):
        """Ask for exact timers, and for real-time scheduling if the thread ever sleeps."""
        self.scheduling = ask_for_priority(self._factor > 0.0)

    def _schedule(self, due):
        """Make the next tick due at that instant, and those after it follow at the pace wanted."""
        factor = 1.0 if self._source.follows_clock_topic else self._factor
        self._due = due
        self._deadlines = (
            Timeline(due, Fraction(self._rate) * Fraction(factor), self._work.next_tick)
            if factor
            else None
        )
        self._period = math.ceil(NANOSECONDS / (self._rate * factor)) if factor else 0
        self._backlog = 2 * self._period + (
            CLOCK_JUMP if self._source.follows_clock_topic else BACKLOG
        )

    def _resume_at(self, due):
        """Go on at that instant as if no time had passed since the tick before."""
        self._schedule(due)
        ticks, running = self.latest
        self._left_out = due - running - (self._period if ticks else 0)

    def _run_tick(self, now, publish):
        if not self._begun:
            self._begun = True
            self._work.begin()
        self._work.run_tick(publish)
        self.latest = (self.latest[0] + 1, now - self._left_out)

    def _idle(self):
        """Wait while paused; run a tick for each step asked for."""
        while self._pauses and not self._stopping:
            if self._steps:
                future = self._steps.popleft()
                now = self._source.now()
                self._resume_at(now)
                self._run_tick(now, True)
                future.set_result(self._work.next_tick - 1)
                if self._work.finished:
                    return
            else:
                self._work.between_ticks()
                time.sleep(LONGEST_SLEEP)
        while self._steps:
            self._steps.popleft().set_result(None)
        self._resume_at(self._source.now())

    def _next_tick(self):
        """Wait for the next deadline and run its tick."""
        source, work = self._source, self._work
        now = source.now()
        if self._deadlines is None:
            self._due = now
            self._run_tick(now, True)
            return
        due = self._deadlines.instant(work.next_tick)
        while now < due:
            if source.follows_clock_topic:
                if due - now > 2 * self._period:
                    self._jump(now)
                    return
                work.between_ticks()
            elif due - now > LONGEST_SLEEP * NANOSECONDS:
                work.between_ticks()
            source.wait(due - now)
            if self._stopping or self._pauses:
                return
            now = source.now()
        self._due = due
        late = now - due
        publish = True
        if not source.follows_clock_topic:
            self.lateness.add(late)
            if late > self._period:
                publish = self._overrun(now, late)
        elif late > self._backlog:
            self._jump(now)
        self._run_tick(now, publish)

    def _overrun(self, now, late):
        """Count a tick that is more than a period late; return whether to publish it."""
        self.overruns += 1
        if late > self._backlog:
            self.slipped += late
            self._schedule(now)
            return True
        if self.skip_publish:
            self.skipped += 1
            return False
        return True

    def _jump(self, now):
        """Go on from where /clock is now: no tick is lost or run twice."""
        self.clock_jumps += 1
        self._resume_at(now)
