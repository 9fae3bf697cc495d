# SPDX-License-Identifier: Apache-2.0
"""The force at the point of contact: Coulomb's law, rolling, and impacts.

Symbols: e1, e2, e3 axes of the plane (e3 = n, away from it), r from the centre of mass to the
point of contact P, f force on the body at P, N = f . n, F_t the rest of f, I tensor about the
centre of mass, m mass, u velocity of the body's point at P (the slip), d = u/|u|. As P is the
lowest point, n . u is the rate of the gap, and

    u' = b + G f,   G f = f/m + (I^-1 (r x f)) x r,
    b = F/m + (I^-1 (T - omega x I omega)) x r + omega x (omega x r) + omega x r'

with F, T force and couple of all else. A couple N c of rolling friction adds N
(I^-1 c) x r. The components along e1, e2, e3 form a System. Slip: f = N (n - mu d) with
n . u' = 0. Stick: f = -G^-1 b. An impact is the same algebra on impulses, with (u_t, (1 + e) u_n)
in place of b: Newton's restitution e, and Coulomb's law for the impulses.

Slip that begins leaves along a direction d that it keeps at first: u' is parallel to d.

Sources: M. Antali and G. Stepan, Nonlinear Dynamics 97 (2019) 1799 (slip and stick in three
dimensions); F. Genot and B. Brogliato, Eur. J. Mech. A 18 (1999) 653 (Painleve's paradox).
"""

import math
from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.layout import Matrix, Vector
from rigid_body_sim.numerics.functions import hypot
from rigid_body_sim.numerics.vectors import cross, dot, scaled

NEWTON = 50         # most Newton steps for a direction
SECTORS = 32        # directions that are tried where they fail
HALVINGS = 30       # of a sector in which such a direction lies
CLOSE = 1e-16       # rad: a step that short is the last
MOST_LAG = 1e-2     # rad: by which a slip that has just begun may lag


class System(NamedTuple):
    """How a force at the point of contact changes its velocity, along the axes of the plane.

    Attributes
    ----------
    G : Matrix
        1/kg; its last column is for N and includes the couple of friction that goes with N.
    b : Vector
        m/s^2, or the velocity before an impact, m/s.
    """

    G: Matrix
    b: Vector


@compiled
def sticking(system):
    """Return f with b + G f = 0 (Cramer's rule)."""
    a1, a2, a3 = system.G
    b1, b2, b3 = system.b
    c1 = a1[0], a2[0], a3[0]
    c2 = a1[1], a2[1], a3[1]
    c3 = a1[2], a2[2], a3[2]
    b = -b1, -b2, -b3
    across = cross(c2, c3)
    inverse = 1.0 / dot(c1, across)
    return (inverse * dot(b, across), inverse * dot(c1, cross(b, c3)),
            inverse * dot(c1, cross(c2, b)))


@compiled
def slipping(system, mu, dx, dy):
    """Return (u' in the plane, N, A) for a slip along d; N = -b_n/A, and A <= 0 is the paradox."""
    first, second, third = system.G
    push = -mu * dx, -mu * dy, 1.0
    A = dot(third, push)
    N = -system.b[2] / A
    return system.b[0] + N * dot(first, push), system.b[1] + N * dot(second, push), N, A


@compiled
def departure(system, mu, dx, dy):
    """Return (d, growth): the direction along which slip leaves, and how fast it grows.

    Newton's method from a first guess d; where that does not find a growing slip, all directions
    are looked at.

    Returns
    -------
    dx, dy : float
    growth : float
        d . u', m/s^2.
    """
    dx, dy, growth, good = _refined(system, mu, dx, dy)
    if good and growth > 0.0:
        return dx, dy, growth
    best = dx, dy, growth if good else -math.inf
    for k in range(SECTORS):
        x, y = _between(system, mu, _around(k), _around(k + 1))
        x, y, growth, good = _refined(system, mu, x, y)
        if good and growth > best[2]:
            best = x, y, growth
    return best


