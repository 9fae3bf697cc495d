# SPDX-License-Identifier: Apache-2.0
"""A bounce on the plane: the impacts of one instant, of which a flat ring has several."""

from typing import NamedTuple

import numpy as np

from rigid_body_sim.integrators.equations.contact_impacts import (
    IMPACT,
    collide,
    load_impact,
    velocity_of_lowest,
)
from rigid_body_sim.integrators.equations.contact_rest import lies, tip
from rigid_body_sim.integrators.equations.contact_views import UNKNOWNS
from rigid_body_sim.mechanics.contact.parameters import CONTACT
from rigid_body_sim.numerics.functions import hypot

CHATTER = 1e-13          # an impact rebounds no more below that share of the speeds
MOST_IMPACTS = 100       # of a ring that lies flat, at a time
MU, RESTITUTION = (CONTACT.part(name).first for name in ('mu', 'restitution'))
GAP = UNKNOWNS.part('gap').first


class Bounce(NamedTuple):
    """What the impacts of one instant did.

    Attributes
    ----------
    before : float
        Normal velocity before them, m/s.
    impulse : float
        Their normal impulse, N s.
    rebounds : bool
        Whether the body leaves the plane.
    slip : tuple
        Velocity of the contact along the plane if it stays (m/s); zero if it sticks.
    """

    before: float
    impulse: float
    rebounds: bool
    slip: tuple


def bounce(p, y, scales):
    """Change the unknowns by the impacts of one instant; return the Bounce."""
    impact, rebounds = collision(p, y, p[RESTITUTION], scales)
    impulse, slip = impact.impulse, impact.slip
    for _ in range(MOST_IMPACTS):
        # a ring that lies flat turns about another axis from here on: another point goes down
        rounding = scales.rounding(y)
        if impulse < 0.0 or not lies(p, y):
            break
        tips = tip(p, y, rounding / scales.length)
        ux, uy, normal = velocity_of_lowest(p, y)
        slides = hypot(ux, uy) > rounding
        sticks = slip == (0.0, 0.0) and not rebounds and p[MU] > 0.0
        if not tips or (normal >= -rounding and not (sticks and slides)):
            rebounds = rebounds and normal > rounding
            slip = (ux, uy) if slides else (0.0, 0.0)
            break
        again, rebounds = collision(p, y, 0.0, scales)
        impulse, slip = impulse + again.impulse, again.slip
    return Bounce(impact.before, impulse, rebounds, slip)


def collision(p, y, restitution, scales):
    """Change the unknowns by one impact; return the Impact, and whether the body rebounds."""
    out = np.empty(IMPACT.size)
    trial = y.copy()
    collide(p, trial, restitution, out)
    rebounds = load_impact(out).after > CHATTER * scales.speed(y)
    if not rebounds:
        trial = y.copy()
        collide(p, trial, 0.0, out)
    y[:] = trial
    y[GAP] = 0.0
    return load_impact(out.tolist()), rebounds
