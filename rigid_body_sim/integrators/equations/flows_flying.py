# SPDX-License-Identifier: Apache-2.0
"""Template: the two flows of a free body on which a force acts; unknowns as in flying.py.

The rotation is that of flows_turning.py. In a drift the centre of mass goes on in a straight line,
in a kick the force changes its velocity; both sums carry what they lose (Kahan).
"""

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.equations.euler import INVERSE, MASS
from rigid_body_sim.numerics.double_double import add_double

rotation_drift = UNBOUND
rotation_added = UNBOUND
rotation_turned = UNBOUND
torque = UNBOUND
turning = UNBOUND
force = UNBOUND


@compiled
def drift(p, y, c, h):
    """Return (y, c) after the body has moved freely for a time h."""
    z, lost = rotation_drift(p, y[:7], c[:7], h)
    (x1, l1), (x2, l2), (x3, l3) = (
        add_double(y[7], c[7], h * y[10]),
        add_double(y[8], c[8], h * y[11]),
        add_double(y[9], c[9], h * y[12]),
    )
    return (*z, x1, x2, x3, y[10], y[11], y[12]), (*lost, l1, l2, l3, c[10], c[11], c[12])


@compiled
def kick(p, y, c, h):
    """Return (y, c) after forces and torques have acted alone for a time h."""
    q1, q2, q3, q4, w1, w2, w3, _, _, _, v1, v2, v3 = y
    tx, ty, tz = torque(p, q1, q2, q3, q4, w1, w2, w3, v1, v2, v3)
    fx, fy, fz = force(p, q1, q2, q3, q4, w1, w2, w3, v1, v2, v3)
    return _added(p, y, c, h, tx, ty, tz, fx, fy, fz)


@compiled
def kick_with_heat(p, y, c, h):
    """Return (y, c) after all that acts has acted alone for a time h.

    By the explicit midpoint rule.
    """
    q1, q2, q3, q4, w1, w2, w3, _, _, _, v1, v2, v3 = y
    half = 0.5 * h
    tx, ty, tz = torque(p, q1, q2, q3, q4, w1, w2, w3, v1, v2, v3)
    fx, fy, fz = force(p, q1, q2, q3, q4, w1, w2, w3, v1, v2, v3)
    ux, uy, uz = turning(p, q1, q2, q3, q4, w1, w2, w3, v1, v2, v3)
    q1, q2, q3, q4 = rotation_turned(y, half * ux, half * uy, half * uz)
    w1, w2, w3 = (
        w1 + half * p[INVERSE] * tx,
        w2 + half * p[INVERSE + 1] * ty,
        w3 + half * p[INVERSE + 2] * tz,
    )
    v1, v2, v3 = v1 + half * fx / p[MASS], v2 + half * fy / p[MASS], v3 + half * fz / p[MASS]
    tx, ty, tz = torque(p, q1, q2, q3, q4, w1, w2, w3, v1, v2, v3)
    fx, fy, fz = force(p, q1, q2, q3, q4, w1, w2, w3, v1, v2, v3)
    ux, uy, uz = turning(p, q1, q2, q3, q4, w1, w2, w3, v1, v2, v3)
    z, c = _added(p, y, c, h, tx, ty, tz, fx, fy, fz)
    q1, q2, q3, q4 = rotation_turned(y, h * ux, h * uy, h * uz)
    return (q1, q2, q3, q4, *z[4:]), (0.0, 0.0, 0.0, 0.0, *c[4:])


@compiled
def _added(p, y, c, h, tx, ty, tz, fx, fy, fz):
    """Return (y, c) after a torque (frame) and a force (world) for a time h.

    More than eight arguments: torque and force stay scalars in registers.
    """
    z, lost = rotation_added(p, y[:7], c[:7], h, tx, ty, tz)
    mass = p[MASS]
    v1, l1 = add_double(y[10], c[10], h * fx / mass)
    v2, l2 = add_double(y[11], c[11], h * fy / mass)
    v3, l3 = add_double(y[12], c[12], h * fz / mass)
    return (*z, y[7], y[8], y[9], v1, v2, v3), (*lost, c[7], c[8], c[9], l1, l2, l3)
