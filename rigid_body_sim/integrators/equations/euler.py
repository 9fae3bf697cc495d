"""Euler's equations in the frame of a scene (rigid_body_sim/scene/effects/views.py), and the way from that frame to a state vector.

Layout of the first parameters of every scene kind; the values of all that acts stand behind them.
"""

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.numerics.rotations import multiply, normalised, rotate, rotate_back

EULER, INVERSE, MOMENTS = 0, 3, 6          # (I2 - I3)/I1 ..., 1/I1 ..., I1 ...; the first two are 0 where the moment is 0
AXES, POINT = 9, 13                        # quaternion, frame -> body; body origin -> point of reference, frame components
START, PLACE, DRIFT = 16, 17, 20           # time, position and velocity of the point of reference at the start (world)
MASS, MOVES = 23, 24                       # MOVES: 1 of a free body, 0 where the point of reference is held
FIXED = 25


@compiled
def taken(p, tx, ty, tz):
    """Return the part of a torque that turns the body: none about an axis of zero moment, which a thin rod cannot take."""
    return (tx if p[INVERSE] > 0.0 else 0.0), (ty if p[INVERSE + 1] > 0.0 else 0.0), (tz if p[INVERSE + 2] > 0.0 else 0.0)


@compiled
def attitude_rate(qx, qy, qz, qw, wx, wy, wz):
    """Return q' = q omega / 2."""
    hx, hy, hz = 0.5 * wx, 0.5 * wy, 0.5 * wz
    return ((qw * hx + (qy * hz - qz * hy)), (qw * hy + (qz * hx - qx * hz)), (qw * hz + (qx * hy - qy * hx)),
            -(qx * hx + (qy * hy + qz * hz)))


@compiled
def lost_norm(qx, qy, qz, qw):
    """Return (1 - |q|^2)/2, what q must be stretched by to have norm 1 again, to second order."""
    return 0.5 * ((1.0 - qw * qw - qz * qz) - qx * qx - qy * qy)


@compiled
def unit(qx, qy, qz, qw, cx, cy, cz, cw):
    """Return q + c with norm 1, as the nearest doubles and what they lose.

    The stretch must go into q itself: left in c it would be added after the next step, which turns q by x, half the angle of the body, and
    so shrink the error of the norm to 1 - cos(x) only: beyond a quarter turn of q errors would grow from step to step.
    """
    lost = lost_norm(qx, qy, qz, qw) - (qx * cx + qy * cy + qz * cz + qw * cw)
    dx, dy, dz, dw = cx + lost * qx, cy + lost * qy, cz + lost * qz, cw + lost * qw
    sx, sy, sz, sw = qx + dx, qy + dy, qz + dz, qw + dw
    return (sx, sy, sz, sw), (dx - (sx - qx), dy - (sy - qy), dz - (sz - qz), dw - (sw - qw))


@compiled
def read_state(p, vector):
    """Set the parameters that a start, a state vector, decides; return q and omega of the frame, place and velocity of its point (world)."""
    ax, ay, az, aw = p[AXES], p[AXES + 1], p[AXES + 2], p[AXES + 3]
    px, py, pz = p[POINT], p[POINT + 1], p[POINT + 2]
    qx, qy, qz, qw = multiply(vector[1], vector[2], vector[3], vector[4], ax, ay, az, aw)
    wx, wy, wz = rotate_back(ax, ay, az, aw, vector[5], vector[6], vector[7])
    ux, uy, uz = rotate(qx, qy, qz, qw, px, py, pz)
    x, y, z = vector[8] + ux, vector[9] + uy, vector[10] + uz
    ux, uy, uz = rotate(qx, qy, qz, qw, wy * pz - wz * py, wz * px - wx * pz, wx * py - wy * px)
    vx, vy, vz = p[MOVES] * (vector[11] + ux), p[MOVES] * (vector[12] + uy), p[MOVES] * (vector[13] + uz)
    p[START], p[PLACE], p[PLACE + 1], p[PLACE + 2], p[DRIFT], p[DRIFT + 1], p[DRIFT + 2] = vector[0], x, y, z, vx, vy, vz
    return (qx, qy, qz, qw), taken(p, wx, wy, wz), (x, y, z), (vx, vy, vz)


@compiled
def write_state(p, time, qx, qy, qz, qw, wx, wy, wz, x, y, z, vx, vy, vz, out):
    """Fill out, the state vector, from q and omega of the frame and from position and velocity of the point of reference (world)."""
    ax, ay, az, aw = p[AXES], p[AXES + 1], p[AXES + 2], p[AXES + 3]
    px, py, pz = p[POINT], p[POINT + 1], p[POINT + 2]
    qx, qy, qz, qw = normalised(qx, qy, qz, qw)
    out[0] = time
    out[1], out[2], out[3], out[4] = multiply(qx, qy, qz, qw, -ax, -ay, -az, aw)
    out[5], out[6], out[7] = rotate(ax, ay, az, aw, wx, wy, wz)
    out[8], out[9], out[10], out[11], out[12], out[13] = x, y, z, vx, vy, vz
    if px != 0.0 or py != 0.0 or pz != 0.0:
        ux, uy, uz = rotate(qx, qy, qz, qw, px, py, pz)
        out[8], out[9], out[10] = x - ux, y - uy, z - uz
        ux, uy, uz = rotate(qx, qy, qz, qw, wy * pz - wz * py, wz * px - wx * pz, wx * py - wy * px)
        out[11], out[12], out[13] = vx - ux, vy - uy, vz - uz
