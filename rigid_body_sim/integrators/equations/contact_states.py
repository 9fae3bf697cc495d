# SPDX-License-Identifier: Apache-2.0
"""The way between the state vector and the unknowns of a convex body on a plane.

The views are in contact_views.py.
"""

from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.layout import layout
from rigid_body_sim.integrators.equations.contact_views import (
    FLIGHT,
    ROW,
    UNKNOWNS,
    Ledger,
    Unknowns,
)
from rigid_body_sim.mechanics.contact.parameters import CONTACT
from rigid_body_sim.mechanics.contact.touch import gap_of, lever
from rigid_body_sim.mechanics.ledger import ENTRIES, ENTRIES_SIZE, Entries
from rigid_body_sim.numerics.rotations import matrix, multiply, normalised, rotate, rotate_back
from rigid_body_sim.numerics.vectors import apply, cross, dot, minus, plus
from rigid_body_sim.scene.state import STATE, STATE_SIZE, StateView


class Heats(NamedTuple):
    """The heat by its cause (mechanics/ledger.py: HEATS), J."""

    slid: float
    rolled: float
    filmed: float
    struck: float
    spun: float


HEATS = layout(Heats)
load_contact, load_unknowns, store_unknowns = CONTACT.load, UNKNOWNS.load, UNKNOWNS.store
load_lever, load_velocity = ROW.part('lever').load, ROW.part('velocity').load
load_state, store_view = STATE.load, STATE.store
store_entries, store_heats = ENTRIES.store, HEATS.store
NOTHING = Ledger(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, (0.0, 0.0, 0.0), 0.0)


@compiled
def write(p, y, row, time, start, out):
    """Fill the state vector `out` from the unknowns and a row of their rates.

    After it, where there is room, come the entries of the ledger and the heat by its cause.

    Parameters
    ----------
    start : tuple of 2 floats
        Where the centre of mass was at the start of the course, axes of the plane, m.
    """
    c, now, arm, v = load_contact(p), load_unknowns(y), load_lever(row), load_velocity(row)
    q, spent = now.q, now.ledger
    gap = gap_of(c, now.gap, matrix(*now.q)[2]) if c.mode == FLIGHT else 0.0
    place = start[0] + now.place[0], start[1] + now.place[1], gap - arm[2]
    turn = spent.impulse
    if c.inclined != 0.0:
        q = multiply(*c.plane, *q)
        place, v, turn = rotate(*c.plane, *place), rotate(*c.plane, *v), rotate(*c.plane, *turn)
    q = normalised(*q)
    axes = matrix(*q)
    store_view(out, StateView(time, q, now.omega, minus(place, apply(axes, c.center)),
                              minus(v, apply(axes, cross(now.omega, c.center)))))
    if len(out) > STATE_SIZE:
        heat = (spent.slid + spent.rolled + spent.filmed + spent.struck + spent.damped
                + spent.spun)
        store_entries(out, Entries(spent.work, heat, turn), STATE_SIZE)
    if len(out) > STATE_SIZE + ENTRIES_SIZE:
        store_heats(out, Heats(spent.slid, spent.rolled, spent.filmed, spent.struck, spent.spun),
                    STATE_SIZE + ENTRIES_SIZE)


@compiled
def read(p, state, y):
    """Fill the unknowns y of a flight from a state vector; return the centre of mass (plane)."""
    c, given = load_contact(p), load_state(state)
    q, omega = normalised(*given.orientation), given.angular_velocity
    axes = matrix(*q)
    place = plus(given.position, apply(axes, c.center))
    v = plus(given.velocity, apply(axes, cross(omega, c.center)))
    if c.inclined != 0.0:
        px, py, pz, pw = c.plane
        q = normalised(*multiply(-px, -py, -pz, pw, *q))
        place, v = rotate_back(*c.plane, *place), rotate_back(*c.plane, *v)
    gamma = matrix(*q)[2]
    gap = place[2] + dot(gamma, lever(c, gamma))
    store_unknowns(y, Unknowns(q, omega, v, (0.0, 0.0), gap, 0.0, NOTHING))
    return place
