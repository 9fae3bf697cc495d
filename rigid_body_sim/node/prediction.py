"""What theory says will be seen next, beside what was seen: the time between two flips of a free body, or two turning points of a pendulum.

Theory here means formulas that share nothing with the simulation: complete elliptic integrals of the state after the last disturbance.
"""

import math

import numpy as np
from scipy.special import ellipkm1

from rigid_body_sim.rotations import rotate_back
from rigid_body_sim.theory import kater_pendulum

IDLE = {}


def between_events(scene, state):
    """Return the name of a repeated event and the time (s) between two of them, or None where theory has no such prediction.

    Parameters
    ----------
    scene : scenes.Scene
    state : State
        Of the undisturbed motion, at any time.
    """
    names = {effect.name for effect in scene.effects}
    if scene.constraint.kind == 'free' and not names - {'gravity'}:
        return _flips(scene, state)
    if scene.constraint.kind == 'hinge' and names == {'gravity'}:
        return _turning_points(scene, state)
    return None


def _flips(scene, state):
    """Time between changes of sign of omega2, 2 K(k)/lambda (Landau and Lifshitz, Mechanics, section 37), I1 < I2 < I3.

    Every second one brings back the same state. Discriminants are sums of like-signed terms, and the modulus is taken by 1 - k^2.
    """
    inertia = scene.body.about_center
    order = np.argsort(inertia.moments)
    I1, I2, I3 = np.array(inertia.moments)[order]
    if not 0.0 < I1 < I2 < I3:
        return None
    w1, w2, w3 = np.array(rotate_back(*inertia.axes, *state.angular_velocity))[order] ** 2
    above_least = I2 * (I2 - I1) * w2 + I3 * (I3 - I1) * w3         # L^2 - 2 E I1
    below_greatest = I1 * (I3 - I1) * w1 + I2 * (I3 - I2) * w2      # 2 E I3 - L^2
    middle = I3 * (I3 - I2) * w3 - I1 * (I2 - I1) * w1              # L^2 - 2 E I2
    around_third, around_first = (I3 - I2) * above_least, (I2 - I1) * below_greatest
    lead, side = (around_third, around_first) if middle > 0.0 else (around_first, around_third)
    complement = (I3 - I1) * abs(middle) / lead
    if not (lead > 0.0 and side > 0.0 and complement > 0.0):
        return None
    return 'flip', 2.0 * ellipkm1(complement) / math.sqrt(lead / (I1 * I2 * I3))


def _turning_points(scene, state):
    """Half the period at the amplitude that the state's energy reaches; None for a pendulum that turns over or stands still."""
    n, body = np.array(scene.constraint.axis), scene.body
    arm = np.subtract(body.center_of_mass, scene.constraint.through)
    across = arm - n * (n @ arm)
    moment = n @ body.about_center.matrix @ n + body.mass * (across @ across)
    down = -np.array(rotate_back(*state.orientation, 0.0, 0.0, 1.0))
    down -= n * (n @ down)
    slope, length = np.linalg.norm(down), np.linalg.norm(across)
    if not slope * length > 0.0:
        return None
    frequency = math.sqrt(body.mass * scene.effect('gravity').g * length * slope / moment)
    # sin(phi/2)^2 without forming phi
    half_sine_squared = np.sum((across / length - down / slope) ** 2) / 4.0
    reach = half_sine_squared + (n @ state.angular_velocity / (2.0 * frequency)) ** 2
    if not 0.0 < reach < 1.0:
        return None
    return 'turning point', kater_pendulum.period(frequency, 2.0 * math.asin(math.sqrt(reach))) / 2.0


class Prediction:
    """Follows one undisturbed motion: its prediction, and what was seen of it.

    Parameters
    ----------
    scene : scenes.Scene
    state : State or None
        At its beginning; None while a wrench is held, when theory has nothing to say.
    """

    def __init__(self, scene, state):
        self._scene, self._state = scene, state
        self._expected = IDLE
        self._last = {}
        self.measured = None

    def note(self, name, time):
        """Note an event."""
        if name in self._last:
            self.measured = name, time - self._last[name]
        self._last[name] = time

    def compared(self):
        """Return what is predicted and what was measured last, as a dict; empty where there is no prediction."""
        if self._expected is IDLE:
            self._expected = between_events(self._scene, self._state) if self._state is not None else None
        if self._expected is None:
            return {}
        name, predicted = self._expected
        found = {'event': name, 'predicted_interval': float(predicted)}
        if self.measured is not None and self.measured[0] == name:
            interval = self.measured[1]
            found |= {'measured_interval': interval, 'relative_difference': float(interval / predicted - 1.0)}
        return found
