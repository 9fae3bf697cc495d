"""Template: the equations of a body on a hinge: the angle phi (rad) since the start about the axis n (frame components), and phi'.

    I phi'' = n . Gamma,    q = q0 (n sin(phi/2), cos(phi/2)),    omega = phi' n

I is the moment about the axis, Gamma the torque about the hinge point; the rest of Gamma is the bearing's.
"""


from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.equations.euler import (
    FIXED,
    INVERSE,
    PLACE,
    read_state,
    write_state,
)
from rigid_body_sim.numerics.functions import cos, sin
from rigid_body_sim.numerics.rotations import multiply, rotate  # noqa: F401 (rotate: for the bound sums)

torque = UNBOUND
booked = UNBOUND

UNKNOWNS = 2
GROUPS = ((0, 1, True), (1, 2, False))
AXIS, ATTITUDE = FIXED, FIXED + 3    # n; q0


@compiled
def start(p, vector, node, at):
    """Set the parameters that a start decides, and fill `node` from `at` on with its unknowns."""
    q, _, _, _ = read_state(p, vector)
    p[ATTITUDE], p[ATTITUDE + 1], p[ATTITUDE + 2], p[ATTITUDE + 3] = q
    node[at], node[at + 1] = 0.0, p[AXIS] * vector[5] + p[AXIS + 1] * vector[6] + p[AXIS + 2] * vector[7]


@compiled
def attitude(p, phi):
    """Return q at an angle."""
    s, c = sin(0.5 * phi), cos(0.5 * phi)
    return multiply(p[ATTITUDE], p[ATTITUDE + 1], p[ATTITUDE + 2], p[ATTITUDE + 3], s * p[AXIS], s * p[AXIS + 1], s * p[AXIS + 2], c)


@compiled
def taken(p, tx, ty, tz):
    """Return the part of a torque that turns the body: the one along the axis."""
    along = p[AXIS] * tx + p[AXIS + 1] * ty + p[AXIS + 2] * tz
    return along * p[AXIS], along * p[AXIS + 1], along * p[AXIS + 2]


@compiled
def rate(p, y):
    """Return the rates of the unknowns, then of the books."""
    phi, speed = y[0], y[1]
    nx, ny, nz = p[AXIS], p[AXIS + 1], p[AXIS + 2]
    qx, qy, qz, qw = attitude(p, phi)
    tx, ty, tz = torque(p, qx, qy, qz, qw, speed * nx, speed * ny, speed * nz, 0.0, 0.0, 0.0)
    return (speed, p[INVERSE] * (nx * tx + ny * ty + nz * tz),
            *booked(p, qx, qy, qz, qw, speed * nx, speed * ny, speed * nz, 0.0, 0.0, 0.0))


@compiled
def settled(y, c):
    """Return both as they are: these unknowns keep no condition."""
    return y, c


@compiled
def write(p, time, y, out):
    """Fill out, the state vector."""
    phi, speed = y[0], y[1]
    qx, qy, qz, qw = attitude(p, phi)
    write_state(p, time, qx, qy, qz, qw, speed * p[AXIS], speed * p[AXIS + 1], speed * p[AXIS + 2], p[PLACE], p[PLACE + 1], p[PLACE + 2],
                0.0, 0.0, 0.0, out)
