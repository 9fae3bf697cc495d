"""Template: march by Gauss collocation with eight stages (gauss16.py).

A node is one point of the march: [time, next step or number of the node, squared scales (3), unknowns, what their sums lost]; before KEPT
the size of the step that led here (0: none) and the sweeps it was given, from KEPT on its rates at the stages.

`control` holds [tolerance per second, fixed step or 0, origin] and from WORK on a workspace S: the stages (unknown by unknown, eight each),
from RATES on their rates (books too), from MATRIX on h a_ij (at 8 j + i) for one h, from PREDICTOR on the same from the rates of the step
before, for one pair of steps; from FOR on these steps, the time of the node whose step has its curve kept and the size of its last
coefficients, and from CURVE on that curve: coefficients of P_0 ... P_16, unknown by unknown.
"""

import math

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.marching.gauss_nodes import AHEAD, DENSE, STAGES, TAILS, A, B, C
from rigid_body_sim.integrators.marching.points import onward
from rigid_body_sim.numerics.functions import power

rate = UNBOUND
settled = UNBOUND
load = UNBOUND
put = UNBOUND
load_scales = UNBOUND
put_scales = UNBOUND
stage_rates = UNBOUND
spread = UNBOUND
combined = UNBOUND
advanced = UNBOUND
measure = UNBOUND
by_group = UNBOUND
grown = UNBOUND
fastest = UNBOUND
first_scales = UNBOUND
along = UNBOUND
end_of_curve = UNBOUND
# counts of the unknowns, with books and without, and places that follow from them
SIZE = UNBOUND
UNKNOWNS = UNBOUND
RATES = UNBOUND
KEPT = UNBOUND
MATRIX = UNBOUND
PREDICTOR = UNBOUND
FOR = UNBOUND
CURVE = UNBOUND

TIME, STEP, SCALES, VALUES = 0, 1, 2, 5
TOLERANCE, FIXED, ORIGIN, WORK = 0, 1, 2, 3

NEARLY = 1e-9            # of a fixed step: an end that close to a node is that node
GROWTH, SHRINK, SAFETY = 1.5, 0.3, 0.9
WORTH = 1.05             # change of step below which the step stays: another predictor costs half a sweep
TRIALS = 60              # of one step
MOST_SWEEPS = 45         # of one trial: slower convergence asks for a smaller step
COMFORTABLE = 13         # beyond it longer steps cost more than they save
FIRST, UNMOVED = 0.5, 1e-3    # the first step: rad of the fastest unknown; s, where nothing moves yet
FIRST_SWEEPS = 4         # of a step without one before it
ROUNDING = 2.0 ** -60    # of an increment: nothing to it
NOISE = 2.0 ** -44       # of an increment: changes so small that no longer fall are rounding
# The rates of y' = i nu y with x = nu h have Legendre coefficients c_n = x^(n + 1) (2 n + 1)/(2^n (2 n + 1)!!) for large n: c_(n + 1)/c_n is
# x/(4 n + 2), the 7th is 5.8e-8 x^8, and the step errs by (8!)^2/(16! 17!) x^17: that is UNSEEN x^9 times the 7th.
FALL_7, FALL_75, FALL_64, UNSEEN = 26.0, 26.0 * 22.0, 22.0 * 18.0, 3.8e-12
LONGEST = 3.5            # of x, which is half the angle that a body turns: beyond it substitution takes more sweeps than are given
ENOUGH = 0.03            # of what is allowed: a change so small says that one sweep less would do


@compiled
def begin(p, control, node):
    """Choose the first step from a node whose time and unknowns are set, and the scales."""
    control[ORIGIN], control[WORK + FOR + 3] = node[TIME], math.nan    # no curve yet
    y = load(node, VALUES)
    k = rate(p, y)
    speed = fastest(y, k)
    h = FIRST / speed if speed > 0.0 else UNMOVED
    node[STEP], node[KEPT - 1] = 0.0 if control[FIXED] > 0.0 else h, 1.0
    put_scales(first_scales(y, k, h), node, SCALES)


@compiled
def _prepare(S, h, last):
    """Fill the matrix for a step h, and the predictor from a step of size `last` (if there was one), unless they are there."""
    if S[FOR] != h:
        S[FOR] = h
        for j in range(STAGES):
            for i in range(STAGES):
                S[MATRIX + STAGES * j + i] = h * A[i, j]
    if last > 0.0 and (S[FOR + 1] != h or S[FOR + 2] != last):
        S[FOR + 1], S[FOR + 2] = h, last
        for i in range(STAGES):
            x = C[i] * h / last
            for j in range(STAGES):
                total = 0.0
                for k in range(STAGES):
                    total = (total + AHEAD[j, STAGES - 1 - k]) * x
                S[PREDICTOR + STAGES * j + i] = last * total


