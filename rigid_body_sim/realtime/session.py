# SPDX-License-Identifier: Apache-2.0
"""A session: one simulation, tick by tick, in the tick thread.

At tick k, in this order: the state moves on to tick k; requests (reset, changes of parameters)
take effect; then commands, in the order in which they came; then the state is published and
recorded. So whatever reaches the node between two ticks takes effect at the next one, and is
recorded with its number.

While nothing disturbs the body, states and messages of coming ticks are prefetched, many at once,
after a tick has been published, so that the next ticks only send them. The simulation object then
lags behind. A request, a command, an event or a balance makes it catch up with the present tick,
and the prefetched messages are dropped. The bits are the same either way.
"""

import collections
import concurrent.futures
import math
import time
from fractions import Fraction

import numpy as np

from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.messages.timeline import NANOSECONDS, Pace, Timeline
from rigid_body_sim.recording import about
from rigid_body_sim.recording.about import ERROR, OK, WARN
from rigid_body_sim.scene.state import States
from rigid_body_sim.simulation.admission import NOT_FINITE, REASONS, TOO_MUCH_WORK
from rigid_body_sim.simulation.command_rows import HOLD, KIND, LET_GO, RELEASE, TOPICS
from rigid_body_sim.theory.prediction import Prediction

REPORT_EVERY = NANOSECONDS
"""A refused command is reported at most this often for each topic and reason, ns."""
AHEAD = 64
"""Number of ticks prefetched at 1 kHz or less. At higher rates it is smaller, so that prefetching
fits between two ticks.
"""
WITH_EXAMPLE = (REASONS[NOT_FINITE], REASONS[TOO_MUCH_WORK])
"""Reasons of refusals that are reported with a valid command."""
QUIET = 16
"""Number of ticks after a disturbance for which nothing is prefetched."""


