# SPDX-License-Identifier: Apache-2.0
"""Elementary forces and torques: the few formulas of gravity, torques and held commands.

Every kernel has the signature that an `Acting` asks for (protocol.py): its own values, then the
attitude (qx, qy, qz, qw) of the frame, its angular velocity (frame components) and the velocity of
the centre of mass (world components). `r` is the arm from the reference point to the centre of
mass (frame components, m).
"""

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.numerics.rotations import rotate, rotate_back


@compiled
def constant(ux, uy, uz, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return the vector u as it is: a force in world axes, or a couple in body axes."""
    return ux, uy, uz


@compiled
def to_frame(ux, uy, uz, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return the frame components of a couple given in world axes, R^T u."""
    return rotate_back(qx, qy, qz, qw, ux, uy, uz)


@compiled
def held_force(fx, fy, fz, ux, uy, uz, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return the force F + R u (N, world components) of F in world axes and u in the frame's."""
    ux, uy, uz = rotate(qx, qy, qz, qw, ux, uy, uz)
    return fx + ux, fy + uy, fz + uz


@compiled
def held_torque(tx, ty, tz, ux, uy, uz, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return the couple R^T T + u (N m, frame components) of T in world axes, u in the frame's."""
    tx, ty, tz = rotate_back(qx, qy, qz, qw, tx, ty, tz)
    return tx + ux, ty + uy, tz + uz


@compiled
def held_about_point(rx, ry, rz, fx, fy, fz, tx, ty, tz, sx, sy, sz,
                     qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return the torque r x R^T F + R^T T + s (N m, frame components) about the point.

    F and T are given in world axes, s in the frame's.
    """
    fx, fy, fz = rotate_back(qx, qy, qz, qw, fx, fy, fz)
    tx, ty, tz = rotate_back(qx, qy, qz, qw, tx, ty, tz)
    return ry * fz - rz * fy + tx + sx, rz * fx - rx * fz + ty + sy, rx * fy - ry * fx + tz + sz


@compiled
def moment_of_weight(sx, sy, sz, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return the torque of gravity -s x (R^T z) with s = M g r (N m).

    R^T z = (2 (x z - w y), 2 (y z + w x), w^2 + z^2 - x^2 - y^2) with the quaternion (x, y, z, w):
    only the third row of R is needed.
    """
    gx, gy = 2.0 * (qx * qz - qw * qy), 2.0 * (qy * qz + qw * qx)
    gz = (qw * qw - qx * qx) + (qz * qz - qy * qy)
    return sz * gy - sy * gz, sx * gz - sz * gx, sy * gx - sx * gy
