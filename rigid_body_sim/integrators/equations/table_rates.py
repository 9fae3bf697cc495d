# SPDX-License-Identifier: Apache-2.0
"""The equations of a sphere on a table under a held force F and couple T.

Coulomb friction f acts at the lowest point.

Symbols as in rigid_body_sim/motions/sliding_sphere.py: a radius, M mass, k = I/(M a^2), mu, g, z
up, u = v - a omega x z the slip. The normal force is N = M g - F_z (none if that is negative: the
ball stays on the table). With e = a omega x z and p = v + k e, which friction does not change,

    u' = G + (1 + 1/k) f/M,    G = F/M - (T x z)/(k M a),
    p' = F/M + (T x z)/(M a),    I omega_z' = T_z,
    v = (p + k u)/(1 + k),   e = (p - u)/(1 + k).

SLIDING: f = -mu N u/|u|. As u vanishes its direction may turn ever faster, so there time is an
unknown too and the independent variable is s with dt = |u| ds: everything is smooth in s, and |u|
dies like an exponential. ROLLING: u = 0, f = -M G k/(1 + k), as long as |f| <= mu N. GLIDING: no
friction. CREEPING: slip that has just begun. It is so small that it follows G, whose direction
turns with the body at a rate below |omega|, with a lag of u |omega|/G at most: u' = (1 - c/G) G
with c = (1 + 1/k) mu N/M. All but SLIDING have t for their independent variable.
"""

from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.layout import Pair, Quaternion, Vector, layout
from rigid_body_sim.motions import sliding_sphere
from rigid_body_sim.numerics.functions import hypot
from rigid_body_sim.numerics.rotations import multiply, rotate
from rigid_body_sim.numerics.vectors import plus


class Pushed(NamedTuple):
    """The parameters of a sphere that is pushed.

    Attributes
    ----------
    sphere : sliding_sphere.Parameters
    mode : float
    world_force, world_couple, body_force, body_couple : Vector
        What holds in world axes and in body axes, N and N m.
    """

    sphere: sliding_sphere.Parameters
    mode: float
    world_force: Vector
    world_couple: Vector
    body_force: Vector
    body_couple: Vector


class Unknowns(NamedTuple):
    """The unknowns; the ledger follows them."""

    q: Quaternion
    u: Pair
    p: Pair
    spin: float      # omega_z, rad/s
    place: Pair      # since the start, m
    time: float      # since the start, s


PUSHED = layout(Pushed)
PARAMETERS = PUSHED.size
MODE = PUSHED.part('mode').first
RADIUS, RATIO, MASS, FRICTION, GRAVITY = (
    PUSHED.part('sphere').part(name).first for name in sliding_sphere.Parameters._fields)
load_pushed = PUSHED.load
SLIDING, ROLLING, GLIDING, CREEPING = range(4)

Q, U, P, SPIN, PLACE, TIME = (layout(Unknowns).part(name).first for name in Unknowns._fields)
UNKNOWNS = layout(Unknowns).size
GROUPS = (
    (Q, U, True),
    (U, SPIN, False),
    (SPIN, PLACE, False),
    (PLACE, TIME, False),
    (TIME, UNKNOWNS, False),
)


@compiled
def wrench(p, q):
    """Return force and couple, world axes."""
    given = load_pushed(p)
    return (plus(given.world_force, rotate(*q, *given.body_force)),
            plus(given.world_couple, rotate(*q, *given.body_couple)))


@compiled
def drive(p, y):
    """Return G (x, y) and c = (1 + 1/k) mu N/M.

    c is the largest deceleration of the slip that friction can give.
    """
    (fx, fy, fz), (tx, ty, _) = wrench(p, y[:U])
    a, k, M = p[RADIUS], p[RATIO], p[MASS]
    return (
        fx / M - ty / (k * M * a),
        fy / M + tx / (k * M * a),
        (1.0 + 1.0 / k) * p[FRICTION] * max(0.0, p[GRAVITY] - fz / M),
    )


@compiled
def motion(p, y):
    """Return v (x, y) and omega (x, y, z), world axes."""
    a, k = p[RADIUS], p[RATIO]
    ux, uy, px, py, wz = y[U:PLACE]
    vx, vy = (px + k * ux) / (1.0 + k), (py + k * uy) / (1.0 + k)
    return vx, vy, (uy - py) / ((1.0 + k) * a), (px - ux) / ((1.0 + k) * a), wz


@compiled
def rate(p, y):
    """Return the rates of the unknowns, then of the ledger.

    Both are per unit of the independent variable.
    """
    a, k, M = p[RADIUS], p[RATIO], p[MASS]
    (fx, fy, _), (tx, ty, tz) = wrench(p, y[:U])
    slip_x, slip_y = y[U:P]
    gx, gy, c = drive(p, y)
    vx, vy, wx, wy, wz = motion(p, y)
    pace, ux, uy = 1.0, 0.0, 0.0
    if p[MODE] == SLIDING:
        pace = hypot(slip_x, slip_y)
        ux, uy = pace * gx - c * slip_x, pace * gy - c * slip_y
    elif p[MODE] == GLIDING:
        ux, uy = gx, gy
    elif p[MODE] == CREEPING:
        G = hypot(gx, gy)
        share_left = max(0.0, 1.0 - c / G) if G > 0.0 else 0.0
        ux, uy = share_left * gx, share_left * gy
    # pace times friction, from u' = G + (1 + 1/k) f/M
    share = M * k / (1.0 + k)
    rubx, ruby = share * (ux - pace * gx), share * (uy - pace * gy)
    half = 0.5 * pace
    qx, qy, qz, qw = multiply(half * wx, half * wy, half * wz, 0.0, *y[:U])
    return (
        qx, qy, qz, qw,
        ux, uy,
        pace * (fx / M + ty / (M * a)),
        pace * (fy / M - tx / (M * a)),
        pace * tz / (k * M * a * a),
        pace * vx, pace * vy, pace,
        pace * (fx * vx + fy * vy + tx * wx + ty * wy + tz * wz),
        -(rubx * slip_x + ruby * slip_y),
        pace * tx + a * ruby, pace * ty - a * rubx, pace * tz,
    )
