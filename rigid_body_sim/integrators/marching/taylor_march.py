# SPDX-License-Identifier: Apache-2.0
"""Template: march by Taylor series (taylor.py).

A point of the march holds [time, step planned from here or number of the point, squared scale of
omega, 0, 0, unknowns, what their sums lost]. `control` holds [tolerance per second, fixed step or
0, origin, time of the point whose series stand behind] and from WORK on the coefficients, order by
order.

A step h should make the larger of its last two terms, c, what the tolerance allows in that time: c
h^ORDER = tolerance h. What c says at one point is the plan for the next one: so a step is known
while its coefficients are still being made, and nothing waits for the last of them. Where c says
at the point itself that the plan is not nearly right, the step is chosen anew.
"""

import math

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.equations.euler import lost_norm
from rigid_body_sim.integrators.marching.points import SCALES, STEP, TIME, VALUES, onward
from rigid_body_sim.integrators.marching.taylor_series import ORDER, along
from rigid_body_sim.integrators.marching.taylor_series import UNKNOWNS as SIZE
from rigid_body_sim.numerics.functions import power
from rigid_body_sim.numerics.rotations import rotate_back  # noqa: F401 (for the bound source)

expand = UNBOUND

SCALE = SCALES    # there is one, that of omega
TOLERANCE, FIXED, ORIGIN, FOR, WORK = 0, 1, 2, 3, 4
PLACES = 8               # of an order's coefficients
NEARLY = 1e-9            # of a fixed step: an end that close to a point is that point
GROWTH = 4.0             # of a step, at most
UNMOVED = 1e-3           # s, the first step where nothing moves
NOTHING = 1e-300         # (rad/s)^2, of a body that neither turns nor is turned
# a plan is taken if the square of the last terms is what is allowed but for this factor
NEAR = 16.0
ROOT = 0.5 / (ORDER - 2)
PART = 0.6 * ROOT        # of what a point says about the step, the next plan follows part
# of the approximation (Pade's) to x^PART near 1
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
    point[SCALE] = (
        point[VALUES + 4] * point[VALUES + 4]
        + point[VALUES + 5] * point[VALUES + 5]
        + point[VALUES + 6] * point[VALUES + 6]
    )


@compiled
def load(array, at):
    """Return the unknowns, or what their sums lost."""
    return (
        array[at],
        array[at + 1],
        array[at + 2],
        array[at + 3],
        array[at + 4],
        array[at + 5],
        array[at + 6],
    )


@compiled
def put(values, array, at):
    """Write what `load` reads."""
    array[at], array[at + 1], array[at + 2], array[at + 3] = (
        values[0],
        values[1],
        values[2],
        values[3],
    )
    array[at + 4], array[at + 5], array[at + 6] = values[4], values[5], values[6]


@compiled
def _square(S, order, weight):
    """Return the squared norm of the coefficients of an order.

    Those of omega count by a weight.
    """
    a = PLACES * order
    return (
        (S[a] * S[a] + S[a + 1] * S[a + 1])
        + (S[a + 2] * S[a + 2] + S[a + 3] * S[a + 3])
        + weight * (S[a + 4] * S[a + 4] + S[a + 5] * S[a + 5] + S[a + 6] * S[a + 6])
    )


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
def _step(S, tolerance, planned, scale):
    """Return what `chosen` does for the coefficients of all unknowns."""
    weight = 1.0 / scale if scale > NOTHING else 0.0
    final, before = _square(S, ORDER, weight), _square(S, ORDER - 1, weight)
    return chosen(final, before, tolerance, planned)


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
    y, c = load(point, VALUES), load(point, VALUES + SIZE)
    good = True
    while t < end:
        expand(p, S, y)
        # a body that hardly turns yet is measured by the rate that omega' gives it
        pull = math.sqrt(
            S[PLACES + 4] * S[PLACES + 4]
            + S[PLACES + 5] * S[PLACES + 5]
            + S[PLACES + 6] * S[PLACES + 6]
        )
        scale1 = max(scale, y[4] * y[4] + y[5] * y[5] + y[6] * y[6], pull)
        if fixed > 0.0:
            step = last + 1.0
            t1, h = control[ORIGIN] + step * fixed, fixed
            if t1 + NEARLY * fixed >= end:
                t1, h = end, end - t
        else:
            h, step = _step(S, tolerance, last, scale1)
            t1 = end if t + 1.1 * h >= end else t + h
            h = t1 - t
        d = along(S, (h,))
        # q is stretched by what it lacked at the beginning of the step, which is known before its
        # end is
        lost = lost_norm(y[0], y[1], y[2], y[3]) - (
            y[0] * c[0] + y[1] * c[1] + y[2] * c[2] + y[3] * c[3]
        )
        d = (
            d[0] + (c[0] + lost * (y[0] + d[0])),
            d[1] + (c[1] + lost * (y[1] + d[1])),
            d[2] + (c[2] + lost * (y[2] + d[2])),
            d[3] + (c[3] + lost * (y[3] + d[3])),
            d[4] + c[4],
            d[5] + c[5],
            d[6] + c[6],
        )
        y1 = (
            y[0] + d[0],
            y[1] + d[1],
            y[2] + d[2],
            y[3] + d[3],
            y[4] + d[4],
            y[5] + d[5],
            y[6] + d[6],
        )
        c1 = (
            d[0] - (y1[0] - y[0]),
            d[1] - (y1[1] - y[1]),
            d[2] - (y1[2] - y[2]),
            d[3] - (y1[3] - y[3]),
            d[4] - (y1[4] - y[4]),
            d[5] - (y1[5] - y[5]),
            d[6] - (y1[6] - y[6]),
        )
        good = t1 > t and y1[0] * y1[0] + y1[4] * y1[4] + y1[5] * y1[5] + y1[6] * y1[6] < math.inf
        if not good or target < t1 or moved == limit:
            following[TIME] = t1 if good else t    # t: none follows
            following[STEP], following[SCALE] = step, scale1
            put(y1, following, VALUES)
            put(c1, following, VALUES + SIZE)
            control[FOR] = t
            break
        t, last, y, c, scale = t1, step, y1, c1, scale1
        moved += 1
    point[TIME], point[STEP], point[SCALE] = t, last, scale
    put(y, point, VALUES)
    put(c, point, VALUES + SIZE)
    return moved, good


@compiled
def between(p, control, point, following, dt):
    """Return the unknowns a time dt after a point, within the step from it.

    By the series at the point.
    """
    y = load(point, VALUES)
    if not dt > 0.0:
        return y
    S = control[WORK:]
    if control[FOR] != point[TIME]:
        expand(p, S, y)
        control[FOR] = point[TIME]
    d = along(S, (dt,))
    return (
        y[0] + d[0],
        y[1] + d[1],
        y[2] + d[2],
        y[3] + d[3],
        y[4] + d[4],
        y[5] + d[5],
        y[6] + d[6],
    )
