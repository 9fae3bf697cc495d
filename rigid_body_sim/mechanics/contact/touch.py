# SPDX-License-Identifier: Apache-2.0
"""The point of contact: its lever, how a force there moves it, and the couples of friction.

Symbols: laws.py. Rolling friction acts against the velocity s' at which the point of contact moves
over the surface of the body: with s' = S (gamma x omega), S symmetric, a force h against it is the
couple -(S h) x gamma on the body, and its power -h . s'. On a sphere of radius R this is the
couple -R |h| omega_t/|omega_t| that is usually called rolling friction.
"""

import math

from rigid_body_sim.compilation.jit import inlined
from rigid_body_sim.mechanics.contact.parameters import FILMY, FLAT, FLATTER, HELD
from rigid_body_sim.numerics.vectors import apply, cross, dot, plus, scaled
from rigid_body_sim.scene.surfaces import ELLIPSOID, TINY, TORUS, lowest, shifted, tilted


@inlined
def lever(c, gamma):
    """Return r, from the centre of mass to the lowest point, body axes."""
    return plus(c.middle, lowest(c.kind, c.size, gamma))


@inlined
def tilting(c, gamma):
    """Return r x gamma, body axes: the couple about the centre of mass over a normal force, m."""
    return plus(cross(c.middle, gamma), tilted(c.kind, c.size, gamma))


@inlined
def swept(c, gamma, omega):
    """Return omega x r + r', m/s: how the lowest point moves in space beside the centre of mass.

    The middle of a ball, or of the tube of a torus, stays above it: the rest of r is left out,
    since its two parts would leave their rounding.
    """
    core, turn = c.middle, cross(gamma, omega)
    if c.kind == ELLIPSOID:
        core = plus(core, lowest(c.kind, c.size, gamma))
        return plus(cross(omega, core), shifted(c.kind, c.size, gamma, turn))
    if c.kind == TORUS:
        ring = c.size[0], 0.0, 0.0
        core = plus(core, lowest(c.kind, ring, gamma))
        return plus(cross(omega, core), shifted(c.kind, ring, gamma, turn))
    return cross(omega, core)


@inlined
def inclination(gamma):
    """Return the angle between the axis of a ring, a torus or a disk, and the normal, rad.

    It is the sine of the angle, for small ones are asked for.
    """
    return math.sqrt(gamma[0] * gamma[0] + gamma[1] * gamma[1])


@inlined
def above_flat(c, gamma):
    """Return by how much a ring is inclined more than one that counts as flat, rad.

    A ring is a torus or a disk: it comes to lie on a circle, all of which touches the plane. For
    other surfaces it is 1.
    """
    if c.kind != TORUS:
        return 1.0
    return inclination(gamma) - (
        FILMY if c.film > 0.0 else FLAT if c.rolling + c.rolling_viscous > 0.0 else FLATTER)


@inlined
def gap_of(c, gap, gamma):
    """Return the gap below a body in flight from the unknown that stands for it, m.

    The lowest point of a ring that turns through flat jumps to its other side, and the rate of the
    gap with it. The gap that it would have if it were flat, with the same middle, is smooth.
    """
    return gap - c.size[0] * inclination(gamma) if c.level > 0.0 else gap


@inlined
def grips(c):
    """Return whether dry friction holds the rolling of a body, or its part along a ring."""
    return c.way == HELD or c.rim > 0.0


@inlined
def is_disk(c):
    """Return whether the surface is the sharp edge of a disk."""
    return c.kind == TORUS and c.size[1] == 0.0


@inlined
def tangent(gamma):
    """Return the unit vector along the rim of a ring at the lowest point, body axes."""
    across = inclination(gamma) + TINY
    return -gamma[1] / across, gamma[0] / across, 0.0


@inlined
def response(mass, inverse, axes, r, pressed):
    """Return the matrix of a System.

    Parameters
    ----------
    inverse : Matrix
        How a couple changes omega, body axes, 1/(kg m^2).
    pressed : Vector
        All couples that go with N, over N: r x e3 and those of friction, body axes, m.
    """
    (e1, e2, e3), lightness = axes, 1.0 / mass
    g1 = cross(apply(inverse, cross(r, e1)), r)
    g2 = cross(apply(inverse, cross(r, e2)), r)
    g3 = cross(apply(inverse, pressed), r)
    return ((lightness + dot(e1, g1), dot(e1, g2), dot(e1, g3)),
            (dot(e1, g2), lightness + dot(e2, g2), dot(e2, g3)),
            (dot(e3, g1), dot(e3, g2), lightness + dot(e3, g3)))


@inlined
def spinning(inverse, axes, r, torque, pressed):
    """Return arguments of `patch_system`: how forces and couples about the normal spin a body.

    `inverse` and `pressed` are those of `response`; `torque` is without that of the contact, body
    axes.
    """
    e1, e2, e3 = axes
    along = apply(inverse, e3)
    turned = (dot(along, cross(r, e1)), dot(along, cross(r, e2)),
              dot(along, pressed))
    return turned, apply(axes, cross(along, r)), (dot(along, torque), dot(along, e3))


@inlined
def couples(c, gamma, moved):
    """Return the couples of rolling friction and of the film of air, body axes.

    Parameters
    ----------
    moved : Vector
        s', m/s.

    Returns
    -------
    viscous, wrung : Vector
        N m; what goes with N is divided by it, m.
    speed, film : float
        |s'| (m/s), and the coefficient of the film of air (N s/m).
    """
    viscous, wrung = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    speed, film = math.sqrt(dot(moved, moved)), 0.0
    if c.rolling > 0.0 or c.rolling_viscous > 0.0 or c.film > 0.0:
        dual = cross(shifted(c.kind, c.size, gamma, moved), gamma)
        if c.film > 0.0:
            film = c.film / math.sqrt(gamma[0] * gamma[0] + gamma[1] * gamma[1])
        viscous = scaled(-(c.rolling_viscous + film), dual)
        if speed > 0.0:
            wrung = scaled(-c.rolling / speed, dual)
    return viscous, wrung, speed, film
