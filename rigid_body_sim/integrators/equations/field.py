# SPDX-License-Identifier: Apache-2.0
"""Template: the equations of a body on which something acts that depends on time or place.

Unknowns are those of flying.py, and the time:

    t' = 1

The clock runs as an unknown, so every method that evaluates rates knows the time of its stages.
The reference point of a pivoted body stays: x' = v = 0.
"""

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.equations import euler
from rigid_body_sim.integrators.equations.euler import (
    CLOCK,
    MASS,
    MOVES,
    attitude_rate,
    load_start,
    read_state,
)
from rigid_body_sim.integrators.equations.flying import GROUPS, write  # noqa: F401 - of flying.py

settled = euler.settled    # one of the template's kernels
omega_rate = UNBOUND
axes_rate = UNBOUND
force = UNBOUND

UNKNOWNS = CLOCK + 1    # nothing is ever in doubt about the clock: it belongs to no group


@compiled
def start(p, vector, point, at):
    """Set the parameters that a start decides, and fill `point` from `at` on with its unknowns."""
    q, omega, place, drift = read_state(p, vector)
    y = (*q, *omega, *place, *drift, load_start(p).time)
    for u in range(UNKNOWNS):
        point[at + u] = y[u]


@compiled
def rate(p, y):
    """Return the rates of the unknowns."""
    qx, qy, qz, qw, wx, wy, wz, x, y_, z, vx, vy, vz, t = y
    ax, ay, az = axes_rate(p, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz, t, x, y_, z)
    fx, fy, fz = force(p, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz, t, x, y_, z)
    free = p[MOVES] / p[MASS]
    return (
        *attitude_rate(qx, qy, qz, qw, ax, ay, az),
        *omega_rate(p, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz, t, x, y_, z),
        vx, vy, vz,
        free * fx, free * fy, free * fz,
        1.0,
    )
