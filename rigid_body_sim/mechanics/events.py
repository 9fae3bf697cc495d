# SPDX-License-Identifier: Apache-2.0
"""Events of scenes that are followed step by step.

They are zero crossings of a watched quantity, bracketed and refined on the solver itself.

Motions in closed form know the times of their events (their kernel `next_event`); these are the
same events for all other solvers.
"""

import math
from dataclasses import dataclass

import numpy as np

from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.root import root
from rigid_body_sim.numerics.rotations import rotate, rotate_back
from rigid_body_sim.numerics.vectors import dot
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.state import ANGULAR_VELOCITY, ORIENTATION, STATE_SIZE

RADIANS_BETWEEN_LOOKS = 0.2
RADIANS_BLIND = 3.0
BLINK = 0.0625    # s
SHARE_OF_STEP = 0.25    # of the method, between two looks
MOST_LOOKS = 2 ** 22
FLIP, TURNING_POINT = 'flip', 'turning point'
WATCHED = FLIP, TURNING_POINT
"""Names of the events that `watches` decides on, whatever solves a scene."""
LOOKS_A_TICK = 20000    # at most


@dataclass(frozen=True)
class Watch:
    """A quantity whose changes of sign are events.

    Attributes
    ----------
    name : str
        Name of the event.
    value : callable
        State vector -> float, relative to its natural size.
    share : float
        Hysteresis: a change of sign counts if the value has been at least this large since the one
        before.
    largest : callable
        State vector -> float: how large the value becomes from there if nothing but the free
        motion acts; stands for the past of a start.
    """

    name: str
    value: object
    share: float
    largest: object


def watches(scene):
    """Return the quantities that are watched in a scene.

    Free body with three different moments: `flip`, the momentum along the middle axis changes its
    sign. Pivot: `turning point`, the height of the third body axis turns (nutation). Hinge:
    `turning point`, the rate changes its sign.
    """
    mechanism, body = scene.constraint.mechanism, scene.body
    if mechanism is Mechanism.FREE and len(set(body.about_center.moments)) == 3:
        return (Watch(FLIP, *_momentum_along_middle_axis(body.about_center)),)
    if mechanism is Mechanism.POINT:
        return (Watch(TURNING_POINT, _rise_of_third_axis, 1e-9, _rise_of_third_axis),)
    if mechanism is Mechanism.AXIS:
        rate = _rate_about(scene.constraint.axis)
        return (Watch(TURNING_POINT, rate, 0.0, rate),)
    return ()


def _momentum_along_middle_axis(inertia):
    """Return value, share and largest of the Watch for flips.

    The value is the share of the momentum that lies along the middle axis.
    """
    order = np.argsort(inertia.moments)

    def components(vector):
        omega = rotate_back(*inertia.axes, *vector[ANGULAR_VELOCITY])
        return [(float(inertia.moments[k]), omega[k]) for k in order]

    def share(vector):
        m = [I * w for I, w in components(vector)]
        size = hypot3(*m)
        return m[1] / size if size > 0.0 else 0.0

    def largest(vector):
        # where the motion crosses the plane of omega1 = 0 or omega3 = 0, whichever comes first, by
        # the constancy of E and L^2
        (I1, w1), (I2, w2), (I3, w3) = components(vector)
        size = hypot3(I1 * w1, I2 * w2, I3 * w3)
        by_first = w2 * w2 + I1 * (I3 - I1) / (I2 * (I3 - I2)) * w1 * w1
        by_third = w2 * w2 + I3 * (I3 - I1) / (I2 * (I2 - I1)) * w3 * w3
        return I2 * math.sqrt(min(by_first, by_third)) / size if size > 0.0 else 0.0

    return share, 0.5, largest


def _rise_of_third_axis(vector):
    """Return the rate at which the height of body axis 3 grows, over |omega|."""
    wx, wy, wz = vector[ANGULAR_VELOCITY]
    size = hypot3(wx, wy, wz)
    return rotate(*vector[ORIENTATION], wy, -wx, 0.0)[2] / size if size > 0.0 else 0.0


def _rate_about(axis):
    def rate(vector):
        return dot(axis, vector[ANGULAR_VELOCITY])

    return rate


class Watcher:
    """Finds the events of one solver, going forward in time.

    Parameters
    ----------
    solver : object
        With `state(time, out)`.
    watched : sequence of Watch
    start : float
        Time of the solver's start, s.
    swing : float
        Rate that potentials may add, rad/s (mechanics/bounds.py), since a body at rest may soon
        move.
    drive : float
        Rate that drives may add in a second, rad/s^2 (mechanics/bounds.py).
    step_at : callable, optional
        Where these bounds may be exceeded: when the step of the method that holds a time begins
        and ends, s. Looks are then at most BLINK and a share of a step apart: what nothing bounds
        may turn a body back and forth at any rate, and the steps follow it.
    """

    def __init__(self, solver, watched, start, swing, drive, step_at=None):
        self._swing, self._drive, self._step_at = swing, drive, step_at
        self._longest = math.inf if step_at is None else BLINK
        self._solver, self._watched = solver, watched
        self._vector = np.empty(STATE_SIZE)
        self._time = start
        self._values = self._look(start)
        self._strong = [
            abs(watch.largest(self._vector.tolist())) >= watch.share for watch in watched
        ]

    def _look(self, time):
        self._solver.state(time, self._vector)
        vector = self._vector.tolist()
        # the time s in which rate s + drive s^2/2 is that angle
        rate = hypot3(*vector[ANGULAR_VELOCITY]) + self._swing
        self._spacing = min(self._longest, 2.0 * RADIANS_BETWEEN_LOOKS / max(
            rate + math.sqrt(rate * rate + 2.0 * RADIANS_BETWEEN_LOOKS * self._drive), 1e-300))
        return [watch.value(vector) for watch in self._watched]

    def events(self, until, tick=0.0):
        """Return the (time, name, values) of the events since the last call, in order.

        None is later than `until`.

        Parameters
        ----------
        until, tick : float
            s; there are at most LOOKS_A_TICK looks in a tick, and MOST_LOOKS in all. Of a body
            that turns over half a turn between two looks, events are passed over.
        """
        found = []
        least = max(tick / LOOKS_A_TICK, (until - self._time) / MOST_LOOKS, 4.0 * math.ulp(until))
        while self._watched and self._time < until:
            # between two looks the body turns so far that changes of sign are missed
            blind = RADIANS_BLIND * self._spacing < least * RADIANS_BETWEEN_LOOKS
            spacing = self._spacing
            if self._step_at is not None and not blind:
                begin, end = self._step_at(self._time)
                spacing = min(spacing, SHARE_OF_STEP * (end - begin))
            time = min(until, self._time + max(spacing, 32.0 * least if blind else least))
            values = self._look(time)
            if blind:
                self._time, self._values = time, values
                self._strong = [abs(value) >= watch.share
                                for watch, value in zip(self._watched, values, strict=True)]
                continue
            for k, (watch, before, after) in enumerate(
                zip(self._watched, self._values, values, strict=True)
            ):
                if (before < 0.0) != (after < 0.0):
                    if self._strong[k]:
                        found.append((self._crossing(watch, self._time, time), watch.name, {}))
                    self._strong[k] = False
                self._strong[k] = self._strong[k] or abs(after) >= watch.share
            self._time, self._values = time, values
        return sorted(found)

    def _crossing(self, watch, begin, end):
        def value(time):
            self._solver.state(time, self._vector)
            return watch.value(self._vector.tolist())

        if value(begin) == 0.0:
            return begin
        return root(value, begin, end, 4e-16 * max(abs(end), 1e-300), 8.9e-16)
