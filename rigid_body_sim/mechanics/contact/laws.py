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

A patch of contact of radius rho resists a spin w about the normal: Coulomb's law then holds for
(u, rho w) in three dimensions, and the couple about n over rho is the third component of friction
(class Patch). A patch so small that its slip relaxes at once pivots: friction gives what u' needs,
and the rest of mu N goes against the spin, f_3 = -sgn(w) sqrt((mu N)^2 - |F_t|^2). The slip that
Coulomb's law has for this friction is

    u = F_t rho w/f_3

Slip that begins leaves along a direction d that it keeps at first: u' is parallel to d.

Sources: M. Antali and G. Stepan, Nonlinear Dynamics 97 (2019) 1799 (slip and stick in three
dimensions); F. Genot and B. Brogliato, Eur. J. Mech. A 18 (1999) 653 (Painleve's paradox).
"""

import math
from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.layout import Matrix, Vector
from rigid_body_sim.numerics.functions import hypot
from rigid_body_sim.numerics.sextic import zeros_of_sextic
from rigid_body_sim.numerics.vectors import apply, cross, dot, minus, plus, scaled

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


class Patch(NamedTuple):
    """A System whose slip is v = (u_1, u_2, rho w), with N apart: v' = b + M f + N c.

    Attributes
    ----------
    M : Matrix
        How the three components of friction change v, 1/kg.
    c, n : Vector
        How N changes v, and how the components of friction change the normal velocity, 1/kg.
    nn : float
        How N changes the normal velocity, 1/kg.
    b : Vector
        v' without a force, m/s^2.
    bn : float
        The normal acceleration without a force, m/s^2.
    """

    M: Matrix
    c: Vector
    n: Vector
    nn: float
    b: Vector
    bn: float


@compiled
def patch_system(system, turned, twisted, spun, rho):
    """Return the Patch of a System.

    Parameters
    ----------
    turned : Vector
        How the components of the force change the spin w, 1/(kg m); N with its couple.
    twisted : Vector
        How a couple about the normal changes the velocity of P, axes of the plane; the rate of the
        spin by it stands apart:
    spun : tuple of 2 floats
        w' without a force (rad/s^2), and by a couple (1/(kg m^2)).
    """
    a1, a2, a3 = system.G
    M = ((a1[0], a1[1], rho * twisted[0]), (a2[0], a2[1], rho * twisted[1]),
         (rho * turned[0], rho * turned[1], rho * rho * spun[1]))
    return Patch(M, (a1[2], a2[2], rho * turned[2]), (a3[0], a3[1], rho * twisted[2]), a3[2],
                 (system.b[0], system.b[1], rho * spun[0]), system.b[2])


@compiled
def patch_sticking(patch):
    """Return (friction, N): v' = 0 and no normal acceleration. M is eliminated first."""
    M, c, n, nn, b, bn = patch
    by_b, by_c = sticking(System(M, scaled(-1.0, b))), sticking(System(M, scaled(-1.0, c)))
    N = (dot(n, by_b) - bn) / (nn - dot(n, by_c))
    return scaled(-1.0, plus(by_b, scaled(N, by_c))), N


@compiled
def patch_slipping(patch, mu, d):
    """Return (v', N, A) for a slip of a patch along a unit vector d."""
    push = scaled(-mu, d)
    A = dot(patch.n, push) + patch.nn
    N = -patch.bn / A
    return plus(patch.b, scaled(N, plus(apply(patch.M, push), patch.c))), N, A


@compiled
def patch_departure(patch, mu, d):
    """Return (d, growth): the direction along which the slip of a patch leaves, as `departure`.

    With v' = x |N| d the direction follows from x > 0: as 1/N = -A/b_n,

        (x + H) d = k,   H = +-mu (M - b n/b_n),   k = +-(c - b n_n/b_n),

    with + for a body that is pressed on the plane (b_n < 0), and - for one that is not. So
    |d| = 1 is a polynomial in x, |adj(x + H) k|^2 = det(x + H)^2, of which all zeros are found.
    Newton's method leaves of its error the rounding of v'.
    """
    found, growth, good = _patch_refined(patch, mu, d)
    if (good and growth > 0.0) or patch.bn == 0.0:
        return found, growth
    best, most = found, growth if good else -math.inf
    sign = -math.copysign(1.0, patch.bn)
    rated = scaled(-1.0 / patch.bn, patch.b)
    k = scaled(sign, plus(patch.c, scaled(patch.nn, rated)))
    push, rows = scaled(sign * mu, patch.n), patch.M
    H = (plus(scaled(sign * mu, rows[0]), scaled(rated[0], push)),
         plus(scaled(sign * mu, rows[1]), scaled(rated[1], push)),
         plus(scaled(sign * mu, rows[2]), scaled(rated[2], push)))
    # adj(x + H) k = x^2 k + x f + a,   det(x + H) = x^3 + trace x^2 + minors x + det
    first, second, third = cross(H[1], H[2]), cross(H[2], H[0]), cross(H[0], H[1])
    trace, det = H[0][0] + H[1][1] + H[2][2], dot(H[0], first)
    minors = first[0] + second[1] + third[2]
    f = minus(scaled(trace, k), apply(H, k))
    a = plus(plus(scaled(k[0], first), scaled(k[1], second)), scaled(k[2], third))
    size = dot(H[0], H[0]) + dot(H[1], H[1]) + dot(H[2], H[2])
    places = zeros_of_sextic((
        det * det - dot(a, a), 2.0 * (minors * det - dot(f, a)),
        minors * minors + 2.0 * (trace * det - dot(k, a)) - dot(f, f),
        2.0 * (det + trace * minors - dot(k, f)), trace * trace + 2.0 * minors - dot(k, k),
        2.0 * trace, 1.0), math.sqrt(size) + math.sqrt(dot(k, k)))
    for x in places:
        d = scaled(det + x * (minors + x * (trace + x)), plus(a, scaled(x, plus(f, scaled(x, k)))))
        size = math.sqrt(dot(d, d))
        if size > 0.0:
            d, growth, good = _patch_refined(patch, mu, scaled(1.0 / size, d))
            if good and growth > most:
                best, most = d, growth
    return best, most


@compiled
def _patch_across(patch, mu, d):
    """Return how v' stands across d.

    Returns
    -------
    first, second : Vector
        Two unit vectors across d.
    slopes : tuple of 4 floats
        Derivative of the parts of v' across d, by a turn of d towards each, m/s^2.
    parts : tuple of 2 floats
        The parts, m/s^2.
    growth, A : float
        d . v', m/s^2; as in `turning`.
    """
    v, N, A = patch_slipping(patch, mu, d)
    growth = dot(d, v)
    first = cross(d, (1.0, 0.0, 0.0) if abs(d[0]) < 0.7 else (0.0, 1.0, 0.0))
    first = scaled(1.0 / math.sqrt(dot(first, first)), first)
    second = cross(d, first)
    pushed = plus(apply(patch.M, scaled(-mu, d)), patch.c)
    one = _patch_slope(patch, mu, first, pushed, N, A)
    other = _patch_slope(patch, mu, second, pushed, N, A)
    slopes = (dot(first, one) - growth, dot(first, other), dot(second, one),
              dot(second, other) - growth)
    return first, second, slopes, (dot(first, v), dot(second, v)), growth, A


@compiled
def _patch_turn(d, first, second, slopes, x, y, most):
    """Turn d until the parts across it change by x and y; return it, and by how much it turned."""
    a, b, c, e = slopes
    det = a * e - b * c
    share = 1.0 / det if det != 0.0 else 0.0
    s, t = share * (e * x - b * y), share * (a * y - c * x)
    size = math.sqrt(s * s + t * t)
    if size > most:
        s, t = most * s / size, most * t / size
    d = plus(d, plus(scaled(s, first), scaled(t, second)))
    return scaled(1.0 / math.sqrt(dot(d, d)), d), size


@compiled
def _patch_refined(patch, mu, d):
    """Return (d, d . v', whether Newton's method converged to a v' parallel to d)."""
    growth, good, A = 0.0, False, 0.0
    for _ in range(NEWTON):
        first, second, slopes, parts, growth, A = _patch_across(patch, mu, d)
        d, size = _patch_turn(d, first, second, slopes, -parts[0], -parts[1], 0.5)
        if size <= CLOSE:
            good = True
            break
        good = size <= 1e-12
    return d, growth, good and A > 0.0


@compiled
def patch_lagging(patch, mu, d, turned):
    """Return the direction of a slip that lags behind a direction d, which turns, and its lag.

    `turned` is the velocity at which d turns, times the speed of the slip, m/s^2.
    """
    first, second, slopes, _, _, _ = _patch_across(patch, mu, d)
    return _patch_turn(d, first, second, slopes, dot(first, turned), dot(second, turned), MOST_LAG)


@compiled
def _patch_slope(patch, mu, along, pushed, N, A):
    """Return the derivative of v' by d along a direction across it."""
    push = scaled(-mu, along)
    return plus(scaled(-N / A * dot(patch.n, push), pushed), scaled(N, apply(patch.M, push)))


@compiled
def patch_pivoting(patch, mu, side, growth):
    """Return (friction, N) of a patch that pivots, or no friction where there is none.

    N and the friction along the plane go with f_3 in a straight line, so that |friction| = mu N is
    a quadratic equation for it. It has one solution on either side if friction can hold a patch
    that does not resist its spin.

    Parameters
    ----------
    side : float
        Sign of the spin.
    growth : tuple of 2 floats
        u', m/s^2.
    """
    M, c, n, nn, b, bn = patch
    along = System(((M[0][0], M[0][1], c[0]), (M[1][0], M[1][1], c[1]), (n[0], n[1], nn)),
                   (b[0] - growth[0], b[1] - growth[1], bn))
    fx, fy, N = sticking(along)
    gx, gy, more = sticking(System(along.G, (M[0][2], M[1][2], n[2])))
    square = 1.0 + gx * gx + gy * gy - mu * mu * more * more
    half = -side * (fx * gx + fy * gy - mu * mu * N * more)
    rest = fx * fx + fy * fy - mu * mu * N * N
    if not (square > 0.0 and rest < 0.0):
        return (0.0, 0.0, 0.0), N
    root = math.sqrt(half * half - square * rest)
    size = -rest / (half + root) if half > 0.0 else (root - half) / square
    third = -side * size
    return (fx + third * gx, fy + third * gy, third), N + third * more


@compiled
def patch_following(patch, mu, d):
    """Return whether the slip u of a patch that pivots is drawn to that of Coulomb's law.

    Then u' falls as u grows: the eigenvalues of du'/du have negative real parts.

    Parameters
    ----------
    d : Vector
        Unit vector along (u, rho w).
    """
    _, N, A = patch_slipping(patch, mu, d)
    pushed = plus(apply(patch.M, scaled(-mu, d)), patch.c)
    one = _patch_slope(patch, mu, plus((1.0, 0.0, 0.0), scaled(-d[0], d)), pushed, N, A)
    other = _patch_slope(patch, mu, plus((0.0, 1.0, 0.0), scaled(-d[1], d)), pushed, N, A)
    return A > 0.0 and N > 0.0 and one[0] + other[1] < 0.0 and (
        one[0] * other[1] > one[1] * other[0])


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
