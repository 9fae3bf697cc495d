# SPDX-License-Identifier: Apache-2.0
"""A simulation in a process of its own, at the pace of the clock, controlled through a pipe.

The page's process sends ``(name, value)`` pairs, see :meth:`Runner.told`; it gets ``('snapshot',
Snapshot)``, ``('scene', About)``, ``('refused', text)``, ``('failed', text)`` and, if the very
first scene cannot run, ``('impossible', error)`` back. While a scene is prepared, ``('preparing',
text)`` tells what is being done; ``('prepared', None)`` ends it, with or without a new scene. So a
method that takes long never holds up the page, and the page never holds up the simulation.
"""

import contextlib
import math
import signal
import time
from typing import NamedTuple

import numpy as np

from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.recording.of_simulation import SimulationRecording
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.scene.state import ANGULAR_VELOCITY, TIME, States
from rigid_body_sim.simulation.command_rows import BODY, HOLD, ZERO
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.theory.prediction import expectation
from rigid_body_sim.view.snapshots import MOST_BETWEEN, TURN_BETWEEN, Snapshot

PERIOD = 1.0 / 60.0
"""Time between two snapshots, s of the clock."""
LONGEST_WORK = 0.05
"""Time that the computation of one snapshot may take, s of the clock: then the motion lags."""
LAST_TIME = 1e9
"""Simulated time that ends the motion, in seconds times the rate over 1000: ticks stay exact."""
WAYS_ON = 'press reset, or let go of the body and press play'
"""What a person may do about a motion that cannot go on."""


class About(NamedTuple):
    """Description of a scene that begins: its YAML text, the method and its notes."""

    text: str
    method: str
    notes: list


