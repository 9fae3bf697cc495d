# SPDX-License-Identifier: Apache-2.0
"""Template: march a convex body on a plane through one phase, to the event that ends it.

It is bound to the rates of equations/contact_rates.py, and uses the coefficients of a Runge-Kutta
method that estimates its error (dop8). Loops over tables keep the compilation short.

A phase is an array of points: the unknowns, and what their sums have lost. The sizes of all steps
are kept beside it, so that a step is made again with the same bits. The front is the last point of
the march.

Events: the watched numbers of a row of rates are looked at in all stages of a step. Where one
falls below zero, or comes close, the step is looked through in parts, and the first zero is
bracketed and refined to round-off. Each look is a step of the method, of full order.
"""

import math

import numpy as np

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.equations.contact_rates import (
    CREEPING,
    FLIGHT,
    GAP,
    OMEGA,
    PACE,
    PLACE,
    ROW,
    SIZE,
    SLIDING,
    TIME,
    UNKNOWNS,
    WATCHED,
    WATCHES,
    U,
)
from rigid_body_sim.integrators.methods import dop8
from rigid_body_sim.mechanics.contact.parameters import CONTACT
from rigid_body_sim.numerics.functions import hypot, power
from rigid_body_sim.numerics.rotations import normalised

rate = UNBOUND

STAGES = len(dop8.A)
A = np.zeros((STAGES, STAGES))
B, E5, E3 = np.zeros(STAGES), np.zeros(STAGES), np.zeros(STAGES)
WEIGHED = tuple(dop8.B)        # stages that a step adds up, and its errors
for _i, _row in enumerate(dop8.A):
    for _j, _a in _row.items():
        A[_i, _j] = _a
for _table, _values in ((B, dop8.B), (E5, dop8.E5), (E3, dop8.E3)):
    for _j, _b in _values.items():
        _table[_j] = _b

LOST = SIZE                  # place in a point of what the sums have lost
POINT = 2 * SIZE
KEPT = 4096                  # points of a phase; beyond, every other one is dropped
(COUNT, STRIDE, STORED, STATUS, TOLERANCE, RATE, SPEED, LENGTH, PLANNED, STEPS,
 PLACED) = range(11)
"""Numbers of a phase: points passed, steps from one kept point to the next, points kept, why it
ended, tolerance per second, scales (rad/s, m/s, m), the step planned, steps made, and the number
of the point at which the cursor stands."""
META = 11
(RUNNING, LOST_CONTACT, LET_GO, STUCK, PARADOX, JUMP, TOUCHED, FAILED, FASTER,
 STOPPED) = range(10)
"""Why a phase ends: N = 0, the grip or the creep ends, the slip is dead, A = 0, what acts jumps,
the body comes down; no step is small enough; a creep has become a slip; a disk lies flat or a body
no longer rolls."""
END, FRESH, TRIED = STAGES, STAGES + 1, STAGES + 2    # rows of the work space beside the stages
WORK_ROWS = STAGES + 3
GROWTH, SHRINK, SAFETY, TRIALS = 4.0, 0.1, 0.9, 60
FLOOR = 2e-17                # of an error: none is asked to be smaller
ROUNDING = 2.0 ** -49
DEAD = 2.0 ** -56            # slip below that share of the speeds is none
PARTS = 16                   # of a step that is looked through
BISECTIONS = 120


