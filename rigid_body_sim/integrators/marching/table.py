# SPDX-License-Identifier: Apache-2.0
"""A sphere on a table under a held wrench, by an adaptive Runge-Kutta method.

Its phases of sliding and rolling are smooth.

rigid_body_sim/integrators/equations/table_rates.py explains the phases, and why sliding has its
own independent variable.
"""

import bisect
import math
from typing import NamedTuple

import numpy as np

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.integrators.equations import table_rates
from rigid_body_sim.integrators.equations.euler import unit
from rigid_body_sim.integrators.equations.table_rates import (
    CREEPING,
    GLIDING,
    PLACE,
    ROLLING,
    SLIDING,
    SPIN,
    UNKNOWNS,
    P,
    Q,
    U,
)
from rigid_body_sim.integrators.marching import steps, unroll
from rigid_body_sim.integrators.marching.adaptive import GROWTH, SAFETY, SHRINK, TRIALS
from rigid_body_sim.integrators.marching.work import Work
from rigid_body_sim.mechanics.ledger import ENTRIES_SIZE
from rigid_body_sim.motions import sliding_sphere
from rigid_body_sim.numerics.functions import hypot, hypot3, power
from rigid_body_sim.numerics.rotations import normalised, rotate, rotate_back
from rigid_body_sim.scene.state import (
    ANGULAR_VELOCITY,
    ORIENTATION,
    POSITION,
    VELOCITY,
)
from rigid_body_sim.scene.state import TIME as STATE_TIME

CLOCK = table_rates.TIME
KEPT = 2048              # most points of a phase; then every other one is dropped
# rad: the ball turns so far before a new slip leaves the direction of its drive; its lag is of the
# order of CREEP^2
CREEP = 1e-4
DEAD = 2.0 ** -56        # share of the speeds: a smaller slip counts as none
FLAT = slice(0, 2)       # the components of a vector along the table
FLOOR = 1e-17            # smallest error that is asked for
DEAR = 50                # steps of a compiled march that a step costs, which Python makes


class OnTable:
    """The kernels and the numbers of one scene and wrench."""

    KEEPS_ENTRIES = True

    def __init__(self, scene, method, wrench, step):
        if step is not None:
            raise BadInput(
                'step',
                f'got {step!r} for a ball on the table',
                'steps end where sliding begins and ends: give an accuracy',
            )
        self.parameters = np.zeros(table_rates.PARAMETERS)
        self.parameters[:sliding_sphere.PARAMETER_SIZE] = sliding_sphere.parameters(scene)
        if wrench:
            axes = 'body' if wrench.frame == 'body' else 'world'
            for name, value in (('force', wrench.force), ('couple', wrench.torque)):
                self.parameters[table_rates.PUSHED.part(f'{axes}_{name}').places] = value
        self.turns_with_body = bool(wrench) and wrench.frame == 'body'
        extra = ENTRIES_SIZE
        self.kernels = specialise(
            steps,
            rate='rigid_body_sim.integrators.equations.table_rates:rate',
            step=unroll.step_source(method, UNKNOWNS, extra),
            trial=unroll.trial_source(method, UNKNOWNS, extra, table_rates.GROUPS),
        )
        self.order, self.weights = method.ORDER, np.array(unroll.weights(method))

    def at(self, stepped):
        """Return the Bound of a solver that differs in its accuracy: this one."""
        return self

    def runner(self, stepped, slow):
        """Return None: runs are those of a course."""

    def course(self, stepped):
        """Return the course of a started solver."""
        return TableCourse(stepped, self)


