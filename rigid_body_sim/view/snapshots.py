# SPDX-License-Identifier: Apache-2.0
"""Snapshots: the data that a page shows of one moment, from any source.

A *source* gives them: a simulation (live.py), a node (node_source.py), a recording (player.py).
"""

from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from rigid_body_sim.mechanics import energy, parameters
from rigid_body_sim.mechanics.balance import Dynamics
from rigid_body_sim.mechanics.potential import energies
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.state import ANGULAR_VELOCITY, ORIENTATION, POSITION, TIME, VELOCITY

TURN_BETWEEN = 0.1
"""Largest turn between two states of a trail, rad, up to MOST_BETWEEN states."""
MOST_BETWEEN = 40
ROUNDING = 64.0 * float(np.finfo(float).eps)
"""A sum below this share of the sizes of its terms is the rounding of terms that cancel."""
LARGEST_TURN = 0.2
"""Turn from state to state, rad, up to which their differences tell the slopes between them."""
LONGEST_GAP = 0.5
"""Time between two states, s, beyond which a trail does not guess what was between them."""


class Snapshot(NamedTuple):
    """One moment of a motion.

    Attributes
    ----------
    time : float
        Simulated time since the start or the last reset, s.
    vector : array (14,)
        The state (scene.state).
    trail : array (n, 14)
        States since the last snapshot, the present one last, for the traces.
    wrench : Wrench
        The held command.
    energy, energy_residual, momentum_residual : float
        Energy (J) and the relative residuals of the ledger; NaN where unknown.
    events : tuple of (float, str)
        Time (s) and text of what happened since the last snapshot.
    restarted : bool
        Whether traces and curves begin anew with this snapshot.
    net : tuple of (array (3,), array (3,)), optional
        Net force (N) and torque (N m), world axes, from a source whose states lack the velocity;
        NaN where unknown. Else they follow from the state and the held command.
    """

    time: float
    vector: np.ndarray
    trail: np.ndarray
    wrench: Wrench
    energy: float
    energy_residual: float
    momentum_residual: float
    events: tuple = ()
    restarted: bool = False
    net: tuple | None = None


UNKNOWN = (np.full(3, np.nan), np.full(3, np.nan))
"""The `net` of a Snapshot whose source cannot tell."""


def trail_between(before, after):
    """Return states (n, 14) from one state to a later one, dense enough for a trace.

    The body is taken to turn evenly, as many times as its angular velocity says, so that a source
    of sixty states a second can show a fast top. The last row is `after`.
    """
    elapsed = after[TIME] - before[TIME]
    if not 0.0 < elapsed < LONGEST_GAP:
        return after[np.newaxis]
    turn = _turn_between(before, after)
    count = min(1 + int(np.linalg.norm(turn) / TURN_BETWEEN), MOST_BETWEEN)
    states = _states_between(before, after, turn, np.arange(1, count + 1) / count)
    states[-1] = after
    return states


def state_between(before, after, share):
    """Return the state (14,) at a share (0 to 1) of the time from one state to a later one.

    The body is taken to turn evenly, as for :func:`trail_between`. States too far apart do not
    tell what is between them: the earlier one is returned.
    """
    if not 0.0 < after[TIME] - before[TIME] < LONGEST_GAP:
        return before
    return _states_between(before, after, _turn_between(before, after), np.array([share]))[0]


def _states_between(before, after, turn, shares):
    """Return the states at shares (n,) of a turn (rotation vector, body axes) between two."""
    share = shares[:, np.newaxis]
    states = before + share * (after - before)
    start = Rotation.from_quat(before[ORIENTATION])
    states[:, ORIENTATION] = (start * Rotation.from_rotvec(share * turn)).as_quat()
    return states


def _turn_between(before, after):
    """Return the rotation vector (body axes) from one state to a later one, whole turns too."""
    elapsed = after[TIME] - before[TIME]
    start, end = Rotation.from_quat(before[ORIENTATION]), Rotation.from_quat(after[ORIENTATION])
    turn = (start.inv() * end).as_rotvec()
    expected = 0.5 * elapsed * (before[ANGULAR_VELOCITY] + after[ANGULAR_VELOCITY])
    angle = float(np.linalg.norm(turn))
    if angle > 0.0:
        axis = turn / angle
        turn = turn + 2.0 * np.pi * round(float(axis @ expected - angle) / (2.0 * np.pi)) * axis
    return turn


class Arrows(NamedTuple):
    """Vectors in world axes: motion, momentum, and what acts on the body.

    Attributes
    ----------
    omega, momentum : array (3,)
        Angular velocity (rad/s), angular momentum about the point of reference (kg m^2/s).
    force, torque : array (3,)
        Net force on the body (N), and dL/dt (N m), reactions of the constraint included. They are
        zero where no more than the rounding of their terms is left.
    """

    omega: np.ndarray
    momentum: np.ndarray
    force: np.ndarray
    torque: np.ndarray