@compiled
def _around(k):
    """Return the direction k of SECTORS: points of a square, made unit vectors."""
    part = 8.0 * (k % SECTORS) / SECTORS
    side = int(part / 2.0)
    along = part - 2.0 * side - 1.0
    x, y = (1.0, along) if side == 0 else (-along, 1.0) if side == 1 else \
        (-1.0, -along) if side == 2 else (along, -1.0)
    size = hypot(x, y)
    return x / size, y / size


@compiled
def _between(system, mu, first, second):
    """Return a direction between two where u' is parallel to it, or the first if none shows.

    The part of u' across d has a pole where A = 0, beside which Newton's method misses a zero;
    times A it has none.
    """
    low = _across(system, mu, first)
    if not low * _across(system, mu, second) < 0.0:
        return first
    left, right = first, second
    for _ in range(HALVINGS):
        x, y = left[0] + right[0], left[1] + right[1]
        size = hypot(x, y)
        middle = x / size, y / size
        if low * _across(system, mu, middle) > 0.0:
            left = middle
        else:
            right = middle
    return left


@compiled
def _across(system, mu, d):
    """Return A times the part of u' across d."""
    _, turns, _, A = turning(system, mu, d[0], d[1])
    return A * turns


@compiled
def turning(system, mu, dx, dy):
    """Return how u' stands to a direction d.

    Returns
    -------
    growth, turns : float
        The parts of u' along d and across it (to the left), m/s^2.
    slope : float
        Derivative of the part across by the angle of d, m/s^2.
    A : float
        1/kg; at most 0 in Painleve's paradox.
    """
    first, second, third = system.G
    ux, uy, N, A = slipping(system, mu, dx, dy)
    growth = dx * ux + dy * uy
    # derivatives by the angle of d, which turns d to (-d_y, d_x)
    turned = mu * dy, -mu * dx
    grown = -N / A * (third[0] * turned[0] + third[1] * turned[1])
    push = -mu * dx, -mu * dy, 1.0
    sx = grown * dot(first, push) + N * (first[0] * turned[0] + first[1] * turned[1])
    sy = grown * dot(second, push) + N * (second[0] * turned[0] + second[1] * turned[1])
    return growth, dx * uy - dy * ux, dx * sy - dy * sx - growth, A


@compiled
def _refined(system, mu, dx, dy):
    """Return (d, d . u', whether Newton's method converged to a u' parallel to d)."""
    growth, good, A = 0.0, False, 0.0
    for _ in range(NEWTON):
        growth, turns, slope, A = turning(system, mu, dx, dy)
        step = -turns / slope if slope != 0.0 else 0.0
        step = max(-0.5, min(0.5, step))
        dx, dy = dx - step * dy, dy + step * dx
        size = hypot(dx, dy)
        dx, dy = dx / size, dy / size
        if abs(step) <= CLOSE:
            good = True
            break
        good = abs(step) <= 1e-12
    return dx, dy, growth, good and A > 0.0


@compiled
def impulse(G, velocity, restitution, mu):
    """Return the impulse (N s, axes of the plane) of an impact with a velocity of P before it.

    P leaves with -e times its normal velocity. It sticks if Coulomb's law allows the impulse, and
    slides on otherwise, along the direction that it has after the impact.
    """
    vx, vy, vz = velocity
    system = System(G, (vx, vy, (1.0 + restitution) * vz))
    stuck = sticking(system)
    friction = hypot(stuck[0], stuck[1])
    if mu > 1e300 or friction <= mu * stuck[2]:
        return stuck
    size = hypot(vx, vy)
    guess = (vx / size, vy / size) if size > 0.0 else \
        (-stuck[0] / friction, -stuck[1] / friction)
    if mu == 0.0:
        return 0.0, 0.0, -system.b[2] / G[2][2]
    dx, dy, _ = departure(system, mu, *guess)
    N = slipping(system, mu, dx, dy)[2]
    return scaled(N, (-mu * dx, -mu * dy, 1.0))
