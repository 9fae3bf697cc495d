"""Sphere on a table with Coulomb friction, in closed form and in three dimensions (notes, "Billiard ball slipping -> rolling").

Symbols: a radius, M mass, k = I/(M a^2) (2/5 solid, 2/3 shell), mu coefficient of friction, g gravity that presses the ball on the
table, z up, v velocity of the centre, omega angular velocity in world axes, u = v - a omega x z velocity of the lowest point (the slip),
e = u/|u|.

While u != 0 the table pushes with -mu M g e, so v' = -mu g e, a omega' = (mu g/k) z x e, u' = -mu g (1 + 1/k) e: the slip keeps its
direction and dies at the onset of rolling,

    t_r = k |u0|/((1 + k) mu g),  v_r = (v0 + k a omega0 x z)/(1 + k)   (solid: t = 2 |v0 - a omega0|/(7 mu g), v = 5 v0 (1 + h/a)/7).

From there on v and omega are constant and the slip is exactly zero. Spin about the vertical is untouched. While sliding omega runs along
a straight line, so the attitude is a ramped rotation (rigid_body_sim/numerics/ramped_rotation.py): elementary without side spin, else
parabolic-cylinder functions, with checkpoints along the slide so that a later state costs one short step.

A state whose slip is below ROUNDING (|v| + a |omega|) rolls: that much is left of zero when a rolling state goes through body axes.

Kernels besides those of every motion: `rolling_onset`, `slip`, `reaction`, `exchanged`, `next_event`.
"""

import math

import numpy as np

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.mechanics.ledger import DISSIPATED, ENTRIES_SIZE
from rigid_body_sim.numerics.functions import cos, hypot, sin
from rigid_body_sim.numerics.ramped_rotation import HALF_STEP, RIM, ramped_rotation
from rigid_body_sim.numerics.rotations import multiply, normalised, rotate, rotate_back
from rigid_body_sim.scene.constraints import Table
from rigid_body_sim.scene.effects.sliding_friction import SlidingFriction
from rigid_body_sim.scene.state import STATE_SIZE

ROUNDING = 2.0 ** -49    # 8 ulp; body axes and back were seen to leave 2.9 in 200,000 random states
CHECKPOINTS = 32
EVENTS = ('rolling began',)
fill_columns = None

RADIUS, RATIO, MASS, FRICTION, GRAVITY = range(5)
PARAMETER_SIZE = 5

# layout of the anchor
START = 5                                    # the state there, angular velocity in world axes
SLIP, DIRECTION = 19, 20                     # |u0| and e = (x, y)
DURATION = 22                                # of the slide; infinite if it never ends
DECELERATION, RAMP = 23, 24                  # mu g; |omega'|
ALONG, ACROSS, ACROSS_AXIS = 25, 26, 27      # parts of omega0 along omega' and across it; unit vector of the latter
ROLLING_ORIENTATION, ROLLING_VELOCITY, ROLLING_POSITION, ROLLING_SPIN = 30, 34, 36, 38    # at the onset; spin: axis and rate
COUNT, INTERVAL, ATTITUDES = 42, 43, 44      # checkpoints along the slide
ANCHOR_SIZE = ATTITUDES + 4 * CHECKPOINTS


def absorbs(scene):
    """Return whether the scene is a balanced sphere on a table, with friction or without."""
    return (isinstance(scene.constraint, Table) and scene.lists_only(SlidingFriction)
            and scene.body.about_center.moments[0] > 0.0)


def parameters(scene):
    """Return radius (m), k, mass (kg), mu and g (m/s^2)."""
    body, friction = scene.body, scene.effect('sliding_friction')
    ratio = body.about_center.moments[0] / (body.mass * body.radius * body.radius)
    return np.array([body.radius, ratio, body.mass, friction.mu if friction else 0.0, friction.g if friction else 0.0])


@compiled
def anchor(parameters, start, anchor):
    """Fill the anchor from the state `start`."""
    a, k = parameters[RADIUS], parameters[RATIO]
    for n in range(PARAMETER_SIZE):
        anchor[n] = parameters[n]
    qx, qy, qz, qw = normalised(start[1], start[2], start[3], start[4])
    wx, wy, wz = rotate(qx, qy, qz, qw, start[5], start[6], start[7])
    vx, vy = start[11], start[12]
    for n in range(STATE_SIZE):
        anchor[START + n] = start[n]
    anchor[START + 1], anchor[START + 2], anchor[START + 3], anchor[START + 4] = qx, qy, qz, qw
    anchor[START + 5], anchor[START + 6], anchor[START + 7] = wx, wy, wz
    ux, uy = vx - a * wy, vy + a * wx
    slip = hypot(ux, uy)
    for n in range(SLIP, ATTITUDES):
        anchor[n] = 0.0
    if slip <= ROUNDING * (hypot(vx, vy) + a * hypot(hypot(wx, wy), wz)):
        _roll(anchor, vx, vy, start[8], start[9], qx, qy, qz, qw)
        return
    ex, ey = ux / slip, uy / slip
    deceleration = parameters[FRICTION] * parameters[GRAVITY]
    ramp = deceleration / (k * a)
    anchor[SLIP], anchor[DIRECTION], anchor[DIRECTION + 1] = slip, ex, ey
    anchor[DECELERATION], anchor[RAMP] = deceleration, ramp
    _split_spin(anchor, wx, wy, wz, ex, ey)
    anchor[COUNT] = 1.0
    anchor[ATTITUDES], anchor[ATTITUDES + 1], anchor[ATTITUDES + 2], anchor[ATTITUDES + 3] = qx, qy, qz, qw
    gain = k * slip / (1.0 + k)
    if ramp == 0.0 or gain > 1e300 * deceleration:
        anchor[DURATION] = math.inf
        return
    duration = gain / deceleration
    anchor[DURATION] = duration
    qx, qy, qz, qw = _lay_checkpoints(anchor, duration)
    vx, vy = vx - gain * ex, vy - gain * ey
    x, y = start[8] + 0.5 * duration * (start[11] + vx), start[9] + 0.5 * duration * (start[12] + vy)
    _roll(anchor, vx, vy, x, y, qx, qy, qz, qw)


