"""The exact solver: a motion in closed form, evaluated at any time from its anchor."""

import math

import numpy as np

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.compilation.threads import look, on_all_cores
from rigid_body_sim.mechanics.exchange import Actors, Exchange
from rigid_body_sim.mechanics.ledger import ENTRIES_SIZE
from rigid_body_sim.motions import loops as template

CROWD = 4    # events that are told within a tick: a body at 1e6 rad/s would flip hundreds of times
NONE_YET = (-math.inf,) * CROWD
LEAST = 512      # states of many bodies that a thread takes, at least
AT_ONCE = 32768  # states of one call of a kernel: a tenth of a second at most


def loops(motion):
    """Return the module of bulk loops bound to a motion (rigid_body_sim/motions/loops.py)."""
    bindings = {name: f'{motion.__name__}:{name}' for name in template.BINDINGS}
    for name, binding in (template.IN_COLUMNS if motion.fill_columns is not None else template.ONE_BY_ONE).items():
        bindings[name] = binding.format(motion.__name__)
    return specialise(template, **bindings)


class Exact:
    """Solve a scene by the motion that absorbs it.

    Nothing accumulates: every state is evaluated from the state given to :meth:`start`, so it depends on no other time that was asked.

    Parameters
    ----------
    scene : scenes.Scene
    motion : module
        What ``motions.absorbing_motion(scene)`` returned.
    """

    name = 'exact'

    def __init__(self, scene, motion):
        self.motion = motion
        self._scene = scene
        self._parameters = motion.parameters(scene)
        self._loops, self._actors = loops(motion), None if motion.exchanged else Actors(scene)

    def start(self, vector):
        """Anchor the motion at a state (14 doubles, its time included) and return a solver from there."""
        started = object.__new__(Exact)
        started.__dict__.update(self.__dict__)
        started.anchor, started._start = np.empty(self.motion.ANCHOR_SIZE), vector.copy()
        self.motion.anchor(self._parameters, vector, started.anchor)
        started._next_event, started._exchange, started._last_events = None, None, NONE_YET
        return started

    def state(self, time, out):
        """Fill out, shape (14,), with the state at a time (s)."""
        self.motion.state(self.anchor, time, out)

    def states(self, times, out):
        """Fill out, shape (n, 14), with the states at n times, in any order."""
        states, anchor = self._loops.states, self.anchor
        if len(times) <= AT_ONCE:
            states(anchor, times, out)
            return
        for first in range(0, len(times), AT_ONCE):    # an interrupt is heard between two calls
            look()
            states(anchor, times[first:first + AT_ONCE], out[first:first + AT_ONCE])

    def many(self, starts, times, out):
        """Fill out, shape (bodies, n, 14), with the states at n times (s) from many starts, shape (bodies, 14), on all cores."""
        parameters, at_once = self._parameters[np.newaxis], max(1, AT_ONCE // max(1, len(times)))

        def work(part):
            for first in range(part.start, part.stop, at_once):
                some = slice(first, min(first + at_once, part.stop))
                for begin in range(0, max(1, len(times)), AT_ONCE):
                    look()
                    then = slice(begin, begin + AT_ONCE)
                    self._loops.ensemble(parameters, starts[some], times[then], out[some, then])

        on_all_cores(work, len(starts), LEAST // max(1, len(times)))

    def exchanged(self, time):
        """Return what effects exchanged with the body from the anchor to a time, shape (5,): mechanics/ledger.py."""
        out = np.zeros(ENTRIES_SIZE)
        if self.motion.exchanged is not None:
            self.motion.exchanged(self.anchor, time, out)
        elif self._actors.acts:
            if self._exchange is None:
                self._exchange = Exchange(self._actors, self.states, self._start, 0.0)
            out[:] = self._exchange.until(time)
        return out

    def events(self, after, until, tick=0.0):
        """Return the (time, name, values) of what happens after one time and not later than another, in order.

        Where more than CROWD happen within the length of a tick (s), the rest of that time is passed over.
        """
        found = []
        if self.motion.next_event is None:
            return found
        while self._next_event is None or self._next_event[0] <= until:
            if self._next_event is not None:
                time, code = self._next_event
                found.append((time, self.motion.EVENTS[code], {}))
                self._last_events = (*self._last_events[1:], time)
                after = max(time, self._last_events[0] + tick)
            self._next_event = self.motion.next_event(self.anchor, after)
        return found