@compiled
def step_from(p, w, y, lost, h):
    """Fill row FRESH with the unknowns after a step h from y; the rates at y are in row 0.

    Returns
    -------
    float
        0 if the numbers stayed finite, else infinite.
    """
    for i in range(1, STAGES):
        # sums stay in registers: two arrays in a loop would be looked at for overlap each time
        s0 = s1 = s2 = s3 = s4 = s5 = s6 = s7 = s8 = s9 = s10 = s11 = s12 = s13 = 0.0
        for j in range(i):
            a = h * A[i, j]
            if a != 0.0:
                s0 += a * w[j, 0]
                s1 += a * w[j, 1]
                s2 += a * w[j, 2]
                s3 += a * w[j, 3]
                s4 += a * w[j, 4]
                s5 += a * w[j, 5]
                s6 += a * w[j, 6]
                s7 += a * w[j, 7]
                s8 += a * w[j, 8]
                s9 += a * w[j, 9]
                s10 += a * w[j, 10]
                s11 += a * w[j, 11]
                s12 += a * w[j, 12]
                s13 += a * w[j, 13]
        sums = s0, s1, s2, s3, s4, s5, s6, s7, s8, s9, s10, s11, s12, s13
        for n in range(UNKNOWNS):
            w[TRIED, n] = sums[n] + y[n]
        rate(p, w[TRIED], w[i])
    b0, b5, b6, b7 = h * B[0], h * B[5], h * B[6], h * B[7]
    b8, b9, b10, b11 = h * B[8], h * B[9], h * B[10], h * B[11]
    bad = 0.0
    for n in range(SIZE):
        d = lost[n] + (
            b0 * w[0, n] + b5 * w[5, n] + b6 * w[6, n] + b7 * w[7, n]
            + b8 * w[8, n] + b9 * w[9, n] + b10 * w[10, n] + b11 * w[11, n])
        s = y[n] + d
        w[FRESH, n] = s
        w[TRIED, n] = d - (s - y[n])
        if not abs(s) < math.inf:
            bad = math.inf
    x, yy, z, v = normalised(w[FRESH, 0], w[FRESH, 1], w[FRESH, 2], w[FRESH, 3])
    w[TRIED, 0] += w[FRESH, 0] - x
    w[TRIED, 1] += w[FRESH, 1] - yy
    w[TRIED, 2] += w[FRESH, 2] - z
    w[TRIED, 3] += w[FRESH, 3] - v
    # along q there is nothing to make up for
    along = w[TRIED, 0] * x + w[TRIED, 1] * yy + w[TRIED, 2] * z + w[TRIED, 3] * v
    w[TRIED, 0] -= along * x
    w[TRIED, 1] -= along * yy
    w[TRIED, 2] -= along * z
    w[TRIED, 3] -= along * v
    w[FRESH, 0], w[FRESH, 1], w[FRESH, 2], w[FRESH, 3] = x, yy, z, v
    return bad


@compiled
def error_of(w, h, meta):
    """Return the estimated error of the step in the rows, as an angle (rad)."""
    fifth = third = moved = 0.0
    for n in range(UNKNOWNS):
        e5 = e3 = d = 0.0
        for j in WEIGHED:
            e5 += E5[j] * w[j, n]
            e3 += E3[j] * w[j, n]
            d += B[j] * w[j, n]
        weight = 1.0
        if OMEGA <= n < U:
            weight = 1.0 / meta[RATE]
        elif U <= n < PLACE:
            weight = 1.0 / meta[SPEED]
        elif PLACE <= n <= GAP:
            weight = 1.0 / meta[LENGTH]
        elif n == TIME:
            weight = meta[RATE]
        fifth += weight * weight * e5 * e5
        third += weight * weight * e3 * e3
        moved += weight * weight * d * d
    fifth, third, moved = h * h * fifth, h * h * third, h * h * moved
    if not fifth > ROUNDING * ROUNDING * moved:
        return 0.0 if fifth >= 0.0 else math.inf
    return fifth / math.sqrt(fifth + 0.01 * third)


@compiled
def look(p, w, y, lost, h, k):
    """Return the watched number k after a step h from y, whose rates are in row 0."""
    step_from(p, w, y, lost, h)
    rate(p, w[FRESH], w[END])
    return w[END, WATCHED + k]


