# SPDX-License-Identifier: Apache-2.0
"""Template: a body on a hinge on which something acts that depends on time or place.

Unknowns are those of hinged.py, and the time, t' = 1, as in field.py.
"""

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.equations import hinged
from rigid_body_sim.integrators.equations.euler import (
    INVERSE,
    load_start,
    read_state,
)
from rigid_body_sim.integrators.equations.hinged import (
    attitude,
    load_axis,
    load_omega,
    store_attitude,
)
from rigid_body_sim.numerics.vectors import dot

write, settled = hinged.write, hinged.settled    # two of the template's kernels
GROUPS = hinged.GROUPS
torque = UNBOUND

UNKNOWNS = 3    # phi, phi', time


@compiled
def start(p, vector, point, at):
    """Set the parameters that a start decides, and fill `point` from `at` on with its unknowns."""
    q, _, _, _ = read_state(p, vector)
    store_attitude(p, q)
    y = 0.0, dot(load_axis(p), load_omega(vector)), load_start(p).time
    for u in range(UNKNOWNS):
        point[at + u] = y[u]


@compiled
def rate(p, y):
    """Return the rates of the unknowns."""
    phi, speed, t = y
    nx, ny, nz = load_axis(p)
    qx, qy, qz, qw = attitude(p, phi)
    px, py, pz = load_start(p).place
    tx, ty, tz = torque(p, qx, qy, qz, qw, speed * nx, speed * ny, speed * nz, 0.0, 0.0, 0.0,
                        t, px, py, pz)
    return speed, p[INVERSE] * (nx * tx + ny * ty + nz * tz), 1.0
