# SPDX-License-Identifier: Apache-2.0
"""The kernels of a method that marches in compiled code, and the places in their pieces.

The contract `Bound` is in integrators/protocols.py.
"""

import bisect
import functools
import itertools
import math

import numpy as np

from rigid_body_sim.compilation.memory import memory
from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.integrators.marching import track
from rigid_body_sim.integrators.marching.course import Course
from rigid_body_sim.integrators.marching.points import SCALES, STEP, TIME, VALUES
from rigid_body_sim.integrators.marching.switched import Switched

KEPT = 64    # tracks that are kept for scenes that differ in numbers only


class Bound:
    """The kernels of one method on the equations of one scene.

    Parameters
    ----------
    method : Method
        Its family is a MarchingFamily (protocols.py).
    stepped : Stepped
    """

    KEEPS_ENTRIES = False

    def __init__(self, method, stepped):
        family = method.FAMILY
        self.equations = equations = family.equations_of(stepped.scene, stepped.wrench)
        self.march = family.march(method, equations, stepped.step is None)
        control, point = family.begin(stepped, self.march)
        self._family, self._prototypes = family, {}
        self._beginning = np.concatenate((control, point))
        sizes = [equations.parameter_count, len(control), len(point), len(point)]
        places = tuple(itertools.accumulate(sizes))
        self.point, self._places = places[1], places
        self.piece_size = places[-1] + track.STORE + track.CHECKPOINTS * len(point)
        arrives = stepped.step is None and self.march.arrive is not None
        self.track = _track(self.march.__name__, equations.kernels.__name__, equations.write,
                            places, arrives)

    def at(self, stepped):
        """Return the Bound of a solver that differs in its accuracy: it shares the kernels."""
        other = object.__new__(Bound)
        other.__dict__ = self.__dict__.copy()
        other._beginning = np.concatenate(self._family.begin(stepped, self.march))
        other._prototypes = {}
        return other

    def runner(self, stepped, slow):
        """Return (kernel, room) of ``kernel(room, vector, time, out)``, or None.

        The kernel fills `out` as a course from that start does, and returns REACHED; where it
        returns something else, a course is to go there: so it is of a body that turns slower than
        `slow` (rad/s). `room` is its memory, so calls may not overlap. None where what acts has
        kinks.
        """
        if self.equations.modes:
            return None
        last = self.equations.breakpoints[-1] if self.equations.breakpoints else -math.inf
        room = np.concatenate((self.prototype(last), np.empty(self.piece_size)))
        room[self.point + TIME] = last    # from when on what acts is constant
        if slow > 0.0:
            room[self.point + STEP] = slow * slow
        return self.track.final, room

    def course(self, stepped):
        """Return the course of a started solver."""
        if self.equations.modes:
            return Switched(stepped, self)
        return Course(stepped, self)

    def set_head(self, piece, head):
        """Give the first point of a piece the planned step and the scales of another march."""
        _, point, following = self.parts_of(piece)
        kept = piece[self._places[-1] + track.STORE:][:len(point)]
        for one in (point, following, kept):
            one[STEP:VALUES] = memory(head)

    def first_head(self, step):
        """Return a planned step (s) and the scales of a march that none went before."""
        _, point, _ = self.parts_of(self.prototype(-math.inf))
        return np.array([step, *point[SCALES:VALUES]])

    def parts_of(self, piece):
        """Return control, point and following point of a piece, views of it."""
        control, point, following, counts = self._places
        return piece[control:point], piece[point:following], piece[following:counts]

    def steps_of(self, piece):
        """Return the number of steps made in a piece."""
        return int(piece[self._places[-1] + track.COUNT])

    def prototype(self, time):
        """Return the beginning of a piece that starts at a time (s): parameters, control, point.

        The parameters are those that hold from that time to the next breakpoint.
        """
        k = bisect.bisect_right(self.equations.breakpoints, time)
        if k not in self._prototypes:
            held = self.equations.held(time)
            self._prototypes[k] = np.concatenate((held, self._beginning))
        return self._prototypes[k]


@functools.lru_cache(maxsize=KEPT)
def _track(march, kernels, write, places, arrives):
    """Return the template track.py bound to a march, whose `places` are those in a piece.

    The march and the kernels of the equations are given by the names of their modules. A march
    that `arrives` has a kernel for final states.
    """
    names = 'begin', 'march', 'between', 'arrive', 'VALUES'
    bindings = {name: f'{march}:{name}' for name in names}
    bindings['start'], bindings['write'] = f'{kernels}:start', write
    for name, place in zip(('CONTROL', 'POINT', 'FOLLOWING', 'COUNTS'), places, strict=True):
        bindings[name] = f'{name} = {place}\n'
    bindings['final'] = f'final = {"without_points" if arrives else "in_steps"}\n'
    return specialise(track, **bindings)
