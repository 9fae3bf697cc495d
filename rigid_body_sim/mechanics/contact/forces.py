# SPDX-License-Identifier: Apache-2.0
"""The force of the contact on a body that moves: the laws of laws.py at a given posture.

Symbols: laws.py. Forces and slips are along the axes of the plane, couples and levers along those
of the body.
"""

import math
from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled, inlined
from rigid_body_sim.compilation.layout import Matrix, Quaternion, Vector
from rigid_body_sim.mechanics.contact.laws import (
    System,
    departure,
    patch_sticking,
    patch_system,
    sticking,
)
from rigid_body_sim.mechanics.contact.touch import above_flat, lever, response, spinning
from rigid_body_sim.numerics.functions import hypot
from rigid_body_sim.numerics.rotations import matrix
from rigid_body_sim.numerics.vectors import apply, cross, dot, minus, plus, scaled
from rigid_body_sim.scene.surfaces import TORUS, shifted

SPINLESS = 1e-9    # share of the speeds below which a body that rests does not spin


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
    carried : Vector
        omega x r, m/s.
    moved : Vector
        r', the velocity at which the lowest point moves over the surface, m/s.
    """

    q: Quaternion
    omega: Vector
    axes: Matrix
    r: Vector
    carried: Vector
    moved: Vector


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
    r = lever(c, gamma)
    return Posture(q, omega, axes, r, cross(omega, r),
                   shifted(c.kind, c.size, gamma, cross(gamma, omega)))


@inlined
def along_body(axes, f):
    """Return a vector along the axes of the plane as one along those of the body."""
    return plus(scaled(f[0], axes[0]), plus(scaled(f[1], axes[1]), scaled(f[2], axes[2])))


@inlined
def wrung_by(push, wrung):
    """Return a Push whose couple that goes with N is another."""
    return Push(push.force, push.torque, push.viscous, wrung)


@inlined
def driven(c, at, push):
    """Return b of the System."""
    b = plus(cross(apply(c.inverse, push.torque), at.r),
             plus(cross(at.omega, at.carried), cross(at.omega, at.moved)))
    return plus(apply(at.axes, b), scaled(1.0 / c.mass, push.force))


@inlined
def system_of(c, at, push):
    """Return the System."""
    return System(response(c, at.axes, at.r, push.wrung), driven(c, at, push))


@inlined
def patch_of(c, at, push):
    """Return the Patch of a body with a patch of contact."""
    turned, twisted, spun = spinning(c, at.axes, at.r, push.torque, push.wrung)
    return patch_system(system_of(c, at, push), turned, twisted, spun, c.patch)


@inlined
def rolling_force(c, at, push):
    """Return the force on a body that rolls without a couple that goes with N.

    With a = A - omega' x r the acceleration of the centre of mass, A = -omega x (omega x r + s'),
    and f = m a - F, the balance of torques is (I + m r^2 1 - m r r^T) omega' = torque + r x (m A -
    F).
    """
    r = at.r
    A = scaled(-1.0, cross(at.omega, plus(at.carried, at.moved)))
    net = minus(scaled(c.mass, A), along_body(at.axes, push.force))
    x, y, z = plus(push.torque, cross(r, net))
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
    return apply(at.axes, minus(net, scaled(c.mass, cross(grown, r))))


@inlined
def slipping_force(c, at, push, mu, dx, dy):
    """Return (f, u', A) of a slip along d (laws.slipping, for one force)."""
    e1, e2, e3 = at.axes
    b = driven(c, at, push)
    pressed = minus(e3, plus(scaled(mu * dx, e1), scaled(mu * dy, e2)))
    moved = plus(scaled(1.0 / c.mass, pressed),
                 cross(apply(c.inverse, plus(cross(at.r, pressed), push.wrung)), at.r))
    A = dot(e3, moved)
    N = -b[2] / A
    return ((-mu * N * dx, -mu * N * dy, N),
            (b[0] + N * dot(e1, moved), b[1] + N * dot(e2, moved), 0.0), A)


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


@compiled
def holds_still(c, at, F, T):
    """Return whether a body that has almost stopped is at rest: a flat ring, or dry friction.

    Dry rolling friction holds the couple -(S h) x n of a force |h| <= C N, Coulomb's friction the
    force that balances the others. A spin about the normal is not held.

    Parameters
    ----------
    F, T : Vector
        What acts on the resting body: force (axes of the plane), couple (body axes).
    """
    e1, e2, gamma = at.axes
    if c.kind == TORUS and (c.size[1] == 0.0 or above_flat(c, gamma) <= 0.0):
        return True
    held = scaled(-1.0, F)
    if not held[2] > 0.0 or hypot(held[0], held[1]) > c.mu * held[2]:
        return False
    far = math.sqrt(dot(at.r, at.r))
    if abs(dot(at.omega, gamma)) * far > SPINLESS * c.swift:
        return False
    couple = scaled(-1.0, plus(T, cross(at.r, along_body(at.axes, held))))
    if abs(dot(couple, gamma)) > 1e-12 * held[2] * far:
        return False
    wanted = scaled(-1.0, cross(gamma, couple))    # S h
    first, second = shifted(c.kind, c.size, gamma, e1), shifted(c.kind, c.size, gamma, e2)
    a, b, d = dot(e1, first), dot(e1, second), dot(e2, second)
    x, z = dot(wanted, e1), dot(wanted, e2)
    share = 1.0 / (a * d - b * b)
    return hypot(share * (d * x - b * z), share * (a * z - b * x)) <= c.rolling * held[2]
