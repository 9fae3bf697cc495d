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
from rigid_body_sim.numerics.polynomial import zeros_up_to
from rigid_body_sim.numerics.vectors import cross, dot, scaled

NEWTON = 50         # most Newton steps for a direction
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
    are looked at. With u' = x |N| d, x > 0, and 1/N = -A/b_n,

        (x + H) d = k,   H = +-mu (G_tt - b_t n_t/b_n),   k = +-(G_tn - b_t G_nn/b_n),

    where n_t is how friction changes u_n, with + for a body that is pressed on the plane
    (b_n < 0), and - for one that is not. So |d| = 1 is a polynomial in x, |adj(x + H) k|^2 =
    det(x + H)^2, of which all zeros are found. Newton's method leaves of their error the rounding
    of u'.

    Returns
    -------
    dx, dy : float
    growth : float
        d . u', m/s^2.
    """
    dx, dy, growth, good = _refined(system, mu, dx, dy)
    if (good and growth > 0.0) or system.b[2] == 0.0:
        return dx, dy, growth
    best = dx, dy, growth if good else -math.inf
    (g11, g12, c1), (g21, g22, c2), (n1, n2, nn) = system.G
    sign = -math.copysign(1.0, system.b[2])
    b1, b2 = -system.b[0] / system.b[2], -system.b[1] / system.b[2]
    k1, k2 = sign * (c1 + b1 * nn), sign * (c2 + b2 * nn)
    share = sign * mu
    h11, h12 = share * (g11 + b1 * n1), share * (g12 + b1 * n2)
    h21, h22 = share * (g21 + b2 * n1), share * (g22 + b2 * n2)
    # adj(x + H) k = x k + a,   det(x + H) = x^2 + trace x + det
    a1, a2 = h22 * k1 - h12 * k2, h11 * k2 - h21 * k1
    trace, det = h11 + h22, h11 * h22 - h12 * h21
    size = hypot(hypot(h11, h12), hypot(h21, h22)) + hypot(k1, k2)
    polynomial = (
        det * det - (a1 * a1 + a2 * a2), 2.0 * (trace * det - (k1 * a1 + k2 * a2)),
        trace * trace + 2.0 * det - (k1 * k1 + k2 * k2), 2.0 * trace, 1.0, 0.0, 0.0)
    for x in zeros_up_to(polynomial, size):
        turn = det + x * (trace + x)
        dx, dy = turn * (a1 + x * k1), turn * (a2 + x * k2)
        size = hypot(dx, dy)
        if size > 0.0:
            dx, dy, growth, good = _refined(system, mu, dx / size, dy / size)
            if good and growth > best[2]:
                best = dx, dy, growth
    return best


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
