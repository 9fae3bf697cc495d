# SPDX-License-Identifier: Apache-2.0
"""The departure of a free body with internal dissipation from rotation about a principal axis.

As long as the other two components of omega are so small that their products are rounding, they
obey linear equations, whose solution holds at 1e-300 as well as at 1e-9 (i, j, k cyclic, k the
axis):

    omega_i' = a omega_j - g_i omega_i,    a = (I_j - I_k) omega_k/I_i
    omega_j' = b omega_i - g_j omega_j,    b = (I_k - I_i) omega_k/I_j
    g_i = c I_k omega_k^2 (I_k - I_i)/I_i, and the same of j

With m = -(g_i + g_j)/2, d = (g_j - g_i)/2 and s = d^2 + a b, both are sums of e^(r t) with
r = m + sqrt(s) and m - sqrt(s); where s < 0 they turn with sqrt(-s) and change as e^(m t).

The momentum is constant in the world, so the attitude is a turn about it by omega_k t and a small
tilt of the axis against it. A march takes over when the two components are no longer so small.
Near an axis that attracts they stay small, and no march is needed: a march ends when it has come
near that axis, and the turning after that costs nothing, however fast and long.
"""

import math

import numpy as np

from rigid_body_sim.integrators.marching.course import NO_STEP
from rigid_body_sim.mechanics.bounds import relaxation
from rigid_body_sim.numerics.functions import cos, exp, hypot, hypot3, log, sin
from rigid_body_sim.numerics.rotations import multiply, normalised, rotate, rotate_back
from rigid_body_sim.numerics.vectors import cross, minus, plus, scaled
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.state import (
    ANGULAR_VELOCITY,
    ORIENTATION,
    POSITION,
    STATE,
    TIME,
    VELOCITY,
)

NEAR = 1e-9      # other components over omega: their products are below half an ulp
FOLDS = 20.0     # e-folds until the other components of omega are that small
HALVES = 350.0   # half of the largest exponent that exp takes


def applies(scene, wrench):
    """Return whether internal dissipation is all that acts on a scene's body."""
    acting = [effect for effect in scene.effects if effect.acting is not None]
    return (not wrench and scene.constraint.mechanism is Mechanism.FREE
            and len(acting) == 1 and acting[0].inner_dissipation != 0.0)


def arrival(scene, vector):
    """Return the Departure of a state that has arrived near an axis that attracts, or None."""
    found = departure(scene, vector, least=-1.0)
    return found if found is not None and found.end == math.inf else None


def relaxing(scene, vector):
    """Return the time (s) in which dissipation takes the body from a state to its last axis.

    It is approximate, and infinite where there is no such axis.
    """
    frame = scene.frame
    omega = rotate_back(*frame.axes, *STATE.load(vector.tolist()).angular_velocity)
    L = hypot3(*(I * w for I, w in zip(frame.moments, omega, strict=True)))
    rate = relaxation(scene, L)
    return FOLDS / rate if rate > 0.0 else math.inf


def departure(scene, vector, least=0.0):
    """Return the Departure of a state (14 doubles), or None if it is not near an axis.

    A state whose other two components of omega are not above `least` (rad/s) has none.
    """
    frame = scene.frame
    omega = rotate_back(*frame.axes, *STATE.load(vector.tolist()).angular_velocity)
    k = max(range(3), key=lambda axis: abs(omega[axis]))
    small = hypot(omega[k - 2], omega[k - 1])
    if not least < small < NEAR * abs(omega[k]) or min(frame.moments) <= 0.0:
        return None
    found = Departure(scene, frame, vector, omega, k)
    return found if found.end > float(vector[TIME]) else None