@compiled
def first_zero(p, w, y, lost, h, k, begin):
    """Return the part of the step h at which a watched number first falls below zero.

    Returns
    -------
    float
        The first part (same unit as h) for which it is negative, to round-off; -1 if it stays
        above.
    """
    low, value_low = 0.0, begin
    least, at = math.inf, 0.0
    high, value_high = -1.0, 0.0
    for n in range(1, PARTS + 1):
        part = h * n / PARTS
        value = look(p, w, y, lost, part, k)
        if value < 0.0:
            high, value_high = part, value
            break
        if value < least:
            least, at = value, part
        low, value_low = part, value
    if high < 0.0:
        # the least of the values may hide a dip: golden section around it
        left, right = max(0.0, at - h / PARTS), min(h, at + h / PARTS)
        for _ in range(24):
            first = right - 0.6180339887498949 * (right - left)
            second = left + 0.6180339887498949 * (right - left)
            one, other = (look(p, w, y, lost, first, k), look(p, w, y, lost, second, k))
            if one < 0.0 or other < 0.0:
                high, value_high = (first, one) if one < 0.0 else (second, other)
                low, value_low = max(0.0, at - h / PARTS), least
                break
            if one < other:
                right = second
            else:
                left = first
        if high < 0.0:
            return -1.0
    # Illinois, kept within the bracket, until no double lies between
    side = 0
    for n in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if n % 3 != 2 and value_low > value_high and math.isfinite(value_low):
            middle = (low * value_high - high * value_low) / (value_high - value_low)
        if not low < middle < high:
            middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        value = look(p, w, y, lost, middle, k)
        if value < 0.0:
            high, value_high = middle, value
            if side == 1:
                value_low *= 0.5
            side = 1
        else:
            low, value_low = middle, value
            if side == -1:
                value_high *= 0.5
            side = -1
    return high


@compiled
def begin(p, w, front, meta, y):
    """Set the first point of a phase from its unknowns and choose its first step."""
    for n in range(SIZE):
        front[n], front[LOST + n] = y[n], 0.0
    rate(p, y, w[0])
    pace = w[0, PACE]
    size = math.sqrt(w[0, 4] * w[0, 4] + w[0, 5] * w[0, 5] + w[0, 6] * w[0, 6])
    fastest = meta[RATE] * pace + size / meta[RATE]
    if p[MODE] == SLIDING:
        fastest += hypot(w[0, U], w[0, U + 1]) / pace
    meta[PLANNED] = power(meta[TOLERANCE], 1.0 / dop8.ORDER) / fastest
    meta[COUNT], meta[STRIDE], meta[STORED], meta[STATUS] = 0.0, 1.0, 0.0, RUNNING
    meta[STEPS], meta[PLACED] = 0.0, -1.0


MODE = CONTACT.part('mode').first
SWIFT = CONTACT.part('swift').first


@compiled
def march(p, w, phase, sizes, front, meta, target):
    """Move the front on until its time is past the target, the phase ends, or no room is left."""
    y, lost = front[:LOST], front[LOST:]
    mode = p[MODE]
    rate(p, y, w[0])
    while (meta[STATUS] == RUNNING and y[TIME] <= target and meta[STEPS] < len(sizes)
           and (meta[STORED] < len(phase) or len(phase) == KEPT)):
        h = meta[PLANNED]
        good, planned = False, h
        for _ in range(TRIALS):
            bad = step_from(p, w, y, lost, h)
            error = error_of(w, h, meta) + bad
            allowed = meta[TOLERANCE] * (w[FRESH, TIME] - y[TIME]) + FLOOR
            good = error <= allowed
            factor = SHRINK
            if error < math.inf:
                factor = min(GROWTH, max(SHRINK, SAFETY * power(
                    allowed / max(error, 1e-9 * allowed), 1.0 / (dop8.ORDER - 1))))
            planned = h * factor
            if good:
                break
            h = planned
        if not good or (mode != SLIDING and not w[FRESH, TIME] > y[TIME]):
            meta[STATUS] = FAILED
            break
        rate(p, w[FRESH], w[END])
        status, part = RUNNING, h
        for k in range(WATCHES):
            below = w[END, WATCHED + k] < 0.0
            for i in range(1, STAGES):
                below |= w[i, WATCHED + k] < 0.0
            from_below = w[0, WATCHED + k] <= 0.0
            if below and not (from_below and (k == 4 or w[END, WATCHED + k] >= 0.0)):
                at = first_zero(p, w, y, lost, h, k, w[0, WATCHED + k])
                # the rows are those of the last look: put them back
                step_from(p, w, y, lost, h)
                rate(p, w[FRESH], w[END])
                if 0.0 < at <= part:
                    part, status = at, k + 1
        if status != RUNNING:
            step_from(p, w, y, lost, part)
        _keep(phase, front, meta)
        sizes[int(meta[STEPS])] = part
        meta[STEPS] += 1.0
        died = mode == SLIDING and w[END, PACE] < w[0, PACE] and (
            w[END, PACE] <= DEAD * p[SWIFT])
        for n in range(SIZE):
            y[n], lost[n] = w[FRESH, n], w[TRIED, n]
        meta[PLANNED] = planned
        meta[COUNT] += 1.0
        if status != RUNNING:
            meta[STATUS] = _named(mode, status)
        elif died:
            meta[STATUS] = STUCK
        meta[RATE] = max(meta[RATE], math.sqrt(
            y[OMEGA] * y[OMEGA] + y[OMEGA + 1] * y[OMEGA + 1] + y[OMEGA + 2] * y[OMEGA + 2]))
        if meta[STATUS] == RUNNING:
            for n in range(ROW):
                w[0, n] = w[END, n]


