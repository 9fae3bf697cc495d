# SPDX-License-Identifier: Apache-2.0
"""The end of the motion of a convex body on a plane: it jams, halts, rolls back, or is held.

Symbols: mechanics/contact/laws.py; the views are in contact_views.py.
"""

import math

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.integrators.equations.contact_views import (
    GLIDING,
    LEDGER,
    ROLLING,
    ROW,
    SLIDING,
    UNKNOWNS,
)
from rigid_body_sim.mechanics.contact.forces import along_body, posture
from rigid_body_sim.mechanics.contact.holding import across_rim, against, growing, tips
from rigid_body_sim.mechanics.contact.parameters import CONTACT, LOW
from rigid_body_sim.mechanics.contact.touch import (
    above_flat,
    inclination,
    is_disk,
    tangent,
)
from rigid_body_sim.numerics.functions import hypot
from rigid_body_sim.numerics.rotations import matrix, multiply, normalised
from rigid_body_sim.numerics.vectors import apply, cross, dot, minus, plus, scaled
from rigid_body_sim.scene.surfaces import TORUS

TIPPED = 2.0 ** -56    # rad: the inclination of a ring that has lain flat and begins to tip
LEVEL = 2.0 ** -49     # rad: the inclination of one that lies flat but for rounding
IDEAL = 1e300          # a larger mu is infinite
ZERO = (0.0, 0.0, 0.0)

load_contact, load_unknowns = CONTACT.load, UNKNOWNS.load
load_couple = ROW.part('couple').load
load_omega = UNKNOWNS.part('omega').load
store_q = UNKNOWNS.part('q').store
store_omega, store_u = UNKNOWNS.part('omega').store, UNKNOWNS.part('u').store
PACE = ROW.part('pace').first
store_impulse, STRUCK = LEDGER.part('impulse').store, LEDGER.part('struck').first


@compiled
def spins(p, y):
    """Return the velocity rho w at which a patch of contact spins on the plane, m/s."""
    c, now = load_contact(p), load_unknowns(y)
    return c.patch * dot(matrix(*now.q)[2], now.omega)


@compiled
def hastens(row, y):
    """Return the rate of the spin about the normal, rad/s^2; `row` holds the rates."""
    return dot(matrix(*load_unknowns(y).q)[2], load_omega(row))


@compiled
def grip_patch(p, y):
    """Take what is left of the spin of a patch of contact whose slip has died.

    Friction takes it, and its angular impulse is in the ledger.
    """
    c, now = load_contact(p), load_unknowns(y)
    if c.patch == 0.0:
        return
    axes = matrix(*now.q)
    change = scaled(-dot(axes[2], now.omega), axes[2])
    store_impulse(y, plus(now.ledger.impulse, apply(axes, apply(c.inertia, change))))
    store_omega(y, plus(now.omega, change))


@compiled
def lies_low(p, y):
    """Return whether a body is a ring that is almost flat."""
    c, now = load_contact(p), load_unknowns(y)
    return c.kind == TORUS and inclination(matrix(*now.q)[2]) < LOW


@compiled
def rise(p, y):
    """Return by how much a ring that lay flat on its lowest point would be higher, m.

    That is the unknown gap of a `level` flight less the gap (mechanics/contact/touch.py).
    """
    c, now = load_contact(p), load_unknowns(y)
    return c.size[0] * inclination(matrix(*now.q)[2])


@compiled
def jams(p, y):
    """Return whether a ring lies so low that rolling friction leaves it no motion."""
    c = load_contact(p)
    return c.rolling + c.rolling_viscous + c.film > 0.0 and lies_low(p, y)


@compiled
def halt(p, y):
    """Stop a body that rests, and lower a disk to the plane."""
    c, now = load_contact(p), load_unknowns(y)
    at = posture(c, now.q, now.omega)
    v = apply(at.axes, cross(at.r, now.omega))
    if c.mode != ROLLING:
        v = plus(v, (now.u[0], now.u[1], 0.0))
    momentum = apply(c.inertia, now.omega)
    y[STRUCK] += 0.5 * (dot(momentum, now.omega) + c.mass * dot(v, v))
    store_impulse(y, minus(now.ledger.impulse, apply(at.axes, momentum)))
    store_omega(y, ZERO)
    store_u(y, ZERO)