@compiled
def _split_spin(anchor, wx, wy, wz, ex, ey):
    """Fill the parts of omega0 along omega' = ramp (z x e) and across it; rounding of omega0 is no side spin."""
    forward = wx * ex + wy * ey
    anchor[ALONG] = wy * ex - wx * ey
    across = hypot(forward, wz)
    if across <= ROUNDING * abs(anchor[ALONG]):
        anchor[ACROSS_AXIS + 2] = 1.0
        return
    anchor[ACROSS] = across
    anchor[ACROSS_AXIS], anchor[ACROSS_AXIS + 1], anchor[ACROSS_AXIS + 2] = forward * ex / across, forward * ey / across, wz / across


@compiled
def _roll(anchor, vx, vy, x, y, qx, qy, qz, qw):
    """Fill what holds from the onset of rolling on: omega = (-v_y, v_x)/a and the vertical spin."""
    a = anchor[RADIUS]
    wx, wy, wz = -vy / a, vx / a, anchor[START + 7]
    rate = hypot(hypot(wx, wy), wz)
    anchor[ROLLING_ORIENTATION], anchor[ROLLING_ORIENTATION + 1] = qx, qy
    anchor[ROLLING_ORIENTATION + 2], anchor[ROLLING_ORIENTATION + 3] = qz, qw
    anchor[ROLLING_VELOCITY], anchor[ROLLING_VELOCITY + 1] = vx, vy
    anchor[ROLLING_POSITION], anchor[ROLLING_POSITION + 1] = x, y
    if rate > 0.0:
        anchor[ROLLING_SPIN], anchor[ROLLING_SPIN + 1], anchor[ROLLING_SPIN + 2] = wx / rate, wy / rate, wz / rate
        anchor[ROLLING_SPIN + 3] = rate


@compiled
def _lay_checkpoints(anchor, duration):
    """Fill the attitudes along the slide, one a Taylor step as far as there is room, and return the one at the onset."""
    along, across = anchor[ALONG], anchor[ACROSS]
    end, rim = along + anchor[RAMP] * duration, RIM * math.sqrt(anchor[RAMP])
    steps = 0.25 * duration * max(hypot(along, across), hypot(end, across)) / HALF_STEP
    count = 1
    if across > 0.0 and steps < CHECKPOINTS:
        count = 1 + int(steps)
    elif 0.0 < across < rim and along < rim and end > -rim:
        count = CHECKPOINTS
    anchor[COUNT], anchor[INTERVAL] = count, duration / count
    for n in range(count):
        qx, qy, qz, qw = _sliding_attitude(anchor, n, duration / count)
        if n + 1 < count:
            _keep_attitude(anchor, n + 1, qx, qy, qz, qw)
    return qx, qy, qz, qw


@compiled
def _keep_attitude(anchor, n, qx, qy, qz, qw):
    at = ATTITUDES + 4 * n
    anchor[at], anchor[at + 1], anchor[at + 2], anchor[at + 3] = qx, qy, qz, qw


@compiled
def _sliding_attitude(anchor, n, time):
    """Return the attitude of the sliding ball at a time after checkpoint n."""
    along = anchor[ALONG] + anchor[RAMP] * (n * anchor[INTERVAL])
    x, y, z, w = ramped_rotation(along, anchor[ACROSS], anchor[RAMP], time)
    # to the world, from the axes along z x e = (-e_y, e_x, 0), across it, and their product
    ax, ay = -anchor[DIRECTION + 1], anchor[DIRECTION]
    bx, by, bz = anchor[ACROSS_AXIS], anchor[ACROSS_AXIS + 1], anchor[ACROSS_AXIS + 2]
    x, y, z = ax * x + bx * y + ay * bz * z, ay * x + by * y - ax * bz * z, bz * y + (ax * by - ay * bx) * z
    at = ATTITUDES + 4 * n
    qx, qy, qz, qw = multiply(x, y, z, w, anchor[at], anchor[at + 1], anchor[at + 2], anchor[at + 3])
    return normalised(qx, qy, qz, qw)