class TableCourse:
    """One course from a start."""

    TELLS_EVENTS = True

    def __init__(self, stepped, bound):
        self._bound, vector = bound, stepped.vector
        self._name, self._most = f'{stepped.method.NAME} on {stepped.scene.name}', stepped.most
        self._tolerance = stepped.accuracy / stepped.horizon
        p = bound.parameters
        q = normalised(*vector[ORIENTATION])
        omega, v = rotate(*q, *vector[ANGULAR_VELOCITY]), vector[VELOCITY]
        e = p[table_rates.RADIUS] * np.array([omega[1], -omega[0]])
        u = v[FLAT] - e
        if hypot(*u) <= sliding_sphere.ROUNDING * (
            hypot(*v[FLAT]) + p[table_rates.RADIUS] * hypot3(*omega)
        ):
            u = np.zeros(2)
            e = v[FLAT]
        y = np.zeros(UNKNOWNS + ENTRIES_SIZE)
        y[Q:U], y[U:P], y[P:SPIN], y[SPIN] = q, u, v[FLAT] + p[table_rates.RATIO] * e, omega[2]
        self._start, self._begin = np.array(vector), float(vector[STATE_TIME])
        self._phases = [self._phase_from(tuple(y.tolist()))]

    def _phase_from(self, y):
        """Return the phase that begins with the unknowns y."""
        p = self._bound.parameters.copy()
        gx, gy, c = table_rates.drive(p, y)
        if p[table_rates.FRICTION] * p[table_rates.GRAVITY] == 0.0:
            p[table_rates.MODE] = GLIDING
        elif any(y[U:P]):
            p[table_rates.MODE] = SLIDING
        elif hypot(gx, gy) <= c:
            p[table_rates.MODE] = ROLLING
        else:
            p[table_rates.MODE] = CREEPING
        return _Phase(self._bound, p, y, self._tolerance, self._begin)

    def states(self, times, out):
        """Fill the rows of `out` as `state` does, for times not before the start."""
        for row, time in enumerate(times):
            self.state(time, out[row])

    def state(self, time, out):
        """Fill `out` with the state at a time not before the start."""
        self._write(time, self._at(time - self._begin), out)

    def entries(self, time):
        """Return the entries of the ledger from the start to a time."""
        return np.array(self._at(time - self._begin)[UNKNOWNS:])

    def events(self, after, until):
        """Return the (time, name, values) after one time (s) and up to another.

        The events are: rolling began, sliding began.
        """
        # as far as what is rounded to `until`
        self._reach(math.nextafter(until, math.inf) - self._begin)
        names = {CREEPING: 'sliding began', ROLLING: 'rolling began'}
        changes = [
            (self._begin + phase.begin, names[phase.mode], {})
            for phase in self._phases[1:]
            if phase.mode in names
        ]
        return [change for change in changes if after < change[0] <= until]

    def _reach(self, elapsed):
        """March until a time since the start is passed."""
        def arrived(limit):
            for _ in range(limit):
                phase = self._phases[-1]
                if phase.passes(elapsed):
                    return True
                if phase.last is None:
                    phase.go_on()
                else:
                    self._phases.append(self._phase_from(phase.last))
            return False

        if not self._phases[-1].passes(elapsed):
            work = Work(self._name, self._most, DEAR)
            work.go(arrived, lambda: self._begin + self._phases[-1].reached,
                    float(self._begin + elapsed))

    def _at(self, elapsed):
        self._reach(elapsed)
        place = bisect.bisect_right([phase.begin for phase in self._phases], elapsed) - 1
        return self._phases[place].at(elapsed)

    def _write(self, time, y, out):
        vx, vy, *omega = table_rates.motion(self._bound.parameters, y)
        q = normalised(*y[Q:U])
        out[STATE_TIME], out[ORIENTATION], out[ANGULAR_VELOCITY] = time, q, rotate_back(*q, *omega)
        out[POSITION] = self._start[POSITION] + [*y[PLACE:CLOCK], 0.0]
        out[VELOCITY] = vx, vy, 0.0


class Point(NamedTuple):
    """A point of a phase.

    Attributes
    ----------
    y : tuple of floats
        The unknowns, and the ledger.
    lost : tuple of floats
        What their sums have lost.
    scales : tuple of floats
        Squared.
    planned, last : float
        The next step and the step that led here, s or its like.
    """

    y: tuple
    lost: tuple
    scales: tuple
    planned: float
    last: float