@compiled
def solve(p, S, y, h, last, sweeps, allowed, scales):
    """Solve the equations of the stages of a step.

    Parameters
    ----------
    last : float
        Size of the step before, whose rates stand in S; 0 if there was none.
    sweeps : int
        How many before the first look at the change that the next one makes.
    allowed : float
        Change at which it is enough.

    Returns
    -------
    (mean rates of the step, sweeps that were needed before the last one, whether one less would do, whether it converged)
    """
    _prepare(S, h, last)
    if last > 0.0:
        spread(S, y, PREDICTOR)
    else:
        first = rate(p, y)
        for u in range(UNKNOWNS):
            for i in range(STAGES):
                S[RATES + STAGES * u + i] = first[u]
        spread(S, y, MATRIX)
        sweeps = max(sweeps, FIRST_SWEEPS)
    for _ in range(sweeps - 1):
        stage_rates(p, S)
        spread(S, y, MATRIX)
    stage_rates(p, S)
    mean = combined(S, B)
    size = h * h * measure(mean, mean, 0.0, scales)
    enough = max(allowed * allowed, ROUNDING * ROUNDING * size)
    least, smallest = sweeps, math.inf
    while True:
        spread(S, y, MATRIX)
        stage_rates(p, S)
        before, mean = mean, combined(S, B)
        change = h * h * measure(mean, before, 1.0, scales)
        if change <= enough or smallest <= change <= NOISE * NOISE * size:
            return mean, sweeps, sweeps == least and change <= ENOUGH * ENOUGH * enough, True
        sweeps, smallest = sweeps + 1, change
        if not sweeps < MOST_SWEEPS or not change < math.inf:
            return mean, sweeps, False, False


@compiled
def _judged(S, h, mean, scales):
    """Return (estimated error of a step, its length in radians of its largest motion); (0, 0) where coefficients are but rounding.

    Each group of unknowns errs by its own fastest motion: the torque of the weight turns in body axes twice as fast as q does, so omega may
    err most where its changes are small.
    """
    rows = combined(S, TAILS[0]), combined(S, TAILS[1]), combined(S, TAILS[2]), combined(S, TAILS[3])
    c7, c6 = by_group(rows[0], scales), by_group(rows[1], scales)
    c5, c4 = by_group(rows[2], scales), by_group(rows[3], scales)
    noise = NOISE * NOISE * measure(mean, mean, 0.0, scales)
    error, s7, s6, s5, s4 = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(len(c7)):
        s7, s6, s5, s4 = s7 + c7[k], s6 + c6[k], s5 + c5[k], s4 + c4[k]
        if c5[k] + c4[k] > noise:
            square = _fastest_square(c7[k], c6[k], c5[k], c4[k], noise)
            seventh = math.sqrt(max(c7[k], square * c6[k] / (FALL_7 * FALL_7)))
            error += UNSEEN * h * seventh * square * square * square * square * math.sqrt(square)
    if s5 + s4 <= noise:
        return error, 0.0
    return error, math.sqrt(_fastest_square(s7, s6, s5, s4, noise))


@compiled
def _fastest_square(c7, c6, c5, c4, noise):
    """Return the squared length of a step in radians, from squared coefficients: both pairs, lest an even or odd motion hide one."""
    return math.sqrt(max(FALL_75 * FALL_75 * c7 / (c5 + noise), FALL_64 * FALL_64 * c6 / (c4 + noise)))


