# SPDX-License-Identifier: Apache-2.0
"""Dry rolling friction that holds: the point of contact stays where it is on the body.

Symbols: laws.py, touch.py. A body whose s' is 0 turns about the normal only, and omega' is along
it. A disk falls, too, for its point of contact moves along the rim only: with the tangent e of the
rim and b = e x n, s' is along e and 0 for b . omega = 0, and it stays 0 as long as b . omega' =
-(e . omega) (n . omega). Friction does this by the couple -(S h) x n of a force h, without power,
as long as |h| <= C N.

A torus rolls along its ring, with the part s_e of s' along e, and about its tube, with the part
s_b along b. At a small inclination a the lever of h_e is R/a, for the radius R of the ring:
friction stops s_e in a time that falls like a^2, and s_e : s_b = h_e : h_b from then on. As long
as a h_e/(C N) is negligible, s_e = 0 is the motion of a disk that is held, with friction C N
against s_b (ContactParameters: rim).
"""

import math
from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled, inlined
from rigid_body_sim.compilation.layout import Vector
from rigid_body_sim.mechanics.contact.forces import Posture, along_body, torque_of
from rigid_body_sim.mechanics.contact.parameters import HELD, SLOW
from rigid_body_sim.mechanics.contact.touch import (
    above_flat,
    couples,
    inclination,
    is_disk,
    tangent,
)
from rigid_body_sim.numerics.functions import hypot
from rigid_body_sim.numerics.vectors import apply, cross, dot, minus, plus, scaled
from rigid_body_sim.scene.surfaces import TINY, TORUS, shifted

SPINLESS = 1e-9   # share of the speeds below which a body that rests does not spin
NEWTON = 50       # most Newton steps for a direction
NEAR = 1e-6       # rad: angle of a finite difference
CLOSE = 1e-9      # rad: a step that short is the last


@inlined
def across_rim(gamma):
    """Return b of a disk, body axes."""
    return cross(tangent(gamma), gamma)


@inlined
def tips(c, at):
    """Return s_b, the velocity at which the point of contact of a torus moves about its tube."""
    gamma = at.axes[2]
    return -c.size[1] * dot(across_rim(gamma), cross(gamma, at.omega))


@inlined
def gripped(c, at):
    """Return the Posture of a body whose point of contact friction holds where it is on it.

    That of a torus that tips still moves about the tube.
    """
    gamma, inverse, shift = at.axes[2], c.inverse, (0.0, 0.0, 0.0)
    moved, drawn = at.moved, at.drawn
    if c.rim > 0.0:
        moved = scaled(tips(c, at), across_rim(gamma))
        drawn = plus(cross(at.omega, at.carried), cross(at.omega, moved))
    if is_disk(c) or c.rim > 0.0:
        b = across_rim(gamma)
        turned = apply(c.inverse, b)
        share = 1.0 / (dot(b, turned) + TINY)    # b is 0 where a disk lies flat
        rows = c.inverse
        inverse = (minus(rows[0], scaled(share * turned[0], turned)),
                   minus(rows[1], scaled(share * turned[1], turned)),
                   minus(rows[2], scaled(share * turned[2], turned)))
        shift = scaled(-share * dot(tangent(gamma), at.omega) * dot(gamma, at.omega), turned)
    else:
        share = 1.0 / dot(gamma, apply(c.inertia, gamma))
        inverse = (scaled(share * gamma[0], gamma), scaled(share * gamma[1], gamma),
                   scaled(share * gamma[2], gamma))
    return Posture(at.q, at.omega, at.axes, at.r, at.tilting, at.carried, moved,
                   plus(drawn, cross(shift, at.r)), inverse, shift)


@inlined
def gripping(c, at, torque, grown):
    """Return the couple by which friction holds the point of contact, and its force.

    Parameters
    ----------
    torque : Vector
        All other couples about the centre of mass, with the gyroscopic one, body axes, N m.
    grown : Vector
        omega', rad/s^2.

    Returns
    -------
    couple : Vector
        Body axes, N m.
    force : Pair
        As `against` returns it, N.
    """
    couple = minus(apply(c.inertia, grown), torque)
    return couple, against(c, at, couple)


@inlined
def against(c, at, couple):
    """Return h along the plane, N, whose friction is a couple -(S h) x n.

    Of a disk, and of a torus that tips, it is h . e and 0.
    """
    e1, e2, gamma = at.axes
    if is_disk(c) or c.rim > 0.0:
        return dot(across_rim(gamma), couple) * inclination(gamma) / c.size[0], 0.0
    wanted = scaled(-1.0, cross(gamma, couple))    # S h
    first, second = shifted(c.kind, c.size, gamma, e1), shifted(c.kind, c.size, gamma, e2)
    a, b, d = dot(e1, first), dot(e1, second), dot(e2, second)
    x, z = dot(wanted, e1), dot(wanted, e2)
    share = 1.0 / (a * d - b * b)
    return share * (d * x - b * z), share * (a * z - b * x)


@inlined
def way_at(c, time):
    """Return the direction in which a body begins to roll, at a time of the unknowns, s."""
    if not c.onset > 0.0:
        return c.way
    angle = c.turn * (time - c.since)
    size = hypot(1.0, angle)
    return (c.way[0] - angle * c.way[1]) / size, (c.way[1] + angle * c.way[0]) / size


