# SPDX-License-Identifier: Apache-2.0
"""Motion of a free body of any inertia in closed form, with or without a uniform field.

The rotation is that of rotation.py, which has the equations; anchor.py computes what it takes. The
centre of mass flies on a parabola; the pose is that of the body's origin, which may be elsewhere.

Kernels besides those of every motion: `fill_columns`, the same operations as `state` on many times
side by side, and `next_event`. The event is `flip`: the momentum along the axis of the middle
moment changes its sign, in a motion that takes it to at least L/2. (That is the hysteresis: in one
motion either every change of sign is a flip or none, so none is lost or counted twice when the
motion is anchored anew on the way.) Two equal moments have no middle axis: such a body does not
flip (mechanics/events.py).
"""

import math
from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.compilation.layout import Vector, layout
from rigid_body_sim.motions.free_body.anchor import (
    Inertia,
    RotationAnchor,
    attitude_of,
    fill_rotation,
    load_attitude,
    rotation_parameters,
)
from rigid_body_sim.motions.free_body.rotation import (
    CIRCULAR,
    HYPERBOLIC,
    circular,
    hyperbolic,
    load_circular,
    load_course,
    load_hyperbolic,
    steady,
    turned,
)
from rigid_body_sim.motions.loops import COLUMNS
from rigid_body_sim.numerics.double_double import two_sum
from rigid_body_sim.numerics.phase import COUNTABLE, TRIES
from rigid_body_sim.numerics.rotations import rotate
from rigid_body_sim.numerics.vectors import cross, minus, plus
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.state import STATE, StateView

EVENTS = ('flip',)
entries = takes = None


class Parameters(NamedTuple):
    """Numbers of the scene."""

    inertia: Inertia
    center_of_mass: Vector    # body axes, m
    g: float                  # m/s^2, along -z


class Flight(NamedTuple):
    """How the centre of mass moves, and where it is in the body."""

    position: Vector     # place of the centre of mass at the start, m
    velocity: Vector     # m/s
    g: float             # m/s^2
    arm: Vector          # from the body's origin to the centre of mass, body axes, m
    has_arm: float       # 1.0 if the arm is not 0


class Anchor(NamedTuple):
    """Numbers that one state determines."""

    rotation_anchor: RotationAnchor
    flight: Flight


PARAMETERS, ANCHOR = layout(Parameters), layout(Anchor)
PARAMETER_SIZE, ANCHOR_SIZE = PARAMETERS.size, ANCHOR.size
load_center_of_mass, load_g = PARAMETERS.part('center_of_mass').load, PARAMETERS.part('g').load
load_flight, store_flight = ANCHOR.part('flight').load, ANCHOR.part('flight').store
load_tumbles = ANCHOR.part('rotation_anchor').part('attitude').part('tumbles').load
load_state, store_state = STATE.load, STATE.store
load_row, store_row = COLUMNS.load, COLUMNS.store


def absorbs(scene):
    """Return whether this motion solves the whole scene."""
    return scene.constraint.mechanism is Mechanism.FREE and scene.weight is not None


def parameters(scene):
    """Return the numbers of the scene that the kernels take: :class:`Parameters` as an array."""
    body = scene.body
    return PARAMETERS.array(Parameters(
        rotation_parameters(body.about_center), body.center_of_mass, scene.weight))


@compiled
def anchor(parameters, start, out):
    """Fill the anchor from the state `start`.

    The angular velocity along an axis of zero moment must be 0.
    """
    fill_rotation(parameters, start, out)
    begin, c = load_state(start), load_center_of_mass(parameters)
    q = begin.orientation
    position = plus(begin.position, rotate(*q, *c))
    velocity = plus(begin.velocity, rotate(*q, *cross(begin.angular_velocity, c)))
    has_arm = 1.0 if c[0] != 0.0 or c[1] != 0.0 or c[2] != 0.0 else 0.0
    store_flight(out, Flight(position, velocity, load_g(parameters), c, has_arm))


@compiled
def state(anchor, time, out):
    """Fill out with the state at any time, before or after the anchor."""
    flight = load_flight(anchor)
    dt = two_sum(time, -load_course(anchor).start)
    omega, ZS = turned(anchor, dt)
    begun = _state_of(load_attitude(anchor), flight, time, dt, omega, ZS)
    store_state(out, _of_origin(flight, begun) if flight.has_arm != 0.0 else begun)


@compiled_inline
def _state_of(attitude, flight, time, dt, omega, ZS):
    """Return the state for omega and Z S in the frame; its position is the centre of mass."""
    q, body_omega = attitude_of(attitude, omega, ZS)
    t = dt[0]
    fall = flight.g * t
    vx, vy, vz = flight.velocity
    position = plus(flight.position, (vx * t, vy * t, (vz - 0.5 * fall) * t))
    return StateView(time, q, body_omega, position, (vx, vy, vz - fall))


@compiled_inline
def _of_origin(flight, state):
    """Return the state with position and velocity of the body's origin."""
    q, arm = state.orientation, flight.arm
    position = minus(state.position, rotate(*q, *arm))
    velocity = minus(state.velocity, rotate(*q, *cross(state.angular_velocity, arm)))
    return StateView(state.time, q, state.angular_velocity, position, velocity)


@compiled
def fill_columns(anchor, times, columns):
    """Fill columns with up to BLOCK states: the operations of `state`, arranged as vector code."""
    course, attitude, flight = load_course(anchor), load_attitude(anchor), load_flight(anchor)
    if course.form == CIRCULAR:
        series = load_circular(anchor)
        for k in range(len(times)):
            dt = two_sum(times[k], -course.start)
            omega, ZS = circular(course, series, dt)
            store_row(columns, _state_of(attitude, flight, times[k], dt, omega, ZS), k)
    elif course.form == HYPERBOLIC:
        series = load_hyperbolic(anchor)
        for k in range(len(times)):
            dt = two_sum(times[k], -course.start)
            omega, ZS = hyperbolic(course, series, dt)
            store_row(columns, _state_of(attitude, flight, times[k], dt, omega, ZS), k)
    else:
        for k in range(len(times)):
            dt = two_sum(times[k], -course.start)
            omega, ZS = steady(course, dt)
            store_row(columns, _state_of(attitude, flight, times[k], dt, omega, ZS), k)
    if flight.has_arm != 0.0:
        for k in range(len(times)):
            store_row(columns, _of_origin(flight, load_row(columns, k)), k)


@compiled
def next_event(anchor, after):
    """Return the time of the first flip later than `after`, infinite if there is none, and 0."""
    if load_tumbles(anchor) == 0.0:
        return math.inf, 0
    course = load_course(anchor)
    rate = course.rate[0]
    half_turns = math.floor(2.0 * (rate * (after - course.start) + course.phase)) - 1.0
    if not abs(half_turns) < COUNTABLE:
        return math.inf, 0
    time = course.start + (0.5 * half_turns - course.phase) / rate
    for _ in range(TRIES):
        if time > after:
            return time, 0
        half_turns += 1.0
        time = course.start + (0.5 * half_turns - course.phase) / rate
    return math.inf, 0
