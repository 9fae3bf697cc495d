# SPDX-License-Identifier: Apache-2.0
"""The growth of deviations that are too small for any control of steps to see.

A body that stands upright, or turns about an axis from which heat takes it, leaves that state as
e^(r t) from however small a deviation. A control of steps measures errors against the motion, so
that it sees no deviation as long as it is small, and lets steps become long beside 1/r. Through
such a step no method follows e^(r t): an explicit one makes a polynomial of it, an implicit one a
fraction that is near 1, with which the body stays where it is for ever. So a march from such a
state goes in stretches of SHARE/r, until it can be seen that the body leaves.

r is the largest real part of the eigenvalues of the Jacobian of

    turn' = omega + u - omega x turn,    omega',    place' = velocity,    velocity'

by differences at the state (turn: a small rotation, body axes; u: the extra rate by internal
dissipation; place and velocity of a body that nothing holds).
"""

import bisect
import math

import numpy as np

from rigid_body_sim.integrators.marching.course import fill
from rigid_body_sim.mechanics.balance import Dynamics
from rigid_body_sim.mechanics.bounds import falling, pushed_unbounded, relaxation, swing_rate
from rigid_body_sim.mechanics.parameters import scene_parameters
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.growth import fastest_growth
from rigid_body_sim.numerics.rotations import multiply, rotate
from rigid_body_sim.numerics.vectors import cross, dot, minus, scaled
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.scene import kept
from rigid_body_sim.scene.state import (
    ANGULAR_VELOCITY,
    ORIENTATION,
    POSITION,
    STATE_SIZE,
    TIME,
    VELOCITY,
)

SHARE = 0.1       # of 1/r, the length of a stretch: order 8 errs by 3e-15 in it
UNSEEN = 1e-3     # share of r max(|omega|, r): a smaller omega' shows no leaving yet
SEEN = 0.1        # a larger one does
STILL = 1e-3      # share of the bound of r: what turns faster about a hinge leaves nothing
SLOWEST = 1e-3    # share of the bound of r: a slower growth is not looked for
LEAN = 0.1        # rad, in which what turns on and stands is to stand
LOOKS = 32        # stretches between two looks at the Jacobian
MOST = 2 ** 14    # stretches, more than doubles can grow in
STEP = 1e-4       # of differences, share of the size of the unknown
KEPT = 16         # marches that stay in memory; others are made anew when asked for
UNBOUNDED = 1.0   # rad/s, where the bound of r is not known
TURN, OMEGA, PLACE = range(3)    # the unknowns whose rates are looked at; then the velocity


@kept
def slowest(scene):
    """Return a rate (rad/s): in a body that turns faster nothing grows faster than it turns."""
    if scene.inner_dissipation > 0.0 or pushed_unbounded(scene):
        return math.inf
    swing = swing_rate(scene)
    return swing if scene.constraint.axis is None else STILL * swing


