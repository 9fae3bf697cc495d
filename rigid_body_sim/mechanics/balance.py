# SPDX-License-Identifier: Apache-2.0
"""Accelerations and reactions of a state, by the forces of a scene at one instant.

They follow from Newton's and Euler's equations, whatever solved the motion. Symbols: M mass, a
acceleration of the centre of mass (world), F sum of the forces other than the reaction (world), r
arm from the point of reference P to the centre of mass, I tensor about P, Gamma torque of F and of
all couples about P (body axes), n unit vector along a hinge.

    free      M a = F,                              I omega' = Gamma - omega x I omega
    pivot     I omega' = Gamma - omega x I omega    reaction M a - F at P, no couple; of one that
              moves with the acceleration b, Gamma has -r x R^T M b
    hinge     omega' = n (n . Gamma)/(n . I n)      reaction M a - F,
                                                    I omega' + omega x I omega - Gamma about P
    table     normal force M g - F_z; friction mu times that against the slip, or what keeps the
              lowest point at rest
    plane     that of a free body under the force of the contact (contact/standing.py)
"""

from typing import NamedTuple

import numpy as np

from rigid_body_sim.compilation.jit import in_python
from rigid_body_sim.mechanics.contact.standing import Standing
from rigid_body_sim.mechanics.parameters import scene_parameters
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
from rigid_body_sim.scene.constraints import Free
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.expressions.path import along
from rigid_body_sim.scene.state import STATE

STICKS = 1e-11    # relative to the speeds: a smaller slip is the rounding of rolling
NOTHING = (0.0, 0.0, 0.0)


class Balance(NamedTuple):
    """Accelerations and reactions at one instant.

    Attributes
    ----------
    acceleration : array (3,)
        That of the body's origin, world axes, m/s^2.
    angular_acceleration : array (3,)
        omega', body axes, rad/s^2.
    force, torque : array (3,)
        Of the constraint on the body, world axes, N and N m; the torque about `point`. Zero for a
        free body.
    point : array (3,)
        World, m: the fixed point, the point `through` of a hinge, the point of contact with the
        table; the origin of a free body.
    """

    acceleration: np.ndarray
    angular_acceleration: np.ndarray
    force: np.ndarray
    torque: np.ndarray
    point: np.ndarray


class Motion(NamedTuple):
    """A state in the form that the balance takes, as tuples.

    Attributes
    ----------
    R : tuple of 3 rows
        Rotation matrix, body -> world.
    omega : tuple of 3 floats
        Angular velocity, body axes, rad/s.
    position, velocity : tuple of 3 floats
        Those of the body's origin, world axes, m and m/s.
    time : float
        s.
    """

    R: tuple
    omega: tuple
    position: tuple
    velocity: tuple
    time: float


class Actions(NamedTuple):
    """The sum of effects and a held wrench at one instant.

    Attributes
    ----------
    force : tuple of 3 floats
        At the centre of mass, world axes, N.
    couple : tuple of 3 floats
        Body axes, N m.
    turning : tuple of 3 floats
        Extra rate at which the axes turn at constant angular momentum, body axes, rad/s.
    """

    force: tuple
    couple: tuple
    turning: tuple


