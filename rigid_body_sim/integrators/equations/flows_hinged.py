# SPDX-License-Identifier: Apache-2.0
"""Template: the two flows of a body on a hinge.

Unknowns as in hinged.py. A drift goes on with the rate, a kick changes the rate.
"""

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.numerics.double_double import add_double

rate = UNBOUND


@compiled
def drift(p, y, c, h):
    """Return (y, c) after the body has turned freely for a time h."""
    phi, lost = add_double(y[0], c[0], h * y[1])
    return (phi, y[1]), (lost, c[1])


@compiled
def kick(p, y, c, h):
    """Return (y, c) after the torque has acted alone for a time h."""
    speed, lost = add_double(y[1], c[1], h * rate(p, y)[1])
    return (y[0], speed), (c[0], lost)


@compiled
def kick_with_heat(p, y, c, h):
    """Return (y, c) after a torque that depends on the rate has acted alone for a time h.

    By the explicit midpoint rule.
    """
    speed, lost = add_double(y[1], c[1], h * rate(p, (y[0], y[1] + 0.5 * h * rate(p, y)[1]))[1])
    return (y[0], speed), (c[0], lost)