class Mechanics:
    """The quantities that are computed from states for drawing.

    The point of reference of L is the centre of mass of a free body and of a body on a table, and
    the body's fixed point or hinge otherwise.
    """

    def __init__(self, scene):
        self.scene = scene
        self.packed = parameters.parameters(scene)
        self._dynamics, self._energies = Dynamics(scene), energies(scene)

    def arrows(self, vector, wrench):
        """Return the Arrows of a state (14,) under a held Wrench."""
        body, constraint = self.scene.body, self.scene.constraint
        balance = self._dynamics.balance(vector, wrench)
        turn = Rotation.from_quat(vector[ORIENTATION])
        omega, growth = vector[ANGULAR_VELOCITY], np.asarray(balance.angular_acceleration)
        center = np.array(body.center_of_mass)
        force = body.mass * _sum(np.asarray(balance.acceleration),
                                 turn.apply(np.cross(growth, center)),
                                 turn.apply(np.cross(omega, np.cross(omega, center))))
        inertia = constraint.inertia(body).matrix
        changes = [turn.apply(inertia @ growth), turn.apply(np.cross(omega, inertia @ omega))]
        if constraint.mechanism is Mechanism.AXIS:
            axis = turn.apply(constraint.axis)
            arm = turn.apply(constraint.arm(body))
            along = axis @ _sum(*changes, np.cross(arm, force))
            sizes = [*changes, np.linalg.norm(arm) * force]
            torque = axis * _cleared(along, sizes)
        else:
            torque = _sum(*changes)
        return Arrows(turn.apply(omega), self.momentum(vector), force, torque)

    def momentum(self, vector):
        """Return the angular momentum of a state, world axes, kg m^2/s."""
        diagnosis = np.empty(energy.DIAGNOSIS_SIZE)
        self._energies.diagnose(self.packed, vector, diagnosis)
        return diagnosis[energy.MOMENTUM:].copy()

    def of(self, snapshot):
        """Return the Arrows of a Snapshot."""
        arrows = self.arrows(snapshot.vector, snapshot.wrench)
        if snapshot.net is None:
            return arrows
        return arrows._replace(force=snapshot.net[0], torque=snapshot.net[1])

    def need_velocity(self):
        """Return whether force and torque depend on the velocity of the body's origin."""
        if self.scene.constraint.mechanism in (Mechanism.TABLE, Mechanism.PLANE):
            return True
        found = []
        for speed in (0.0, 1.0):
            vector = self.scene.initial.vector.copy()
            vector[VELOCITY] = speed
            found.append(self.arrows(vector, Wrench()))
        return any(np.any(one != other) for one, other in zip(*(each[2:] for each in found),
                                                              strict=True))

    def net_between(self, states):
        """Return net force and torque by the differences of three states (3, 14).

        They hold at the middle state. They are UNKNOWN if the states are not evenly spaced in
        time, or if the body turns by more than LARGEST_TURN from one to the next.
        """
        before, after = np.diff(states[:, TIME])
        step = 0.5 * (before + after)
        speed = float(np.linalg.norm(states[1, ANGULAR_VELOCITY]))
        if not abs(after - before) < 1e-3 * step or speed * step > LARGEST_TURN:
            return UNKNOWN
        turns = Rotation.from_quat(states[:, ORIENTATION])
        centers = states[:, POSITION] + turns.apply(self.scene.body.center_of_mass)
        momenta = np.array([self.momentum(state) for state in states])
        if self.scene.constraint.mechanism is Mechanism.AXIS:
            axis = turns[1].apply(self.scene.constraint.axis)
            momenta = np.outer(momenta @ axis, axis)
        bends = self.scene.body.mass / step**2 * np.array([centers[0], -2.0 * centers[1],
                                                           centers[2]])
        slopes = np.array([-momenta[0], momenta[2]]) / (2.0 * step)
        return _sum(*bends), _sum(*slopes)

    def center(self, vector):
        """Return the centre of mass of a state in the world, m."""
        turn = Rotation.from_quat(vector[ORIENTATION])
        return vector[POSITION] + turn.apply(self.scene.body.center_of_mass)

    def velocity_at(self, vector, point):
        """Return the velocity (m/s, world) of the body's point that is now at `point` (world)."""
        omega = Rotation.from_quat(vector[ORIENTATION]).apply(vector[ANGULAR_VELOCITY])
        return vector[VELOCITY] + np.cross(omega, point - vector[POSITION])


def _sum(*terms):
    """Return the sum of vectors (3,), or zero where only its rounding is left."""
    return _cleared(np.sum(terms, axis=0), terms)


def _cleared(value, terms):
    """Return a number or vector that was made from terms (3,), zero if that is their rounding."""
    size = sum(float(np.linalg.norm(term)) for term in terms)
    return value if float(np.linalg.norm(value)) > ROUNDING * size else 0.0 * value
