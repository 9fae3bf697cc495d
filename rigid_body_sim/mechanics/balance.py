"""Accelerations and reactions of a state: what a scene's forces do at one instant, by Newton and Euler, whatever solved the motion.

Symbols: M mass, a = R (...) acceleration of the centre of mass (world), F sum of the forces other than the reaction (world), r arm from the
point of reference P to the centre of mass, I tensor about P, Gamma torque of F and of all couples about P (body axes).

    free      M a = F,                      I omega' = Gamma - omega x I omega  (P the centre of mass)
    pivot     I omega' = Gamma - omega x I omega,   reaction M a - F at P, no couple
    hinge     omega' = n (n . Gamma)/(n . I n),     reaction M a - F, couple I omega' + omega x I omega - Gamma about P
    table     normal force M g - F_z; friction mu times that against the slip, or what keeps the lowest point at rest
"""

import dataclasses
import functools
import importlib
from typing import NamedTuple

import numpy as np

from rigid_body_sim.mechanics.parameters import moment_about_hinge
from rigid_body_sim.numerics.rotations import multiply
from rigid_body_sim.scene.effects.views import Frame
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.state import ANGULAR_VELOCITY, ORIENTATION, POSITION, TIME, VELOCITY

STICKS = 1e-11    # slip below that share of the speeds is the rounding of rolling
UP = np.array([0.0, 0.0, 1.0])


class Balance(NamedTuple):
    """What acts at one instant.

    Attributes
    ----------
    acceleration : array (3,)
        Of the body's origin, world axes, m/s^2.
    angular_acceleration : array (3,)
        omega', body axes, rad/s^2.
    force, torque : array (3,)
        Of the constraint on the body, world axes, N and N m; the torque about `point`. Zero for a free body.
    point : array (3,)
        World, m: the fixed point, the point `through` of a hinge, the point of contact with the table; the origin of a free body.
    """

    acceleration: np.ndarray
    angular_acceleration: np.ndarray
    force: np.ndarray
    torque: np.ndarray
    point: np.ndarray


class Reactions(NamedTuple):
    """What a pivot, a hinge or the table exerts on the body at n times: force, torque and point of a Balance, arrays of shape (n, 3)."""

    force: np.ndarray
    torque: np.ndarray
    point: np.ndarray


