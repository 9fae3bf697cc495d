# SPDX-License-Identifier: Apache-2.0
"""Sphere on a table with Coulomb friction (notes, "Billiard ball slipping -> rolling").

It is solved in closed form and in three dimensions.

Symbols: a radius, M mass, k = I/(M a^2) (2/5 solid, 2/3 shell), mu coefficient of friction, g
gravity that presses the ball on the table, z up, v velocity of the centre, omega angular velocity
in world axes, u = v - a omega x z velocity of the lowest point (the slip), e = u/|u|.

While u != 0 the table pushes with -mu M g e, so v' = -mu g e, a omega' = (mu g/k) z x e,
u' = -mu g (1 + 1/k) e: the slip keeps its direction and ends at the onset of rolling,

    t_r = k |u0|/((1 + k) mu g),        v_r = (v0 + k a omega0 x z)/(1 + k)

(solid: t = 2 |v0 - a omega0|/(7 mu g), v = 5 v0 (1 + h/a)/7). From there on v and omega are
constant and the slip is exactly zero. Spin about the vertical is untouched. While sliding omega
changes linearly, so the attitude is a ramped rotation (numerics/ramped_rotation.py):
elementary without side spin, else parabolic-cylinder functions, with checkpoints along the slide
so that a later state costs one short step.

A state whose slip is below ROUNDING (|v| + a |omega|) rolls: the rounding of a rolling state in
body axes leaves that much.

Kernels besides those of every motion: `rolling_onset`, `slip`, `reaction`, `entries`,
`next_event`.
"""

import math
from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.compilation.layout import Pair, Quaternion, Vector, layout
from rigid_body_sim.mechanics.ledger import DISSIPATED, ENTRIES, ENTRIES_SIZE
from rigid_body_sim.numerics.functions import hypot, sin_cos
from rigid_body_sim.numerics.ramped_rotation import HALF_STEP, RIM, ramped_rotation
from rigid_body_sim.numerics.rotations import multiply, normalised, rotate, rotate_back
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.state import STATE, StateView

ROUNDING = 2.0 ** -49    # 8 ulp; body axes and back left at most 2.9 in 200,000 random states
CHECKPOINTS = 32
EVENTS = ('rolling began',)
fill_columns = takes = None


class Parameters(NamedTuple):
    """Numbers of the scene, by the symbols above."""

    a: float     # m
    k: float
    M: float     # kg
    mu: float
    g: float     # m/s^2


class Slide(NamedTuple):
    """The sliding; all 0 if the ball rolls at the start."""

    u: float               # |u0|, m/s
    e: Pair
    deceleration: float    # mu g, m/s^2
    ramp: float            # |omega'|, rad/s^2
    along: float           # part of omega0 along omega', rad/s
    across: float          # part across it, rad/s
    across_axis: Vector    # unit vector of the latter


class Rolling(NamedTuple):
    """The ball at the onset of rolling."""

    orientation: Quaternion
    velocity: Pair
    position: Pair
    spin: Pair             # horizontal part of omega, rad/s
    axis: Vector           # direction of omega
    rate: float            # |omega|, rad/s


class Track(NamedTuple):
    """Checkpoints along the slide; their attitudes follow the anchor in the array."""

    count: float
    interval: float        # s


class Anchor(NamedTuple):
    """Numbers that one state determines."""

    ball: Parameters
    start: StateView       # with the angular velocity in world axes
    slide: Slide
    duration: float        # time that the slide takes, s; infinite if it never ends
    rolling: Rolling
    track: Track


class Checkpoint(NamedTuple):
    """One of the attitudes along the slide."""

    orientation: Quaternion


PARAMETERS, ANCHOR = layout(Parameters), layout(Anchor)
PARAMETER_SIZE, SLIDE, ATTITUDES = PARAMETERS.size, ANCHOR.part('slide').first, ANCHOR.size
QUATERNION = layout(Checkpoint).part('orientation')
ANCHOR_SIZE = ATTITUDES + QUATERNION.size * CHECKPOINTS
load_parameters, load_state, store_state = PARAMETERS.load, STATE.load, STATE.store
load_anchor = ANCHOR.load
load_start, store_start = ANCHOR.part('start').load, ANCHOR.part('start').store
store_angular_impulse = ENTRIES.part('angular_impulse').store
load_ball, store_ball = ANCHOR.part('ball').load, ANCHOR.part('ball').store
load_slide, store_slide = ANCHOR.part('slide').load, ANCHOR.part('slide').store
load_duration, store_duration = ANCHOR.part('duration').load, ANCHOR.part('duration').store
load_rolling, store_rolling = ANCHOR.part('rolling').load, ANCHOR.part('rolling').store
load_rate = ANCHOR.part('rolling').part('rate').load
load_track, store_track = ANCHOR.part('track').load, ANCHOR.part('track').store
load_quaternion, store_quaternion = QUATERNION.load, QUATERNION.store


