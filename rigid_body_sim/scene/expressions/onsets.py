# SPDX-License-Identifier: Apache-2.0
"""Onsets: times at which a function of time begins to change after it was constant for long.

``exp(-((t - 50)/0.02)^2)`` is nothing for 49.9 s and over 0.2 s later. No method that takes long
steps sees such a pulse: its stages meet zeros, and all derivatives at the start of a step are zero
to the last digit. So steps end where it begins, and at some times within it.

Intervals of time are halved until the function hardly changes within each of them. Functions with
kinks are left out: their kinks are located as the body meets them.
"""

import functools
import math

import numpy as np

from rigid_body_sim.scene.expressions import tree
from rigid_body_sim.scene.expressions.intervals import fixed, ranges
from rigid_body_sim.scene.expressions.source import KINKED, TIME

LIVELY = {'exp', 'tanh', '/', '^'}
"""Operations that may be constant for long and change fast later."""
SMALL = range(9)    # powers that are not so flat
STRETCHES = np.array([0.0, *(math.ldexp(1.0, k) for k in range(-4, 24))])
"""Edges of the stretches of time that are looked at, s: up to half a year."""
SAMPLES = 16        # of a stretch, for the largest value
RESOLVED = 0.25     # share of the largest value by which the function changes within a part
STEEP = 2.0 ** 8    # factor by which it changes within a part, at most, of what is not nothing
NOTHING = 2.0 ** -48    # share of the largest value: a change of so much is none
HALVINGS = 40       # of a stretch, at most
MOST = 256          # parts of a stretch that are halved at once: beyond, it is lively throughout
SHORTER = 12.0      # times a part before: there the function begins to change faster
AT_REST = 4.0       # the same beside the time in which nothing changed
SMALLEST = 16       # halvings after which what overflows is looked at closer
WITHIN = 12         # parts behind that one at whose ends a step ends
MANY = 256          # times in all


@functools.lru_cache(maxsize=256)
def onsets(trees: tuple[tree.Term, ...],
           parameters: tuple[tuple[str, float], ...]) -> tuple[float, ...]:
    """Return the times (s) at which a step ends because a function of time begins to change.

    They rise. At most MANY are found, the earliest ones, up to half a year.

    Parameters
    ----------
    trees : tuple of Terms
    parameters : tuple of (str, float)
        Those that the trees may use.
    """
    known, times, seen = dict(parameters), set(), set()
    able = {*TIME, *known}
    for one in reversed(tree.parts(*trees)):    # what contains others comes before them
        if (_is_lively(one) and one not in seen and {*TIME} <= tree.names(one) <= able
                and not {part.op for part in tree.parts(one)} & {*KINKED, 'where'}):
            seen.update(tree.parts(one))
            [slope] = tree.derivatives(one, TIME)
            times |= set(_begins(*_parts(functools.partial(_values, slope, known))))
    return tuple(sorted(times)[:MANY])


def _values(slope, known, times):
    """Return the intervals of a slope in intervals of time."""
    given = {name: fixed(value, times[0]) for name, value in known.items()}
    return ranges((slope,), {'t': times} | given)[slope]


def _is_lively(one):
    """Return whether a term may be constant for long and change fast later, by its operation."""
    if one.op == '^' and one.args[1].op == 'number':
        return one.args[1].args[0] not in SMALL
    return one.op in LIVELY


def _begins(begin, length, rests):
    """Return the onsets: where parts of time become much shorter, and some times behind, s."""
    found, longest, rest, left = [], 0.0, 0.0, 0
    for k in range(1, len(begin)):
        rest = rest + length[k - 1] if rests[k - 1] else 0.0
        longest = max(longest, length[k - 1])
        if SHORTER * length[k] <= longest or AT_REST * length[k] <= rest:
            found.append(begin[k])
            longest, rest, left = length[k], 0.0, WITHIN
        elif left:
            found.append(begin[k])
            left -= 1
    return found


