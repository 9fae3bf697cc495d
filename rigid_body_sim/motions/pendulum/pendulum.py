# SPDX-License-Identifier: Apache-2.0
"""Physical pendulum: a body on a hinge of any direction (notes, "Kater's Pendulum").

It is solved in closed form over any time, with gravity or without. A constant force at the centre
of mass is more weight or less, and rotors change nothing but the reaction.

Symbols: n the axis (unit vector, the same in the body and in the world), I the moment about it, r
the arm from `through` to the centre of mass, gamma the vertical in body axes, d and G the parts of
r and gamma across n; phi the angle of r from its lowest position, positive about n.

    phi'' = -Omega^2 sin(phi),              Omega^2 = M g d G/I,
    d G cos(phi) = -r_across . gamma,       d G sin(phi) = (n x r) . gamma.

With s = sin(phi/2), c = cos(phi/2) and w = phi'/2, both h^2 = w^2 + Omega^2 s^2 and
Delta = Omega^2 c^2 - w^2 = (Omega c - w)(Omega c + w) are constant. The sign of Delta decides the
case, and Delta gives the complementary modulus without cancellation:

    swings, Delta >= 0:   w = Omega k cn u,   s = k sn u,   c = dn u,
                          u' = Omega,         k' = sqrt(Delta)/Omega
    turns over, < 0:      c = cn u,           s = sn u,     w = h dn u,
                          u' = h,             k' = sqrt(-Delta)/h

The quaternion of the rotation by phi about n is (n s, c): no angle is ever formed, and its sign
is continuous. sn, cn and dn are the theta functions of free_body/rotation.py (w, s and c move like
the omega of a free body), separatrix included; the phase u/(4 K) is in turns, its rate a pair of
doubles. Omega = 0 (vertical axis, centre of mass on the axis, no gravity) and equilibria are
uniform rotations.

Kernels besides those of every motion: `fill_columns`, the same operations as `state` on many times
side by side; `next_event` (the rate changes its sign); `reaction`.
Sources: Whittaker, Analytical Dynamics, section 44; NIST DLMF 22.19(i).
"""

import math
from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.compilation.layout import Vector, layout
from rigid_body_sim.mechanics.pulls import weight_of
from rigid_body_sim.motions.free_body.rotation import (
    CIRCULAR,
    HYPERBOLIC,
    load_circular,
    load_course,
    load_hyperbolic,
)
from rigid_body_sim.motions.loops import COLUMNS
from rigid_body_sim.motions.pendulum import anchor
from rigid_body_sim.motions.pendulum.anchor import (
    NEVER,
    circular,
    functions,
    hyperbolic,
    load_circle,
    load_parameters,
    load_swing,
    steady,
)
from rigid_body_sim.numerics.double_double import two_sum
from rigid_body_sim.numerics.phase import COUNTABLE, TRIES
from rigid_body_sim.numerics.rotations import rotate, rotate_back
from rigid_body_sim.numerics.vectors import cross, dot, minus, plus, scaled
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.state import STATE, StateView

EVENTS = ('turning point',)
entries = takes = None

PARAMETER_SIZE, ANCHOR_SIZE = anchor.PARAMETER_SIZE, anchor.ANCHOR_SIZE
parameters, anchor = anchor.parameters, anchor.anchor


class Reaction(NamedTuple):
    """Force (N) and couple (N m) of the bearing on the body, world axes."""

    force: Vector
    couple: Vector


load_state, store_state, store_row = STATE.load, STATE.store, COLUMNS.store
store_reaction = layout(Reaction).store


def absorbs(scene):
    """Return whether the scene is a body on a hinge under its weight alone, or under nothing."""
    return scene.constraint.mechanism is Mechanism.AXIS and weight_of(scene) is not None


@compiled
def state(anchor, time, out):
    """Fill out with the state at a time before or after the anchor."""
    store_state(out, state_at(anchor, time))


@compiled_inline
def state_at(anchor, time):
    """Return the state at a time, a StateView."""
    dt = two_sum(time, -load_course(anchor).start)
    s, c, w = functions(anchor, dt)
    return _state_of(load_circle(anchor), time, s, c, w)


