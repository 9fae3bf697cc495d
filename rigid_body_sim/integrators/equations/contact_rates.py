# SPDX-License-Identifier: Apache-2.0
"""Template: the equations of a convex body on a plane, in each of its phases.

It is bound to the sum of what acts besides the contact. Symbols: mechanics/contact/laws.py. All
vectors but omega are along the axes of the plane.

    FLIGHT    no contact: x'' = F/m
    SLIDING   u != 0 (with a patch of contact: or a spin about the normal): f = N (n - mu u/|u|).
              Where u dies its direction may turn ever faster, so time is an unknown and the
              independent variable is s with dt = |u| ds (|u| with the spin of a patch):
              everything is smooth in s, and |u| dies like an exponential
    ROLLING   u = 0: f = -G^-1 b, as long as |F_t| <= mu N. With a patch of contact nothing spins
              about the normal, either, and its couple over rho is the third component of F_t
    GLIDING   no friction (mu = 0)
    RESTING   nothing moves any more
    CREEPING  slip that has just begun, along the direction for which u' is parallel to u; its lag
              behind that direction is corrected to the first order in |u| |omega|/(mu g)

The height of the centre of mass is the gap less n . r, and in contact its velocity is u - omega x
r: gap and normal velocity are zero to the last bit there, and small gaps are as exact as large
ones.

A row of rates ends with what is watched (an event comes where one of the five falls below 0), with
force and couple of the contact, slip, velocity of the centre of mass, and r.
"""

import math

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.mechanics.contact.laws import (
    System,
    departure,
    impulse,
    patch_departure,
    patch_lagging,
    patch_slipping,
    patch_sticking,
    patch_system,
    slipping,
    sticking,
    turning,
)
from rigid_body_sim.mechanics.contact.parameters import CONTACT, FILMY, FLAT, FLATTER, LOW
from rigid_body_sim.mechanics.contact.touch import couples, lever, response, spinning
from rigid_body_sim.numerics.functions import hypot
from rigid_body_sim.numerics.rotations import (
    matrix,
    multiply,
    normalised,
    rotate,
    rotate_back,
)
from rigid_body_sim.numerics.vectors import apply, cross, dot, minus, plus, scaled
from rigid_body_sim.scene.surfaces import TORUS, shifted

# (p, q, omega, v of the centre of mass) -> force (world), couple (body), power of work and heat
applied = UNBOUND

FLIGHT, SLIDING, ROLLING, GLIDING, CREEPING, RESTING = range(6)

# unknowns: attitude, omega (body axes), u or v of the centre of mass (of a creep |u|), place of
# the centre of mass along the plane since the start of the course, gap, time since the start; then
# the ledger
Q, OMEGA, U, PLACE, GAP, TIME = 0, 4, 7, 10, 12, 13
UNKNOWNS = 14
SLID, ROLLED, FILMED, STRUCK, DAMPED, WORK, IMPULSE, SPUN = 14, 15, 16, 17, 18, 19, 20, 23
SIZE = 24
WATCHED = SIZE           # gap or N, grip, A, time to what jumps, what stops
WATCHES = 5
FORCE = WATCHED + WATCHES      # N, axes of the plane
COUPLE = FORCE + 3       # N m, axes of the plane
SLIP = COUPLE + 3        # u, m/s, along the plane
VELOCITY = SLIP + 2      # of the centre of mass, m/s, axes of the plane
LEVER = VELOCITY + 3     # r, m, axes of the plane
PACE = LEVER + 3         # of the slip, with the spin of a patch, m/s
ROW = PACE + 1
PARAMETER_COUNT = CONTACT.size
ROUNDING = 2.0 ** -50    # of a normal velocity, beside the speeds
SLOW = 1e-13             # share of the speeds below which a body does not roll
SPINLESS = 1e-9          # share of the speeds below which a body that rests does not spin
SHORT = 1e-6             # time of a difference, over that in which the body moves by its size

load_contact = CONTACT.load


