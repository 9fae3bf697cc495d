# SPDX-License-Identifier: Apache-2.0
"""Template: the equations of a pivoted body, or of a free one on which no force acts.

The unknowns are q (4) and omega (3) of the frame.

    q' = q (omega + u)/2,    m = I omega
    omega1' = ((I2 - I3)/I1) omega2 omega3 + (Gamma + m x u)_1/I1 and cyclically

Gamma is the torque about the point of reference, u the extra turning rate of internal dissipation.
The coefficients of Euler's terms are between -1 and 1 for every body, needles included. The point
of reference moves in a straight line.
"""

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.equations import euler
from rigid_body_sim.integrators.equations.euler import (
    OMEGA,
    PLACE,
    attitude_rate,
    load_start,
    read_state,
    write_state,
)
from rigid_body_sim.numerics.vectors import plus, scaled

settled = euler.settled    # one of the template's kernels
omega_rate = UNBOUND
axes_rate = UNBOUND

UNKNOWNS = PLACE
GROUPS = ((0, OMEGA, True), (OMEGA, PLACE, False))
APART = ((0, OMEGA, True), *((k, k + 1, False) for k in range(OMEGA, PLACE)))
"""Groups under internal dissipation: a departure from an axis is accurate while it is small."""


@compiled
def start(p, vector, point, at):
    """Set the parameters that a start decides, and fill `point` from `at` on with its unknowns."""
    q, omega, _, _ = read_state(p, vector)
    y = (*q, *omega)
    for u in range(UNKNOWNS):
        point[at + u] = y[u]


@compiled
def rate(p, y):
    """Return the rates of the unknowns."""
    qx, qy, qz, qw, wx, wy, wz = y
    ax, ay, az = axes_rate(p, qx, qy, qz, qw, wx, wy, wz, 0.0, 0.0, 0.0)
    return (
        *attitude_rate(qx, qy, qz, qw, ax, ay, az),
        *omega_rate(p, qx, qy, qz, qw, wx, wy, wz, 0.0, 0.0, 0.0),
    )


@compiled
def write(p, time, y, out):
    """Fill `out`, the state vector."""
    begin = load_start(p)
    place = plus(begin.place, scaled(time - begin.time, begin.drift))
    write_state(p, time, y[:OMEGA], y[OMEGA:PLACE], place, begin.drift, out)
