# SPDX-License-Identifier: Apache-2.0
"""Template: march by Gauss collocation with eight stages (gauss16.py).

A point holds, after its Head (points.py), the unknowns and what their sums lost; in LAST the size
of the step that led here (0: none), in SWEEPS the sweeps it was given, and from KEPT on its rates
at the stages.

`control` holds, after its Control, in TURNING and MOVING the accelerations of terms that may
cancel (rad/s^2, m/s^2, bounds.py), and from WORK on a workspace S:

    0           stages, unknown by unknown, eight each
    RATES       their rates
    MATRIX      h a_ij (at 8 j + i) for one h
    PREDICTOR   the same from the rates of the step before, for one pair of steps
    FOR         the step of the matrix; FOR_STEP, FOR_BEFORE: the two steps of the predictor
    FOR_POINT   the time of the point whose step has its curve kept
    TAIL        the size of the curve's last coefficients
    BETWEEN     the same as MATRIX for points between the stages, and the rates at the stages while
                rates at these points stand in their place
    CURVE       the curve: coefficients of P_0 ... P_16, unknown by unknown; after it what
                relaxing.py needs where drag is stiff
"""

import math

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.marching.gauss_nodes import (
    AHEAD,
    DENSE,
    HIGHEST,
    STAGES,
    TAILS,
    A,
    B,
    C,
)
from rigid_body_sim.integrators.marching.gauss_nodes import BETWEEN as TO_BETWEEN
from rigid_body_sim.integrators.marching.points import (
    CONTROL,
    FIXED,
    LEAST_ERROR,
    ORIGIN,
    SCALES,
    STEP,
    TIME,
    TOLERANCE,
    VALUES,
    Standing,
    onward,
)
from rigid_body_sim.numerics.functions import power

rate = UNBOUND
settled = UNBOUND
load = UNBOUND
put = UNBOUND
load_scales = UNBOUND
put_scales = UNBOUND
stage_rates = UNBOUND
relax = UNBOUND         # what stiff drag asks for between two sweeps: relaxing.py, or nothing
hidden = UNBOUND        # the error that a rough term hides: `rough`, or 0 where nothing is rough
spread = UNBOUND
combined = UNBOUND
advanced = UNBOUND
measure = UNBOUND
by_group = UNBOUND
grown = UNBOUND
fastest = UNBOUND
first_scales = UNBOUND
pulled = UNBOUND
balanced = UNBOUND
FLIGHT = UNBOUND  # which of the scales are those of place and velocity; (): none
along = UNBOUND
end_of_curve = UNBOUND
SIZE = UNBOUND    # count of the unknowns
# the same as NOISE as a share of the unknowns, where the increments are small
FLOOR = UNBOUND
CLOCK = UNBOUND      # rounding of the time, as a share of it, where anything depends on it; else 0
SETTLED = UNBOUND    # a change that is enough whatever was asked, as a share of the unknowns
# places in a point
LAST = UNBOUND
SWEEPS = UNBOUND
KEPT = UNBOUND
# places in S
RATES = UNBOUND
MATRIX = UNBOUND
PREDICTOR = UNBOUND
FOR = UNBOUND
FOR_STEP = UNBOUND
FOR_BEFORE = UNBOUND
FOR_POINT = UNBOUND
TAIL = UNBOUND
CURVE = UNBOUND
BETWEEN = UNBOUND
ASIDE = UNBOUND
arrive = None    # final states are like others

TURNING = CONTROL.size      # places in `control`
MOVING = TURNING + 1
WORK = MOVING + 1

