# SPDX-License-Identifier: Apache-2.0
"""Heavy symmetric top with a fixed point, in closed form over any time.

Notes, "Symmetric Top" to "Fast top". It absorbs a pivot (a point of the body stays where it is),
gravity or none, and a body with two equal moments about the pivot and its centre of mass on the
third axis. A constant force at the centre of mass is more weight or less, and rotors along the
third axis are more spin. Spherical tops, thin rods (the spherical pendulum), hanging and standing
tops, and tops without weight are ordinary cases.

Symbols: e3 the symmetry axis, towards the centre of mass at distance h from the pivot; I1, I1, I3
moments about the pivot; k = M g h/I1; n = P_gamma/I1 = I3 omega_3/I1, or (I3 omega_3 + H)/I1 with
rotors of the momentum H along e3; beta the angle of e3 to the vertical, u = cos(beta).

A top with I3 := I1 and the same n differs from this one by a steady rotation about e3 at the rate
omega_3 - n, which is omega_3 (I1 - I3)/I1 without rotors, so I3 and H enter nowhere else. The
attitude is a pair of complex numbers a = w + i z, b = y - i x (Cayley-Klein parameters,
|a|^2 = (1 + u)/2, |b|^2 = (1 - u)/2),
so nothing happens at beta = 0 and pi, where Euler's angles fail. a, b and omega_c = omega_2 - i
omega_1 are single-valued functions of time: a theta quotient times a phase that grows steadily
(theta.py). The phase of omega_c is that of b less that of a, because with gamma the vertical in
body axes and c = omega . gamma across e3

    omega_c = (c + i u')/(1 - u^2) gamma_c,     gamma_c = 2 i conj(a) b.

Numbers that multiply the time have more digits than a double (means.py), so errors do not grow.

Kernels besides those of every motion: `fill_columns`, the same operations as `state` on many times
side by side; `next_event`, `turning_index`, `turning_time` (where beta turns); `reaction`. A
nutation too slight to be seen in doubles (NOTICED in anchor.py) is no event.
"""

import math
from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.compilation.layout import Pair, Quaternion, Vector, layout
from rigid_body_sim.mechanics.pulls import total_pull, weight_of
from rigid_body_sim.motions.lagrange_top.anchor import anchor_nutation
from rigid_body_sim.motions.lagrange_top.means import NEVER
from rigid_body_sim.motions.lagrange_top.nutation import (
    CIRCULAR,
    Nutation,
    circular_functions,
    functions,
    hyperbolic_functions,
    load_circular,
    load_course,
    load_hyperbolic,
)
from rigid_body_sim.motions.lagrange_top.theta import Klein
from rigid_body_sim.motions.loops import COLUMNS
from rigid_body_sim.numerics.double_double import add, multiply_double, two_sum
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.pairs import quotient, quotient_of
from rigid_body_sim.numerics.phase import COUNTABLE, TRIES
from rigid_body_sim.numerics.rotations import multiply, rotate, rotate_back, turn_to
from rigid_body_sim.numerics.vectors import cross, minus, plus, scaled
from rigid_body_sim.scene import bodies
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.frame import turned_back
from rigid_body_sim.scene.principal_axes import ULPS
from rigid_body_sim.scene.scene import kept
from rigid_body_sim.scene.state import STATE, StateView

EVENTS = ('turning point',)
entries = takes = None


class Parameters(NamedTuple):
    """Numbers of the scene."""

    mass: float          # kg
    g: float             # m/s^2, with all that pulls at the centre of mass
    arm: float           # h, m
    pull: Pair           # M g h/I1, 1/s^2
    ratio: Pair          # I3/I1
    excess: Pair         # (I1 - I3)/I1
    rotor: Pair          # H/I1, rad/s
    frame: Quaternion    # turns the axes of the top, whose third is e3, to those of the body
    point: Vector        # from the body's origin to the pivot, body axes, m
    is_away: float       # 1.0 where they are not the same, else 0.0


class Steady(NamedTuple):
    """Constants of the motion."""

    start: float         # time of the start, s
    spin: float          # omega_3, rad/s
    frame: Quaternion    # see Parameters
    pivot: Vector        # in the world, m
    point: Vector        # see Parameters
    is_away: float


class Anchor(NamedTuple):
    """Numbers that one state determines."""

    nutation: Nutation
    steady: Steady


class Reaction(NamedTuple):
    """What the pivot does to the body."""

    force: Vector        # world axes, N


PARAMETERS, ANCHOR = layout(Parameters), layout(Anchor)
PARAMETER_SIZE, ANCHOR_SIZE = PARAMETERS.size, ANCHOR.size
load_parameters, load_state, store_state = PARAMETERS.load, STATE.load, STATE.store
load_steady, store_steady = ANCHOR.part('steady').load, ANCHOR.part('steady').store
load_start = ANCHOR.part('steady').part('start').load
load_row, store_row, store_reaction = COLUMNS.load, COLUMNS.store, layout(Reaction).store
NOWHERE = (0.0, 0.0, 0.0)
ORDERS = (((0.5, 0.5, 0.5, 0.5), (0.5, 0.5, -0.5, -0.5)),
          ((-0.5, -0.5, -0.5, 0.5), (0.5, -0.5, 0.5, 0.5)),
          (bodies.IDENTITY, (1.0, 0.0, 0.0, 0.0)))
