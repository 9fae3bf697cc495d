# SPDX-License-Identifier: Apache-2.0
"""The balance of forces of a body above, or in contact with, a plane at one instant."""

from rigid_body_sim.mechanics.contact.forces import (
    Posture,
    Push,
    holds_still,
    patch_of,
    system_of,
)
from rigid_body_sim.mechanics.contact.laws import (
    departure,
    patch_departure,
    patch_slipping,
    patch_sticking,
    slipping,
    sticking,
)
from rigid_body_sim.mechanics.contact.numbers import contact_parameters
from rigid_body_sim.mechanics.contact.parameters import CONTACT, LOW
from rigid_body_sim.mechanics.contact.touch import above_flat, couples, inclination, lever
from rigid_body_sim.numerics.functions import hypot, hypot3
from rigid_body_sim.numerics.rotations import rotate, rotate_back
from rigid_body_sim.numerics.vectors import apply, cross, dot, plus, scaled, transposed
from rigid_body_sim.scene.surfaces import TORUS, shifted

TOUCHES = 1e-11    # a gap, a slip, a speed below that share of lengths and speeds is rounding
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
        moved = shifted(c.kind, c.size, gamma, cross(gamma, omega))
        pressed = rotate_back(*c.plane, *force)[2] < 0.0
        stands = Posture(None, omega, axes, r, cross(omega, r), moved)
        if pressed and not any(omega) and not any(velocity) and (
                self._lies(gamma) or (c.rolling > 0.0 and not self._is_disk and holds_still(
                    c, stands, rotate_back(*c.plane, *force), couple))):
            force = scaled(-1.0, force)
            return force, scaled(-1.0, plus(couple, cross(r, apply(columns, force)))), r
        viscous, wrung, _, _ = couples(c, gamma, moved)
        torque = plus(plus(couple, viscous), scaled(-1.0, cross(omega, apply(c.inertia, omega))))
        push = Push(rotate_back(*c.plane, *force), torque, viscous, wrung)
        if c.patch > 0.0:
            f, twist = self._patch_force(patch_of(c, stands, push), u, dot(gamma, omega), speed)
            viscous = plus(viscous, scaled(twist, gamma))
        else:
            f = self._force(system_of(c, stands, push), u, speed)
        if not f[2] > 0.0:
            return NOTHING, NOTHING, r
        return rotate(*c.plane, *f), plus(viscous, scaled(f[2], wrung)), r

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