def absorbs(scene):
    """Return whether the scene is a balanced sphere on a table, with friction or without."""
    return (scene.constraint.mechanism is Mechanism.TABLE
            and all(effect.contact is not None for effect in scene.acting)
            and scene.body.about_center.moments[0] > 0.0)


def parameters(scene):
    """Return the numbers of the scene, :class:`Parameters` as an array."""
    body, touch = scene.body, scene.contact
    ratio = body.about_center.moments[0] / (body.mass * body.radius * body.radius)
    return PARAMETERS.array(Parameters(body.radius, ratio, body.mass, touch.mu, touch.g))


@compiled
def anchor(parameters, start, anchor):
    """Fill the anchor from the state `start`."""
    ball, begin = load_parameters(parameters), load_state(start)
    a, k = ball.a, ball.k
    q = normalised(*begin.orientation)
    omega = rotate(*q, *begin.angular_velocity)
    wx, wy, wz = omega
    vx, vy, _ = begin.velocity
    px, py, _ = begin.position
    store_ball(anchor, ball)
    store_start(anchor, StateView(begin.time, q, omega, begin.position, begin.velocity))
    for n in range(SLIDE, ATTITUDES):
        anchor[n] = 0.0
    ux, uy = vx - a * wy, vy + a * wx
    slip = hypot(ux, uy)
    if slip <= ROUNDING * (hypot(vx, vy) + a * hypot(hypot(wx, wy), wz)):
        _roll(anchor, a, wz, (vx, vy), (px, py), q)
        return
    ex, ey = ux / slip, uy / slip
    deceleration = ball.mu * ball.g
    ramp = deceleration / (k * a)
    along, across, axis = _split_spin(omega, ex, ey)
    store_slide(anchor, Slide(slip, (ex, ey), deceleration, ramp, along, across, axis))
    store_track(anchor, Track(1.0, 0.0))
    store_quaternion(anchor, q, int(ATTITUDES))
    gain = k * slip / (1.0 + k)
    if ramp == 0.0 or gain > 1e300 * deceleration:
        store_duration(anchor, math.inf)
        return
    duration = gain / deceleration
    store_duration(anchor, duration)
    q = _lay_checkpoints(anchor, duration)
    at_x, at_y = vx - gain * ex, vy - gain * ey
    x, y = px + 0.5 * duration * (vx + at_x), py + 0.5 * duration * (vy + at_y)
    _roll(anchor, a, wz, (at_x, at_y), (x, y), q)


@compiled_inline
def _split_spin(omega, ex, ey):
    """Return the parts of omega0 along omega' = ramp (z x e) and across it, and the latter's axis.

    A side spin no larger than the rounding of omega0 counts as none.
    """
    wx, wy, wz = omega
    forward, along = wx * ex + wy * ey, wy * ex - wx * ey
    across = hypot(forward, wz)
    if across <= ROUNDING * abs(along):
        return along, 0.0, (0.0, 0.0, 1.0)
    return along, across, (forward * ex / across, forward * ey / across, wz / across)


@compiled
def _roll(anchor, a, wz, velocity, position, orientation):
    """Fill the motion from the onset of rolling: omega = (-v_y, v_x)/a and the vertical spin."""
    wx, wy = -velocity[1] / a, velocity[0] / a
    rate = hypot(hypot(wx, wy), wz)
    axis = (wx / rate, wy / rate, wz / rate) if rate > 0.0 else (0.0, 0.0, 0.0)
    store_rolling(anchor, Rolling(orientation, velocity, position, (wx, wy), axis, rate))


@compiled
def _lay_checkpoints(anchor, duration):
    """Fill the attitudes along the slide and return the one at the onset.

    The checkpoints are one Taylor step apart as far as there is room.
    """
    slide = load_anchor(anchor).slide
    along, across = slide.along, slide.across
    end, rim = along + slide.ramp * duration, RIM * math.sqrt(slide.ramp)
    steps = 0.25 * duration * max(hypot(along, across), hypot(end, across)) / HALF_STEP
    count = 1
    if across > 0.0 and steps < CHECKPOINTS:
        count = 1 + int(steps)
    elif 0.0 < across < rim and along < rim and end > -rim:
        count = CHECKPOINTS
    store_track(anchor, Track(count, duration / count))
    q = load_quaternion(anchor, int(ATTITUDES))
    for n in range(count):
        q = _sliding_attitude(anchor, n, duration / count)
        if n + 1 < count:
            store_quaternion(anchor, q, ATTITUDES + 4 * (n + 1))
    return q