@compiled
def lies(p, y):
    """Return whether a body is a ring that lies flat."""
    c, now = load_contact(p), load_unknowns(y)
    return c.kind == TORUS and above_flat(c, matrix(*now.q)[2]) <= 0.0


@compiled_inline
def _tips(gamma, omega, slow):
    """Return whether a ring that lies flat tips; `slow` as in `tip`.

    A strike about the normal gives a ring that is a little inclined a part across its axis, too,
    which is up to twice as large as that of the normal: I_3 <= 2 I_1.
    """
    return hypot(omega[0], omega[1]) > slow + 4.0 * abs(omega[2]) * inclination(gamma)


@compiled_inline
def _level(q, gamma):
    """Return the attitude of a ring that lies level beside an almost flat one."""
    return (normalised(0.0, 0.0, q[2], q[3]) if gamma[2] > 0.0
            else normalised(q[0], q[1], 0.0, 0.0))


@compiled_inline
def _incline(y, level, time, rate):
    """Incline a ring from a level attitude by a turn for a time (s) at a rate (body, rad/s)."""
    half = 0.5 * time
    store_q(y, normalised(*multiply(*level, half * rate[0], half * rate[1], 0.0, 1.0)))


@compiled
def topple(y, way):
    """Incline a ring that lies flat and rests the way in which a couple begins to tip it.

    Parameters
    ----------
    way : tuple of 2 floats
        How omega grows, body axes, in any unit.
    """
    now = load_unknowns(y)
    gamma = matrix(*now.q)[2]
    inclined = max(inclination(gamma), TIPPED)
    _incline(y, _level(now.q, gamma), inclined / hypot(way[0], way[1]), way)


@compiled
def tip(p, y, slow):
    """Incline a ring that lies flat the way in which it begins to tip, or level one that does not.

    All of the ring touches the plane, and its lowest point is the one that goes down first: with
    the axis of the ring turning at omega, gamma' = gamma x omega.

    Parameters
    ----------
    slow : float
        Rate below which the ring does not tip, rad/s.

    Returns
    -------
    bool
        Whether it lies flat and tips.
    """
    c, now = load_contact(p), load_unknowns(y)
    gamma, rate = matrix(*now.q)[2], hypot(now.omega[0], now.omega[1])
    if c.kind != TORUS or above_flat(c, gamma) > 0.0:
        return False
    level = _level(now.q, gamma)
    inclined, momentum = inclination(gamma), apply(c.inertia, now.omega)
    if not _tips(gamma, now.omega, slow):
        spin = now.omega[2] if abs(now.omega[2]) > slow else 0.0
        store_omega(y, (0.0, 0.0, spin))
        if inclined <= LEVEL:
            store_q(y, level)
        return False
    inclined = max(inclined, TIPPED)
    # the spin turns the axis of the ring, too
    off = max(-1.0, min(1.0, -inclined * now.omega[2] / rate))
    on = math.sqrt(1.0 - off * off)
    _incline(y, level, inclined / rate, (on * now.omega[0] - off * now.omega[1],
                                         off * now.omega[0] + on * now.omega[1]))
    # the plane gives what the momentum turns with the body
    turned = minus(apply(matrix(*load_unknowns(y).q), momentum), apply(matrix(*now.q), momentum))
    store_impulse(y, plus(now.ledger.impulse, turned))
    return True


@compiled
def lies_level(p, y, slow):
    """Return whether a body is a ring that lies flat and does not tip; `slow` as in `tip`."""
    return lies(p, y) and not _tips(matrix(*load_unknowns(y).q)[2], load_unknowns(y).omega, slow)


