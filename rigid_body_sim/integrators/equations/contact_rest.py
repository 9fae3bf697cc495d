# SPDX-License-Identifier: Apache-2.0
"""The end of the motion of a convex body on a plane: it jams, halts, or rolls back.

Symbols: mechanics/contact/laws.py; the views are in contact_views.py.
"""

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.integrators.equations.contact_views import LEDGER, ROLLING, UNKNOWNS
from rigid_body_sim.mechanics.contact.forces import posture
from rigid_body_sim.mechanics.contact.parameters import CONTACT, LOW
from rigid_body_sim.mechanics.contact.touch import inclination
from rigid_body_sim.numerics.rotations import matrix
from rigid_body_sim.numerics.vectors import apply, cross, dot, minus, plus, scaled
from rigid_body_sim.scene.surfaces import TORUS

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
    """Take the last bits of the rolling from a body that is about to roll back."""
    now = load_unknowns(y)
    gamma = matrix(*now.q)[2]
    store_omega(y, scaled(dot(gamma, now.omega), gamma))
