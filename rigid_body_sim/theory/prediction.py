# SPDX-License-Identifier: Apache-2.0
"""Predictions of theory for an undisturbed motion, with what was measured.

==================== ======================================= =====================================
scene                predicted and measured                  theory
==================== ======================================= =====================================
free body            interval between two flips              asymmetric_top.time_between_flips
free symmetric body  rate of omega about the axis            symmetric_top.precession_rate
same, axial torque   the same, on average                    driven_body.phase
body with heat       least energy, once it is reached        largest_axis.least_energy
hinged with gravity  interval between two turning points     kater_pendulum.period
bat that is hit      rate after the blow                     baseball_bat.angular_acceleration
heavy symmetric top  interval between two turning points     heavy_top.time_between_turning_points
ball on the table    time and speed when rolling begins      billiard.sliding_time and
                                                             billiard.speed_when_rolling
==================== ======================================= =====================================

The formulas share nothing with the simulation. They start from the state after the last
disturbance. The node and the browser view use this module.
"""

import math
import threading

import numpy as np

from rigid_body_sim.numerics.rotations import rotate_back
from rigid_body_sim.scene.bodies import IDENTITY
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.theory import (
    asymmetric_top,
    baseball_bat,
    driven_body,
    heavy_top,
    kater_pendulum,
    symmetric_top,
)
from rigid_body_sim.theory.expectations import Interval, Relaxing, Rolling, Steady, Turning


def expectation(scene, state):
    """Return the expectation of theory for a scene from a state on, or None if it has none.

    The object has ``note``, ``look`` and ``compared`` (expectations.py).
    """
    if any(strike.time > state.time for strike in scene.strikes):
        return None
    mechanism, acting = scene.constraint.mechanism, scene.acting
    if mechanism is Mechanism.FREE and scene.weight is not None:
        return _flips(scene, state) or _round_the_axis(scene, state)
    if mechanism is Mechanism.FREE and all(one.inner_dissipation for one in acting):
        return Relaxing(scene, state)
    if mechanism is Mechanism.FREE:
        return _round_the_axis(scene, state)
    if mechanism is Mechanism.AXIS and not acting and scene.strikes:
        return _after_a_blow(scene, state)
    if mechanism is Mechanism.AXIS and scene.weight:
        return _swing(scene, state)
    if mechanism is Mechanism.POINT and scene.weight:
        return _nutation(scene, state)
    if mechanism is Mechanism.TABLE and acting:
        return Rolling(scene, state)
    return None


def _in_order(inertia, state):
    """Return the moments in rising order and omega along their axes."""
    order = np.argsort(inertia.moments)
    return (np.array(inertia.moments)[order],
            np.array(rotate_back(*inertia.axes, *state.angular_velocity))[order])


def _flips(scene, state):
    seconds = asymmetric_top.time_between_flips(*_in_order(scene.body.about_center, state))
    return Interval('flip', seconds) if seconds else None


def _round_the_axis(scene, state):
    """Return the expected turning of omega about the axis of a body with two equal moments."""
    inertia = scene.body.about_center
    I = inertia.moments
    axes = [axis for axis in range(3) if I[(axis + 1) % 3] == I[(axis + 2) % 3] != I[axis]]
    if not axes:
        return None
    [axis] = axes
    I1, I3, torque = I[(axis + 1) % 3], I[axis], _axial_torque(scene, inertia, axis)
    spin = float(rotate_back(*inertia.axes, *state.angular_velocity)[axis])

    def across(state):
        omega = rotate_back(*inertia.axes, *state.angular_velocity)
        return omega[(axis + 1) % 3], omega[(axis + 2) % 3]

    if torque is None or not (spin or torque) or not any(across(state)):
        return None
    return Turning(
        lambda time: float(driven_body.phase(time, spin, torque, I1, I3) if torque
                           else symmetric_top.precession_rate(spin, I1, I3) * time),
        across, state)


