# SPDX-License-Identifier: Apache-2.0
"""The end of the motion of a convex body on a plane: whether it rests, jams, or rolls back.

Symbols: mechanics/contact/laws.py; the views are in contact_views.py.
"""

import math

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.integrators.equations.contact_views import LEDGER, ROLLING, UNKNOWNS
from rigid_body_sim.mechanics.contact.forces import along_body, posture
from rigid_body_sim.mechanics.contact.parameters import CONTACT, LOW
from rigid_body_sim.numerics.functions import hypot
from rigid_body_sim.numerics.rotations import matrix
from rigid_body_sim.numerics.vectors import apply, cross, dot, minus, plus, scaled
from rigid_body_sim.scene.surfaces import TORUS, shifted

SPINLESS = 1e-9          # share of the speeds below which a body that rests does not spin
ZERO = (0.0, 0.0, 0.0)

load_contact, load_unknowns = CONTACT.load, UNKNOWNS.load
store_omega, store_u = UNKNOWNS.part('omega').store, UNKNOWNS.part('u').store
store_impulse, STRUCK = LEDGER.part('impulse').store, LEDGER.part('struck').first


@compiled
def spins(p, y):
    """Return the speed at which a patch of contact spins on the plane, m/s."""
    c, now = load_contact(p), load_unknowns(y)
    return c.patch * abs(dot(matrix(*now.q)[2], now.omega))


@compiled
def jams(p, y):
    """Return whether a disk lies so low that its friction of rolling leaves no motion."""
    c, now = load_contact(p), load_unknowns(y)
    gamma = matrix(*now.q)[2]
    edge = c.kind == TORUS and c.size[1] == 0.0
    return (edge and c.rolling + c.rolling_viscous + c.film > 0.0
            and math.sqrt(gamma[0] * gamma[0] + gamma[1] * gamma[1]) < LOW)


@compiled
def holds_still(c, at, F, T):
    """Return whether a body that has almost stopped is at rest: a flat disk, or dry friction.

    Dry rolling friction holds the couple -(S h) x n of a force |h| <= C N, Coulomb's friction the
    force that balances the others. A spin about the normal is not held.

    Parameters
    ----------
    F, T : Vector
        What acts on the resting body: force (axes of the plane), couple (body axes).
    """
    e1, e2, gamma = at.axes
    if c.kind == TORUS and c.size[1] == 0.0:
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


@compiled
def halt(p, y):
    """Take what is left of the motion, and of the height of a disk, from a body that rests."""
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
    """Take the last bits of the rolling from a body that is about to roll back."""
    now = load_unknowns(y)
    gamma = matrix(*now.q)[2]
    store_omega(y, scaled(dot(gamma, now.omega), gamma))