AGAIN = False            # of relax: the stages are not predicted ones
NEARLY = 1e-9            # share of a fixed step: an end that close to a point is that point
GROWTH, SHRINK, SAFETY = 1.5, 0.3, 0.9
# a step stays unless it changes by more: another predictor costs half a sweep
WORTH = 1.05
TRIALS = 60              # largest number of attempts at a step
MOST_SWEEPS = 45         # most sweeps of an attempt: slower convergence asks for a smaller step
COMFORTABLE = 13         # beyond so many sweeps longer steps cost more than they save
FIRST, UNMOVED = 0.5, 1e-3    # the first step: rad of the fastest unknown; s, where nothing moves
LONGEST_FIRST = 2.0 ** 20     # s: TRIALS attempts find a step from there
FIRST_SWEEPS = 4         # sweeps of a step without one before it
ROUNDING = 2.0 ** -60    # share of an increment that is nothing to it
NOISE = 2.0 ** -44       # share of an increment: smaller changes that no longer fall are rounding
CANCELLED = 2.0 ** -57    # share of cancelling terms that a step need not resolve: errors add up
# The rates of y' = i nu y with x = nu h have Legendre coefficients
#     c_n = x^(n + 1) (2 n + 1)/(2^n (2 n + 1)!!)    for large n:
# c_(n + 1)/c_n is x/(4 n + 2), the 7th is 5.8e-8 x^8, and the step errs by
# (8!)^2/(16! 17!) x^17: that is UNSEEN x^9 times the 7th.
FALL_7, FALL_75, FALL_64, UNSEEN = 26.0, 26.0 * 22.0, 22.0 * 18.0, 3.8e-12
# largest x, half the angle of a step: beyond it substitution takes too many sweeps
LONGEST = 3.5
# share of the tolerance that a state between points may err by: the points themselves err by far
# less than is allowed. A curve errs by its last coefficient, a shorter step by its last sweep.
BETWEEN_POINTS = 2.0 ** -7
ENOUGH = 0.03            # share of the allowed change: after one so small a sweep less would do


@compiled
def _load_point(point):
    """Return the Standing of a point."""
    return Standing(point[TIME], point[STEP], load_scales(point, SCALES), load(point, int(VALUES)),
                    load(point, VALUES + SIZE), point[LAST], int(point[SWEEPS]))


@compiled
def _store_point(standing, point):
    """Write the Standing of a point; the rates at its stages stay."""
    point[TIME], point[STEP] = standing.time, standing.step
    point[LAST], point[SWEEPS] = standing.last, standing.sweeps
    put_scales(standing.scales, point, SCALES)
    put(standing.y, point, int(VALUES))
    put(standing.lost, point, VALUES + SIZE)


@compiled
def _take_rates(point, S):
    """Copy the rates that a point keeps into S."""
    for k in range(STAGES * SIZE):
        S[RATES + k] = point[KEPT + k]


@compiled
def _keep_rates(S, point):
    """Copy the rates in S into a point."""
    for k in range(STAGES * SIZE):
        point[KEPT + k] = S[RATES + k]


@compiled
def begin(p, control, point):
    """Choose the first step from a point whose time and unknowns are set, and the scales."""
    control[ORIGIN], control[WORK + FOR_POINT] = point[TIME], math.nan    # no curve yet
    y = load(point, int(VALUES))
    k = rate(p, y)
    speed = fastest(y, k)
    h = min(FIRST / speed, LONGEST_FIRST) if speed > 0.0 else UNMOVED
    point[STEP], point[SWEEPS] = 0.0 if control[FIXED] > 0.0 else h, 1.0
    control[MOVING], scales = balanced(control[MOVING], load_scales(point, SCALES), k)
    put_scales(first_scales(scales, y, k, h), point, SCALES)


@compiled
def _prepare(S, h, last):
    """Fill the matrix for a step h, and the predictor from a step `last` > 0, if needed."""
    if S[FOR] != h:
        S[FOR] = h
        for j in range(STAGES):
            for i in range(STAGES):
                S[MATRIX + STAGES * j + i] = h * A[i, j]
                S[BETWEEN + STAGES * j + i] = h * TO_BETWEEN[i, j]
    if last > 0.0 and (S[FOR_STEP] != h or S[FOR_BEFORE] != last):
        S[FOR_STEP], S[FOR_BEFORE] = h, last
        for i in range(STAGES):
            x = C[i] * h / last
            for j in range(STAGES):
                total = 0.0
                for k in range(STAGES):
                    total = (total + AHEAD[j, STAGES - 1 - k]) * x
                S[PREDICTOR + STAGES * j + i] = last * total


