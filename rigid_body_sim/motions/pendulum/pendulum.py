"""Physical pendulum: a body on a hinge of any direction, in closed form over any time, with gravity or without (notes, "Kater's Pendulum").

Symbols: n the axis (unit vector, the same in the body and in the world), I the moment about it, r the arm from `through` to the centre of mass,
gamma the vertical in body axes, d and G the parts of r and gamma across n; phi the angle of r from its lowest position, positive about n.

    phi'' = -Omega^2 sin(phi),    Omega^2 = M g d G/I,    d G cos(phi) = -r_across . gamma,    d G sin(phi) = (n x r) . gamma.

With s = sin(phi/2), c = cos(phi/2) and w = phi'/2, both w^2 + Omega^2 s^2 and Delta = Omega^2 c^2 - w^2 = (Omega c - w)(Omega c + w) stay.
Delta decides, and gives the complementary modulus without cancellation:

    swings, Delta >= 0:   w = Omega k cn u,   s = k sn u,   c = dn u,    u' = Omega,      k' = sqrt(Delta)/Omega
    turns over, < 0:      c = cn u,           s = sn u,     w = h dn u,  u' = h,          k' = sqrt(-Delta)/h,     h^2 = w^2 + Omega^2 s^2

The quaternion of the rotation by phi about n is (n s, c): no angle is ever formed, and its sign is continuous. sn, cn and dn are the theta
functions of free_rotation.py (w, s and c move like the omega of a free body), separatrix included; the phase u/(4 K) is in turns, its rate a
pair of doubles. Omega = 0 (vertical axis, centre of mass on the axis, no gravity) and equilibria are uniform rotations.

Kernels besides those of every motion: `states`, the same operations as `state` on many times side by side; `next_event` (the rate changes its
sign); `reaction`.
Sources: Whittaker, Analytical Dynamics, section 44; NIST DLMF 22.19(i).
"""

import math

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.motions.free_body.rotation import (
    CIRCULAR,
    FORM,
    HYPERBOLIC,
    PERIOD,
    PHASE,
    RATE,
    START,
)
from rigid_body_sim.motions.loops import BLOCK
from rigid_body_sim.motions.pendulum import anchor
from rigid_body_sim.motions.pendulum.anchor import (
    ARM,
    COSINE,
    GRAVITY,
    MASS,
    MIDDLE,
    MOMENTUM,
    NEVER,
    NORMAL,
    SINE,
    SWINGS,
    TURNED,
    UNIT,
    UPRIGHT,
    WEIGHT,
    circular,
    functions,
    hyperbolic,
    steady,
)
from rigid_body_sim.numerics.double_double import two_sum
from rigid_body_sim.numerics.phase import COUNTABLE
from rigid_body_sim.numerics.rotations import rotate, rotate_back
from rigid_body_sim.scene.constraints import Hinge
from rigid_body_sim.scene.effects.gravity import Gravity

EVENTS = ('turning point',)
exchanged = None

PARAMETER_SIZE, ANCHOR_SIZE = anchor.PARAMETER_SIZE, anchor.ANCHOR_SIZE
parameters, anchor = anchor.parameters, anchor.anchor


def absorbs(scene):
    """Return whether the scene is a body on a hinge under its weight alone, or under nothing."""
    return isinstance(scene.constraint, Hinge) and scene.lists_only(Gravity)


@compiled
def state(c, time, out):
    """Fill out with the state (14 doubles) at a time before or after the anchor c."""
    dt, dt_low = two_sum(time, -c[START])
    out[0] = time
    (out[1], out[2], out[3], out[4], out[5], out[6], out[7],
     out[8], out[9], out[10], out[11], out[12], out[13]) = _pose(c, *functions(c, dt, dt_low))


@compiled_inline
def _pose(c, sine, cosine, half_rate):
    """Return the state without its time, of s, c and w."""
    a, b, n, m, e, f = UPRIGHT, TURNED, NORMAL, MIDDLE, COSINE, SINE
    x, y = cosine * c[a] + sine * c[b], cosine * c[a + 1] + sine * c[b + 1]
    z, w = cosine * c[a + 2] + sine * c[b + 2], cosine * c[a + 3] + sine * c[b + 3]
    scale = 1.0 / math.sqrt(x * x + y * y + z * z + w * w)
    rate = 2.0 * half_rate
    cosine, sine = (cosine - sine) * (cosine + sine), 2.0 * sine * cosine
    return (scale * x, scale * y, scale * z, scale * w, rate * c[n], rate * c[n + 1], rate * c[n + 2],
            c[m] - (cosine * c[e] + sine * c[f]), c[m + 1] - (cosine * c[e + 1] + sine * c[f + 1]),
            c[m + 2] - (cosine * c[e + 2] + sine * c[f + 2]), rate * (sine * c[e] - cosine * c[f]),
            rate * (sine * c[e + 1] - cosine * c[f + 1]), rate * (sine * c[e + 2] - cosine * c[f + 2]))


