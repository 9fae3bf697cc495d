# SPDX-License-Identifier: Apache-2.0
"""Template: march a convex body on a plane through one phase, to the event that ends it.

It is bound to the rates of equations/contact_rates.py, to steps (contact_step.py,
contact_series_step.py or contact_gauss_step.py) and to their order, and to contact_zero.py.

A phase is an array of points: the unknowns, and what their sums have lost. The sizes of all steps
are kept beside it, so that a step is made again with the same bits. The front is the last point of
the march.

Events: the watched numbers of a row of rates are looked at in all stages of a step. Where one
falls below zero, or comes close, the step is looked through in parts, and the first zero is
bracketed and refined to round-off. Each look is a step of the method, of full order.
"""

import math

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.compilation.layout import layout
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.equations.contact_rest import lies_low, spins
from rigid_body_sim.integrators.equations.contact_states import write
from rigid_body_sim.integrators.equations.contact_views import (
    CREEPING,
    FLIGHT,
    PIVOTING,
    ROW,
    SLIDING,
    UNKNOWNS,
    Watched,
)
from rigid_body_sim.integrators.marching import contact_step
from rigid_body_sim.mechanics.contact.parameters import CONTACT
from rigid_body_sim.numerics.functions import hypot, power
from rigid_body_sim.numerics.vectors import dot
from rigid_body_sim.scene.surfaces import TORUS

rate = UNBOUND           # contact_rates.py
step_from = UNBOUND      # contact_step.py, contact_series_step.py, contact_gauss_step.py
error_of = UNBOUND
longest = UNBOUND
ORDER = UNBOUND
first_zero = UNBOUND     # contact_zero.py

STAGES = contact_step.STAGES
END, FRESH, TRIED = contact_step.END, contact_step.FRESH, contact_step.TRIED
SIZE, ROW_SIZE, TIME = UNKNOWNS.size, ROW.size, UNKNOWNS.part('time').first
GAP = UNKNOWNS.part('gap').first
PACE, WATCHED = ROW.part('pace').first, ROW.part('watched').first
WATCHES = ROW.part('watched').size
# which of the watched numbers falls below zero
NORMAL, GRIP, FIRMNESS, JUMPS, STOPS, ROLLS = (
    layout(Watched).part(name).first for name in Watched._fields)
NOTHING = -1    # none does
load_omega, load_u = UNKNOWNS.part('omega').load, UNKNOWNS.part('u').load
MODE, SWIFT, KIND, DRY, VISCOUS, FILM, PATCH, SIDE, LAG = (CONTACT.part(name).first for name in (
    'mode', 'swift', 'kind', 'rolling', 'rolling_viscous', 'film', 'patch', 'side', 'lag'))

LOST = SIZE                  # place in a point of what the sums have lost
POINT = 2 * SIZE
KEPT = 4096                  # points of a phase; beyond, every other one is dropped
(COUNT, STRIDE, STORED, STATUS, TOLERANCE, RATE, SPEED, LENGTH, PLANNED, STEPS,
 PLACED, CROWDED, FADED, JAMMED, AHEAD) = range(15)
"""Numbers of a phase: points passed, steps from one kept point to the next, points kept, why it
ended, tolerance per second, scales (rad/s, m/s, m), the step planned, steps made, the number of
the point at which the cursor stands, how many of the last steps were all too short, how many were
all of a slip that fades, and how many all too short for a slip that jams; the time from the front
to the event that no step reaches (s)."""
META = 15
(RUNNING, LOST_CONTACT, LET_GO, STUCK, PARADOX, JUMP, TOUCHED, FAILED, FASTER,
 STOPPED, HELD, SETTLED) = range(12)
