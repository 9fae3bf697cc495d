# SPDX-License-Identifier: Apache-2.0
"""A recording as a source: its states at any time, with marks where something happened."""

import contextlib
import math
import pathlib
import time

import numpy as np

from rigid_body_sim.analysis.source import sources
from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording.reader import Recording
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.state import STATE_SIZE, TIME
from rigid_body_sim.view.snapshots import UNKNOWN, Mechanics, Snapshot, state_between

MOST_STATES = 1_000_000
"""Most states that are kept; of a longer recording every n-th is kept."""
MOST_BETWEEN = 40
MOST_MARKS = 60
"""With more marks only those of commands and resets are kept."""
PARTED = 4.0
"""If a difference is this many times the one beside it, something happened between its states."""
NANOSECONDS = 1e9


class Player:
    """A recording as a source of snapshots; a second one can be drawn beside it.

    Parameters
    ----------
    path : path-like
        Of a recording; its first body is shown.

    Attributes
    ----------
    name : str
        The recording's own name, to tell two of them apart.
    end : float
        Time of its last state since its first one, s.
    marks : list of (float, str)
        Time (s) and text of what happened.
    beside : Player or None
        Another recording, at the same time since its own start.
    """

    pushes, edits, plays, paces = False, False, True, True
    preparing = ''

    def __init__(self, path):
        self._times, self._vectors, self._energies, source = states_of(path)
        self.scene, self.generation = source.scene, 1
        self.name = pathlib.Path(path).name
        self._mechanics = Mechanics(self.scene) if self.scene else None
        self.method = source.run.get('method', 'a recording')
        self.marks = [((mark.stamp - source.start) / NANOSECONDS,
                       f'{mark.kind} {mark.name}'.strip()) for mark in source.history.marks]
        if len(self.marks) > MOST_MARKS:
            self.marks = [mark for mark in self.marks if not mark[1].startswith('event')]
        self.end = float(self._times[-1]) if len(self._times) else 0.0
        self.messages, self.expected, self.beside = [], {}, None
        self.speed, self._paused, self._time, self._shown = 1.0, False, 0.0, -1.0
        self._restarted, self._last = True, time.monotonic()

    wait = staticmethod(time.sleep)

    def poll(self):
        """Return the Snapshot of now, if it differs from the last one."""
        now = time.monotonic()
        if not self._paused:
            self._time += (now - self._last) * self.speed
            if self._time > self.end:
                self.seek(0.0)    # playing again after the end
        self._last = now
        if self._time == self._shown:
            return []
        before, self._shown = self._shown, self._time
        snapshot = self.at(self._time, before)
        self._restarted = False
        return [snapshot]

    def at(self, when, before):
        """Return the Snapshot at a time (s), with the trail since another one."""
        place = max(int(np.searchsorted(self._times, when, side='right')) - 1, 0)
        first = max(int(np.searchsorted(self._times, before, side='right')), 0)
        going_on = before <= when and not self._restarted
        between = range(first, place) if going_on else ()
        step = max(1, len(between) // MOST_BETWEEN)
        events = tuple(mark for mark in self.marks if going_on and before < mark[0] <= when)
        return Snapshot(when, self._vectors[place], self._vectors[[*between[::step], place]],
                     Wrench(), float(self._energies[place]), math.nan, math.nan, events,
                     not going_on, self._net(place))

    def beside_of(self, snapshot):
        """Return the Snapshot at the time of another recording's; the rates may differ."""
        when = float(snapshot.vector[TIME])
        found = self.at(when, when)
        place = max(int(np.searchsorted(self._times, when, side='right')) - 1, 0)
        if place + 1 >= len(self._times) or when == self._times[place]:
            return found
        before, after = self._vectors[place], self._vectors[place + 1]
        share = (when - before[TIME]) / (after[TIME] - before[TIME])
        return found._replace(vector=state_between(before, after, share))

    def _net(self, place):
        """Return net force and torque at a state, from states that no strike parts."""
        if self._mechanics is None:
            return UNKNOWN
        last = len(self._vectors) - 3
        if last < 0:
            return UNKNOWN
        around = min(max(place - 1, 0), last)
        found = [self._mechanics.net_between(self._vectors[one:one + 3])
                 for one in (around, max(place - 2, 0), min(place, last))]
        return tuple(_steady(*parts) for parts in zip(*found, strict=True))

    def seek(self, when):
        """Go to a time, s."""
        self._time, self._shown, self._restarted = when, math.nan, True

    def set_speed(self, speed):
        """Play at another pace."""
        self.speed = speed

    def tell(self, name, value=None):
        """Pause, make a step of a sixtieth of a second, or go back to the start."""
        if name == 'pause':
            self._paused = value
        elif name == 'step':
            self._paused = True
            self._time = min(self._time + self.speed / 60.0, self.end)
        else:
            self.seek(0.0)

    def close(self):
        """Do nothing: there is nothing to close."""


def _steady(value, *others):
    """Return a difference, or the least of those beside it if a strike or impact parts its states.

    That makes a difference larger by far than those beside it.
    """
    least = min(others, key=np.linalg.norm)
    return least if np.linalg.norm(value) > PARTED * np.linalg.norm(least) else value


def states_of(path):
    """Return times (s), states (n, 14), energies (J) and the Source of a recording's first body.

    `path` may also be an open Recording. Of more than MOST_STATES states every n-th is kept.
    """
    is_open = isinstance(path, Recording)
    opened = contextlib.nullcontext(path) if is_open else Recording(path)
    with opened as recording:
        source = sources(recording)[0]
        for topic in ('pose', 'angular_velocity'):
            if topic not in source.topics:
                raise BadInput(str(recording.path), f'has no topic {topic}',
                               'a recording with pose and angular_velocity')
        return *_states(recording, source), source


def _states(recording, source):
    """Return times (s), states (n, 14) and energies of a body, thinned to MOST_STATES."""
    step = -(-source.ticks // MOST_STATES)
    pose = recording.read(source.topics['pose'], ['pose.position', 'pose.orientation'])
    turning = recording.read(source.topics['angular_velocity'], ['vector'])
    energy = recording.read(source.topics['energy'], ['data']) if 'energy' in source.topics else {}
    stamps = pose['log_time'][::step]
    vectors = np.zeros((len(stamps), STATE_SIZE))
    vectors[:, 0] = (stamps - source.start) / NANOSECONDS
    vectors[:, 1:5] = pose['pose.orientation'][::step]
    vectors[:, 8:11] = pose['pose.position'][::step]
    place = np.searchsorted(turning['log_time'], stamps).clip(0, len(turning['log_time']) - 1)
    vectors[:, 5:8] = turning['vector'][place]
    energies = np.full(len(stamps), math.nan)
    if energy and len(energy['log_time']):
        place = np.searchsorted(energy['log_time'], stamps).clip(0, len(energy['log_time']) - 1)
        energies = energy['data'][place]
    return vectors[:, 0].copy(), vectors, energies