@compiled_inline
def _state_of(circle, time, s, c, w):
    """Return the state for s, c and w."""
    a, b = circle.upright, circle.turned
    qx, qy = c * a[0] + s * b[0], c * a[1] + s * b[1]
    qz, qw = c * a[2] + s * b[2], c * a[3] + s * b[3]
    scale = 1.0 / math.sqrt(qx * qx + qy * qy + qz * qz + qw * qw)
    rate = 2.0 * w
    cosine, sine = (c - s) * (c + s), 2.0 * s * c
    way = plus(scaled(cosine, circle.cosine), scaled(sine, circle.sine))
    slope = minus(scaled(sine, circle.cosine), scaled(cosine, circle.sine))
    return StateView(time, (scale * qx, scale * qy, scale * qz, scale * qw),
                     scaled(rate, circle.normal), minus(circle.middle, way), scaled(rate, slope))


@compiled
def fill_columns(anchor, times, columns):
    """Fill columns with up to BLOCK states: the operations of `state`, arranged as vector code."""
    course, swing, circle = load_course(anchor), load_swing(anchor), load_circle(anchor)
    if course.form == CIRCULAR:
        series = load_circular(anchor)
        for k in range(len(times)):
            s, c, w = circular(course, series, swing, two_sum(times[k], -course.start))
            store_row(columns, _state_of(circle, times[k], s, c, w), k)
    elif course.form == HYPERBOLIC:
        series = load_hyperbolic(anchor)
        for k in range(len(times)):
            s, c, w = hyperbolic(course, series, swing, two_sum(times[k], -course.start))
            store_row(columns, _state_of(circle, times[k], s, c, w), k)
    else:
        for k in range(len(times)):
            s, c, w = steady(course, swing, two_sum(times[k], -course.start))
            store_row(columns, _state_of(circle, times[k], s, c, w), k)


@compiled
def next_event(anchor, after):
    """Return the time of the first turning point after `after`, infinite if none is, and 0."""
    course = load_course(anchor)
    if load_swing(anchor).swings == 0.0:
        return math.inf, 0
    if course.form == HYPERBOLIC and load_hyperbolic(anchor).period >= NEVER:
        return math.inf, 0
    half_turns = math.floor(2.0 * (course.rate[0] * (after - course.start) + course.phase)) - 1.0
    if not abs(half_turns) < COUNTABLE:
        return math.inf, 0
    time = _turning_time(course, half_turns)
    for _ in range(TRIES):
        if time > after:
            return time, 0
        half_turns += 1.0
        time = _turning_time(course, half_turns)
    return math.inf, 0


@compiled_inline
def _turning_time(course, half_turns):
    """Return when the phase is a quarter turn and that many half turns."""
    return course.start + (0.25 + 0.5 * half_turns - course.phase) / course.rate[0]


@compiled
def reaction(parameters, state, out):
    """Fill out, shape (6,), with force (N) and couple (N m) of the bearing on the body.

    They hold at the point `through`, in world axes. Newton and Euler about that point, which does
    not move, with I the tensor there and Gamma the torque of the weight:
    force = M (r'' + g z), couple = I n phi'' + phi'^2 n x I n - Gamma.
    """
    p, now = load_parameters(parameters), load_state(state)
    q, n, r = now.orientation, p.unit, p.arm
    gamma = rotate_back(*q, 0.0, 0.0, 1.0)
    nxr = cross(n, r)
    rate, growth, weight = dot(n, now.angular_velocity), -p.weight * dot(nxr, gamma), p.mass * p.g
    squared = rate * rate
    rise = plus(scaled(growth, nxr), scaled(squared, cross(n, nxr)))
    force = plus(scaled(p.mass, rise), scaled(weight, gamma))
    momentum = plus(scaled(growth, p.momentum), scaled(squared, cross(n, p.momentum)))
    couple = plus(momentum, scaled(weight, cross(r, gamma)))
    store_reaction(out, Reaction(rotate(*q, *force), rotate(*q, *couple)))
