"""Elementary wrenches: the few formulas of which gravity, torques and held commands are made.

Every kernel has the signature that rigid_body_sim/effects/views.py asks of an `Acting`: its own values, then the attitude (qx, qy, qz,
qw) of the frame, its angular velocity (frame components) and the velocity of the centre of mass (world components). `r` is the arm from
the reference point to the centre of mass (frame components, m).
"""

from rigid_body_sim.compiled import compiled
from rigid_body_sim.rotations import rotate, rotate_back


@compiled
def constant(ux, uy, uz, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return the vector u as it is: a force given in world axes, or a couple given in body axes."""
    return ux, uy, uz


@compiled
def to_frame(ux, uy, uz, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return the frame components of a couple given in world axes, R^T u."""
    return rotate_back(qx, qy, qz, qw, ux, uy, uz)


@compiled
def to_world(ux, uy, uz, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return the world components of a force given in body axes, R u."""
    return rotate(qx, qy, qz, qw, ux, uy, uz)


@compiled
def moment(rx, ry, rz, fx, fy, fz, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return the torque r x R^T F (N m, frame components) about the reference point of a force F given in world axes."""
    ux, uy, uz = rotate_back(qx, qy, qz, qw, fx, fy, fz)
    return ry * uz - rz * uy, rz * ux - rx * uz, rx * uy - ry * ux


@compiled
def moment_of_weight(sx, sy, sz, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return the torque of gravity -s x (R^T z) with s = M g r (N m): `moment` for F = -M g z, where only the third row of R is needed.

    R^T z = (2 (x z - w y), 2 (y z + w x), w^2 + z^2 - x^2 - y^2) with the quaternion (x, y, z, w); the factor 2 of the first two stands
    out.
    """
    gx, gy = 2.0 * (qx * qz - qw * qy), 2.0 * (qy * qz + qw * qx)
    gz = (qw * qw - qx * qx) + (qz * qz - qy * qy)
    return sz * gy - sy * gz, sx * gz - sz * gx, sy * gx - sx * gy
