# SPDX-License-Identifier: Apache-2.0
"""Template: the equations of a free body on which a force acts.

Unknowns are q (4) and omega (3) of the frame, position x and velocity v of the centre of mass
(world). Rotation as in rigid_body_sim/integrators/equations/turning.py, about the centre of mass;
x' = v, M v' = F.
"""

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.equations import euler
from rigid_body_sim.integrators.equations.euler import (
    CLOCK,
    DRIFT,
    MASS,
    OMEGA,
    PLACE,
    attitude_rate,
    read_state,
    write_state,
)

settled = euler.settled    # one of the template's kernels
omega_rate = UNBOUND
axes_rate = UNBOUND
force = UNBOUND

UNKNOWNS = CLOCK
GROUPS = ((0, OMEGA, True), (OMEGA, PLACE, False), (PLACE, DRIFT, False), (DRIFT, CLOCK, False))


@compiled
def start(p, vector, point, at):
    """Set the parameters that a start decides, and fill `point` from `at` on with its unknowns."""
    q, omega, place, drift = read_state(p, vector)
    y = (*q, *omega, *place, *drift)
    for u in range(UNKNOWNS):
        point[at + u] = y[u]


@compiled
def rate(p, y):
    """Return the rates of the unknowns."""
    qx, qy, qz, qw, wx, wy, wz, _, _, _, vx, vy, vz = y
    ax, ay, az = axes_rate(p, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz)
    fx, fy, fz = force(p, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz)
    return (
        *attitude_rate(qx, qy, qz, qw, ax, ay, az),
        *omega_rate(p, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz),
        vx, vy, vz,
        fx / p[MASS], fy / p[MASS], fz / p[MASS],
    )


@compiled
def write(p, time, y, out):
    """Fill `out`, the state vector."""
    write_state(p, time, y[:OMEGA], y[OMEGA:PLACE], y[PLACE:DRIFT], y[DRIFT:CLOCK], out)
