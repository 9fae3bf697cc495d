# SPDX-License-Identifier: Apache-2.0
"""Template: what acts on a convex body on a plane besides its contact, now and a moment later.

It is bound to the sum of what acts, and to whether dry rolling friction may hold the body. All
vectors are along the axes of the plane, but omega and couples are along those of the body.
"""

from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.compilation.layout import Vector
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.equations.contact_views import FLIGHT
from rigid_body_sim.mechanics.contact.forces import Push, posture, torque_of
from rigid_body_sim.mechanics.contact.holding import gripped, rolling_couples, way_at
from rigid_body_sim.mechanics.contact.touch import couples, gap_of, grips
from rigid_body_sim.numerics.rotations import multiply, normalised, rotate, rotate_back
from rigid_body_sim.numerics.vectors import apply, cross, dot, minus, plus, scaled

# (p, q, omega, v of the centre of mass, time and place of it) -> force (world), couple (body),
# power of work and heat, and the part of the couple from within the body
applied = UNBOUND
# a line HOLDS = True for a scene with dry rolling friction, else HOLDS = False
HOLDS = UNBOUND


class Applied(NamedTuple):
    """What acts besides the contact.

    Attributes
    ----------
    force : Vector
        Axes of the plane, N.
    couple, inner : Vector
        About the centre of mass, body axes, N m, and its part against parts inside the body.
    work, heat : float
        Powers, W.
    """

    force: Vector
    couple: Vector
    work: float
    heat: float
    inner: Vector


@compiled_inline
def applied_at(p, c, now, at, omega, v, ahead):
    """Return the Applied at an attitude, with velocities, a time `ahead` (s) of the unknowns."""
    time = c.began + now.time + ahead
    # the height is that of the attitude: the gap less r . n
    gap = gap_of(c, now.gap, at.axes[2]) if c.mode == FLIGHT else 0.0
    height = gap - dot(at.axes[2], at.r)
    place = (c.origin[0] + now.place[0] + ahead * v[0],
             c.origin[1] + now.place[1] + ahead * v[1], height)
    if c.inclined == 0.0:
        fx, fy, fz, tx, ty, tz, work, heat, ix, iy, iz = applied(
            p, *at.q, *omega, *v, time, *place)
        return Applied((fx, fy, fz), (tx, ty, tz), work, heat, (ix, iy, iz))
    fx, fy, fz, tx, ty, tz, work, heat, ix, iy, iz = applied(
        p, *multiply(*c.plane, *at.q), *omega, *rotate(*c.plane, *v), time,
        *rotate(*c.plane, *place))
    return Applied(rotate_back(*c.plane, fx, fy, fz), (tx, ty, tz), work, heat, (ix, iy, iz))


@compiled_inline
def posture_at(c, q, omega):
    """Return the Posture, of a body whose rolling friction may hold."""
    at = posture(c, q, omega)
    if HOLDS and grips(c):
        at = gripped(c, at)
    return at


@compiled_inline
def couples_at(c, at, time):
    """Return the couples of rolling friction, as touch.couples does."""
    return rolling_couples(c, at, way_at(c, time)) if HOLDS else couples(c, at.axes[2], at.moved)


@compiled_inline
def hastened(c, at, torque):
    """Return omega' under a couple about the centre of mass, body axes, rad/s^2."""
    grown = apply(at.inverse, torque)
    if HOLDS and grips(c):
        grown = plus(grown, at.shift)
    return grown


@compiled
def posture_after(p, c, now, at, f, touch, slip, since, short):
    """Return the Posture a short time later under a force and a couple of the contact.

    More than eight arguments: those of a rate, and what the contact does in the meantime.

    Parameters
    ----------
    slip : Vector
        The velocity of the lowest point that counts, m/s.
    since, short : float
        The time of the Posture after that of the unknowns, and by how much later, s.
    """
    acts = applied_at(p, c, now, at, at.omega, minus(slip, apply(at.axes, at.carried)), since)
    torque = plus(plus(acts.couple, touch), torque_of(at, f))
    grown = hastened(c, at, minus(torque, cross(at.omega, apply(c.uneven, at.omega))))
    x, y, z, w = multiply(*at.q, *at.omega, 0.0)
    half = 0.5 * short
    q = normalised(at.q[0] + half * x, at.q[1] + half * y, at.q[2] + half * z,
                   at.q[3] + half * w)
    return posture_at(c, q, plus(at.omega, scaled(short, grown)))


@compiled
def push_on(p, c, now, at, slip, since):
    """Return the Push on a Posture, a time after that of the unknowns.

    `slip` and `since` are those of `posture_after`.
    """
    acts = applied_at(p, c, now, at, at.omega, minus(slip, apply(at.axes, at.carried)), since)
    viscous, wrung, _, _ = couples_at(c, at, now.time + since)
    torque = minus(plus(acts.couple, viscous), cross(at.omega, apply(c.uneven, at.omega)))
    return Push(acts.force, torque, viscous, wrung)