"""Quaternions that turn the third axis into the first, second or third one, and against it."""


def absorbs(scene):
    """Return whether the scene is a symmetric body under its weight alone, held at a point.

    Symmetric means exactly so (:func:`symmetry_axis`). What counts as weight says
    :func:`mechanics.pulls.weight_of`; rotors may turn along the symmetry axis.
    """
    return (scene.constraint.mechanism is Mechanism.POINT and weight_of(scene) is not None
            and is_symmetric(scene))


def is_symmetric(scene):
    """Return whether a body is symmetric and its rotors turn along its axis.

    The scene has a Total (mechanics/pulls.py).
    """
    return symmetry_axis(scene) is not None and rotor_along(scene) is not None


def rotor_along(scene):
    """Return the momentum of rotors along e3 (kg m^2/s), None where some of it lies across."""
    if scene.weight is not None:
        return 0.0
    carried = total_pull(scene).carried
    x, y, along = rotate_back(*symmetry_axis(scene)[1], *rotate(*scene.frame.axes, *carried))
    size = hypot3(*carried)
    return math.copysign(size, along) if max(abs(x), abs(y)) <= ULPS * size else None


@kept
def symmetry_axis(scene):
    """Return the symmetry axis of a scene's body.

    Two moments about the pivot must be the same double, and the centre of mass must lie on the
    third axis: to the last bit where principal axes and body axes coincide up to order and sign,
    else to the rounding of the turn between them.

    Returns
    -------
    axis : int
        0, 1 or 2: the principal axis that is e3; it points towards the centre of mass.
    frame : quaternion
        It turns the top's axes into the body's.
    The result is None where the body is not symmetric.
    """
    inertia, arm = scene.constraint.inertia(scene.body), scene.constraint.arm(scene.body)
    moments, axes = inertia.moments, inertia.axes
    distance = hypot3(*arm)
    if moments[0] == moments[1] == moments[2]:
        if distance > 0.0:
            return 2, turn_to(*(component / distance for component in arm))
        return 2, bodies.IDENTITY
    local = turned_back(axes, arm)
    slack = 0.0 if set(map(abs, axes)) <= {0.0, 0.5, 1.0} else ULPS * distance
    for k, (upright, upside_down) in enumerate(ORDERS):
        i, j = (k + 1) % 3, (k + 2) % 3
        if moments[i] == moments[j] and max(abs(local[i]), abs(local[j])) <= slack:
            return k, multiply(*axes, *(upside_down if local[k] < 0.0 else upright))
    return None


def parameters(scene):
    """Return the numbers of the scene that the kernels take: :class:`Parameters` as an array."""
    return PARAMETERS.array(numbers_of(scene, weight_of(scene)))


def numbers_of(scene, g):
    """Return the :class:`Parameters` of a scene for g (m/s^2)."""
    body, arm = scene.body, hypot3(*scene.constraint.arm(scene.body))
    axis, frame = symmetry_axis(scene)
    point, moments = scene.constraint.point(body), scene.constraint.inertia(body).moments
    # exact, as quotients of integers: M g h/I1, I3/I1 and (I1 - I3)/I1
    across, along = moments[(axis + 1) % 3], moments[axis]
    (I1, of_I1), (I3, of_I3) = across.as_integer_ratio(), along.as_integer_ratio()
    (M, of_M), (pull, of_pull) = body.mass.as_integer_ratio(), g.as_integer_ratio()
    h, of_h = arm.as_integer_ratio()
    weight, of_weight = M * pull * h, of_M * of_pull * of_h
    return Parameters(
        body.mass, float(g), arm, quotient(weight * of_I1, of_weight * I1),
        quotient(I3 * of_I1, of_I3 * I1), quotient(I1 * of_I3 - I3 * of_I1, of_I3 * I1),
        quotient_of(rotor_along(scene), across), frame, point, float(any(point)))


@compiled
def anchor(parameters, start, out):
    """Fill the anchor from the state `start`."""
    fill_anchor(load_parameters(parameters), load_state(start), out)


@compiled_inline
def fill_anchor(p, begin, out):
    """Fill the anchor from Parameters and a StateView."""
    x, y, z, w = multiply(*begin.orientation, *p.frame)
    omega_1, omega_2, omega_3 = rotate_back(*p.frame, *begin.angular_velocity)
    n = multiply_double(p.ratio[0], p.ratio[1], omega_3)
    own_spin = multiply_double(p.excess[0], p.excess[1], omega_3)
    if p.rotor[0] != 0.0:
        (h, low) = p.rotor
        n, own_spin = add(n[0], n[1], h, low), add(own_spin[0], own_spin[1], -h, -low)
    anchor_nutation(Klein((w, z), (y, -x), (omega_2, -omega_1)), n, p.pull, own_spin, out)
    pivot = plus(begin.position, scaled(p.is_away, rotate(*begin.orientation, *p.point)))
    store_steady(out, Steady(begin.time, omega_3, p.frame, pivot, p.point, p.is_away))