class _Phase:
    """Sliding, rolling or gliding from one change to the next.

    The points depend on the start of the phase only.

    Attributes
    ----------
    mode : int
        SLIDING, ROLLING or GLIDING.
    begin : float
        Time since the start of the course, s.
    last : tuple
        Unknowns at the end, once it is reached.
    """

    def __init__(self, bound, p, y, tolerance, origin):
        self._origin = origin    # the time at which the course starts, s
        self._bound, self._p, self._tolerance, self.mode = (
            bound,
            p,
            tolerance,
            int(p[table_rates.MODE]),
        )
        self.begin, self.last = float(y[CLOCK]), None
        self._kept, self._stride, self._count = [], 1, 0
        gx, gy, c = table_rates.drive(p, y)
        _, _, *omega = table_rates.motion(p, y)
        pace = hypot(*y[U:P]) if self.mode == SLIDING else 1.0
        swift = c + hypot(gx, gy) + pace * hypot3(*omega)
        h = power(tolerance, 1.0 / bound.order) / (swift if swift > 0.0 else 1.0)
        if self.mode == CREEPING:
            h = CREEP / max(1.0, hypot3(*omega))
        self._front = Point(y, (0.0,) * len(y), (0.0,) * 4, h, 0.0)
        self._keep()

    @property
    def reached(self):
        """The time that the march has reached, since the start of the course, s."""
        return self._front.y[CLOCK]

    def passes(self, elapsed):
        """Return whether the march has passed a time (s), at which the phase has not ended."""
        return (self.reached if self.last is None else self.last[CLOCK]) > elapsed

    def go_on(self):
        """March by one step, at most to the end of the phase."""
        following = self._next(self._front)
        self.last = self._end(self._front, following)
        self._front = following
        self._count += 1
        self._keep()

    def at(self, elapsed):
        """Return the unknowns and ledger entries at a time that the march has passed."""
        point = self._kept[
            max(0, bisect.bisect_right(self._kept, elapsed, key=lambda point: point.y[CLOCK]) - 1)
        ]
        following = self._next(point)
        while following.y[CLOCK] <= elapsed:
            point, following = following, self._next(following)
        if point.y[CLOCK] == elapsed:
            return point.y
        if self.mode != SLIDING:
            return self._part(point, elapsed - point.y[CLOCK])
        # time is an unknown: Newton's method for the part of the step that ends at it, within what
        # is known to hold it
        low, high = 0.0, following.last
        part = high * (elapsed - point.y[CLOCK]) / (following.y[CLOCK] - point.y[CLOCK])
        for _ in range(TRIALS):
            y = self._part(point, part)
            late = y[CLOCK] - elapsed
            if late > 0.0:
                high = part
            else:
                low = part
            pace = hypot(*y[U:P])
            better = part - late / pace if pace > 0.0 else low
            better = better if low <= better <= high else 0.5 * (low + high)
            if abs(better - part) <= 1e-16 * high:
                break
            part = better
        return y

    def _keep(self):
        if self._count % self._stride == 0:
            self._kept.append(self._front)
            if len(self._kept) == KEPT:
                self._kept, self._stride = self._kept[::2], 2 * self._stride

    def _part(self, point, h):
        y, lost = point.y, point.lost
        kernels = self._bound.kernels
        return kernels.step(self._p, y, lost, kernels.rate(self._p, y), h)[0]

    def _next(self, point):
        """Return the point after one accepted step."""
        y, lost, scales, h, _ = point
        kernels, p = self._bound.kernels, self._p
        first = kernels.rate(p, y)
        for _ in range(TRIALS):
            after, lost_after, scales_after, error = kernels.trial(
                p, self._bound.weights, y, lost, first, h, scales)
            allowed = self._tolerance * (after[CLOCK] - y[CLOCK]) + FLOOR
            factor = SHRINK
            if error < math.inf:
                factor = SAFETY * power(
                    allowed / max(error, 1e-9 * allowed), 1.0 / self._bound.order
                )
                factor = min(GROWTH, max(SHRINK, factor))
            if error <= allowed:
                q, lost_q = unit(*after[Q:U], *lost_after[Q:U])
                return Point((*q, *after[U:]), (*lost_q, *lost_after[U:]), scales_after,
                             h * factor, h)
            h *= factor
        time = self._origin + y[CLOCK]
        raise NotConverged(f'a ball on the table: no step is small enough at t = {time!r} s', time)

    def _end(self, point, following):
        """Return the unknowns where the phase ends if it does so within a step, else None."""
        before, after = point.y, following.y
        if self.mode == SLIDING:
            vx, vy, *omega = table_rates.motion(self._p, after)
            slip, c = hypot(*after[U:P]), table_rates.drive(self._p, after)[2]
            speed = hypot(vx, vy) + self._p[table_rates.RADIUS] * hypot3(*omega)
            dead = slip < hypot(*before[U:P]) and slip <= DEAD * max(
                speed, c * (after[CLOCK] - self.begin)
            )
            return (*after[:U], 0.0, 0.0, *after[P:]) if dead else None
        if self.mode == CREEPING:
            return after if any(after[U:P]) else None
        if self.mode == GLIDING or not self._bound.turns_with_body or self._grips(after):
            return None
        low, high = 0.0, following.last
        for _ in range(TRIALS):
            middle = 0.5 * (low + high)
            if self._grips(self._part(point, middle)):
                low = middle
            else:
                high = middle
        return self._part(point, high)

    def _grips(self, y):
        """Return whether friction can hold the lowest point."""
        gx, gy, c = table_rates.drive(self._p, y)
        return hypot(gx, gy) <= c