@compiled
def march(p, control, node, following, target, end, limit):
    """Move `node` on until the step from it holds the time `target`, at most `limit` steps; return (steps moved, whether it went well).

    The step from `node` ends at `following`, which is not known yet if its time is not later. Both are changed. The last node stands at
    `end` exactly.
    """
    moved = onward(node, following, target)
    if moved < 0:
        return 0, True
    tolerance, fixed, S = control[TOLERANCE], control[FIXED], control[WORK:]
    t, planned, last, sweeps = node[TIME], node[STEP], node[KEPT - 2], int(node[KEPT - 1])
    scales, y, c = load_scales(node, SCALES), load(node, VALUES), load(node, VALUES + SIZE)
    for k in range(STAGES * SIZE):
        S[RATES + k] = node[KEPT + k]
    good = True
    while t < end:
        for k in range(STAGES * SIZE):
            node[KEPT + k] = S[RATES + k]
        good, h, next_step, before = False, planned, planned, last
        for _ in range(TRIALS):
            if fixed > 0.0:
                t1, h, next_step = control[ORIGIN] + (planned + 1.0) * fixed, fixed, planned + 1.0
                if t1 + NEARLY * fixed >= end:
                    t1, h = end, end - t
            else:
                t1 = end if t + 1.1 * h >= end else t + h
                h = t1 - t
            allowed = tolerance * h
            scales1 = grown(scales, y)
            mean, used, fewer, good = solve(p, S, y, h, before, sweeps, allowed, scales1)
            if fixed == 0.0:
                factor = SHRINK
                if good:
                    error, x = _judged(S, h, mean, scales1)
                    good = error <= allowed and x <= LONGEST and t1 > t
                    if error < math.inf:
                        factor = min(GROWTH, max(SHRINK, SAFETY * power(allowed / max(error, 1e-9 * allowed), 1.0 / (2 * STAGES - 1))))
                        factor = min(factor, SAFETY * LONGEST / max(x, 1e-3))
                if good and used > COMFORTABLE:
                    factor = min(factor, 1.0 if used <= COMFORTABLE + 3 else SAFETY)
                next_step = h if good and t1 < end and 1.0 <= factor < WORTH else h * factor
            if good or fixed > 0.0:
                break
            h, before = next_step, 0.0    # the rates of the step before are overwritten
        y1, c1 = advanced(y, mean, c, h)
        y1, c1 = settled(y1, c1)
        sweeps1 = max(1, used - 1) if fewer else used
        if not good or target < t1 or moved == limit:
            following[TIME], following[STEP], following[KEPT - 2], following[KEPT - 1] = t1, next_step, h, sweeps1
            put_scales(scales1, following, SCALES)
            put(y1, following, VALUES)
            put(c1, following, VALUES + SIZE)
            for k in range(STAGES * SIZE):
                following[KEPT + k] = S[RATES + k]
            break
        t, planned, last, sweeps, y, c, scales = t1, next_step, h, sweeps1, y1, c1, scales1
        moved += 1
    node[TIME], node[STEP], node[KEPT - 2], node[KEPT - 1] = t, planned, last, sweeps
    put_scales(scales, node, SCALES)
    put(y, node, VALUES)
    put(c, node, VALUES + SIZE)
    return moved, good


@compiled
def between(p, control, node, following, dt):
    """Return the unknowns a time dt after a node and within the step from it.

    After a step of the same size they follow the polynomial through the rates of both, 16 in all, if its last coefficient is small enough;
    else a shorter step of the method is made.
    """
    y = load(node, VALUES)
    if not dt > 0.0:
        return y
    S, h, last = control[WORK:], following[KEPT - 2], node[KEPT - 2]
    if h == last:
        if S[FOR + 3] != node[TIME]:
            S[FOR + 3] = node[TIME]
            _lay_curve(S, node, following, h)
            highest = end_of_curve(S)
            S[FOR + 4] = math.sqrt(measure(highest, highest, 0.0, load_scales(node, SCALES)))
        if S[FOR + 4] <= max(control[TOLERANCE] * h, ROUNDING):
            return along(S, y, dt / h)
    for k in range(STAGES * SIZE):
        S[RATES + k] = node[KEPT + k]
    sweeps = max(1, int(dt / last * node[KEPT - 1])) if last > 0.0 else 1
    mean, _, _, _ = solve(p, S, y, dt, last, sweeps, control[TOLERANCE] * dt, load_scales(node, SCALES))
    y, _ = advanced(y, mean, load(node, VALUES + SIZE), dt)
    return y


@compiled
def _lay_curve(S, node, following, h):
    """Fill the curve of the step between two nodes: integrals from the first one."""
    terms = 2 * STAGES + 1
    for u in range(SIZE):
        for k in range(terms):
            S[CURVE + terms * u + k] = 0.0
        for j in range(STAGES):
            before, now = h * node[KEPT + STAGES * u + j], h * following[KEPT + STAGES * u + j]
            for k in range(terms):
                S[CURVE + terms * u + k] += before * DENSE[j, k] + now * DENSE[STAGES + j, k]
