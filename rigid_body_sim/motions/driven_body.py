# SPDX-License-Identifier: Apache-2.0
"""Motion of a free or pivoted body under a constant torque that changes omega linearly.

It absorbs a body with two equal moments under a constant torque N along its third axis a, fixed in
the body, and a sphere (three equal moments) under any constant torque, fixed in the body or in the
world. Under a torque along a, or under none, it may have rotors of the momentum h along a. A free
body may also fly under a constant force and linear drag (flight.py). The spin may pass through
zero.

With I1 the equal moments, I that about a, w the spin about a and t the part of omega across it,

    w = w0 + N tau/I,     Phi = w0 tau + N tau^2/(2 I),

and omega's part across a turns in the body by the angle (I - I1)/I1 Phi + h/I1 tau, quadratic in
time. Seen from axes that turn in the body with it, the angular velocity is t0 + (I w + h)/I1 a: it
changes linearly with time. The turn of these axes is that of numerics/ramped_rotation.py
(parabolic-cylinder functions; the Landau-Zener problem), and the body lags behind them by the same
angle. Under a torque fixed in the world omega of a sphere changes linearly in world axes.
"""

import math
from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.compilation.layout import Pair, Quaternion, Vector, layout
from rigid_body_sim.mechanics.pulls import total_pull
from rigid_body_sim.motions.flight import Field, Flight, field_of, flight_from, flown
from rigid_body_sim.numerics.double_double import two_sum
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.pairs import (
    TURN,
    in_integers,
    quotient,
    quotient_of,
    scaled,
    times,
)
from rigid_body_sim.numerics.phase import fraction, sin_cos
from rigid_body_sim.numerics.ramped_rotation import ramped_rotation
from rigid_body_sim.numerics.rotations import multiply, normalised, rotate, rotate_back
from rigid_body_sim.numerics.vectors import across, cross, dot
from rigid_body_sim.numerics.vectors import plus as sum_of
from rigid_body_sim.numerics.vectors import scaled as stretched
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.principal_axes import ULPS
from rigid_body_sim.scene.scene import kept
from rigid_body_sim.scene.state import STATE

EVENTS = ()
entries = takes = next_event = None
fill_columns = None

IN_BODY, IN_WORLD = 0.0, 1.0    # axes in which the torque is constant


class Drive(NamedTuple):
    """The torque, and what the body makes of it."""

    axes: float          # IN_BODY or IN_WORLD
    a: Vector            # its direction (unit vector) in these axes
    growth: Pair         # N/I, rad/s^2
    ratio: float         # I/I1
    excess: Pair         # (I - I1)/I1
    rotor: Pair          # h/I1, rad/s


class Parameters(NamedTuple):
    """Numbers of the scene."""

    drive: Drive
    field: Field


class Anchor(NamedTuple):
    """Numbers that one state determines.

    The axes e1, e2, e3 are those of ramped_rotation, in the axes of the torque.
    """

    drive: Drive
    start: float             # s
    orientation: Quaternion
    omega: Vector            # rad/s, in the axes of the torque
    e1: Vector
    e2: Vector
    e3: Vector
    along: float             # w0, rad/s
    across: float            # |t0|, rad/s
    flight: Flight


PARAMETERS, ANCHOR = layout(Parameters), layout(Anchor)
PARAMETER_SIZE, ANCHOR_SIZE = PARAMETERS.size, ANCHOR.size
load_parameters, load_anchor, store_anchor = PARAMETERS.load, ANCHOR.load, ANCHOR.store
load_state, store_state = STATE.load, STATE.store


def absorbs(scene):
    """Return whether this motion solves the whole scene."""
    if scene.constraint.mechanism not in (Mechanism.FREE, Mechanism.POINT):
        return False
    total = total_pull(scene)
    return (total is not None and total.is_carried_only
            and (scene.constraint.mechanism is Mechanism.FREE or not any(total.force))
            and drive(scene) is not None)


