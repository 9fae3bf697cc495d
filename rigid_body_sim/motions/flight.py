# SPDX-License-Identifier: Apache-2.0
"""Flight of the reference point under a constant force and linear drag, in closed form.

With p the place of the reference point, g the force over the mass, r the drag over the mass and
x = r t (f1 and f2 are those of numerics/relaxation.py):

    p'' = g - r p',     p = p0 + t (p0' f1(x) + g t f2(x)),     p' = p0' exp(-x) + g t f1(x).

The reference point of a held body rests. The pose is that of the body's origin, which may be
elsewhere.
"""

from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled_inline
from rigid_body_sim.compilation.layout import Vector
from rigid_body_sim.numerics.relaxation import relaxation
from rigid_body_sim.numerics.rotations import rotate
from rigid_body_sim.numerics.vectors import cross, minus, plus, scaled
from rigid_body_sim.scene.state import StateView


class Field(NamedTuple):
    """Numbers of the scene."""

    center: Vector       # the reference point, body axes, m
    moves: float         # 1.0, or 0.0 if a bearing holds it
    force: Vector        # over the mass, world axes, m/s^2
    slowing: float       # linear drag over the mass, 1/s


class Flight(NamedTuple):
    """The motion of the reference point from a start on."""

    position: Vector     # world, m
    velocity: Vector     # m/s
    field: Field


def field_of(scene, total):
    """Return the Field of a scene and its Total (mechanics/pulls.py)."""
    frame = scene.frame
    if not frame.moves:
        return Field(frame.point, 0.0, (0.0, 0.0, 0.0), 0.0)
    x, y, z = total.force
    force = x / frame.mass, y / frame.mass, z / frame.mass
    return Field(frame.point, 1.0, force, total.slowing / frame.mass)


@compiled_inline
def flight_from(field, begin):
    """Return the Flight from a state."""
    q, c = begin.orientation, field.center
    velocity = plus(begin.velocity, rotate(*q, *cross(begin.angular_velocity, c)))
    return Flight(plus(begin.position, rotate(*q, *c)), scaled(field.moves, velocity), field)


@compiled_inline
def flown(flight, t, time, q, omega):
    """Return the state t seconds after the start, for the attitude and omega there."""
    e, f1, f2 = 1.0, 1.0, 0.5
    if flight.field.slowing != 0.0:
        e, f1, f2 = relaxation(flight.field.slowing * t)
    gained = scaled(t, flight.field.force)
    way = scaled(t, plus(scaled(f1, flight.velocity), scaled(f2, gained)))
    velocity = plus(scaled(e, flight.velocity), scaled(f1, gained))
    arm = flight.field.center
    return StateView(time, q, omega, minus(plus(flight.position, way), rotate(*q, *arm)),
                     minus(velocity, rotate(*q, *cross(omega, arm))))
