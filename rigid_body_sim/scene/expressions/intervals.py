# SPDX-License-Identifier: Apache-2.0
"""Intervals in which expressions lie within intervals of what they depend on.

Many intervals at once: a pair of arrays, the least and the largest values. Rounding is not counted
and an operand that stands twice is taken to vary twice, so the values are some more or an ulp less
than those of the function. Source: R. E. Moore, R. B. Kearfott, M. J. Cloud, Introduction to
Interval Analysis (2009), chapters 2 and 5.
"""

import math

import numpy as np

from rigid_body_sim.scene.expressions import tree

Range = tuple[np.ndarray, np.ndarray]


def ranges(trees: tuple[tree.Term, ...], given: dict[str, Range]) -> dict[tree.Term, Range]:
    """Return the intervals of trees and of all their parts.

    Parameters
    ----------
    trees : tuple of Terms
    given : dict of str to tuple of 2 arrays (n,)
        The intervals of names. Other names, and what has kinks, may be any number.
    """
    like = next(iter(given.values()))[0]
    found: dict[tree.Term, Range] = {}
    with np.errstate(all='ignore'):
        for part in tree.parts(*trees):
            if part.op == 'number':
                found[part] = fixed(part.args[0], like)
            elif part.op == 'name':
                found[part] = given.get(part.args[0]) or _any(like)
            else:
                low, high = _operation(part, [found[arg] for arg in part.args])
                # what is not a number may be anything
                found[part] = (np.where(np.isnan(low), -np.inf, low),
                               np.where(np.isnan(high), np.inf, high))
    return found


def fixed(value: float, like: np.ndarray) -> Range:
    """Return the intervals of a number, as many as an array has entries."""
    return np.full_like(like, value), np.full_like(like, value)


def _any(like):
    return np.full_like(like, -np.inf), np.full_like(like, np.inf)


def _operation(part, operands):
    """Return the intervals of an operation on intervals; all numbers where no rule is known."""
    (a, b), (c, d) = (*operands, operands[0])[:2]
    match part.op:
        case '+':
            return a + c, b + d
        case '-':
            return a - d, b - c
        case 'negative':
            return -b, -a
        case '*':
            return _product(a, b, c, d)
        case '/':
            through = (c <= 0.0) & (d >= 0.0)
            low, high = _product(a, b, 1.0 / d, 1.0 / c)
            return np.where(through, -np.inf, low), np.where(through, np.inf, high)
        case '^':
            return _power(a, b, c, d)
        case 'exp':
            return np.exp(a), np.exp(b)
        case 'tanh':
            return np.tanh(a), np.tanh(b)
        case 'sqrt':
            return np.sqrt(np.maximum(a, 0.0)), np.sqrt(np.maximum(b, 0.0))
        case 'log':
            return np.log(np.maximum(a, 0.0)), np.log(np.maximum(b, 0.0))
        case 'sin':
            return _sine(a, b)
        case 'cos':
            return _sine(a + 0.5 * math.pi, b + 0.5 * math.pi)
    return _any(a)


def _product(a, b, c, d):
    """Return the intervals of [a, b] [c, d]; nothing times anything is nothing."""
    ends = [np.where((u == 0.0) | (v == 0.0), 0.0, u * v) for u in (a, b) for v in (c, d)]
    return np.minimum.reduce(ends), np.maximum.reduce(ends)


def _power(a, b, c, d):
    """Return the intervals of [a, b] to a power that does not change; else all numbers."""
    power = c.flat[0]
    if not (np.array_equal(c, d) and (c == power).all()):
        return _any(a)
    if power != math.floor(power):
        a, b = np.maximum(a, 0.0), np.maximum(b, 0.0)
    ends = np.power(a, power), np.power(b, power)
    low, high = np.minimum(*ends), np.maximum(*ends)
    through = (a < 0.0) & (b > 0.0)
    if power < 0.0:
        return np.where(through, -np.inf, low), np.where(through, np.inf, high)
    return np.where(through & (power % 2.0 == 0.0), 0.0, low), high


def _sine(a, b):
    """Return the intervals of the sine of [a, b]."""
    low, high = np.minimum(np.sin(a), np.sin(b)), np.maximum(np.sin(a), np.sin(b))

    def meets(place):
        """Return whether a place, give and take whole turns, lies within."""
        return np.floor((b - place) / (2.0 * math.pi)) >= np.ceil((a - place) / (2.0 * math.pi))
    return (np.where(meets(-0.5 * math.pi), -1.0, low), np.where(meets(0.5 * math.pi), 1.0, high))
