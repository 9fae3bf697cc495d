"""Motion of a free rigid body, in closed form over any time: no torque, perhaps a uniform field; every inertia.

The rotation is that of free_rotation.py, which has the equations; free_anchor.py computes what it takes. The centre of mass flies on a
parabola; the pose is that of the body's origin, which may be elsewhere.

Kernels besides those of every motion: `states`, the same operations as `state` on many times side by side, and `next_event`. The event is
`flip`: the momentum along the axis of the middle moment changes its sign, in a motion that takes it to at least L/2. (That is the hysteresis:
in one motion either every change of sign is a flip or none, so none is lost or counted twice when the motion is anchored anew on the way.)
"""

import math

import numpy as np

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.motions.free_body import anchor as rotation_anchor
from rigid_body_sim.motions.free_body.anchor import (
    ROUNDING,
    TO_BODY,
    TO_WORLD,
    TUMBLES,
    fill_rotation,
    rotation_parameters,
)
from rigid_body_sim.motions.free_body.rotation import (
    CIRCULAR,
    FORM,
    HYPERBOLIC,
    PHASE,
    RATE,
    START,
    circular,
    hyperbolic,
    steady,
    turned,
)
from rigid_body_sim.motions.loops import BLOCK
from rigid_body_sim.numerics.double_double import two_sum
from rigid_body_sim.numerics.phase import COUNTABLE
from rigid_body_sim.numerics.rotations import rotate
from rigid_body_sim.scene.constraints import Free
from rigid_body_sim.scene.effects.gravity import Gravity

EVENTS = ('flip',)
exchanged = None

# layout of the parameters behind those of the rotation: centre of mass, g
CENTER, GRAVITY = rotation_anchor.PARAMETER_SIZE, rotation_anchor.PARAMETER_SIZE + 3
PARAMETER_SIZE = GRAVITY + 1
# layout of the anchor behind that of the rotation: position and velocity of the centre of mass, g, its place in the body, 1 if not the origin
POSITION, VELOCITY, FIELD, ARM, OFFSET = (rotation_anchor.SIZE + k for k in (0, 3, 6, 7, 10))
ANCHOR_SIZE = OFFSET + 1



def absorbs(scene):
    """Return whether this motion solves the whole scene."""
    return isinstance(scene.constraint, Free) and scene.lists_only(Gravity)


def parameters(scene):
    """Return the numbers of the scene that the kernels take, shape (PARAMETER_SIZE,)."""
    g = sum(effect.g for effect in scene.effects if effect.name == 'gravity')
    return np.concatenate([rotation_parameters(scene.body.about_center), scene.body.center_of_mass, [g]])


@compiled
def anchor(p, start, out):
    """Precompute the motion from a state (14 doubles, its time included); the angular velocity along an axis of zero moment must be 0."""
    fill_rotation(p, start, out)
    cx, cy, cz = p[CENTER], p[CENTER + 1], p[CENTER + 2]
    qx, qy, qz, qw, wx, wy, wz = start[1], start[2], start[3], start[4], start[5], start[6], start[7]
    rx, ry, rz = rotate(qx, qy, qz, qw, cx, cy, cz)
    ux, uy, uz = rotate(qx, qy, qz, qw, wy * cz - wz * cy, wz * cx - wx * cz, wx * cy - wy * cx)
    out[POSITION], out[POSITION + 1], out[POSITION + 2] = start[8] + rx, start[9] + ry, start[10] + rz
    out[VELOCITY], out[VELOCITY + 1], out[VELOCITY + 2] = start[11] + ux, start[12] + uy, start[13] + uz
    out[FIELD], out[ARM], out[ARM + 1], out[ARM + 2] = p[GRAVITY], cx, cy, cz
    out[OFFSET] = 1.0 if cx != 0.0 or cy != 0.0 or cz != 0.0 else 0.0


@compiled
def state(c, time, out):
    """Fill out with the state (14 doubles) at a time before or after the anchor c."""
    dt, dt_low = two_sum(time, -c[START])
    w1, w2, w3, x, y, z, w = turned(c, dt, dt_low)
    qx, qy, qz, qw, wx, wy, wz = _attitude_and_omega(c, w1, w2, w3, x, y, z, w)
    rx, ry, rz, vx, vy, vz = _flight(c, dt)
    if c[OFFSET] != 0.0:
        rx, ry, rz, vx, vy, vz = _origin(c, qx, qy, qz, qw, wx, wy, wz, rx, ry, rz, vx, vy, vz)
    out[0] = time
    out[1], out[2], out[3], out[4] = qx, qy, qz, qw
    out[5], out[6], out[7] = wx, wy, wz
    out[8], out[9], out[10], out[11], out[12], out[13] = rx, ry, rz, vx, vy, vz


