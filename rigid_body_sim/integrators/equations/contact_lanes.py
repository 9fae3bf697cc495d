# SPDX-License-Identifier: Apache-2.0
"""Template: the rates of a convex body that rolls or slides on a plane, as vector code takes them.

The equations are those of contact_rates.py in the phases ROLLING, SLIDING and GLIDING, under a
uniform field. A compiler makes vector code of a loop over the stages of a step where each of them
takes the same way: the template is bound to the parameters with what decides a way as literals.
"""

import math
from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled_inline
from rigid_body_sim.compilation.layout import Pair, Quaternion, Vector
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.equations.contact_views import (
    ROLLING,
    SLIDING,
    Ledger,
    Unknowns,
    Watched,
)
from rigid_body_sim.mechanics.contact.forces import (
    Push,
    posture,
    rolling_force,
    slipping_force,
    torque_of,
)
from rigid_body_sim.mechanics.contact.parameters import CONTACT
from rigid_body_sim.mechanics.contact.touch import above_flat, couples
from rigid_body_sim.numerics.rotations import multiply
from rigid_body_sim.numerics.vectors import apply, cross, dot, plus, scaled

# p -> the parameters, a tuple of numbers and literals
known = UNBOUND

load_contact = CONTACT.load
ZERO = (0.0, 0.0, 0.0)


class Coupled(NamedTuple):
    """The unknowns on which the rates depend: the first ones of Unknowns (contact_views.py)."""

    q: Quaternion
    omega: Vector
    slip: Pair


class Stage(NamedTuple):
    """The rates of the unknowns at an instant, and what is watched there."""

    rates: Unknowns
    watched: Watched


@compiled_inline
def parameters(p):
    """Return the ContactParameters, and the weight along the axes of the plane, N."""
    return load_contact(known(p)), (p[-3], p[-2], p[-1])


@compiled_inline
def _pace(c, now):
    """Return dt/ds, where s is the variable of the phase."""
    ux, uy = now.slip
    return math.sqrt(ux * ux + uy * uy) if c.mode == SLIDING else 1.0


@compiled_inline
def turned(c, now):
    """Return the rate of q."""
    half = 0.5 * _pace(c, now)
    x, y, z, w = multiply(*now.q, *now.omega, 0.0)
    return half * x, half * y, half * z, half * w


@compiled_inline
def stage(c, weight, now):
    """Return the Stage of a body in contact."""
    at = posture(c, now.q, now.omega)
    e1, e2, e3 = at.axes
    viscous, wrung, speed, film = couples(c, e3, at.moved)
    torque = plus(cross(apply(c.uneven, now.omega), now.omega), viscous)
    push = Push(weight, torque, viscous, wrung)
    pace, grip, firmness, growth, slid = _pace(c, now), 1.0, 1.0, ZERO, 0.0
    if c.mode == ROLLING:
        f = rolling_force(c, at, push)
        if c.mu < 1e300:
            grip = c.mu * f[2] - math.sqrt(f[0] * f[0] + f[1] * f[1])
    else:
        dx, dy, mu = 1.0, 0.0, 0.0
        if c.mode == SLIDING:
            mu = c.mu
            dx, dy = (now.slip[0] / pace, now.slip[1] / pace) if pace > 0.0 else (1.0, 0.0)
        f, growth, A = slipping_force(c, at, push, mu, dx, dy)
        firmness, slid = A * c.mass, mu * f[2] * pace
    turning = torque_of(at, f)
    entries = Ledger(pace * slid, pace * c.rolling_viscous * speed * speed,
                     pace * film * speed * speed, 0.0, 0.0, 0.0,
                     scaled(pace, apply(at.axes, plus(turning, viscous))), 0.0)
    v = now.slip[0] - dot(e1, at.carried), now.slip[1] - dot(e2, at.carried)
    rates = Unknowns(turned(c, now), scaled(pace, apply(at.inverse, plus(torque, turning))),
                     scaled(pace, growth), (pace * v[0], pace * v[1]), 0.0, pace, entries)
    return Stage(rates, Watched(f[2], grip, firmness, 1.0, above_flat(c, e3), 1.0))
