# SPDX-License-Identifier: Apache-2.0
"""The balance of forces of a body above, or in contact with, a plane at one instant."""

import math

from rigid_body_sim.mechanics.contact.forces import (
    Push,
    patch_of,
    standing,
    system_of,
    torque_of,
)
from rigid_body_sim.mechanics.contact.holding import (
    across_rim,
    bears,
    burden,
    gripped,
    gripping,
    growing,
    holds_still,
    rolling_couples,
    tips,
    way_out,
)
from rigid_body_sim.mechanics.contact.laws import departure, slipping, sticking
from rigid_body_sim.mechanics.contact.numbers import contact_parameters, weight
from rigid_body_sim.mechanics.contact.parameters import CONTACT, HELD, LOW, TIPS
from rigid_body_sim.mechanics.contact.patch import (
    patch_departure,
    patch_pivoting,
    patch_slipping,
    patch_sticking,
)
from rigid_body_sim.mechanics.contact.touch import (
    above_flat,
    couples,
    inclination,
    lever,
    tangent,
)
from rigid_body_sim.numerics.functions import hypot, hypot3
from rigid_body_sim.numerics.rotations import rotate, rotate_back
from rigid_body_sim.numerics.vectors import apply, cross, dot, plus, scaled, transposed
from rigid_body_sim.scene.surfaces import TORUS

TOUCHES = 1e-11    # a gap, a slip, a speed below that share of lengths and speeds is rounding
PIVOTS = 1e-8      # share of the speeds below which the slip of a patch that spins is its balance
BEGINS = 1e-7      # share of the speeds below which a rolling has no direction of its own
NOTHING = (0.0, 0.0, 0.0)