@compiled_inline
def _state_of(steady, time, klein):
    """Return the state of a Klein; its norm is 1 up to rounding, which is taken out.

    Its position and velocity are those of the pivot.
    """
    (a_re, a_im), (b_re, b_im), (o_re, o_im) = klein
    fx, fy, fz, fw = steady.frame
    # summed near 0, where rounding has no side
    excess = (((a_re * a_re - 0.25) + (a_im * a_im - 0.25))
              + ((b_re * b_re - 0.25) + (b_im * b_im - 0.25)))
    scale = 1.0 - 0.5 * excess
    q = multiply(scale * -b_im, scale * b_re, scale * a_im, scale * a_re, -fx, -fy, -fz, fw)
    omega = rotate(fx, fy, fz, fw, -o_im, o_re, steady.spin)
    return StateView(time, q, omega, steady.pivot, NOWHERE)


@compiled_inline
def _of_origin(steady, now):
    """Return a state with the position and velocity of the body's origin, not of the pivot."""
    q, omega = now.orientation, now.angular_velocity
    return StateView(now.time, q, omega, minus(now.position, rotate(*q, *steady.point)),
                     minus(now.velocity, rotate(*q, *cross(omega, steady.point))))


@compiled
def state(anchor, time, out):
    """Fill out with the state at a time before or after the anchor."""
    store_state(out, state_at(anchor, time))


@compiled_inline
def state_at(anchor, time):
    """Return the state at a time, a StateView."""
    steady = load_steady(anchor)
    now = _state_of(steady, time, functions(anchor, two_sum(time, -steady.start)))
    if steady.is_away != 0.0:
        now = _of_origin(steady, now)
    return now


@compiled
def fill_columns(anchor, times, columns):
    """Fill columns with up to BLOCK states: the operations of `state`, arranged as vector code."""
    course, steady = load_course(anchor), load_steady(anchor)
    if course.form == CIRCULAR:
        series = load_circular(anchor)
        for k in range(len(times)):
            klein = circular_functions(course, series, two_sum(times[k], -steady.start))
            store_row(columns, _state_of(steady, times[k], klein), k)
    else:
        series = load_hyperbolic(anchor)
        for k in range(len(times)):
            klein = hyperbolic_functions(course, series, two_sum(times[k], -steady.start))
            store_row(columns, _state_of(steady, times[k], klein), k)
    if steady.is_away != 0.0:
        for k in range(len(times)):
            store_row(columns, _of_origin(steady, load_row(columns, k)), k)


@compiled
def next_event(anchor, after):
    """Return the time of the first turning point after `after`, infinite if none is, and 0."""
    if load_course(anchor).nutates == 0.0:
        return math.inf, 0
    index = turning_index(anchor, after) - 1.0
    if not abs(index) < COUNTABLE:
        return math.inf, 0
    time = turning_time(anchor, index)
    for _ in range(TRIES):
        if time > after:
            return time, 0
        index += 1.0
        time = turning_time(anchor, index)
    return math.inf, 0


@compiled
def turning_index(anchor, time):
    """Return the number (a whole float) of the last turning point of beta at or before a time.

    Even numbers are lowest, odd ones highest positions of e3. The turning points in (t1, t2] are
    those after turning_index(t1) up to turning_index(t2). In steady precession the number never
    changes.
    """
    course, start = load_course(anchor), load_start(anchor)
    turns = course.begin.start + course.rate[0] * (time - start)
    return math.floor(2.0 * turns) + course.begin.parity


@compiled
def turning_time(anchor, index):
    """Return the time (s) of a turning point of beta by its number, infinite if there is none."""
    course, start = load_course(anchor), load_start(anchor)
    begin, rate = course.begin, course.rate[0]
    turns = 0.5 * (index - begin.parity)
    if rate == 0.0 or (turns != 0.0 and begin.stretch >= NEVER):
        return math.inf
    return start + (turns - begin.start) / rate


@compiled
def reaction(parameters, state, out):
    """Fill out, shape (3,), with the force of the pivot on the body (N, world axes).

    It is M (acceleration of the centre of mass + g z), without a couple: c = h e3 and
    c'' = h (omega' x e3 + omega x (omega x e3)), with omega' by Euler's equations.
    """
    p, now = load_parameters(parameters), load_state(state)
    q = multiply(*now.orientation, *p.frame)
    omega_1, omega_2, omega_3 = rotate_back(*p.frame, *now.angular_velocity)
    gamma_1, gamma_2, _ = rotate_back(*q, 0.0, 0.0, 1.0)
    turning, pull = p.excess[0] * omega_3 - p.rotor[0], p.pull[0]
    rise_1 = turning * omega_2 + pull * gamma_2
    rise_2 = -turning * omega_1 - pull * gamma_1
    push = p.mass * p.arm
    x, y, z = rotate(*q, push * (rise_2 + omega_1 * omega_3), push * (omega_2 * omega_3 - rise_1),
                     -push * (omega_1 * omega_1 + omega_2 * omega_2))
    store_reaction(out, Reaction((x, y, z + p.mass * p.g)))