@compiled
def _keep(phase, front, meta):
    """Keep the front, if it is its turn."""
    if meta[COUNT] != meta[STORED] * meta[STRIDE]:
        return
    if meta[STORED] == KEPT:
        for n in range(KEPT // 2):
            for i in range(POINT):
                phase[n, i] = phase[2 * n, i]
        meta[STORED], meta[STRIDE] = KEPT // 2, 2.0 * meta[STRIDE]
        if meta[COUNT] != meta[STORED] * meta[STRIDE]:
            return
    place = int(meta[STORED])
    for i in range(POINT):
        phase[place, i] = front[i]
    meta[STORED] += 1.0


@compiled
def _named(mode, k):
    """Return why a phase ends whose watched number k - 1 fell below zero."""
    if k == 1:
        return TOUCHED if mode == FLIGHT else LOST_CONTACT
    if k == 2:
        return FASTER if mode == CREEPING else LET_GO
    return PARADOX if k == 3 else JUMP if k == 4 else STOPPED


@compiled
def at(p, w, phase, sizes, meta, cursor, time, y):
    """Fill y with the unknowns at a time that the march has passed.

    `cursor`, shape (2, POINT), holds the ends of the step in which the last answer lay.
    """
    if not (meta[PLACED] >= 0.0 and cursor[0, TIME] <= time < cursor[1, TIME]):
        low, high = 0, int(meta[STORED]) - 1
        while low < high:
            middle = (low + high + 1) // 2
            if phase[middle, TIME] <= time:
                low = middle
            else:
                high = middle - 1
        first = low * meta[STRIDE]
        if not (first <= meta[PLACED] + 1.0 and meta[PLACED] >= 0.0 and cursor[1, TIME] <= time):
            for n in range(POINT):
                cursor[1, n] = phase[low, n]
            meta[PLACED] = first - 1.0
        while True:
            meta[PLACED] += 1.0
            for n in range(POINT):
                cursor[0, n] = cursor[1, n]
            rate(p, cursor[0], w[0])
            step_from(p, w, cursor[0, :LOST], cursor[0, LOST:], sizes[int(meta[PLACED])])
            for n in range(SIZE):
                cursor[1, n], cursor[1, LOST + n] = w[FRESH, n], w[TRIED, n]
            if cursor[1, TIME] > time or meta[PLACED] + 1.0 >= meta[STEPS]:
                break
    values, lost, began = cursor[0, :LOST], cursor[0, LOST:], cursor[0, TIME]
    if time <= began:
        for n in range(SIZE):
            y[n] = values[n]
        return
    rate(p, values, w[0])
    if p[MODE] != SLIDING:
        step_from(p, w, values, lost, time - began)
    else:
        _step_to(p, w, values, lost, sizes[int(meta[PLACED])], cursor[1, TIME], time)
    for n in range(SIZE):
        y[n] = w[FRESH, n]


@compiled
def _step_to(p, w, values, lost, h, ended, time):
    """Step to a time where time is an unknown: Newton's method, within what holds the time."""
    low, high, began = 0.0, h, values[TIME]
    part = h
    if ended > began:
        part = min(h, h * (time - began) / (ended - began))
    for _ in range(TRIALS):
        step_from(p, w, values, lost, part)
        late = w[FRESH, TIME] - time
        if late > 0.0:
            high = part
        else:
            low = part
        rate(p, w[FRESH], w[END])
        pace = w[END, PACE]
        better = part - late / pace if pace > 0.0 else low
        if not low <= better <= high:
            better = 0.5 * (low + high)
        if abs(better - part) <= 1e-16 * h:
            break
        part = better
