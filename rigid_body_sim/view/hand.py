# SPDX-License-Identifier: Apache-2.0
"""The hand: the mouse's actions on a body, as commands.

A drag is a damped spring from the grabbed point of the body to the cursor. Its force F acts at the
grabbed point g; the command is that force at the centre of mass c and the couple (g - c) x F. A
click is a strike: an impulse J along the line of sight, at the point that was clicked.

The spring is as stiff as the body is heavy at that point: a unit impulse along n changes the
point's velocity by n . A n, and 1/(n . A n) is the mass that the hand feels (the constraint
included). So every body, from a needle to a planet, follows the cursor at the same pace.
"""

import math

import numpy as np
from scipy.spatial.transform import Rotation

from rigid_body_sim.mechanics.impulse import RESPONSE_SIZE, apply_impulse
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.state import ANGULAR_VELOCITY, ORIENTATION, POSITION
from rigid_body_sim.simulation.command_rows import BODY, HOLD, IMPULSE, LET_GO, WIDTH, WORLD

PULL = 2.0 * math.pi * 0.8
"""Angular frequency at which the grabbed point follows the cursor, rad per second of the clock."""
DAMPING = 0.7
"""Damping of the spring, relative to critical."""
STEADY = 0.2
"""Largest angle of the spring's oscillation from one snapshot to the next, rad.

A wrench is held from snapshot to snapshot and acts a snapshot or two late: a faster spring would
be driven by its own delay. With a delay of two snapshots the limit is 0.3 rad.
"""
FOLLOWS = 0.3
"""Turn of the body between snapshots, rad, at which a hand follows a point only halfway."""
SLACK = 1e-2
"""The hand exerts no torque about an axis whose moment is this small, relative to the largest.

Commands to a body that has such an axis are in body axes: a couple that stayed fixed in the world
for a snapshot, while the axis turns into it, would spin a needle by millions of turns.
"""


class Hand:
    """Turns actions of the mouse into rows of commands (simulation.command_rows).

    Parameters
    ----------
    mechanics : snapshots.Mechanics
    """

    def __init__(self, mechanics):
        self._mechanics = mechanics
        self._slack = _slack_axes(mechanics.scene)
        scene = mechanics.scene
        rolls = scene.constraint.mechanism is Mechanism.PLANE and scene.contact.mu == math.inf
        self._normal = np.array(scene.constraint.normal) if rolls else None
        self._middle = np.array(mechanics.scene.constraint.point(mechanics.scene.body))

    def pull(self, vector, grabbed, cursor, pace):
        """Return the row that holds the spring's wrench.

        A body that has to roll is pulled along its plane or towards it, never off it.

        Parameters
        ----------
        vector : array (14,)
            State of the body.
        grabbed, cursor : array (3,)
            The grabbed point of the body and the point under the mouse, world, m.
        pace : float
            Angular frequency of the spring, rad per simulated second; PULL in real time.

        Returns
        -------
        array (1, 8) or None
            None where no force can move that point.
        """
        velocity = self._mechanics.velocity_at(vector, grabbed)
        wanted = pace * (pace * (np.subtract(cursor, grabbed)) - 2.0 * DAMPING * velocity)
        if self._normal is not None:
            wanted = wanted - max(float(wanted @ self._normal), 0.0) * self._normal
        size = float(np.linalg.norm(wanted))
        if size == 0.0 or not math.isfinite(size):
            return None
        mass = self.felt_mass(vector, grabbed, wanted / size)
        return None if mass is None else self._row(HOLD, vector, grabbed, mass * wanted)

    def held_point(self, vector, grip, lag):
        """Return the point (world, m) where a hand holds the body.

        It is the grabbed point of the body while the body turns little between snapshots. A hand
        cannot follow a point that whirls about an axis: it holds such a body at the axis.

        Parameters
        ----------
        vector : array (14,)
            State of the body.
        grip : array (3,)
            The grabbed point in body axes, m.
        lag : float
            Simulated time from snapshot to snapshot, s.
        """
        turn, omega = Rotation.from_quat(vector[ORIENTATION]), vector[ANGULAR_VELOCITY]
        rate = float(np.linalg.norm(omega))
        arm = grip - self._middle
        share = 1.0 / (1.0 + (rate * lag / FOLLOWS) ** 2)
        if rate > 0.0 and share < 1.0:
            on_axis = omega * (float(omega @ arm) / rate**2)
            arm = on_axis + share * (arm - on_axis)
        return vector[POSITION] + turn.apply(self._middle + arm)

    def strike(self, vector, point, impulse):
        """Return the row of an impulse (array (3,), N s, world) at a point of the body (world)."""
        return self._row(IMPULSE, vector, point, np.asarray(impulse, float))

    def felt_mass(self, vector, point, direction):
        """Return the effective mass (kg) at a point along a unit vector, or None."""
        force, couple = self._at_center(vector, point, np.asarray(direction, float))
        after = vector.copy()
        apply_impulse(self._mechanics.packed, after, force, couple, np.empty(RESPONSE_SIZE))
        change = (self._mechanics.velocity_at(after, point)
                  - self._mechanics.velocity_at(vector, point)) @ direction
        return 1.0 / float(change) if change > 1e-300 and math.isfinite(change) else None

    def _row(self, kind, vector, point, force):
        force, couple = self._at_center(vector, point, force)
        if not len(self._slack):
            return np.array([kind, WORLD, *force, *couple]).reshape(1, WIDTH)
        back = Rotation.from_quat(vector[ORIENTATION]).inv()
        return np.array([kind, BODY, *back.apply(force), *back.apply(couple)]).reshape(1, WIDTH)

    def _at_center(self, vector, point, force):
        """Return force and couple at the centre of mass, without torque about slack axes."""
        couple = np.cross(point - self._mechanics.center(vector), force)
        turn = Rotation.from_quat(vector[ORIENTATION])
        for axis in turn.apply(self._slack) if len(self._slack) else ():
            couple = couple - axis * (axis @ couple)
        return force, couple


def together(rows):
    """Return the row of several pulls at once, each of shape (1, 8) and in the same axes."""
    row = rows[0].copy()
    row[:, 2:] = np.sum(rows, axis=0)[:, 2:]
    return row


def pace_of(strength, speed, lag):
    """Return the angular frequency of the spring, rad per simulated second.

    Parameters
    ----------
    strength : float
        Its stiffness relative to the usual one.
    speed : float
        Simulated seconds per second of the clock.
    lag : float
        Simulated time from snapshot to snapshot, or from tick to tick if that is longer, s.
    """
    return min(PULL * math.sqrt(strength) / speed, STEADY / lag)


def release():
    """Return the row that releases the body."""
    return LET_GO.copy()


def _slack_axes(scene):
    """Return the principal axes of small or no moment, in body axes, array (n, 3)."""
    inertia = scene.constraint.inertia(scene.body)
    if scene.constraint.mechanism is Mechanism.AXIS:
        return np.empty((0, 3))
    moments = np.array(inertia.moments)
    axes = Rotation.from_quat(inertia.axes).as_matrix().T
    return axes[moments < SLACK * moments.max()]