class Departure:
    """The motion near an axis, from a state on.

    Attributes
    ----------
    begin : float
        The time of the state, s.
    end : float
        The time until which it holds, s; infinite near an axis that attracts.
    """

    def __init__(self, scene, frame, vector, omega, k):
        i, j = (k + 1) % 3, (k + 2) % 3
        moments, spin = frame.moments, omega[k]
        self._places, self._spin, self._frame = (i, j, k), spin, frame
        self._moments, self._small = moments, (omega[i], omega[j])
        c = scene.inner_dissipation * moments[k] * spin * spin
        Ii, Ij, Ik = moments[i], moments[j], moments[k]
        fall_i, fall_j = c * ((Ik - Ii) / Ii), c * ((Ik - Ij) / Ij)
        self._mean, self._half = -0.5 * (fall_i + fall_j), 0.5 * (fall_j - fall_i)
        self._a, self._b = (Ij - Ik) / Ii * spin, (Ik - Ii) / Ij * spin
        self._square = self._half * self._half + self._a * self._b
        root = math.sqrt(max(self._square, 0.0))
        # the exponents, the smaller one without the difference of the other two
        larger = self._mean + math.copysign(root, self._mean)
        product = fall_i * fall_j - self._a * self._b
        self._up, self._down = larger, (product / larger if larger != 0.0 else 0.0)
        if self._mean < 0.0:
            self._up, self._down = self._down, self._up
        state = STATE.load(vector.tolist())
        self.begin = state.time
        q, point = multiply(*state.orientation, *frame.axes), frame.from_body(frame.point)
        self._point, carried = point, rotate(*q, *cross(omega, point))
        self._place = plus(state.position, rotate(*q, *point))
        self._drift = plus(state.velocity, carried)
        x, y, z, w = self._tilt(*self._small)
        self._about_momentum = multiply(*q, -x, -y, -z, w)
        # |omega_i, omega_j| is not above this times e^(growth t)
        largest = max(abs(self._half), abs(self._a), abs(self._b))
        size = hypot(*self._small)
        size *= 1.0 + 2.0 * largest / (math.sqrt(abs(self._square)) or abs(spin))
        growth = self._up if self._square > 0.0 else self._mean
        self.end = math.inf
        if growth > 0.0:
            room = log(NEAR * abs(spin)) - log(size) if size > 0.0 else math.inf
            self.end = self.begin + max(room, 0.0) / growth

    def _tilt(self, small_i, small_j):
        """Return the turn from the body to axes whose k is along the momentum."""
        i, j, k = self._places
        along = self._moments[k] * self._spin
        turn = [0.0, 0.0, 0.0, 1.0]
        turn[i] = 0.5 * (self._moments[j] * small_j / along)
        turn[j] = -0.5 * (self._moments[i] * small_i / along)
        return tuple(turn)

    def _components(self, time):
        """Return omega_i and omega_j a time after the start."""
        x, y = self._small
        root = math.sqrt(abs(self._square))
        if self._square > 0.0:
            grown = tuple(0.5 * (value + (half * self._half + other * across) / root)
                          for value, half, other, across in
                          ((x, x, y, self._a), (y, -y, x, self._b)))
            rest = x - grown[0], y - grown[1]
            return tuple(_times_exp(one, self._up * time) + _times_exp(other, self._down * time)
                         for one, other in zip(grown, rest, strict=True))
        phase = root * time
        share, turn = cos(phase), sin(phase) / root if root > 0.0 else time
        return (_times_exp(x * share + (x * self._half + y * self._a) * turn, self._mean * time),
                _times_exp(y * share + (x * self._b - y * self._half) * turn, self._mean * time))

    def state(self, time, out):
        """Fill out, shape (14,), with the state at a time before the end."""
        elapsed = time - self.begin
        i, j, k = self._places
        small = self._components(elapsed)
        omega = [0.0, 0.0, 0.0]
        omega[i], omega[j], omega[k] = *small, self._spin
        half = 0.5 * self._spin * elapsed
        turn = [0.0, 0.0, 0.0, cos(half)]
        turn[k] = sin(half)
        q = normalised(*multiply(*multiply(*self._about_momentum, *turn), *self._tilt(*small)))
        ax, ay, az, aw = self._frame.axes
        place = plus(self._place, scaled(elapsed, self._drift))
        out[TIME] = time
        out[ORIENTATION] = multiply(*q, -ax, -ay, -az, aw)
        out[ANGULAR_VELOCITY] = rotate(ax, ay, az, aw, *omega)
        out[POSITION] = minus(place, rotate(*q, *self._point))
        out[VELOCITY] = minus(self._drift, rotate(*q, *cross(tuple(omega), self._point)))