"""Why a phase ends: N = 0, the grip or the creep ends, the slip is dead, A = 0, what acts jumps,
the body comes down; no step is small enough; a creep has become a slip, or a pivot ends; a ring
lies flat, is flat in a flight, or a body no longer rolls; dry friction holds the rolling of a
disk, or lets a body roll; a slip of a patch pivots."""
GROWTH, SHRINK, SAFETY, TRIALS = 4.0, 0.1, 0.9, 60
UNSEEN = 1e-3                # share of the scale of omega: a slower body all but stands
LEAP, SHORTER = 1.2, 0.25    # growth of its omega in a step; share of a step that is too long
FLOOR = 2e-17                # smallest error that is asked for
CLOSE = 0.1                  # share of a watched number that is looked at more closely
DEAD = 2.0 ** -56            # slip below that share of the speeds counts as none
DYING = 2.0 ** -50           # slip below that share dies soon; an error of that size is allowed
STRETCH = 64.0               # growth of a slip in a step beyond which its error has no more room
TOO_SHORT = 1e-5             # share of the time in which a ring that is almost flat falls
CROWD = 25000                # so many steps in a row that short: friction leaves no motion
STALLED = 2000               # and so many in a row of a slip that dies: it is dead
FADES = 1e-3                 # share of the speeds below which a slip fades
JAMS = 1e-3                  # m A below which a slip jams where A goes on falling
HASTE = 1e-3                 # share of the time until A = 0: a step below that is too short
SETTLES = 0.5                # share of spin and lag allowed that what begins to pivot leaves free
PACED = 2.0 ** -52           # rounding of its pace, by which it may err after STALLED such steps


@compiled
def begin(p, row, front, meta, y):
    """Set the first point of a phase from its unknowns and choose its first step.

    `row` holds the rates there.
    """
    for n in range(SIZE):
        front[n], front[LOST + n] = y[n], 0.0
    grown, slip, pace = load_omega(row), load_u(row), row[PACE]
    fastest = meta[RATE] * pace + math.sqrt(dot(grown, grown)) / meta[RATE]
    if p[MODE] == SLIDING:
        fastest += hypot(slip[0], slip[1]) / pace
    meta[PLANNED] = power(meta[TOLERANCE], 1.0 / ORDER) / fastest
    meta[COUNT], meta[STRIDE], meta[STORED], meta[STATUS] = 0.0, 1.0, 0.0, RUNNING
    meta[STEPS], meta[PLACED], meta[CROWDED], meta[FADED] = 0.0, -1.0, 0.0, 0.0
    meta[JAMMED], meta[AHEAD] = 0.0, 0.0