def _axial_torque(scene, inertia, axis):
    """Return the constant torque about a principal axis, N m; None for any other torque."""
    frame, along = scene.frame, 0.0
    for effect in scene.acting:
        if effect.series is None:
            return None
        pull = effect.series(frame, 0.0)
        changes = any(effect.series(frame, time) != pull for time in effect.breakpoints)
        if changes or pull.couple or pull.drag or pull.slowing:
            return None
        if any(pull.constant[k] for k in range(3) if k != axis):
            return None
        along += pull.constant[axis]
    return along


def _after_a_blow(scene, state):
    """Return the expected rate of a hinged body that was hit once, at rest at time 0."""
    n, body = np.array(scene.constraint.axis), scene.body
    arm = np.array(scene.constraint.arm(body))
    length = np.linalg.norm(arm - n * (n @ arm))
    if (len(scene.strikes) != 1 or scene.strikes[0].time or state.time
            or scene.initial.angular_velocity.any() or not length):
        return None
    impulse, turn = (np.array(rotate_back(*scene.initial.orientation, *vector[:3]))
                     for vector in scene.strikes[0].as_impulse(body, scene.initial.vector))
    a = math.sqrt(n @ body.about_center.matrix @ n / body.mass)
    # F d, the moment of the blow about the hinge
    return Steady(float(baseball_bat.angular_acceleration(
        n @ (turn + np.cross(arm, impulse)), 1.0, body.mass, length, a)), n)


def _swing(scene, state):
    """Return the expected half period at the amplitude that the energy allows.

    It is None for a pendulum that turns over or stands still.
    """
    n, body = np.array(scene.constraint.axis), scene.body
    arm = np.array(scene.constraint.arm(body))
    across = arm - n * (n @ arm)
    moment = n @ body.about_center.matrix @ n + body.mass * (across @ across)
    down = -np.array(rotate_back(*state.orientation, 0.0, 0.0, 1.0))
    down -= n * (n @ down)
    slope, length = np.linalg.norm(down), np.linalg.norm(across)
    if not slope * length * scene.weight > 0.0:
        return None
    frequency = math.sqrt(body.mass * scene.weight * length * slope / moment)
    # sin(phi/2)^2 without forming phi
    half_sine_squared = np.sum((across / length - down / slope) ** 2) / 4.0
    reach = half_sine_squared + (n @ state.angular_velocity / (2.0 * frequency)) ** 2
    if not 0.0 < reach < 1.0:
        return None
    return Interval('turning point', kater_pendulum.period(
        frequency, 2.0 * math.asin(math.sqrt(reach))) / 2.0)


def _nutation(scene, state):
    """Return the expected half period of nutation of a top with body axis 3 as symmetry axis."""
    body = scene.body
    inertia = scene.constraint.inertia(body)
    I1, I2, I3 = inertia.moments
    x, y, length = scene.constraint.arm(body)
    if I1 != I2 or x or y or inertia.axes != IDENTITY:
        return None
    up = rotate_back(*state.orientation, 0.0, 0.0, 1.0)
    seconds = heavy_top.time_between_turning_points(
        state.angular_velocity, up, I1, I3, body.mass * scene.weight * length)
    return Interval('turning point', seconds) if seconds else None


class Prediction:
    """The prediction for one undisturbed motion, compared with the motion.

    The prediction is computed when it is first needed, since under a stream of commands most
    motions end before that. Any thread may ask for it.

    Parameters
    ----------
    scene : scenes.Scene
    state : State or None
        The state at the beginning; None while a wrench is held, when theory has nothing to say.
    """

    def __init__(self, scene, state):
        self._scene, self._state, self._found = scene, state, None
        self._made = threading.Lock()

    @property
    def _expected(self):
        with self._made:
            if self._state is not None:
                self._found, self._state = expectation(self._scene, self._state), None
            return self._found

    def note(self, name, time):
        """Note an event and its time, s."""
        if self._expected:
            self._expected.note(name, time)

    def look(self, state):
        """Look at a later state."""
        if self._expected:
            self._expected.look(state)

    def compared(self):
        """Return the prediction and the last measurement; empty without a prediction."""
        return self._expected.compared() if self._expected else {}
