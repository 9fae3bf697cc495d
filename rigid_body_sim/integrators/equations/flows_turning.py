# SPDX-License-Identifier: Apache-2.0
"""Template: the two flows of a pivoted body, or of a free one on which no force acts.

Unknowns as in turning.py.

drift            the free rotation about the point of reference, by its series to round-off:
                 free_turn.py
kick             what acts changes omega while the attitude stands: exact if torques depend on
                 the attitude alone
kick_with_heat   the same where they depend on omega too (drag), or turn the axes (internal
                 dissipation): the explicit midpoint rule, order 2

c carries what the sums of q and omega have lost (Kahan) from flow to flow.
"""

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.equations.euler import OMEGA, load_inverse, load_moments
from rigid_body_sim.integrators.equations.free_turn import turned_freely
from rigid_body_sim.numerics.double_double import add_double
from rigid_body_sim.numerics.rotations import from_rotation_vector, multiply, normalised

torque = UNBOUND
turning = UNBOUND    # the extra turning rate of internal dissipation


@compiled
def drift(p, y, c, h):
    """Return (y, c) after the body has turned freely for a time h."""
    return turned_freely(p, y, c, h)


@compiled
def kick(p, y, c, h):
    """Return (y, c) after the torques have acted alone for a time h."""
    q1, q2, q3, q4, w1, w2, w3 = y
    tx, ty, tz = torque(p, q1, q2, q3, q4, w1, w2, w3, 0.0, 0.0, 0.0)
    return added(p, y, c, h, tx, ty, tz)


@compiled
def kick_with_heat(p, y, c, h):
    """Return (y, c) after all that acts has acted alone for a time h.

    The explicit midpoint rule is used.
    """
    q1, q2, q3, q4, w1, w2, w3 = y
    half = 0.5 * h
    tx, ty, tz = torque(p, q1, q2, q3, q4, w1, w2, w3, 0.0, 0.0, 0.0)
    ux, uy, uz = turning(p, q1, q2, q3, q4, w1, w2, w3, 0.0, 0.0, 0.0)
    a1, a2, a3, a4 = turned(y, half * ux, half * uy, half * uz)
    i1, i2, i3 = load_inverse(p)
    w1, w2, w3 = w1 + half * i1 * tx, w2 + half * i2 * ty, w3 + half * i3 * tz
    tx, ty, tz = torque(p, a1, a2, a3, a4, w1, w2, w3, 0.0, 0.0, 0.0)
    ux, uy, uz = turning(p, a1, a2, a3, a4, w1, w2, w3, 0.0, 0.0, 0.0)
    z, c = added(p, y, c, h, tx, ty, tz)
    q1, q2, q3, q4 = turned(y, h * ux, h * uy, h * uz)
    return (q1, q2, q3, q4, *z[OMEGA:]), (0.0, 0.0, 0.0, 0.0, *c[OMEGA:])


@compiled
def turned(y, rx, ry, rz):
    """Return the attitude turned by a rotation vector of the frame."""
    return normalised(*multiply(*y[:OMEGA], *from_rotation_vector(rx, ry, rz)))


@compiled
def added(p, y, c, h, tx, ty, tz):
    """Return (y, c) with what a torque (frame) adds to omega in a time h."""
    (w1, w2, w3), (l1, l2, l3), (i1, i2, i3) = y[OMEGA:], c[OMEGA:], load_moments(p)
    w1, l1 = add_double(w1, l1, h * tx / i1 if i1 > 0.0 else 0.0)
    w2, l2 = add_double(w2, l2, h * ty / i2 if i2 > 0.0 else 0.0)
    w3, l3 = add_double(w3, l3, h * tz / i3 if i3 > 0.0 else 0.0)
    return (*y[:OMEGA], w1, w2, w3), (*c[:OMEGA], l1, l2, l3)
