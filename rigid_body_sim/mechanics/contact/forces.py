# SPDX-License-Identifier: Apache-2.0
"""The force of the contact on a body that moves: the laws of laws.py at a given posture.

Symbols: laws.py. Forces and slips are along the axes of the plane, couples and levers along those
of the body.
"""

import math
from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled, inlined
from rigid_body_sim.compilation.layout import Matrix, Quaternion, Vector
from rigid_body_sim.mechanics.contact.laws import System, departure, sticking
from rigid_body_sim.mechanics.contact.patch import patch_sticking, patch_system
from rigid_body_sim.mechanics.contact.touch import grips, lever, response, spinning, swept, tilting
from rigid_body_sim.numerics.functions import hypot
from rigid_body_sim.numerics.rotations import matrix
from rigid_body_sim.numerics.vectors import apply, cross, dot, minus, plus, scaled
from rigid_body_sim.scene.surfaces import shifted


class Posture(NamedTuple):
    """How a body stands above the plane, and how it moves.

    Attributes
    ----------
    q : Quaternion
        Body -> plane.
    omega : Vector
        Body axes, rad/s.
    axes : Matrix
        e1, e2, e3 along the axes of the body.
    r : Vector
        From the centre of mass to the lowest point, m.
    tilting : Vector
        r x e3, of which the part of r along e3 has been left out, not rounded off, m.
    carried : Vector
        omega x r, m/s.
    moved : Vector
        r', the velocity at which the lowest point moves over the surface, m/s.
    drawn : Vector
        u' without forces and couples, m/s^2.
    inverse : Matrix
        How a couple changes omega, I^-1; less if friction holds the rolling, 1/(kg m^2).
    shift : Vector
        omega' without a couple, where friction holds the rolling, rad/s^2.
    """

    q: Quaternion
    omega: Vector
    axes: Matrix
    r: Vector
    tilting: Vector
    carried: Vector
    moved: Vector
    drawn: Vector
    inverse: Matrix
    shift: Vector


class Push(NamedTuple):
    """The sum of everything that acts on a body besides the force at its lowest point.

    Attributes
    ----------
    force : Vector
        N.
    torque : Vector
        With the gyroscopic one and `viscous`, N m.
    viscous : Vector
        The part of the couples of the contact that does not go with N, N m.
    wrung : Vector
        The part that does, over N, m.
    """

    force: Vector
    torque: Vector
    viscous: Vector
    wrung: Vector


@inlined
def posture(c, q, omega):
    """Return the Posture of a body with an attitude and an angular velocity."""
    axes = matrix(*q)
    gamma = axes[2]
    return standing(c, q, omega, axes, lever(c, gamma))


@inlined
def standing(c, q, omega, axes, r):
    """Return the Posture of a body whose lowest point is at r."""
    carried = cross(omega, r)
    moved = shifted(c.kind, c.size, axes[2], cross(axes[2], omega))
    drawn = cross(omega, swept(c, axes[2], omega))
    return Posture(q, omega, axes, r, tilting(c, axes[2]), carried, moved, drawn, c.inverse,
                   (0.0, 0.0, 0.0))


@inlined
def along_body(axes, f):
    """Return a vector along the axes of the plane as one along those of the body."""
    return plus(scaled(f[0], axes[0]), plus(scaled(f[1], axes[1]), scaled(f[2], axes[2])))


@inlined
def torque_of(at, f):
    """Return the couple about the centre of mass, body axes, of a force f at the lowest point.

    The force is along the axes of the plane.
    """
    e1, e2, _ = at.axes
    return plus(cross(at.r, plus(scaled(f[0], e1), scaled(f[1], e2))), scaled(f[2], at.tilting))


@inlined
def wrung_by(push, wrung):
    """Return a Push whose couple that goes with N is another."""
    return Push(push.force, push.torque, push.viscous, wrung)


@inlined
def driven(c, at, push):
    """Return b of the System."""
    b = plus(cross(apply(at.inverse, push.torque), at.r), at.drawn)
    return plus(apply(at.axes, b), scaled(1.0 / c.mass, push.force))


@inlined
def system_of(c, at, push):
    """Return the System."""
    pressed = plus(at.tilting, push.wrung)
    return System(response(c.mass, at.inverse, at.axes, at.r, pressed), driven(c, at, push))


@inlined
def patch_of(c, at, push):
    """Return the Patch of a body with a patch of contact."""
    turned, twisted, spun = spinning(at.inverse, at.axes, at.r, push.torque,
                                     plus(at.tilting, push.wrung))
    if grips(c):
        spun = spun[0] + dot(at.axes[2], at.shift), spun[1]
    return patch_system(system_of(c, at, push), turned, twisted, spun, c.patch)


@inlined
def rolling_force(c, at, push):
    """Return the force on a body that rolls without a couple that goes with N.

    With a = A - omega' x r the acceleration of the centre of mass, A = -omega x (omega x r + s'),
    and f = m a - F, the balance of torques is (I + m r^2 1 - m r r^T) omega' = torque + r x (m A -
    F).
    """
    r = at.r
    net = scaled(-c.mass, at.drawn)    # m A
    x, y, z = minus(plus(push.torque, cross(r, net)), torque_of(at, push.force))
    square = c.mass * dot(r, r)
    (a, b, d), (_, e, g), (_, _, h) = c.inertia
    mx, my, mz = scaled(c.mass, r)
    a, e, h = a + square - mx * r[0], e + square - my * r[1], h + square - mz * r[2]
    b, d, g = b - mx * r[1], d - mx * r[2], g - my * r[2]
    # cofactors of the symmetric matrix
    aa, bb, dd = e * h - g * g, d * g - b * h, b * g - d * e
    ee, gg, hh = a * h - d * d, b * d - a * g, a * e - b * b
    share = 1.0 / (a * aa + b * bb + d * dd)
    grown = (share * (aa * x + bb * y + dd * z), share * (bb * x + ee * y + gg * z),
             share * (dd * x + gg * y + hh * z))
    return minus(apply(at.axes, minus(net, scaled(c.mass, cross(grown, r)))), push.force)


@inlined
def slipping_force(c, at, push, mu, dx, dy):
    """Return (f, u', A) of a slip along d (laws.slipping, for one force)."""
    b, lightness, unit = driven(c, at, push), 1.0 / c.mass, (-mu * dx, -mu * dy, 1.0)
    couple = plus(torque_of(at, unit), push.wrung)
    moved = plus(scaled(lightness, unit), apply(at.axes, cross(apply(at.inverse, couple), at.r)))
    N = -b[2] / moved[2]
    return ((N * unit[0], N * unit[1], N), (b[0] + N * moved[0], b[1] + N * moved[1], 0.0),
            moved[2])


@compiled
def held(c, at, push):
    """Return force, couple about the normal and grip of a patch of contact that holds."""
    friction, N = patch_sticking(patch_of(c, at, push))
    return ((friction[0], friction[1], N), c.patch * friction[2],
            c.mu * N - math.sqrt(dot(friction, friction)))


@compiled
def leaving(system, mu):
    """Return the direction along which slip leaves a contact that no longer holds."""
    stuck = sticking(system)
    size = hypot(stuck[0], stuck[1])
    guess = (-stuck[0] / size, -stuck[1] / size) if size > 0.0 else (1.0, 0.0)
    dx, dy, _ = departure(system, mu, *guess)
    return dx, dy
