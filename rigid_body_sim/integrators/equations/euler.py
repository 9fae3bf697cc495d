# SPDX-License-Identifier: Apache-2.0
"""Euler's equations in the frame of a scene, and the way from that frame to a state vector.

scene/frame.py has the frame.

The parameters of every scene kind begin with EquationParameters, and these with SceneParameters
(mechanics/parameters.py); the values of all that acts come after them.
"""

from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.layout import Quaternion, Vector, layout
from rigid_body_sim.mechanics.parameters import SceneParameters
from rigid_body_sim.numerics.rotations import multiply, normalised, rotate, rotate_back
from rigid_body_sim.numerics.vectors import cross, minus, plus, scaled
from rigid_body_sim.scene.state import STATE, StateView


class Start(NamedTuple):
    """Numbers that a start determines.

    Attributes
    ----------
    time : float
        s.
    place, drift : Vector
        Position (m) and velocity (m/s) of the point of reference, world axes.
    """

    time: float
    place: Vector
    drift: Vector


class EquationParameters(NamedTuple):
    """The numbers of Euler's equations in the frame of a scene.

    Attributes
    ----------
    scene : SceneParameters
        The body; its `frame_axes` are those of this frame.
    euler : Vector
        (I2 - I3)/I1 and cyclically; 0 where the moment is 0.
    inverse : Vector
        1/I1 ..., 0 where the moment is 0; on a hinge the first is that of the moment about it.
    point : Vector
        Body origin -> point of reference, frame components, m.
    start : Start
    moves : float
        1 where the point of reference moves, 0 where it is held in its place.
    """

    scene: SceneParameters
    euler: Vector
    inverse: Vector
    point: Vector
    start: Start
    moves: float


class Unknowns(NamedTuple):
    """The unknowns of a body that turns and flies; one that only turns has the first two.

    Attributes
    ----------
    q : Quaternion
        Frame -> world.
    omega : Vector
        Frame components, rad/s.
    place, drift : Vector
        Position (m) and velocity (m/s) of the point of reference, world axes.
    time : float
        s; where time or place matters.
    """

    q: Quaternion
    omega: Vector
    place: Vector
    drift: Vector
    time: float


OMEGA, PLACE, DRIFT, CLOCK = (layout(Unknowns).part(name).first
                              for name in ('omega', 'place', 'drift', 'time'))
EQUATION = layout(EquationParameters)
BODY = EQUATION.part('scene')
EULER, INVERSE, MOVES = (EQUATION.part(name).first for name in ('euler', 'inverse', 'moves'))
MOMENTS, MASS = BODY.part('moments').first, BODY.part('mass').first
FIXED = EQUATION.size
NO_START = Start(0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
load_moments, load_axes = BODY.part('moments').load, BODY.part('frame_axes').load
load_euler, load_inverse, load_point, load_moves = (
    EQUATION.part(name).load for name in ('euler', 'inverse', 'point', 'moves'))
load_start, store_start = EQUATION.part('start').load, EQUATION.part('start').store
load_state, store_state = STATE.load, STATE.store


@compiled
def taken(p, tx, ty, tz):
    """Return the part of a torque that turns the body.

    There is none about an axis of zero moment, such as that of a thin rod.
    """
    ix, iy, iz = load_inverse(p)
    return tx if ix > 0.0 else 0.0, ty if iy > 0.0 else 0.0, tz if iz > 0.0 else 0.0


@compiled
def attitude_rate(qx, qy, qz, qw, wx, wy, wz):
    """Return q' = q omega / 2."""
    hx, hy, hz = 0.5 * wx, 0.5 * wy, 0.5 * wz
    return (
        (qw * hx + (qy * hz - qz * hy)),
        (qw * hy + (qz * hx - qx * hz)),
        (qw * hz + (qx * hy - qy * hx)),
        -(qx * hx + (qy * hy + qz * hz)),
    )


@compiled
def lost_norm(qx, qy, qz, qw):
    """Return (1 - |q|^2)/2, what q must be stretched by to have norm 1 again, to second order."""
    return 0.5 * ((1.0 - qw * qw - qz * qz) - qx * qx - qy * qy)


@compiled
def unit(qx, qy, qz, qw, cx, cy, cz, cw):
    """Return q + c with norm 1, as the nearest doubles and what they lose.

    The stretch must go into q itself. Left in c it would be added after the next step, which turns
    q by x, half the angle of the body; the share 1 - cos(x) of the error of the norm would remain,
    and beyond a quarter turn of q errors would grow from step to step.
    """
    lost = lost_norm(qx, qy, qz, qw) - (qx * cx + qy * cy + qz * cz + qw * cw)
    dx, dy, dz, dw = cx + lost * qx, cy + lost * qy, cz + lost * qz, cw + lost * qw
    sx, sy, sz, sw = qx + dx, qy + dy, qz + dz, qw + dw
    return (sx, sy, sz, sw), (dx - (sx - qx), dy - (sy - qy), dz - (sz - qz), dw - (sw - qw))


@compiled
def settled(y, c):
    """Return the unknowns and what their sums have lost, with q brought back to norm 1."""
    q, lost = unit(*y[:OMEGA], *c[:OMEGA])
    return (*q, *y[OMEGA:]), (*lost, *c[OMEGA:])


@compiled
def read_state(p, vector):
    """Set the parameters that a start decides.

    Parameters
    ----------
    p : array
        EquationParameters.
    vector : array (14,)
        The state at the start.

    Returns
    -------
    tuples
        q and omega of the frame, position and velocity of its point (world).
    """
    axes, point, state = load_axes(p), load_point(p), load_state(vector)
    q = multiply(*state.orientation, *axes)
    omega = rotate_back(*axes, *state.angular_velocity)
    place = plus(state.position, rotate(*q, *point))
    carried = rotate(*q, *cross(omega, point))
    drift = scaled(load_moves(p), plus(state.velocity, carried))
    store_start(p, Start(state.time, place, drift))
    return q, taken(p, omega[0], omega[1], omega[2]), place, drift


@compiled
def write_state(p, time, q, omega, place, drift, out):
    """Fill `out`, the state vector.

    Parameters
    ----------
    p : array
        EquationParameters.
    time : float
        s.
    q, omega : tuples
        Those of the frame.
    place, drift : tuples
        Position (m) and velocity (m/s) of the point of reference, world axes.
    out : array (14,)
    """
    (ax, ay, az, aw), point = load_axes(p), load_point(p)
    q = normalised(*q)
    attitude, omega_body = multiply(*q, -ax, -ay, -az, aw), rotate(ax, ay, az, aw, *omega)
    if point[0] != 0.0 or point[1] != 0.0 or point[2] != 0.0:
        place = minus(place, rotate(*q, *point))
        drift = minus(drift, rotate(*q, *cross(omega, point)))
    store_state(out, StateView(time, attitude, omega_body, place, drift))