class Standing:
    """What a plane does to the body of a scene.

    Parameters
    ----------
    scene : Scene
    """

    def __init__(self, scene):
        self._c = CONTACT.load(contact_parameters(scene).tolist())
        self._is_disk = self._c.kind == TORUS and self._c.size[1] == 0.0
        self._heaviness = weight(scene)

    def force(self, R, omega, position, velocity, force, couple):
        """Return what the plane exerts on the body.

        Parameters
        ----------
        R : tuple of 3 rows
            Rotation matrix, body -> world.
        omega : tuple
            Body axes, rad/s.
        position, velocity : tuple
            Of the centre of mass, world axes, m and m/s.
        force, couple : tuple
            Of all else, world and body axes, N and N m.

        Returns
        -------
        force : tuple
            World axes, N; zero if the body does not touch the plane.
        couple : tuple
            Of rolling friction, body axes, N m.
        lever : tuple
            From the centre of mass to the lowest point, body axes, m.
        """
        c = self._c
        columns = transposed(R)
        axes = tuple(tuple(apply(columns, rotate(*c.plane, *e)))
                     for e in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))
        gamma = axes[2]
        r = lever(c, gamma)
        height = rotate_back(*c.plane, *position)[2]
        below = dot(gamma, r)
        u = plus(rotate_back(*c.plane, *velocity), apply(axes, cross(omega, r)))
        speed = hypot3(*velocity) + hypot3(*omega) * hypot3(*r)
        if height + below > TOUCHES * (abs(height) + abs(below)) or u[2] > TOUCHES * speed:
            return NOTHING, NOTHING, r
        pressed = rotate_back(*c.plane, *force)[2] < 0.0
        stands = standing(c, None, omega, axes, r)
        if pressed and not any(omega) and not any(velocity) and self._rests(
                stands, rotate_back(*c.plane, *force), couple):
            force = scaled(-1.0, force)
            return force, scaled(-1.0, plus(couple, cross(r, apply(columns, force)))), r
        free = plus(couple, scaled(-1.0, cross(omega, apply(c.uneven, omega))))
        f, touch = self._touch(stands, (rotate_back(*c.plane, *force), free), (u, speed))
        if not f[2] > 0.0:
            return NOTHING, NOTHING, r
        return rotate(*c.plane, *f), touch, r

    def _touch(self, stands, acts, slip):
        """Return what `_exerted` does, for the same arguments; dry rolling friction may hold."""
        c, gamma = self._c, stands.axes[2]
        if not c.rolling > 0.0:
            return self._exerted(c, stands, acts, slip)
        along, across = dot(tangent(gamma), stands.moved), 0.0
        c = c._replace(swift=slip[1] or 1.0)    # beside which no rolling is none
        rolls = abs(along) if self._is_disk else hypot3(*stands.moved)
        if c.kind == TORUS and not self._is_disk and rolls > TOUCHES * slip[1]:
            tipped = self._tipped(c, stands, acts, slip)
            if tipped is not None:
                return tipped
        falls = math.sqrt(self._heaviness * hypot3(*stands.r))
        begins = not self._is_disk and rolls <= BEGINS * (slip[1] + falls)
        if rolls <= TOUCHES * slip[1] or begins:
            still, held = c._replace(way=HELD), gripped(c, stands)
            f, touch = self._exerted(still, held, acts, slip)
            holds, (along, across) = gripping(c, held, *self._turned(held, acts, f, touch))
            if hypot(along, across) <= c.rolling * f[2]:
                if begins and rolls > TOUCHES * slip[1]:    # it ends
                    return self._exerted(c, stands, acts, slip)
                return f, plus(touch, holds)

            def growth(x, z):
                one = c._replace(way=(x, z), onset=slip[1] + falls)
                f, touch = self._exerted(one, stands, acts, slip)
                return growing(one, stands, self._turned(stands, acts, f, touch)[1])
            if not self._is_disk:
                way = way_out(growth, along, across)
                # friction is along the way, whatever little s' there is
                c = c._replace(way=way, onset=slip[1] + falls)
                return self._exerted(c, stands, acts, slip)
        way = math.copysign(1.0, along), 0.0
        return self._exerted(c._replace(way=way), stands, acts, slip)

    def _tipped(self, c, stands, acts, slip):
        """Return what `_exerted` does, of a torus that tips, None of one that does not."""
        if abs(dot(across_rim(stands.axes[2]), stands.omega)) > TOUCHES * hypot3(*stands.omega):
            return None
        c = c._replace(rim=TIPS, way=(math.copysign(1.0, tips(c, stands)), 0.0))
        held = gripped(c, stands)
        f, touch = self._exerted(c, held, acts, slip)
        holds, (along, _) = gripping(c, held, *self._turned(held, acts, f, touch))
        if abs(along) * inclination(stands.axes[2]) > TIPS * c.rolling * f[2]:
            return None
        return f, plus(touch, holds)

    def _turned(self, stands, acts, f, touch):
        """Return the couple about the centre of mass, and omega'."""
        torque = plus(plus(acts[1], touch), torque_of(stands, f))
        return torque, plus(apply(stands.inverse, torque), stands.shift)

    def _exerted(self, c, stands, acts, slip):
        """Return the force (axes of the plane) and couple (body axes) of the contact.

        Parameters
        ----------
        acts : tuple of 2 tuples
            Force (axes of the plane) and couple with the gyroscopic one (body axes) of all else.
        slip : tuple of tuple and float
            Velocity of the lowest point, and the speeds beside which it is rounding, m/s.
        """
        gamma, (u, speed) = stands.axes[2], slip
        viscous, wrung, _, _ = (rolling_couples(c, stands, c.way) if c.rolling > 0.0
                                else couples(c, gamma, stands.moved))
        push = Push(acts[0], plus(acts[1], viscous), viscous, wrung)
        if c.patch > 0.0:
            spin = dot(gamma, stands.omega)
            f, twist = self._patch_force(patch_of(c, stands, push), u, spin, speed)
            viscous = plus(viscous, scaled(twist, gamma))
        else:
            f = self._force(system_of(c, stands, push), u, speed)
        return f, plus(viscous, scaled(f[2], wrung))

    def _rests(self, stands, force, couple):
        """Return whether a body that does not move is at rest; force along the plane's axes."""
        c = self._c
        if self._lies(stands.axes[2]):
            return bears(c, burden(c, stands, force, couple))
        return c.rolling > 0.0 and not self._is_disk and holds_still(c, stands, force, couple)

    def _lies(self, gamma):
        """Return whether the body is a ring that counts as flat once nothing moves.

        It then lies on a circle, or is jammed by dry friction: no force at one point holds it.
        """
        c = self._c
        if c.rolling > 0.0:
            return c.kind == TORUS and inclination(gamma) < LOW * (1.0 + 1e-6)
        return above_flat(c, gamma) < 1e-6 * inclination(gamma)

    def _patch_force(self, patch, u, spin, speed):
        """Return force (axes of the plane) and couple about the normal of a patch of contact."""
        mu, rho = self._c.mu, self._c.patch
        slip = hypot3(u[0], u[1], rho * spin)
        if slip <= PIVOTS * speed and spin != 0.0:
            # what a state tells of so small a slip is rounding; of a spin it is not
            friction, N = patch_pivoting(patch, mu, math.copysign(1.0, spin), (0.0, 0.0))
            if N > 0.0 > friction[2] * spin and self._is_balance(u, spin, speed, friction):
                return (friction[0], friction[1], N), rho * friction[2]
        if slip > TOUCHES * speed:
            d = u[0] / slip, u[1] / slip, rho * spin / slip
        else:
            friction, N = patch_sticking(patch)
            size = hypot3(*friction)
            if size <= mu * N:
                return (friction[0], friction[1], N), rho * friction[2]
            if not N > 0.0:
                return NOTHING, 0.0
            d, _ = patch_departure(patch, mu, scaled(-1.0 / size, friction))
        _, N, _ = patch_slipping(patch, mu, d)
        return (-mu * N * d[0], -mu * N * d[1], N), -mu * N * rho * d[2]

    def _is_balance(self, u, spin, speed, friction):
        """Return whether a slip is the one that Coulomb's law has for a friction, to rounding.

        A body that holds does not spin by more than rounding.
        """
        share = self._c.patch * spin / friction[2]
        off = hypot(u[0] - share * friction[0], u[1] - share * friction[1])
        return off <= TOUCHES * speed and (
            abs(spin) * self._c.size[0] > TOUCHES * speed)

    def _force(self, system, u, speed):
        """Return the force of the contact, axes of the plane."""
        mu, slip = self._c.mu, hypot(u[0], u[1])
        if slip > TOUCHES * speed and mu < 1e300:
            dx, dy = u[0] / slip, u[1] / slip
        else:
            f = sticking(system)
            size = hypot(f[0], f[1])
            if size <= mu * f[2]:
                return f
            if mu == 0.0 or not f[2] > 0.0:
                dx, dy = 1.0, 0.0
            else:
                dx, dy, _ = departure(system, mu, -f[0] / size, -f[1] / size)
        N = slipping(system, mu, dx, dy)[2]
        return -mu * N * dx, -mu * N * dy, N
