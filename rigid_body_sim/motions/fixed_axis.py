# SPDX-License-Identifier: Apache-2.0
"""Rotation about a fixed axis under a constant torque and drag, in closed form.

It absorbs a body on a hinge about which its weight does nothing: the centre of mass lies on the
axis, or the axis is vertical. It also absorbs a free body that spins about a principal axis, as
long as torque and drag leave it there; such a body may fly under a constant force and linear drag
(flight.py). Symbols: n the axis, I the moment about it, phi the angle turned, N the torque along n
and k the drag of the turning:

    phi'' = g - r phi',     g = N/I,     r = k/I,
    phi = phi0' t f1(r t) + g t^2 f2(r t),     phi' = phi0' exp(-r t) + g t f1(r t)

with f1 and f2 of numerics/relaxation.py. The angle and the numbers that it comes from are pairs of
doubles, so its error does not grow with time.

The event is a `turning point`: phi' changes its sign.
"""

import math
from typing import NamedTuple

import numpy as np

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.compilation.layout import Pair, Quaternion, Vector, layout
from rigid_body_sim.mechanics.pulls import total_pull
from rigid_body_sim.motions.axle import Exact, axle
from rigid_body_sim.motions.flight import Field, Flight, field_of, flight_from, flown
from rigid_body_sim.motions.pendulum.anchor import Pairs
from rigid_body_sim.numerics.double_double import add, two_sum
from rigid_body_sim.numerics.functions import exp, hypot3
from rigid_body_sim.numerics.pairs import TURN, in_integers, quotient, times
from rigid_body_sim.numerics.phase import fraction, sin_cos
from rigid_body_sim.numerics.relaxation import relaxation_pairs, relaxed_time
from rigid_body_sim.numerics.rotations import multiply, normalised, rotate, rotate_back
from rigid_body_sim.numerics.vectors import apply, cross, dot, scaled
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.principal_axes import ULPS
from rigid_body_sim.scene.state import ANGULAR_VELOCITY, ORIENTATION, STATE

EVENTS = ('turning point',)
entries = None
fill_columns = None


class Parameters(NamedTuple):
    """Numbers of the scene; vectors in body axes unless they say otherwise."""

    axis: Pairs          # n
    unit: Vector         # n in doubles
    growth: Pair         # g of the torque that is constant in the body, rad/s^2
    couple: Vector       # torque that is constant in the world, over I, world axes, rad/s^2
    slowing: Pair        # r, 1/s
    field: Field


class Anchor(NamedTuple):
    """Numbers that one state determines."""

    start: float             # s
    orientation: Quaternion
    unit: Vector             # n
    rate: Pair               # phi' at the start, rad/s
    growth: Pair             # g, rad/s^2
    slowing: Pair            # r, 1/s
    flight: Flight


PARAMETERS, ANCHOR = layout(Parameters), layout(Anchor)
PARAMETER_SIZE, ANCHOR_SIZE = PARAMETERS.size, ANCHOR.size
load_parameters, load_anchor, store_anchor = PARAMETERS.load, ANCHOR.load, ANCHOR.store
load_state, store_state = STATE.load, STATE.store


def absorbs(scene):
    """Return whether this motion solves the whole scene."""
    if scene.constraint.mechanism not in (Mechanism.FREE, Mechanism.AXIS):
        return False
    total = total_pull(scene)
    return total is not None and _axis_of(scene, total) is not None


def takes(scene, start):
    """Return whether a state, shape (14,), turns about the axis of the scene and stays there."""
    total = total_pull(scene)
    axis = _axis_of(scene, total)
    if scene.constraint.mechanism is Mechanism.AXIS:
        return weight_is_idle(scene, total, start)
    return _stays(scene, total, axis, start)


def _axis_of(scene, total):
    """Return the axis of a scene (unit vector, or the number of a principal axis), or None."""
    start = scene.initial.vector
    if scene.constraint.mechanism is Mechanism.AXIS:
        return scene.constraint.axis if weight_is_idle(scene, total, start) else None
    return next((k for k in range(3) if _stays(scene, total, k, start)), None)


def weight_is_idle(scene, total, start):
    """Return whether the force on a hinged body has no torque along the axis, now and later."""
    size = hypot3(*total.force)
    if size == 0.0 or axle(scene).distance[0] == 0:
        return True
    n = rotate(*start[ORIENTATION].tolist(), *scene.constraint.axis)
    return hypot3(*cross(n, total.force)) <= ULPS * size