@compiled
def _predict(p, S, y, last):
    """Fill the stages by the curve of the step before, of size `last`; 0: by the rates at y."""
    if last > 0.0:
        spread(S, y, PREDICTOR)
        return
    first = rate(p, y)
    for u in range(SIZE):
        for i in range(STAGES):
            S[RATES + STAGES * u + i] = first[u]
    spread(S, y, MATRIX)


@compiled
def solve(p, S, y, h, last, sweeps, allowed, pull, scales):
    """Solve the equations of the stages of a step by substitution.

    More than eight arguments: scalars and tuples stay in registers where arrays would not.

    Parameters
    ----------
    h : float
        Size of the step, s.
    last : float
        Size of the step before, whose rates stand in S; 0 if there was none.
    sweeps : int
        How many sweeps before the first look at the change that the next one makes.
    allowed : float
        Change at which it is enough.
    pull : float
        What terms that may cancel do in the step, as a share of what they move: where they nearly
        do, they leave their rounding.
    scales : tuple of floats
        Squared scales.

    Returns
    -------
    tuple of floats, int, bool, bool
        Mean rates of the step, the sweeps that were needed before the last one, whether one less
        would do, whether it converged.
    """
    _prepare(S, h, last)
    _predict(p, S, y, last)
    if not last > 0.0:
        sweeps = max(sweeps, FIRST_SWEEPS)
    for sweep in range(sweeps - 1):
        stage_rates(p, S)
        relax(S, y, h, sweep == 0)
        spread(S, y, MATRIX)
    stage_rates(p, S)
    relax(S, y, h, sweeps == 1)
    mean = combined(S, B)
    size = h * h * measure(mean, mean, 0.0, scales)
    enough = max(allowed * allowed, ROUNDING * ROUNDING * size, SETTLED * SETTLED)
    floor = max(NOISE * NOISE * (size + pull * pull), FLOOR * FLOOR)
    least, smallest = sweeps, math.inf
    while True:
        spread(S, y, MATRIX)
        stage_rates(p, S)
        relax(S, y, h, bool(AGAIN))
        before, mean = mean, combined(S, B)
        change = h * h * measure(mean, before, 1.0, scales)
        if change <= enough or smallest <= change <= floor:
            return mean, sweeps, sweeps == least and change <= ENOUGH * ENOUGH * enough, True
        sweeps, smallest = sweeps + 1, change
        if not sweeps < MOST_SWEEPS or not change < math.inf:
            return mean, sweeps, False, False


@compiled
def _judged(S, h, mean, pull, scales, time):
    """Return the estimated error of a step, and its length in radians of its largest motion.

    (0, 0) where the coefficients are only rounding. Each group of unknowns errs by its own fastest
    motion: the torque of the weight turns in body axes twice as fast as q does, so omega may err
    most where its changes are small.
    """
    noise = _noise(h, mean, pull, scales, time)
    c7 = by_group(combined(S, TAILS[0]), scales)
    c6 = by_group(combined(S, TAILS[1]), scales)
    c5 = by_group(combined(S, TAILS[2]), scales)
    c4 = by_group(combined(S, TAILS[3]), scales)
    error, s7, s6, s5, s4 = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(len(c7)):
        s7, s6, s5, s4 = s7 + c7[k], s6 + c6[k], s5 + c5[k], s4 + c4[k]
        if c5[k] + c4[k] > noise:
            square = _fastest_square(c7[k], c6[k], c5[k], c4[k], noise)
            seventh = math.sqrt(max(c7[k], square * c6[k] / (FALL_7 * FALL_7)))
            fourth = UNSEEN * h * seventh * square * square * square * square
            error += fourth * math.sqrt(square)
    if s5 + s4 <= noise:
        return error, 0.0
    return error, math.sqrt(_fastest_square(s7, s6, s5, s4, noise))


@compiled
def _noise(h, mean, pull, scales, time):
    """Return the square of a coefficient of the rates that may be rounding.

    What acts with time is as rough as its rounding makes the fastest motion that the step
    resolves.
    """
    size = measure(mean, mean, 0.0, scales) + pull * pull / (h * h)
    rounding = max(NOISE, CLOCK * time * LONGEST / h)
    return max(rounding * rounding * size, FLOOR * FLOOR / (h * h))


