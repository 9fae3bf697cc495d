"""What theory says will be seen of an undisturbed motion, beside what was seen.

=================== ============================================= ==================================================================
scene               predicted and measured                        theory
=================== ============================================= ==================================================================
free body           interval between two flips                    asymmetric_top.time_between_flips
free symmetric body rate at which omega goes round the axis       symmetric_top.precession_rate
hinged with gravity interval between two turning points           kater_pendulum.period
heavy symmetric top interval between two turning points           heavy_top.time_between_turning_points
ball on the table   when rolling begins, the speed it rolls at    billiard.sliding_time, billiard.speed_when_rolling
=================== ============================================= ==================================================================

The formulas share nothing with the simulation. They start from the state after the last disturbance.
"""

import math

import numpy as np

from rigid_body_sim.bodies import IDENTITY
from rigid_body_sim.rotations import rotate, rotate_back
from rigid_body_sim.theory import asymmetric_top, billiard, heavy_top, kater_pendulum, symmetric_top


def expectation(scene, state):
    """Return what theory expects of a scene from a state on: Interval, Turning, Rolling, or None where it is silent."""
    names = {effect.name for effect in scene.effects if effect.name != 'strike'}
    if any(effect.name == 'strike' and effect.time > state.time for effect in scene.effects):
        return None
    kind = scene.constraint.kind
    if kind == 'free' and not names - {'gravity'}:
        return _flips(scene, state) or _round_the_axis(scene, state)
    if names == {'gravity'} and kind in ('hinge', 'pivot'):
        return _swing(scene, state) if kind == 'hinge' else _nutation(scene, state)
    if kind == 'table' and names == {'sliding_friction'}:
        return Rolling(scene, state)
    return None


def _comparison(name, predicted, measured, values):
    """Return predicted, measured and their relative difference under their names."""
    values[f'predicted_{name}'] = float(predicted)
    if measured is not None:
        difference = float(measured / predicted - 1.0) if predicted else float(measured)
        values[f'measured_{name}'] = float(measured)
        values['relative_difference'] = max(difference, values.get('relative_difference', 0.0), key=abs)
    return values


class Interval:
    """The time between two events of one name, and as a frequency (rad/s): two intervals are one period."""

    def __init__(self, event, seconds):
        self.event, self._seconds = event, seconds
        self._last = self._measured = None

    def note(self, name, time):
        """Note an event."""
        if name == self.event:
            self._measured = time - self._last if self._last is not None else None
            self._last = time

    def look(self, state):
        """States say nothing new."""

    def compared(self):
        """Return the comparison, a dict."""
        found = _comparison('interval', self._seconds, self._measured, {'event': self.event})
        return _comparison('frequency', math.pi / self._seconds, math.pi / self._measured if self._measured else None, found)


class Turning:
    """The rate (rad/s) at which omega goes round the axis of a free symmetric body, in body axes, between two looks at the state."""

    def __init__(self, rate, components, state):
        self._rate, self._components = rate, components
        self._before, self._first = self._at(state), self._at(state)
        self._turned = 0.0

    def _at(self, state):
        across = self._components(state)
        return state.time, math.atan2(across[1], across[0])

    def note(self, name, time):
        """Events say nothing new."""

    def look(self, state):
        """Add the angle since the last look; how many whole turns it holds is what the predicted rate comes nearest to."""
        now = self._at(state)
        expected = self._rate * (now[0] - self._before[0])
        self._turned += expected + math.remainder(now[1] - self._before[1] - expected, 2.0 * math.pi)
        self._before = now

    def compared(self):
        """Return the comparison, a dict."""
        elapsed = self._before[0] - self._first[0]
        return _comparison('rate', self._rate, self._turned / elapsed if elapsed > 0.0 else None, {'quantity': 'omega round the axis'})


class Rolling:
    """When a ball stops slipping (s after the state it starts from), and the speed it then has."""

    def __init__(self, scene, state):
        body, friction = scene.body, scene.effect('sliding_friction')
        self._start = state.time
        share = body.about_center.moments[0] / (body.mass * body.radius**2)
        slip, ahead = _slip(body.radius, state)
        size = float(np.hypot(*slip))
        slipping = size > 1e-14 * (np.hypot(*state.velocity[:2]) + np.hypot(*ahead))
        grip = friction.mu * friction.g
        self._time = (billiard.sliding_time(size, friction.mu, friction.g, share) if grip else math.inf) if slipping else 0.0
        self._speed = float(np.hypot(*billiard.speed_when_rolling(state.velocity[:2], ahead, share)))
        self._onset = None if slipping else 0.0
        self._rolls_at = None
        self.look(state)

    def note(self, name, time):
        """Note an event."""
        if name == 'rolling began' and self._onset is None:
            self._onset = time - self._start

    def look(self, state):
        """Read the speed once it rolls."""
        if self._onset is not None and state.time >= self._start + self._onset:
            self._rolls_at = float(np.hypot(*state.velocity[:2]))

    def compared(self):
        """Return the comparison, a dict; empty for a ball that never rolls."""
        if not math.isfinite(self._time):
            return {}
        found = _comparison('time', self._time, self._onset, {'event': 'rolling began'})
        return _comparison('speed', self._speed, self._rolls_at, found)


