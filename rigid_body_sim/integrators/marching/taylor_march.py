# SPDX-License-Identifier: Apache-2.0
"""Template: march by Taylor series (taylor.py).

A point of the march holds, after its Head (points.py), the unknowns and what their sums lost; of
the scales there is one, the squared scale of omega. `control` holds, after its Control, in FOR
the time of the point whose series follow, and from WORK on their coefficients, order by order.

A step h should make the larger of its last two terms, c, what the tolerance allows in that time: c
h^ORDER = tolerance h. What c says at one point is the plan for the next one: so a step is known
while its coefficients are still being made, and nothing waits for the last of them. Where c says
at the point itself that the plan is not nearly right, the step is chosen anew.
"""

import math

from rigid_body_sim.compilation.jit import compiled, inlined
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.equations.euler import OMEGA, lost_norm
from rigid_body_sim.integrators.marching.points import (
    CONTROL,
    FIXED,
    LOST,
    ORIGIN,
    PAUSED,
    REACHED,
    SCALES,
    STEP,
    TIME,
    TOLERANCE,
    VALUES,
    onward,
)
from rigid_body_sim.integrators.marching.taylor_series import ORDER, TURNING, Turning, along
from rigid_body_sim.numerics.functions import power
from rigid_body_sim.numerics.rotations import rotate_back  # noqa: F401 (for the bound source)
from rigid_body_sim.numerics.vectors import dot, minus, plus

expand = UNBOUND

SIZE = TURNING.size
SCALE = SCALES    # there is one, that of omega
load, store, load_omega = TURNING.load, TURNING.store, TURNING.part('omega').load
FOR = CONTROL.size    # places in `control`
WORK = FOR + 1
PLACES = 8               # places for the coefficients of an order
ROOM = PLACES * (ORDER + 1)
NEARLY = 1e-9            # share of a fixed step: an end that close to a point is that point
GROWTH = 4.0             # largest factor by which a step grows
UNMOVED = 1e-3           # s, the first step where nothing moves
NOTHING = 1e-300         # (rad/s)^2, of a body that neither turns nor is turned
# a plan is taken if the square of the last terms is what is allowed but for this factor
NEAR = 16.0
# the step is longer by one factor where the squares of the last terms are too small by the other
BY, CLEARLY = 1.04, 4.0
ROOT = 0.5 / (ORDER - 2)
PART = 0.6 * ROOT        # exponent: the next plan follows the step that a point asks for in part
# coefficients of Pade's approximation to x^PART near 1
UPPER, MIDDLE, LOWER = (
    (1.0 + PART) * (2.0 + PART),
    2.0 * (4.0 - PART * PART),
    (1.0 - PART) * (2.0 - PART),
)


@compiled
def begin(p, control, point):
    """Note the origin of a point whose time and unknowns are set, and the scale."""
    control[ORIGIN], control[FOR] = point[TIME], math.nan
    point[STEP] = 0.0
    omega = load_omega(point, int(VALUES))
    point[SCALE] = dot(omega, omega)


@inlined
def _turning(flat):
    """Return a tuple of seven floats as what it is."""
    return Turning(flat[:OMEGA], flat[OMEGA:])


@inlined
def _sum(y, d):
    """Return y + d."""
    (qx, qy, qz, qw), (dx, dy, dz, dw) = y.q, d.q
    return Turning((qx + dx, qy + dy, qz + dz, qw + dw), plus(y.omega, d.omega))


@inlined
def _lost(y, d, y1):
    """Return d - (y1 - y), what y1 = y + d has lost of d."""
    (dx, dy, dz, dw), (qx, qy, qz, qw), (sx, sy, sz, sw) = d.q, y.q, y1.q
    return Turning((dx - (sx - qx), dy - (sy - qy), dz - (sz - qz), dw - (sw - qw)),
                   minus(d.omega, minus(y1.omega, y.omega)))


@inlined
def _completed(d, y, c):
    """Return the change d of y in a step, with what the sums before had lost, c.

    q is also stretched by what it lacked at the beginning of the step, which is known before its
    end is.
    """
    (dx, dy, dz, dw), (qx, qy, qz, qw), (cx, cy, cz, cw) = d.q, y.q, c.q
    lacks = lost_norm(qx, qy, qz, qw) - (qx * cx + qy * cy + qz * cz + qw * cw)
    return Turning((dx + (cx + lacks * (qx + dx)), dy + (cy + lacks * (qy + dy)),
                    dz + (cz + lacks * (qz + dz)), dw + (cw + lacks * (qw + dw))),
                   plus(d.omega, c.omega))


@inlined
def _is_finite(y):
    """Return whether unknowns are; of q, which has the norm 1, one component tells."""
    x = y.q[0]
    return x * x + dot(y.omega, y.omega) < math.inf


@compiled
def _square(S, order, weight):
    """Return the squared norm of the coefficients of an order; those of omega have a weight."""
    (x, y, z, w), omega = load(S, PLACES * order)
    return (x * x + y * y) + (z * z + w * w) + weight * dot(omega, omega)