class Unstable:
    """What may let a deviation grow faster than the body turns, in a scene.

    Parameters
    ----------
    scene : Scene
    """

    def __init__(self, scene):
        self._still = swing_rate(scene)
        fall = falling(scene)
        self._open = pushed_unbounded(scene) or fall == math.inf
        self._still += fall if fall < math.inf else 0.0
        self._largest = max(scene.constraint.inertia(scene.body).moments)
        self._heat = relaxation(scene, self._largest)
        self._hinge = scene.constraint.axis
        self._held = scene_parameters(scene).through
        self._moves = scene.constraint.mechanism is Mechanism.FREE
        self._slow = slowest(scene)
        self._dynamics = Dynamics(scene)

    def _bound(self, speed):
        """Return a bound of r for a body that turns with a speed (rad/s)."""
        known = self._still + self._heat * speed * speed
        return known + (UNBOUNDED + speed) if self._open else known

    def may_grow(self, speed):
        """Return whether a deviation may grow faster than a body turns, at rates (rad/s)."""
        return (speed < self._slow) & (self._open | (speed < self._bound(speed)))

    def unclear(self, speeds, torques):
        """Return which of many bodies take a look at the rates, from |omega| and |torque|, (n,).

        What a torque turns at once, and faster than the body turns, shows that it leaves.
        """
        bound, gyroscopic = self._bound(speeds), self._largest * speeds * speeds
        turned = torques - gyroscopic > UNSEEN * self._largest * bound * (bound + speeds)
        alone = np.full(len(speeds), True) if self._hinge is not None else speeds <= STILL * bound
        return ~(turned & alone)

    def shown(self, vector, wrench):
        """Return how far it shows that the body leaves, from 0 (it stands) to 1."""
        omega = tuple(vector[ANGULAR_VELOCITY].tolist())
        rate = tuple(self._rates(vector, wrench)[OMEGA].tolist())
        speed = hypot3(*omega)
        bound = self._bound(speed)
        turns = self._hinge is None and speed > STILL * bound
        if turns:    # the part along omega changes no direction
            rate = minus(rate, scaled(dot(rate, omega) / (speed * speed), omega))
        size = hypot3(*rate)
        if turns and size < UNSEEN * bound * max(speed, bound):
            size = max(size, self._changed(vector, scaled(LEAN / speed, omega), wrench))
        if size == 0.0 and speed > 0.0 and not turns:
            return STILL * UNSEEN    # it passes the state
        return size / (bound * max(speed, bound)) if size > 0.0 else 0.0

    def _changed(self, vector, turn, wrench):
        """Return by how much omega' changes as the body turns on, rad/s^2."""
        ahead, behind = (
            self._rates(_moved(vector, TURN, sign * np.array(turn), self._held), wrench)[OMEGA]
            for sign in (1.0, -1.0))
        return 0.5 * hypot3(*(ahead - behind).tolist())

    def rate(self, vector, wrench):
        """Return r at a state (14 doubles) where it is the fastest that there is, else 0; 1/s."""
        speed = hypot3(*vector[ANGULAR_VELOCITY].tolist())
        bound = self._bound(speed)
        jacobian = self._jacobian(vector, wrench, max(speed, bound))
        if not np.isfinite(jacobian).all():
            return 0.0
        found = fastest_growth(jacobian)
        least = max(speed, SLOWEST * bound) if self._hinge is None else SLOWEST * bound
        return found if found > least else 0.0

    def _rates(self, vector, wrench):
        """Return Dynamics.rates at a state; not numbers where an expression has no value."""
        try:
            return self._dynamics.rates(vector, wrench)
        except (ArithmeticError, ValueError):
            return np.full((4, 3), math.nan)

    def _jacobian(self, vector, wrench, fastest):
        """Return the Jacobian; of a body on a hinge that along the axis, shape (2, 2)."""
        sizes = [1.0, fastest]
        if self._moves:
            sizes += [1.0 + hypot3(*vector[POSITION].tolist()),
                      1.0 + hypot3(*vector[VELOCITY].tolist())]
        axes = np.eye(3) if self._hinge is None else np.array([self._hinge])
        omega, columns = tuple(vector[ANGULAR_VELOCITY].tolist()), []
        for group, size in enumerate(sizes):
            for axis in axes:
                move = STEP * size * axis
                change = (self._rates(_moved(vector, group, move, self._held), wrench)
                          - self._rates(_moved(vector, group, -move, self._held), wrench))
                rows = change[:len(sizes)] / (2.0 * STEP * size)
                if group == TURN:
                    rows[TURN] -= cross(omega, tuple(axis.tolist()))
                columns.append([dot(tuple(row.tolist()), tuple(axis.tolist())) for row in rows]
                               if self._hinge is not None else rows.ravel())
        return np.array(columns).T


@kept
def unstable(scene):
    """Return the Unstable of a scene."""
    return Unstable(scene)