def _slip(radius, state):
    """Return the velocity of the lowest point, and a omega as a forward velocity: both in the plane, m/s."""
    wx, wy, _ = rotate(*state.orientation, *state.angular_velocity)
    ahead = radius * np.array([wy, -wx])
    return state.velocity[:2] - ahead, ahead


def _in_order(inertia, state):
    """Return the moments in rising order and omega along their axes."""
    order = np.argsort(inertia.moments)
    return np.array(inertia.moments)[order], np.array(rotate_back(*inertia.axes, *state.angular_velocity))[order]


def _flips(scene, state):
    seconds = asymmetric_top.time_between_flips(*_in_order(scene.body.about_center, state))
    return Interval('flip', seconds) if seconds else None


def _round_the_axis(scene, state):
    inertia = scene.body.about_center
    for axis in range(3):
        first, second = (axis + 1) % 3, (axis + 2) % 3
        I1, I3 = inertia.moments[first], inertia.moments[axis]
        if inertia.moments[second] == I1 and I1 != I3:
            omega = rotate_back(*inertia.axes, *state.angular_velocity)
            rate = symmetric_top.precession_rate(omega[axis], I1, I3)

            def across(state):
                omega = rotate_back(*inertia.axes, *state.angular_velocity)
                return omega[first], omega[second]    # noqa: B023  (the loop ends here)

            return Turning(float(rate), across, state) if rate and any(across(state)) else None
    return None


def _swing(scene, state):
    """Half the period at the amplitude that the state's energy reaches; None for a pendulum that turns over or stands still."""
    n, body = np.array(scene.constraint.axis), scene.body
    arm = np.subtract(body.center_of_mass, scene.constraint.through)
    across = arm - n * (n @ arm)
    moment = n @ body.about_center.matrix @ n + body.mass * (across @ across)
    down = -np.array(rotate_back(*state.orientation, 0.0, 0.0, 1.0))
    down -= n * (n @ down)
    slope, length = np.linalg.norm(down), np.linalg.norm(across)
    if not slope * length * scene.effect('gravity').g > 0.0:
        return None
    frequency = math.sqrt(body.mass * scene.effect('gravity').g * length * slope / moment)
    # sin(phi/2)^2 without forming phi
    half_sine_squared = np.sum((across / length - down / slope) ** 2) / 4.0
    reach = half_sine_squared + (n @ state.angular_velocity / (2.0 * frequency)) ** 2
    if not 0.0 < reach < 1.0:
        return None
    return Interval('turning point', kater_pendulum.period(frequency, 2.0 * math.asin(math.sqrt(reach))) / 2.0)


def _nutation(scene, state):
    """Half the period of the nutation of a top whose axis of symmetry is body axis 3."""
    body = scene.body
    I1, I2, I3 = body.about_origin.moments
    x, y, length = body.center_of_mass
    if I1 != I2 or x or y or body.about_origin.axes != IDENTITY:
        return None
    up = rotate_back(*state.orientation, 0.0, 0.0, 1.0)
    seconds = heavy_top.time_between_turning_points(state.angular_velocity, up, I1, I3, body.mass * scene.effect('gravity').g * length)
    return Interval('turning point', seconds) if seconds else None


class Prediction:
    """Follows one undisturbed motion: its prediction, and what was seen of it.

    Parameters
    ----------
    scene : scenes.Scene
    state : State or None
        At its beginning; None while a wrench is held, when theory has nothing to say.
    """

    def __init__(self, scene, state):
        self._expected = expectation(scene, state) if state is not None else None

    def note(self, name, time):
        """Note an event and its time, s."""
        if self._expected:
            self._expected.note(name, time)

    def look(self, state):
        """Look at a later state."""
        if self._expected:
            self._expected.look(state)

    def compared(self):
        """Return what is predicted and what was measured last, as a dict; empty where there is no prediction."""
        return self._expected.compared() if self._expected else {}