class Session:
    """The work of the tick thread.

    Parameters
    ----------
    simulation : Simulation
    command_queue : commands.Commands
    publishing : publishing.Publishing
    journal : journal.Journal
    settings : parameters.Settings
    epoch : callable
        Returns the stamp of tick 0 (ns); called just before that tick.

    Attributes
    ----------
    next_tick : int
        Number of the next tick to run.
    timeline : Timeline or None
        Stamps of the ticks; None before the first one.
    finished : bool
    balance : dict
        The ledger at the last request by :meth:`want_balance`, with its ``tick`` and ``time``.
    event_counts : collections.Counter
        Events so far, by name.
    prediction : prediction.Prediction
        Prediction for the motion since the last disturbance.
    """

    def __init__(self, simulation, command_queue, publishing, journal, settings, epoch):
        self.simulation = simulation
        self.timeline = None
        self._commands, self._publishing, self._journal, self._epoch = (
            command_queue,
            publishing,
            journal,
            epoch,
        )
        command_queue.report = self._report_refusal
        self.command_timeout = settings.command_timeout
        self._duration, self._last_tick = settings.duration, None
        self._display_rate = settings.display_rate
        self._pace = Pace(settings.display_rate, simulation.rate)
        self._tick = self.next_tick = simulation.tick
        self._ahead = collections.deque()
        self._look_ahead_from = self._tick
        self.finished = False
        self.event_counts = collections.Counter()
        self._requests = collections.deque()
        self._release_tick = None
        self._reports = {}
        self._balance_wanted = False
        self._disturbed()
        self.take_balance()

    # -- from other threads

    def request(self, act):
        """Have `act(session)` called at the next tick; return a Future of what it returns."""
        future = concurrent.futures.Future()
        self._requests.append((act, future))
        return future

    def want_balance(self):
        """Ask for a fresh :attr:`balance`."""
        self._balance_wanted = True

    # -- the tick thread

    def begin(self):
        """Fix the stamps, just before the first tick, and publish the scene."""
        self.timeline = Timeline(self._epoch(), self.simulation.rate, self.next_tick)
        self._end = self.timeline.origin + round(self._duration * NANOSECONDS)
        self._find_last_tick()
        self.announce_scene()

    def run_tick(self, publish):
        """Run the next tick; `publish` says whether its state is published and recorded."""
        self._tick = tick = self.next_tick
        if self._requests:
            self._catch_up()
            self._serve_requests()
        self._commands.take()
        if self._commands.waiting or self._release_tick is not None:
            self._catch_up()
            self._command(tick)
        if self._ahead:
            stamp, messages, paced = self._ahead.popleft()
        else:
            stamp, messages, paced = self._present(tick)
        if publish:
            self._publishing.tick(messages)
            if paced:
                for topic, message in self._publishing.paced(paced):
                    self._journal.paced(topic, stamp, message)
            if self._journal.tick(stamp, messages):
                self._catch_up()
                self._journal.state(self.simulation, stamp)
        if self._balance_wanted:
            self.take_balance()
        self.next_tick = tick + 1
        if self._last_tick is not None and tick >= self._last_tick:
            self.finished = True
        if not self._ahead and tick >= self._look_ahead_from:
            self._look_ahead(tick)

    def _present(self, tick):
        """Advance to a tick that was not prefetched, report its events, return its entry."""
        self._catch_up()
        if self.simulation.events:
            self._report_events()
        [entry] = self._messages(self.simulation.vector[None], tick)
        return entry

    def _catch_up(self):
        """Bring the simulation to the tick that is being run; drop prefetched messages."""
        self._ahead.clear()
        if self._tick > self.simulation.tick:
            try:
                self.simulation.advance(self._tick - self.simulation.tick)
            except NotConverged:
                self._report_events()    # of the last tick, which is published
                raise

    def _look_ahead(self, tick):
        """Prefetch the messages of the ticks after this one, up to the next event."""
        self._catch_up()
        try:
            states = self.simulation.foresee(
                min(AHEAD, math.ceil(AHEAD * 1000.0 / self.simulation.rate))
            )
        except NotConverged:
            # reported at its tick, if the run gets there
            states = ()
        if len(states):
            self._ahead.extend(self._messages(states.vector, tick + 1))
        else:
            self._look_ahead_from = tick + QUIET

    def _messages(self, vectors, tick):
        """Return (stamp, messages, paced messages or None) of consecutive ticks."""
        energies, squares = self.simulation.diagnose(States(vectors))
        stamps = self.timeline.instants(tick, len(vectors))
        made, wrench, paced = (
            self._publishing.messages,
            self.simulation.wrench,
            [None] * len(vectors),
        )
        if made.paced:
            for k in self._pace.due(tick, len(vectors)):
                one = slice(k - tick, k - tick + 1)
                [paced[k - tick]] = made.paced.messages(
                    vectors[one], energies[one], squares[one], stamps[one], wrench
                )
        return zip(
            stamps,
            made.ticking.messages(vectors, energies, squares, stamps, wrench),
            paced,
            strict=True,
        )

    def between_ticks(self):
        """Take commands into the queue while there is time, so that none is lost."""
        if self.timeline is None:
            return
        self._commands.look()
        if self._balance_wanted:
            self.take_balance()

    def _serve_requests(self):
        while self._requests:
            act, future = self._requests.popleft()
            try:
                future.set_result(act(self))
            except BadInput as refusal:
                future.set_exception(refusal)

    def reset(self):
        """Reset the state; called at a tick. Held wrenches end with it."""
        self.simulation.reset()
        self._release_tick = None
        self._disturbed()
        self._journal.entry('reset', self.stamp, tick=self.next_tick)
        return self.next_tick

    def switch(self, simulation, messages, keep_state):
        """Go on with another simulation and its SceneMessages from the present tick on."""
        self._report_events()
        simulation.follow(self.simulation, keep_state)
        if simulation.rate != self.simulation.rate:
            self.timeline = self.timeline.from_tick(self.next_tick, simulation.rate)
            self._find_last_tick()
            self._pace = Pace(self._display_rate, simulation.rate)
        self.simulation = simulation
        self._disturbed()
        if not keep_state:
            self._release_tick = None
            self._publishing.messages = messages
            self.announce_scene()

    def _find_last_tick(self):
        if self._duration:
            left = Fraction(self._end - self.timeline.origin, NANOSECONDS)
            self._last_tick = self.timeline.tick + self.timeline.ticks_in(left)

    def note_parameters(self, changed, keep_state):
        """Record and tell that parameters changed; called at the tick from which they hold."""
        simulation = self.simulation
        self._journal.entry(
            'parameters',
            self.stamp,
            tick=self.next_tick,
            changed=changed,
            scene=simulation.scene.text,
            simulation=about.run_of(simulation),
            keeps_state=keep_state,
        )
        self.event(OK, 'parameters changed', ', '.join(changed), changed)

    def announce_scene(self):
        """Publish and record the scene as it runs."""
        for topic, data in self._publishing.scene(self.simulation.scene):
            self._journal.message(topic, self.stamp, data)

    @property
    def stamp(self):
        """Stamp of the tick that is being run, ns."""
        return self.timeline.instant(self.next_tick)

    def event(self, level, name, message, values=None):
        """Publish and record an event of the tick that is being run, or of that in `values`."""
        self.event_counts[name] += 1
        values = {
            'tick': self.next_tick,
            'time': self.simulation.time_at(self.next_tick),
            **(values or {}),
        }
        topic, data = self._publishing.event(level, name, message, values)
        self._journal.message(topic, self.timeline.instant(values['tick']), data)

    def _report_events(self):
        events, self.simulation.events[:] = list(self.simulation.events), []
        for event in events:
            self.prediction.note(event.name, event.time)
            self.event(OK, event.name, *about.event_text(event))

    # -- commands

    def _command(self, tick):
        """Apply the waiting commands; release a wrench that has timed out."""
        self.simulation.forget_past()
        if self._commands.waiting:
            self._take_effect(tick, self._commands.collect())
        due = self._release_tick is not None and tick >= self._release_tick
        # a release after which no motion follows is refused, and tried again at the next tick
        if due and self._take_effect(tick, LET_GO):
            self._release_tick = None
            self.event(
                WARN,
                'command timed out',
                f'no cmd_wrench for {self.command_timeout:g} s: the held wrench ended',
            )

    def _take_effect(self, tick, rows):
        """Apply commands, and report those that are refused; return whether any was taken."""
        refused = self.simulation.command(rows)
        for refusal in refused:
            remedy = '' if refusal.reason in WITH_EXAMPLE else refusal.error.remedy
            self._commands.refuse(
                TOPICS[int(rows[refusal.place, KIND])],
                refusal.reason,
                refusal.error.problem.removeprefix('got '),
                remedy,
            )
        if refused:
            rows = np.delete(rows, [refusal.place for refusal in refused], axis=0)
        if not len(rows):
            return False
        kinds = set(rows[:, KIND].tolist())
        if HOLD in kinds:
            timeout = self.timeline.ticks_in(self.command_timeout)
            self._release_tick = tick + timeout if timeout else None
        self._commands.applied += len(rows) - (RELEASE in kinds)
        self._disturbed()
        self._journal.commands(tick, self.stamp, rows)
        return True

    def _disturbed(self):
        """Start a new comparison with theory, and wait for a while before prefetching again."""
        self._look_ahead_from = self._tick + QUIET
        simulation = self.simulation
        self.prediction = Prediction(
            simulation.scene, None if simulation.wrench else simulation.state
        )

    def _report_refusal(self, topic, reason, got, remedy):
        """Report a refused command, at most once a second for each topic and reason."""
        now = time.monotonic_ns()
        told, silent = self._reports.get((topic, reason), (-REPORT_EVERY, 0))
        if now - told < REPORT_EVERY:
            self._reports[topic, reason] = told, silent + 1
            return
        self._reports[topic, reason] = now, 0
        self.event(
            ERROR,
            'command refused',
            f'{topic}: {reason}: got {got}; right would be: {remedy}',
            {
                'topic': topic,
                'reason': reason,
                'got': got,
                'right': remedy,
                'not_told_since': silent,
            },
        )

    def take_balance(self):
        """Take a fresh :attr:`balance`; while ticks run, only the tick thread may do so."""
        self._balance_wanted = False
        self._catch_up()
        self.prediction.look(self.simulation.state)
        self.balance = {
            'tick': self.simulation.tick,
            'time': self.simulation.time,
            **self.simulation.ledger(),
        }