def _times_exp(value, exponent):
    """Return value e^exponent, also where the power alone is beyond doubles."""
    if exponent > HALVES:
        return value * exp(HALVES) * exp(min(exponent - HALVES, 700.0))
    return value * exp(max(exponent, -700.0)) if exponent > -700.0 else 0.0


class Departing:
    """A course that begins with a Departure and goes on with a march.

    Parameters
    ----------
    near : Departure
    march_from : callable
        From a state (14 doubles) to the course of the march.
    """

    TELLS_EVENTS = False

    def __init__(self, near, march_from):
        self._near, self._march_from, self._march = near, march_from, None

    def kinks(self, until):
        """Return the times of kinks: none."""
        return []

    def _later(self):
        if self._march is None:
            start = np.empty(STATE.size)
            self._near.state(self._near.end, start)
            self._march = self._march_from(start)
        return self._march

    def entries_until(self, time):
        """Return the part of a time (s) in which dissipation still takes energy from the body."""
        if self._near.end == math.inf:    # the square of what is NEAR
            return self._near.begin
        return time if time < self._near.end else self._later().entries_until(time)

    def step_at(self, time):
        """Return when the step that holds a time (s) begins and ends, s."""
        end = self._near.end
        return (-math.inf, end) if time < end else self._later().step_at(time)

    def state(self, time, out):
        """Fill `out` with the state at a time (s) not before the start."""
        if time < self._near.end:
            self._near.state(time, out)
        else:
            self._later().state(time, out)

    def states(self, times, out):
        """Fill the rows of `out` with the states at times (s) not before the start."""
        early = times < self._near.end
        for row in np.flatnonzero(early):
            self._near.state(float(times[row]), out[row])
        late = np.flatnonzero(~early)
        if len(late):
            part = np.empty((len(late), STATE.size))
            self._later().states(times[late], part)
            out[late] = part


class Arriving:
    """A course that goes on without steps once the body turns about the axis that attracts.

    It checks for the arrival at fixed times, each twice the one before, so the result does not
    depend on the times that are asked for.

    Parameters
    ----------
    scene : Scene
    march : object
        The course that marches.
    vector : array (14,)
        The start.
    """

    TELLS_EVENTS = False

    def __init__(self, scene, march, vector):
        self._scene, self._march, self._rest = scene, march, None
        self._begin, self._ahead = float(vector[TIME]), relaxing(scene, vector)

    @property
    def _look(self):
        return self._begin + self._ahead

    def entries_until(self, time):
        """Return the part of a time (s) in which dissipation still takes energy from the body."""
        self._reach(time)
        return time if self._rest is None else min(time, self._look)

    def _reach(self, time):
        """Look for the arrival at all the fixed times up to one."""
        while self._rest is None and self._look <= time:
            vector = np.empty(STATE.size)
            self._march.state(self._look, vector)
            self._rest = arrival(self._scene, vector)
            if self._rest is None:
                self._ahead *= 2.0

    def kinks(self, until):
        """Return the times of kinks: none."""
        return []

    def step_at(self, time):
        """Return when the step that holds a time (s) begins and ends, s."""
        self._reach(time)
        rests = self._rest is not None and time >= self._look
        return NO_STEP if rests else self._march.step_at(time)

    def state(self, time, out):
        """Fill `out` with the state at a time (s) not before the start."""
        self._reach(time)
        course = self._march if time < self._look or self._rest is None else self._rest
        course.state(time, out)

    def states(self, times, out):
        """Fill the rows of `out` with the states at times (s) not before the start."""
        self._reach(float(times.max()))
        late = times >= self._look if self._rest is not None else np.zeros(len(times), bool)
        for row in np.flatnonzero(late):
            self._rest.state(float(times[row]), out[row])
        early = np.flatnonzero(~late)
        if len(early):
            part = np.empty((len(early), STATE.size))
            self._march.states(times[early], part)
            out[early] = part
