# SPDX-License-Identifier: Apache-2.0
"""Where a smooth function of time dips below zero between two looks that both see it above."""

import math

PART = 2.0 ** -10    # share of the time between two looks over which slopes are taken
CLOSER = 2.0 ** -4    # share of that time from a place that is tried to where its slope is taken
TRIES = 10           # places that are tried for the lowest point
NEAREST = 0.01       # share of an interval by which the next place is away from its ends
SURE = 4.0           # times what a parabola lacks to zero: a function that far above stays there


def dip(values, low, high):
    """Return a time between two others at which one of several functions is below zero, or None.

    A function that falls at the first time and rises at the second one has its lowest point
    between them. That is found by cubics through values and slopes, until one value is below zero
    or it is plain that none is. The earliest such time is returned.

    Parameters
    ----------
    values : function
        ``values(time)`` returns a list of floats, all at least 0 at both times.
    low, high : float
        s.
    """
    by = PART * (high - low)
    if not low < low + by < high - by < high:
        return None
    first, last = values(low), values(high)
    falls = [(other - one) / by for one, other in zip(first, values(low + by), strict=True)]
    rises = [(other - one) / by for one, other in zip(values(high - by), last, strict=True)]
    found = [_below(lambda time, k=k: values(time)[k], (low, first[k], falls[k]),
                    (high, last[k], rises[k]), by) for k in range(len(first))
             if _may(first[k], falls[k], last[k], rises[k], high - low)]
    return min((time for time in found if time is not None), default=None)


def _may(first, fall, last, rise, long):
    """Return whether a function may be below zero between two places: it is steepest there."""
    return fall < 0.0 < rise and min(first + fall * long, last - rise * long) < 0.0


def _below(value, low, high, by):
    """Return a time at which a function is below zero, or None.

    Parameters
    ----------
    low, high : (float, float, float)
        Times, values there, which are not below zero, and slopes, the first below, the second
        above zero.
    by : float
        Time over which slopes are taken.
    """
    begin, end = low[0], high[0]
    for _ in range(TRIES):
        time = _lowest(low, high)
        if not low[0] < time < high[0]:
            return None
        here = value(time)
        if here < 0.0:
            return time
        step = min(CLOSER * by, time - begin, end - time)
        slope = (value(time + step) - value(time - step)) / (2.0 * step)
        bend = (high[2] - low[2]) / (high[0] - low[0])
        if not slope or here > SURE * 0.5 * slope * slope / bend:
            return None
        if slope < 0.0:
            low = time, here, slope
        else:
            high = time, here, slope
    return None


def _lowest(low, high):
    """Return where the cubic through two (time, value, slope) is lowest: it falls, then rises."""
    (begin, first, fall), (end, last, rise) = low, high
    long = end - begin
    chord = 3.0 * (last - first) / long
    # slope: fall + 2 u (chord - 2 fall - rise) + 3 u^2 (fall + rise - 2 chord/3), u from 0 to 1
    half, square = chord - 2.0 * fall - rise, 3.0 * (fall + rise) - 2.0 * chord
    root = math.sqrt(max(half * half - square * fall, 0.0))
    share = -fall / (half + root) if half + root > 0.0 else 0.5
    return begin + long * min(max(share, NEAREST), 1.0 - NEAREST)
