# SPDX-License-Identifier: Apache-2.0
"""A simulation as a source: the page's end of the pipe to runner.py."""

import math
import multiprocessing
import time

import numpy as np
import yaml

from rigid_body_sim.command_line import deaf_children
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.view import runner

SLOWEST = 1e-3
"""A body that turns more slowly than this (rad/s) is not shown in real time."""

FINISHED_WITHIN = 60.0
"""Time that a process that records may take to end a step and to finish its recording, s."""


class Live:
    """A scene that runs in another process.

    Parameters
    ----------
    text : str
        YAML of the scene.
    settings : dict
        Keywords of the Simulation: ``rate``, ``integrator``, ``accuracy``.
    output : str, optional
        Folder of the recording to make.

    Attributes
    ----------
    scene : Scene
        The scene of the snapshots; it changes when a new one has begun.
    generation : int
        Number of scenes that have begun.
    method : str
        The method that runs the scene.
    messages : list of str
        Errors since the page last looked; the page empties the list.
    speed : float
        Simulated seconds per second of the clock.
    tick : float
        Simulated time between two moments at which commands act, s.
    expected : dict
        What theory predicts beside what was measured.
    beside : None
        Only a recording has a second one beside it.
    """

    pushes, edits, plays, paces = True, True, False, True
    beside = None

    def __init__(self, text, settings, output=None):
        self.scene, self.generation, self.method = parse_scene(text), 0, ''
        self.speed = pace_for(self.scene)
        self.messages, self.expected = list(self.scene.notes), {}
        self.tick = 1.0 / settings['rate']
        self._output, self._asked, self._next, self._doing = output, None, None, ''
        context = multiprocessing.get_context('spawn')
        self._pipe, other = context.Pipe()
        self._process = context.Process(target=runner.serve, args=(other, settings, output),
                                        daemon=True)
        with deaf_children():
            self._process.start()
        other.close()
        self.begin(text)

    def begin(self, text):
        """Begin a scene from its YAML text, after the one that is being prepared."""
        if self._asked is not None:
            self._next = text
            return
        self._asked = yaml.safe_load(text)['scene'].replace('_', ' '), time.monotonic()
        self._doing = 'starting'
        self.tell('scene', text)
        self.set_speed(self.speed)

    @property
    def preparing(self):
        """What a page waits for, in words, or an empty text."""
        if self._asked is None:
            return ''
        name, since = self._asked
        return f'Preparing {name}: {self._doing}, {time.monotonic() - since:.0f} s'

    def _prepared(self):
        """Go on to the scene that was asked for meanwhile."""
        self._asked, later, self._next = None, self._next, None
        if later is not None:
            self.begin(later)

    def set_speed(self, speed):
        """Run at another pace."""
        self.speed = speed
        self.tell('speed', speed)

    def tell(self, name, value=None):
        """Send the simulation a request (Runner.told)."""
        self._pipe.send((name, value))

    def wait(self, seconds):
        """Wait for the simulation, some seconds at most; return whether it has sent something."""
        return self._pipe.poll(seconds)

    def poll(self):
        """Return the Snapshots that have come since the last call.

        Raises
        ------
        BadInput, NotConverged
            If the first scene cannot run with the settings given.
        """
        snapshots = []
        while self._pipe.poll():
            name, value = self._pipe.recv()
            if name == 'impossible':
                raise value
            if name == 'snapshot':
                snapshots.append(value)
            elif name == 'scene':
                self.scene, self.method = parse_scene(value.text), value.method
                self.generation += 1
                self.expected = {}
                snapshots.clear()
            elif name == 'expected':
                self.expected = value
            elif name == 'preparing':
                self._doing = value
            elif name == 'prepared':
                self._prepared()
            else:
                self.messages.append(value)
        return snapshots

    def command(self, rows):
        """Give commands (simulation.command_rows) to the body, unless another one is awaited."""
        if self._asked is None:
            self.tell('command', rows)

    def close(self):
        """End the process; one that records finishes its recording."""
        self._pipe.close()
        if self._output:
            self._process.join(FINISHED_WITHIN)
        if self._process.is_alive():
            self._process.terminate()


def pace_for(scene):
    """Return the initial speed: real time, or faster so that a slow body turns in some seconds."""
    rate = float(np.linalg.norm(scene.initial.angular_velocity))
    return 10.0 ** round(-math.log10(rate)) if 0.0 < rate < SLOWEST else 1.0