class Reactions(NamedTuple):
    """Force and torque of a pivot, a hinge or the table on the body at n times.

    Attributes
    ----------
    force, torque, point : array (n, 3)
        As those of a Balance.
    """

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
        self._effects = [effect for effect in scene.effects if effect.acting is not None]
        self._scene = scene_parameters(scene)
        # effects are asked as for a free body: only then do they state their forces
        hinge = constraint.frame(body).hinge
        self._frame = Free().frame(body)._replace(hinge=hinge)
        self._path = constraint.path
        self._own, self._inner = constraint.frame(body), scene.inner_dissipation
        balances = {Mechanism.FREE: self._free, Mechanism.POINT: self._pivot,
                    Mechanism.AXIS: self._hinge, Mechanism.TABLE: self._table,
                    Mechanism.PLANE: self._plane}
        self._of = balances[constraint.mechanism]
        if constraint.mechanism is Mechanism.TABLE:
            self._mu, self._g = scene.contact.mu, scene.contact.g
            self._radius = body.radius
        if constraint.mechanism is Mechanism.PLANE:
            self._standing = Standing(scene)

    def balance(self, vector, wrench=Wrench()):    # noqa: B008 (immutable)
        """Return the Balance at a state (14 doubles) under a held wrench, just after its time."""
        found = self._of(*self._at(vector, wrench))
        return Balance(*(np.array(part) for part in found))

    def rates(self, vector, wrench=Wrench()):    # noqa: B008 (immutable)
        """Return how a state changes, array (4, 3).

        The rate at which the axes turn and omega' (body axes, rad/s and rad/s^2), the velocity of
        the origin and its rate (world axes, m/s and m/s^2).
        """
        motion, acting = self._at(vector, wrench)
        acceleration, growth, *_ = self._of(motion, acting)
        return np.array([plus(motion.omega, acting.turning), growth, motion.velocity,
                         acceleration])

    def _at(self, vector, wrench):
        """Return the Motion of a state and the Actions there."""
        time, q, omega, position, velocity = STATE.load(vector.tolist())
        R = matrix(*q)
        of_center = plus(velocity, apply(R, cross(omega, self._scene.center)))
        center = plus(position, apply(R, self._scene.center))
        acting = self._actions(time, q, omega, of_center, center, wrench)
        return Motion(R, omega, position, velocity, time), acting

    def reactions(self, vectors, wrenches):
        """Return the Reactions at states (n, 14) under the wrench held at each."""
        found = [self.balance(vector, wrench)
                 for vector, wrench in zip(vectors, wrenches, strict=True)]
        parts = np.array([(one.force, one.torque, one.point) for one in found]).reshape(-1, 3, 3)
        return Reactions(*(np.ascontiguousarray(parts[:, k]) for k in range(3)))

    def _actions(self, time, q, omega, velocity, center, wrench):
        """Return the Actions of effects and wrench; velocity and place are of the mass centre."""
        axes = self._frame.axes
        q_frame, omega_frame = multiply(*q, *axes), rotate_back(*axes, *omega)
        sums = {'force': NOTHING, 'torque': NOTHING}
        for actor in [*self._effects, *([wrench] if wrench else [])]:
            for one in actor.acting(self._frame, time):
                if one.gives == 'turning':
                    continue
                field = (time, *center) if one.in_field else ()
                law = in_python(one.kernel)
                added = law(*one.values, *q_frame, *omega_frame, *velocity, *field)
                sums[one.gives] = plus(sums[one.gives], added)
        turning = self._turning(time, q, omega, velocity, center) if self._inner else NOTHING
        return Actions(sums['force'], rotate(*axes, *sums['torque']), turning)

    def _turning(self, time, q, omega, velocity, center):
        """Return the extra rate of the axes, body axes: its moments are about the held point."""
        own = self._own
        q_frame, omega_frame = multiply(*q, *own.axes), rotate_back(*own.axes, *omega)
        place = minus(center, rotate(*q_frame, *own.arm))
        turning = NOTHING
        for effect in self._effects:
            for one in effect.acting(own, time):
                if one.gives == 'force' or (one.gives == 'torque' and one.books != 'potential'):
                    continue
                field = (time, *place) if one.in_field else ()
                law = in_python(one.kernel)
                added = law(*one.values, *q_frame, *omega_frame, *velocity, *field)
                share = 1.0 if one.gives == 'turning' else self._inner
                turning = plus(turning, scaled(share, added))
        return rotate(*own.axes, *turning)

    def _growth(self, omega, torque):
        """Return I^-1 (torque - omega x I omega); nothing about an axis without moment."""
        axes, moments = self._scene.axes, self._scene.moments
        spin = rotate_back(*axes, *omega)
        left = minus(rotate_back(*axes, *torque), cross(spin, product(moments, spin)))
        return rotate(*axes, *(part / moment if moment > 0.0 else 0.0
                               for part, moment in zip(left, moments, strict=True)))

    def _momentum(self, omega):
        axes = self._scene.axes
        return rotate(*axes, *product(self._scene.moments, rotate_back(*axes, *omega)))

    def _free(self, motion, acting):
        omega, turning, center = motion.omega, acting.turning, self._scene.center
        gyroscopic = cross(self._momentum(omega), turning)
        growth = self._growth(omega, plus(acting.couple, gyroscopic))
        # the velocity of the origin has omega x c, but its axes turn with the extra rate too
        lever = plus(_carried(omega, growth, center), cross(turning, cross(omega, center)))
        of_origin = minus(scaled(1.0 / self._scene.mass, acting.force), apply(motion.R, lever))
        return of_origin, growth, NOTHING, NOTHING, motion.position

    def _pivot(self, motion, acting):
        force, through = acting.force, self._scene.through
        arm, turning = minus(self._scene.center, through), acting.turning
        if self._path is not None:    # the pivot moves
            accelerated = along(self._path, motion.time)[2]
            force = minus(force, scaled(self._scene.mass, accelerated))
        moment = plus(cross(arm, apply(transposed(motion.R), force)),
                      cross(self._momentum(motion.omega), turning))
        growth = self._growth(motion.omega, plus(acting.couple, moment))
        lever = _carried(motion.omega, growth, arm)
        lever = plus(lever, cross(turning, cross(motion.omega, arm)))
        held = minus(scaled(self._scene.mass, apply(motion.R, lever)), force)
        if not any(through) and self._path is None:    # the body's origin is held
            return NOTHING, growth, held, NOTHING, motion.position
        lever = plus(_carried(motion.omega, growth, through),
                     cross(turning, cross(motion.omega, through)))
        of_origin = scaled(-1.0, apply(motion.R, lever))
        if self._path is not None:
            of_origin = plus(of_origin, accelerated)
        return of_origin, growth, held, NOTHING, plus(motion.position, apply(motion.R, through))

    def _hinge(self, motion, acting):
        R, omega, force, scene = motion.R, motion.omega, acting.force, self._scene
        arm, n, through = minus(scene.center, scene.through), scene.hinge_axis, scene.through
        torque = plus(acting.couple, cross(arm, apply(transposed(R), force)))
        along = dot(n, torque)
        if not any(omega):    # dry friction balances some of it, or all
            borne = max(-scene.grip, min(along, scene.grip))
            torque, along = minus(torque, scaled(borne, n)), along - borne
        growth = scaled(along / scene.hinge_moment, n)
        along = _carried(omega, growth, arm)
        held = minus(scaled(scene.mass, apply(R, along)), force)
        # about P: the tensor about the centre of mass, and the mass there
        spun = plus(self._momentum(growth), cross(omega, self._momentum(omega)))
        spun = plus(spun, scaled(scene.mass, cross(arm, along)))
        of_origin = scaled(-1.0, apply(R, _carried(omega, growth, through)))
        point = plus(motion.position, apply(R, through))
        return of_origin, growth, held, apply(R, minus(spun, torque)), point

    def _table(self, motion, acting):
        mass, force, moment = self._scene.mass, acting.force, self._scene.moments[0]
        down = (0.0, 0.0, -self._radius)
        turn, torque = apply(motion.R, motion.omega), apply(motion.R, acting.couple)
        normal = mass * self._g - force[2]
        flat = (force[0], force[1], 0.0)
        slip_x, slip_y, _ = plus(motion.velocity, cross(turn, down))
        speed = hypot(slip_x, slip_y)
        if speed > STICKS * (hypot3(*motion.velocity) + self._radius * hypot3(*turn)):
            friction = scaled(-self._mu * normal / speed, (slip_x, slip_y, 0.0))
        else:
            friction = self._grip(flat, torque, normal, down)
        growth = scaled(1.0 / moment, plus(torque, cross(down, friction)))
        return (scaled(1.0 / mass, plus(flat, friction)), apply(transposed(motion.R), growth),
                plus(friction, (0.0, 0.0, normal)), NOTHING, plus(motion.position, down))

    def _plane(self, motion, acting):
        R, omega, center = motion.R, motion.omega, self._scene.center
        of_center = plus(motion.velocity, apply(R, cross(omega, center)))
        place = plus(motion.position, apply(R, center))
        force, couple, arm = self._standing.force(R, omega, place, of_center, acting.force,
                                                  acting.couple)
        torque = plus(acting.couple, plus(couple, cross(arm, apply(transposed(R), force))))
        growth = self._growth(omega, torque)
        of_origin = minus(scaled(1.0 / self._scene.mass, plus(acting.force, force)),
                          apply(R, _carried(omega, growth, center)))
        return of_origin, growth, force, apply(R, couple), plus(place, apply(R, arm))

    def _grip(self, flat, torque, normal, down):
        """Return the friction that keeps the lowest point at rest, or the largest one."""
        mass, moment = self._scene.mass, self._scene.moments[0]
        driven = plus(scaled(1.0 / mass, flat), cross(scaled(1.0 / moment, torque), down))
        gives = 1.0 / mass + self._radius * self._radius / moment
        friction = (-driven[0] / gives, -driven[1] / gives, 0.0)
        most, size = self._mu * normal, hypot3(*friction)
        return scaled(most / size, friction) if size > most else friction


def _carried(omega, growth, arm):
    """Return the acceleration at the end of an arm: omega' x r + omega x (omega x r)."""
    return plus(cross(growth, arm), cross(omega, cross(omega, arm)))
