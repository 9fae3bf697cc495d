# SPDX-License-Identifier: Apache-2.0
"""The course of a scene whose actions have kinks: each stretch between two is a march of its own.

Between two kinks every switch (scene/effects/protocol.py, Acting) keeps its side, which the
kernels are given as a number, so what they compute is smooth there. The switches are looked at
several times in each step of the march; where one has changed its sign, or has done so for a while
between two looks (dips.py), the time of that is located to round-off on the march itself, and a
new march starts there. So no step crosses a kink, and a method keeps its order.

A body on a hinge with dry friction comes to rest when its rate passes zero under a torque that the
friction balances, and stays until the torque outgrows it.
"""

import bisect
import math
from typing import NamedTuple

import numpy as np

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.errors import NotConverged
from rigid_body_sim.integrators.equations.euler import INVERSE
from rigid_body_sim.integrators.marching import sides
from rigid_body_sim.integrators.marching.course import NO_STEP, Course, fill, stops_after
from rigid_body_sim.integrators.marching.dips import dip
from rigid_body_sim.integrators.marching.points import (
    SCALES,
    STEP,
    TIME,
    VALUES,
)
from rigid_body_sim.integrators.marching.work import Doublings, Work
from rigid_body_sim.scene.state import ANGULAR_VELOCITY, STATE_SIZE, VELOCITY

LOOKS = 4                    # looks in one step, at least
TURNED = 1.0                 # rad, at most between two looks at a body on a hinge that winds
DEAR = 100                   # steps that cost as much as the looks of one
STALLS = 4                   # marches that end where they begin: then a body slides along a kink
NEAR = 4.0                   # changes between looks: within them a switch may be left in between
SHORTEST, LONGEST = 2.0 ** -20, 2.0 ** -4    # s, between two looks at a body at rest
CALM, BRISK = 0.01, 0.1      # share of the friction by which a torque changes between two looks
FIRST = 2.0 ** -7            # s, the step of a body that breaks loose
KEPT = 16                    # marches that stay in memory; others are made anew when asked for


class Start(NamedTuple):
    """The settings that a course takes from the solver that starts it."""

    method: object
    scene: object
    most: object
    step: float | None
    begin: float
    vector: np.ndarray
    stop: float


class Stretch(NamedTuple):
    """The time between two kinks.

    Attributes
    ----------
    begin, end : float
        s; the end is a breakpoint of what acts, a kink may come before.
    vector : array (14,)
        The state at its beginning.
    modes : tuple of floats
        The side of each switch: 1, -1, or 0 of one that stays on its kink.
    rests : bool
        Whether dry friction holds the body.
    head : array or None
        Step and scales of the march before, so that the errors of unknowns that are small now are
        not measured against their own size.
    """

    begin: float
    end: float
    vector: np.ndarray
    modes: tuple
    rests: bool
    head: np.ndarray | None


class Within(Course):
    """A march on which every switch keeps its side."""

    def __init__(self, start, bound, modes, head):
        super().__init__(start, bound)
        prototype, vector, piece = self._first_piece()
        prototype = prototype.copy()
        prototype[bound.equations.modes] = modes
        bound.track.first_piece(prototype, vector, piece)
        self._adapts = start.step is None
        if head is not None and self._adapts:
            bound.set_head(piece, head)

    def head(self, time):
        """Return planned step and scales of the step that holds a time (s), an array."""
        self.state(time, np.empty(STATE_SIZE))
        _, point, _ = self._bound.parts_of(self._pieces[0])
        return np.array(point[STEP:VALUES])


class Resting:
    """A body that dry friction holds."""

    def __init__(self, vector):
        self._vector = vector

    def step_at(self, time):
        """Return NO_STEP: it takes none."""
        return NO_STEP

    def state(self, time, out):
        """Fill `out` with the state at a time (s)."""
        out[:] = self._vector
        out[TIME] = time

    def states(self, times, out):
        """Fill the rows of `out` with the states at times (s)."""
        out[:] = self._vector
        out[:, TIME] = times


