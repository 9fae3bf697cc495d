# SPDX-License-Identifier: Apache-2.0
"""A warm-up before the clock starts, so that no tick does anything for the first time.

Kernels are compiled, or loaded from the cache, when they are first called, and modules are
imported when they are first needed. The warm-up therefore runs the session itself, with a
simulation of its own and without publishing: single and prefetched ticks, commands, a reset, a
balance.
"""

import contextlib
import types

import numpy as np

from rigid_body_sim.command_line import patience
from rigid_body_sim.errors import NotConverged
from rigid_body_sim.node.journal import NoJournal
from rigid_body_sim.realtime.session import QUIET, Session
from rigid_body_sim.recording import about
from rigid_body_sim.simulation.command_rows import BODY, HOLD, IMPULSE, LET_GO, WORLD, ZERO
from rigid_body_sim.simulation.simulation import Simulation

FASTEST = 1000.0
"""Least rate of the warm-up (Hz), so that it covers a tenth of a second of the motion."""
SMALL = (1e-9, 1e-9, 1e-9)
COMMANDS = np.array(
    [(kind, axes, *ZERO, *SMALL) for kind in (IMPULSE, HOLD) for axes in (BODY, WORLD)]
)


def rehearse(simulation, messages):
    """Run ticks as a node will run them, on a separate simulation, before any clock starts.

    A motion that ends on the way ends the warm-up: the run itself tells that at its tick.

    Parameters
    ----------
    simulation : Simulation
        It is not changed.
    messages : state_topics.SceneMessages
        Makes the messages of its scene.
    """
    with patience(), contextlib.suppress(NotConverged):
        _rehearse(simulation, messages)


def _rehearse(simulation, messages):
    choice = simulation.choice
    trial = Simulation(
        simulation.scene,
        simulation.integrator,
        simulation.accuracy,
        max(simulation.rate, FASTEST),
        choice.step,
        horizon=choice.horizon,
        settled=choice.settled,
    )
    queue = _Queue()
    settings = types.SimpleNamespace(command_timeout=0.0, duration=0.0, display_rate=FASTEST)
    session = Session(trial, queue, _Nowhere(messages), NoJournal(), settings, lambda: 0)
    session.begin()
    _run(session)
    if trial.scene.accepts_commands:
        # the second ones meet a body that is already commanded; a wrench is held in either frame,
        # for the last of them holds
        for rows in (COMMANDS, COMMANDS[::-1], LET_GO):
            queue.put(rows)
            _run(session)
    session.request(Session.reset)
    _run(session)


def _run(session):
    session.want_balance()
    # the last of these ticks are prefetched
    for _ in range(QUIET + 4):
        session.run_tick(True)


class _Queue:
    """Stands for the commands that wait."""

    def __init__(self):
        self._rows = np.empty(0)
        self.waiting = self.applied = 0

    def put(self, rows):
        self._rows, self.waiting = rows, len(rows)

    def take(self):
        """Do nothing: no other command arrives."""

    def collect(self):
        self.waiting = 0
        return self._rows

    def refuse(self, topic, reason, got, remedy=None):
        """Ignore that the body has an axis of zero moment and cannot take a torque about it."""


class _Nowhere:
    """Stands for the publishers: makes every message and sends none."""

    def __init__(self, messages):
        self.messages = messages

    def tick(self, messages):
        pass

    def paced(self, messages):
        return [('', message) for message in messages]

    def event(self, level, name, message, values):
        return '', about.event_message('rehearsal', level, name, message, values)

    def scene(self, scene):
        return [('', about.scene_message(scene))]