class Runner:
    """The loop of the process.

    Parameters
    ----------
    pipe : multiprocessing.Connection
    settings : dict
        ``rate``, ``integrator`` and ``accuracy`` of the Simulation.
    output : str or None
        Folder of the recording to make.
    """

    def __init__(self, pipe, settings, output):
        self._pipe, self._settings, self._output = pipe, settings, output
        self._simulation = self._recording = None
        self._events = []
        self._speed, self._paused, self._halted, self._steps = 1.0, False, False, 0
        self._cost, self._last = 0.0, 0.0
        self._told = {'scene': self._begin, 'command': self._command, 'speed': self._set_speed,
                      'pause': self._pause, 'step': self._step, 'reset': self._reset}

    def told(self, name, value):
        """Do what the page asks for.

        ``scene``: a YAML text begins. ``command``: rows of commands act at the present tick.
        ``speed``: simulated seconds per second. ``pause``: a bool. ``step``: the motion goes on by
        one snapshot while paused. ``reset``: the state goes back to the initial one. A motion that
        cannot go on halts until ``pause`` is false, a reset, or another scene.
        """
        self._told[name](value)

    def run(self):
        """Serve until the page's process closes the pipe."""
        due = self._last = time.monotonic()
        while True:
            while self._pipe.poll(max(due - time.monotonic(), 0.0)):
                self.told(*self._pipe.recv())
            due = max(due + PERIOD, self._follow_clock())

    def _follow_clock(self):
        """Advance by the time since the last call, or since a scene began; return the clock."""
        now = time.monotonic()
        elapsed, self._last = now - self._last, now
        self._advance(elapsed)
        return now

    def _begin(self, text):
        try:
            self._prepare(text)
        finally:
            self._pipe.send(('prepared', None))

    def _prepare(self, text):
        """Begin a scene, or say why it cannot begin."""
        try:
            self._pipe.send(('preparing', 'choosing a method'))
            simulation = Simulation(parse_scene(text), **self._settings)
            self._pipe.send(('preparing', 'compiling what a push needs'))
            self._rehearse(simulation.scene)
            self._record(simulation)
        except (BadInput, NotConverged) as error:
            # with nothing to go on with, the page's process ends with this error
            self._pipe.send(('refused', str(error)) if self._simulation else ('impossible', error))
            return
        self._simulation = simulation
        self._pipe.send(('scene', About(simulation.scene.text, simulation.choice.method,
                                        list(simulation.scene.notes))))
        self._restarted()

    def _record(self, simulation):
        """Continue the recording, if there is one, with a simulation that begins."""
        if self._recording:
            simulation.follow(self._simulation, keep_state=False)
            changed = {'scene': simulation.scene.name}
            self._write(lambda recording: recording.switch(simulation, changed))
        elif self._output:
            output, self._output = self._output, None
            parameters = {'scene': simulation.scene.name, **self._settings}
            self._recording = SimulationRecording(output, 'view', simulation, parameters,
                                                  commanded=True)

    def _write(self, act):
        """Call a function with the recording, if there is one; a full disk ends it."""
        if self._recording is None:
            return
        try:
            act(self._recording)
        except OSError as error:
            recording, self._recording = self._recording, None
            with contextlib.suppress(OSError):
                recording.close()
            with contextlib.suppress(OSError):
                self._pipe.send(('refused', f'the disk refuses the recording ({error.strerror}): '
                                 'it ends here; "recover" keeps all up to here'))

    def _write_present(self):
        """Record the present tick, after everything that took effect at it."""
        simulation, states = self._simulation, States(self._simulation.vector[None].copy())
        self._take_events()
        self._write(lambda recording: recording.ticks(simulation.tick, states))

    def _take_events(self):
        """Take the events since the last call, for the recording and for the snapshot."""
        events = list(self._simulation.events)
        self._simulation.events.clear()
        self._events += events
        self._write(lambda recording: recording.note(events))

    def _go(self, ticks):
        """Advance by a number of ticks, and record those that are passed."""
        simulation = self._simulation
        if not ticks or self._recording is None:
            simulation.advance(ticks)
            return
        first = simulation.tick + 1
        self._write_present()
        states = simulation.advance_through(ticks)
        # actions of the mouse still take effect at the last one
        self._take_events()
        self._write(lambda recording: recording.ticks(first, States(states.vector[:-1])))

    def close(self):
        """Execute the last requests of the page, and finish the recording, if there is one."""
        with contextlib.suppress(EOFError, OSError):
            while self._pipe.poll():
                self.told(*self._pipe.recv())
        if self._recording:
            self._write_present()
            self._write(lambda recording: recording.close())

    def _rehearse(self, scene):
        """Compile what the first command needs, before the mouse is used."""
        simulation = Simulation(scene, **self._settings)
        simulation.command(np.array([(HOLD, BODY, *ZERO, 1e-9, 0.0, 0.0)]))
        simulation.advance()
        simulation.ledger()

    def _restarted(self):
        self._time = 0.0
        self._cost = 0.0
        self._halted = False
        self._expected = expectation(self._simulation.scene, self._simulation.state)
        self._send(self._simulation.vector.copy()[np.newaxis], restarted=True)
        # time spent on the preparation does not count as time of the motion
        self._last = time.monotonic()

    def _command(self, rows):
        if self._simulation is None:
            return
        refused = self._simulation.command(rows)
        for refusal in refused:
            self._pipe.send(('refused', str(refusal.error)))
        taken = np.delete(rows, [refusal.place for refusal in refused], axis=0)
        self._write(lambda recording: recording.commands(taken))
        self._expected = None

    def _set_speed(self, speed):
        self._speed = float(speed)

    def _pause(self, paused):
        self._paused, self._halted = bool(paused), False

    def _step(self, _):
        self._steps += 1

    def _reset(self, _):
        if self._simulation is not None:
            self._simulation.reset()
            self._write(lambda recording: recording.reset())
            self._restarted()

    def _advance(self, seconds):
        """Advance by some seconds of the clock, and send the snapshot."""
        if self._simulation is None:
            return
        steps, self._steps = self._steps, 0
        still = self._paused or self._halted
        forward = steps * PERIOD * self._speed if still else seconds * self._speed
        if forward <= 0.0:
            return
        if self._cost > 0.0:
            forward = min(forward, LONGEST_WORK / self._cost)
        began = time.perf_counter()
        try:
            self._move(min(self._time + forward, LAST_TIME * 1000.0 / self._simulation.rate))
        except (BadInput, NotConverged) as error:
            if self._simulation.time > self._time:
                self._show(self._simulation.time)
            self._pipe.send(('failed', f'{error}. The motion halts there: {WAYS_ON}'))
            self._halted = True
            return
        took = (time.perf_counter() - began) / forward
        self._cost = 0.8 * self._cost + 0.2 * took

    def _move(self, until):
        """Advance the motion to any time (s), not only that of a tick, and send the snapshot."""
        simulation = self._simulation
        origin = simulation.time_at(0)
        self._go(max(int((until - origin) * simulation.rate) - simulation.tick, 0))
        self._show(until)

    def _show(self, until):
        """Send the snapshot of a time (s) that the motion has reached, with the trail to it."""
        simulation = self._simulation
        rate = float(np.linalg.norm(simulation.vector[ANGULAR_VELOCITY]))
        between = 1 + min(int(rate * (until - self._time) / TURN_BETWEEN), MOST_BETWEEN)
        times = np.linspace(self._time, until, between + 1)[1:]
        trail = simulation.states(times).vector
        self._time = until
        self._send(trail)
        simulation.forget_past()

    def _send(self, trail, restarted=False):
        simulation = self._simulation
        ledger = simulation.ledger()
        self._take_events()
        happened = [(event.time, event.name) for event in self._events]
        self._events.clear()
        if self._expected:
            for at, name in happened:
                self._expected.note(name, at)
            self._expected.look(simulation.state)
        self._pipe.send(('snapshot', Snapshot(
            float(trail[-1, TIME]), trail[-1], trail, simulation.wrench, simulation.energy,
            ledger['energy_residual'], ledger['momentum_residual'], tuple(happened), restarted)))
        if self._expected and (compared := self._expected.compared()):
            self._pipe.send(('expected', {key: value for key, value in compared.items()
                                          if isinstance(value, str) or math.isfinite(value)}))


def serve(pipe, settings, output=None):
    """Run as the main function of the process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    runner = Runner(pipe, settings, output)
    try:
        runner.run()
    except (EOFError, OSError):
        return
    finally:
        runner.close()
