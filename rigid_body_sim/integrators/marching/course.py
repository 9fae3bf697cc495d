# SPDX-License-Identifier: Apache-2.0
"""The course of a solver whose method marches in compiled code, piece by piece.

A piece is one array (track.py): the stretch between two breakpoints of what acts. Bound, in
bound.py, has its kernels and places; the contract `Course` is in integrators/protocols.py.
"""

import bisect
import math

import numpy as np

from rigid_body_sim.compilation.memory import memory
from rigid_body_sim.compilation.threads import look
from rigid_body_sim.errors import NotConverged
from rigid_body_sim.integrators.marching.points import (
    FIXED,
    LOST,
    ORIGIN,
    REACHED,
    STEP,
    TIME,
    VALUES,
)
from rigid_body_sim.integrators.marching.work import Doublings, Work
from rigid_body_sim.scene.state import STATE_SIZE

FOR_EVER = (math.inf,)
NO_STEP = -math.inf, math.inf    # what holds a time where nothing is stepped
AT_ONCE = 4096    # states of one call of a kernel


def stops_after(begin, breakpoints, stop=math.inf):
    """Return the times after a beginning at which a step ends, s, and infinity."""
    return sorted({time for time in (*breakpoints, stop, math.inf) if time > begin})


def fill(times, out, begins, course_of):
    """Fill the rows of `out` with the states at times (s), each by the course that holds it.

    Parameters
    ----------
    begins : list of float
        Where the courses begin, s, in order; the first one not later than any of the times.
    course_of : callable
        The number of a course -> the course.
    """
    places = np.searchsorted(begins, times, side='right') - 1
    for place in np.unique(places):
        rows = np.flatnonzero(places == place)
        part = np.empty((len(rows), STATE_SIZE))
        course_of(int(place)).states(times[rows], part)
        out[rows] = part


def lost(method, scene, time):
    """Return the NotConverged of a march that ends at a time (s)."""
    time = float(time)
    return NotConverged(f'{method.NAME} on {scene.name}: at t = {time!r} s the state is no longer '
                        'finite, or the step fell below what the clock resolves', time)


class Course:
    """One march from a start: a piece for each stretch, made when the march reaches it."""

    TELLS_EVENTS = False

    def __init__(self, stepped, bound):
        # A course does not keep the solver itself: two objects that hold each other stay in
        # memory until the garbage is collected.
        self._method, self._scene, self._most = stepped.method, stepped.scene, stepped.most
        self._begin, self._vector = stepped.begin, stepped.vector
        self._bound, self._pieces, self._ends = bound, [], FOR_EVER
        if bound.equations.breakpoints or stepped.stop < math.inf:
            self._ends = stops_after(self._begin, bound.equations.breakpoints, stepped.stop)

    def kinks(self, until):
        """Return the times of kinks: none."""
        return []

    def step_at(self, time):
        """Return when the step that holds a time (s) begins and ends, s."""
        self.state(time, np.empty(STATE_SIZE))
        piece = self._pieces[bisect.bisect_right(self._ends, time)]
        control, point, following = self._bound.parts_of(piece)
        begin, end = float(point[TIME]), float(following[TIME])
        if end > begin:
            return begin, end
        return begin, float(control[ORIGIN] + (point[STEP] + 1.0) * control[FIXED])    # fixed.py

    def _first_piece(self):
        """Append the piece at the start, not filled yet; return what track.first_piece takes."""
        self._pieces.append(memory(np.empty(self._bound.piece_size)))
        return self._bound.prototype(self._begin), self._vector, self._pieces[0]

    def _next_piece(self, begin):
        """Return the piece that begins where the last one ends, at a time (s)."""
        bound, before = self._bound, self._pieces[-1]
        piece, prototype = memory(np.empty(bound.piece_size)), memory(bound.prototype(begin))
        fixed, first = bound.equations.fixed_count, bound.point + VALUES
        values = slice(first, first + bound.march.SIZE)
        piece[:len(prototype)] = prototype
        piece[:fixed], piece[bound.point + TIME] = before[:fixed], begin
        piece[values] = before[values]
        bound.track.opened(piece)
        return piece

    def state(self, time, out):
        """Fill `out` with the state at a time (s) not before the start."""
        track = self._bound.track
        if not time < self._ends[0]:
            self.states(np.array([time]), out[np.newaxis])
        elif self._pieces:
            if track.state(self._pieces[0], time, self._ends[0], out) != REACHED:
                self._go_on(self._pieces[0], time, out)
        else:
            first = self._first_piece()
            if track.first_state(*first, time, self._ends[0], out) != REACHED:
                self._go_on(self._pieces[0], time, out)

    def _go_on(self, piece, time, out):
        """Fill `out` with the state of the first piece at a time far ahead."""
        self._reach(piece, time, self._ends[0], Doublings(time, 1))
        self._bound.track.state(piece, time, self._ends[0], out)

    def _reach(self, piece, target, end, doublings):
        """March until the step from the point holds a time, in slices (work.py)."""
        follow, place = self._bound.track.follow, self._bound.point + TIME

        def arrived(limit):
            status = follow(piece, target, end, limit)
            if status == LOST:
                raise lost(self._method, self._scene, piece[place])
            return status == REACHED

        work = Work(f'{self._method.NAME} on {self._scene.name}', self._most,
                    made=self._bound.steps_of(piece), doublings=doublings)
        work.go(arrived, lambda: float(piece[place]), min(float(target), end))

    def states(self, times, out):
        """Fill the rows of `out` with the states at times (s) not before the start."""
        order = np.argsort(times, kind='stable')
        track, last, done, k = self._bound.track, times[order[-1]], 0, 0
        if not self._pieces:
            track.first_piece(*self._first_piece())
        while done < len(order):
            end, until = self._ends[k], len(order)
            if not last < end:
                until = int(np.searchsorted(times[order], end, side='left'))
            piece, doublings = self._pieces[k], Doublings(float(min(last, end)), len(order))
            while done < until:
                look()
                part = order[done:min(until, done + AT_ONCE)]
                filled = track.states(piece, *map(memory, (times, part)), end, memory(out))
                done += filled
                if filled < len(part):
                    self._reach(piece, times[order[done]], end, doublings)
            k += 1
            if done < len(order) and k == len(self._pieces):
                self._reach(piece, end, end, doublings)
                self._pieces.append(self._next_piece(end))
