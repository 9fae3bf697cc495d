# SPDX-License-Identifier: Apache-2.0
"""Template: the equations of a body on a hinge, in the angle phi and its rate.

phi (rad) is the angle since the start about the axis n (frame components), less whole turns.

    I phi'' = n . Gamma,    q = q0 (n sin(phi/2), cos(phi/2)),    omega = phi' n

I is the moment about the axis, Gamma the torque about the hinge point; the rest of Gamma is the
bearing's.
"""

import math
from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.layout import Quaternion, layout
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.equations.euler import (
    BODY,
    INVERSE,
    EquationParameters,
    load_start,
    read_state,
    write_state,
)
from rigid_body_sim.numerics.functions import atan2, sin_cos
from rigid_body_sim.numerics.rotations import multiply
from rigid_body_sim.numerics.vectors import dot, scaled
from rigid_body_sim.scene.state import STATE

torque = UNBOUND

PHI, SPEED = 0, 1    # places of the unknowns phi and phi'
UNKNOWNS = 2
TURN = 2.0 * math.pi
TWO_TURNS, REST = 4.0 * math.pi, 4.898587196589413e-16    # 4 pi as a sum of two doubles
GROUPS = ((PHI, SPEED, True), (SPEED, UNKNOWNS, False))


class HingedParameters(NamedTuple):
    """The parameters of a body on a hinge."""

    equation: EquationParameters    # its frame has the body's axes: n is the hinge_axis
    attitude: Quaternion            # q0, at the start


NO_ATTITUDE = 0.0, 0.0, 0.0, 0.0    # before a start
PARAMETERS = layout(HingedParameters)
load_omega = STATE.part('angular_velocity').load
load_axis = BODY.part('hinge_axis').load
load_attitude, store_attitude = PARAMETERS.part('attitude').load, PARAMETERS.part('attitude').store


@compiled
def start(p, vector, point, at):
    """Set the parameters that a start decides, and fill `point` from `at` on with its unknowns."""
    q, _, _, _ = read_state(p, vector)
    store_attitude(p, q)
    point[at + PHI], point[at + SPEED] = 0.0, dot(load_axis(p), load_omega(vector))


@compiled
def attitude(p, phi):
    """Return q at an angle."""
    s, c = sin_cos(0.5 * phi)
    return multiply(*load_attitude(p), *scaled(s, load_axis(p)), c)


@compiled
def rate(p, y):
    """Return the rates of the unknowns."""
    phi, speed = y
    nx, ny, nz = load_axis(p)
    qx, qy, qz, qw = attitude(p, phi)
    tx, ty, tz = torque(p, qx, qy, qz, qw, speed * nx, speed * ny, speed * nz, 0.0, 0.0, 0.0)
    return speed, p[INVERSE] * (nx * tx + ny * ty + nz * tz)


@compiled
def settled(y, c):
    """Return the unknowns and what their sums have lost, with phi within a turn of 0.

    Two turns leave the attitude and the sign of q as they are. Stages and the attitude are formed
    from phi as a double: a phi that counted the turns would lose digits with each of them.
    """
    phi, lost = y[PHI], c[PHI]
    if phi > TURN:
        return (phi - TWO_TURNS, *y[SPEED:]), (lost - REST, *c[SPEED:])
    if phi < -TURN:
        return (phi + TWO_TURNS, *y[SPEED:]), (lost + REST, *c[SPEED:])
    return y, c


@compiled
def angle_between(first, second, n):
    """Return the angle about n (body axes) from one attitude to another, from -2 pi to 2 pi."""
    x, y, z, w = first
    ux, uy, uz, uw = multiply(-x, -y, -z, w, *second)
    return 2.0 * atan2(dot(n, (ux, uy, uz)), uw)


@compiled
def less_turns(turned, phi):
    """Return an angle, less two turns if its sum with phi is not between -2 pi and 2 pi."""
    if turned + phi > TURN:
        return turned - TWO_TURNS - REST
    return turned + TWO_TURNS + REST if turned + phi <= -TURN else turned


@compiled
def write(p, time, y, out):
    """Fill `out`, the state vector."""
    phi, speed = y[PHI], y[SPEED]
    write_state(p, time, attitude(p, phi), scaled(speed, load_axis(p)), load_start(p).place,
                (0.0, 0.0, 0.0), out)