@compiled
def _sliding_attitude(anchor, n, time):
    """Return the attitude of the sliding ball at a time after checkpoint n."""
    slid = load_anchor(anchor)
    slide, (ex, ey) = slid.slide, slid.slide.e
    along = slide.along + slide.ramp * (n * slid.track.interval)
    x, y, z, w = ramped_rotation(along, slide.across, slide.ramp, time)
    # to the world, from the axes along z x e = (-e_y, e_x, 0), across it, and their product
    ax, ay = -ey, ex
    bx, by, bz = slide.across_axis
    turn = (ax * x + bx * y + ay * bz * z, ay * x + by * y - ax * bz * z,
            bz * y + (ax * by - ay * bx) * z, w)
    return normalised(*multiply(*turn, *load_quaternion(anchor, ATTITUDES + 4 * n)))


@compiled
def state(anchor, time, out):
    """Fill out with the state at any time, before or after the anchor."""
    duration, elapsed = load_duration(anchor), time - load_start(anchor).time
    if _rolls(load_slide(anchor).u, duration, elapsed):
        rolled = elapsed - duration
        half = 0.5 * load_rate(anchor) * rolled
        sine, cosine = sin_cos(half)
        rolling = load_rolling(anchor)
        vx, vy = rolling.velocity
        x, y = rolling.position[0] + rolled * vx, rolling.position[1] + rolled * vy
        wx, wy = rolling.spin
        nx, ny, nz = rolling.axis
        q = multiply(sine * nx, sine * ny, sine * nz, cosine, *rolling.orientation)
        # an ulp in the norm of (axis sin, cos) would be the same at every tick, and the spin would
        # drift where each tick is an anchor
        q = normalised(*q)
    else:
        begin, slide, track = load_start(anchor), load_slide(anchor), load_track(anchor)
        ex, ey = slide.e
        px, py, _ = begin.position
        lost, gained = slide.deceleration * elapsed, slide.ramp * elapsed
        v0x, v0y, _ = begin.velocity
        vx, vy = v0x - lost * ex, v0y - lost * ey
        x, y = px + elapsed * (v0x - 0.5 * lost * ex), py + elapsed * (v0y - 0.5 * lost * ey)
        wx = begin.angular_velocity[0] - gained * ey
        wy = begin.angular_velocity[1] + gained * ex
        n = 0
        if track.count > 1.0 and elapsed > 0.0:
            n = min(int(elapsed / track.interval), int(track.count) - 1)
        q = _sliding_attitude(anchor, n, elapsed - n * track.interval)
    begin = load_start(anchor)
    wz, pz = begin.angular_velocity[2], begin.position[2]
    store_state(out, StateView(time, q, rotate_back(*q, wx, wy, wz), (x, y, pz), (vx, vy, 0.0)))


@compiled_inline
def _rolls(u, duration, elapsed):
    """Return whether the ball rolls; one that rolls at its anchor did so before, too."""
    return u == 0.0 or elapsed >= duration


@compiled
def rolling_onset(anchor):
    """Return the time (s) when rolling begins.

    It is the anchor's own if the ball rolls there, and infinite if it never will.
    """
    held = load_anchor(anchor)
    return held.start.time + held.duration


@compiled
def slip(anchor, time):
    """Return the velocity (x, y) of the lowest point over the table, m/s; zero once it rolls."""
    held = load_anchor(anchor)
    slide, elapsed = held.slide, time - held.start.time
    if _rolls(slide.u, held.duration, elapsed):
        return 0.0, 0.0
    size = slide.u - slide.deceleration * (1.0 + 1.0 / held.ball.k) * elapsed
    return size * slide.e[0], size * slide.e[1]


@compiled
def reaction(anchor, time):
    """Return the force of the table on the ball (N, world axes) at the point of contact.

    It is friction and the normal force M g.
    """
    held = load_anchor(anchor)
    normal = held.ball.M * held.ball.g
    if _rolls(held.slide.u, held.duration, time - held.start.time):
        return 0.0, 0.0, normal
    push = -held.ball.mu * normal
    return push * held.slide.e[0], push * held.slide.e[1], normal


@compiled
def entries(anchor, time, out):
    """Fill out (mechanics/ledger.py) with what friction did since the anchor.

    Heat: mu M g times the distance slid. Angular impulse about the centre: a mu M g z x e times
    the time slid.
    """
    for n in range(ENTRIES_SIZE):
        out[n] = 0.0
    held = load_anchor(anchor)
    slide, duration = held.slide, held.duration
    if slide.u == 0.0 or slide.deceleration == 0.0:
        return
    slid_for = min(time - held.start.time, duration)
    share = slid_for / duration if duration > 0.0 else 0.0
    push = held.ball.M * slide.deceleration
    impulse = held.ball.a * push * slid_for
    out[DISSIPATED] = push * slide.u * slid_for * (1.0 - 0.5 * share)
    ex, ey = slide.e
    store_angular_impulse(out, (-impulse * ey, impulse * ex, 0.0))


@compiled
def next_event(anchor, after):
    """Return the time and the code (into EVENTS) of the first event after `after`, or infinity."""
    onset = rolling_onset(anchor)
    return (onset, 0) if load_anchor(anchor).slide.u > 0.0 and onset > after else (math.inf, 0)
