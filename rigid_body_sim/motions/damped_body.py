# SPDX-License-Identifier: Apache-2.0
"""Motion of a free or pivoted body, without torque or with drag in proportion to its inertia.

A free body may also fly under a constant force and linear drag (flight.py): the drag on the centre
of mass leaves the rotation alone. The centre of mass of a pivoted body is the pivot, or nothing
pulls at it.

With r the rate of the drag, Euler's equations are I omega' = -omega x I omega - r I omega. In the
time s, which slows down more and more,

    s = (1 - exp(-r t))/r,     omega(t) = exp(-r t) Omega(s),     q(t) = Q(s),

Q and Omega are the torque-free rotation (free_body/rotation.py) from the same start. So a sphere
under angular drag, and a rod or a point mass with drag at its end, are free rotations coming to
rest after a finite angle. s is a pair of doubles, as the time is.

The event is the `flip` of free_body.py.
"""

import math
from fractions import Fraction
from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.compilation.layout import Pair, layout
from rigid_body_sim.mechanics.pulls import total_pull
from rigid_body_sim.motions.flight import Field, Flight, field_of, flight_from, flown
from rigid_body_sim.motions.free_body.anchor import (
    Inertia,
    RotationAnchor,
    attitude_of,
    fill_rotation,
    load_attitude,
    rotation_parameters,
)
from rigid_body_sim.motions.free_body.rotation import (
    load_course,
    turned,
)
from rigid_body_sim.numerics.double_double import two_sum
from rigid_body_sim.numerics.functions import exp
from rigid_body_sim.numerics.pairs import pair_of, times
from rigid_body_sim.numerics.phase import COUNTABLE, TRIES
from rigid_body_sim.numerics.relaxation import relaxation_pairs, relaxed_time
from rigid_body_sim.numerics.vectors import scaled
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.principal_axes import ULPS
from rigid_body_sim.scene.scene import kept
from rigid_body_sim.scene.state import STATE

EVENTS = ('flip',)
entries = takes = fill_columns = None


class Parameters(NamedTuple):
    """Numbers of the scene."""

    inertia: Inertia
    damping: Pair      # r, 1/s
    field: Field


class Anchor(NamedTuple):
    """Numbers that one state determines."""

    rotation_anchor: RotationAnchor
    damping: Pair
    flight: Flight


PARAMETERS, ANCHOR = layout(Parameters), layout(Anchor)
PARAMETER_SIZE, ANCHOR_SIZE = PARAMETERS.size, ANCHOR.size
load_given_damping, load_field = PARAMETERS.part('damping').load, PARAMETERS.part('field').load
load_damping, store_damping = ANCHOR.part('damping').load, ANCHOR.part('damping').store
load_flight, store_flight = ANCHOR.part('flight').load, ANCHOR.part('flight').store
load_tumbles = ANCHOR.part('rotation_anchor').part('attitude').part('tumbles').load
load_state, store_state = STATE.load, STATE.store


def absorbs(scene):
    """Return whether this motion solves the whole scene."""
    if scene.constraint.mechanism not in (Mechanism.FREE, Mechanism.POINT):
        return False
    total = total_pull(scene)
    return (total is not None and not any(total.torque) and not any(total.couple)
            and (scene.constraint.mechanism is Mechanism.FREE or not any(total.force))
            and damping(scene) is not None)


@kept
def damping(scene):
    """Return r (1/s, exact) if the angular drag of a scene is r times the inertia, else None.

    The scene has a Total (mechanics/pulls.py).
    """
    moments, total = scene.constraint.inertia(scene.body).moments, total_pull(scene)
    if not any(map(any, total.drag)):
        return Fraction(0)
    drag = [[-entry for entry in row] for row in total.drag]
    slack = ULPS * max(abs(entry) for row in drag for entry in row)
    turning = [k for k in range(3) if moments[k] > 0.0]    # about the others nothing turns
    if any(abs(drag[j][k]) > slack for j in turning for k in turning if j != k):
        return None
    rates = [Fraction(drag[k][k]) / Fraction(moments[k]) for k in turning]
    r = max(rates, default=Fraction(0))
    return None if r - min(rates, default=r) > ULPS * r else r


def parameters(scene):
    """Return the numbers of the scene that the kernels take: :class:`Parameters` as an array."""
    total = total_pull(scene)
    inertia = rotation_parameters(scene.constraint.inertia(scene.body))
    return PARAMETERS.array(Parameters(
        inertia, pair_of(damping(scene)), field_of(scene, total)))


@compiled
def anchor(parameters, start, out):
    """Fill the anchor from the state `start`.

    The angular velocity along an axis of zero moment must be 0.
    """
    fill_rotation(parameters, start, out)
    store_damping(out, load_given_damping(parameters))
    store_flight(out, flight_from(load_field(parameters), load_state(start)))


@compiled_inline
def _slower(damping, dt):
    """Return s as a pair and exp(-r t), for a time t as a pair."""
    if damping[0] == 0.0:
        return dt, 1.0
    x = times(damping, dt)
    f1, _ = relaxation_pairs(x)
    return times(dt, f1), exp(-x[0])


@compiled
def state(anchor, time, out):
    """Fill out with the state at any time, before or after the anchor."""
    dt = two_sum(time, -load_course(anchor).start)
    s, slower = _slower(load_damping(anchor), dt)
    q, omega = attitude_of(load_attitude(anchor), *turned(anchor, s))
    store_state(out, flown(load_flight(anchor), dt[0], time, q, scaled(slower, omega)))


@compiled
def next_event(anchor, after):
    """Return the time of the first flip later than `after`, infinite if there is none, and 0."""
    if load_tumbles(anchor) == 0.0:
        return math.inf, 0
    course, damping = load_course(anchor), load_damping(anchor)
    s, _ = _slower(damping, two_sum(after, -course.start))
    half_turns = math.floor(2.0 * (course.rate[0] * s[0] + course.phase)) - 1.0
    if not abs(half_turns) < COUNTABLE:
        return math.inf, 0
    time = _flip_time(course, damping, half_turns)
    for _ in range(TRIES):
        if time > after:
            return time, 0
        half_turns += 1.0
        time = _flip_time(course, damping, half_turns)
    return math.inf, 0


@compiled_inline
def _flip_time(course, damping, half_turns):
    """Return when the phase is that many half turns."""
    s = (0.5 * half_turns - course.phase) / course.rate[0]
    return course.start + (s if damping[0] == 0.0 else relaxed_time(damping[0], s))
