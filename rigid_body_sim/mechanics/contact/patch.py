# SPDX-License-Identifier: Apache-2.0
"""The force at a patch of contact, which resists a spin about the normal, too.

Symbols: laws.py. A patch of radius rho resists a spin w about the normal: Coulomb's law then holds
for (u, rho w) in three dimensions, and the couple about n over rho is the third component of
friction (class Patch). A patch so small that its slip relaxes at once pivots: friction gives what
u' needs, and the rest of mu N goes against the spin, f_3 = -sgn(w) sqrt((mu N)^2 - |F_t|^2). The
slip that Coulomb's law has for this friction is

    u = F_t rho w/f_3
"""

import math
from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.layout import Matrix, Vector
from rigid_body_sim.mechanics.contact.laws import CLOSE, MOST_LAG, NEWTON, System, sticking
from rigid_body_sim.numerics.polynomial import zeros_up_to
from rigid_body_sim.numerics.vectors import apply, cross, dot, minus, plus, scaled


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
    found, growth, good = _refined(patch, mu, d)
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
    places = zeros_up_to((
        det * det - dot(a, a), 2.0 * (minors * det - dot(f, a)),
        minors * minors + 2.0 * (trace * det - dot(k, a)) - dot(f, f),
        2.0 * (det + trace * minors - dot(k, f)), trace * trace + 2.0 * minors - dot(k, k),
        2.0 * trace, 1.0), math.sqrt(size) + math.sqrt(dot(k, k)))
    for x in places:
        d = scaled(det + x * (minors + x * (trace + x)), plus(a, scaled(x, plus(f, scaled(x, k)))))
        size = math.sqrt(dot(d, d))
        if size > 0.0:
            d, growth, good = _refined(patch, mu, scaled(1.0 / size, d))
            if good and growth > most:
                best, most = d, growth
    return best, most


@compiled
def _across(patch, mu, d):
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
    one = _slope(patch, mu, first, pushed, N, A)
    other = _slope(patch, mu, second, pushed, N, A)
    slopes = (dot(first, one) - growth, dot(first, other), dot(second, one),
              dot(second, other) - growth)
    return first, second, slopes, (dot(first, v), dot(second, v)), growth, A


@compiled
def _turn(d, first, second, slopes, x, y, most):
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
def _refined(patch, mu, d):
    """Return (d, d . v', whether Newton's method converged to a v' parallel to d)."""
    growth, good, A = 0.0, False, 0.0
    for _ in range(NEWTON):
        first, second, slopes, parts, growth, A = _across(patch, mu, d)
        d, size = _turn(d, first, second, slopes, -parts[0], -parts[1], 0.5)
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
    first, second, slopes, _, _, _ = _across(patch, mu, d)
    return _turn(d, first, second, slopes, dot(first, turned), dot(second, turned), MOST_LAG)


@compiled
def _slope(patch, mu, along, pushed, N, A):
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
    one = _slope(patch, mu, plus((1.0, 0.0, 0.0), scaled(-d[0], d)), pushed, N, A)
    other = _slope(patch, mu, plus((0.0, 1.0, 0.0), scaled(-d[1], d)), pushed, N, A)
    return A > 0.0 and N > 0.0 and one[0] + other[1] < 0.0 and (
        one[0] * other[1] > one[1] * other[0])
