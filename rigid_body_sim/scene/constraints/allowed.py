# SPDX-License-Identifier: Apache-2.0
"""Whether a state is one that a constraint allows, as its mechanism, point, axis and path say."""

import math

from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.rotations import rotate
from rigid_body_sim.numerics.vectors import across, cross, minus, plus
from rigid_body_sim.scene.bodies import Body
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism, Vector
from rigid_body_sim.scene.expressions.path import along
from rigid_body_sim.scene.initial import Start
from rigid_body_sim.scene.state import State

ROUNDING = 2.0 ** -40    # largest share of the numbers of a state that is rounding
AT_REST = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)    # place, velocity, acceleration


def refuse_forbidden(state: State, constraint: Constraint, start: Start, body: Body,
                     where: str) -> None:
    """Refuse a state at time 0 in which the body is not where, or moves as, it is held.

    Parameters
    ----------
    state : State
        What ``constraint.initial(start, body, where)`` has made.
    constraint : Constraint
    start : Start
        Where the constraint knows the key `position`, that is the place of the point it holds.
    body : Body
    where : str
        File and key path, for error lines.

    Raises
    ------
    BadInput
    """
    q, omega = state.orientation.tolist(), state.angular_velocity.tolist()
    place, velocity = state.position.tolist(), state.velocity.tolist()
    kind = f'constraint {constraint.kind}'
    x, y, z, w = q
    if abs(x * x + y * y + z * z + w * w - 1.0) > ROUNDING:
        raise BadInput(where, f'the {kind} starts with the orientation {q}',
                       'a quaternion of norm 1')
    if constraint.mechanism is Mechanism.TABLE and velocity[2] != 0.0:
        raise BadInput(where, f'the {kind} starts with the vertical velocity {velocity[2]!r} m/s',
                       'a body that stays on the table: 0')
    if constraint.mechanism is Mechanism.AXIS:
        axis = constraint.axis
        if axis is None or abs(hypot3(*axis) - 1.0) > ROUNDING:
            raise BadInput(where, f'the {kind} has the axis {axis}',
                           'a unit vector, body axes: its mechanism turns about an axis')
        beside: Vector = across(axis, omega)
        if hypot3(*beside) > ROUNDING * hypot3(*omega):
            raise BadInput(where, f'the {kind} starts with the angular velocity {omega}',
                           f'one along its axis {list(axis)}, body axes')
    if constraint.holds_a_point:
        _refuse_loose(q, omega, place, velocity, constraint, start, body, where)


def _refuse_loose(q, omega, place, velocity, constraint, start, body, where):
    """Refuse a state whose held point is not where the constraint holds it, or leaves it."""
    held, its_velocity, _ = AT_REST if constraint.path is None else along(constraint.path, 0.0)
    arm = rotate(*q, *constraint.point(body))
    turning = cross(rotate(*q, *omega), arm)
    slip = minus(plus(velocity, turning), its_velocity)
    speeds = math.fsum(hypot3(*one) for one in (velocity, turning, its_velocity))
    if hypot3(*slip) > ROUNDING * speeds:
        raise BadInput(where, f'the constraint {constraint.kind} starts with its held point at '
                       f'{list(plus(velocity, turning))} m/s',
                       f'a velocity of the origin that leaves it at {list(its_velocity)} m/s')
    if 'position' not in constraint.INITIAL:
        return
    held = plus(start.position, held)
    found = plus(place, arm)
    lengths = math.fsum(hypot3(*one) for one in (place, arm, held))
    if hypot3(*minus(found, held)) > ROUNDING * lengths:
        raise BadInput(where, f'the constraint {constraint.kind} starts with its held point at '
                       f'{list(found)} m', f'the place that position says, {list(held)} m')
