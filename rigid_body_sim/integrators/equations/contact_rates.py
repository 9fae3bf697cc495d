# SPDX-License-Identifier: Apache-2.0
"""Template: the equations of a convex body on a plane, in each of its phases.

It is bound to what acts besides the contact (contact_acting.py) and to the slip of a patch that
pivots (contact_pivoting.py). Symbols: mechanics/contact/laws.py; the forces are in
mechanics/contact/forces.py, the views in contact_views.py. All vectors but omega are along the
axes of the plane.

    FLIGHT    no contact: x'' = F/m
    SLIDING   u != 0 (with a patch of contact: or a spin about the normal): f = N (n - mu u/|u|).
              As u vanishes its direction may turn ever faster, so time is an unknown and the
              independent variable is s with dt = |u| ds (|u| with the spin of a patch):
              everything is smooth in s, and |u| dies like an exponential
    ROLLING   u = 0: f = -G^-1 b, as long as |F_t| <= mu N. With a patch of contact nothing spins
              about the normal, either, and its couple over rho is the third component of F_t
    GLIDING   no friction (mu = 0)
    RESTING   nothing moves any more
    CREEPING  slip that has just begun, along the direction for which u' is parallel to u; its lag
              behind that direction is corrected to the first order in |u| |omega|/(mu g). It
              ends, as a SLIDING, where it is fast or lags far
    PIVOTING  a SLIDING of a patch so small that u relaxes in no time. It ends where the spin
              does, or, as a SLIDING, where u lags behind that of a balance by more than the
              accuracy lets it, or where a ring lies low

In each phase of contact dry rolling friction may hold the lowest point where it is on the body
(p.way): a couple without power keeps it there, as long as its force is at most C N. Such a body
spins about the normal, and slides. A disk falls, too, since its lowest point moves along the rim
only.

The height of the centre of mass is the gap less n . r, and in contact its velocity is u - omega x
r: gap and normal velocity are zero to the last bit there, and small gaps are as exact as large
ones.
"""

import math
from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.compilation.layout import Vector
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.equations.contact_views import (
    CREEPING,
    FLIGHT,
    PIVOTING,
    RESTING,
    ROLLING,
    ROW,
    SLIDING,
    UNKNOWNS,
    Ledger,
    Row,
    Unknowns,
    Watched,
)
from rigid_body_sim.mechanics.contact.forces import (
    Push,
    held,
    leaving,
    patch_of,
    posture,
    rolling_force,
    slipping_force,
    system_of,
    torque_of,
    wrung_by,
)
from rigid_body_sim.mechanics.contact.holding import (
    along_way,
    burden,
    gripping,
    holds_still,
    tips,
    way_at,
)
from rigid_body_sim.mechanics.contact.laws import MOST_LAG, departure, slipping, sticking, turning
from rigid_body_sim.mechanics.contact.parameters import CONTACT, HELD, LOW, SLOW
from rigid_body_sim.mechanics.contact.patch import (
    patch_departure,
    patch_lagging,
    patch_slipping,
    patch_sticking,
)
from rigid_body_sim.mechanics.contact.touch import (
    above_flat,
    gap_of,
    inclination,
    is_disk,
    tangent,
)
from rigid_body_sim.numerics.functions import hypot
from rigid_body_sim.numerics.rotations import multiply
from rigid_body_sim.numerics.vectors import apply, cross, dot, minus, plus, scaled
from rigid_body_sim.scene.surfaces import TORUS

applied_at = UNBOUND       # contact_acting.py
posture_at = UNBOUND
couples_at = UNBOUND
hastened = UNBOUND
posture_after = UNBOUND
push_on = UNBOUND
pivot = UNBOUND            # contact_pivoting.py
# a line HOLDS = True for a scene with dry rolling friction, else HOLDS = False
HOLDS = UNBOUND
# a line PATCHED = True for a scene with a patch of contact, else PATCHED = False
PATCHED = UNBOUND

