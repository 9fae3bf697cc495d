# SPDX-License-Identifier: Apache-2.0
"""Expectations of theory for a motion, compared with what its events or its states show.

Each has ``note(name, time)`` for events, ``look(state)`` for later states, and ``compared()``,
which returns predicted and measured values and their relative difference as a dict.
"""

import math

import numpy as np

from rigid_body_sim.numerics.rotations import rotate, rotate_back
from rigid_body_sim.theory import billiard, euler_equations, largest_axis


def _comparison(name, predicted, measured, values):
    """Return predicted, measured and their relative difference under their names."""
    values[f'predicted_{name}'] = float(predicted)
    if measured is not None:
        difference = float(measured / predicted - 1.0) if predicted else float(measured)
        values[f'measured_{name}'] = float(measured)
        values['relative_difference'] = max(
            difference, values.get('relative_difference', 0.0), key=abs)
    return values


class Interval:
    """The time between two events of one name (s), also as a frequency (rad/s).

    Two intervals make one period.
    """

    def __init__(self, event, seconds):
        self.event, self._seconds = event, seconds
        self._last = self._measured = None

    def note(self, name, time):
        """Note an event."""
        if name == self.event:
            self._measured = time - self._last if self._last is not None else None
            self._last = time

    def look(self, state):
        """Do nothing: states add nothing."""

    def compared(self):
        """Return the comparison, a dict."""
        found = _comparison('interval', self._seconds, self._measured, {'event': self.event})
        return _comparison('frequency', math.pi / self._seconds,
                           math.pi / self._measured if self._measured else None, found)


class Turning:
    """The mean rate (rad/s) at which omega turns about the axis of a symmetric body.

    It is the rate in body axes since the first look at the state.

    Parameters
    ----------
    angle : callable
        Takes the seconds since the first state and returns the predicted angle, rad.
    components : callable
        Takes a state and returns the two components of omega across the axis.
    """

    def __init__(self, angle, components, state):
        self._angle, self._components = angle, components
        self._began, (self._elapsed, self._seen) = state.time, (0.0, self._direction(state))
        self._turned = 0.0

    def _direction(self, state):
        first, second = self._components(state)
        return math.atan2(second, first)

    def note(self, name, time):
        """Do nothing: events add nothing."""

    def look(self, state):
        """Add the angle since the last look; its whole turns are those nearest to theory."""
        elapsed, seen = state.time - self._began, self._direction(state)
        expected = self._angle(elapsed) - self._angle(self._elapsed)
        self._turned += expected + math.remainder(seen - self._seen - expected, 2.0 * math.pi)
        self._elapsed, self._seen = elapsed, seen

    def compared(self):
        """Return the comparison, a dict."""
        # before the first look the rate is that of the next second
        seconds = self._elapsed or 1.0
        measured = self._turned / seconds if self._elapsed else None
        return _comparison('rate', self._angle(seconds) / seconds, measured,
                           {'quantity': 'omega round the axis'})


class Relaxing:
    """The energy (J) at which dissipation ends; it is measured once it stops falling."""

    def __init__(self, scene, state):
        self._inertia = scene.body.about_center
        self._least = largest_axis.least_energy(
            self._inertia.moments, np.linalg.norm(self._momentum(state)))
        self._energy, self._settled = None, None

    def _momentum(self, state):
        return np.array(self._inertia.moments) * rotate_back(
            *self._inertia.axes, *state.angular_velocity)

    def note(self, name, time):
        """Do nothing: events add nothing."""

    def look(self, state):
        """Take the energy, and find whether it has settled between two looks.

        It has settled when it falls by less than 1e-9 of itself and the wobble has died out.
        """
        energy = float(euler_equations.kinetic_energy(
            self._inertia.moments, rotate_back(*self._inertia.axes, *state.angular_velocity)))
        across = np.delete(self._momentum(state), np.argmax(self._inertia.moments))
        still = (self._energy is not None and abs(energy - self._energy) < 1e-9 * energy
                 and np.linalg.norm(across)
                 < 1e-3 * math.sqrt(2.0 * energy * max(self._inertia.moments)))
        self._energy, self._settled = energy, energy if still else None

    def compared(self):
        """Return the comparison, a dict."""
        return _comparison('energy', self._least, self._settled,
                           {'quantity': 'least energy at this angular momentum'})


class Steady:
    """A constant rate (rad/s) about a hinge."""

    def __init__(self, rate, axis):
        self._rate, self._axis, self._seen = rate, np.array(axis), None

    def note(self, name, time):
        """Do nothing: events add nothing."""

    def look(self, state):
        """Read the rate."""
        self._seen = float(self._axis @ state.angular_velocity)

    def compared(self):
        """Return the comparison, a dict."""
        return _comparison('rate', self._rate, self._seen, {'quantity': 'rate after the blow'})


class Rolling:
    """The time when a ball stops slipping (s after its first state), and its speed then (m/s)."""

    def __init__(self, scene, state):
        body, friction = scene.body, scene.contact
        self._start = state.time
        share = body.about_center.moments[0] / (body.mass * body.radius**2)
        slip, ahead = _slip(body.radius, state)
        size = float(np.hypot(*slip))
        slipping = size > 1e-14 * (np.hypot(*state.velocity[:2]) + np.hypot(*ahead))
        grip = friction.mu * friction.g
        self._time = ((billiard.sliding_time(size, friction.mu, friction.g, share)
                       if grip else math.inf) if slipping else 0.0)
        self._speed = float(np.hypot(
            *billiard.speed_when_rolling(state.velocity[:2], ahead, share)))
        self._onset = None if slipping else 0.0
        self._rolls_at = None
        self.look(state)

    def note(self, name, time):
        """Note an event."""
        if name == 'rolling began' and self._onset is None:
            self._onset = time - self._start

    def look(self, state):
        """Read the speed once the ball rolls."""
        if self._onset is not None and state.time >= self._start + self._onset:
            self._rolls_at = float(np.hypot(*state.velocity[:2]))

    def compared(self):
        """Return the comparison, a dict; it is empty for a ball that never rolls."""
        if not math.isfinite(self._time):
            return {}
        found = _comparison('time', self._time, self._onset, {'event': 'rolling began'})
        return _comparison('speed', self._speed, self._rolls_at, found)


def _slip(radius, state):
    """Return the slip of the lowest point and the forward velocity of rolling, in the plane."""
    wx, wy, _ = rotate(*state.orientation, *state.angular_velocity)
    ahead = radius * np.array([wy, -wx])
    return state.velocity[:2] - ahead, ahead