@compiled_inline
def _applied(p, c, q, omega, v):
    """Return force (axes of the plane), couple (body axes) and powers of what else acts."""
    if c.inclined == 0.0:
        fx, fy, fz, tx, ty, tz, work, heat = applied(p, *q, *omega, *v)
        return (fx, fy, fz), (tx, ty, tz), work, heat
    fx, fy, fz, tx, ty, tz, work, heat = applied(
        p, *multiply(*c.plane, *q), *omega, *rotate(*c.plane, *v))
    return rotate_back(*c.plane, fx, fy, fz), (tx, ty, tz), work, heat


@compiled_inline
def _driven(c, r, omega, carried, moved, torque):
    """Return b without the force F, body axes."""
    return plus(cross(apply(c.inverse, torque), r),
                plus(cross(omega, carried), cross(omega, moved)))


@compiled_inline
def _system(c, axes, r, omega, carried, moved, torque, wrung, F):
    """Return the System under a torque without that of the contact, body axes, and a force F."""
    b = _driven(c, r, omega, carried, moved, torque)
    return System(response(c, axes, r, wrung), plus(apply(axes, b), scaled(1.0 / c.mass, F)))


@compiled_inline
def _rolling_force(c, axes, r, omega, carried, moved, torque, F):
    """Return the force on a body that rolls, axes of the plane.

    With a = A - omega' x r the acceleration of the centre of mass, A = -omega x (omega x r + s'),
    and f = m a - F, the balance of torques is (I + m r^2 1 - m r r^T) omega' = torque + r x (m A -
    F).
    """
    e1, e2, e3 = axes
    A = scaled(-1.0, cross(omega, plus(carried, moved)))
    pushed = plus(scaled(F[0], e1), plus(scaled(F[1], e2), scaled(F[2], e3)))
    net = minus(scaled(c.mass, A), pushed)
    x, y, z = plus(torque, cross(r, net))
    square = c.mass * dot(r, r)
    (a, b, d), (_, e, g), (_, _, h) = c.inertia
    mx, my, mz = scaled(c.mass, r)
    a, e, h = a + square - mx * r[0], e + square - my * r[1], h + square - mz * r[2]
    b, d, g = b - mx * r[1], d - mx * r[2], g - my * r[2]
    # cofactors of the symmetric matrix
    aa, bb, dd = e * h - g * g, d * g - b * h, b * g - d * e
    ee, gg, hh = a * h - d * d, b * d - a * g, a * e - b * b
    share = 1.0 / (a * aa + b * bb + d * dd)
    grown = (share * (aa * x + bb * y + dd * z), share * (bb * x + ee * y + gg * z),
             share * (dd * x + gg * y + hh * z))
    return apply(axes, minus(net, scaled(c.mass, cross(grown, r))))


@compiled_inline
def _slipping_force(c, axes, r, wrung, b, mu, dx, dy):
    """Return (f, u', A) of a slip along d, axes of the plane (laws.slipping, for one force)."""
    e1, e2, e3 = axes
    push = minus(e3, plus(scaled(mu * dx, e1), scaled(mu * dy, e2)))
    moved = plus(scaled(1.0 / c.mass, push),
                 cross(apply(c.inverse, plus(cross(r, push), wrung)), r))
    A = dot(e3, moved)
    N = -b[2] / A
    return ((-mu * N * dx, -mu * N * dy, N),
            (b[0] + N * dot(e1, moved), b[1] + N * dot(e2, moved), 0.0), A)


@compiled
def _leaving(system, mu):
    """Return the direction along which slip leaves a contact that no longer holds."""
    stuck = sticking(system)
    size = hypot(stuck[0], stuck[1])
    guess = (-stuck[0] / size, -stuck[1] / size) if size > 0.0 else (1.0, 0.0)
    dx, dy, _ = departure(system, mu, *guess)
    return dx, dy


@compiled_inline
def _short(c):
    """Return the time of a difference, s."""
    return SHORT * c.size[0] / c.swift


