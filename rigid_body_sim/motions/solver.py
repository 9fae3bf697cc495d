# SPDX-License-Identifier: Apache-2.0
"""The exact solver: a motion in closed form, evaluated at any time from its anchor."""

import functools
import math

import numpy as np

from rigid_body_sim.compilation.memory import memory
from rigid_body_sim.compilation.repeated import repeated
from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.compilation.threads import look, on_all_cores
from rigid_body_sim.errors import BadInput
from rigid_body_sim.mechanics.bounds import drive, swing_rate
from rigid_body_sim.mechanics.events import WATCHED, Watcher, watches
from rigid_body_sim.mechanics.ledger import ENTRIES_SIZE
from rigid_body_sim.mechanics.quadrature import Actors, Quadrature
from rigid_body_sim.motions import loops as template
from rigid_body_sim.scene.state import TIME

CROWD = 4    # most events reported within a tick: a body at 1e6 rad/s would flip hundreds of times
NONE_YET = (-math.inf,) * CROWD
LEAST = 512      # least number of states of many bodies that a thread takes
AT_ONCE = 32768  # states of one call of a kernel, which takes a tenth of a second at most


@functools.cache
def loops(motion):
    """Return the module of bulk loops bound to a motion (rigid_body_sim/motions/loops.py)."""
    bindings = {name: f'{motion.__name__}:{name}' for name in template.BINDINGS}
    bulk = template.IN_COLUMNS if motion.fill_columns is not None else template.ONE_BY_ONE
    for name, binding in bulk.items():
        bindings[name] = binding.format(motion.__name__)
    return specialise(template, **bindings)


class _Asked:
    """Objects that only the ledger and the events of a scene need, made when first used."""

    def __init__(self, scene, motion):
        self.scene, self.motion = scene, motion

    @functools.cached_property
    def actors(self):
        """The Actors of the scene."""
        return Actors(self.scene)

    @functools.cached_property
    def watched(self):
        """The quantities that are watched in the scene."""
        return watches(self.scene)

    @functools.cached_property
    def tells(self):
        """Whether the motion knows the times of all events that are watched."""
        return self.motion.next_event is not None and (
            {watch.name for watch in self.watched} == {*self.motion.EVENTS} & {*WATCHED})


