"""Template: the two flows of a free body on which a force acts; unknowns as in flying.py.

The rotation is that of flows_turning.py. In a drift the centre of mass goes on in a straight line, in a kick the force changes its velocity;
both sums carry what they lose (Kahan).
"""

from rigid_body_sim.compiled import compiled
from rigid_body_sim.integrators.euler import INVERSE, MASS
from rigid_body_sim.specialise import UNBOUND

rotation_drift = UNBOUND
rotation_added = UNBOUND
rotation_turned = UNBOUND
torque = UNBOUND
turning = UNBOUND
force = UNBOUND


@compiled
def drift(p, y, c, h):
    """Return (y, c) after the body has moved freely for a time h."""
    (q1, q2, q3, q4, w1, w2, w3), _ = rotation_drift(p, y[:7], c[:7], h)
    d1, d2, d3 = h * y[10] + c[7], h * y[11] + c[8], h * y[12] + c[9]
    x1, x2, x3 = y[7] + d1, y[8] + d2, y[9] + d3
    return ((q1, q2, q3, q4, w1, w2, w3, x1, x2, x3, y[10], y[11], y[12]),
            (*c[:7], d1 - (x1 - y[7]), d2 - (x2 - y[8]), d3 - (x3 - y[9]), c[10], c[11], c[12]))


@compiled
def kick(p, y, c, h):
    """Return (y, c) after forces and torques have acted alone for a time h."""
    q1, q2, q3, q4, w1, w2, w3, _, _, _, v1, v2, v3 = y
    tx, ty, tz = torque(p, q1, q2, q3, q4, w1, w2, w3, v1, v2, v3)
    fx, fy, fz = force(p, q1, q2, q3, q4, w1, w2, w3, v1, v2, v3)
    return _added(p, y, c, h, tx, ty, tz, fx, fy, fz)


@compiled
def kick_with_heat(p, y, c, h):
    """Return (y, c) after all that acts has acted alone for a time h, by the explicit midpoint rule."""
    q1, q2, q3, q4, w1, w2, w3, _, _, _, v1, v2, v3 = y
    half = 0.5 * h
    tx, ty, tz = torque(p, q1, q2, q3, q4, w1, w2, w3, v1, v2, v3)
    fx, fy, fz = force(p, q1, q2, q3, q4, w1, w2, w3, v1, v2, v3)
    ux, uy, uz = turning(p, q1, q2, q3, q4, w1, w2, w3, v1, v2, v3)
    q1, q2, q3, q4 = rotation_turned(y, half * ux, half * uy, half * uz)
    w1, w2, w3 = w1 + half * p[INVERSE] * tx, w2 + half * p[INVERSE + 1] * ty, w3 + half * p[INVERSE + 2] * tz
    v1, v2, v3 = v1 + half * fx / p[MASS], v2 + half * fy / p[MASS], v3 + half * fz / p[MASS]
    tx, ty, tz = torque(p, q1, q2, q3, q4, w1, w2, w3, v1, v2, v3)
    fx, fy, fz = force(p, q1, q2, q3, q4, w1, w2, w3, v1, v2, v3)
    ux, uy, uz = turning(p, q1, q2, q3, q4, w1, w2, w3, v1, v2, v3)
    z, c = _added(p, y, c, h, tx, ty, tz, fx, fy, fz)
    q1, q2, q3, q4 = rotation_turned(y, h * ux, h * uy, h * uz)
    return (q1, q2, q3, q4, *z[4:]), c


@compiled
def _added(p, y, c, h, tx, ty, tz, fx, fy, fz):
    """Return (y, c) after a torque (frame) and a force (world) for a time h."""
    z, lost = rotation_added(y[:7], c[:7], h * p[INVERSE] * tx, h * p[INVERSE + 1] * ty, h * p[INVERSE + 2] * tz)
    d1, d2, d3 = h * fx / p[MASS] + c[10], h * fy / p[MASS] + c[11], h * fz / p[MASS] + c[12]
    v1, v2, v3 = y[10] + d1, y[11] + d2, y[12] + d3
    return ((*z, y[7], y[8], y[9], v1, v2, v3),
            (*lost, c[7], c[8], c[9], d1 - (v1 - y[10]), d2 - (v2 - y[11]), d3 - (v3 - y[12])))