@compiled
def _ahead(p, c, y, axes, r, f, touch):
    """Return the System a short time later under a force and a couple of the contact, body axes.

    Behind it stand what `spinning` takes there: the axes of the plane, the lever, and torque and
    couple that goes with N.
    """
    q, omega = (y[0], y[1], y[2], y[3]), (y[4], y[5], y[6])
    F, T, _, _ = _applied(p, c, q, omega, scaled(-1.0, apply(axes, cross(omega, r))))
    pushed = plus(scaled(f[0], axes[0]), plus(scaled(f[1], axes[1]), scaled(f[2], axes[2])))
    torque = plus(plus(T, touch), cross(r, pushed))
    grown = apply(c.inverse, minus(torque, cross(omega, apply(c.inertia, omega))))
    short = _short(c)
    x, yy, z, w = multiply(*q, *omega, 0.0)
    half = 0.5 * short
    q = normalised(q[0] + half * x, q[1] + half * yy, q[2] + half * z, q[3] + half * w)
    omega = plus(omega, scaled(short, grown))
    axes = matrix(*q)
    r = lever(c, axes[2])
    carried = cross(omega, r)
    moved = shifted(c.kind, c.size, axes[2], cross(axes[2], omega))
    F, T, _, _ = _applied(p, c, q, omega, scaled(-1.0, apply(axes, carried)))
    viscous, wrung, _, _ = couples(c, axes[2], moved)
    torque = minus(plus(T, viscous), cross(omega, apply(c.inertia, omega)))
    return (_system(c, axes, r, omega, carried, moved, torque, wrung, F), axes, r,
            (torque, wrung))


@compiled
def _lagging(p, c, y, system, viscous, wrung, dx, dy):
    """Return the direction of a creep |u|: it lags behind the direction d, which turns.

    With the angle phi of u, |u| phi' is the part of u' across u. Where d turns at the rate phi', u
    stands off d by |u| phi' over the slope of that part. phi' is a difference over a short time.
    """
    axes = matrix(y[0], y[1], y[2], y[3])
    r = lever(c, axes[2])
    _, _, N, _ = slipping(system, c.mu, dx, dy)
    f = -c.mu * N * dx, -c.mu * N * dy, N
    ahead, _, _, _ = _ahead(p, c, y, axes, r, f, plus(viscous, scaled(N, wrung)))
    ex, ey, _ = departure(ahead, c.mu, dx, dy)
    _, _, slope, _ = turning(system, c.mu, dx, dy)
    if not slope < 0.0:
        return dx, dy
    off = y[7] * (dx * ey - dy * ex) / (_short(c) * slope)
    off = max(-1e-2, min(1e-2, off))
    size = hypot(1.0, off)
    return (dx - off * dy) / size, (dy + off * dx) / size


@compiled_inline
def _patch_of(c, axes, r, omega, carried, moved, torque, wrung, F):
    """Return the Patch of a body with a patch of contact."""
    system = _system(c, axes, r, omega, carried, moved, torque, wrung, F)
    turned, twisted, spun = spinning(c, axes, r, torque, wrung)
    return patch_system(system, turned, twisted, spun, c.patch)


@compiled
def _held(c, axes, r, omega, carried, moved, torque, wrung, F):
    """Return force (axes of the plane), couple about the normal and grip of a patch that holds."""
    friction, N = patch_sticking(_patch_of(c, axes, r, omega, carried, moved, torque, wrung, F))
    return ((friction[0], friction[1], N), c.patch * friction[2],
            c.mu * N - math.sqrt(dot(friction, friction)))


@compiled
def _parting(p, c, y, axes, r, patch, viscous, wrung):
    """Return the direction of a creep |w| of a patch that holds no more.

    It lags behind the direction along which the slip begins, as in `_lagging`.
    """
    friction, _ = patch_sticking(patch)
    size = math.sqrt(dot(friction, friction))
    d, _ = patch_departure(patch, c.mu, scaled(-1.0 / size, friction))
    _, N, _ = patch_slipping(patch, c.mu, d)
    f = -c.mu * N * d[0], -c.mu * N * d[1], N
    twist = scaled(-c.mu * N * c.patch * d[2], axes[2])
    system, axes, r, (torque, couple) = _ahead(p, c, y, axes, r, f,
                                               plus(plus(viscous, scaled(N, wrung)), twist))
    turned, twisted, spun = spinning(c, axes, r, torque, couple)
    ahead, _ = patch_departure(patch_system(system, turned, twisted, spun, c.patch), c.mu, d)
    return patch_lagging(patch, c.mu, d, scaled(y[7] / _short(c), minus(ahead, d)))