class Exact:
    """Solve a scene by the motion that absorbs it.

    Nothing accumulates: every state is evaluated from the state given to :meth:`start`, so it
    depends on no other time that was asked.

    Parameters
    ----------
    scene : Scene
    motion : module
        What ``motions.absorbing_motion(scene)`` returned.
    solved : Scene, optional
        The scene that the motion absorbs, where it differs from the one that is published
        (nearly.py).
    """

    name = 'exact'

    def __init__(self, scene, motion, solved=None):
        self.motion = motion
        self._scene, self._solved = scene, solved or scene
        self._parameters = motion.parameters(self._solved)
        self._loops, self._asked = loops(motion), _Asked(scene, motion)
        self.rests_on_start = motion.takes is not None or self.is_nearly
        self.anchor, self._start = None, None    # of a solver that was started
        self._next_event, self._quadrature, self._watcher = None, None, None
        self._last_events = NONE_YET

    @property
    def solved(self):
        """The Scene that the motion absorbs."""
        return self._solved

    @property
    def is_nearly(self):
        """Whether the scene that the motion absorbs differs from the one that is published."""
        return self._solved is not self._scene

    def takes(self, vector):
        """Return whether the motion holds from a state (14 doubles)."""
        return self.motion.takes is None or self.motion.takes(self._solved, vector)

    def start(self, vector):
        """Anchor the motion at a state (14 doubles, with its time); return a solver from it."""
        started = object.__new__(Exact)
        started.__dict__ = self.__dict__.copy()
        started.anchor, started._start = memory(np.empty(self.motion.ANCHOR_SIZE)), vector.copy()
        self.motion.anchor(memory(self._parameters), memory(vector), started.anchor)
        return started

    def runner(self):
        """Return ``run(start, time, out)``, which fills out with the state at a time from a start.

        It has the bits of ``self.start(start).state(time, out)``, by one kernel. Calls may not
        overlap: each thread makes a runner of its own.
        """
        room = np.concatenate((np.empty(self.motion.ANCHOR_SIZE), self._parameters))
        return repeated(self._loops.final, room, True, _refuse_state)

    def state(self, time, out):
        """Fill out, shape (14,), with the state at a time (s)."""
        self.motion.state(self.anchor, time, out)
        if time < self._start[TIME]:
            _refuse_beyond(out[np.newaxis])

    def states(self, times, out):
        """Fill out, shape (n, 14), with the states at n times, in any order.

        Raises
        ------
        BadInput
            A time so long before the start that the motion is beyond what doubles hold.
        """
        states, anchor, numbers = self._loops.states, self.anchor, memory(times)
        if len(times) <= AT_ONCE:
            states(anchor, numbers, out)
        else:
            for first in range(0, len(times), AT_ONCE):    # an interrupt is handled between calls
                look()
                states(anchor, numbers[first:first + AT_ONCE], out[first:first + AT_ONCE])
        if len(times) and times.min() < self._start[TIME]:
            _refuse_beyond(out)

    def many(self, starts, times, out):
        """Fill out, shape (bodies, n, 14), with the states of many bodies at n times (s).

        The bodies start from `starts`, shape (bodies, 14); all cores take part. Raises what
        `states` raises.
        """
        parameters, at_once = self._parameters[np.newaxis], max(1, AT_ONCE // max(1, len(times)))

        def work(part):
            for first in range(part.start, part.stop, at_once):
                some = slice(first, min(first + at_once, part.stop))
                for begin in range(0, max(1, len(times)), AT_ONCE):
                    look()
                    then = slice(begin, begin + AT_ONCE)
                    self._loops.ensemble(parameters, starts[some], times[then], out[some, then])

        on_all_cores(work, len(starts), LEAST // max(1, len(times)))
        if len(times) and len(starts) and times.min() < starts[:, TIME].max():
            _refuse_beyond(out.reshape(-1, out.shape[-1]))

    def allowance(self, until):
        """Return None: a closed form allows itself no error (integrators/protocols.py)."""

    def entries(self, time):
        """Return the ledger's entries from anchor to time, shape (5,) (mechanics/ledger.py)."""
        out = np.zeros(ENTRIES_SIZE)
        if self.motion.entries is not None:
            self.motion.entries(self.anchor, time, out)
        elif self._asked.actors.acts:
            if self._quadrature is None:
                self._quadrature = Quadrature(self._asked.actors, self.states, self._start, 0.0)
            out[:] = self._quadrature.until(time)
        return out

    def events(self, after, until, tick=0.0):
        """Return the (time, name, values) of what happens after one time and up to another.

        They are in order of time. Where more than CROWD happen within the length of a tick (s),
        the rest of that time is passed over. Events that the motion does not tell are looked for
        on its states, going forward in time.
        """
        if not self._asked.tells:
            if self._watcher is None:
                self._watcher = Watcher(self, self._asked.watched, float(self._start[TIME]),
                                        swing_rate(self._scene), drive(self._scene, None))
            found = self._watcher.events(until, tick)
            return [event for event in found if event[0] > after]
        found = []
        while self._next_event is None or self._next_event[0] <= until:
            if self._next_event is not None:
                time, code = self._next_event
                found.append((time, self.motion.EVENTS[code], {}))
                self._last_events = (*self._last_events[1:], time)
                after = max(time, self._last_events[0] + tick)
            self._next_event = self.motion.next_event(self.anchor, after)
        return found


def _refuse_state(start, time, out):
    """Raise BadInput: a state before the start is not finite."""
    _refuse_beyond(out[np.newaxis])


def _refuse_beyond(states):
    """Raise BadInput if a state is not finite: going back, drag makes a motion grow for ever."""
    good = np.isfinite(states).all(axis=1)
    if not good.all():
        raise BadInput('time', f'at {float(states[~good][0, TIME])!r} s, before the start, the '
                       'motion is beyond what doubles hold', 'a later time')