ROUNDING = 2.0 ** -50    # of a normal velocity, relative to the speeds
SLID = 1e-3              # share of the radius: a shorter slide is part of coming to rest
LAGS = 1e4               # rad: lag with which a creep ends, over its share of the speeds then
SHORT = 1e-6             # time of a difference, over the time in which the body moves by its size
ZERO = (0.0, 0.0, 0.0)

load_contact, load_unknowns, store_row = CONTACT.load, UNKNOWNS.load, ROW.store
RATES = ROW.part('rates').size


class Contact(NamedTuple):
    """The contact as a phase has it.

    Attributes
    ----------
    f : Vector
        The force on the body, N.
    push : Push
        All else.
    growth : Vector
        The rate of the unknown u, m/s^2.
    slip, v : Vector
        Velocities of the lowest point and of the centre of mass, m/s.
    normal, grip, firmness : float
        Watched.
    speed, film : float
        Of the lowest point over the surface (m/s), and the coefficient of the film of air (N s/m).
    slid, spun : float
        Heat of the slip and of the spin of a patch, W.
    pace : float
        Speed of the slip, m/s.
    """

    f: Vector
    push: Push
    growth: Vector
    slip: Vector
    v: Vector
    normal: float
    grip: float
    firmness: float
    speed: float
    film: float
    slid: float
    spun: float
    pace: float


@compiled_inline
def _short(c):
    """Return the time step of a finite difference, s."""
    return SHORT * c.size[0] / c.swift


@compiled
def _ahead(p, c, now, at, f, touch):
    """Return Posture and Push after the time of a difference; the arguments: `posture_after`."""
    short = _short(c)
    later = posture_after(p, c, now, at, f, touch, ZERO, 0.0, short)
    return later, push_on(p, c, now, later, ZERO, short)


@compiled
def _lagging(p, c, now, at, push, slow):
    """Return the direction of a creep |u|, and by how much (rad) it lags behind d, which turns.

    With the angle phi of u, |u| phi' is the part of u' across u. Where d turns at the rate phi', u
    stands off d by |u| phi' over the slope of that part. phi' is a finite difference.

    Parameters
    ----------
    slow : float
        |u|, m/s.
    """
    system = system_of(c, at, push)
    dx, dy = leaving(system, c.mu)
    _, _, N, _ = slipping(system, c.mu, dx, dy)
    f = -c.mu * N * dx, -c.mu * N * dy, N
    later, pushed = _ahead(p, c, now, at, f, plus(push.viscous, scaled(N, push.wrung)))
    ex, ey, _ = departure(system_of(c, later, pushed), c.mu, dx, dy)
    _, _, slope, _ = turning(system, c.mu, dx, dy)
    if not slope < 0.0:
        return dx, dy, 0.0
    lag = slow * (dx * ey - dy * ex) / (_short(c) * slope)
    off = max(-MOST_LAG, min(MOST_LAG, lag))
    size = hypot(1.0, off)
    return (dx - off * dy) / size, (dy + off * dx) / size, abs(lag)


@compiled
def _parting(p, c, now, at, push, slow):
    """Return the direction of a creep |w| of a patch that has begun to slip, and its lag (rad).

    It lags behind the direction along which the slip begins, as in `_lagging`.
    """
    patch = patch_of(c, at, push)
    friction, _ = patch_sticking(patch)
    size = math.sqrt(dot(friction, friction))
    guess = scaled(-1.0 / size, friction) if size > 0.0 else (1.0, 0.0, 0.0)
    d, _ = patch_departure(patch, c.mu, guess)
    _, N, _ = patch_slipping(patch, c.mu, d)
    f = -c.mu * N * d[0], -c.mu * N * d[1], N
    twist = scaled(-c.mu * N * c.patch * d[2], at.axes[2])
    later, pushed = _ahead(p, c, now, at, f,
                           plus(plus(push.viscous, scaled(N, push.wrung)), twist))
    ahead, _ = patch_departure(patch_of(c, later, pushed), c.mu, d)
    return patch_lagging(patch, c.mu, d, scaled(slow / _short(c), minus(ahead, d)))


@compiled_inline
def _shared(c, heat, dx, dy):
    """Return the heat of friction by its cause: of the slip, and of the spin of a patch."""
    if c.patch > 0.0:
        slid = heat * (dx * dx + dy * dy)
        return slid, heat - slid
    return heat, 0.0