def _parts(function):
    """Return parts of time in which a slope hardly changes.

    A stretch in which it changes more often than MOST parts can tell is one part, as short as
    those would be. Two such stretches end the search: the function is as lively later.

    Parameters
    ----------
    function : callable
        Intervals of time (begin and end, s) -> intervals of the slope.

    Returns
    -------
    list, list, list
        In the order of time: where each begins (s), how long it is (s), and whether nothing
        changes in it.
    """
    begin, end = STRETCHES[:-1], STRETCHES[1:]
    stretch, lively = np.arange(len(begin)), np.zeros(len(begin), dtype=bool)
    samples = (begin[:, np.newaxis]
               + np.outer(end - begin, (np.arange(SAMPLES) + 0.5) / SAMPLES)).ravel()
    largest, done = _finite(np.abs(function((samples, samples))[0])), []
    for halving in range(HALVINGS + 1):
        middle, quarter = 0.5 * (begin + end), 0.75 * begin + 0.25 * end
        # in one call: each has a fixed cost
        points = np.concatenate((begin, quarter, middle, end))
        low, high = function((np.append(begin, points), np.append(end, points)))
        within, at = (low[:len(begin)], high[:len(begin)]), np.abs(low[len(begin):]).reshape(4, -1)
        largest = max(largest, _finite(at[2]))
        rests, resolved = _judged(within, at, largest, halving >= SMALLEST)
        left = ~resolved & (halving < HALVINGS)
        several = stretch[left][:, np.newaxis] == np.arange(len(lively))
        lively |= np.count_nonzero(several, axis=0) > MOST
        twice = np.flatnonzero(lively[1:] & lively[:-1])
        last = twice[0] if len(twice) else len(lively)
        done.append((begin[~left], (end - begin)[~left], stretch[~left], rests[~left]))
        left &= ~lively[stretch] & (stretch <= last)
        if not left.any():
            break
        begin, middle, end = begin[left], middle[left], end[left]
        begin, end = np.sort(np.append(begin, middle)), np.sort(np.append(middle, end))
        stretch = np.repeat(stretch[left], 2)
    begin, length, stretch, rests = (
        np.concatenate(column) for column in zip(*done, strict=True))
    kept = ~lively[stretch] & (stretch <= last)
    throughout = np.flatnonzero(lively[:last + 1])
    begin = np.append(begin[kept], STRETCHES[throughout])
    length = np.append(length[kept], np.diff(STRETCHES)[throughout] / MOST)
    rests = np.append(rests[kept], np.zeros(len(throughout), dtype=bool))
    order = np.argsort(begin)
    return begin[order].tolist(), length[order].tolist(), rests[order].tolist()


def _judged(within, at, largest, is_small):
    """Return whether a slope is nothing in parts, and whether it changes little there.

    Parameters
    ----------
    within : tuple of 2 arrays
        The least and the largest value in each part.
    at : array (4, parts)
        The sizes at its beginning, quarter, middle and end.
    largest : float
        The largest size of all.
    is_small : bool
        Whether the parts are so small that points tell of one in which the slope overflows.
    """
    (low, high), nothing = within, at <= NOTHING * largest
    with np.errstate(invalid='ignore', over='ignore'):    # infinite ends
        change, size = high - low, np.maximum(-low, high)
        rests = np.maximum(change, size) <= NOTHING * largest
        steep = (((low > 0.0) & (high > STEEP * low)) | ((high < 0.0) & (low < STEEP * high))
                 | (nothing[0] & nothing[1] & (size > STEEP * NOTHING * largest)))
    if is_small:    # what overflows there on the way may still be nothing
        rests |= ~np.isfinite(change) & (nothing | ~np.isfinite(at)).all(axis=0)
    return rests, rests | ((change <= RESOLVED * largest) & ~steep)


def _finite(sizes):
    """Return the largest finite size, or 0."""
    return float(sizes[np.isfinite(sizes)].max(initial=0.0))