@compiled
def rough(p, S, y, h, mean, pull, scales, time):
    """Return the error of a step by terms that are too small to show in its first coefficients.

    The rates along the curve of the step, at the stages and between them, give the coefficients of
    P_14 and P_15: what of a rough term eight stages do not see is about as large.
    """
    for k in range(STAGES * SIZE):
        S[ASIDE + k] = S[RATES + k]
    last, before = combined(S, HIGHEST[0, 0]), combined(S, HIGHEST[1, 0])
    spread(S, y, BETWEEN)
    stage_rates(p, S)
    square = (measure(last, combined(S, HIGHEST[0, 1]), -1.0, scales)
              + measure(before, combined(S, HIGHEST[1, 1]), -1.0, scales))
    for k in range(STAGES * SIZE):
        S[RATES + k] = S[ASIDE + k]
    return h * math.sqrt(square) if square > _noise(h, mean, pull, scales, time) else 0.0


@compiled
def _fastest_square(c7, c6, c5, c4, noise):
    """Return the squared length of a step in radians, from squared coefficients.

    It takes both pairs of them, because an even or an odd motion would hide one.
    """
    return math.sqrt(max(FALL_75 * FALL_75 * c7 / (c5 + noise),
                         FALL_64 * FALL_64 * c6 / (c4 + noise)))


@compiled
def _pull(control, h, scales):
    """Return what terms that may cancel do in a step, as a share of what they move."""
    return pulled(control[TURNING], control[MOVING], h, scales)


@compiled
def _span(control, here, h, end):
    """Return the end of a step h and its size; the last step of a march ends at `end` exactly."""
    fixed = control[FIXED]
    if fixed > 0.0:
        t1 = control[ORIGIN] + (here.step + 1.0) * fixed
        if t1 + NEARLY * fixed >= end:
            return end, end - here.time
        return t1, fixed
    t1 = end if here.time + 1.1 * h >= end else here.time + h
    return t1, t1 - here.time


@compiled
def _factor(error, x, allowed, used, converged, good):
    """Return by how much the next step, or the next attempt, is longer than a step.

    Parameters
    ----------
    error, x : float
        What `_judged` returned, where the step converged.
    used : int
        Its sweeps.
    good : bool
        Whether the step is taken.
    """
    factor = SHRINK
    if converged and error < math.inf:
        ratio = allowed / max(error, 1e-9 * allowed)
        factor = min(GROWTH, max(SHRINK, SAFETY * power(ratio, 1.0 / (2 * STAGES - 1))))
        factor = min(factor, SAFETY * LONGEST / max(x, 1e-3))
    if good and used > COMFORTABLE:
        factor = min(factor, 1.0 if used <= COMFORTABLE + 3 else SAFETY)
    return factor


@compiled
def _step(p, control, here, end):
    """Return the Standing at the end of a step, and whether the step is good.

    An adaptive step is tried with ever smaller sizes until its estimated error is what the
    tolerance allows in that time. The rates of the step before stand in S, those of this one
    replace them.
    """
    S, fixed = control[WORK:], control[FIXED] > 0.0
    scales, h, before = grown(here.scales, here.y), here.step, here.last
    for _ in range(TRIALS):
        t1, h = _span(control, here, h, end)
        pull = _pull(control, h, scales)
        seen = max(control[TOLERANCE] * h, LEAST_ERROR)
        allowed = max(seen, CANCELLED * pull)
        # a first step has no prediction that would be good where what moves is small beside pull
        mean, used, fewer, good = solve(p, S, here.y, h, before, here.sweeps,
                                        allowed if before > 0.0 else seen, pull, scales)
        if fixed:
            next_step = here.step + 1.0
            break
        error, x, converged = 0.0, 0.0, good
        if converged:
            error, x = _judged(S, h, mean, pull, scales, abs(t1))
            if error <= allowed:
                error = max(error, hidden(p, S, here.y, h, mean, pull, scales, abs(t1)))
            good = error <= allowed and x <= LONGEST and t1 > here.time
        factor = _factor(error, x, allowed, used, converged, good)
        next_step = h if good and t1 < end and 1.0 <= factor < WORTH else h * factor
        if good:
            break
        h, before = next_step, 0.0    # the rates of the step before are overwritten
    y, lost = advanced(here.y, mean, here.lost, h)
    y, lost = settled(y, lost)
    return Standing(t1, next_step, scales, y, lost, h, max(1, used - 1) if fewer else used), good


