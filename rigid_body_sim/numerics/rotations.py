# SPDX-License-Identifier: Apache-2.0
"""Rotations as unit quaternions (x, y, z, w), as in ROS and SciPy, and as z-y-z Euler angles.

A quaternion turns body vectors into world vectors. Kernels take and return scalars in tuples. The
product p q means the rotation q followed by p. Euler angles are those of the notes (section
"Euler angles for rigid body in inertial frame"): R = Rz(alpha) Ry(beta) Rz(gamma).
"""

import math

from rigid_body_sim.compilation.jit import compiled, inlined
from rigid_body_sim.numerics.functions import atan2, cos, hypot, sin


@compiled
def multiply(px, py, pz, pw, qx, qy, qz, qw):
    """Return the quaternion of the rotation q followed by p."""
    return (pw * qx + px * qw + py * qz - pz * qy,
            pw * qy - px * qz + py * qw + pz * qx,
            pw * qz + px * qy - py * qx + pz * qw,
            pw * qw - px * qx - py * qy - pz * qz)


@compiled
def rotate(qx, qy, qz, qw, vx, vy, vz):
    """Return the world components of the body vector v.

    They are v + 2 w (u x v) + 2 u x (u x v) with u = (qx, qy, qz).
    """
    tx = 2.0 * (qy * vz - qz * vy)
    ty = 2.0 * (qz * vx - qx * vz)
    tz = 2.0 * (qx * vy - qy * vx)
    return (vx + qw * tx + qy * tz - qz * ty,
            vy + qw * ty + qz * tx - qx * tz,
            vz + qw * tz + qx * ty - qy * tx)


@compiled
def rotate_back(qx, qy, qz, qw, vx, vy, vz):
    """Return the body components of the world vector v."""
    return rotate(-qx, -qy, -qz, qw, vx, vy, vz)


@compiled
def normalised(qx, qy, qz, qw):
    """Return q / |q|; the norm must not be zero.

    A sum of squares near 1 rounds more finely below 1 than above, and quaternions divided by its
    root come out 0.6 ulp long on average, which becomes a trend if it happens at every tick. So
    the last bits are corrected by |q|^2 - 1, summed near 0, where rounding is symmetric.
    """
    if abs(_excess(qx, qy, qz, qw)) > 1e-9:
        scale = 1.0 / math.sqrt(qx * qx + qy * qy + qz * qz + qw * qw)
        qx, qy, qz, qw = qx * scale, qy * scale, qz * scale, qw * scale
    half = 0.5 * _excess(qx, qy, qz, qw)
    return qx - qx * half, qy - qy * half, qz - qz * half, qw - qw * half


def turn_to(x, y, z):
    """Return a quaternion that turns the third axis into the unit vector (x, y, z)."""
    if z < 0.0:    # -z into it, after z into -z
        return multiply(*normalised(y, -x, 0.0, 1.0 - z), 1.0, 0.0, 0.0, 0.0)
    return normalised(-y, x, 0.0, 1.0 + z)


@compiled
def _excess(qx, qy, qz, qw):
    """Return |q|^2 - 1."""
    return ((qx * qx - 0.25) + (qy * qy - 0.25)) + ((qz * qz - 0.25) + (qw * qw - 0.25))


@inlined
def matrix(qx, qy, qz, qw):
    """Return the rows of the rotation matrix of q, which turns body into world components."""
    return ((1.0 - 2.0 * (qy * qy + qz * qz), 2.0 * (qx * qy - qz * qw),
             2.0 * (qx * qz + qy * qw)),
            (2.0 * (qx * qy + qz * qw), 1.0 - 2.0 * (qx * qx + qz * qz),
             2.0 * (qy * qz - qx * qw)),
            (2.0 * (qx * qz - qy * qw), 2.0 * (qy * qz + qx * qw),
             1.0 - 2.0 * (qx * qx + qy * qy)))


def from_matrix(R):
    """Return the quaternion, with w >= 0, of a rotation matrix given by its rows.

    The diagonal shows which component is largest, and that one divides the others
    (S. W. Shepperd, Journal of Guidance and Control 1 (1978) 223).
    """
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = R
    # (2 x)^2, (2 y)^2, (2 z)^2, (2 w)^2
    squares = (1.0 + xx - yy - zz, 1.0 - xx + yy - zz, 1.0 - xx - yy + zz, 1.0 + xx + yy + zz)
    k = squares.index(max(squares))
    products = ((squares[0], xy + yx, xz + zx, zy - yz), (xy + yx, squares[1], yz + zy, xz - zx),
                (xz + zx, yz + zy, squares[2], yx - xy),
                (zy - yz, xz - zx, yx - xy, squares[3]))[k]
    scale = math.copysign(0.5 / math.sqrt(squares[k]), products[3])
    return normalised(*(scale * product for product in products))


@compiled
def from_rotation_vector(rx, ry, rz):
    """Return the quaternion of the rotation by the angle |r| (rad) about r."""
    angle = math.sqrt(rx * rx + ry * ry + rz * rz)
    half = 0.5 * angle
    # sin(half) / angle: its series has no term below half^2 / 6, which is under an ulp there
    factor = 0.5 if angle < 1e-8 else sin(half) / angle
    return rx * factor, ry * factor, rz * factor, cos(half)


@compiled
def angle_between(px, py, pz, pw, qx, qy, qz, qw):
    """Return the angle (rad, 0 to pi) of the rotation that takes one attitude to the other.

    It is accurate for small angles too.
    """
    x, y, z, w = multiply(-px, -py, -pz, pw, qx, qy, qz, qw)
    return 2.0 * atan2(math.sqrt(x * x + y * y + z * z), abs(w))


@compiled
def angles_between(p, q, out):
    """Fill out, shape (n,), with the angles (rad) between n attitudes and n others, (n, 4)."""
    for k in range(len(out)):
        out[k] = angle_between(p[k, 0], p[k, 1], p[k, 2], p[k, 3],
                               q[k, 0], q[k, 1], q[k, 2], q[k, 3])


@compiled
def from_euler_zyz(alpha, beta, gamma):
    """Return the quaternion of R = Rz(alpha) Ry(beta) Rz(gamma)."""
    sine, cosine = sin(0.5 * beta), cos(0.5 * beta)
    total, difference = 0.5 * (alpha + gamma), 0.5 * (alpha - gamma)
    return (-sine * sin(difference), sine * cos(difference),
            cosine * sin(total), cosine * cos(total))


@compiled
def to_euler_zyz(qx, qy, qz, qw):
    """Return (alpha, beta, gamma) with alpha, gamma in (-pi, pi] and beta in [0, pi].

    At beta = 0 and pi only the sum or the difference of alpha and gamma is defined; there gamma
    is 0.
    """
    upright, inverted = hypot(qz, qw), hypot(qx, qy)
    beta = 2.0 * atan2(inverted, upright)
    total = atan2(qz, qw)
    difference = atan2(-qx, qy)
    if inverted == 0.0:
        return _wrapped(2.0 * total), 0.0, 0.0
    if upright == 0.0:
        return _wrapped(2.0 * difference), beta, 0.0
    return _wrapped(total + difference), beta, _wrapped(total - difference)


@compiled
def _wrapped(angle):
    if angle > math.pi:
        return angle - 2.0 * math.pi
    if angle <= -math.pi:
        return angle + 2.0 * math.pi
    return angle
