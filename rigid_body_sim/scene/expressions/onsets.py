# SPDX-License-Identifier: Apache-2.0
"""Onsets: times at which a function of time begins to change after it was constant for long.

``exp(-((t - 50)/0.02)^2)`` is nothing for 49.9 s and over 0.2 s later. No method that takes long
steps sees such a pulse: its stages meet zeros, and all derivatives at the start of a step are zero
to the last digit. So steps end where it begins, and at some times within it.

Intervals of time are halved until the function hardly changes within each of them. Functions with
kinks are left out: their kinks are located as the body meets them.
"""

import functools

import numpy as np

from rigid_body_sim.scene.expressions import tree
from rigid_body_sim.scene.expressions.intervals import fixed, ranges
from rigid_body_sim.scene.expressions.source import KINKED, TIME

LIVELY = {'exp', 'tanh', '/', '^'}
"""Operations that may be constant for long and change fast later."""
SMALL = range(9)    # powers that are not so flat
STRETCHES = np.array([0.0, *(2.0 ** np.arange(-4.0, 24.0))])
"""Edges of the stretches of time that are looked at, s: up to half a year."""
SAMPLES = 64        # of a stretch, for the largest value
RESOLVED = 0.25     # share of the largest value by which the function changes within a part
STEEP = 2.0 ** 16   # factor by which it changes within a part, at most, of what is not nothing
NOTHING = 2.0 ** -50    # share of the largest value: a change of so much is none
HALVINGS = 40       # of a stretch, at most
MOST = 256          # parts of a stretch that are halved at once: beyond, it is lively throughout
SHORTER = 16.0      # times the part before: there the function begins to change
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
    known, times = dict(parameters), set()
    able = {*TIME, *known}
    for one in tree.parts(*trees):
        if (_is_lively(one) and {*TIME} <= tree.names(one) <= able
                and not {part.op for part in tree.parts(one)} & {*KINKED, 'where'}):
            times |= set(_begins(*_parts(functools.partial(_values, one, known))))
    return tuple(sorted(times)[:MANY])


def _values(one, known, times):
    """Return the intervals of a function of time and of parameters in intervals of time."""
    given = {name: fixed(value, times[0]) for name, value in known.items()}
    return ranges((one,), {'t': times} | given)[one]


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
        longest = max(longest, length[k - 1], rest)
        if SHORTER * length[k] <= longest:
            found.append(begin[k])
            longest, rest, left = length[k], 0.0, WITHIN
        elif left:
            found.append(begin[k])
            left -= 1
    return found


def _parts(function):
    """Return parts of time in which a function hardly changes.

    A stretch in which it changes more often than MOST parts can tell is one part, as short as
    those would be. Two such stretches end the search: the function is as lively later.

    Parameters
    ----------
    function : callable
        Intervals of time (begin and end, s) -> intervals of values.

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
    largest, done = _largest(function, samples), []
    for halving in range(HALVINGS + 1):
        low, high = function((begin, end))
        middle = 0.5 * (begin + end)
        largest = max(largest, _largest(function, middle))
        rests, resolved = _judged(low, high, largest)
        left = ~resolved & (halving < HALVINGS)
        lively |= np.bincount(stretch[left], minlength=len(lively)) > MOST
        twice = np.flatnonzero(lively[1:] & lively[:-1])
        last = twice[0] if len(twice) else len(lively)
        done.append((begin[~left], (end - begin)[~left], stretch[~left], rests[~left]))
        left &= ~lively[stretch] & (stretch <= last)
        if not left.any():
            break
        begin, middle, end = begin[left], middle[left], end[left]
        begin, end = np.sort(np.r_[begin, middle]), np.sort(np.r_[middle, end])
        stretch = np.repeat(stretch[left], 2)
    begin, length, stretch, rests = (
        np.concatenate(column) for column in zip(*done, strict=True))
    kept = ~lively[stretch] & (stretch <= last)
    throughout = np.flatnonzero(lively[:last + 1])
    begin = np.r_[begin[kept], STRETCHES[throughout]]
    length = np.r_[length[kept], np.diff(STRETCHES)[throughout] / MOST]
    rests = np.r_[rests[kept], np.zeros(len(throughout), dtype=bool)]
    order = np.argsort(begin)
    return begin[order].tolist(), length[order].tolist(), rests[order].tolist()


def _judged(low, high, largest):
    """Return whether a function does not change in parts, and whether it changes little there.

    Their least and largest values are given, and the largest size of all.
    """
    with np.errstate(invalid='ignore', over='ignore'):    # infinite ends
        change = high - low
        steep = ((low > 0.0) & (high > STEEP * low)) | ((high < 0.0) & (low < STEEP * high))
        rests = change <= NOTHING * largest
        return rests, rests | ((change <= RESOLVED * largest) & ~steep)


def _largest(function, times):
    """Return the largest finite size of a function at times (s), or 0."""
    sizes = np.abs(function((times, times))[0])
    return float(sizes[np.isfinite(sizes)].max(initial=0.0))