def _moved(vector, group, move, held):
    """Return a state with its attitude (TURN), OMEGA, PLACE or velocity changed.

    The point `held` (body axes, m) keeps its place and velocity as attitude or omega change.
    """
    out = vector.copy()
    if group not in (TURN, OMEGA):
        out[POSITION if group == PLACE else VELOCITY] += move
        return out
    if group == TURN:
        half = tuple((0.5 * move).tolist())
        turned = multiply(*vector[ORIENTATION].tolist(), *half, math.sqrt(1.0 - dot(half, half)))
        out[ORIENTATION] = turned
    else:
        out[ANGULAR_VELOCITY] += move
    for sign, one in ((1.0, vector), (-1.0, out)):
        q, omega = one[ORIENTATION].tolist(), one[ANGULAR_VELOCITY].tolist()
        out[POSITION] += scaled(sign, rotate(*q, *held))
        out[VELOCITY] += scaled(sign, rotate(*q, *cross(tuple(omega), held)))
    return out


class Growing:
    """A course that goes in stretches until it shows that the body leaves, then in a march.

    Parameters
    ----------
    grows : Unstable
    wrench : effects.wrench.Wrench
        Held all the time.
    vector : array (14,)
        The start.
    rate : float
        r there, 1/s.
    breakpoints : tuple of floats
        Times at which what acts jumps, s; after each it is looked anew.
    march_from : callable
        From a state (14 doubles), and a time (s) at which a step is to end, to a course.
    """

    TELLS_EVENTS = False

    def __init__(self, grows, wrench, vector, rate, breakpoints, march_from):
        self._grows, self._wrench, self._march_from = grows, wrench, march_from
        self._later = [time for time in breakpoints if time > vector[TIME]]
        self._begins, self._ends, self._starts = [], [], []
        self._courses, self._kinks, self._rate = {}, [], rate
        self._enter(vector, 0)

    def _enter(self, vector, count):
        """Begin a stretch at a state, after a count of stretches that it did not show in."""
        begin = float(vector[TIME])
        jump = next((time for time in self._later if time > begin), math.inf)
        if count and count % LOOKS == 0:
            self._rate = self._grows.rate(vector, self._wrench)
        shown = self._grows.shown(vector, self._wrench)
        stands = shown == 0.0
        over = stands or shown > SEEN or self._rate == 0.0 or count >= MOST
        end = jump if over else min(jump, begin + SHARE / self._rate)
        self._begins.append(begin)
        self._starts.append(vector)
        self._ends.append(end if end > begin else jump)
        self._count = 0 if end == jump else count + 1

    def _reach(self, time):
        """Make the stretches until one holds a time (s)."""
        while time >= self._ends[-1]:
            place, end, vector = len(self._ends) - 1, self._ends[-1], np.empty(STATE_SIZE)
            course = self._course(place)
            course.state(end, vector)
            self._kinks += course.kinks(end)
            if self._count == 0:
                self._rate = self._grows.rate(vector, self._wrench)
            self._enter(vector, self._count)

    def _course(self, place):
        """Return the course of a stretch."""
        if place not in self._courses:
            if len(self._courses) == KEPT:
                del self._courses[next(iter(self._courses))]
            self._courses[place] = self._march_from(self._starts[place], self._ends[place])
        return self._courses[place]

    def _place(self, time):
        self._reach(time)
        return bisect.bisect_right(self._begins, time) - 1

    def kinks(self, until):
        """Return the times of kinks before a time (s): those of the marches."""
        last = self._course(self._place(until))
        return [time for time in [*self._kinks, *last.kinks(until)] if time < until]

    def step_at(self, time):
        """Return when the step that holds a time (s) begins and ends, s."""
        place = self._place(time)
        begin, end = self._course(place).step_at(time)
        return begin, min(end, self._ends[place])

    def state(self, time, out):
        """Fill `out` with the state at a time (s) not before the start."""
        self._course(self._place(time)).state(time, out)

    def states(self, times, out):
        """Fill the rows of `out` with the states at times (s) not before the start."""
        self._reach(float(times.max()))
        fill(times, out, self._begins, self._course)