@compiled_inline
def _in_flight(c, now, at, push):
    """Return the Contact of a FLIGHT: none."""
    # a gap that shrinks no faster than rounding is that of a body that has just lifted off
    shrinks = now.u[2] + dot(at.axes[2], at.carried) < -ROUNDING * c.swift
    gap = gap_of(c, now.gap, at.axes[2])
    normal = gap if shrinks else max(gap, 0.0)
    return Contact(ZERO, push, scaled(1.0 / c.mass, push.force),
                   (now.u[0], now.u[1], 0.0), now.u, normal, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)


@compiled_inline
def _rolling(c, at, push, v, speed, film):
    """Return the Contact of a body that is ROLLING."""
    grip = 1.0
    if c.patch > 0.0:
        f, twist, grip = held(c, at, push)
        couple = scaled(twist, at.axes[2])
        push = Push(push.force, plus(push.torque, couple), plus(push.viscous, couple), push.wrung)
    elif c.rolling > 0.0:
        f = sticking(system_of(c, at, push))
    else:
        f = rolling_force(c, at, push)
    if c.patch == 0.0 and c.mu < 1e300:
        grip = c.mu * f[2] - hypot(f[0], f[1])
    return Contact(f, push, ZERO, ZERO, v, f[2], grip, 1.0, speed, film, 0.0, 0.0, 1.0)


@compiled_inline
def _pressing(N, A):
    """Return the watched N of a slip: where A < 0 it is the paradox that turns its sign.

    N grows without bound as A falls to 0, and only what lifts off leads it through 0.
    """
    return N if A >= 0.0 else -N


@compiled_inline
def _slipping(c, now, at, push, v, speed, film):
    """Return the Contact of a body that is GLIDING or SLIDING."""
    dx, dy, mu, pace = 1.0, 0.0, 0.0, 1.0
    if c.mode == SLIDING:
        pace, mu = hypot(now.u[0], now.u[1]), c.mu
        if c.patch > 0.0:
            spin = c.patch * dot(at.axes[2], at.omega)
            pace = hypot(pace, spin)
            if pace > 0.0:
                push = wrung_by(push, minus(push.wrung, scaled(mu * c.patch * spin / pace,
                                                               at.axes[2])))
        if pace > 0.0:
            dx, dy = now.u[0] / pace, now.u[1] / pace
    f, growth, A = slipping_force(c, at, push, mu, dx, dy)
    slid, spun = _shared(c, mu * f[2] * pace, dx, dy)
    return Contact(f, push, growth, (now.u[0], now.u[1], 0.0), v, _pressing(f[2], A), 1.0,
                   A * c.mass, speed, film, slid, spun, pace)


@compiled
def _pivoting(p, c, now, at, push, v, speed, film):
    """Return the Contact of a patch that is PIVOTING."""
    slip, spin = (now.u[0], now.u[1], 0.0), c.patch * dot(at.axes[2], at.omega)
    goes, lag = pivot(p, c, now, at, push)
    couple = scaled(c.patch * goes.friction[2], at.axes[2])
    push = Push(push.force, plus(push.torque, couple), plus(push.viscous, couple), push.wrung)
    return Contact(goes.f, push, goes.growth, slip, v, goes.f[2],
                   min(c.side * spin, c.lag - lag), 1.0, speed, film, -dot(goes.friction, slip),
                   -goes.friction[2] * spin, 1.0)