@compiled
def fill_columns(c, times, columns):
    """Fill columns, BLOCK times, BLOCK times x, ..., with up to BLOCK states: the operations of `state`, arranged to become vector code."""
    if c[FORM] == CIRCULAR:
        for k in range(len(times)):
            _keep(columns, k, times[k], _pose(c, *circular(c, *two_sum(times[k], -c[START]))))
    elif c[FORM] == HYPERBOLIC:
        for k in range(len(times)):
            _keep(columns, k, times[k], _pose(c, *hyperbolic(c, *two_sum(times[k], -c[START]))))
    else:
        for k in range(len(times)):
            _keep(columns, k, times[k], _pose(c, *steady(c, *two_sum(times[k], -c[START]))))


@compiled_inline
def _keep(columns, k, time, pose):
    b = BLOCK
    columns[k] = time
    (columns[b + k], columns[2 * b + k], columns[3 * b + k], columns[4 * b + k], columns[5 * b + k], columns[6 * b + k], columns[7 * b + k],
     columns[8 * b + k], columns[9 * b + k], columns[10 * b + k], columns[11 * b + k], columns[12 * b + k], columns[13 * b + k]) = pose


@compiled
def next_event(c, after):
    """Return the time of the first turning point later than `after`, infinite if there is none, and the code 0."""
    if c[SWINGS] == 0.0 or (c[FORM] == HYPERBOLIC and c[PERIOD] >= NEVER):
        return math.inf, 0
    half_turns = math.floor(2.0 * (c[RATE] * (after - c[START]) + c[PHASE])) - 1.0
    if not abs(half_turns) < COUNTABLE:
        return math.inf, 0
    time = _turning_time(c, half_turns)
    while time <= after:
        half_turns += 1.0
        time = _turning_time(c, half_turns)
    return time, 0


@compiled
def _turning_time(c, half_turns):
    """Return when the phase is a quarter turn and that many half turns."""
    return c[START] + (0.25 + 0.5 * half_turns - c[PHASE]) / c[RATE]


@compiled
def reaction(p, state, out):
    """Fill out, shape (6,), with force (N) and couple (N m) of the bearing on the body at the point `through`, world axes.

    Newton and Euler about that point, which does not move, with I the tensor there and Gamma the torque of the weight:
    force = M (r'' + g z), couple = I n phi'' + phi'^2 n x I n - Gamma.
    """
    x, y, z, w = state[1], state[2], state[3], state[4]
    nx, ny, nz, rx, ry, rz = p[UNIT], p[UNIT + 1], p[UNIT + 2], p[ARM], p[ARM + 1], p[ARM + 2]
    jx, jy, jz = p[MOMENTUM], p[MOMENTUM + 1], p[MOMENTUM + 2]
    gx, gy, gz = rotate_back(x, y, z, w, 0.0, 0.0, 1.0)
    sx, sy, sz = ny * rz - nz * ry, nz * rx - nx * rz, nx * ry - ny * rx
    rate = nx * state[5] + ny * state[6] + nz * state[7]
    growth, squared, weight = -p[WEIGHT] * (sx * gx + sy * gy + sz * gz), rate * rate, p[MASS] * p[GRAVITY]
    fx = p[MASS] * (growth * sx + squared * (ny * sz - nz * sy)) + weight * gx
    fy = p[MASS] * (growth * sy + squared * (nz * sx - nx * sz)) + weight * gy
    fz = p[MASS] * (growth * sz + squared * (nx * sy - ny * sx)) + weight * gz
    cx = growth * jx + squared * (ny * jz - nz * jy) + weight * (ry * gz - rz * gy)
    cy = growth * jy + squared * (nz * jx - nx * jz) + weight * (rz * gx - rx * gz)
    cz = growth * jz + squared * (nx * jy - ny * jx) + weight * (rx * gy - ry * gx)
    out[0], out[1], out[2] = rotate(x, y, z, w, fx, fy, fz)
    out[3], out[4], out[5] = rotate(x, y, z, w, cx, cy, cz)
