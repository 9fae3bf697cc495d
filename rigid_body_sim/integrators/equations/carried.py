# SPDX-License-Identifier: Apache-2.0
"""Template: the equations of a body at a pivot that moves as the scene says.

The unknowns are q (4) and omega (3) of the frame, and the time:

    t' = 1

Rotation as in turning.py, about the pivot. Place and velocity of the pivot are those of its path,
never integrated; the effect of its acceleration on the body is among the torques
(scene/effects/carrying.py).
"""

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.equations import euler
from rigid_body_sim.integrators.equations.euler import (
    OMEGA,
    PLACE,
    Start,
    attitude_rate,
    load_start,
    read_state,
    store_start,
    write_state,
)
from rigid_body_sim.numerics.vectors import minus, plus

settled = euler.settled    # one of the template's kernels
omega_rate = UNBOUND
axes_rate = UNBOUND
path = UNBOUND    # (p, t) -> place, velocity and acceleration, nine floats

UNKNOWNS = PLACE + 1    # nothing is ever in doubt about the clock: it belongs to no group
GROUPS = ((0, OMEGA, True), (OMEGA, PLACE, False))


@compiled
def start(p, vector, point, at):
    """Set the parameters that a start decides, and fill `point` from `at` on with its unknowns.

    The path is moved so that it meets the place of the pivot at the start.
    """
    q, omega, place, drift = read_state(p, vector)
    time = load_start(p).time
    x, y_, z, _, _, _, _, _, _ = path(p, time)
    store_start(p, Start(time, minus(place, (x, y_, z)), drift))
    y = (*q, *omega, time)
    for u in range(UNKNOWNS):
        point[at + u] = y[u]


@compiled
def rate(p, y):
    """Return the rates of the unknowns."""
    qx, qy, qz, qw, wx, wy, wz, t = y
    x, y_, z, vx, vy, vz, _, _, _ = path(p, t)
    x, y_, z = plus(load_start(p).place, (x, y_, z))
    ax, ay, az = axes_rate(p, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz, t, x, y_, z)
    return (
        *attitude_rate(qx, qy, qz, qw, ax, ay, az),
        *omega_rate(p, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz, t, x, y_, z),
        1.0,
    )


@compiled
def write(p, time, y, out):
    """Fill `out`, the state vector."""
    x, y_, z, vx, vy, vz, _, _, _ = path(p, time)
    write_state(p, time, y[:OMEGA], y[OMEGA:PLACE], plus(load_start(p).place, (x, y_, z)),
                (vx, vy, vz), out)