@compiled_inline
def _creeping(p, c, now, at, push, v, speed, film):
    """Return the Contact of a body that is CREEPING, at the speed u[0]."""
    slow = now.u[0]
    if c.patch > 0.0:
        d, lag = _parting(p, c, now, at, push, slow)
        slipped, N, A = patch_slipping(patch_of(c, at, push), c.mu, d)
        growth = dot(d, slipped)
        push = wrung_by(push, minus(push.wrung, scaled(c.mu * c.patch * d[2], at.axes[2])))
    else:
        system = system_of(c, at, push)
        dx, dy, lag = _lagging(p, c, now, at, push, slow)
        growth = turning(system, c.mu, dx, dy)[0]
        _, _, N, A = slipping(system, c.mu, dx, dy)
        d = dx, dy, 0.0
    slid, spun = _shared(c, c.mu * N * slow, d[0], d[1])
    slip = slow * d[0], slow * d[1], 0.0
    # it becomes a slip, or it dies again
    grip = c.creep - max(slow, lag * c.swift / LAGS) if slow >= 0.0 else slow
    return Contact((-c.mu * N * d[0], -c.mu * N * d[1], N), push, (growth, 0.0, 0.0), slip,
                   plus(v, slip), _pressing(N, A), grip, A * c.mass, speed, film, slid, spun, 1.0)


@compiled_inline
def _motion(c, at, speed, along):
    """Return how far a body in contact is from lying flat, or from standing still (watched).

    A rolling that has just begun stands still where it goes back. A torus that tips up from lying
    flat may come down again before it is inclined by more.
    """
    flat = above_flat(c, at.axes[2])
    if HOLDS and c.rim > 0.0:
        goes = c.way[0] * tips(c, at) + SLOW * c.swift
        return goes if c.way[0] * at.axes[2][2] < 0.0 else min(flat, goes)
    if HOLDS and c.way != HELD and not is_disk(c):
        return min(flat, along + SLOW * c.swift if c.onset > 0.0 else speed - SLOW * c.swift)
    return flat


@compiled_inline
def _centre(c, now, at):
    """Return the velocity of the centre of mass; of a creep, what it would be without slip."""
    if c.mode == FLIGHT:
        return now.u
    if c.mode in (ROLLING, CREEPING):
        return minus(ZERO, apply(at.axes, at.carried))
    return minus((now.u[0], now.u[1], 0.0), apply(at.axes, at.carried))


@compiled_inline
def _resting(p, c, now, at):
    """Return the Row of a body that rests: the contact balances what else acts."""
    acts = applied_at(p, c, now, at, at.omega, _centre(c, now, at), 0.0)
    # the plane holds body and rotors: it takes what a motor gives to its rotor
    held_back = scaled(-1.0, apply(at.axes, acts.inner))
    nothing = Ledger(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, held_back, 0.0)
    still = Unknowns((0.0, 0.0, 0.0, 0.0), ZERO, ZERO, (0.0, 0.0), 0.0, 1.0, nothing)
    return Row(still, Watched(1.0, 1.0, 1.0, c.until - now.time, 1.0, 1.0),
               scaled(-1.0, acts.force), ZERO, (0.0, 0.0), ZERO, apply(at.axes, at.r), 1.0)


@compiled_inline
def _gripped(c, at, torque, grown, N):
    """Return the couple by which friction holds the rolling, and the watched number for it."""
    if HOLDS and c.way == HELD:
        couple, force = gripping(c, at, torque, grown)
        return couple, c.rolling * N * (1.0 + c.slack) - hypot(*force)
    if HOLDS and c.rim > 0.0:
        couple, (along, _) = gripping(c, at, torque, grown)
        return couple, c.rim * c.rolling * N - abs(along) * inclination(at.axes[2])
    if HOLDS and is_disk(c):
        return ZERO, c.way[0] * dot(tangent(at.axes[2]), at.moved)
    if HOLDS and c.onset > 0.0:
        return ZERO, c.onset - math.sqrt(dot(at.moved, at.moved))
    return ZERO, 1.0


