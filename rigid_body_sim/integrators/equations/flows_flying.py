# SPDX-License-Identifier: Apache-2.0
"""Template: the two flows of a free body on which a force acts; unknowns as in flying.py.

The rotation is that of flows_turning.py. In a drift the centre of mass goes on in a straight line,
in a kick the force changes its velocity; both sums carry what they lose (Kahan).
"""

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.equations.euler import (
    MASS,
    OMEGA,
    PLACE,
    load_inverse,
)
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
    x1, x2, x3, v1, v2, v3 = y[PLACE:]
    l1, l2, l3, m1, m2, m3 = c[PLACE:]
    z, lost = rotation_drift(p, y[:PLACE], c[:PLACE], h)
    (x1, l1), (x2, l2), (x3, l3) = (
        add_double(x1, l1, h * v1), add_double(x2, l2, h * v2), add_double(x3, l3, h * v3))
    return (*z, x1, x2, x3, v1, v2, v3), (*lost, l1, l2, l3, m1, m2, m3)


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

    The explicit midpoint rule is used.
    """
    q1, q2, q3, q4, w1, w2, w3, _, _, _, v1, v2, v3 = y
    half = 0.5 * h
    tx, ty, tz = torque(p, q1, q2, q3, q4, w1, w2, w3, v1, v2, v3)
    fx, fy, fz = force(p, q1, q2, q3, q4, w1, w2, w3, v1, v2, v3)
    ux, uy, uz = turning(p, q1, q2, q3, q4, w1, w2, w3, v1, v2, v3)
    q1, q2, q3, q4 = rotation_turned(y, half * ux, half * uy, half * uz)
    i1, i2, i3 = load_inverse(p)
    w1, w2, w3 = w1 + half * i1 * tx, w2 + half * i2 * ty, w3 + half * i3 * tz
    v1, v2, v3 = v1 + half * fx / p[MASS], v2 + half * fy / p[MASS], v3 + half * fz / p[MASS]
    tx, ty, tz = torque(p, q1, q2, q3, q4, w1, w2, w3, v1, v2, v3)
    fx, fy, fz = force(p, q1, q2, q3, q4, w1, w2, w3, v1, v2, v3)
    ux, uy, uz = turning(p, q1, q2, q3, q4, w1, w2, w3, v1, v2, v3)
    z, c = _added(p, y, c, h, tx, ty, tz, fx, fy, fz)
    q1, q2, q3, q4 = rotation_turned(y, h * ux, h * uy, h * uz)
    return (q1, q2, q3, q4, *z[OMEGA:]), (0.0, 0.0, 0.0, 0.0, *c[OMEGA:])


@compiled
def _added(p, y, c, h, tx, ty, tz, fx, fy, fz):
    """Return (y, c) after a torque (frame) and a force (world) for a time h.

    More than eight arguments: torque and force stay scalars in registers.
    """
    x1, x2, x3, v1, v2, v3 = y[PLACE:]
    l1, l2, l3, m1, m2, m3 = c[PLACE:]
    z, lost = rotation_added(p, y[:PLACE], c[:PLACE], h, tx, ty, tz)
    mass = p[MASS]
    v1, m1 = add_double(v1, m1, h * fx / mass)
    v2, m2 = add_double(v2, m2, h * fy / mass)
    v3, m3 = add_double(v3, m3, h * fz / mass)
    return (*z, x1, x2, x3, v1, v2, v3), (*lost, l1, l2, l3, m1, m2, m3)
