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
    AXIS,
    REST,
    TURN,
    TWO_TURNS,
    attitude,
    load_axis,
    load_omega,
    store_attitude,
)
from rigid_body_sim.numerics.vectors import dot

write = hinged.write      # one of the template's kernels
torque = UNBOUND

UNKNOWNS = 3
GROUPS = ((0, 1, True), (1, 2, False))


@compiled
def start(p, vector, point, at):
    """Set the parameters that a start decides, and fill `point` from `at` on with its unknowns."""
    q, _, _, _ = read_state(p, vector)
    store_attitude(p, q)
    point[at], point[at + 1] = 0.0, dot(load_axis(p), load_omega(vector))
    point[at + 2] = load_start(p).time


@compiled
def rate(p, y):
    """Return the rates of the unknowns."""
    phi, speed, t = y[0], y[1], y[2]
    nx, ny, nz = p[AXIS], p[AXIS + 1], p[AXIS + 2]
    qx, qy, qz, qw = attitude(p, phi)
    px, py, pz = load_start(p).place
    tx, ty, tz = torque(p, qx, qy, qz, qw, speed * nx, speed * ny, speed * nz, 0.0, 0.0, 0.0,
                        t, px, py, pz)
    return speed, p[INVERSE] * (nx * tx + ny * ty + nz * tz), 1.0


@compiled
def settled(y, c):
    """Return the unknowns and what their sums have lost, with phi within a turn of 0."""
    phi, lost = y[0], c[0]
    if phi > TURN:
        return (phi - TWO_TURNS, y[1], y[2]), (lost - REST, c[1], c[2])
    if phi < -TURN:
        return (phi + TWO_TURNS, y[1], y[2]), (lost + REST, c[1], c[2])
    return y, c