@compiled
def march(p, w, phase, sizes, front, meta, target):
    """Move the front on until its time is past the target, the phase ends, or no room is left.

    More than forty lines: each function that calls a step compiles it once more, half a second.
    """
    y, lost = front[:LOST], front[LOST:]
    mode = p[MODE]
    watches = WATCHES if p[DRY] > 0.0 else ROLLS    # only dry friction holds a rolling
    jams = p[KIND] == TORUS and p[DRY] + p[VISCOUS] + p[FILM] > 0.0
    rate(p, y, w[0])
    while (meta[STATUS] == RUNNING and y[TIME] <= target and meta[STEPS] < len(sizes)
           and (meta[STORED] < len(phase) or len(phase) == KEPT)):
        h = meta[PLANNED]
        good, planned, took = False, h, h
        for _ in range(TRIALS):
            bad = step_from(p, w, y, lost, h)
            error = bad if bad > 0.0 else error_of(
                w, h, (meta[RATE], meta[SPEED], meta[LENGTH]))
            took = w[FRESH, TIME] - y[TIME]
            allowed = meta[TOLERANCE] * min(took, STRETCH * h * w[0, PACE]) + FLOOR
            if meta[FADED] > STALLED:
                allowed += min(PACED * h * meta[RATE] * p[SWIFT], FADES * w[0, PACE] / p[SWIFT])
            good = error <= allowed
            planned = min(h * _factor(error, allowed), longest(w, h))
            if good and _leaps(w, y, meta[RATE]):
                good, planned = False, SHORTER * h
            if good:
                break
            h = planned
        if not good or (mode != SLIDING and not w[FRESH, TIME] > y[TIME]):
            meta[STATUS] = FAILED
            break
        rate(p, w[FRESH], w[END])
        ends, part = NOTHING, h
        for k in range(watches):
            if _dips(w) if mode == FLIGHT and k == NORMAL else _falls(w, k):
                at = first_zero(p, w, y, lost, h, k, w[0, WATCHED + k])
                # the rows are those of the last look: put them back
                step_from(p, w, y, lost, h)
                rate(p, w[FRESH], w[END])
                if 0.0 < at <= part:
                    part, ends = at, k
        if ends in (NORMAL, FIRMNESS) and _dies(p, w, y):
            meta[STATUS] = STUCK
            break
        if ends != NOTHING:
            bad = step_from(p, w, y, lost, part)
            # a part may err by more than the step, whose error happens to be small
            if bad > 0.0 or error_of(
                    w, part, (meta[RATE], meta[SPEED], meta[LENGTH])) > allowed:
                meta[PLANNED] = 0.5 * part
                continue
        _keep(phase, front, meta)
        sizes[int(meta[STEPS])] = part
        meta[STEPS] += 1.0
        died = mode == SLIDING and w[END, PACE] < w[0, PACE] and (
            w[END, PACE] <= DEAD * p[SWIFT])
        for n in range(SIZE):
            y[n], lost[n] = w[FRESH, n], w[TRIED, n]
        meta[PLANNED] = planned
        meta[COUNT] += 1.0
        stalls = mode == SLIDING and w[END, PACE] <= DYING * p[SWIFT]
        fades = mode == SLIDING and w[END, PACE] <= FADES * p[SWIFT]
        meta[FADED] = meta[FADED] + 1.0 if fades else 0.0
        low = w[END, WATCHED + STOPS]
        if stalls or (jams and lies_low(p, y) and (
                took * meta[RATE] < TOO_SHORT * math.sqrt(abs(low)))):
            meta[CROWDED] += 1.0
        else:
            meta[CROWDED] = 0.0
        ahead = _until_jam(w, took) if mode == SLIDING else 0.0
        meta[JAMMED] = meta[JAMMED] + 1.0 if took < HASTE * ahead else 0.0
        if ends != NOTHING:
            meta[STATUS] = _named(mode, ends)
        elif died:
            meta[STATUS] = STUCK
        elif meta[CROWDED] > (STALLED if stalls else CROWD):
            meta[STATUS] = STUCK if stalls else FAILED
        elif meta[JAMMED] > STALLED:
            meta[STATUS], meta[AHEAD] = PARADOX, ahead
        elif p[PATCH] > 0.0 and fades and meta[FADED] % STALLED == 0.0 and _settles(p, w, y):
            meta[STATUS] = SETTLED
        omega = load_omega(y)
        meta[RATE] = max(meta[RATE], math.sqrt(dot(omega, omega)))
        if meta[STATUS] == RUNNING:
            for n in range(ROW_SIZE):
                w[0, n] = w[END, n]


@compiled_inline
def _leaps(w, y, rate):
    """Return whether a body that all but stands turns faster after a step by more than LEAP.

    What leaves an unstable state is too small there for its error to show (growing.py). Before the
    step omega counts with what its growth makes of it in the time of the scales.
    """
    before = max(_size(load_omega(y)), _size(load_omega(w[0])) / rate)
    return LEAP * before < _size(load_omega(w[FRESH])) < UNSEEN * rate


@compiled_inline
def _size(vector):
    """Return the largest component of a vector: its square may be no double."""
    return max(abs(vector[0]), abs(vector[1]), abs(vector[2]))


@compiled_inline
def _dies(p, w, y):
    """Return whether a step begins with a slip that shrinks and is no more than its error may be.

    The step may turn what is left of it around. What the laws say of a slip the other way is then
    no event: the slip is over.
    """
    return p[MODE] == SLIDING and w[0, PACE] <= DYING * p[SWIFT] and (
        dot(load_u(w[0]), load_u(y)) < 0.0)


@compiled_inline
def _until_jam(w, took):
    """Return the time (s) from the end of a step until A = 0, if it is small and falls; else 0.

    There N grows like 1/A, and the direction of the slip relaxes at a rate like N/A, which no
    step follows to the end: A falls at an even rate, which tells the time.
    """
    before, after = w[0, WATCHED + FIRMNESS], w[END, WATCHED + FIRMNESS]
    if not 0.0 < after < before < JAMS:
        return 0.0
    return took * after / (before - after)


