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
from rigid_body_sim.numerics.functions import hypot, hypot3
from rigid_body_sim.numerics.rotations import matrix, multiply, rotate, rotate_back
from rigid_body_sim.numerics.vectors import (
    apply,
    cross,
    dot,
    minus,
    plus,
    product,
    scaled,
    transposed,
)
from rigid_body_sim.scene.effects.views import Frame
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.state import STATE_SIZE

STICKS = 1e-11    # slip below that share of the speeds is the rounding of rolling
NOTHING = (0.0, 0.0, 0.0)


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


class Motion(NamedTuple):
    """A state as the balance takes it, in tuples.

    Attributes
    ----------
    R : tuple of 3 rows
        Rotation matrix, body -> world.
    omega : tuple of 3 floats
        Angular velocity, body axes, rad/s.
    position, velocity : tuple of 3 floats
        Of the body's origin, world axes, m and m/s.
    """

    R: tuple
    omega: tuple
    position: tuple
    velocity: tuple


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
        self._kind, self._mass, self._center = constraint.kind, body.mass, body.center_of_mass
        # effects are asked as if the body were free: only then do they name their forces
        self._frame = Frame.of(body, dataclasses.replace(constraint, kind='free'))
        inertia = body.about_origin if self._kind == 'pivot' else body.about_center
        self._axes, self._moments = inertia.axes, inertia.moments
        self._fixed = (0.0, 0.0, 0.0) if self._kind == 'pivot' else constraint.through
        if self._kind == 'hinge':
            self._axis, self._moment = constraint.axis, moment_about_hinge(body, constraint)
        if self._kind == 'table':
            friction = scene.effect('sliding_friction')
            self._mu, self._g = (friction.mu, friction.g) if friction else (0.0, 0.0)
            self._radius, self._moment = body.radius, body.about_center.moments[0]

    def balance(self, vector, wrench=Wrench()):    # noqa: B008 (immutable)
        """Return the Balance at a state (14 doubles) under a held wrench, just after the state's time."""
        time, qx, qy, qz, qw, wx, wy, wz, px, py, pz, vx, vy, vz = vector[:STATE_SIZE].tolist()
        q, omega, velocity = (qx, qy, qz, qw), (wx, wy, wz), (vx, vy, vz)
        R = matrix(*q)
        of_center = plus(velocity, apply(R, cross(omega, self._center)))
        given = self._given(time, q, omega, of_center, wrench)
        found = getattr(self, f'_{self._kind}')(Motion(R, omega, (px, py, pz), velocity), *given)
        return Balance(*(np.array(part) for part in found))

    def reactions(self, vectors, wrenches):
        """Return the Reactions at states (n, 14) under the wrench held at each."""
        found = [self.balance(vector, wrench) for vector, wrench in zip(vectors, wrenches, strict=True)]
        parts = np.array([(one.force, one.torque, one.point) for one in found]).reshape(-1, 3, 3)
        return Reactions(*(np.ascontiguousarray(parts[:, k]) for k in range(3)))

    def _given(self, time, q, omega, velocity, wrench):
        """Return the force (world), the couple and the extra turning rate (body axes) of effects and wrench."""
        axes = self._frame.axes
        q_frame, omega_frame = multiply(*q, *axes), rotate_back(*axes, *omega)
        sums = {'force': NOTHING, 'torque': NOTHING, 'turning': NOTHING}
        for actor in [*self._effects, *([wrench] if wrench else [])]:
            for one in actor.acting(self._frame, time):
                sums[one.gives] = plus(sums[one.gives], _kernel(one.kernel)(*one.values, *q_frame, *omega_frame, *velocity))
        return sums['force'], rotate(*axes, *sums['torque']), rotate(*axes, *sums['turning'])

    def _growth(self, omega, torque):
        """Return I^-1 (torque - omega x I omega); nothing about an axis without moment."""
        spin = rotate_back(*self._axes, *omega)
        left = minus(rotate_back(*self._axes, *torque), cross(spin, product(self._moments, spin)))
        return rotate(*self._axes, *(part / moment if moment > 0.0 else 0.0 for part, moment in zip(left, self._moments, strict=True)))

    def _momentum(self, omega):
        return rotate(*self._axes, *product(self._moments, rotate_back(*self._axes, *omega)))

    def _free(self, motion, force, couple, turning):
        omega = motion.omega
        growth = self._growth(omega, plus(couple, cross(self._momentum(omega), turning)))
        # the velocity of the origin has omega x c, but its axes turn with the extra rate too
        lever = plus(_carried(omega, growth, self._center), cross(turning, cross(omega, self._center)))
        return minus(scaled(1.0 / self._mass, force), apply(motion.R, lever)), growth, NOTHING, NOTHING, motion.position

    def _pivot(self, motion, force, couple, turning):
        growth = self._growth(motion.omega, plus(couple, cross(self._center, apply(transposed(motion.R), force))))
        lever = _carried(motion.omega, growth, self._center)
        held = minus(scaled(self._mass, apply(motion.R, lever)), force)
        return NOTHING, growth, held, NOTHING, motion.position

    def _hinge(self, motion, force, couple, turning):
        R, omega, arm = motion.R, motion.omega, minus(self._center, self._fixed)
        torque = plus(couple, cross(arm, apply(transposed(R), force)))
        growth = scaled(dot(self._axis, torque) / self._moment, self._axis)
        along = _carried(omega, growth, arm)
        held = minus(scaled(self._mass, apply(R, along)), force)
        # about P: the tensor about the centre of mass, and the mass there
        spun = plus(plus(self._momentum(growth), cross(omega, self._momentum(omega))), scaled(self._mass, cross(arm, along)))
        of_origin = scaled(-1.0, apply(R, _carried(omega, growth, self._fixed)))
        return of_origin, growth, held, apply(R, minus(spun, torque)), plus(motion.position, apply(R, self._fixed))

    def _table(self, motion, force, couple, turning):
        turn, down, torque = apply(motion.R, motion.omega), (0.0, 0.0, -self._radius), apply(motion.R, couple)
        normal = self._mass * self._g - force[2]
        flat = (force[0], force[1], 0.0)
        slip_x, slip_y, _ = plus(motion.velocity, cross(turn, down))
        speed = hypot(slip_x, slip_y)
        if speed > STICKS * (hypot3(*motion.velocity) + self._radius * hypot3(*turn)):
            friction = scaled(-self._mu * normal / speed, (slip_x, slip_y, 0.0))
        else:
            # what keeps the lowest point at rest, if friction is strong enough
            driven_x, driven_y, _ = plus(scaled(1.0 / self._mass, flat), cross(scaled(1.0 / self._moment, torque), down))
            gives = 1.0 / self._mass + self._radius * self._radius / self._moment
            friction = (-driven_x / gives, -driven_y / gives, 0.0)
            most, size = self._mu * normal, hypot3(*friction)
            friction = scaled(most / size, friction) if size > most else friction
        growth = scaled(1.0 / self._moment, plus(torque, cross(down, friction)))
        return (scaled(1.0 / self._mass, plus(flat, friction)), apply(transposed(motion.R), growth),
                plus(friction, (0.0, 0.0, normal)), NOTHING, plus(motion.position, down))


def _carried(omega, growth, arm):
    """Return the acceleration of a point at the end of an arm: omega' x r + omega x (omega x r)."""
    return plus(cross(growth, arm), cross(omega, cross(omega, arm)))


@functools.cache
def _kernel(name):
    """Return the plain function of a kernel: to compile it for a single call would take longer than all calls."""
    module, _, function = name.partition(':')
    kernel = getattr(importlib.import_module(module), function)
    return getattr(kernel, 'py_func', kernel)