class Switched:
    """Stretches from a start on, each made when the march reaches it.

    Parameters
    ----------
    stepped : Stepped
        Started.
    bound : marching.bound.Bound
        Its equations have switches.
    """

    TELLS_EVENTS = False

    def __init__(self, stepped, bound):
        self._method, self._scene, self._most = stepped.method, stepped.scene, stepped.most
        self._step, self._slowest, self._stop = stepped.step, 1.0 / stepped.horizon, stepped.stop
        self._bound, equations = bound, bound.equations
        self._kernels = specialise(sides, switching=equations.switching_source(),
                                   COUNT=f'COUNT = {len(equations.modes)}\n')
        self._stretches, self._begins, self._stalls, self._steps = [], [], 0, 0
        self._winds = equations.frame.hinge is not None and equations.frame.hinge.winds
        self._courses = {}
        self._enter(np.array(stepped.vector, dtype=float), None)

    def state(self, time, out):
        """Fill `out` with the state at a time (s) not before the start."""
        self._reach(time)
        self._course(self._place(time)).state(time, out)

    def states(self, times, out):
        """Fill the rows of `out` with the states at times (s) not before the start."""
        self._reach(float(times.max()))
        fill(times, out, self._begins, self._course)

    def step_at(self, time):
        """Return when the step that holds a time (s) begins and ends, s."""
        self._reach(time)
        return self._course(self._place(time)).step_at(time)

    def kinks(self, until):
        """Return the times of the kinks after the start and before a time, s."""
        self._reach(until)
        return [begin for begin in self._begins[1:] if begin < until]

    def _place(self, time):
        return bisect.bisect_right(self._begins, time) - 1

    def _course(self, place):
        """Return the course of a stretch."""
        if place not in self._courses:
            if len(self._courses) == KEPT:
                del self._courses[next(iter(self._courses))]
            stretch = self._stretches[place]
            self._courses[place] = (
                Resting(stretch.vector) if stretch.rests else
                Within(self._start(stretch.begin, stretch.vector), self._bound, stretch.modes,
                       stretch.head))
        return self._courses[place]

    def _start(self, begin, vector):
        return Start(self._method, self._scene, self._most, self._step, begin, vector, self._stop)

    def _reach(self, target):
        """Look ahead until every kink up to a time (s) is known."""
        def arrived(limit):
            for _ in range(limit):
                if self._seen > target:
                    return True
                self._look_on()
                self._steps += 1
            return False

        if not self._seen > target:
            work = Work(f'{self._method.NAME} on {self._scene.name}', self._most, DEAR,
                        made=self._steps, doublings=Doublings(target, 1))
            work.go(arrived, lambda: self._seen, target)

    def _sides(self, vector, modes=None):
        """Return the switches at a state, as floats."""
        p = self._bound.equations.held(float(vector[TIME]))
        if modes is not None:
            p[self._bound.equations.modes] = modes
        out = np.empty(len(self._bound.equations.modes))
        self._kernels.sides(p, vector, out)
        return out.tolist()

    def _pull(self, vector):
        """Return the torque along a hinge that friction is to bear, N m."""
        equations = self._bound.equations
        p, y = equations.start(vector)
        _, growth, *_ = equations.kernels.rate(p, y)
        return float(growth / p[INVERSE])

    def _enter(self, vector, head):
        """Begin a stretch at a state (14 doubles, which stay as they are)."""
        equations, begin = self._bound.equations, float(vector[TIME])
        end = stops_after(begin, equations.breakpoints, self._stop)[0]
        found, rests = self._sides(vector), False
        modes = [float(side > 0.0) - float(side < 0.0) for side in found]
        undecided = [k for k, mode in enumerate(modes) if mode == 0.0]
        if equations.grip > 0.0 and not vector[ANGULAR_VELOCITY].any():
            pull = self._pull(vector)
            rests = abs(pull) <= equations.grip
            for k in equations.gripping:
                modes[k] = 0.0 if rests else math.copysign(1.0, pull)
            undecided = [k for k in undecided if k not in equations.gripping]
        for k in () if rests else undecided:
            modes[k] = self._tried(vector, modes, k, head)
        self._stretches.append(Stretch(begin, end, vector, tuple(modes), rests, head))
        self._begins.append(begin)
        self._seen, self._spacing = begin, SHORTEST
        self._margins_seen = ()    # at the last two looks of the stretch

    def _tried(self, vector, modes, k, head):
        """Return the side to which a switch goes that begins on its kink; 0 where it stays."""
        begin = float(vector[TIME])
        for mode in (1.0, -1.0):
            trial = [*modes[:k], mode, *modes[k + 1:]]
            course = Within(self._start(begin, vector), self._bound, trial, head)
            time = begin + (course.step_at(begin)[1] - begin) * 2.0 ** -10
            out = np.empty(STATE_SIZE)
            course.state(time, out)
            side = self._sides(out, trial)[k]
            if side * mode > 0.0:
                return mode
        return 0.0

    def _look_on(self):
        """Look at the switches in the step ahead; enter the next stretch if one changes."""
        place = len(self._stretches) - 1
        stretch, course = self._stretches[place], self._course(place)
        end = self._end_at_rest(stretch) if stretch.rests else course.step_at(self._seen)[1]
        end = min(end, stretch.end)
        out, before = np.empty(STATE_SIZE), self._seen
        looks = self._looks(course, end)
        for share in range(1, looks + 1):
            time = end if share == looks else self._seen + (end - self._seen) * (share / looks)
            if not time > before:
                continue
            margins, left = self._margins(course, stretch, time, out), None
            if min(margins) < 0.0:
                left = time
            elif _are_near(margins, *self._margins_seen[::-1]):
                left = dip(lambda at: self._margins(course, stretch, at, out), before, time)
            self._margins_seen = (*self._margins_seen[-1:], margins)
            if left is not None:
                self._cross(course, stretch, before, left)
                return
            before = time
        self._seen = end
        if end == stretch.end < math.inf:
            course.state(end, out)
            self._enter(out, self._head(stretch, course, end))

    def _looks(self, course, end):
        """Return the number of looks until a time (s)."""
        if not self._winds:
            return LOOKS
        ends = np.empty((2, STATE_SIZE))
        course.states(np.array([self._seen, end]), ends)
        rate = float(np.abs(ends[:, ANGULAR_VELOCITY]).sum(axis=1).max())
        turned = rate * (end - self._seen)
        return max(LOOKS, math.ceil(turned / TURNED)) if math.isfinite(turned) else LOOKS

    def _margins(self, course, stretch, time, out):
        """Return how far the switches are on their sides at a time of a stretch: below 0 beyond.

        `out` is filled with the state. Of a body at rest it is what friction could bear yet.
        """
        course.state(time, out)
        if stretch.rests:
            return [self._bound.equations.grip - abs(self._pull(out))]
        found = self._sides(out, stretch.modes)
        return [side * mode if mode != 0.0 else -abs(side)
                for side, mode in zip(found, stretch.modes, strict=True)]

    def _changed(self, course, stretch, time, out):
        """Return the switches that have left their sides at a time of a stretch."""
        left = [k for k, margin in enumerate(self._margins(course, stretch, time, out))
                if margin < 0.0]
        return [-1] if stretch.rests and left else left

    def _cross(self, course, stretch, low, high):
        """Enter the stretch after the first kink between two times."""
        out = np.empty(STATE_SIZE)
        while True:    # bisection takes as many turns as a double has bits
            middle = low + 0.5 * (high - low)
            if not low < middle < high:
                break
            if self._changed(course, stretch, middle, out):
                high = middle
            else:
                low = middle
        changed = self._changed(course, stretch, high, out)
        stalled = high - stretch.begin <= 8.0 * math.ulp(high)
        self._stalls = self._stalls + 1 if stalled else 0
        if self._stalls > STALLS:
            raise self._slides(high)
        if any(k in self._bound.equations.gripping for k in changed):
            out[ANGULAR_VELOCITY] = out[VELOCITY] = 0.0
        self._enter(out, self._head(stretch, course, high))

    def _head(self, stretch, course, time):
        head = stretch.head if stretch.rests else course.head(time)
        if head is None:
            head = self._bound.first_head(FIRST)
        # of a body that was at rest: what time adds up to has the rounding of the clock, and
        # an omega of that size turns the body by less than its accuracy
        scale = SCALES - STEP    # of omega
        head[scale] = max(head[scale], self._slowest * self._slowest)
        return head

    def _end_at_rest(self, stretch):
        """Return the time of the next look at a body at rest, s."""
        if not self._bound.equations.in_field:
            return stretch.end
        out = stretch.vector.copy()
        out[TIME] = self._seen
        now, grip = self._pull(out), self._bound.equations.grip
        while True:
            out[TIME] = self._seen + self._spacing
            change = abs(self._pull(out) - now)
            if change <= BRISK * grip or self._spacing <= SHORTEST:
                break
            self._spacing *= 0.5
        time = self._seen + self._spacing
        if change < CALM * grip and self._spacing < LONGEST:
            self._spacing *= 2.0
        return max(time, math.nextafter(self._seen, math.inf))

    def _slides(self, time):
        return NotConverged(
            f'{self._method.NAME} on {self._scene.name}: at t = {time!r} s the body slides along '
            'a kink, where what acts drives it back from both sides; at a hinge that is '
            'dry_friction, elsewhere a smooth function like tanh would do', time)


def _are_near(now, before=None, earlier=None):
    """Return whether one of some switches may be left and back between two looks.

    It changes by little between looks where it is far from zero.

    Parameters
    ----------
    now, before, earlier : list of float
        Margins at the last three looks, as far as there are.
    """
    if earlier is None:
        return True
    for k, last in enumerate(now):
        one, other = before[k], earlier[k]
        if min(last, one) <= NEAR * max(abs(last - one), abs(one - other)):
            return True
    return False