@inlined
def rolling_couples(c, at, way):
    """Return what `couples` (touch.py) does, under dry friction that may hold.

    Friction goes by the way of the phase (`way_at`) in a rolling that has just begun, and for a
    disk: the sign of its velocity may change within a step. Where s' counts as none, friction is
    in proportion to it, so that a step may pass the end of the rolling.
    """
    viscous, wrung, speed, film = couples(c, at.axes[2], at.moved)
    if c.way == HELD:
        return viscous, (0.0, 0.0, 0.0), 0.0, film    # what is left of s' takes no power
    if c.rim > 0.0:
        gamma = at.axes[2]
        about = scaled(-c.size[1], cross(across_rim(gamma), gamma))
        return (scaled(-(c.rolling_viscous + film) * tips(c, at), about),
                scaled(-c.rolling * way[0], about), abs(tips(c, at)), film)
    if is_disk(c) or c.onset > 0.0:
        e1, e2, gamma = at.axes
        along = tangent(gamma)
        ahead = scaled(way[0], along) if is_disk(c) else plus(scaled(way[0], e1),
                                                              scaled(way[1], e2))
        wrung = scaled(-c.rolling, cross(shifted(c.kind, c.size, gamma, ahead), gamma))
    elif speed < SLOW * c.swift:
        wrung = scaled(speed / (SLOW * c.swift), wrung)
    return viscous, wrung, speed, film


@inlined
def along_way(c, at, way, speed):
    """Return the part of the velocity s' against which dry friction acts, m/s."""
    if not c.onset > 0.0:
        return speed
    return way[0] * dot(at.axes[0], at.moved) + way[1] * dot(at.axes[1], at.moved)


@inlined
def growing(c, at, grown):
    """Return how s' grows along the plane where it is 0, under omega', m/s^2."""
    e1, e2, gamma = at.axes
    growth = shifted(c.kind, c.size, gamma, cross(gamma, grown))
    return dot(e1, growth), dot(e2, growth)


class Burden(NamedTuple):
    """What a plane has to give a ring that lies flat on a circle, so that it rests.

    Attributes
    ----------
    tilting : Vector
        Couple about the middle of the circle, along the plane, body axes, N m.
    spinning : float
        And along the normal, N m.
    along, normal : float
        Force along the plane and along the normal, N.
    """

    tilting: Vector
    spinning: float
    along: float
    normal: float


@inlined
def burden(c, at, F, T):
    """Return the Burden under a force F (axes of the plane) and a couple T (body axes)."""
    gamma, share = at.axes[2], 1.0 if c.mu > 0.0 else 0.0
    held = -share * F[0], -share * F[1], -F[2]
    foot = minus(c.middle, scaled(c.size[1], gamma))
    couple = scaled(-1.0, plus(T, cross(foot, along_body(at.axes, held))))
    spinning = dot(gamma, couple)
    return Burden(minus(couple, scaled(spinning, gamma)), spinning, hypot(F[0], F[1]), -F[2])


@inlined
def bears(c, load):
    """Return whether pressure on the circle and friction can bear a Burden.

    No pressure bears a couple beyond N R, which acts beyond the circle. Friction gives |f| <= mu N
    alone and |M| <= mu N R alone, and both together at least where the sum of the shares is below
    1.
    """
    tilting = math.sqrt(dot(load.tilting, load.tilting))
    needed = load.along + abs(load.spinning) / c.size[0]
    return load.normal > 0.0 and tilting <= c.size[0] * load.normal and (
        needed <= c.mu * load.normal)


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
    gamma = at.axes[2]
    if c.kind == TORUS and above_flat(c, gamma) <= 0.0:
        return bears(c, burden(c, at, F, T))
    held = scaled(-1.0, F)
    if not held[2] > 0.0 or hypot(held[0], held[1]) > c.mu * held[2]:
        return False
    far = math.sqrt(dot(at.r, at.r))
    if abs(dot(at.omega, gamma)) * far > SPINLESS * c.swift:
        return False
    couple = scaled(-1.0, plus(T, torque_of(at, held)))
    if abs(dot(couple, gamma)) > 1e-12 * held[2] * far:
        return False
    return hypot(*against(c, at, couple)) <= c.rolling * held[2]


def way_out(growth, x, z):
    """Return the direction in which a body that friction no longer holds begins to roll.

    It is that of the growth of s' under the friction against it, by Newton's method.

    Parameters
    ----------
    growth : callable
        (x, z) -> how s' grows along the plane under friction against a direction, in any unit.
    x, z : float
        A first guess: the force that would hold the body.
    """
    size = hypot(x, z)
    if size == 0.0:
        return 1.0, 0.0    # nothing holds a body that the plane does not carry
    x, z = x / size, z / size
    for _ in range(NEWTON):
        a, b = growth(x, z)
        across = x * b - z * a
        ex, ez = x - NEAR * z, z + NEAR * x
        a, b = growth(ex, ez)
        slope = (ex * b - ez * a - across) / NEAR
        step = max(-0.5, min(0.5, -across / slope)) if slope != 0.0 else 0.0
        x, z = x - step * z, z + step * x
        size = hypot(x, z)
        x, z = x / size, z / size
        if abs(step) < CLOSE:
            break
    return x, z
