# SPDX-License-Identifier: Apache-2.0
"""The end of the motion of a convex body on a plane: it jams, halts, or rolls back.

Symbols: mechanics/contact/laws.py; the views are in contact_views.py.
"""

from rigid_body_sim.compilation.jit import compiled, inlined
from rigid_body_sim.integrators.equations.contact_views import (
    GLIDING,
    LEDGER,
    ROLLING,
    ROW,
    SLIDING,
    UNKNOWNS,
)
from rigid_body_sim.mechanics.contact.forces import against, along_body, posture
from rigid_body_sim.mechanics.contact.parameters import CONTACT, LOW
from rigid_body_sim.mechanics.contact.touch import inclination
from rigid_body_sim.numerics.functions import hypot
from rigid_body_sim.numerics.rotations import matrix
from rigid_body_sim.numerics.vectors import apply, cross, dot, minus, plus, scaled
from rigid_body_sim.scene.surfaces import TORUS, shifted

ZERO = (0.0, 0.0, 0.0)

load_contact, load_unknowns = CONTACT.load, UNKNOWNS.load
load_couple = ROW.part('couple').load
store_omega, store_u = UNKNOWNS.part('omega').store, UNKNOWNS.part('u').store
store_impulse, STRUCK = LEDGER.part('impulse').store, LEDGER.part('struck').first


@compiled
def spins(p, y):
    """Return the speed at which a patch of contact spins on the plane, m/s."""
    c, now = load_contact(p), load_unknowns(y)
    return c.patch * abs(dot(matrix(*now.q)[2], now.omega))


@compiled
def jams(p, y):
    """Return whether a ring lies so low that rolling friction leaves it no motion."""
    c, now = load_contact(p), load_unknowns(y)
    return (c.kind == TORUS and c.rolling + c.rolling_viscous + c.film > 0.0
            and inclination(matrix(*now.q)[2]) < LOW)


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
def pause(p, y):
    """Take the last bits of the rolling from a body that is about to roll back, or is held."""
    c, now = load_contact(p), load_unknowns(y)
    at = posture(c, now.q, now.omega)
    _set_omega(c, at, y, scaled(dot(at.axes[2], now.omega), at.axes[2]))


@inlined
def _set_omega(c, at, y, omega):
    """Change omega by friction, whose angular impulse is in the ledger.

    The centre of mass of a body that slides keeps its velocity.
    """
    now, change = load_unknowns(y), minus(omega, at.omega)
    turn = apply(c.inertia, change)
    store_impulse(y, plus(now.ledger.impulse, apply(at.axes, turn)))
    store_omega(y, omega)
    if c.mode == SLIDING or c.mode == GLIDING:
        carried = apply(at.axes, cross(change, at.r))
        store_u(y, (now.u[0] + carried[0], now.u[1] + carried[1], 0.0))


@compiled
def nudge(p, y, row, speed):
    """Let a body that friction no longer holds roll at a speed (m/s), against what held it.

    `row` holds the rates while it is held.
    """
    c, now, couple = load_contact(p), load_unknowns(y), load_couple(row)
    at = posture(c, now.q, now.omega)
    e1, e2, gamma = at.axes
    # -(S h) x gamma is the rolling friction of an s' along h, and s' = S (gamma x omega)
    x, z = against(c, at, along_body(at.axes, couple))
    size = hypot(x, z)
    first, second = shifted(c.kind, c.size, gamma, e1), shifted(c.kind, c.size, gamma, e2)
    a, b, d = dot(e1, first), dot(e1, second), dot(e2, second)
    share = speed / (size * (a * d - b * b))
    rolls = plus(scaled(share * (d * x - b * z), e1), scaled(share * (a * z - b * x), e2))
    _set_omega(c, at, y, plus(scaled(dot(gamma, now.omega), gamma), cross(rolls, gamma)))
