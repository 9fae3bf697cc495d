# SPDX-License-Identifier: Apache-2.0
"""The impact of a convex body that comes down on a plane.

Symbols: mechanics/contact/laws.py; the views are in contact_views.py.
"""

from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.layout import Pair, Vector, layout
from rigid_body_sim.integrators.equations.contact_views import LEDGER, UNKNOWNS
from rigid_body_sim.mechanics.contact.forces import posture, torque_of
from rigid_body_sim.mechanics.contact.laws import impulse
from rigid_body_sim.mechanics.contact.parameters import CONTACT
from rigid_body_sim.mechanics.contact.touch import response
from rigid_body_sim.numerics.functions import hypot
from rigid_body_sim.numerics.vectors import apply, dot, plus, scaled

HALVINGS = 60    # of an interval, until its ends are neighbours


class Impact(NamedTuple):
    """The results of an impact.

    Attributes
    ----------
    slip : Pair
        After the impact, m/s; 0 if the body sticks.
    before, after : float
        Normal velocity of the lowest point, m/s.
    impulse : float
        Along the normal, N s.
    """

    slip: Pair
    before: float
    after: float
    impulse: float


class Rebound(NamedTuple):
    """What an impact does to the point that meets the plane.

    Attributes
    ----------
    restitution : float
    impulse : Vector
        N s, axes of the plane.
    after : Vector
        Velocity after the impact, m/s.
    loss : float
        Energy that it takes, J.
    """

    restitution: float
    impulse: Vector
    after: Vector
    loss: float


IMPACT = layout(Impact)
load_contact, load_unknowns = CONTACT.load, UNKNOWNS.load
load_impact, store_impact = IMPACT.load, IMPACT.store
store_omega, store_u = UNKNOWNS.part('omega').store, UNKNOWNS.part('u').store
store_impulse, STRUCK = LEDGER.part('impulse').store, LEDGER.part('struck').first


@compiled
def velocity_of_lowest(p, y):
    """Return the velocity of the lowest point of a flight, axes of the plane, m/s."""
    c, now = load_contact(p), load_unknowns(y)
    at = posture(c, now.q, now.omega)
    return plus(now.u, apply(at.axes, at.carried))


@compiled
def rebound(G, before, restitution, mu):
    """Return the Rebound by Newton's law; with friction it may create energy.

    The arguments are those of :func:`mechanics.contact.laws.impulse`.
    """
    given = impulse(G, before, restitution, mu)
    after = plus(before, apply(G, given))
    loss = -0.5 * dot(given, plus(before, after))
    return Rebound(restitution, given, after, loss)


@compiled
def bearable(G, before, restitution, mu):
    """Return the Rebound of the largest restitution, up to the one given, that creates no energy.

    The arguments are those of :func:`rebound`.
    """
    found = rebound(G, before, restitution, mu)
    if found.loss >= 0.0:
        return found
    low, high = 0.0, restitution
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if rebound(G, before, middle, mu).loss >= 0.0:
            low = middle
        else:
            high = middle
    return rebound(G, before, low, mu)


@compiled
def collide(p, y, restitution, out):
    """Change the unknowns of a flight by an impact.

    Where Newton's law would create energy, as it can with friction, the restitution is smaller.

    Parameters
    ----------
    y : array
        Unknowns, changed in place: omega, velocity, ledger.
    out : array
        Filled with the Impact.
    """
    c, now = load_contact(p), load_unknowns(y)
    at = posture(c, now.q, now.omega)
    before = plus(now.u, apply(at.axes, at.carried))
    G = response(c.mass, c.inverse, at.axes, at.r, at.tilting)
    e, given, after, loss = bearable(G, before, restitution, c.mu)
    normal = -e * before[2]
    turn = torque_of(at, given)
    store_omega(y, plus(now.omega, apply(c.inverse, turn)))
    store_u(y, plus(now.u, scaled(1.0 / c.mass, given)))
    y[STRUCK] += loss
    store_impulse(y, plus(now.ledger.impulse, apply(at.axes, turn)))
    sticks = given[2] > 0.0 and hypot(given[0], given[1]) < c.mu * given[2] * (1.0 - 1e-14)
    slip = (0.0, 0.0) if sticks else (after[0], after[1])
    store_impact(out, Impact(slip, before[2], normal, given[2]))