@compiled_inline
def _attitude_and_omega(c, w1, w2, w3, x, y, z, w):
    """Return the orientation and omega (body axes) of what :func:`turned` returns."""
    g, m, d = TO_WORLD, TO_BODY, ROUNDING
    scale = 1.0 / math.sqrt(x * x + y * y + z * z + w * w)
    x, y, z, w = scale * x, scale * y, scale * z, scale * w
    return (c[g] * x + c[g + 1] * y + c[g + 2] * z + c[g + 3] * w, c[g + 4] * x + c[g + 5] * y + c[g + 6] * z + c[g + 7] * w,
            c[g + 8] * x + c[g + 9] * y + c[g + 10] * z + c[g + 11] * w, c[g + 12] * x + c[g + 13] * y + c[g + 14] * z + c[g + 15] * w,
            c[m] * w1 + c[m + 1] * w2 + c[m + 2] * w3 + c[d], c[m + 3] * w1 + c[m + 4] * w2 + c[m + 5] * w3 + c[d + 1],
            c[m + 6] * w1 + c[m + 7] * w2 + c[m + 8] * w3 + c[d + 2])


@compiled_inline
def _flight(c, dt):
    """Return position and velocity of the centre of mass."""
    r, v, fall = POSITION, VELOCITY, c[FIELD] * dt
    return (c[r] + c[v] * dt, c[r + 1] + c[v + 1] * dt, c[r + 2] + (c[v + 2] - 0.5 * fall) * dt, c[v], c[v + 1], c[v + 2] - fall)


@compiled_inline
def _origin(c, qx, qy, qz, qw, wx, wy, wz, rx, ry, rz, vx, vy, vz):
    """Return position and velocity of the body's origin, from those of the centre of mass."""
    cx, cy, cz = c[ARM], c[ARM + 1], c[ARM + 2]
    dx, dy, dz = rotate(qx, qy, qz, qw, cx, cy, cz)
    ux, uy, uz = rotate(qx, qy, qz, qw, wy * cz - wz * cy, wz * cx - wx * cz, wx * cy - wy * cx)
    return rx - dx, ry - dy, rz - dz, vx - ux, vy - uy, vz - uz


@compiled
def fill_columns(c, times, columns):
    """Fill columns, BLOCK times, BLOCK times x, ..., with up to BLOCK states: the operations of `state`, arranged to become vector code."""
    b = BLOCK
    if c[FORM] == CIRCULAR:
        for k in range(len(times)):
            dt, dt_low = two_sum(times[k], -c[START])
            w1, w2, w3, x, y, z, w = circular(c, dt, dt_low)
            x, y, z, w, w1, w2, w3 = _attitude_and_omega(c, w1, w2, w3, x, y, z, w)
            _keep(columns, k, times[k], x, y, z, w, w1, w2, w3)
    elif c[FORM] == HYPERBOLIC:
        for k in range(len(times)):
            dt, dt_low = two_sum(times[k], -c[START])
            w1, w2, w3, x, y, z, w = hyperbolic(c, dt, dt_low)
            x, y, z, w, w1, w2, w3 = _attitude_and_omega(c, w1, w2, w3, x, y, z, w)
            _keep(columns, k, times[k], x, y, z, w, w1, w2, w3)
    else:
        for k in range(len(times)):
            dt, dt_low = two_sum(times[k], -c[START])
            w1, w2, w3, x, y, z, w = steady(c, dt, dt_low)
            x, y, z, w, w1, w2, w3 = _attitude_and_omega(c, w1, w2, w3, x, y, z, w)
            _keep(columns, k, times[k], x, y, z, w, w1, w2, w3)
    for k in range(len(times)):
        dt, _ = two_sum(times[k], -c[START])
        rx, ry, rz, vx, vy, vz = _flight(c, dt)
        _keep_flight(columns, k, rx, ry, rz, vx, vy, vz)
    if c[OFFSET] != 0.0:
        for k in range(len(times)):
            rx, ry, rz, vx, vy, vz = _origin(
                c, columns[b + k], columns[2 * b + k], columns[3 * b + k], columns[4 * b + k], columns[5 * b + k], columns[6 * b + k],
                columns[7 * b + k], columns[8 * b + k], columns[9 * b + k], columns[10 * b + k], columns[11 * b + k],
                columns[12 * b + k], columns[13 * b + k])
            _keep_flight(columns, k, rx, ry, rz, vx, vy, vz)


@compiled_inline
def _keep(columns, k, time, x, y, z, w, wx, wy, wz):
    b = BLOCK
    columns[k], columns[b + k], columns[2 * b + k], columns[3 * b + k], columns[4 * b + k] = time, x, y, z, w
    columns[5 * b + k], columns[6 * b + k], columns[7 * b + k] = wx, wy, wz


@compiled_inline
def _keep_flight(columns, k, rx, ry, rz, vx, vy, vz):
    b = BLOCK
    columns[8 * b + k], columns[9 * b + k], columns[10 * b + k] = rx, ry, rz
    columns[11 * b + k], columns[12 * b + k], columns[13 * b + k] = vx, vy, vz


@compiled
def next_event(c, after):
    """Return the time of the first flip later than `after`, infinite if there is none, and the code 0."""
    if c[TUMBLES] == 0.0:
        return math.inf, 0
    start, rate, phase = c[START], c[RATE], c[PHASE]
    half_turns = math.floor(2.0 * (rate * (after - start) + phase)) - 1.0
    if not abs(half_turns) < COUNTABLE:
        return math.inf, 0
    time = start + (0.5 * half_turns - phase) / rate
    while time <= after:
        half_turns += 1.0
        time = start + (0.5 * half_turns - phase) / rate
    return time, 0