@compiled
def march(p, control, point, following, target, end, limit):
    """Move `point` on until the step from it holds the time `target`, at most `limit` steps.

    The step from `point` ends at `following`, which is not known yet if its time is not later.
    Both are changed. The last point stands at `end` exactly.

    Returns
    -------
    int, bool
        Steps moved, and whether it went well.
    """
    moved = onward(point, following, target)
    if moved < 0:
        return 0, True
    S, good = control[WORK:], True
    here = _load_point(point)
    _take_rates(point, S)
    while here.time < end:
        _keep_rates(S, point)
        reached, good = _step(p, control, here, end)
        if not good or target < reached.time or moved == limit:
            _store_point(reached, following)
            _keep_rates(S, following)
            if not good:
                following[TIME] = here.time    # none follows
            break
        here = reached
        moved += 1
    _store_point(here, point)
    return moved, good


@compiled
def between(p, control, point, following, dt):
    """Return the unknowns a time dt after a point and within the step from it.

    After a step of the same size they follow the polynomial through the rates of both, 16 in all,
    if its last coefficient is small enough; else a shorter step of the method is made. Where that
    one does not converge they follow the polynomial of the step itself: of a body at rest the
    rates are rounding, and a step that was settled at once may be too long for substitution.
    """
    y = load(point, int(VALUES))
    if not dt > 0.0:
        return y
    S, h, last = control[WORK:], following[LAST], point[LAST]
    scales = load_scales(point, SCALES)
    if h == last:
        if S[FOR_POINT] != point[TIME]:
            S[FOR_POINT] = point[TIME]
            _lay_curve(S, point, following, h)
            highest = end_of_curve(S)
            S[TAIL] = math.sqrt(measure(highest, highest, 0.0, scales))
        if S[TAIL] <= max(BETWEEN_POINTS * control[TOLERANCE] * h, ROUNDING):
            return along(S, y, dt / h)
    _take_rates(point, S)
    sweeps = max(1, int(dt / last * point[SWEEPS])) if last > 0.0 else 1
    pull = _pull(control, dt, scales)
    allowed = BETWEEN_POINTS * control[TOLERANCE] * dt
    mean, _, _, converged = solve(p, S, y, dt, last, sweeps, allowed, pull, scales)
    if not converged:
        return _within(S, following, dt / h)
    y, _ = advanced(y, mean, load(point, VALUES + SIZE), dt)
    return y


@compiled
def _within(S, following, x):
    """Return the unknowns after a part x of the step to a point, by the rates at its stages."""
    _take_rates(following, S)
    row, back = S[ASIDE:ASIDE + STAGES], x - 1.0
    for j in range(STAGES):
        total = 0.0
        for k in range(STAGES):
            total = (total + AHEAD[j, STAGES - 1 - k]) * back
        row[j] = total
    y, _ = advanced(load(following, int(VALUES)), combined(S, row), load(following, VALUES + SIZE),
                    following[LAST])
    return y


@compiled
def _lay_curve(S, point, following, h):
    """Fill the curve of the step between two points: integrals from the first one."""
    terms = 2 * STAGES + 1
    for u in range(SIZE):
        for k in range(terms):
            S[CURVE + terms * u + k] = 0.0
        for j in range(STAGES):
            before = h * point[KEPT + STAGES * u + j]
            now = h * following[KEPT + STAGES * u + j]
            for k in range(terms):
                S[CURVE + terms * u + k] += before * DENSE[j, k] + now * DENSE[STAGES + j, k]