@compiled_inline
def _settles(p, w, y):
    """Return whether a slip that fades pivots: it is the one that its friction asks for."""
    spin = spins(p, y)
    p[MODE], p[SIDE] = PIVOTING, math.copysign(1.0, spin)
    rate(p, y, w[FRESH])
    p[MODE], p[SIDE] = SLIDING, 0.0
    return w[FRESH, WATCHED + GRIP] > SETTLES * min(abs(spin), p[LAG])


@compiled_inline
def _factor(error, allowed):
    """Return the factor by which the next step is longer."""
    if not error < math.inf:
        return SHRINK
    return min(GROWTH, max(SHRINK, SAFETY * power(
        allowed / max(error, 1e-9 * allowed), 1.0 / (ORDER - 1))))


@compiled_inline
def _falls(w, k):
    """Return whether a watched number k may fall below zero within the step in the rows.

    It does so between two stages only where it falls at first, and comes close: the stages of
    dop8 are at most 0.27 of a step apart, so that a parabola which touches zero has a stage below
    a fourteenth of its larger end; those of the other methods are closer.
    """
    begin, end = w[0, WATCHED + k], w[END, WATCHED + k]
    least = end
    for i in range(1, STAGES):
        least = min(least, w[i, WATCHED + k])
    if begin <= 0.0:
        return least < 0.0 and k != STOPS and end < 0.0
    return least < 0.0 or (least < begin and least < CLOSE * max(begin, end))


@compiled_inline
def _dips(w):
    """Return whether the gap of a flight may fall below zero within the step in the rows.

    It may where it falls at some stage and comes close, as in `_falls`. A flight begins at the
    plane, so that its gap is small at first: being small is no sign while it grows.
    """
    begin, end = w[0, WATCHED + NORMAL], w[END, WATCHED + NORMAL]
    least, most = end, max(begin, end)
    falls = w[0, GAP] < 0.0 or w[END, GAP] < 0.0
    for i in range(1, STAGES):
        gap = w[i, WATCHED + NORMAL]
        least, most = min(least, gap), max(most, gap)
        falls = falls or w[i, GAP] < 0.0
    return least < 0.0 or ((falls or least < begin) and least < CLOSE * most)


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
    """Return why a phase ends whose watched number k fell below zero."""
    if k == NORMAL:
        return TOUCHED if mode == FLIGHT else LOST_CONTACT
    if k == GRIP:
        return FASTER if mode in (CREEPING, PIVOTING) else LET_GO
    return (PARADOX if k == FIRMNESS else JUMP if k == JUMPS else STOPPED if k == STOPS
            else HELD)


@compiled
def states(p, w, phase, sizes, front, meta, cursor, y, start, begin, times, order, out):
    """Fill rows of `out` with the states at times that the march has passed.

    The array `y` is used up. More than eight arguments: compiled code is handed arrays and
    scalars.

    Parameters
    ----------
    start, begin : tuple of 2 floats, float
        Where the centre of mass was at the start of the course, axes of the plane, m; its time, s.
    times : array
        s.
    order : array of int
        The rows of `times` and `out`, in the order of the times.
    """
    for row in order:
        if meta[STEPS] > 0.0:
            at(p, w, phase, sizes, meta, cursor, times[row] - begin, y)
        else:
            for n in range(SIZE):
                y[n] = front[n]
        rate(p, y, w[0])
        write(p, y, w[0], times[row], start, out[row])


@compiled_inline
def at(p, w, phase, sizes, meta, cursor, time, y):
    """Fill y with the unknowns at a time that the march has passed.

    `cursor`, shape (2, POINT), holds the ends of the step in which the last answer lay.
    """
    # the last step holds its end, too
    is_last = meta[PLACED] + 1.0 >= meta[STEPS]
    if not (meta[PLACED] >= 0.0 and cursor[0, TIME] <= time and (
            time < cursor[1, TIME] or is_last)):
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
