# SPDX-License-Identifier: Apache-2.0
"""Template: march by the Taylor series of a scene's own equations (recurrences.py).

A point of the march holds, after its Head (points.py), the unknowns and what their sums lost.
`control` is that of taylor_march.py, and so is the choice of the steps.
"""

import math

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.marching.points import (
    FIXED,
    ORIGIN,
    SCALES,
    STEP,
    TIME,
    TOLERANCE,
    VALUES,
    onward,
)
from rigid_body_sim.integrators.marching.taylor_march import FOR, NEARLY, UNMOVED, WORK, chosen
from rigid_body_sim.integrators.marching.taylor_series import ORDER

prepare = UNBOUND
expand = UNBOUND
along = UNBOUND
settled = UNBOUND
load = UNBOUND
put = UNBOUND
load_scales = UNBOUND
put_scales = UNBOUND
grown = UNBOUND
measured = UNBOUND
added = UNBOUND
SIZE = UNBOUND
BASED = UNBOUND
PLACES = UNBOUND
ROOM = UNBOUND
arrive = None    # final states are like others

FALL = 0.9                 # largest fall of a base within a step, relative to the base
RISE = 3.0                 # and largest change
SHORTER = 0.75             # of a step in which a base falls too far, what is tried next
LEAST = 2.0 ** -25         # the step over the zero of a base, as a share of the planned step
TICKS = 2.0 ** -50         # and, if that is longer, of the time
LOW = 2                    # order of the series of that step


@compiled
def begin(p, control, point):
    """Note the origin of a point whose time and unknowns are set, and its scales."""
    control[ORIGIN], control[FOR] = point[TIME], math.nan
    point[STEP] = 0.0
    prepare(p, control[WORK:])
    y = load(point, int(VALUES))
    put_scales(grown(load_scales(point, SCALES), y, y, 0.0), point, SCALES)


@compiled
def change(S, base, h):
    """Return by how much a base can change within a step, and by how much it can fall, at most.

    Bases are what roots and powers are taken of; S has their integrals after the unknowns.
    """
    changed = fallen = 0.0
    for k in range(ORDER, 1, -1):
        grown = k * S[PLACES * k + base]
        changed, fallen = h * (changed + abs(grown)), h * (fallen + max(-grown, 0.0))
    return changed, fallen


@compiled
def expanded(p, control, y, t, planned):
    """Fill S; return the length of the step where a base is about to pass zero, else 0.

    A series of sqrt(u^2) is u or -u: it does not show that u passes zero, and near that the higher
    coefficients are rounding. The step over it is so short that they do not count; nor does what
    the root is in it. A base that stays 0 is none of these.
    """
    S = control[WORK:]
    expand(p, S, y)
    if control[FIXED] > 0.0:
        return 0.0
    least = max(LEAST * max(planned, UNMOVED), TICKS * abs(t))
    for base in range(SIZE, SIZE + BASED):
        if not change(S, base, least)[0] <= FALL * S[PLACES + base]:
            for place in range(PLACES * (LOW + 1), PLACES * (ORDER + 1)):
                S[place] = 0.0
            return least
    return 0.0


@compiled
def within(S, h, step, last, over):
    """Return a step within which all bases stay positive, h at most, and the plan for the next.

    A base that is a square and rises to four times has a zero as far behind as the step leads
    ahead: farther on the rounding of its coefficients would be magnified, which the series of the
    root times the root hides. Other zeros beside the real line show in the last terms.
    `over` is what `expanded` returned; the plan, `step` or the `last` one, knows nothing of bases.
    """
    chosen_one = h
    if over > 0.0:
        h = min(h, over)
    for base in range(SIZE, SIZE + (BASED if over == 0.0 else 0)):
        while h > 0.0:
            changed, fallen = change(S, base, h)
            if changed <= RISE * S[PLACES + base] and fallen <= FALL * S[PLACES + base]:
                break
            h *= SHORTER
    return h, last if h < chosen_one and last > 0.0 else step


@compiled
def march(p, control, point, following, target, end, limit):
    """Move `point` on until the step from it holds the time `target`, at most `limit` steps.

    Return (steps moved, whether it went well); as ``march`` of taylor_march.py.
    """
    moved = onward(point, following, target)
    if moved < 0:
        return 0, True
    tolerance, fixed, S = control[TOLERANCE], control[FIXED], control[WORK:]
    t, last = point[TIME], point[STEP]
    scales, y, c = load_scales(point, SCALES), load(point, int(VALUES)), load(point, VALUES + SIZE)
    good = True
    while t < end:
        over = expanded(p, control, y, t, last)
        scales1 = grown(scales, y, load(S, int(PLACES)), last if fixed == 0.0 else fixed)
        if fixed > 0.0:
            step = last + 1.0
            t1, h = control[ORIGIN] + step * fixed, fixed
            if t1 + NEARLY * fixed >= end:
                t1, h = end, end - t
        else:
            final, before = measured(S, int(ORDER), scales1), measured(S, ORDER - 1, scales1)
            h, step = within(S, *chosen(final, before, tolerance, last), last, over)
            t1 = end if t + 1.1 * h >= end else t + h
            h = t1 - t
        y1, c1, size = added(y, c, along(S, (h,)))
        good = t1 > t and size < math.inf
        y1, c1 = settled(y1, c1)
        if not good or target < t1 or moved == limit:
            following[TIME] = t1 if good else t    # t: none follows
            following[STEP] = step
            put_scales(scales1, following, SCALES)
            put(y1, following, int(VALUES))
            put(c1, following, VALUES + SIZE)
            control[FOR] = t
            break
        t, last, y, c, scales = t1, step, y1, c1, scales1
        moved += 1
    point[TIME], point[STEP] = t, last
    put_scales(scales, point, SCALES)
    put(y, point, int(VALUES))
    put(c, point, VALUES + SIZE)
    return moved, good


@compiled
def between(p, control, point, following, dt):
    """Return the unknowns a time dt after a point, within the step from it, by its series."""
    y = load(point, int(VALUES))
    if not dt > 0.0:
        return y
    S = control[WORK:]
    if control[FOR] != point[TIME]:
        expanded(p, control, y, point[TIME], point[STEP])
        control[FOR] = point[TIME]
    y, _, _ = added(y, load(point, VALUES + SIZE), along(S, (dt,)))
    return y