class Dynamics:
    """The balance of forces of a scene, state by state.

    Parameters
    ----------
    scene : Scene
    """

    def __init__(self, scene):
        body, constraint = scene.body, scene.constraint
        self._effects = [effect for effect in scene.effects if hasattr(effect, 'acting')]
        self._kind, self._mass, self._center = constraint.kind, body.mass, np.array(body.center_of_mass)
        # effects are asked as if the body were free: only then do they name their forces
        self._frame = Frame.of(body, dataclasses.replace(constraint, kind='free'))
        inertia = body.about_origin if self._kind == 'pivot' else body.about_center
        self._axes, self._moments = _matrix(*inertia.axes), np.array(inertia.moments)
        self._inverse = np.divide(1.0, self._moments, out=np.zeros(3), where=self._moments > 0.0)
        self._frame_axes = _matrix(*self._frame.axes)
        self._fixed = np.zeros(3) if self._kind == 'pivot' else np.array(constraint.through)
        if self._kind == 'hinge':
            self._axis, self._moment = np.array(constraint.axis), moment_about_hinge(body, constraint)
        if self._kind == 'table':
            friction = scene.effect('sliding_friction')
            self._mu, self._g = (friction.mu, friction.g) if friction else (0.0, 0.0)
            self._radius, self._moment = body.radius, float(np.mean(body.about_center.moments))

    def balance(self, vector, wrench=Wrench()):    # noqa: B008 (immutable)
        """Return the Balance at a state (14 doubles) under a held wrench, just after the state's time."""
        q, omega = tuple(vector[ORIENTATION].tolist()), np.array(vector[ANGULAR_VELOCITY])
        R = _matrix(*q)
        velocity = vector[VELOCITY] + R @ _cross(omega, self._center)
        force, couple, turning = self._given(float(vector[TIME]), q, omega, velocity, wrench)
        return getattr(self, f'_{self._kind}')(vector, R, omega, force, couple, turning)

    def reactions(self, vectors, wrenches):
        """Return the Reactions at states (n, 14) under the wrench held at each."""
        found = [self.balance(vector, wrench) for vector, wrench in zip(vectors, wrenches, strict=True)]
        parts = np.array([(one.force, one.torque, one.point) for one in found]).reshape(-1, 3, 3)
        return Reactions(*(np.ascontiguousarray(parts[:, k]) for k in range(3)))

    def _given(self, time, q, omega, velocity, wrench):
        """Return the force (world), the couple and the extra turning rate (body axes) of effects and wrench."""
        q_frame = multiply(*q, *self._frame.axes)
        omega_frame, velocity = (omega @ self._frame_axes).tolist(), velocity.tolist()
        sums = {'force': np.zeros(3), 'torque': np.zeros(3), 'turning': np.zeros(3)}
        for actor in [*self._effects, *([wrench] if wrench else [])]:
            for one in actor.acting(self._frame, time):
                sums[one.gives] += _kernel(one.kernel)(*one.values, *q_frame, *omega_frame, *velocity)
        return sums['force'], self._frame_axes @ sums['torque'], self._frame_axes @ sums['turning']

    def _growth(self, omega, torque):
        """Return I^-1 (torque - omega x I omega); nothing about an axis without moment."""
        spin = omega @ self._axes
        left = torque @ self._axes - _cross(spin, self._moments * spin)
        return self._axes @ (self._inverse * left)

    def _momentum(self, omega):
        return self._axes @ (self._moments * (omega @ self._axes))

    def _free(self, vector, R, omega, force, couple, turning):
        growth = self._growth(omega, couple + _cross(self._momentum(omega), turning))
        # the velocity of the origin has omega x c, but its axes turn with the extra rate too
        lever = _carried(omega, growth, self._center) + _cross(turning, _cross(omega, self._center))
        return Balance(force / self._mass - R @ lever, growth, np.zeros(3), np.zeros(3), vector[POSITION].copy())

    def _pivot(self, vector, R, omega, force, couple, turning):
        growth = self._growth(omega, couple + _cross(self._center, force @ R))
        held = self._mass * (R @ _carried(omega, growth, self._center)) - force
        return Balance(np.zeros(3), growth, held, np.zeros(3), vector[POSITION].copy())

    def _hinge(self, vector, R, omega, force, couple, turning):
        arm = self._center - self._fixed
        torque = couple + _cross(arm, force @ R)
        growth = self._axis * (self._axis @ torque) / self._moment
        along = _carried(omega, growth, arm)
        held = self._mass * (R @ along) - force
        # about P: the tensor about the centre of mass, and the mass there
        spun = self._momentum(growth) + _cross(omega, self._momentum(omega)) + self._mass * _cross(arm, along)
        through = R @ self._fixed
        return Balance(-(R @ _carried(omega, growth, self._fixed)), growth, held, R @ (spun - torque),
                       vector[POSITION] + through)

    def _table(self, vector, R, omega, force, couple, turning):
        turn, down = R @ omega, -self._radius * UP
        torque = R @ couple
        normal = self._mass * self._g - force[2]
        flat = np.array([force[0], force[1], 0.0])
        slip = vector[VELOCITY] + _cross(turn, down)
        slip[2] = 0.0
        speed = np.linalg.norm(slip)
        if speed > STICKS * (np.linalg.norm(vector[VELOCITY]) + self._radius * np.linalg.norm(turn)):
            friction = -self._mu * normal * slip / speed
        else:
            # what keeps the lowest point at rest, if friction is strong enough
            driven = flat / self._mass + _cross(torque / self._moment, down)
            friction = -driven / (1.0 / self._mass + self._radius * self._radius / self._moment)
            friction[2] = 0.0
            most, size = self._mu * normal, np.linalg.norm(friction)
            friction *= most / size if size > most else 1.0
        growth = (torque + _cross(down, friction)) / self._moment
        return Balance((flat + friction) / self._mass, growth @ R, friction + normal * UP, np.zeros(3),
                       vector[POSITION] + down)


def _matrix(x, y, z, w):
    """Return the matrix of a unit quaternion: it turns ten vectors here, for the price of one turned by the quaternion."""
    return np.array(((1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)),
                     (2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)),
                     (2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y))))


def _cross(a, b):
    """Return a x b; numpy's own takes ten times as long for a single pair."""
    (a1, a2, a3), (b1, b2, b3) = a.tolist(), b.tolist()
    return np.array((a2 * b3 - a3 * b2, a3 * b1 - a1 * b3, a1 * b2 - a2 * b1))


def _carried(omega, growth, arm):
    """Return the acceleration of a point at the end of an arm: omega' x r + omega x (omega x r)."""
    return _cross(growth, arm) + _cross(omega, _cross(omega, arm))


@functools.cache
def _kernel(name):
    """Return the plain function of a kernel: to compile it for a single call would take longer than all calls."""
    module, _, function = name.partition(':')
    kernel = getattr(importlib.import_module(module), function)
    return getattr(kernel, 'py_func', kernel)