@compiled
def rate(p, y, k):
    """Fill a row k with the rates of the unknowns y.

    More than forty lines: a function between this one and those of the phases would compile them
    once more, half a second.
    """
    c, now = load_contact(p), load_unknowns(y)
    at = posture_at(c, now.q, now.omega)
    e3 = at.axes[2]
    if c.mode == RESTING:
        store_row(k, _resting(p, c, now, at))
        return
    v = _centre(c, now, at)
    F, T, work, heat, inner = applied_at(p, c, now, at, at.omega, v, 0.0)
    torque = minus(T, cross(at.omega, apply(c.uneven, at.omega)))
    gap, motion, rolling, along = 0.0, 1.0, 1.0, 0.0
    if c.mode == FLIGHT:
        contact = _in_flight(c, now, at, Push(F, torque, ZERO, ZERO))
        gap = v[2] + dot(e3, cross(at.omega, c.middle) if c.level > 0.0 else at.carried)
        motion = 1.0 if c.level > 0.0 else above_flat(c, e3)
    else:
        viscous, wrung, speed, film = couples_at(c, at, now.time)
        push = Push(F, plus(torque, viscous), viscous, wrung)
        if c.mode == ROLLING:
            contact = _rolling(c, at, push, v, speed, film)
        elif c.mode == CREEPING:
            contact = _creeping(p, c, now, at, push, v, speed, film)
        elif PATCHED and c.mode == PIVOTING:
            contact = _pivoting(p, c, now, at, push, v, speed, film)
        else:
            contact = _slipping(c, now, at, push, v, speed, film)
        along = along_way(c, at, way_at(c, now.time), speed) if HOLDS else speed
        motion = _motion(c, at, speed, along)
        torque = plus(contact.push.torque,
                      plus(torque_of(at, contact.f), scaled(contact.f[2], contact.push.wrung)))
    grown = hastened(c, at, torque)
    touch = plus(contact.push.viscous, scaled(contact.f[2], contact.push.wrung))
    if HOLDS and c.mode != FLIGHT:
        holds, rolling = _gripped(c, at, torque, grown, contact.f[2])
        touch = plus(touch, holds)
    turn = apply(at.axes, plus(plus(torque_of(at, contact.f), touch), minus(T, inner)))
    rolled = (c.rolling_viscous * contact.speed * contact.speed
              + c.rolling * contact.f[2] * along)
    entries = Ledger(contact.slid, rolled, contact.film * contact.speed * contact.speed, 0.0,
                        heat, work, turn, contact.spun)
    x, yy, z, w = multiply(*at.q, *at.omega, 0.0)
    rates = Unknowns((0.5 * x, 0.5 * yy, 0.5 * z, 0.5 * w), grown, contact.growth,
                     (contact.v[0], contact.v[1]), gap, 1.0, entries)
    watched = Watched(contact.normal, contact.grip, contact.firmness, c.until - now.time, motion,
                      rolling)
    store_row(k, Row(rates, watched, contact.f, apply(at.axes, touch),
                     (contact.slip[0], contact.slip[1]), contact.v, apply(at.axes, at.r),
                     contact.pace))
    if c.mode == SLIDING:
        for place in range(RATES):
            k[place] *= contact.pace


@compiled_inline
def _still(p, y):
    """Return parameters, unknowns and Posture of a body, and what acts on it where it is still."""
    c, now = load_contact(p), load_unknowns(y)
    at = posture(c, now.q, now.omega)
    return c, now, at, applied_at(p, c, now, at, ZERO, ZERO, 0.0)


@compiled
def stays(p, y):
    """Return whether a body that has almost stopped is at rest (mechanics/contact/forces.py)."""
    c, _, at, acts = _still(p, y)
    return holds_still(c, at, acts.force, acts.couple)


@compiled
def load_of(p, y):
    """Return the Burden (mechanics/contact/holding.py) of a ring that lies flat and rests."""
    c, _, at, acts = _still(p, y)
    return burden(c, at, acts.force, acts.couple)


@compiled
def slides_on(p, y):
    """Return whether a body that has come to lie flat, a disk or a torus, goes on sliding there.

    Friction stops one that does not within SLID of its radius, where the plane holds it at all.
    """
    c, now, at, acts = _still(p, y)
    if c.kind != TORUS or inclination(at.axes[2]) > LOW:
        return False
    held = scaled(-1.0, acts.force)
    v, radius = _centre(c, now, at), c.size[0]
    speed = hypot(v[0], v[1]) + abs(dot(at.axes[2], now.omega)) * radius
    braking = c.mu * held[2] - hypot(held[0], held[1])
    return not c.mass * speed * speed <= 2.0 * SLID * radius * braking
