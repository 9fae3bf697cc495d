"""Template: the two flows of a pivoted body, or of a free one on which no force acts; unknowns as in turning.py.

drift            the free rotation about the point of reference, in closed form (rigid_body_sim/motions/free_body.py): exact for any step
kick             what acts changes omega while the attitude stands: exact if torques depend on the attitude alone
kick_with_heat   the same where they depend on omega too (drag), or turn the axes (internal dissipation): the explicit midpoint rule, order 2

c carries what the sums of omega have lost (Kahan) from kick to kick; the attitude is a product of unit quaternions, made unit each time.
"""

import numpy as np

from rigid_body_sim.compiled import compiled
from rigid_body_sim.integrators.euler import INVERSE
from rigid_body_sim.motions import free_body
from rigid_body_sim.rotations import from_rotation_vector, multiply, normalised
from rigid_body_sim.specialise import UNBOUND
from rigid_body_sim.state import STATE_SIZE

torque = UNBOUND
turning = UNBOUND    # the extra turning rate of internal dissipation
BODY = UNBOUND       # where the numbers of free_body.py begin among the parameters


@compiled
def drift(p, y, c, h):
    """Return (y, c) after the body has turned freely for a time h."""
    anchor, state = np.empty(free_body.ANCHOR_SIZE), np.zeros(STATE_SIZE)
    state[1], state[2], state[3], state[4], state[5], state[6], state[7] = y[0], y[1], y[2], y[3], y[4], y[5], y[6]
    free_body.anchor(p[BODY:], state, anchor)
    free_body.state(anchor, h, state)
    return (state[1], state[2], state[3], state[4], state[5], state[6], state[7]), c


@compiled
def kick(p, y, c, h):
    """Return (y, c) after the torques have acted alone for a time h."""
    q1, q2, q3, q4, w1, w2, w3 = y
    tx, ty, tz = torque(p, q1, q2, q3, q4, w1, w2, w3, 0.0, 0.0, 0.0)
    return added(y, c, h * p[INVERSE] * tx, h * p[INVERSE + 1] * ty, h * p[INVERSE + 2] * tz)


@compiled
def kick_with_heat(p, y, c, h):
    """Return (y, c) after all that acts has acted alone for a time h, by the explicit midpoint rule."""
    q1, q2, q3, q4, w1, w2, w3 = y
    half = 0.5 * h
    tx, ty, tz = torque(p, q1, q2, q3, q4, w1, w2, w3, 0.0, 0.0, 0.0)
    ux, uy, uz = turning(p, q1, q2, q3, q4, w1, w2, w3, 0.0, 0.0, 0.0)
    a1, a2, a3, a4 = turned(y, half * ux, half * uy, half * uz)
    w1, w2, w3 = w1 + half * p[INVERSE] * tx, w2 + half * p[INVERSE + 1] * ty, w3 + half * p[INVERSE + 2] * tz
    tx, ty, tz = torque(p, a1, a2, a3, a4, w1, w2, w3, 0.0, 0.0, 0.0)
    ux, uy, uz = turning(p, a1, a2, a3, a4, w1, w2, w3, 0.0, 0.0, 0.0)
    z, c = added(y, c, h * p[INVERSE] * tx, h * p[INVERSE + 1] * ty, h * p[INVERSE + 2] * tz)
    q1, q2, q3, q4 = turned(y, h * ux, h * uy, h * uz)
    return (q1, q2, q3, q4, z[4], z[5], z[6]), c


@compiled
def turned(y, rx, ry, rz):
    """Return the attitude turned by a rotation vector of the frame."""
    return normalised(*multiply(y[0], y[1], y[2], y[3], *from_rotation_vector(rx, ry, rz)))


@compiled
def added(y, c, d1, d2, d3):
    """Return (y, c) with the increments added to omega, and what the sums lose."""
    d1, d2, d3 = d1 + c[4], d2 + c[5], d3 + c[6]
    w1, w2, w3 = y[4] + d1, y[5] + d2, y[6] + d3
    return (y[0], y[1], y[2], y[3], w1, w2, w3), (0.0, 0.0, 0.0, 0.0, d1 - (w1 - y[4]), d2 - (w2 - y[5]), d3 - (w3 - y[6]))