@kept
def drive(scene):
    """Return the Drive of a scene that has a Total (mechanics/pulls.py), or None."""
    inertia, total = scene.constraint.inertia(scene.body), total_pull(scene)
    moments, torque, carried = inertia.moments, total.torque, total.carried
    size, spinning = hypot3(*torque), hypot3(*carried)
    in_world = any(total.couple)
    if in_world + any(torque) + any(carried) == 0 or min(moments) == 0.0:
        return None
    if in_world:
        if any(torque) or any(carried) or len(set(moments)) > 1:
            return None
        size = hypot3(*total.couple)
        direction = [component / size for component in total.couple]
        return Drive(IN_WORLD, direction, quotient_of(size, moments[0]), 1.0, (0.0, 0.0),
                     (0.0, 0.0))
    if len(set(moments)) == 1:
        along, whole = (torque, size) if size else (carried, spinning)
        direction = [component / whole for component in along]
        h = dot(direction, carried)
        if hypot3(*across(direction, carried)) > ULPS * spinning:
            return None
        return Drive(IN_BODY, rotate(*inertia.axes, *direction), quotient_of(size, moments[0]),
                     1.0, (0.0, 0.0), quotient_of(math.copysign(spinning, h), moments[0]))
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        if (moments[i] == moments[j] and max(abs(torque[i]), abs(torque[j])) <= ULPS * size
                and max(abs(carried[i]), abs(carried[j])) <= ULPS * spinning):
            sign = math.copysign(1.0, torque[k])
            unit = [0.0, 0.0, 0.0]
            unit[k] = sign
            (I, I1), _ = in_integers((moments[k], moments[i]))
            return Drive(IN_BODY, rotate(*inertia.axes, *unit),
                         quotient_of(abs(torque[k]), moments[k]), quotient(I, I1)[0],
                         quotient(I - I1, I1), quotient_of(sign * carried[k], moments[i]))
    return None


def parameters(scene):
    """Return the numbers of the scene that the kernels take: :class:`Parameters` as an array."""
    return PARAMETERS.array(Parameters(drive(scene), field_of(scene, total_pull(scene))))


@compiled
def anchor(parameters, start, out):
    """Fill the anchor from the state `start`."""
    p, begin = load_parameters(parameters), load_state(start)
    drive, q = p.drive, normalised(*begin.orientation)
    in_world = drive.axes == IN_WORLD
    # in the body U is the turn back: omega runs the other way, and a is -e1
    omega = rotate(*q, *begin.angular_velocity) if in_world else begin.angular_velocity
    along, rest = dot(drive.a, omega), across(drive.a, omega)
    size = hypot3(*rest)
    e1, e2 = drive.a, (0.0, 0.0, 0.0)
    if size > 0.0:
        e2 = (rest[0] / size, rest[1] / size, rest[2] / size)
    if not in_world:
        e1, e2 = stretched(-1.0, e1), stretched(-1.0, e2)
    store_anchor(out, Anchor(drive, begin.time, q, omega, e1, e2, cross(e1, e2), along, size,
                             flight_from(p.field, begin)))


@compiled
def _lagged(held, dt):
    """Return the turns of (I - I1)/I1 Phi + h/I1 dt as a pair, dt (s, a pair) after the start."""
    drive = held.drive
    grown = scaled(times(drive.growth, dt), 0.5)
    turns = times(drive.excess, times(TURN, times(dt, plus_any(grown, (held.along, 0.0)))))
    if drive.rotor[0] == 0.0:
        return turns
    return plus_any(turns, times(TURN, times(dt, drive.rotor)))


@compiled_inline
def plus_any(p, q):
    """Return the sum of two pairs whose signs may differ."""
    high, low = two_sum(p[0], q[0])
    return two_sum(high, low + (p[1] + q[1]))


@compiled
def state(anchor, time, out):
    """Fill out with the state at any time, before or after the anchor."""
    held = load_anchor(anchor)
    drive, dt = held.drive, two_sum(time, -held.start)
    t, gained = dt[0], drive.growth[0] * dt[0]
    x, y, z, w = ramped_rotation(drive.ratio * held.along + drive.rotor[0], held.across,
                                 drive.ratio * drive.growth[0], t)
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = held.e1, held.e2, held.e3
    x, y, z = ax * x + bx * y + cx * z, ay * x + by * y + cy * z, az * x + bz * y + cz * z
    omega = sum_of(held.omega, stretched(gained, drive.a))
    if drive.axes == IN_WORLD:
        q = normalised(*multiply(x, y, z, w, *held.orientation))
        omega = rotate_back(*q, *omega)
    else:
        q = multiply(*held.orientation, -x, -y, -z, w)
        if drive.excess[0] != 0.0 or drive.rotor[0] != 0.0:
            turns = _lagged(held, dt)
            sine, cosine = sin_cos(*fraction(0.5 * turns[0], 0.5 * turns[1]))
            q = multiply(*q, *stretched(-sine, drive.a), cosine)
            rest = stretched(-held.across, held.e2)
            omega = sum_of(stretched(held.along + gained, drive.a), sum_of(
                stretched((cosine - sine) * (cosine + sine), rest),
                stretched(2.0 * sine * cosine, cross(drive.a, rest))))
        q = normalised(*q)
    store_state(out, flown(held.flight, t, time, q, omega))
