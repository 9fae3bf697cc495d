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
    (phi, speed), (lost, speed_lost) = y, c
    phi, lost = add_double(phi, lost, h * speed)
    return (phi, speed), (lost, speed_lost)


@compiled
def kick(p, y, c, h):
    """Return (y, c) after the torque has acted alone for a time h."""
    (phi, speed), (phi_lost, lost) = y, c
    _, growth = rate(p, y)
    speed, lost = add_double(speed, lost, h * growth)
    return (phi, speed), (phi_lost, lost)


@compiled
def kick_with_heat(p, y, c, h):
    """Return (y, c) after a torque that depends on the rate has acted alone for a time h.

    The explicit midpoint rule is used.
    """
    (phi, speed), (phi_lost, lost) = y, c
    _, growth = rate(p, y)
    _, growth = rate(p, (phi, speed + 0.5 * h * growth))
    speed, lost = add_double(speed, lost, h * growth)
    return (phi, speed), (phi_lost, lost)