@compiled
def rate(p, y, k):
    """Fill a row k with the rates of the unknowns y."""
    c = load_contact(p)
    q, omega = (y[0], y[1], y[2], y[3]), (y[4], y[5], y[6])
    axes = matrix(*q)
    e1, e2, e3 = axes
    r = lever(c, e3)
    carried = cross(omega, r)
    mode = c.mode
    u = y[7], y[8], 0.0
    if mode == FLIGHT:
        v = y[7], y[8], y[9]
    else:
        if mode in (ROLLING, CREEPING):
            u = 0.0, 0.0, 0.0
        v = minus(u, apply(axes, carried))
    F, T, work, heat = _applied(p, c, q, omega, v)
    # friction of rolling and of the film of air: couples dual to the motion of P over the surface
    turned = cross(e3, omega)
    moved = shifted(c.kind, c.size, e3, turned)
    k[WATCHED], k[WATCHED + 1], k[WATCHED + 2] = 1.0, 1.0, 1.0
    k[WATCHED + 3] = c.until - y[TIME]
    k[ROLLED], k[FILMED], k[STRUCK], k[SLID], k[SPUN] = 0.0, 0.0, 0.0, 0.0, 0.0
    k[PACE] = 1.0
    f, touch = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)    # plane axes, body axes
    f_body, slip, pace = f, f, 1.0
    torque = minus(T, cross(omega, apply(c.inertia, omega)))
    k[WATCHED + 4] = 1.0
    if mode == RESTING:
        for n in range(SIZE):
            k[n] = 0.0
        k[TIME] = 1.0
        k[FORCE], k[FORCE + 1], k[FORCE + 2] = scaled(-1.0, F)
        k[COUPLE], k[COUPLE + 1], k[COUPLE + 2] = 0.0, 0.0, 0.0
        k[SLIP], k[SLIP + 1] = 0.0, 0.0
        k[VELOCITY], k[VELOCITY + 1], k[VELOCITY + 2] = 0.0, 0.0, 0.0
        k[LEVER], k[LEVER + 1], k[LEVER + 2] = apply(axes, r)
        return
    if mode == FLIGHT:
        # a gap that shrinks no faster than rounding is that of a body that has just lifted off
        shrinks = v[2] + dot(e3, carried) < -ROUNDING * c.swift
        k[WATCHED] = y[GAP] if shrinks else max(y[GAP], 0.0)
        slip = scaled(1.0 / c.mass, F)
    else:
        viscous, wrung, speed, film = couples(c, e3, moved)
        k[ROLLED] = c.rolling_viscous * speed * speed
        k[FILMED] = film * speed * speed
        torque = plus(torque, viscous)
        if mode == ROLLING:
            if c.patch > 0.0:
                f, twist, k[WATCHED + 1] = _held(c, axes, r, omega, carried, moved, torque, wrung,
                                                 F)
                viscous, torque = (plus(viscous, scaled(twist, e3)),
                                   plus(torque, scaled(twist, e3)))
            elif c.rolling > 0.0:
                f = sticking(_system(c, axes, r, omega, carried, moved, torque, wrung, F))
            else:
                f = _rolling_force(c, axes, r, omega, carried, moved, torque, F)
            if c.patch == 0.0:
                k[WATCHED + 1] = c.mu * f[2] - hypot(f[0], f[1]) if c.mu < 1e300 else 1.0
        elif mode in (GLIDING, SLIDING):
            dx, dy, mu = 1.0, 0.0, 0.0
            if mode == SLIDING:
                pace, mu = hypot(y[7], y[8]), c.mu
                if c.patch > 0.0:
                    spin = c.patch * dot(e3, omega)
                    pace = hypot(pace, spin)
                    if pace > 0.0:
                        wrung = minus(wrung, scaled(mu * c.patch * spin / pace, e3))
                if pace > 0.0:
                    dx, dy = y[7] / pace, y[8] / pace
            b = plus(apply(axes, _driven(c, r, omega, carried, moved, torque)),
                     scaled(1.0 / c.mass, F))
            f, slip, A = _slipping_force(c, axes, r, wrung, b, mu, dx, dy)
            k[WATCHED + 2] = A * c.mass
            k[SLID] = mu * f[2] * pace
            k[PACE] = pace
            if c.patch > 0.0 and mode == SLIDING:
                k[SPUN] = mu * f[2] * pace
                k[SLID] = k[SPUN] * (dx * dx + dy * dy)
                k[SPUN] -= k[SLID]
        elif c.patch > 0.0:
            patch = _patch_of(c, axes, r, omega, carried, moved, torque, wrung, F)
            d = _parting(p, c, y, axes, r, patch, viscous, wrung)
            slipped, N, A = patch_slipping(patch, c.mu, d)
            growth = dot(d, slipped)
            dx, dy, dz = d
            wrung = minus(wrung, scaled(c.mu * c.patch * dz, e3))
            f, slip = (-c.mu * N * dx, -c.mu * N * dy, N), (growth, 0.0, 0.0)
            u = y[7] * dx, y[7] * dy, 0.0
            v = plus(v, u)
            k[WATCHED + 1] = c.creep - y[7]
            k[WATCHED + 2] = A * c.mass
            k[SPUN] = c.mu * N * y[7]
            k[SLID] = k[SPUN] * (dx * dx + dy * dy)
            k[SPUN] -= k[SLID]
        else:
            system = _system(c, axes, r, omega, carried, moved, torque, wrung, F)
            dx, dy = _leaving(system, c.mu)
            dx, dy = _lagging(p, c, y, system, viscous, wrung, dx, dy)
            growth = turning(system, c.mu, dx, dy)[0]
            _, _, N, A = slipping(system, c.mu, dx, dy)
            f, slip = (-c.mu * N * dx, -c.mu * N * dy, N), (growth, 0.0, 0.0)
            u = y[7] * dx, y[7] * dy, 0.0
            v = plus(v, u)
            k[WATCHED + 1] = c.creep - y[7]
            k[WATCHED + 2] = A * c.mass
            k[SLID] = c.mu * N * y[7]
        k[WATCHED] = f[2]
        if c.kind == TORUS and c.size[1] == 0.0:
            k[WATCHED + 4] = math.sqrt(e3[0] * e3[0] + e3[1] * e3[1]) - (
                FILMY if c.film > 0.0 else FLAT if c.rolling + c.rolling_viscous > 0.0
                else FLATTER)
        elif c.rolling > 0.0 and mode == ROLLING:
            k[WATCHED + 4] = speed - SLOW * c.swift
        f_body = plus(scaled(f[0], e1), plus(scaled(f[1], e2), scaled(f[2], e3)))
        touch = plus(viscous, scaled(f[2], wrung))
        k[ROLLED] += c.rolling * f[2] * speed
        torque = plus(torque, plus(cross(r, f_body), scaled(f[2], wrung)))
    grown = apply(c.inverse, torque)
    x, yy, z, w = multiply(*q, *omega, 0.0)
    k[0], k[1], k[2], k[3] = 0.5 * x, 0.5 * yy, 0.5 * z, 0.5 * w
    k[4], k[5], k[6] = grown
    k[7], k[8], k[9] = slip
    k[10], k[11], k[GAP] = v[0], v[1], v[2] + dot(e3, carried) if mode == FLIGHT else 0.0
    k[TIME], k[DAMPED], k[WORK] = 1.0, heat, work
    turn = apply(axes, plus(plus(cross(r, f_body), touch), T))
    k[IMPULSE], k[IMPULSE + 1], k[IMPULSE + 2] = turn
    if mode == SLIDING:
        for place in range(SIZE):
            k[place] *= pace
    k[FORCE], k[FORCE + 1], k[FORCE + 2] = f
    k[COUPLE], k[COUPLE + 1], k[COUPLE + 2] = apply(axes, touch)
    k[SLIP], k[SLIP + 1] = u[0], u[1]
    k[VELOCITY], k[VELOCITY + 1], k[VELOCITY + 2] = v
    k[LEVER], k[LEVER + 1], k[LEVER + 2] = apply(axes, r)