@compiled
def state(anchor, time, out):
    """Fill out with the state at any time, before or after the anchor."""
    elapsed = time - anchor[START]
    ex, ey = anchor[DIRECTION], anchor[DIRECTION + 1]
    if _rolls(anchor, elapsed):
        rolled = elapsed - anchor[DURATION]
        vx, vy = anchor[ROLLING_VELOCITY], anchor[ROLLING_VELOCITY + 1]
        x, y = anchor[ROLLING_POSITION] + rolled * vx, anchor[ROLLING_POSITION + 1] + rolled * vy
        wx, wy = -vy / anchor[RADIUS], vx / anchor[RADIUS]
        half = 0.5 * anchor[ROLLING_SPIN + 3] * rolled
        sine = sin(half)
        qx, qy, qz, qw = multiply(
            sine * anchor[ROLLING_SPIN], sine * anchor[ROLLING_SPIN + 1], sine * anchor[ROLLING_SPIN + 2], cos(half),
            anchor[ROLLING_ORIENTATION], anchor[ROLLING_ORIENTATION + 1], anchor[ROLLING_ORIENTATION + 2], anchor[ROLLING_ORIENTATION + 3])
        # an ulp in the norm of (axis sin, cos) would be the same at every tick, and the spin would drift where each tick is an anchor
        qx, qy, qz, qw = normalised(qx, qy, qz, qw)
    else:
        lost, gained = anchor[DECELERATION] * elapsed, anchor[RAMP] * elapsed
        vx, vy = anchor[START + 11] - lost * ex, anchor[START + 12] - lost * ey
        x = anchor[START + 8] + elapsed * (anchor[START + 11] - 0.5 * lost * ex)
        y = anchor[START + 9] + elapsed * (anchor[START + 12] - 0.5 * lost * ey)
        wx, wy = anchor[START + 5] - gained * ey, anchor[START + 6] + gained * ex
        n = 0
        if anchor[COUNT] > 1.0 and elapsed > 0.0:
            n = min(int(elapsed / anchor[INTERVAL]), int(anchor[COUNT]) - 1)
        qx, qy, qz, qw = _sliding_attitude(anchor, n, elapsed - n * anchor[INTERVAL])
    out[0] = time
    out[1], out[2], out[3], out[4] = qx, qy, qz, qw
    out[5], out[6], out[7] = rotate_back(qx, qy, qz, qw, wx, wy, anchor[START + 7])
    out[8], out[9], out[10] = x, y, anchor[START + 10]
    out[11], out[12], out[13] = vx, vy, 0.0


@compiled
def _rolls(anchor, elapsed):
    """Return whether the ball rolls; one that rolls at its anchor did so before, too."""
    return anchor[SLIP] == 0.0 or elapsed >= anchor[DURATION]


@compiled
def rolling_onset(anchor):
    """Return the time (s) when rolling begins: the anchor's own if it rolls there, infinite if it never will."""
    return anchor[START] + anchor[DURATION]


@compiled
def slip(anchor, time):
    """Return the velocity (x, y) of the lowest point over the table, m/s; exactly zero once the ball rolls."""
    elapsed = time - anchor[START]
    if _rolls(anchor, elapsed):
        return 0.0, 0.0
    size = anchor[SLIP] - anchor[DECELERATION] * (1.0 + 1.0 / anchor[RATIO]) * elapsed
    return size * anchor[DIRECTION], size * anchor[DIRECTION + 1]


@compiled
def reaction(anchor, time):
    """Return the force of the table on the ball (N, world axes) at the point of contact: friction and the normal force M g."""
    normal = anchor[MASS] * anchor[GRAVITY]
    if _rolls(anchor, time - anchor[START]):
        return 0.0, 0.0, normal
    push = -anchor[FRICTION] * normal
    return push * anchor[DIRECTION], push * anchor[DIRECTION + 1], normal


@compiled
def exchanged(anchor, time, out):
    """Fill out (mechanics/ledger.py) with what friction did since the anchor.

    Heat: mu M g times the distance slid. Angular impulse about the centre: a mu M g z x e times the time slid.
    """
    for n in range(ENTRIES_SIZE):
        out[n] = 0.0
    if anchor[SLIP] == 0.0 or anchor[DECELERATION] == 0.0:
        return
    slid_for = min(time - anchor[START], anchor[DURATION])
    share = slid_for / anchor[DURATION] if anchor[DURATION] > 0.0 else 0.0
    push = anchor[MASS] * anchor[DECELERATION]
    impulse = anchor[RADIUS] * push * slid_for
    out[DISSIPATED] = push * anchor[SLIP] * slid_for * (1.0 - 0.5 * share)
    out[2], out[3] = -impulse * anchor[DIRECTION + 1], impulse * anchor[DIRECTION]


@compiled
def next_event(anchor, after):
    """Return the time and the code (into EVENTS) of the first event later than `after`; infinite if there is none."""
    onset = rolling_onset(anchor)
    return (onset, 0) if anchor[SLIP] > 0.0 and onset > after else (math.inf, 0)
