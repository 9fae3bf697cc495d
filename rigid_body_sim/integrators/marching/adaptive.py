# SPDX-License-Identifier: Apache-2.0
"""Template: march with a Runge-Kutta method that chooses its own steps.

A point of the march holds, after its Head (points.py), the unknowns and what their sums lost;
`control` holds, after its Control, the rounding of the rates of the first relative group per
second, the acceleration of terms that may cancel (m/s^2, bounds.py), and from WEIGHTS on the
weights of the method (unroll.py). A step is accepted when its
estimated error per second is below the tolerance, so that errors add up in proportion to time and
not to the number of steps.
"""

import math

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.marching.points import (
    CONTROL,
    LEAST_ERROR,
    SCALES,
    STEP,
    TIME,
    TOLERANCE,
    VALUES,
    onward,
)
from rigid_body_sim.numerics.functions import power

rate = UNBOUND
settled = UNBOUND
trial = UNBOUND
fastest = UNBOUND
load = UNBOUND
put = UNBOUND
load_scales = UNBOUND
put_scales = UNBOUND
balanced = UNBOUND
FLIGHT = UNBOUND    # which of the scales are those of place and velocity; (): none
SIZE = UNBOUND
ORDER = UNBOUND
arrive = None    # final states are like others

ROUNDING = CONTROL.size    # places in `control`
MOVING = ROUNDING + 1
WEIGHTS = MOVING + 1
GROWTH, SHRINK, SAFETY = 4.0, 0.1, 0.9
SPEED = 10.0               # 1/s, of a first step where nothing moves yet
LONGEST_FIRST = 2.0 ** 20  # s: TRIALS refusals lead to any step from there
TRIALS = 60                # refusals of one step after which it is given up


@compiled
def begin(p, control, point):
    """Choose the first step from a point whose time and unknowns are set, and the scales."""
    y = load(point, int(VALUES))
    k = rate(p, y)
    control[MOVING], scales = balanced(control[MOVING], load_scales(point, SCALES), k)
    put_scales(scales, point, SCALES)
    speed = fastest(y, k)
    first = power(control[TOLERANCE], 1.0 / ORDER) / (speed if speed > 0.0 else SPEED)
    point[STEP] = min(first, LONGEST_FIRST)


@compiled
def march(p, control, point, following, target, end, limit):
    """Move `point` on until the step from it holds the time `target`, at most `limit` steps.

    Return (steps moved, whether it went well).

    Parameters
    ----------
    point, following : array
        The step from `point` ends at `following`, which is not known yet if its time is not later.
        Both are changed.
    end : float
        The last point stands there exactly.
    """
    tolerance, rounding, weights = control[TOLERANCE], control[ROUNDING], control[WEIGHTS:]
    moved = onward(point, following, target)
    if moved < 0:
        return 0, True
    t, planned = point[TIME], point[STEP]
    scales, y, c = load_scales(point, SCALES), load(point, int(VALUES)), load(point, VALUES + SIZE)
    good = True
    while t < end:
        k0 = rate(p, y)
        h = planned
        good = False
        for _ in range(TRIALS):
            t1 = end if t + 1.1 * h >= end else t + h
            y1, c1, scales1, error = trial(p, weights, y, c, k0, t1 - t, scales)
            # near a balance large terms nearly cancel and leave their rounding in every stage; a
            # smaller tolerance would make steps shorter for ever
            noise = rounding / math.sqrt(scales1[0]) if scales1[0] > 0.0 else 0.0
            allowed = max(max(tolerance, noise) * (t1 - t), LEAST_ERROR)
            good = error <= allowed and t1 > t
            if error > 1e-9 * allowed and error < math.inf:
                h = (t1 - t) * min(
                    GROWTH, max(SHRINK, SAFETY * power(allowed / error, 1.0 / (ORDER - 1)))
                )
            else:    # no error is visible, or it is not a number
                h = (t1 - t) * (GROWTH if good else SHRINK)
            if good:
                break
        y1, c1 = settled(y1, c1)
        if not good or target < t1 or moved == limit:
            following[TIME], following[STEP] = t1 if good else t, h    # t: none follows
            put_scales(scales1, following, SCALES)
            put(y1, following, int(VALUES))
            put(c1, following, VALUES + SIZE)
            break
        t, planned, y, c, scales = t1, h, y1, c1, scales1
        moved += 1
    point[TIME], point[STEP] = t, planned
    put_scales(scales, point, SCALES)
    put(y, point, int(VALUES))
    put(c, point, VALUES + SIZE)
    return moved, good


@compiled
def between(p, control, point, following, dt):
    """Return the unknowns a time dt after a point, within the step from it.

    It is one step of the method.
    """
    y = load(point, int(VALUES))
    if dt > 0.0:
        # the same step as in the march, so that there is one to compile; its error is not looked
        # at
        lost, scales = load(point, VALUES + SIZE), load_scales(point, SCALES)
        y, _, _, _ = trial(p, control[WEIGHTS:], y, lost, rate(p, y), dt, scales)
    return y