@compiled
def velocity_of_lowest(p, y):
    """Return the velocity of the lowest point of a flight, axes of the plane, m/s."""
    c = load_contact(p)
    q, omega = (y[0], y[1], y[2], y[3]), (y[4], y[5], y[6])
    axes = matrix(*q)
    return plus((y[7], y[8], y[9]), apply(axes, cross(omega, lever(c, axes[2]))))


@compiled
def collide(p, y, restitution, out):
    """Change the unknowns of a flight by an impact.

    An impact that would make energy is taken without restitution: Newton's law with friction can.

    Parameters
    ----------
    y : array
        Unknowns, changed in place: omega, velocity, ledger.
    out : array (6,)
        Filled with the slip after the impact (m/s, 0 if it sticks), the normal velocity before and
        after it (m/s), and the normal impulse (N s).
    """
    c = load_contact(p)
    q, omega = (y[0], y[1], y[2], y[3]), (y[4], y[5], y[6])
    axes = matrix(*q)
    r = lever(c, axes[2])
    v = y[7], y[8], y[9]
    before = plus(v, apply(axes, cross(omega, r)))
    G = response(c, axes, r, (0.0, 0.0, 0.0))
    given = impulse(G, before, restitution, c.mu)
    after = plus(before, apply(G, given))
    loss = -0.5 * dot(given, plus(before, after))
    normal = -restitution * before[2]
    if loss < 0.0 and restitution > 0.0:
        given = impulse(G, before, 0.0, c.mu)
        after = plus(before, apply(G, given))
        loss, normal = -0.5 * dot(given, plus(before, after)), 0.0
    body = rotate_back(*q, *given)
    turn = cross(r, body)
    gained = apply(c.inverse, turn)
    y[4], y[5], y[6] = plus(omega, gained)
    y[7], y[8], y[9] = plus(v, scaled(1.0 / c.mass, given))
    y[STRUCK] += loss
    ix, iy, iz = apply(axes, turn)
    y[IMPULSE] += ix
    y[IMPULSE + 1] += iy
    y[IMPULSE + 2] += iz
    sticks = c.mu > 0.0 and hypot(given[0], given[1]) < c.mu * given[2] * (1.0 - 1e-14)
    out[0], out[1] = (0.0, 0.0) if sticks else (after[0], after[1])
    out[2], out[3], out[4] = before[2], normal, given[2]


