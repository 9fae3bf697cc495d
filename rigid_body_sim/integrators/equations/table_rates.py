# SPDX-License-Identifier: Apache-2.0
"""The equations of a sphere on a table under a held force F and couple T.

Coulomb friction f acts at the lowest point.

Symbols as in rigid_body_sim/motions/sliding_sphere.py: a radius, M mass, k = I/(M a^2), mu, g, z
up, u = v - a omega x z the slip. The normal force is N = M g - F_z (none if that is negative: the
ball stays on the table). With e = a omega x z and p = v + k e, which friction does not change,

    u' = G + (1 + 1/k) f/M,    G = F/M - (T x z)/(k M a),
    p' = F/M + (T x z)/(M a),    I omega_z' = T_z,
    v = (p + k u)/(1 + k),   e = (p - u)/(1 + k).

SLIDING: f = -mu N u/|u|. Where u dies its direction may turn ever faster, so there time is an
unknown too and the independent variable is s with dt = |u| ds: everything is smooth in s, and |u|
dies like an exponential. ROLLING: u = 0, f = -M G k/(1 + k), as long as |f| <= mu N. GLIDING: no
friction. CREEPING: slip that has just begun. It is so small that it follows G, whose direction
turns with the body at a rate below |omega|, with a lag of u |omega|/G at most: u' = (1 - c/G) G
with c = (1 + 1/k) mu N/M. All but SLIDING have t for their independent variable.
"""


from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.numerics.functions import hypot
from rigid_body_sim.numerics.rotations import multiply, rotate

RADIUS, RATIO, MASS, FRICTION, GRAVITY = range(5)    # as sliding_sphere.parameters
MODE, WORLD_FORCE, WORLD_COUPLE, BODY_FORCE, BODY_COUPLE = 5, 6, 9, 12, 15
PARAMETERS = 18
SLIDING, ROLLING, GLIDING, CREEPING = range(4)

# unknowns: attitude, slip u, p, omega_z, place since the start, time since the start; then the
# ledger
Q, U, P, SPIN, PLACE, TIME = 0, 4, 6, 8, 9, 11
UNKNOWNS = 12
GROUPS = (
    (Q, U, True),
    (U, SPIN, False),
    (SPIN, PLACE, False),
    (PLACE, TIME, False),
    (TIME, UNKNOWNS, False),
)


@compiled
def wrench(p, qx, qy, qz, qw):
    """Return force and couple, world axes."""
    fx, fy, fz = rotate(qx, qy, qz, qw, p[BODY_FORCE], p[BODY_FORCE + 1], p[BODY_FORCE + 2])
    tx, ty, tz = rotate(qx, qy, qz, qw, p[BODY_COUPLE], p[BODY_COUPLE + 1], p[BODY_COUPLE + 2])
    return (p[WORLD_FORCE] + fx, p[WORLD_FORCE + 1] + fy, p[WORLD_FORCE + 2] + fz,
            p[WORLD_COUPLE] + tx, p[WORLD_COUPLE + 1] + ty, p[WORLD_COUPLE + 2] + tz)


@compiled
def drive(p, y):
    """Return G (x, y) and c = (1 + 1/k) mu N/M.

    c is the largest deceleration of the slip that friction can give.
    """
    fx, fy, fz, tx, ty, _ = wrench(p, y[0], y[1], y[2], y[3])
    a, k, M = p[RADIUS], p[RATIO], p[MASS]
    return (
        fx / M - ty / (k * M * a),
        fy / M + tx / (k * M * a),
        (1.0 + 1.0 / k) * p[FRICTION] * max(0.0, p[GRAVITY] - fz / M),
    )


@compiled
def motion(p, y):
    """Return v (x, y) and omega (x, y, z), world axes."""
    a, k = p[RADIUS], p[RATIO]
    vx, vy = (y[6] + k * y[4]) / (1.0 + k), (y[7] + k * y[5]) / (1.0 + k)
    return vx, vy, (y[5] - y[7]) / ((1.0 + k) * a), (y[6] - y[4]) / ((1.0 + k) * a), y[8]


@compiled
def rate(p, y):
    """Return the rates of the unknowns, then of the ledger.

    Per unit of the independent variable.
    """
    a, k, M = p[RADIUS], p[RATIO], p[MASS]
    fx, fy, _, tx, ty, tz = wrench(p, y[0], y[1], y[2], y[3])
    gx, gy, c = drive(p, y)
    vx, vy, wx, wy, wz = motion(p, y)
    pace, ux, uy = 1.0, 0.0, 0.0
    if p[MODE] == SLIDING:
        pace = hypot(y[4], y[5])
        ux, uy = pace * gx - c * y[4], pace * gy - c * y[5]
    elif p[MODE] == GLIDING:
        ux, uy = gx, gy
    elif p[MODE] == CREEPING:
        G = hypot(gx, gy)
        share_left = max(0.0, 1.0 - c / G) if G > 0.0 else 0.0
        ux, uy = share_left * gx, share_left * gy
    # pace times friction, from u' = G + (1 + 1/k) f/M
    share = M * k / (1.0 + k)
    rubx, ruby = share * (ux - pace * gx), share * (uy - pace * gy)
    half = 0.5 * pace
    qx, qy, qz, qw = multiply(half * wx, half * wy, half * wz, 0.0, y[0], y[1], y[2], y[3])
    return (
        qx,
        qy,
        qz,
        qw,
        ux,
        uy,
        pace * (fx / M + ty / (M * a)),
        pace * (fy / M - tx / (M * a)),
        pace * tz / (k * M * a * a),
        pace * vx,
        pace * vy,
        pace,
        pace * (fx * vx + fy * vy + tx * wx + ty * wy + tz * wz),
        -(rubx * y[4] + ruby * y[5]),
        pace * tx + a * ruby,
        pace * ty - a * rubx,
        pace * tz,
    )
