# SPDX-License-Identifier: Apache-2.0
"""Template: march with steps of one size.

A point of the march holds, after its Head (points.py), the unknowns and what their sums lost;
`control` is a Control. The k-th point stands at origin + k h, formed anew each time; the last one
stands at the end.
"""

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.marching.points import FIXED, ORIGIN, STEP, TIME, VALUES

rate = UNBOUND
settled = UNBOUND
step = UNBOUND
load = UNBOUND
put = UNBOUND
SIZE = UNBOUND
arrive = None    # final states are like others

COUNT = STEP    # in the place of the planned step: the number of the point
NEARLY = 1e-9    # share of a step: an end that close to a point is that point


@compiled
def begin(p, control, point):
    """Take the time of a point as the origin of all times."""
    control[ORIGIN] = point[TIME]


@compiled
def march(p, control, point, following, target, end, limit):
    """Move `point` on until the step from it holds the time `target`, at most `limit` steps.

    Return (steps moved, whether it went well).

    Parameters
    ----------
    point : array
        Changed; `following` is not needed.
    end : float
        The last point stands there exactly.
    """
    h, origin = control[FIXED], control[ORIGIN]
    t, count = point[TIME], point[COUNT]
    y, c = load(point, int(VALUES)), load(point, VALUES + SIZE)
    moved = 0
    while t < end and moved < limit:
        t1, size = origin + (count + 1.0) * h, h
        if t1 + NEARLY * h >= end:
            t1, size = end, end - t
        if target < t1:
            break
        y, c = step(p, y, c, rate(p, y), size)
        y, c = settled(y, c)
        t, count = t1, count + 1.0
        moved += 1
    point[TIME], point[COUNT] = t, count
    put(y, point, int(VALUES))
    put(c, point, VALUES + SIZE)
    return moved, y[0] == y[0]


@compiled
def between(p, control, point, following, dt):
    """Return the unknowns a time dt after a point, within the step from it.

    It is one step of the method.
    """
    y = load(point, int(VALUES))
    if dt > 0.0:
        y, _ = step(p, y, load(point, VALUES + SIZE), rate(p, y), dt)
    return y