@compiled
def is_clamped(p, y, velocity, rounding):
    """Return whether ideal friction holds a disk that lies flat by all of its rim.

    It is what friction does to a flat disk as mu grows: the disk stops at once. One whose centre
    of mass is above its rim would tip.

    Parameters
    ----------
    velocity : tuple of 3 floats
        Of its lowest point, along the axes of the plane, m/s.
    rounding : float
        Of a velocity, m/s.
    """
    c, now = load_contact(p), load_unknowns(y)
    gamma = matrix(*now.q)[2]
    return (c.mu > IDEAL and is_disk(c) and c.middle[2] == 0.0
            and lies_level(p, y, rounding / c.size[0])
            and abs(velocity[2]) <= rounding + inclination(gamma) * hypot(velocity[0],
                                                                          velocity[1]))


@compiled
def lay(p, y, N):
    """Lay a ring that lies flat down on the plane, which bears it with N; the loss is in the heat.

    What slides on its face has its lowest point below the middle of the ring.
    """
    c, now = load_contact(p), load_unknowns(y)
    gamma = matrix(*now.q)[2]
    if inclination(gamma) <= LEVEL:
        return
    y[STRUCK] += N * c.size[0] * inclination(gamma)
    store_q(y, _level(now.q, gamma))


@compiled
def comes_down(p, y, row):
    """Return whether a ring that lies flat and tips is inclined by no more than counts as flat.

    It comes down at once. `row` holds the rates.
    """
    c, now = load_contact(p), load_unknowns(y)
    flat = above_flat(c, matrix(*now.q)[2])
    if flat > 0.0:
        return False
    rate, grown = hypot(now.omega[0], now.omega[1]), load_omega(row)
    pace = row[PACE] if c.mode == SLIDING else 1.0
    slows = -(now.omega[0] * grown[0] + now.omega[1] * grown[1]) / (rate * pace)
    return rate * rate < -2.0 * flat * slows


@compiled
def tipping(p, y):
    """Return how a low torus rolls: about its tube (m/s), and its axis along the ring (rad/s)."""
    c, now = load_contact(p), load_unknowns(y)
    at = posture(c, now.q, now.omega)
    return tips(c, at), dot(across_rim(at.axes[2]), now.omega)


@compiled
def about_tube(p, y, x, z):
    """Return the part about the tube of a torus of a vector (x, z) along the plane."""
    axes = matrix(*load_unknowns(y).q)
    b = across_rim(axes[2])
    return x * dot(axes[0], b) + z * dot(axes[1], b)


@compiled
def rolls(p, y):
    """Return the velocity of the lowest point over the body, m/s: of a disk along its rim."""
    c, now = load_contact(p), load_unknowns(y)
    at = posture(c, now.q, now.omega)
    speed = math.sqrt(dot(at.moved, at.moved))
    return math.copysign(speed, dot(tangent(at.axes[2]), at.moved)) if is_disk(c) else speed


@compiled
def pause(p, y):
    """Take the last bits of the rolling from a body that is about to roll back, or is held.

    Friction takes them, and its angular impulse is in the ledger. The centre of mass of a body
    that slides keeps its velocity.
    """
    c, now = load_contact(p), load_unknowns(y)
    at = posture(c, now.q, now.omega)
    gamma = at.axes[2]
    if is_disk(c) or c.rim > 0.0:
        b = across_rim(gamma)
        change = scaled(-dot(b, now.omega), b)
    else:
        change = minus(scaled(dot(gamma, now.omega), gamma), now.omega)
    store_impulse(y, plus(now.ledger.impulse, apply(at.axes, apply(c.inertia, change))))
    store_omega(y, plus(now.omega, change))
    if c.mode == SLIDING or c.mode == GLIDING:
        carried = apply(at.axes, cross(change, at.r))
        store_u(y, (now.u[0] + carried[0], now.u[1] + carried[1], 0.0))


@compiled
def withheld(p, y, row):
    """Return the force h, N, by which friction holds the rolling (holding.py: against).

    `row` holds the rates while it is held.
    """
    c, now = load_contact(p), load_unknowns(y)
    at = posture(c, now.q, now.omega)
    return against(c, at, along_body(at.axes, load_couple(row)))


@compiled
def grows(p, y, row):
    """Return how a rolling grows from 0 along the plane, in any unit; `row` holds the rates."""
    c, now = load_contact(p), load_unknowns(y)
    return growing(c, posture(c, now.q, now.omega), load_omega(row))