@compiled
def spins(p, y):
    """Return the speed at which a patch of contact spins on the plane, m/s."""
    c = load_contact(p)
    gamma = matrix(y[0], y[1], y[2], y[3])[2]
    return c.patch * abs(dot(gamma, (y[4], y[5], y[6])))


@compiled
def jams(p, y):
    """Return whether a disk lies so low that its friction of rolling leaves no motion."""
    c = load_contact(p)
    gamma = matrix(y[0], y[1], y[2], y[3])[2]
    edge = c.kind == TORUS and c.size[1] == 0.0
    return (edge and c.rolling + c.rolling_viscous + c.film > 0.0
            and math.sqrt(gamma[0] * gamma[0] + gamma[1] * gamma[1]) < LOW)


@compiled
def stays(p, y):
    """Return whether a body that has almost stopped is at rest: a flat disk, or dry friction.

    Dry rolling friction holds the couple -(S h) x n of a force |h| <= C N, Coulomb's friction the
    force that balances the others. A spin about the normal is not held.
    """
    c = load_contact(p)
    q, omega = (y[0], y[1], y[2], y[3]), (y[4], y[5], y[6])
    axes = matrix(*q)
    e1, e2, gamma = axes
    if c.kind == TORUS and c.size[1] == 0.0:
        return True
    r = lever(c, gamma)
    F, T, _, _ = _applied(p, c, q, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    held = scaled(-1.0, F)
    if not held[2] > 0.0 or hypot(held[0], held[1]) > c.mu * held[2]:
        return False
    if abs(dot(omega, gamma)) * math.sqrt(dot(r, r)) > SPINLESS * c.swift:
        return False
    pushed = plus(scaled(held[0], e1), plus(scaled(held[1], e2), scaled(held[2], gamma)))
    couple = scaled(-1.0, plus(T, cross(r, pushed)))
    if abs(dot(couple, gamma)) > 1e-12 * held[2] * math.sqrt(dot(r, r)):
        return False
    wanted = scaled(-1.0, cross(gamma, couple))    # S h
    first, second = shifted(c.kind, c.size, gamma, e1), shifted(c.kind, c.size, gamma, e2)
    a, b, d = dot(e1, first), dot(e1, second), dot(e2, second)
    x, z = dot(wanted, e1), dot(wanted, e2)
    share = 1.0 / (a * d - b * b)
    return hypot(share * (d * x - b * z), share * (a * z - b * x)) <= c.rolling * held[2]


@compiled
def halt(p, y):
    """Take what is left of the motion, and of the height of a disk, from a body that rests."""
    c = load_contact(p)
    omega = y[4], y[5], y[6]
    axes = matrix(y[0], y[1], y[2], y[3])
    v = apply(axes, cross(lever(c, axes[2]), omega))
    if c.mode != ROLLING:
        v = plus(v, (y[7], y[8], 0.0))
    momentum = apply(c.inertia, omega)
    y[STRUCK] += 0.5 * (dot(momentum, omega) + c.mass * dot(v, v))
    x, yy, z = apply(axes, momentum)
    y[IMPULSE] -= x
    y[IMPULSE + 1] -= yy
    y[IMPULSE + 2] -= z
    for n in range(OMEGA, PLACE):
        y[n] = 0.0


@compiled
def pause(p, y):
    """Take the last bits of the rolling from a body that is about to roll back."""
    gamma = matrix(y[0], y[1], y[2], y[3])[2]
    y[4], y[5], y[6] = scaled(dot(gamma, (y[4], y[5], y[6])), gamma)


@compiled
def write(p, y, row, time, x, yy, out):
    """Fill the state vector `out` at a time, and behind it the entries of the ledger.

    Parameters
    ----------
    row : array
        Work space.
    x, yy : float
        Where the centre of mass was at the start of the course, axes of the plane, m.
    """
    rate(p, y, row)
    c = load_contact(p)
    q, omega = (y[0], y[1], y[2], y[3]), (y[4], y[5], y[6])
    gap = y[GAP] if c.mode == FLIGHT else 0.0
    place = x + y[PLACE], yy + y[PLACE + 1], gap - row[LEVER + 2]
    v = row[VELOCITY], row[VELOCITY + 1], row[VELOCITY + 2]
    turn = y[IMPULSE], y[IMPULSE + 1], y[IMPULSE + 2]
    if c.inclined != 0.0:
        q = multiply(*c.plane, *q)
        place, v, turn = rotate(*c.plane, *place), rotate(*c.plane, *v), rotate(*c.plane, *turn)
    q = normalised(*q)
    axes = matrix(*q)
    out[0] = time
    out[1], out[2], out[3], out[4] = q
    out[5], out[6], out[7] = omega
    out[8], out[9], out[10] = minus(place, apply(axes, c.center))
    out[11], out[12], out[13] = minus(v, apply(axes, cross(omega, c.center)))
    if len(out) > 14:
        out[14] = y[WORK]
        out[15] = y[SLID] + y[ROLLED] + y[FILMED] + y[STRUCK] + y[DAMPED] + y[SPUN]
        out[16], out[17], out[18] = turn
    if len(out) > 19:
        out[19], out[20], out[21], out[22] = y[SLID], y[ROLLED], y[FILMED], y[STRUCK]
        out[23] = y[SPUN]


@compiled
def read(p, state, y):
    """Fill the unknowns y of a flight from a state vector; return the centre of mass (plane)."""
    c = load_contact(p)
    q = normalised(state[1], state[2], state[3], state[4])
    omega = state[5], state[6], state[7]
    axes = matrix(*q)
    place = plus((state[8], state[9], state[10]), apply(axes, c.center))
    v = plus((state[11], state[12], state[13]), apply(axes, cross(omega, c.center)))
    if c.inclined != 0.0:
        px, py, pz, pw = c.plane
        q = normalised(*multiply(-px, -py, -pz, pw, *q))
        place, v = rotate_back(*c.plane, *place), rotate_back(*c.plane, *v)
    for n in range(SIZE):
        y[n] = 0.0
    y[0], y[1], y[2], y[3] = q
    y[4], y[5], y[6] = omega
    y[7], y[8], y[9] = v
    turned = matrix(*q)
    r = lever(c, turned[2])
    y[GAP] = place[2] + dot(turned[2], r)
    return place