def _stays(scene, total, k, start):
    """Return whether a free body turns about its principal axis k and stays there."""
    moments, axes = scene.body.about_center.moments, scene.body.about_center.axes
    q = start[ORIENTATION].tolist()
    omega = rotate_back(*axes, *start[ANGULAR_VELOCITY].tolist())
    couple = rotate_back(*axes, *rotate_back(*q, *total.couple))
    drag = [row[k] for row in total.drag]
    return moments[k] > 0.0 and all(
        omega[j] == 0.0 and abs(drag[j]) <= ULPS * abs(drag[k])
        and total.torque[j] == 0.0 and abs(couple[j]) <= ULPS * hypot3(*couple)
        for j in range(3) if j != k)


def parameters(scene):
    """Return the numbers of the scene that the kernels take: :class:`Parameters` as an array."""
    total = total_pull(scene)
    given, one = in_integers([
        number for vector in (total.torque, total.couple, *total.drag) for number in vector])
    three = iter(given)
    torque, couple, *drag = zip(three, three, three, strict=True)
    if scene.constraint.mechanism is Mechanism.AXIS:
        held = axle(scene)
        n, (moment, of_moment), unit = held.axis, held.moment, scene.constraint.axis
        growth, of_growth = dot(n.integers, torque), n.over * one
        k, of_k = -dot(n.integers, apply(drag, n.integers)), n.over * n.over * one
    else:
        place, inertia = _axis_of(scene, total), scene.body.about_center
        unit = rotate(*inertia.axes, *np.eye(3)[place])
        n, moment = Exact(*in_integers(unit)), inertia.moments[place]
        moment, of_moment = moment.as_integer_ratio()
        growth, of_growth, k, of_k = torque[place], one, -drag[place][place], one
    return PARAMETERS.array(Parameters(
        [quotient(component, n.over) for component in n.integers], unit,
        quotient(growth * of_moment, of_growth * moment),
        [component * of_moment / (one * moment) for component in couple],
        quotient(k * of_moment, of_k * moment), field_of(scene, total)))


@compiled_inline
def _plus(p, q):
    """Return the sum of two pairs, whatever their signs."""
    return add(*p, *q)


@compiled_inline
def _along(n, v):
    """Return n . v as a pair, n of pairs and v of doubles."""
    x, y, z = v
    return _plus(_plus(times(n[0], (x, 0.0)), times(n[1], (y, 0.0))), times(n[2], (z, 0.0)))


@compiled
def anchor(parameters, start, out):
    """Fill the anchor from a state; of its angular velocity the part along the axis counts."""
    p, begin = load_parameters(parameters), load_state(start)
    q = normalised(*begin.orientation)
    couple = rotate_back(*q, *p.couple)
    growth = _plus(p.growth, _along(p.axis, couple))
    store_anchor(out, Anchor(begin.time, q, p.unit, _along(p.axis, begin.angular_velocity), growth,
                             p.slowing, flight_from(p.field, begin)))


@compiled
def state(anchor, time, out):
    """Fill out with the state at a time before or after the anchor."""
    held = load_anchor(anchor)
    dt = two_sum(time, -held.start)
    x = times(held.slowing, dt)
    f1, f2, e = (1.0, 0.0), (0.5, 0.0), 1.0
    if x[0] != 0.0:
        f1, f2 = relaxation_pairs(x)
        e = exp(-x[0])
    gained = times(held.growth, dt)
    angle = times(dt, _plus(times(held.rate, f1), times(gained, f2)))
    half, low = times(TURN, angle)
    sine, cosine = sin_cos(*fraction(0.5 * half, 0.5 * low))
    rate = e * held.rate[0] + times(gained, f1)[0]
    q = normalised(*multiply(*held.orientation, *scaled(sine, held.unit), cosine))
    store_state(out, flown(held.flight, dt[0], time, q, scaled(rate, held.unit)))


@compiled
def next_event(anchor, after):
    """Return the time of the turning point if it is later than `after`, else infinity, and 0."""
    held = load_anchor(anchor)
    rate, growth = held.rate[0], held.growth[0]
    if rate == 0.0 or growth == 0.0:
        return math.inf, 0
    time = held.start + relaxed_time(-held.slowing[0], -rate / growth)
    return (time, 0) if time > after else (math.inf, 0)