@compiled
def chosen(final, before, tolerance, planned):
    """Return (the step from here, the plan for the next point).

    A step is GROWTH times the plan at most.

    Parameters
    ----------
    final, before : float
        Squared norms of the last two coefficients. Of their terms the lower one counts as it
        would at the step that is planned.
    tolerance : float
        For a second.
    planned : float
        s; 0 of the first step.
    """
    allowed = tolerance * tolerance
    if planned == 0.0:    # the first step: by the last term alone
        if final == 0.0:
            return UNMOVED, UNMOVED
        planned = power(allowed / final, 0.5 / (ORDER - 1))
    second = planned * planned
    fourth = second * second
    eighth = fourth * fourth
    square = max(final * second, before)
    reached = square * (fourth * eighth * (eighth * eighth))
    if allowed < NEAR * reached and reached < NEAR * allowed:
        a, b, c = allowed * allowed, allowed * reached, reached * reached
        return planned, planned * (
            (UPPER * a + MIDDLE * b + LOWER * c) / (LOWER * a + MIDDLE * b + UPPER * c)
        )
    h = GROWTH * planned
    if square != 0.0:
        h = min(h, power(allowed / square, ROOT))
    return h, h


@compiled
def _last_terms(S, scale):
    """Return the squared norms of the last two coefficients, of all unknowns."""
    weight = 1.0 / scale if scale > NOTHING else 0.0
    return _square(S, int(ORDER), weight), _square(S, ORDER - 1, weight)


@inlined
def _rescaled(scale, y, S):
    """Return the squared scale of omega with what is met at a point, whose series are in S.

    A body that hardly turns yet is measured by the rate that omega' gives it.
    """
    omega_rate = load_omega(S, int(PLACES))
    return max(scale, dot(y.omega, y.omega), math.sqrt(dot(omega_rate, omega_rate)))


@compiled
def march(p, control, point, following, target, end, limit):
    """Move `point` on until the step from it holds the time `target`, at most `limit` steps.

    Return (steps moved, whether it went well).

    The step from `point` ends at `following`, which is not known yet if its time is not later.
    Both are changed. The last point stands at `end` exactly. More than forty lines: the order of
    the lines hides the latency of the coefficients, so the step is written out in one place.
    """
    moved = onward(point, following, target)
    if moved < 0:
        return 0, True
    tolerance, fixed, S = control[TOLERANCE], control[FIXED], control[WORK:]
    t, last, scale = point[TIME], point[STEP], point[SCALE]
    y, c = load(point, int(VALUES)), load(point, VALUES + SIZE)
    good = True
    while t < end:
        expand(p, S, (*y.q, *y.omega))
        scale1 = _rescaled(scale, y, S)
        if fixed > 0.0:
            step = last + 1.0
            t1, h = control[ORIGIN] + step * fixed, fixed
            if t1 + NEARLY * fixed >= end:
                t1, h = end, end - t
        else:
            final, before = _last_terms(S, scale1)
            h, step = chosen(final, before, tolerance, last)
            t1 = end if t + 1.1 * h >= end else t + h
            h = t1 - t
        d = _completed(_turning(along(S, (h,))), y, c)
        y1 = _sum(y, d)
        c1 = _lost(y, d, y1)
        good = t1 > t and _is_finite(y1)
        if not good or target < t1 or moved == limit:
            following[TIME] = t1 if good else t    # t: none follows
            following[STEP], following[SCALE] = step, scale1
            store(following, y1, int(VALUES))
            store(following, c1, VALUES + SIZE)
            control[FOR] = t
            break
        t, last, y, c, scale = t1, step, y1, c1, scale1
        moved += 1
    point[TIME], point[STEP], point[SCALE] = t, last, scale
    store(point, y, int(VALUES))
    store(point, c, VALUES + SIZE)
    return moved, good


@compiled
def between(p, control, point, following, dt):
    """Return the unknowns a time dt after a point, within the step from it, by its series."""
    y, S = load(point, int(VALUES)), control[WORK:]
    if dt > 0.0 and control[FOR] != point[TIME]:
        expand(p, S, (*y.q, *y.omega))
        control[FOR] = point[TIME]
    return _after(S, y, dt)


@compiled
def arrive(p, control, point, target, limit):
    """Return (how a march without points to a time ended, the unknowns then).

    It has the bits of `march` and `between`. Time and unknowns of the start, a point that is not
    later, are set. At most `limit` steps are made.
    """
    tolerance, S = control[TOLERANCE], control[WORK:]
    t, y, last = point[TIME], load(point, int(VALUES)), 0.0
    c, scale = Turning((0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0)), dot(y.omega, y.omega)
    for _ in range(limit):
        expand(p, S, (*y.q, *y.omega))
        scale = _rescaled(scale, y, S)
        final, before = _last_terms(S, scale)
        dt = target - t
        if not (t + BY * dt > target and _leads_beyond(final, before, tolerance, last, dt)):
            h, step = chosen(final, before, tolerance, last)
            t1 = t + h
            d = _completed(_turning(along(S, (t1 - t,))), y, c)
            y1 = _sum(y, d)
            if not t1 > t:    # so it is, too, where coefficients are not finite
                return LOST, (*y.q, *y.omega)
            if t1 <= target:
                t, last, y, c = t1, step, y1, _lost(y, d, y1)
                continue
        return REACHED, _after(S, y, dt)
    return PAUSED, (*y.q, *y.omega)


@compiled
def _leads_beyond(final, before, tolerance, planned, dt):
    """Return whether `chosen` gives a step longer than BY times dt; False where that is not clear.

    It takes no root.
    """
    if 0.0 < planned < BY * dt:
        return False
    longest = max(planned, dt)    # a first plan follows from the final term
    second = dt * dt
    fourth = second * second
    eighth = fourth * fourth
    square = max(final * (longest * longest), before)
    reached = square * (fourth * eighth * (eighth * eighth))
    return final > NOTHING and CLEARLY * reached < tolerance * tolerance


@inlined
def _after(S, y, dt):
    """Return the unknowns a time dt after those whose series are in S."""
    if dt > 0.0:
        y = _sum(y, _turning(along(S, (dt,))))
    return (*y.q, *y.omega)
