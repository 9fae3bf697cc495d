# SPDX-License-Identifier: Apache-2.0
"""Many bodies of a scene by Taylor series, eight at once: taylor's mode for ensembles.

batch_lane.py has the numbers of a body, batch_step.py a step in the vector unit, batch_march.py
the march.

The states agree with those of the method to the accuracy asked, not to the bit, since order and
steps differ.
"""

import math

import numpy as np

from rigid_body_sim.compilation.lanes import LANES
from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.compilation.threads import in_slices
from rigid_body_sim.integrators.equations import euler, series
from rigid_body_sim.integrators.marching import (
    batch_directions,
    batch_hinge,
    batch_lane,
    batch_march,
    batch_turning,
)
from rigid_body_sim.integrators.marching.batch_march import ANYBODY, NOBODY, SEATS
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.rotations import from_matrix, multiply, rotate
from rigid_body_sim.numerics.vectors import across, apply, cross, scaled
from rigid_body_sim.scene.state import TIME as STATE_TIME

ROUNDS = 64    # rounds of steps in the first call of the march
COARSE_FROM = 3e-8    # the least tolerance, for a second, to which the shorter series is quicker
LINE = 64    # bytes of the processor's cache: rows of lanes begin with one


def unit(vector):
    """Return the unit vector along a vector that is not zero."""
    length = hypot3(*vector)
    return tuple(x / length for x in vector)


def directions(force, couple):
    """Return three unit vectors as rows of a rotation.

    The first is along a force, the second across it in the plane of force and couple.
    """
    first = force if any(force) else couple
    first = unit(first) if any(first) else (1.0, 0.0, 0.0)
    least = min(range(3), key=lambda k: abs(first[k]))
    for other in (couple, tuple(float(k == least) for k in range(3))):
        second = across(first, other)
        if hypot3(*second) > 1e-3 * hypot3(*other):
            break
    second = unit(second)
    return first, second, cross(first, second)


def rows_for(p, hinge):
    """Return the directions, and the rows of lanes with the numbers of the equations.

    p holds the parameters of equations/series.py; `hinge` is that of the frame, or None. The
    directions of a body on a hinge are the axes of its frame where the angle is 0.
    """
    def numbers(layout, name):
        return p[layout.part(name).places].tolist()

    inverse = numbers(euler.EQUATION, 'inverse')
    force, couple = numbers(series.SERIES, 'force'), numbers(series.SERIES, 'couple')
    constant, (u1, u2, u3, u4, u5, u6) = (
        numbers(series.SERIES, 'constant'), numbers(series.SERIES, 'pull'))
    if hinge:
        axes = multiply(*hinge.zero, *euler.load_axes(p))
        rows = tuple(rotate(*axes, *(float(k == i) for k in range(3))) for i in range(3))
        across, aside, _ = apply(rows, force)
        # the second direction is (-y, x, 0) in the body where the first one is (x, y, 0)
        pull = np.zeros((3, 3))
        pull[2] = across * u5 + aside * u6, across * u6 - aside * u5, 0.0
        constant[2] += inverse[2] * apply(rows, couple)[2]
        second = (0.0, 0.0, 0.0)
    else:
        rows = directions(force, couple)
        along, aside, _ = apply(rows, couple)
        pull = hypot3(*force) * np.array(((0.0, u1, u2), (u4, 0.0, u3), (u5, u6, 0.0)))
        pull += np.diag(scaled(along, inverse))
        second = scaled(aside, inverse)
    table = np.zeros((batch_lane.ROWS, LANES))
    for at, values in (
        (batch_lane.EULER, numbers(euler.EQUATION, 'euler')),
        (batch_lane.CONSTANT, constant),
        (batch_lane.U, pull.ravel()),
        (batch_lane.V, second),
        (batch_lane.DRAG, numbers(series.SERIES, 'drag')),
        (batch_lane.INVERSES, 1.0 / np.arange(1.0, batch_lane.ORDER + 1.0)),
    ):
        table[at:at + len(values)] = np.reshape(values, (-1, 1))
    return rows, table


def _form(equations):
    """Return the module with the Form of a scene's equations."""
    if equations.hinged:
        return batch_hinge
    return batch_directions if equations.pushed or equations.coupled else batch_turning


class Batch:
    """Bodies under one scene's equations at some times.

    Parameters
    ----------
    equations : series.Series
    tolerance : float
        For a second.
    times : array (n,)
        s, in any order, n > 0.
    """

    def __init__(self, equations, tolerance, times):
        self._equations, self._tolerance, self._times = equations, tolerance, times
        self._stretches, self._numbers = [], {}
        self._order = np.argsort(times, kind='stable')
        form, dragged = _form(equations).__name__, equations.dragged and not equations.hinged
        series = f'{form}:{"coarse_" if tolerance >= COARSE_FROM else ""}'
        self._kernels = specialise(
            batch_march, advance=f'{series}advance{"_with_drag" if dragged else ""}',
            between=f'{series}between', unknowns=f'{form}:unknowns')
        rising, begin = times[self._order], -math.inf
        # between two breakpoints the equations hold, and their result at the end is the start of
        # the next stretch
        for end in (*(time for time in equations.breakpoints if time <= rising[-1]), math.inf):
            first, last = np.searchsorted(rising, (begin, end)).tolist()
            self._stretches.append((begin, first, last, end))
            begin = end

    def _numbers_from(self, begin):
        """Return the rows of lanes, the parameters of each lane and the turn from a time on."""
        if begin not in self._numbers:
            p = self._equations.held(begin)
            rows, table = rows_for(p, self._equations.frame.hinge)
            self._numbers[begin] = (
                table, np.tile(p, (LANES, 1)), from_matrix(tuple(zip(*rows, strict=True))))
        return self._numbers[begin]

    def run(self, starts, out):
        """Fill out, shape (bodies, n, 14), with the states of bodies.

        They start from `starts`, shape (bodies, 14).

        No start is later than a time.

        Return (number of a body whose state is no longer finite or whose step fell below what the
        clock resolves, its time), or None.
        """
        states, seats = starts.copy(), np.empty(SEATS, dtype=np.int64)
        earliest = starts[:, STATE_TIME].min(initial=math.inf)
        for begin, first, last, end in self._stretches:
            if end <= earliest and first == last:
                continue    # it is over before the first body starts
            table, p, turn = self._numbers_from(begin)
            W, numbers, found = _on_lines(table), p.copy(), []

            def arrived(rounds, W=W, numbers=numbers, turn=turn, stretch=(first, last, end),
                        found=found):
                found[:] = self._kernels.march(
                    W, numbers, turn, self._tolerance, seats, states, self._times, self._order,
                    *stretch, out, rounds)
                return found[0] != ANYBODY

            self._kernels.empty(seats)
            in_slices(arrived, ROUNDS)
            body, time = found
            if body != NOBODY:
                return body, time
        return None


def _on_lines(table):
    """Return a copy, flat, that begins with a line of the cache."""
    room = np.empty(table.size + LINE // 8)
    begin = -room.ctypes.data % LINE // 8
    copy = room[begin:begin + table.size]
    copy[:] = table.ravel()
    return copy
